//! The arc-transversal median of one arc, and the seam at which another estimator can take its place.

use crate::{
    arc::{Bearing, ReportedArc},
    crossing::{Crossing, MinAngle, crossings},
    echo::{Echo, Kind},
    median::middle_two,
    partners::Partners,
    resolution::interval,
    scalar::{Scalar, sine_cosine_in_quadrant},
};

/// What an arc gives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Verdict<E> {
    /// An echo.
    Echo(E),
    /// None: the reading is ignored, with this many crossings.
    Ignored(u32),
}

/// Turns one arc and the arcs it met into an echo. It keeps nothing from one arc to the next.
pub trait Estimator<T: Scalar> {
    /// What it says of an arc.
    type Echo;

    /// Estimates where on `arc` the echo came from. `scratch` has room for two numbers for each partner. Shows each
    /// crossing it uses to `visit`, with the partner's slot.
    fn estimate(
        &self,
        arc: &ReportedArc<T>,
        partners: &Partners<'_, T>,
        scratch: &mut [T],
        visit: impl FnMut(usize, &Crossing<T>),
    ) -> Verdict<Self::Echo>;
}

/// What an arc without a transversal crossing gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum OnNone {
    /// Its centre (Sec. III-B).
    #[default]
    Center,
    /// No echo.
    Drop,
}

/// What an arc with exactly two transversal crossings gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum OnTwo {
    /// No echo (Sec. III-B).
    #[default]
    Drop,
    /// Its centre.
    Center,
    /// The mean of the two.
    Mean,
}

/// The arc-transversal median (Sec. III): intersect, keep the transversal crossings, take their median.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TransversalMedian<T> {
    /// θmin.
    pub min_angle: MinAngle<T>,
    /// What no crossing gives.
    pub on_none: OnNone,
    /// What two crossings give.
    pub on_two: OnTwo,
}

impl<T: Scalar> TransversalMedian<T> {
    /// As in the paper: 30°, the centre where nothing crosses, nothing where two do.
    pub const PAPER: Self = Self { min_angle: MinAngle::PAPER, on_none: OnNone::Center, on_two: OnTwo::Drop };

    /// Where on the arc the echo lies: the table of Sec. III-B, and close range (Sec. IV-B) before it.
    fn place(&self, sines: &mut [T], near: bool) -> Option<(Kind, Bearing<T>)> {
        let mean = |(lower, upper)| Bearing::bisector(&Bearing::from_sine(lower), &Bearing::from_sine(upper));
        match (sines, self.on_none, self.on_two) {
            _ if near => Some((Kind::Near, Bearing::AHEAD)),
            ([], OnNone::Center, _) => Some((Kind::Center, Bearing::AHEAD)),
            ([], OnNone::Drop, _) | ([_, _], _, OnTwo::Drop) => None,
            ([only], ..) => Some((Kind::Single, Bearing::from_sine(*only))),
            ([_, _], _, OnTwo::Center) => Some((Kind::Pair, Bearing::AHEAD)),
            ([a, b], _, OnTwo::Mean) => Some((Kind::Pair, mean((*a, *b)))),
            // The sine grows with the azimuth up to 90 degrees, so the median of the one is the median of the other.
            (many, ..) => match middle_two(many)? {
                (lower, upper) if lower == upper => Some((Kind::Median, Bearing::from_sine(lower))),
                middle => Some((Kind::Median, mean(middle))),
            },
        }
    }

    /// Length along the arc in which the echo lies.
    fn resolution(&self, kind: Kind, sines: &[T], interval: T, arc: &ReportedArc<T>) -> T {
        match (kind, sines) {
            (Kind::Median | Kind::Single, _) => interval,
            (Kind::Pair, [a, b]) if self.on_two == OnTwo::Mean => {
                let spacing = Bearing::from_sine(*a).angle_to(&Bearing::from_sine(*b)).magnitude();
                interval + arc.arc.radius * spacing
            }
            _ => arc.arc_length(),
        }
    }
}

impl<T: Scalar> Estimator<T> for TransversalMedian<T> {
    type Echo = Echo<T>;

    #[inline(always)]
    fn estimate(
        &self,
        arc: &ReportedArc<T>,
        partners: &Partners<'_, T>,
        scratch: &mut [T],
        mut visit: impl FnMut(usize, &Crossing<T>),
    ) -> Verdict<Echo<T>> {
        let mut found = 0;
        partners.for_each_transversal(&arc.arc, &self.min_angle, |slot, other| {
            crossings(&arc.arc, other, &self.min_angle, |crossing| {
                if let Some(place) = scratch.get_mut(found) {
                    *place = crossing.sine;
                    found += 1;
                    visit(slot, &crossing);
                }
            });
        });
        let sines = scratch.get_mut(..found).unwrap_or_default();
        let (count, interval) = (found as u32, interval(arc.range_resolution, &self.min_angle));
        let near = arc.arc_length() <= interval;
        let Some((kind, bearing)) = self.place(sines, near) else {
            return Verdict::Ignored(count);
        };
        let ahead = bearing == Bearing::AHEAD;
        Verdict::Echo(Echo {
            t: arc.t,
            sensor: arc.sensor,
            kind,
            position: if ahead { arc.arc.middle() } else { arc.arc.at(&bearing) },
            range: arc.arc.radius,
            bearing,
            crossings: count,
            within: within(sines, &bearing, interval / arc.arc.radius * T::HALF),
            resolution: self.resolution(kind, sines, interval, arc),
            interval,
            arc_length: arc.arc_length(),
        })
    }
}

/// How many azimuths lie within ± `half_angle` (radians) of `bearing`, inclusive.
fn within<T: Scalar>(sines: &[T], bearing: &Bearing<T>, half_angle: T) -> u32 {
    if sines.is_empty() {
        return 0;
    }
    // No azimuth is farther than 90° off the boresight; beyond that the sine would come back.
    let right_angle = T::PI * T::HALF;
    let half_angle = if half_angle < right_angle { half_angle } else { right_angle };
    let (sin, cos) = sine_cosine_in_quadrant(half_angle);
    let edge = |side: T| {
        let turned = bearing.sin * cos + side * (bearing.cos * sin);
        let still_ahead = bearing.cos * cos - side * (bearing.sin * sin) > T::ZERO;
        if still_ahead { turned } else { side }
    };
    let (lower, upper) = (edge(-T::ONE), edge(T::ONE));
    sines.iter().filter(|&&sine| lower <= sine && sine <= upper).count() as u32
}

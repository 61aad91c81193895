//! A reading of the local map as a witness: what it says about a reflector that somebody else supposes.

use nalgebra::{Point2, Vector2};

use crate::{
    arc::{cross, dot},
    columns::Columns,
    scalar::Scalar,
};

/// What a witness says of a supposed reflector.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Vote<T> {
    /// It reports an echo where the reflector would give one: by how much farther than supposed, in metres.
    For(T),
    /// It looks there and reports clearly farther, or nothing.
    Against,
    /// It does not look there, or something nearer hides the reflector from it.
    Silent,
}

/// One reading: where it looks and how far the first thing there is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Witness<T: Scalar> {
    pub sensor: Point2<T>,
    /// Along the boresight.
    axis: Vector2<T>,
    /// Metres. Without an echo, how far it reaches.
    pub range: T,
    /// Whether there is an echo at that range.
    pub echo: bool,
    /// Of half the beam, times `scale` over the axis's length.
    cos: T,
    /// The same.
    sin: T,
    /// What offsets times axis times cosine or sine are too large by: with it, nothing has to be divided.
    scale: T,
}

/// How far from the truth of its reading a witness may find a reflector, in metres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tolerance<T> {
    /// For it, up to this much nearer or farther.
    pub agree: T,
    /// Against it, from this much farther.
    pub beyond: T,
}

impl<T: Scalar> Tolerance<T> {
    /// For ranges in steps of `range_resolution` (metres): the reported arc's own rounding and the witness's add up to one
    /// step at most.
    pub fn of(range_resolution: T) -> Self {
        Self { agree: range_resolution, beyond: range_resolution * (T::ONE + T::HALF) }
    }
}

/// Share of the half beam within which an echo would surely have been heard: a beam's edge is not sharp.
const SURE_SHARE: u32 = 85;

impl<T: Scalar> Witness<T> {
    /// The reading in `slot`; `None` where it can say nothing: too close, or invalid.
    #[inline(always)]
    pub fn of(columns: &Columns<'_, T>, slot: usize) -> Option<Self> {
        let sight = columns.sight(slot)?;
        // The half beam from its half angle's tangent: cos = (1 − t²)/(1 + t²), sin = 2t/(1 + t²).
        let [numerator, denominator] = sight.tangent;
        let (a, b) = (numerator * numerator, denominator * denominator);
        Some(Self {
            sensor: sight.sensor,
            axis: sight.axis,
            range: sight.range,
            echo: sight.echo,
            cos: b - a,
            sin: T::TWO * numerator * denominator,
            scale: (a + b) * sight.length,
        })
    }

    /// Whether it could have a word on anything within `reach` of `middle`: its beam comes that near, and what it reports
    /// is no nearer than that.
    #[inline]
    pub fn concerns(&self, middle: Point2<T>, reach: T) -> bool {
        let offset = middle - self.sensor;
        let aside = cross(self.axis, offset).magnitude();
        let ahead = dot(self.axis, offset);
        let far = self.range + reach;
        aside * self.cos - ahead * self.sin <= reach * self.scale && dot(offset, offset) <= far * far
    }

    /// Whether `offset` from its sensor lies in its beam, edges included.
    #[inline]
    pub fn sees(&self, offset: Vector2<T>) -> bool {
        cross(self.axis, offset).magnitude() * self.cos <= dot(self.axis, offset) * self.sin
    }

    /// Whether `offset` lies well within its beam.
    fn surely_sees(&self, offset: Vector2<T>) -> bool {
        let share = T::from_count(SURE_SHARE) / T::from_count(100);
        cross(self.axis, offset).magnitude() * self.cos <= dot(self.axis, offset) * self.sin * share
    }

    /// Its word on a point that answers from every side.
    pub fn on_point(&self, point: Point2<T>, tolerance: &Tolerance<T>) -> Vote<T> {
        self.on_round(point, T::ZERO, tolerance)
    }

    /// Its word on a round thing, which answers from every side and from its nearest point.
    pub fn on_round(&self, center: Point2<T>, radius: T, tolerance: &Tolerance<T>) -> Vote<T> {
        let offset = center - self.sensor;
        self.vote(dot(offset, offset).square_root() - radius, offset, tolerance)
    }

    /// Its word on a wall through `point` that answers only along its perpendicular; `normal` is that direction, away
    /// from the sensors. Second, how far along the wall from `point` it would hear it.
    pub fn on_wall(&self, point: Point2<T>, normal: Vector2<T>, window: T, tolerance: &Tolerance<T>) -> (Vote<T>, T) {
        let offset = point - self.sensor;
        let (distance, aside) = (dot(normal, offset), cross(offset, normal));
        if !(distance > T::ZERO && aside.magnitude() <= window) {
            return (Vote::Silent, aside);
        }
        (self.vote(distance, normal, tolerance), aside)
    }

    /// Its word on something at `distance` in the direction `towards`.
    fn vote(&self, distance: T, towards: Vector2<T>, tolerance: &Tolerance<T>) -> Vote<T> {
        let farther = self.range - distance;
        if farther.magnitude() <= tolerance.agree {
            if self.echo && self.sees(towards) { Vote::For(farther) } else { Vote::Silent }
        } else if farther > tolerance.beyond && self.surely_sees(towards) {
            Vote::Against
        } else {
            Vote::Silent
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    impl Witness<f64> {
        /// At a place, looking along a heading (degrees) with half a beam of 30°.
        pub fn looking(sensor: Point2<f64>, heading_deg: f64, range: f64) -> Self {
            let (half, (sin, cos)) = (30f64.to_radians(), heading_deg.to_radians().sin_cos());
            Self {
                sensor,
                axis: Vector2::new(cos, sin),
                range,
                echo: true,
                cos: half.cos(),
                sin: half.sin(),
                scale: 1.0,
            }
        }
    }

    fn witness(range: f64) -> Witness<f64> {
        Witness::looking(Point2::origin(), 0.0, range)
    }

    const INCH: Tolerance<f64> = Tolerance { agree: 0.0254, beyond: 0.0381 };

    #[test]
    fn point_at_the_reported_distance_is_agreed_with_and_the_difference_told() {
        // 3, 4, 5 scaled into the beam: (4.8, 1.4) is 5 away.
        let Vote::For(farther) = witness(5.01).on_point(Point2::new(4.8, 1.4), &INCH) else { panic!() };
        assert!((farther - 0.01).abs() < 1e-12);
    }

    #[test]
    fn point_clearly_before_the_reading_is_spoken_against_and_behind_it_not() {
        assert_eq!(witness(5.1).on_point(Point2::new(4.8, 1.4), &INCH), Vote::Against);
        let nothing = |limit: f64| Witness { echo: false, ..witness(limit) };
        assert_eq!(nothing(f64::INFINITY).on_point(Point2::new(4.8, 1.4), &INCH), Vote::Against);
        assert_eq!(nothing(5.1).on_point(Point2::new(4.8, 1.4), &INCH), Vote::Against);
        assert_eq!(nothing(5.0).on_point(Point2::new(4.8, 1.4), &INCH), Vote::Silent);
        assert_eq!(nothing(4.9).on_point(Point2::new(4.8, 1.4), &INCH), Vote::Silent);
        assert_eq!(witness(4.9).on_point(Point2::new(4.8, 1.4), &INCH), Vote::Silent);
    }

    #[test]
    fn between_agreement_and_contradiction_nothing_is_said() {
        assert_eq!(witness(5.03).on_point(Point2::new(4.8, 1.4), &INCH), Vote::Silent);
    }

    #[test]
    fn beams_edge_agrees_but_does_not_contradict() {
        let edge = Point2::new(29.9f64.to_radians().cos() * 5.0, 29.9f64.to_radians().sin() * 5.0);
        assert!(matches!(witness(5.0).on_point(edge, &INCH), Vote::For(_)));
        assert_eq!(witness(6.0).on_point(edge, &INCH), Vote::Silent);
        let outside = Point2::new(30.1f64.to_radians().cos() * 5.0, 30.1f64.to_radians().sin() * 5.0);
        assert_eq!(witness(5.0).on_point(outside, &INCH), Vote::Silent);
    }

    #[test]
    fn wall_is_heard_at_the_foot_of_its_perpendicular() {
        // A wall x = 2 through (2, 0.5): the foot from the origin is 0.5 to the right of it.
        let (vote, aside) = witness(2.0).on_wall(Point2::new(2.0, 0.5), Vector2::new(1.0, 0.0), 0.9, &INCH);
        assert_eq!((vote, aside), (Vote::For(0.0), -0.5));
        let (vote, _) = witness(2.5).on_wall(Point2::new(2.0, 0.5), Vector2::new(1.0, 0.0), 0.9, &INCH);
        assert_eq!(vote, Vote::Against);
    }

    #[test]
    fn wall_farther_along_than_the_window_or_behind_is_nobodys_business() {
        let (vote, _) = witness(2.0).on_wall(Point2::new(2.0, 1.0), Vector2::new(1.0, 0.0), 0.9, &INCH);
        assert_eq!(vote, Vote::Silent);
        let (vote, _) = witness(2.0).on_wall(Point2::new(-2.0, 0.0), Vector2::new(1.0, 0.0), 0.9, &INCH);
        assert_eq!(vote, Vote::Silent);
    }

    #[test]
    fn reading_concerns_what_its_beam_and_its_range_come_near() {
        assert!(witness(2.0).concerns(Point2::new(2.4, 0.0), 0.5));
        assert!(!witness(2.0).concerns(Point2::new(2.6, 0.0), 0.5));
        // Beside the point 1 m along the beam's edge.
        let (sin, cos) = 30f64.to_radians().sin_cos();
        let beside = |offset: f64| Point2::new(cos - offset * sin, sin + offset * cos);
        assert!(witness(2.0).concerns(beside(0.49), 0.5));
        assert!(!witness(2.0).concerns(beside(0.51), 0.5));
    }
}

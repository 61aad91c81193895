//! The arc: all that one reading says about where its echo came from.

use nalgebra::{Isometry2, Point2, Vector2};

use crate::{
    scalar::Scalar,
    sensor::{Beam, RangeResolution},
};

/// Cross product of plane vectors: positive where `b` lies counter-clockwise of `a`.
#[inline(always)]
pub(crate) fn cross<T: Scalar>(a: Vector2<T>, b: Vector2<T>) -> T {
    a.x * b.y - a.y * b.x
}

#[inline(always)]
pub(crate) fn dot<T: Scalar>(a: Vector2<T>, b: Vector2<T>) -> T {
    a.x * b.x + a.y * b.y
}

/// The points at one distance from a sensor and within its beam; the echo is uniform along it (Sec. II-C).
///
/// Held as the sensor's position, the arc's middle, its radius and its reach, so that neither crossing it with another
/// nor asking whether a point lies in its beam needs an angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arc<T: Scalar> {
    /// The sensor, in the fixed frame.
    pub(crate) sensor: Point2<T>,
    /// The point of the arc on the boresight.
    pub(crate) middle: Point2<T>,
    /// The reading, in metres.
    pub(crate) radius: T,
    /// 2 r tan(φ/4): no point of the arc is farther than this from its middle (the exact distance is 2 r sin(φ/4)).
    pub(crate) reach: T,
}

impl<T: Scalar> Arc<T> {
    /// The arc of radius `radius` (metres, positive) seen from `pose`, the sensor's pose in the fixed frame with its
    /// boresight along +x.
    pub fn new(pose: &Isometry2<T>, radius: T, beam: &Beam<T>) -> Self {
        let sensor = Point2::from(pose.translation.vector);
        let boresight = Vector2::new(pose.rotation.re, pose.rotation.im);
        let reach = radius * beam.quarter_tangent() * T::TWO;
        Self { sensor, middle: sensor + boresight * radius, radius, reach }
    }

    /// The sensor's position.
    pub const fn sensor(&self) -> Point2<T> {
        self.sensor
    }

    /// The arc's centre: where the boresight meets it.
    pub const fn middle(&self) -> Point2<T> {
        self.middle
    }

    /// The reading, in metres.
    pub const fn radius(&self) -> T {
        self.radius
    }

    /// From the sensor to the arc's middle: the boresight, as long as the radius.
    #[inline(always)]
    pub(crate) fn axis(&self) -> Vector2<T> {
        self.middle - self.sensor
    }

    /// Whether the direction `offset` from the sensor lies within the beam, its edges included.
    ///
    /// |azimuth| ≤ φ/2 as sin(φ/2 − |azimuth|) ≥ 0, written with tan(φ/4) = reach / 2r and without its denominators. No
    /// angle, no root, no division, and well conditioned from the narrowest beam to half a turn.
    #[inline(always)]
    pub(crate) fn sees(&self, offset: Vector2<T>) -> bool {
        let axis = self.axis();
        let diameter = self.radius * T::TWO;
        let aside = cross(axis, offset).magnitude();
        let ahead = dot(axis, offset);
        aside * (diameter * diameter - self.reach * self.reach) <= ahead * (T::TWO * diameter * self.reach)
    }

    /// The point of the arc in direction `bearing`.
    pub fn at(&self, bearing: &Bearing<T>) -> Point2<T> {
        let axis = self.axis();
        let aside = Vector2::new(-axis.y, axis.x);
        self.sensor + (axis * bearing.cos + aside * bearing.sin)
    }
}

/// An arc that is being reported, with what its reading and sensor say of it.
#[derive(Debug, Clone, Copy)]
pub struct ReportedArc<T: Scalar> {
    /// The arc.
    pub arc: Arc<T>,
    /// The reading's time, in nanoseconds.
    pub t: i64,
    /// The sensor's index.
    pub sensor: u16,
    /// The beam's full angle φ, in radians.
    pub field_of_view: T,
    /// δ, the range resolution.
    pub range_resolution: RangeResolution<T>,
}

impl<T: Scalar> ReportedArc<T> {
    /// No arc: nothing crosses it.
    pub(crate) const NONE: Self = Self {
        arc: Arc {
            sensor: Point2::new(T::NAN, T::NAN),
            middle: Point2::new(T::NAN, T::NAN),
            radius: T::NAN,
            reach: T::NAN,
        },
        t: 0,
        sensor: 0,
        field_of_view: T::ZERO,
        range_resolution: RangeResolution::STEP,
    };

    /// φ r, the length of the arc, in metres.
    pub fn arc_length(&self) -> T {
        self.field_of_view * self.arc.radius
    }
}

/// A direction relative to a boresight, as a unit vector; counter-clockwise positive.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Bearing<T> {
    /// Cosine of the azimuth, never negative.
    pub(crate) cos: T,
    /// Sine of the azimuth.
    pub(crate) sin: T,
}

impl<T: Scalar> Bearing<T> {
    /// Straight ahead.
    pub const AHEAD: Self = Self { cos: T::ONE, sin: T::ZERO };

    /// The direction within ±90° that has this sine, in \[−1, 1\].
    pub(crate) fn from_sine(sin: T) -> Self {
        let cos_squared = (T::ONE - sin) * (T::ONE + sin);
        Self { cos: if cos_squared > T::ZERO { cos_squared.square_root() } else { T::ZERO }, sin }
    }

    /// The direction halfway between two: its azimuth is the mean of theirs.
    pub(crate) fn bisector(a: &Self, b: &Self) -> Self {
        let (cos, sin) = (a.cos + b.cos, a.sin + b.sin);
        let length = (cos * cos + sin * sin).square_root();
        // Both at the ends of a half-turn beam: ±90° have their mean ahead.
        if !(length > T::ZERO) {
            return Self::AHEAD;
        }
        Self { cos: cos / length, sin: sin / length }
    }

    /// From `self` counter-clockwise to `other`, in radians.
    pub(crate) fn angle_to(&self, other: &Self) -> T {
        let across = self.cos * other.sin - self.sin * other.cos;
        let along = self.cos * other.cos + self.sin * other.sin;
        across.arc_tangent_2(along)
    }

    /// Cosine of the azimuth.
    pub const fn cos(&self) -> T {
        self.cos
    }

    /// Sine of the azimuth.
    pub const fn sin(&self) -> T {
        self.sin
    }

    /// Azimuth of the echo from the boresight, in radians, within ± half the beam (Sec. III-B).
    pub fn azimuth(&self) -> T {
        self.sin.arc_tangent_2(self.cos)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arc(field_of_view_deg: f64) -> Arc<f64> {
        Arc::new(&Isometry2::identity(), 2.0, &Beam::new(field_of_view_deg.to_radians()).unwrap())
    }

    fn towards(azimuth_deg: f64) -> Vector2<f64> {
        let (sin, cos) = azimuth_deg.to_radians().sin_cos();
        Vector2::new(cos, sin) * 3.0
    }

    #[test]
    fn beam_of_any_width_ends_at_half_its_field_of_view() {
        for field_of_view in [0.5, 5.0, 22.5, 90.0, 135.0, 179.0, 180.0] {
            let arc = arc(field_of_view);
            for side in [-1.0, 1.0] {
                assert!(arc.sees(towards(side * (field_of_view / 2.0 - 1e-9))), "{field_of_view}");
                assert!(!arc.sees(towards(side * (field_of_view / 2.0 + 1e-9))), "{field_of_view}");
            }
            assert!(!arc.sees(towards(180.0)));
        }
    }

    #[test]
    fn every_point_of_an_arc_is_within_reach_of_its_middle() {
        for field_of_view in [0.5f64, 5.0, 22.5, 90.0, 180.0] {
            let arc = arc(field_of_view);
            let end = arc.at(&Bearing::from_sine((field_of_view / 2.0).to_radians().sin()));
            assert!((end - arc.middle()).norm() <= arc.reach, "{field_of_view}");
        }
    }

    #[test]
    fn bisector_of_opposite_ends_is_ahead() {
        let (left, right) = (Bearing::from_sine(1.0f64), Bearing::from_sine(-1.0));
        assert_eq!(Bearing::bisector(&left, &right), Bearing::AHEAD);
    }

    #[test]
    fn bisector_has_the_mean_azimuth() {
        let (a, b) = (Bearing::from_sine(0.1f64), Bearing::from_sine(0.7));
        let mean = (a.azimuth() + b.azimuth()) / 2.0;
        assert!((Bearing::bisector(&a, &b).azimuth() - mean).abs() < 1e-15);
    }
}

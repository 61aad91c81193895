//! What one sensor can hear at one moment: a sector about its boresight.
use nalgebra::{Isometry2, Point2, UnitComplex, Vector2};
use parry2d_f64::partitioning::BvhNode;

use crate::world::Shape;

/// Share of the half beam, around the boresight, in which the weak mirror return of a rough wall is still heard.
pub const MIRROR_SHARE: f64 = 0.5;
/// Width by which boxes are still looked into beside a sector, in metres, so that rounding leaves nothing out.
const MARGIN: f64 = 1e-6;

/// The beam of a sensor: a sector about its boresight, borders included.
#[derive(Debug, Clone, Copy)]
pub struct Beam {
    origin: Point2<f64>,
    boresight: Vector2<f64>,
    cos_half: f64,
    cos_mirror: f64,
    sector: Sector,
}

impl Beam {
    /// The beam of a sensor with this pose, boresight along its x axis; `field_of_view` is the full angle, in (0, π].
    pub fn new(sensor: &Isometry2<f64>, field_of_view: f64) -> Self {
        let half = field_of_view / 2.0;
        let turned = |angle: f64| {
            let turn = UnitComplex::from_cos_sin_unchecked(libm::cos(angle), libm::sin(angle));
            sensor.rotation * turn * Vector2::x()
        };
        let origin = Point2::from(sensor.translation.vector);
        Self {
            origin,
            boresight: sensor.rotation * Vector2::x(),
            cos_half: libm::cos(half),
            cos_mirror: libm::cos(half * MIRROR_SHARE),
            sector: Sector { apex: origin, right: turned(-half), left: turned(half) },
        }
    }

    /// Where the sensor is.
    pub fn origin(&self) -> Point2<f64> {
        self.origin
    }

    /// Angle of a point from the boresight, counter-clockwise, in radians.
    pub fn azimuth(&self, point: Point2<f64>) -> f64 {
        let ray = point - self.origin;
        libm::atan2(self.boresight.perp(&ray), self.boresight.dot(&ray))
    }

    /// Distance to a point that the beam holds.
    pub(super) fn range_to(&self, point: Point2<f64>) -> Option<f64> {
        self.range_within(point, self.cos_half)
    }

    /// Distance to a point in that part of the beam in which weak mirrors are heard.
    pub(super) fn mirror_range_to(&self, point: Point2<f64>) -> Option<f64> {
        self.range_within(point, self.cos_mirror)
    }

    fn range_within(&self, point: Point2<f64>, cos_limit: f64) -> Option<f64> {
        let ray = point - self.origin;
        let range = ray.norm();
        (ray.dot(&self.boresight) >= range * cos_limit).then_some(range)
    }

    /// The sector that the beam is.
    pub(super) fn sector(&self) -> &Sector {
        &self.sector
    }
}

/// A sector of at most half a turn: what lies to the left of one direction and to the right of another.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sector {
    pub apex: Point2<f64>,
    pub right: Vector2<f64>,
    pub left: Vector2<f64>,
}

impl Sector {
    /// What is seen from `apex` through the gap where the wall stands; `None` for a pole.
    pub fn through(apex: Point2<f64>, wall: &Shape) -> Option<Self> {
        let Shape::Segment { from, to } = *wall else { return None };
        let (one, other) = (from - apex, to - apex);
        let (right, left) = if one.perp(&other) >= 0.0 { (one, other) } else { (other, one) };
        Some(Self { apex, right: right.normalize(), left: left.normalize() })
    }

    /// Whether a box lies wholly outside.
    pub fn misses(&self, node: &BvhNode) -> bool {
        let (mins, maxs) = (node.mins(), node.maxs());
        let corners = [(mins.x, mins.y), (mins.x, maxs.y), (maxs.x, mins.y), (maxs.x, maxs.y)];
        let rays = corners.map(|(x, y)| Point2::new(x, y) - self.apex);
        rays.iter().all(|ray| self.right.perp(ray) < -MARGIN) || rays.iter().all(|ray| ray.perp(&self.left) < -MARGIN)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use parry2d_f64::{bounding_volume::Aabb, math::Vector};

    use super::*;

    /// A beam of 90° at (1, 0) that looks along +y.
    fn upwards() -> Beam {
        Beam::new(&Isometry2::new(Vector2::new(1.0, 0.0), FRAC_PI_2), FRAC_PI_2)
    }

    #[test]
    fn borders_belong_to_the_beam() {
        let range = |x, y| upwards().range_to(Point2::new(x, y));
        assert_eq!(range(1.0, 3.0), Some(3.0));
        assert!(range(2.999_999, 2.0).is_some() && range(-0.999_999, 2.0).is_some());
        assert!(range(3.000_001, 2.0).is_none() && range(-1.000_001, 2.0).is_none());
        assert!(range(1.0, -1.0).is_none());
    }

    #[test]
    fn weak_mirrors_are_heard_in_the_middle_half() {
        // tan 22.5° = 0.41421.
        assert!(upwards().mirror_range_to(Point2::new(1.8284, 2.0)).is_some());
        assert!(upwards().mirror_range_to(Point2::new(1.8285, 2.0)).is_none());
    }

    #[test]
    fn azimuth_is_counter_clockwise_from_the_boresight() {
        assert!((upwards().azimuth(Point2::new(0.0, 1.0)) - PI / 4.0).abs() < 1e-15);
        assert!((upwards().azimuth(Point2::new(2.0, 1.0)) + PI / 4.0).abs() < 1e-15);
    }

    #[test]
    fn boxes_are_missed_only_where_all_of_them_is_outside() {
        let node = |x: f64, y: f64| BvhNode::leaf(Aabb::new(Vector::new(x, y), Vector::new(x + 1.0, y + 1.0)), 0);
        let beam = upwards();
        assert!(!beam.sector().misses(&node(0.5, 2.0)));
        assert!(!beam.sector().misses(&node(2.0, 0.5)), "its corner is inside");
        assert!(beam.sector().misses(&node(3.5, 0.5)));
        assert!(beam.sector().misses(&node(0.5, -2.0)));
    }
}

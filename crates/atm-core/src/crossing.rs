//! Where two arcs cross, and whether they do so steeply enough (Sec. III-A and III-C).

use nalgebra::Vector2;

use crate::{
    arc::{Arc, Bearing, cross},
    error::DomainError,
    scalar::Scalar,
};

/// The smallest angle at which a crossing counts: θmin, in \[1°, 90°\], inclusive (Sec. III-C).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MinAngle<T> {
    cos: T,
    cot_half: T,
}

impl<T: Scalar> MinAngle<T> {
    /// 30° (Sec. IV-B).
    pub const PAPER: Self = Self { cos: T::COS_30_DEG, cot_half: T::COT_15_DEG };

    /// An angle in radians.
    pub fn new(radians: T) -> Result<Self, DomainError> {
        let degree = T::PI / T::from_count(180);
        let right_angle = T::PI / T::TWO;
        if !(radians >= degree && radians <= right_angle) {
            return Err(DomainError::MinAngle);
        }
        // The paper's angle is the constant, whichever way it is asked for.
        if radians == T::PI / T::from_count(6) {
            return Ok(Self::PAPER);
        }
        let (_, cos) = radians.sine_cosine();
        Ok(Self { cos, cot_half: T::ONE / (radians / T::TWO).tangent() })
    }

    /// cot(θmin/2) = 1/sin θmin + 1/tan θmin: the interval L in units of the range resolution.
    pub const fn cot_half(&self) -> T {
        self.cot_half
    }

    #[cfg(target_arch = "x86_64")]
    pub(crate) const fn cos(&self) -> T {
        self.cos
    }

    /// The angle, in radians.
    pub fn radians(&self) -> T {
        T::TWO * T::ONE.arc_tangent_2(self.cot_half)
    }
}

/// A point that lies on two arcs, within both beams.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing<T: Scalar> {
    pub(crate) offset: Vector2<T>,
    pub(crate) sine: T,
    pub(crate) cosine_between: T,
}

impl<T: Scalar> Crossing<T> {
    /// From the first arc's sensor to the crossing, in metres.
    pub const fn offset(&self) -> Vector2<T> {
        self.offset
    }

    /// Its direction on the first arc.
    pub fn bearing(&self) -> Bearing<T> {
        Bearing::from_sine(self.sine)
    }

    /// The angle between the arcs' tangents, folded to \[0, π/2\], in radians.
    pub fn angle(&self) -> T {
        self.cosine_between.arc_cosine()
    }
}

/// The triangle of two sensors and a point that is as far from each as its reading says.
pub(crate) struct Triangle<T> {
    distance_squared: T,
    square: T,
    other_square: T,
    /// 2 rA rB.
    twice_product: T,
    /// rA² + rB² − d² = 2 rA rB cos θ.
    numerator: T,
}

impl<T: Scalar> Triangle<T> {
    /// `between` the sensors, with the two radii; the radii may change places without changing a bit of the angle.
    #[inline(always)]
    pub(crate) fn new(between: Vector2<T>, radius: T, other_radius: T) -> Self {
        let distance_squared = between.x * between.x + between.y * between.y;
        let (square, other_square) = (radius * radius, other_radius * other_radius);
        let twice_product = T::TWO * (radius * other_radius);
        let numerator = (square + other_square) - distance_squared;
        Self { distance_squared, square, other_square, twice_product, numerator }
    }

    /// Whether the radii meet at θmin or steeper. |cos|: radii that face each other cross near 180 degrees.
    #[inline(always)]
    pub(crate) fn is_transversal(&self, min_angle: &MinAngle<T>) -> bool {
        self.numerator.magnitude() <= self.twice_product * min_angle.cos
    }
}

/// Visits the crossings of `arc` with `other` that are at least `min_angle` steep: none, one or two.
///
/// With d the distance of the sensors, the radii meet at the crossing with cos θ = (rA² + rB² − d²) / (2 rA rB), the same
/// for both intersections of the circles. So the test comes before any root, and what it lets through is neither
/// concentric nor coincident nor tangent nor apart: no epsilon is needed. Beams include their edges.
#[inline(always)]
pub fn crossings<T: Scalar>(arc: &Arc<T>, other: &Arc<T>, min_angle: &MinAngle<T>, mut visit: impl FnMut(Crossing<T>)) {
    let between = other.sensor - arc.sensor;
    let triangle = Triangle::new(between, arc.radius, other.radius);
    if !triangle.is_transversal(min_angle) {
        return;
    }
    let Triangle { distance_squared, square, other_square, twice_product, numerator } = triangle;
    // The circles' intersections from the first centre: along the line of centres, then to either side of it, where
    // 4 × the triangle's area = √((2 rA rB)² − numerator²).
    let scale = T::HALF / distance_squared;
    let along = (square - other_square + distance_squared) * scale;
    let aside = ((twice_product - numerator) * (twice_product + numerator)).square_root() * scale;
    let foot = between * along;
    let side = Vector2::new(-between.y, between.x) * aside;
    let axis = arc.axis();
    for offset in [foot + side, foot - side] {
        if arc.sees(offset) && other.sees(offset - between) {
            let (sine, cosine_between) = (cross(axis, offset) / square, numerator.magnitude() / twice_product);
            // Rounding may carry the sine a last place past 1. Where a reading is so short that its square is 0 there is no
            // azimuth, and where the product with the other one is, no angle.
            if let (Some(sine), true) = (unit_interval(sine), cosine_between <= T::ONE) {
                visit(Crossing { offset, sine, cosine_between });
            }
        }
    }
}

fn unit_interval<T: Scalar>(sine: T) -> Option<T> {
    if sine > T::ONE {
        Some(T::ONE)
    } else if sine < -T::ONE {
        Some(-T::ONE)
    } else if sine.magnitude() <= T::ONE {
        Some(sine)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::PI;
    use std::vec::Vec;

    use nalgebra::Isometry2;

    use super::*;
    use crate::sensor::Beam;

    fn arc(x: f64, y: f64, yaw_deg: f64, radius: f64, field_of_view_deg: f64) -> Arc<f64> {
        let pose = Isometry2::new(Vector2::new(x, y), yaw_deg.to_radians());
        Arc::new(&pose, radius, &Beam::new(field_of_view_deg.to_radians()).unwrap())
    }

    fn count(a: &Arc<f64>, b: &Arc<f64>, min_angle_deg: f64) -> usize {
        let mut count = 0;
        crossings(a, b, &MinAngle::new(min_angle_deg.to_radians()).unwrap(), |_| count += 1);
        count
    }

    #[test]
    fn equal_circles_a_diagonal_apart_cross_at_right_angles() {
        // Sensors at (0,0) and (2,0), both radius √2, looking at (1,1): the radii are perpendicular there.
        let a = arc(0.0, 0.0, 45.0, 2f64.sqrt(), 20.0);
        let b = arc(2.0, 0.0, 135.0, 2f64.sqrt(), 20.0);
        let mut found = None;
        crossings(&a, &b, &MinAngle::PAPER, |crossing| found = Some(crossing));
        let crossing = found.unwrap();
        assert!((crossing.offset() - Vector2::new(1.0, 1.0)).norm() < 1e-15);
        assert!((crossing.angle() - PI / 2.0).abs() < 1e-15);
        assert!(crossing.bearing().azimuth().abs() < 1e-15);
    }

    #[test]
    fn readings_whose_product_is_no_number_have_no_crossing() {
        let arc = |x: f32, radius: f32| {
            let pose = Isometry2::new(Vector2::new(x, 0.0), 0.0);
            Arc::new(&pose, radius, &Beam::new(1.0).unwrap())
        };
        // The second is 10⁻⁴⁰ m long and begins where the first ends.
        let mut angles = Vec::new();
        crossings(&arc(0.0, 1e-6), &arc(1e-6, 1e-40), &MinAngle::PAPER, |crossing| angles.push(crossing.angle()));
        assert_eq!(angles, []);
    }

    #[test]
    fn both_intersections_count_where_both_lie_in_both_beams() {
        let a = arc(0.0, 0.0, 0.0, 1.0, 180.0);
        let b = arc(1.2, 0.0, 180.0, 1.0, 180.0);
        assert_eq!(count(&a, &b, 30.0), 2);
        assert_eq!(count(&a, &arc(1.2, 0.0, 90.0, 1.0, 170.0), 30.0), 1);
    }

    #[test]
    fn concentric_coincident_tangent_and_disjoint_circles_are_rejected() {
        let a = arc(0.0, 0.0, 0.0, 1.0, 180.0);
        assert_eq!(count(&a, &arc(0.0, 0.0, 0.0, 0.5, 180.0), 1.0), 0, "concentric");
        assert_eq!(count(&a, &a, 1.0), 0, "coincident");
        assert_eq!(count(&a, &arc(2.0, 0.0, 180.0, 1.0, 180.0), 1.0), 0, "external_tangent");
        assert_eq!(count(&a, &arc(0.5, 0.0, 0.0, 0.5, 180.0), 1.0), 0, "internal_tangent");
        assert_eq!(count(&a, &arc(5.0, 0.0, 180.0, 1.0, 180.0), 1.0), 0, "disjoint");
    }

    #[test]
    fn angle_counts_from_the_threshold_upwards_on_both_sides_of_a_right_angle() {
        // Equal radii 1 at distance d: cos θ = 1 − d²/2, so θ = 2 asin(d/2).
        for angle in [29.9f64, 30.1, 150.1, 149.9] {
            let distance = 2.0 * (angle / 2.0).to_radians().sin();
            let a = arc(0.0, 0.0, 90.0, 1.0, 180.0);
            let b = arc(distance, 0.0, 90.0, 1.0, 180.0);
            let expected = usize::from((30.0..=150.0).contains(&angle));
            assert_eq!(count(&a, &b, 30.0), expected, "{angle}");
        }
    }

    #[test]
    fn angle_domain_is_one_to_ninety_degrees() {
        assert!(MinAngle::new(0.9f64.to_radians()).is_err());
        assert!(MinAngle::new(1f64.to_radians()).is_ok());
        assert!(MinAngle::new(90f64.to_radians()).is_ok());
        assert!(MinAngle::new(90.1f64.to_radians()).is_err());
        assert!(MinAngle::new(f64::NAN).is_err());
        assert!(MinAngle::new(1f32.to_radians()).is_ok());
        assert!(MinAngle::new(90f32.to_radians()).is_ok());
    }

    #[test]
    fn paper_angle_is_thirty_degrees() {
        let paper = MinAngle::<f64>::PAPER;
        assert_eq!(MinAngle::new(30f64.to_radians()), Ok(paper));
        assert_eq!(MinAngle::new(30f32.to_radians()), Ok(MinAngle::PAPER));
        assert!((paper.radians() - PI / 6.0).abs() < 1e-15);
        let beside = MinAngle::new(30f64.to_radians() * (1.0 + 1e-12)).unwrap();
        assert!((paper.cos - beside.cos).abs() < 1e-11);
        assert!((paper.cot_half() - beside.cot_half()).abs() < 1e-10);
    }
}

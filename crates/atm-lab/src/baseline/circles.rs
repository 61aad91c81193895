//! Where two circles meet.

use atm_core::{Point2, Vector2};

use super::sight::Sight;

/// The points that lie on the arcs of both readings, within both beams: none, one or two, however flat they cross. Touching circles
/// meet in one point.
///
/// Arcs from one place are none: they are concentric, and the same one twice is no crossing.
pub fn common_points(a: &Sight, b: &Sight) -> impl Iterator<Item = Point2<f64>> + use<> {
    let (a, b) = (*a, *b);
    intersections(a.position, a.range, b.position, b.range)
        .into_iter()
        .flatten()
        .filter(move |&point| a.sees(point) && b.sees(point))
}

/// The points at `radius` from `center` and at `other_radius` from `other`.
fn intersections(center: Point2<f64>, radius: f64, other: Point2<f64>, other_radius: f64) -> [Option<Point2<f64>>; 2] {
    let between = other - center;
    let distance = between.norm();
    if !(distance > 0.0) {
        return [None; 2];
    }
    let along = (radius * radius - other_radius * other_radius + distance * distance) / (2.0 * distance);
    let aside_squared = radius * radius - along * along;
    if !(aside_squared >= 0.0) {
        return [None; 2];
    }
    let unit = between / distance;
    let aside = Vector2::new(-unit.y, unit.x) * libm::sqrt(aside_squared);
    let foot = center + unit * along;
    if aside_squared == 0.0 { [Some(foot), None] } else { [Some(foot + aside), Some(foot - aside)] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_four_five() {
        // Radii 5 around (0, 0) and (6, 0): both points are 3 along and 4 aside.
        let found = intersections(Point2::origin(), 5.0, Point2::new(6.0, 0.0), 5.0);
        assert_eq!(found, [Some(Point2::new(3.0, 4.0)), Some(Point2::new(3.0, -4.0))]);
    }

    #[test]
    fn touching_circles_meet_once_and_others_never() {
        let at = |x: f64| Point2::new(x, 0.0);
        assert_eq!(intersections(at(0.0), 1.0, at(3.0), 2.0), [Some(at(1.0)), None]);
        for (x, radius) in [(4.0, 2.0), (0.5, 0.25), (0.0, 1.0), (0.0, 2.0)] {
            assert_eq!(intersections(at(0.0), 1.0, at(x), radius), [None; 2], "{x} {radius}");
        }
    }
}

//! How much of an opening the points leave free.
use atm::units::inches;
use nalgebra::Point2;

/// A point counts as standing in an opening or on its jambs when it lies this near to the line between the jambs, in metres.
pub const DOORWAY_DEPTH: f64 = inches(12.0);
/// Such a point marks a jamb when it lies this near to it, measured along the line, in metres.
pub const JAMB_REACH: f64 = inches(6.0);

/// What the points say of one opening.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gap {
    /// The largest stretch of the line between the jambs that holds no point: from where to where, in metres from the first
    /// jamb.
    pub free: (f64, f64),
    /// Whether there are points at the first and at the second jamb.
    pub marked: [bool; 2],
}

impl Gap {
    /// What the `points` leave free between the two `jambs`.
    ///
    /// Points within [`DOORWAY_DEPTH`] of the line count; the jambs end the opening whether there are points on them or not. Of
    /// two stretches of one length it is the one nearer to the first jamb.
    pub fn between(jambs: [Point2<f64>; 2], points: &[Point2<f64>]) -> Self {
        let [from, to] = jambs;
        let (span, width) = (to - from, (to - from).norm());
        let along = span / width;
        let on_line = |point: &Point2<f64>| {
            let way = point - from;
            (along.perp(&way).abs() <= DOORWAY_DEPTH).then(|| along.dot(&way))
        };
        let places: Vec<f64> = points.iter().filter_map(on_line).collect();
        let at = |jamb: f64| places.iter().any(|place| (place - jamb).abs() <= JAMB_REACH);
        let mut stops: Vec<f64> = places.iter().copied().filter(|place| (0.0..=width).contains(place)).collect();
        stops.extend([0.0, width]);
        stops.sort_by(f64::total_cmp);
        let mut free = (0.0, 0.0);
        for (&a, &b) in stops.iter().zip(stops.iter().skip(1)) {
            if b - a > free.1 - free.0 {
                free = (a, b);
            }
        }
        Self { free, marked: [at(0.0), at(width)] }
    }

    /// The width of the doorway in metres: of the free stretch where both jambs are marked, else 0, so that a method that sees
    /// nothing has found no doorway.
    pub fn width(&self) -> f64 {
        if self.marked == [true; 2] { self.free.1 - self.free.0 } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const JAMBS: [Point2<f64>; 2] = [Point2::new(2.0, 3.0), Point2::new(3.0, 3.0)];

    fn gap(points: &[(f64, f64)]) -> Gap {
        let points: Vec<_> = points.iter().map(|&(x, y)| Point2::new(x, y)).collect();
        Gap::between(JAMBS, &points)
    }

    #[test]
    fn emptiness_and_one_jamb_alone_are_no_doorway() {
        assert_eq!(gap(&[]).width(), 0.0);
        assert_eq!(gap(&[(2.0, 3.0)]).width(), 0.0);
        assert_eq!(gap(&[(3.1, 3.0)]), Gap { free: (0.0, 1.0), marked: [false, true] });
    }

    #[test]
    fn both_jambs_marked_from_outside_leave_the_whole_opening() {
        assert!((gap(&[(1.9, 3.0), (3.1, 2.8)]).width() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn points_in_the_opening_cut_it_and_the_largest_stretch_counts() {
        // Stops at 0, 0.3, 0.4, 1: the largest stretch is the last, 0.6 m.
        let found = gap(&[(1.95, 3.0), (2.3, 3.2), (2.4, 2.9), (3.05, 3.0)]);
        assert!((found.width() - 0.6).abs() < 1e-12 && (found.free.0 - 0.4).abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn points_before_or_behind_the_opening_do_not_count() {
        // 12 in are 0.3048 m.
        let jambs = [(1.95, 3.0), (3.05, 3.0)];
        let with = |y: f64| gap(&[jambs[0], jambs[1], (2.5, y)]).width();
        assert!((with(3.304) - 0.5).abs() < 1e-12);
        assert!((with(3.306) - 1.0).abs() < 1e-12);
        assert!((with(2.694) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_jamb_is_marked_within_6_inches_along_the_wall() {
        // 6 in are 0.1524 m.
        assert_eq!(gap(&[(2.152, 3.0), (2.847, 3.0)]).marked, [true, false]);
        assert_eq!(gap(&[(1.848, 3.0), (3.153, 3.0)]).marked, [true, false]);
    }

    #[test]
    fn points_that_are_no_numbers_count_for_nothing() {
        assert_eq!(gap(&[(f64::NAN, 3.0), (2.5, f64::INFINITY), (1e300, 3.0)]).marked, [false; 2]);
    }
}

//! How far two methods say the same.

use std::collections::HashMap;

use atm_core::Point2;

/// Two points no farther apart than this say the same: 4 in, in metres.
pub const AGREES: f64 = 0.1016;

/// Points by the square of side [`AGREES`] that holds them.
pub struct Places<'a> {
    squares: HashMap<(i64, i64), Vec<&'a Point2<f64>>>,
}

fn square(point: &Point2<f64>) -> (i64, i64) {
    // Saturating: what is so far away is next to nothing.
    ((point.x / AGREES).floor() as i64, (point.y / AGREES).floor() as i64)
}

impl<'a> Places<'a> {
    /// These points.
    pub fn new(points: &'a [Point2<f64>]) -> Self {
        let mut squares: HashMap<(i64, i64), Vec<&Point2<f64>>> = HashMap::new();
        for point in points {
            squares.entry(square(point)).or_default().push(point);
        }
        Self { squares }
    }

    fn has_near(&self, point: &Point2<f64>) -> bool {
        let (column, row) = square(point);
        let around = (-1..=1).flat_map(|right| (-1..=1).map(move |up| (right, up)));
        let squares = around.map(|(right, up)| (column.saturating_add(right), row.saturating_add(up)));
        squares.filter_map(|square| self.squares.get(&square)).flatten().any(|other| (*other - point).norm() <= AGREES)
    }

    /// The share of `points` that has one of these within [`AGREES`]; `None` without points.
    pub fn share_near(&self, points: &[Point2<f64>]) -> Option<f64> {
        let near = points.iter().filter(|point| self.has_near(point)).count();
        (!points.is_empty()).then(|| near as f64 / points.len() as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_is_across_the_edges_of_squares_and_no_farther_than_four_inches() {
        let places = [Point2::new(0.0, 0.0), Point2::new(5.0, 5.0)];
        let places = Places::new(&places);
        let at = |x: f64, y: f64| Point2::new(x, y);
        assert_eq!(places.share_near(&[at(-0.05, -0.05), at(0.1016, 0.0), at(0.0, 0.11), at(0.08, 0.08)]), Some(0.5));
        assert_eq!(places.share_near(&[]), None);
    }
}

//! Whether any of many points lies near a place.
use nalgebra::Point2;

/// Points sorted into square cells, so that those near a place are found without looking at all of them.
#[derive(Debug, Clone)]
pub(super) struct Nearness {
    /// Side of a cell and largest distance that is near, in metres.
    reach: f64,
    /// By cell.
    points: Vec<((i64, i64), Point2<f64>)>,
}

impl Nearness {
    /// Points that are near to within `reach` metres, above 0.
    pub(super) fn new(points: impl IntoIterator<Item = Point2<f64>>, reach: f64) -> Self {
        let mut points: Vec<_> = points.into_iter().map(|point| (cell(point, reach), point)).collect();
        points.sort_by_key(|(cell, _)| *cell);
        Self { reach, points }
    }

    /// Whether some point lies within reach of the place, border included.
    pub(super) fn any(&self, place: Point2<f64>) -> bool {
        let (x, y) = cell(place, self.reach);
        (-1..=1).any(|step| {
            let column = x.saturating_add(step);
            let first = (column, y.saturating_sub(1));
            let from = self.points.partition_point(|(cell, _)| *cell < first);
            let near = self.points.iter().skip(from).take_while(|(cell, _)| *cell <= (column, y.saturating_add(1)));
            near.into_iter().any(|(_, point)| (point - place).norm() <= self.reach)
        })
    }
}

/// Coordinates beyond all whole numbers share the last cell.
fn cell(point: Point2<f64>, side: f64) -> (i64, i64) {
    ((point.x / side).floor() as i64, (point.y / side).floor() as i64)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]
        #[test]
        fn finds_what_looking_at_all_points_finds(
            points in prop::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64), 0..30),
            x in -1.2..1.2_f64, y in -1.2..1.2_f64, reach in 0.01..0.6_f64,
        ) {
            let points: Vec<_> = points.into_iter().map(|(x, y)| Point2::new(x, y)).collect();
            let place = Point2::new(x, y);
            let expected = points.iter().any(|point| nalgebra::distance(point, &place) <= reach);
            prop_assert_eq!(Nearness::new(points, reach).any(place), expected);
        }
    }

    #[test]
    fn places_beyond_all_cells_are_no_trouble() {
        let points = Nearness::new([Point2::new(1e300, -1e300), Point2::new(0.0, 0.0)], 0.1);
        assert!(points.any(Point2::new(0.1, 0.0)) && points.any(Point2::new(1e300, -1e300)));
        assert!(!points.any(Point2::new(-1e300, 1e300)) && !points.any(Point2::new(f64::NAN, 0.0)));
    }
}

//! How spread out a map is.

use std::collections::BTreeMap;

use atm::error::Result;
use atm_core::Point2;

use super::grid::{Cell, Grid};

/// The Shannon entropy, in bits, of how `points` are distributed over cells of `resolution` metres: 2 to that power is the
/// number of cells that hold as much as all of them would if they held it evenly.
///
/// A method that says the same with fewer places has less of it. From one cell size to half of it points alone gain nothing,
/// lines one bit, filled areas two. `None` without points.
///
/// # Errors
/// A point too far from the origin for a grid, and what [`Grid::new`] refuses.
pub fn spread_bits(points: impl IntoIterator<Item = Point2<f64>>, resolution: f64) -> Result<Option<f64>> {
    let lattice = Grid::new(resolution, Point2::origin(), ())?;
    let mut counts: BTreeMap<Cell, u64> = BTreeMap::new();
    let mut total = 0u64;
    for point in points {
        *counts.entry(lattice.cell(point)?).or_default() += 1;
        total += 1;
    }
    // −Σ p log2 p with p = n / N is log2 N − Σ n log2 n / N.
    let weighted: f64 = counts.values().map(|&count| count as f64 * libm::log2(count as f64)).sum();
    Ok((total > 0).then(|| libm::log2(total as f64) - weighted / total as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn evenly_filled_cells_have_the_logarithm_of_their_number() {
        let line: Vec<Point2<f64>> = (0..16).map(|step| Point2::new(0.025 + 0.05 * f64::from(step), 0.01)).collect();
        assert_eq!(spread_bits(line.iter().copied(), 0.05).unwrap(), Some(4.0));
        assert_eq!(spread_bits(line, 0.1).unwrap(), Some(3.0), "a line loses one bit with twice the width");
    }

    #[test]
    fn one_place_has_none_and_no_place_is_no_number() {
        assert_eq!(spread_bits([Point2::new(1.0, 1.0); 5], 0.05).unwrap(), Some(0.0));
        assert_eq!(spread_bits([], 0.05).unwrap(), None);
    }

    #[test]
    fn three_quarters_and_one_quarter() {
        // ¾ log2(4/3) + ¼ log2 4 = 0.8113.
        let points = [0.0, 0.0, 0.0, 1.0].map(|x| Point2::new(x, 0.0));
        let bits = spread_bits(points, 0.5).unwrap().unwrap();
        assert!((bits - 0.811_278).abs() < 1e-6, "{bits}");
    }
}

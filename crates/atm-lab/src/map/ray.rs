//! The cells along a straight line.

use atm::error::Result;
use atm_core::Point2;

use super::grid::{Cell, Grid};

/// The cells that a line crosses, from the one that holds its beginning to the one that holds its end
/// (Amanatides and Woo, *A Fast Voxel Traversal Algorithm for Ray Tracing*, Eurographics 1987).
#[derive(Debug, Clone)]
pub struct Ray {
    next: Option<Cell>,
    end: Cell,
    /// Share of the line at which it leaves the cell, across a column's and a row's edge.
    leave: [f64; 2],
    /// Share of the line across one column and across one row.
    across: [f64; 2],
    forward: [bool; 2],
}

impl Ray {
    /// The cells of `grid` from `from` to `to`.
    ///
    /// # Errors
    /// An end that the grid can't reach.
    pub fn new<T: Copy>(grid: &Grid<T>, from: Point2<f64>, to: Point2<f64>) -> Result<Self> {
        let (first, end) = (grid.cell(from)?, grid.cell(to)?);
        let along = to - from;
        let corner = grid.corner(first);
        let resolution = grid.resolution();
        let leave = |along: f64, corner: f64, from: f64| {
            let edge = if along > 0.0 { corner + resolution } else { corner };
            if along == 0.0 { f64::INFINITY } else { (edge - from) / along }
        };
        Ok(Self {
            next: Some(first),
            end,
            leave: [leave(along.x, corner.x, from.x), leave(along.y, corner.y, from.y)],
            across: [resolution / along.x.abs(), resolution / along.y.abs()],
            forward: [along.x > 0.0, along.y > 0.0],
        })
    }
}

impl Iterator for Ray {
    type Item = Cell;

    fn next(&mut self) -> Option<Cell> {
        let cell = self.next?;
        let left = |index: i32, end: i32, forward: bool| if forward { index < end } else { index > end };
        let columns = left(cell.column, self.end.column, self.forward[0]);
        let rows = left(cell.row, self.end.row, self.forward[1]);
        let step = |index: i32, forward: bool| if forward { index + 1 } else { index - 1 };
        self.next = match (columns, rows) {
            (false, false) => None,
            (true, _) if !rows || self.leave[0] <= self.leave[1] => {
                self.leave[0] += self.across[0];
                Some(Cell { column: step(cell.column, self.forward[0]), ..cell })
            }
            _ => {
                self.leave[1] += self.across[1];
                Some(Cell { row: step(cell.row, self.forward[1]), ..cell })
            }
        };
        Some(cell)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_holds_the_cells_of_finely_spaced_points_and_steps_by_edges() {
        let grid = Grid::new(0.1, Point2::origin(), ()).unwrap();
        for (to_x, to_y) in [(1.0, 0.33), (-0.7, 0.9), (0.05, -1.2), (-1.0, -0.01), (0.0, 0.0)] {
            let (from, to) = (Point2::new(0.051, 0.047), Point2::new(to_x, to_y));
            let cells: Vec<Cell> = Ray::new(&grid, from, to).unwrap().collect();
            for step in 0..=1000 {
                let point = from + (to - from) * (f64::from(step) / 1000.0);
                assert!(cells.contains(&grid.cell(point).unwrap()), "{to:?} {point:?}");
            }
            for pair in cells.windows(2) {
                assert_eq!((pair[0].row - pair[1].row).abs() + (pair[0].column - pair[1].column).abs(), 1);
            }
            assert_eq!(cells.last(), Some(&grid.cell(to).unwrap()));
        }
    }
}

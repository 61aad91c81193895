//! Square cells over the plane, held in blocks where something was written.

use atm::error::{Error, Result};
use atm_core::Point2;

/// Cells along one side of a block.
const SIDE: i32 = 64;
/// Cells in a block.
const BLOCK: usize = (SIDE * SIDE) as usize;
/// Most blocks that a grid holds: 16.8 million cells, 205 m × 205 m of 5 cm all written.
const MAX_BLOCKS: usize = 4096;
/// Most blocks that the rectangle around a grid holds, written or not: 6.5 km × 6.5 km of 5 cm.
const MAX_RECTANGLE: u64 = 1 << 22;

/// A cell by its place in the lattice: the cell (0, 0) has the origin as its lower left corner.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Cell {
    /// Row, counted along +y.
    pub row: i32,
    /// Column, counted along +x.
    pub column: i32,
}

/// Square cells over the plane, all of them holding `unknown` until they are written.
///
/// It grows by blocks of 64 × 64 cells where cells are written, so that a long path costs what lies along it.
#[derive(Debug, Clone)]
pub struct Grid<T> {
    resolution: f64,
    origin: Point2<f64>,
    unknown: T,
    /// Lower left block of the rectangle, as (row, column) of blocks.
    corner: (i32, i32),
    /// The rectangle's rows and columns of blocks.
    size: (i32, i32),
    /// The rectangle's blocks, row by row; `None` where nothing was written.
    blocks: Vec<Option<Box<[T]>>>,
    written: usize,
}

impl<T: Copy> Grid<T> {
    /// An empty grid of cells `resolution` metres wide, with a corner of cells at `origin`; cells that nobody writes are
    /// `unknown`.
    ///
    /// # Errors
    /// A resolution that is not positive and finite.
    pub fn new(resolution: f64, origin: Point2<f64>, unknown: T) -> Result<Self> {
        if !(resolution > 0.0 && resolution.is_finite()) {
            return Err(Error::Map { message: format!("a cell can't be {resolution} m wide") });
        }
        Ok(Self { resolution, origin, unknown, corner: (0, 0), size: (0, 0), blocks: Vec::new(), written: 0 })
    }

    /// Width of a cell, in metres.
    pub const fn resolution(&self) -> f64 {
        self.resolution
    }

    /// What an unwritten cell holds.
    pub const fn unknown(&self) -> T {
        self.unknown
    }

    /// The cell that holds `point`; its lower and left edges belong to it.
    ///
    /// # Errors
    /// A point more than 2³⁰ cells from the origin, or not finite.
    pub fn cell(&self, point: Point2<f64>) -> Result<Cell> {
        let scaled = (point - self.origin) / self.resolution;
        let index = |value: f64| {
            let floor = libm::floor(value);
            (floor.abs() <= f64::from(1 << 30)).then_some(floor as i32)
        };
        match (index(scaled.y), index(scaled.x)) {
            (Some(row), Some(column)) => Ok(Cell { row, column }),
            _ => Err(Error::Map {
                message: format!(
                    "({}, {}) is too far from the origin for a map with cells of {} m",
                    point.x, point.y, self.resolution
                ),
            }),
        }
    }

    /// The middle of a cell.
    pub fn center(&self, cell: Cell) -> Point2<f64> {
        let at = |index: i32| (f64::from(index) + 0.5) * self.resolution;
        Point2::new(self.origin.x + at(cell.column), self.origin.y + at(cell.row))
    }

    /// The lower left corner of a cell.
    pub fn corner(&self, cell: Cell) -> Point2<f64> {
        let at = |index: i32| f64::from(index) * self.resolution;
        Point2::new(self.origin.x + at(cell.column), self.origin.y + at(cell.row))
    }

    /// What a cell holds.
    #[inline]
    pub fn get(&self, cell: Cell) -> T {
        self.place(cell)
            .and_then(|(block, within)| self.blocks.get(block)?.as_ref()?.get(within).copied())
            .unwrap_or(self.unknown)
    }

    /// A cell to write to.
    ///
    /// # Errors
    /// The grid would grow beyond 16.8 million cells, or its blocks lie too far apart.
    #[inline]
    pub fn get_mut(&mut self, cell: Cell) -> Result<&mut T> {
        let (block, within) = match self.place(cell) {
            Some((block, within)) if matches!(self.blocks.get(block), Some(Some(_))) => (block, within),
            _ => self.make_room(cell)?,
        };
        let resolution = self.resolution;
        let found = self.blocks.get_mut(block).and_then(Option::as_mut).and_then(|cells| cells.get_mut(within));
        found.ok_or_else(|| too_large(resolution))
    }

    /// The cells of all written blocks, in an order that depends on nothing but which blocks those are.
    pub fn cells(&self) -> impl Iterator<Item = (Cell, T)> + '_ {
        let (rows, columns) = self.size;
        let places = (0..rows).flat_map(move |row| (0..columns).map(move |column| (row, column)));
        places.zip(&self.blocks).filter_map(|(place, cells)| Some((place, cells.as_ref()?))).flat_map(
            move |((block_row, block_column), cells)| {
                let first_row = (self.corner.0 + block_row) * SIDE;
                let first_column = (self.corner.1 + block_column) * SIDE;
                let within = (0..SIDE).flat_map(|row| (0..SIDE).map(move |column| (row, column)));
                within.zip(cells.iter()).map(move |((row, column), &value)| {
                    (Cell { row: first_row + row, column: first_column + column }, value)
                })
            },
        )
    }

    /// Index of a cell's block in the rectangle and of the cell in its block, where the rectangle reaches that far.
    #[inline]
    fn place(&self, cell: Cell) -> Option<(usize, usize)> {
        let row = cell.row.div_euclid(SIDE) - self.corner.0;
        let column = cell.column.div_euclid(SIDE) - self.corner.1;
        if !((0..self.size.0).contains(&row) && (0..self.size.1).contains(&column)) {
            return None;
        }
        let block = usize::try_from(row).ok()? * usize::try_from(self.size.1).ok()? + usize::try_from(column).ok()?;
        let within = cell.row.rem_euclid(SIDE) * SIDE + cell.column.rem_euclid(SIDE);
        Some((block, usize::try_from(within).ok()?))
    }

    /// Makes the block of `cell`, in a rectangle that is widened to hold it.
    #[cold]
    fn make_room(&mut self, cell: Cell) -> Result<(usize, usize)> {
        self.widen(cell.row.div_euclid(SIDE), cell.column.div_euclid(SIDE))?;
        if self.written >= MAX_BLOCKS {
            return Err(too_large(self.resolution));
        }
        let unknown = self.unknown;
        let (block, within) = self.place(cell).ok_or_else(|| too_large(self.resolution))?;
        if let Some(slot) = self.blocks.get_mut(block) {
            *slot = Some(vec![unknown; BLOCK].into_boxed_slice());
            self.written += 1;
        }
        Ok((block, within))
    }

    /// Widens the rectangle so that it holds the block at (`row`, `column`).
    fn widen(&mut self, row: i32, column: i32) -> Result<()> {
        let empty = self.blocks.is_empty();
        let spanned = |first: i32, count: i32, new: i32| {
            if empty { (new, new + 1) } else { (first.min(new), (first + count).max(new + 1)) }
        };
        let (top, bottom) = spanned(self.corner.0, self.size.0, row);
        let (left, right) = spanned(self.corner.1, self.size.1, column);
        let (rows, columns) = (bottom - top, right - left);
        if u64::from(rows.unsigned_abs()) * u64::from(columns.unsigned_abs()) > MAX_RECTANGLE {
            return Err(too_large(self.resolution));
        }
        if (rows, columns) == self.size {
            return Ok(());
        }
        let mut wider: Vec<Option<Box<[T]>>> = Vec::new();
        wider.resize_with((rows as usize) * (columns as usize), || None);
        let width = self.size.1.max(1) as usize;
        for (index, block) in self.blocks.drain(..).enumerate() {
            let row = (index / width) as i32 + self.corner.0 - top;
            let column = (index % width) as i32 + self.corner.1 - left;
            if let Some(slot) = wider.get_mut((row as usize) * (columns as usize) + column as usize) {
                *slot = block;
            }
        }
        (self.corner, self.size, self.blocks) = ((top, left), (rows, columns), wider);
        Ok(())
    }
}

#[cold]
fn too_large(resolution: f64) -> Error {
    let millions = MAX_BLOCKS * BLOCK / 1_000_000;
    Error::Map { message: format!("the map grows beyond {millions} million cells of {resolution} m; take wider cells") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> Grid<i32> {
        Grid::new(0.5, Point2::new(1.0, -1.0), -7).unwrap()
    }

    #[test]
    fn cells_count_from_the_origin_and_own_their_lower_edges() {
        // Cells of 0.5 m from (1, −1): x = 2.25 is 2.5 cells in, y = −1.01 just below the first row.
        let grid = grid();
        assert_eq!(grid.cell(Point2::new(2.25, -1.01)).unwrap(), Cell { row: -1, column: 2 });
        assert_eq!(grid.cell(Point2::new(1.5, -1.0)).unwrap(), Cell { row: 0, column: 1 });
        assert_eq!(grid.center(Cell { row: -1, column: 2 }), Point2::new(2.25, -1.25));
        assert_eq!(grid.corner(Cell { row: -1, column: 2 }), Point2::new(2.0, -1.5));
    }

    #[test]
    fn what_is_written_stays_while_the_grid_grows_to_all_sides() {
        let mut grid = grid();
        let cells = [(0, 0), (-1, -1), (500, -300), (-200, 900), (63, 64), (64, 63)];
        for (value, (row, column)) in cells.into_iter().enumerate() {
            *grid.get_mut(Cell { row, column }).unwrap() = value as i32;
        }
        for (value, (row, column)) in cells.into_iter().enumerate() {
            assert_eq!(grid.get(Cell { row, column }), value as i32, "{row} {column}");
        }
        assert_eq!(grid.get(Cell { row: 1, column: 1 }), -7, "unwritten in a written block");
        assert_eq!(grid.get(Cell { row: 5000, column: 5000 }), -7, "outside");
        let mut listed: Vec<i32> = grid.cells().map(|(_, value)| value).filter(|&value| value != -7).collect();
        listed.sort_unstable();
        assert_eq!(listed, [0, 1, 2, 3, 4, 5]);
        assert!(grid.cells().all(|(cell, value)| grid.get(cell) == value));
    }

    #[test]
    fn growth_is_bounded_and_says_so() {
        let mut grid = grid();
        *grid.get_mut(Cell { row: 0, column: 0 }).unwrap() = 1;
        let error = grid.get_mut(Cell { row: 1 << 29, column: 1 << 29 }).unwrap_err();
        assert!(error.to_string().contains("take wider cells"), "{error}");
        assert!(grid.cell(Point2::new(1e12, 0.0)).is_err());
        assert!(grid.cell(Point2::new(f64::NAN, 0.0)).is_err());
        let filled =
            (0..=MAX_BLOCKS as i32).find_map(|block| grid.get_mut(Cell { row: 0, column: block * SIDE }).err());
        assert!(filled.is_some());
    }

    #[test]
    fn a_cell_has_a_width() {
        assert!(Grid::new(0.0, Point2::origin(), 0).is_err());
        assert!(Grid::new(f64::NAN, Point2::origin(), 0).is_err());
    }
}

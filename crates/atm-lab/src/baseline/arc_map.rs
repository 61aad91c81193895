//! The arc map: how many arcs pass over each cell (Barshan and Başkent, *Comparison of Two Methods of Surface Profile Extraction from
//! Multiple Ultrasonic Range Measurements*, Measurement Science and Technology 11, 2000).

use atm::error::Result;
use atm_core::Point2;

use super::Sight;
use crate::map::{Cell, Grid};

/// Cells with the number of arcs drawn over them.
#[derive(Debug)]
pub struct ArcMap {
    /// The numbers; NaN where there is no arc.
    pub grid: Grid<f64>,
}

impl ArcMap {
    /// A map of cells `cell` metres wide, without arcs.
    pub fn new(cell: f64) -> Result<Self> {
        Ok(Self { grid: Grid::new(cell, Point2::origin(), f64::NAN)? })
    }

    /// Draws an arc.
    pub fn draw(&mut self, sight: &Sight) -> Result<()> {
        for cell in arc_cells(&mut self.grid, sight)? {
            let votes = self.grid.get_mut(cell)?;
            *votes = if votes.is_nan() { 1.0 } else { *votes + 1.0 };
        }
        Ok(())
    }
}

/// An arc drawn one cell wide: the cells within the beam whose middles are no more than half a cell off it, and the cell of its centre
/// where it is too short for any.
pub fn arc_cells<T: Copy>(grid: &mut Grid<T>, sight: &Sight) -> Result<Vec<Cell>> {
    let half = grid.resolution() / 2.0;
    let mut cells = Vec::new();
    sight.footprint().cells(grid, sight.range - half, sight.range + half, |_, at| {
        cells.push(at.cell);
        Ok(())
    })?;
    if cells.is_empty() {
        cells.push(grid.cell(sight.middle())?);
    }
    Ok(cells)
}

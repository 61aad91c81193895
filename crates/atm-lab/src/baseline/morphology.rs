//! Morphological processing of the arc map (Başkent and Barshan, *Surface Profile Determination from Multiple Sonar Data Using
//! Morphological Processing*, International Journal of Robotics Research 18(8), 1999).

use atm::error::Result;
use atm_core::{Point2, Reading};

use super::{Evidence, Findings, Method, Sight, arc_map::ArcMap};
use crate::map::{Cell, Grid};

/// The arc map as black and white, pruned: a cell stays where enough of its eight neighbours have an arc, too. Where arcs
/// crowd they thicken each other; a lone arc has no more than its own line beside a cell.
#[derive(Debug)]
pub struct Morphology {
    map: ArcMap,
}

impl Morphology {
    /// A cell stays with five of eight neighbours, that is, above this number.
    const OCCUPIED_ABOVE: f64 = 4.5;

    /// A map of cells `cell` metres wide.
    ///
    /// # Errors
    /// As [`Grid::new`].
    pub fn new(cell: f64) -> Result<Self> {
        Ok(Self { map: ArcMap::new(cell)? })
    }

    fn neighbours(&self, cell: Cell) -> usize {
        let around = (-1..=1).flat_map(|row| (-1..=1).map(move |column| (row, column)));
        let set =
            |(row, column)| !self.map.grid.get(Cell { row: cell.row + row, column: cell.column + column }).is_nan();
        around.filter(|&place| place != (0, 0) && set(place)).count()
    }
}

impl Method for Morphology {
    fn take(&mut self, reading: &Reading<f64>) -> Result<()> {
        Sight::new(reading).map_or(Ok(()), |sight| self.map.draw(&sight))
    }

    fn finish(self: Box<Self>) -> Result<Option<Findings>> {
        let mut grid = Grid::new(self.map.grid.resolution(), Point2::origin(), f64::NAN)?;
        for (cell, _) in self.map.grid.cells().filter(|(_, votes)| !votes.is_nan()) {
            *grid.get_mut(cell)? = self.neighbours(cell) as f64;
        }
        let occupied_above = Self::OCCUPIED_ABOVE;
        Ok(Some(Findings::map(Evidence { grid, occupied_above, free_below: f64::NEG_INFINITY })))
    }
}

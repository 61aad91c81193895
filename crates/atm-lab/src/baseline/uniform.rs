//! The uniform arc grid (Sec. II-C): the echo is equally likely anywhere on the arc, and nothing is nearer.

use atm::error::Result;
use atm_core::{Limits, Meaning, Point2, Reading};

use super::{Evidence, Findings, Method, Sight, arc_map::arc_cells, sight::freed};
use crate::map::Grid;

/// What a cell was told: the mass of the arcs on it, and how often it was inside of one.
#[derive(Debug, Clone, Copy, Default)]
struct Told {
    mass: f64,
    free: f64,
}

/// An occupancy grid in which a reading spreads a mass of 1 evenly over the n cells on its arc, 1/n each, and says of each cell
/// inside the arc that it is free, with a mass of 1. A cell's evidence is occupied mass / (occupied + free mass).
#[derive(Debug)]
pub struct UniformArcs {
    grid: Grid<Told>,
    limits: Vec<Limits<f64>>,
}

impl UniformArcs {
    /// A cell is occupied where more mass says so than says free.
    const OCCUPIED: f64 = 0.5;

    /// A grid of cells `cell` metres wide, for sensors with these `limits`: what is beyond the largest range leaves free space up to
    /// there.
    ///
    /// # Errors
    /// As [`Grid::new`].
    pub fn new(cell: f64, limits: Vec<Limits<f64>>) -> Result<Self> {
        Ok(Self { grid: Grid::new(cell, Point2::origin(), Told::default())?, limits })
    }

    fn free(&mut self, reading: &Reading<f64>, to: f64) -> Result<()> {
        freed(reading).cells(&mut self.grid, 0.0, to, |grid, at| {
            grid.get_mut(at.cell)?.free += 1.0;
            Ok(())
        })
    }

    fn spread(&mut self, sight: &Sight) -> Result<()> {
        let cells = arc_cells(&mut self.grid, sight)?;
        let share = 1.0 / cells.len() as f64;
        for cell in cells {
            self.grid.get_mut(cell)?.mass += share;
        }
        Ok(())
    }
}

impl Method for UniformArcs {
    fn take(&mut self, reading: &Reading<f64>) -> Result<()> {
        let half = self.grid.resolution() / 2.0;
        if let Some(sight) = Sight::new(reading) {
            // The arc's own cells, and what half a step of the range may hide, are not inside.
            self.free(reading, (sight.range - half.max(sight.resolution / 2.0)).next_down())?;
            return self.spread(&sight);
        }
        match self.limits.get(usize::from(reading.sensor)).map(Limits::max) {
            Some(reach) if reading.range.meaning() == Meaning::Beyond && reach.is_finite() => self.free(reading, reach),
            _ => Ok(()),
        }
    }

    fn finish(self: Box<Self>) -> Result<Option<Findings>> {
        let mut grid = Grid::new(self.grid.resolution(), Point2::origin(), f64::NAN)?;
        for (cell, told) in self.grid.cells().filter(|(_, told)| told.mass + told.free > 0.0) {
            *grid.get_mut(cell)? = told.mass / (told.mass + told.free);
        }
        Ok(Some(Findings::map(Evidence { grid, occupied_above: Self::OCCUPIED, free_below: Self::OCCUPIED })))
    }
}

//! Histogramic in-motion mapping (Borenstein and Koren, *Histogramic In-Motion Mapping for Mobile Robot Obstacle Avoidance*, IEEE
//! Transactions on Robotics and Automation 7(4), 1991; Sec. II-A).

use atm::error::Result;
use atm_core::{Limits, Meaning, Point2, Reading};

use super::{Evidence, Findings, Method, Sight, sight::freed};
use crate::map::{Cell, Grid, Ray};

/// A histogram grid of which a reading touches the cells on its axis alone: − 1 for each up to the echo, + 3 for the one with the echo,
/// all within \[0, 15\]. The cell that was raised then takes the growth rate operator, the sum of itself and half of each of its
/// eight neighbours, so that cells in clusters grow faster.
#[derive(Debug)]
pub struct Himm {
    /// NaN where no axis passed; that counts as 0.
    grid: Grid<f64>,
    limits: Vec<Limits<f64>>,
}

impl Himm {
    /// Width of its cells, in metres.
    pub const CELL: f64 = 0.1;
    /// What the cell of an echo is raised by.
    const RAISE: f64 = 3.0;
    /// What the cells before it are lowered by.
    const LOWER: f64 = 1.0;
    /// The largest value; the smallest is 0.
    const MOST: f64 = 15.0;
    /// The operator's weight of a neighbour; the cell itself has 1.
    const NEIGHBOUR: f64 = 0.5;
    /// An obstacle has 8 or more; values are multiples of ½.
    const OCCUPIED_ABOVE: f64 = 7.75;

    /// A grid of cells `cell` metres wide, for sensors with these `limits`.
    ///
    /// # Errors
    /// As [`Grid::new`].
    pub fn new(cell: f64, limits: Vec<Limits<f64>>) -> Result<Self> {
        Ok(Self { grid: Grid::new(cell, Point2::origin(), f64::NAN)?, limits })
    }

    fn value(&self, cell: Cell) -> f64 {
        let value = self.grid.get(cell);
        if value.is_nan() { 0.0 } else { value }
    }

    /// Lowers the cells along the axis up to `to`, but not `echo`.
    fn lower(&mut self, from: Point2<f64>, to: Point2<f64>, echo: Option<Cell>) -> Result<()> {
        for cell in Ray::new(&self.grid, from, to)?.filter(|&cell| Some(cell) != echo) {
            *self.grid.get_mut(cell)? = (self.value(cell) - Self::LOWER).max(0.0);
        }
        Ok(())
    }

    fn raise(&mut self, echo: Cell) -> Result<()> {
        let around = (-1..=1).flat_map(|row| (-1..=1).map(move |column| (row, column)));
        let neighbours: f64 = around
            .filter(|&place| place != (0, 0))
            .map(|(row, column)| self.value(Cell { row: echo.row + row, column: echo.column + column }))
            .sum();
        let raised = (self.value(echo) + Self::RAISE).min(Self::MOST);
        *self.grid.get_mut(echo)? = (raised + Self::NEIGHBOUR * neighbours).min(Self::MOST);
        Ok(())
    }
}

impl Method for Himm {
    fn take(&mut self, reading: &Reading<f64>) -> Result<()> {
        if let Some(sight) = Sight::new(reading) {
            let echo = self.grid.cell(sight.middle())?;
            self.lower(sight.position, sight.middle(), Some(echo))?;
            return self.raise(echo);
        }
        match self.limits.get(usize::from(reading.sensor)).map(Limits::max) {
            Some(reach) if reading.range.meaning() == Meaning::Beyond && reach.is_finite() => {
                let axis = freed(reading);
                self.lower(axis.sensor, axis.sensor + axis.boresight * reach, None)
            }
            _ => Ok(()),
        }
    }

    fn finish(self: Box<Self>) -> Result<Option<Findings>> {
        let evidence = Evidence { grid: self.grid, occupied_above: Self::OCCUPIED_ABOVE, free_below: Self::LOWER };
        Ok(Some(Findings::map(evidence)))
    }
}

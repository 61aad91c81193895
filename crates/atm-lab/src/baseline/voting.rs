//! Voting and thresholding (Barshan, *Ultrasonic Surface Profile Determination by Spatial Voting*, IEEE Instrumentation and
//! Measurement Technology Conference, 2001).

use atm::error::Result;
use atm_core::Reading;

use super::{Evidence, Findings, Method, Sight, arc_map::ArcMap};

/// Every arc votes for the cells it passes over; cells with enough votes are occupied. Neighbours don't matter.
#[derive(Debug)]
pub struct Voting {
    map: ArcMap,
}

impl Voting {
    /// Three arcs, as many as make a median, are enough.
    const OCCUPIED_ABOVE: f64 = 2.5;

    /// A map of cells `cell` metres wide.
    ///
    /// # Errors
    /// As [`crate::map::Grid::new`].
    pub fn new(cell: f64) -> Result<Self> {
        Ok(Self { map: ArcMap::new(cell)? })
    }
}

impl Method for Voting {
    fn take(&mut self, reading: &Reading<f64>) -> Result<()> {
        Sight::new(reading).map_or(Ok(()), |sight| self.map.draw(&sight))
    }

    fn finish(self: Box<Self>) -> Result<Option<Findings>> {
        let (grid, occupied_above) = (self.map.grid, Self::OCCUPIED_ABOVE);
        Ok(Some(Findings::map(Evidence { grid, occupied_above, free_below: f64::NEG_INFINITY })))
    }
}

//! The centerline model: the echo is where the boresight meets the arc (Sec. II-A).

use atm::error::Result;
use atm_core::Reading;

use super::{Findings, Mark, Method, Sight};

/// Every reading gives the centre of its arc: sensor + r (cos ψ, sin ψ). It remembers nothing.
#[derive(Debug, Default)]
pub struct Centerline {
    points: Vec<Mark>,
}

impl Method for Centerline {
    fn take(&mut self, reading: &Reading<f64>) -> Result<()> {
        self.points.extend(Sight::new(reading).map(|sight| Mark::of(&sight, sight.middle())));
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<Option<Findings>> {
        Ok(Some(Findings::points(self.points)))
    }
}

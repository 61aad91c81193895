//! Plain arc intersections: something stands wherever two arcs cross (Sec. III-A; Fig. 14 shows why not).

use atm::error::{Error, Result};
use atm_core::Reading;

use super::{Findings, Mark, Method, Sight, circles::common_points, history::History};

/// Every point on two arcs of the local map and within both beams, at whatever angle they cross: the local map of the paper
/// without transversality and without the median. A point speaks of the later reading.
#[derive(Debug, Default)]
pub struct Intersections {
    history: History,
    points: Vec<Mark>,
}

/// Most points that are kept.
const MOST_POINTS: usize = 1 << 24;

impl Method for Intersections {
    fn take(&mut self, reading: &Reading<f64>) -> Result<()> {
        if let Some(sight) = Sight::new(reading) {
            for earlier in self.history.newest_first() {
                self.points.extend(common_points(&sight, earlier).map(|point| Mark::of(&sight, point)));
            }
            if self.points.len() > MOST_POINTS {
                return Err(Error::Map { message: format!("more than {MOST_POINTS} intersections") });
            }
        }
        self.history.enter(reading);
        Ok(())
    }

    fn clock_reset(&mut self) {
        self.history.clear();
    }

    fn finish(self: Box<Self>) -> Result<Option<Findings>> {
        Ok(Some(Findings::points(self.points)))
    }
}

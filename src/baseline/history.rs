//! The last readings of every sensor that had an echo.

use std::collections::{BTreeMap, VecDeque};

use atm_core::Reading;

use super::{HISTORY, sight::Sight};

/// The last [`HISTORY`] readings of each sensor. Readings without an echo take their slot all the same: slots are time.
#[derive(Debug, Default)]
pub struct History {
    rings: BTreeMap<u16, VecDeque<(u64, Option<Sight>)>>,
    arrivals: u64,
}

impl History {
    /// Puts a reading in; its sensor's oldest goes.
    pub fn enter(&mut self, reading: &Reading<f64>) {
        let ring = self.rings.entry(reading.sensor).or_default();
        if ring.len() >= HISTORY {
            ring.pop_front();
        }
        ring.push_back((self.arrivals, Sight::new(reading)));
        self.arrivals += 1;
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.rings.clear();
    }

    /// The echoes in it, the latest arrival first.
    pub fn newest_first(&self) -> Vec<Sight> {
        let mut sights: Vec<(u64, Sight)> =
            self.rings.values().flatten().filter_map(|&(arrival, sight)| Some((arrival, sight?))).collect();
        sights.sort_unstable_by_key(|&(arrival, _)| std::cmp::Reverse(arrival));
        sights.into_iter().map(|(_, sight)| sight).collect()
    }
}

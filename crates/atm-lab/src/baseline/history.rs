//! The last readings of every sensor that had an echo.

use std::collections::BTreeMap;

use atm_core::Reading;

use super::{HISTORY, sight::Sight};

/// The last [`HISTORY`] readings of each sensor. Readings without an echo take their slot all the same: slots are time.
#[derive(Debug, Default)]
pub struct History {
    /// In order of arrival, with their sensors.
    entries: Vec<(u16, Option<Sight>)>,
    /// How many each sensor has.
    counts: BTreeMap<u16, usize>,
}

impl History {
    /// Puts a reading in; its sensor's oldest goes where there are too many.
    pub fn enter(&mut self, reading: &Reading<f64>) {
        let count = self.counts.entry(reading.sensor).or_default();
        if *count < HISTORY {
            *count += 1;
        } else if let Some(oldest) = self.entries.iter().position(|(sensor, _)| *sensor == reading.sensor) {
            self.entries.remove(oldest);
        }
        self.entries.push((reading.sensor, Sight::new(reading)));
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.entries.clear();
        self.counts.clear();
    }

    /// The echoes in it, the latest arrival first.
    pub fn newest_first(&self) -> impl Iterator<Item = &Sight> {
        self.entries.iter().rev().filter_map(|(_, sight)| sight.as_ref())
    }
}

#[cfg(test)]
mod tests {
    use atm_core::{Beam, Isometry2, Limits, Point2, RangeResolution, Vector2};

    use super::*;

    #[test]
    fn a_sensor_keeps_ten_slots_whatever_the_others_do_and_whether_there_was_an_echo() {
        let reading = |t: i64, sensor: u16, range: f64| Reading {
            t,
            sensor,
            range: Limits::NONE.classify(range),
            pose: Isometry2::new(Vector2::zeros(), 0.0),
            robot: Point2::origin(),
            beam: Beam::new(0.4).unwrap(),
            range_resolution: RangeResolution::new(0.01).unwrap(),
        };
        let mut history = History::default();
        history.enter(&reading(0, 7, 1.0));
        for t in 1..=12 {
            history.enter(&reading(t, 3, if t == 5 { f64::INFINITY } else { 1.0 }));
        }
        let times: Vec<i64> = history.newest_first().map(|sight| sight.t).collect();
        assert_eq!(times, [12, 11, 10, 9, 8, 7, 6, 4, 3, 0], "5 has no echo, and it is why 2 is gone");
    }
}

//! Tables that are sorted by sensor: put in the order of time, within bounds.

use std::{collections::VecDeque, sync::Arc};

use super::{Next, Row, Source};
use crate::{
    diagnose::Diagnosis,
    error::{Place, Problem, Result},
    track::Pose,
};

/// Records that are kept to be sorted, at most: about 100 MB.
const MOST: usize = 1 << 20;

/// A record of one reading, without what it shares with the others.
struct Kept {
    t: i64,
    pose: Option<Pose>,
    angle: f64,
    reading: Option<(u16, f64)>,
    empty: u64,
    line: u64,
    byte: u64,
}

enum State {
    /// All records so far are of one sensor.
    OneSensor,
    /// The order is that of the log.
    InOrder,
    /// The records that are kept go first, then the log goes on.
    Replaying,
}

/// A log whose first sensor's records all come before the next one's, at the same times, is put in the order of time; any other is
/// left as it is.
///
/// That is known where the sensor changes for the first time and the time goes back with it, and no sensor comes again. A log of
/// more than a million records is left as it is, too.
pub struct Sorted<S> {
    source: S,
    state: State,
    kept: VecDeque<Kept>,
    place: Place,
}

impl<S: Source> Sorted<S> {
    /// Sorts `source`, where it has to be.
    pub fn new(source: S) -> Self {
        // There is nothing to be sorted among the readings of one.
        let one = source.ids().len() == 1;
        let place = Row::default().place;
        let state = if one { State::InOrder } else { State::OneSensor };
        Self { source, state, kept: VecDeque::new(), place }
    }

    /// Reads as long as there is one sensor; then it is known what the log is.
    fn look(&mut self, row: &mut Row, problems: &mut dyn FnMut(Problem)) -> Result<()> {
        let mut first = None;
        loop {
            match self.source.next_row(row, problems)? {
                Next::Record => {}
                Next::Unusable => continue,
                Next::End => break,
            }
            let (sensor, last) = (row.readings.first().map(|(sensor, _)| *sensor), self.kept.back().map(|kept| kept.t));
            // A record of several readings is one of a wide table.
            let is_wide = row.readings.len() > 1;
            self.keep(row);
            let changes = first.is_some() && sensor.is_some() && sensor != first;
            if changes && self.kept.len() > 2 && last.is_some_and(|last| row.t < last) {
                self.sort(row, problems)?;
                break;
            }
            if changes || is_wide || self.kept.len() >= MOST {
                break;
            }
            first = first.or(sensor);
        }
        self.state = State::Replaying;
        Ok(())
    }

    /// Reads on to the end, and sorts, if no sensor comes again.
    fn sort(&mut self, row: &mut Row, problems: &mut dyn FnMut(Problem)) -> Result<()> {
        let mut seen: Vec<u16> = Vec::new();
        for kept in &self.kept {
            seen.extend(kept.reading.map(|(sensor, _)| sensor).filter(|sensor| seen.last() != Some(sensor)));
        }
        while self.kept.len() < MOST {
            match self.source.next_row(row, problems)? {
                Next::Record => {}
                Next::Unusable => continue,
                Next::End => {
                    // Stable: of one time in the order of the log.
                    self.kept.make_contiguous().sort_by_key(|kept| kept.t);
                    return Ok(());
                }
            }
            let sensor = row.readings.first().map(|(sensor, _)| *sensor);
            let again = sensor.is_some_and(|sensor| seen.last() != Some(&sensor) && seen.contains(&sensor));
            let back = self.kept.back().is_some_and(|last| row.t < last.t);
            let same = sensor.is_none_or(|sensor| seen.last() == Some(&sensor));
            self.keep(row);
            if again || (same && back) {
                return Ok(());
            }
            seen.extend(sensor.filter(|sensor| seen.last() != Some(sensor)));
        }
        Ok(())
    }

    fn keep(&mut self, row: &Row) {
        self.place = row.place.clone();
        let Row { t, pose, angle, empty, .. } = *row;
        let (line, byte) = (row.place.line, row.place.byte);
        let mut readings = row.readings.iter().copied();
        self.kept.push_back(Kept { t, pose, angle, reading: readings.next(), empty, line, byte });
        // Those of a wide table, in records of their own until they are replayed.
        self.kept.extend(readings.map(|reading| Kept { t, pose, angle, reading: Some(reading), empty: 0, line, byte }));
    }

    fn replay(&mut self, row: &mut Row) -> bool {
        let Some(Kept { t, pose, angle, reading, empty, line, byte }) = self.kept.pop_front() else { return false };
        row.readings.clear();
        row.readings.extend(reading);
        // What stood in one record does so again.
        while let Some(next) = self.kept.front().filter(|next| next.byte == byte) {
            row.readings.extend(next.reading);
            self.kept.pop_front();
        }
        (row.t, row.log_time, row.pose, row.angle, row.empty) = (t, t, pose, angle, empty);
        row.place = Place { line, byte, ..self.place.clone() };
        true
    }
}

impl<S: Source> Source for Sorted<S> {
    fn next_row(&mut self, row: &mut Row, problems: &mut dyn FnMut(Problem)) -> Result<Next> {
        if matches!(self.state, State::OneSensor) {
            self.look(row, problems)?;
        }
        if matches!(self.state, State::Replaying) {
            if self.replay(row) {
                return Ok(Next::Record);
            }
            self.state = State::InOrder;
        }
        self.source.next_row(row, problems)
    }

    fn drained(&self) -> bool {
        self.kept.is_empty() && self.source.drained()
    }

    fn position(&self) -> u64 {
        self.source.position()
    }

    fn has_poses(&self) -> bool {
        self.source.has_poses()
    }

    fn ids(&self) -> &[Arc<str>] {
        self.source.ids()
    }

    fn diagnoses(&self) -> Vec<Diagnosis> {
        self.source.diagnoses()
    }
}

#[cfg(test)]
mod tests;

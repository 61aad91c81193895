//! Poses for records that have none: of a table of readings that was joined with one of poses.

use std::{collections::VecDeque, sync::Arc};

use super::{Next, Row, Source};
use crate::{
    diagnose::Diagnosis,
    error::{Problem, Result},
    track::Pose,
};

/// Records that wait for the next pose, at most.
const WAITING: usize = 1 << 16;
/// Poses may be this much farther apart than the two before them.
const SLOWER: f64 = 1.5;
/// And are never used over a longer time, in nanoseconds, unless that was asked for.
const LONGEST: u64 = 5_000_000_000;
/// Share of the gap that a record may lie outside of all poses.
const OUTSIDE: u64 = 10;

/// A log in which a record without a pose takes the one between the poses of the records around it.
///
/// The position is interpolated linearly and the yaw the shorter way, over at most the gap, or half as long again as from one pose to
/// the next before. Before the first pose and after the last one there is none, but for a tenth of the gap.
pub struct Joined<S> {
    source: S,
    max_gap: u64,
    before: Option<(i64, Pose)>,
    /// From the last pose but one to the last, in nanoseconds.
    interval: Option<u64>,
    waiting: VecDeque<Row>,
    /// Those of the front that have their pose, as far as there is one.
    settled: usize,
    ended: bool,
}

impl<S: Source> Joined<S> {
    /// Joins the records of `source`; `max_gap` in nanoseconds.
    pub fn new(source: S, max_gap: u64) -> Self {
        let waiting = VecDeque::new();
        Self { source, max_gap, before: None, interval: None, waiting, settled: 0, ended: false }
    }

    /// Gives what waits its poses, up to `after`; without one the log has ended, or does not say for too long.
    fn settle(&mut self, after: Option<(i64, Pose)>) {
        let longest = match (self.interval, self.before.zip(after)) {
            (Some(interval), _) => (SLOWER * interval as f64) as u64,
            (None, Some(((before, _), (after, _)))) => after.abs_diff(before),
            (None, None) => 0,
        };
        let longest = longest.min(LONGEST).max(self.max_gap);
        let outside = self.max_gap / OUTSIDE;
        for row in self.waiting.iter_mut().skip(self.settled) {
            row.pose = match (self.before, after) {
                (_, Some((t, pose))) if t == row.t => Some(pose),
                (Some((t, pose)), _) if t == row.t => Some(pose),
                (Some((from, first)), Some((to, last))) if from < row.t && row.t < to => {
                    let share = row.t.abs_diff(from) as f64 / to.abs_diff(from) as f64;
                    if to.abs_diff(from) <= longest { first.towards(last, share) } else { None }
                }
                (Some((t, pose)), None) | (None, Some((t, pose))) if t.abs_diff(row.t) <= outside => Some(pose),
                _ => None,
            };
        }
        self.settled = self.waiting.len();
        if let Some((t, _)) = after {
            self.interval =
                self.before.map(|(before, _)| t.abs_diff(before)).filter(|interval| *interval > 0).or(self.interval);
            self.before = after;
        }
    }

    /// A record that has its pose, or for which there is none.
    fn next_settled(&mut self, row: &mut Row) -> bool {
        if self.settled == 0 {
            return false;
        }
        self.settled -= 1;
        self.waiting.pop_front().is_some_and(|front| {
            *row = front;
            true
        })
    }
}

impl<S: Source> Source for Joined<S> {
    fn next_row(&mut self, row: &mut Row, problems: &mut dyn FnMut(Problem)) -> Result<Next> {
        if self.next_settled(row) {
            return Ok(Next::Record);
        }
        if self.ended {
            return Ok(Next::End);
        }
        let next = self.source.next_row(row, problems)?;
        match (next, row.pose) {
            (Next::Record, Some(pose)) if self.waiting.is_empty() => {
                self.settle(Some((row.t, pose)));
                return Ok(Next::Record);
            }
            (Next::Record, pose) => {
                if let Some(pose) = pose {
                    self.settle(Some((row.t, pose)));
                }
                self.waiting.push_back(std::mem::take(row));
                self.settled += usize::from(pose.is_some());
                if self.waiting.len() > WAITING {
                    self.settle(None);
                }
            }
            (Next::End, _) => {
                self.ended = true;
                self.settle(None);
            }
            (Next::Unusable, _) => {}
        }
        Ok(match self.next_settled(row) {
            true => Next::Record,
            false if self.ended => Next::End,
            false => Next::Unusable,
        })
    }

    fn drained(&self) -> bool {
        self.settled == 0 && !self.ended && self.source.drained()
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

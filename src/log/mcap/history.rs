//! One moving frame's poses, as far back as they are still needed.

use std::collections::VecDeque;

use super::rigid::Rigid;

/// Poses that are kept of one frame, at most.
const MOST: usize = 1 << 14;

/// A pose of a frame.
#[derive(Debug, Clone, Copy)]
struct Sample {
    t: i64,
    log_time: i64,
    pose: Rigid,
}

/// What is still needed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Keep {
    /// The latest time that was asked for, in nanoseconds: none before it will be.
    pub(super) from: Option<i64>,
    /// How long after its recording a pose is kept where nobody asks, in nanoseconds.
    pub(super) memory: i64,
}

/// Poses in the order of their times.
#[derive(Debug, Default)]
pub(super) struct History {
    samples: VecDeque<Sample>,
}

impl History {
    /// Takes a pose in at its place; of two at one time the first one counts.
    pub(super) fn add(&mut self, t: i64, log_time: i64, pose: Rigid, keep: Keep) {
        let at = match self.samples.back() {
            Some(last) if last.t >= t => self.samples.partition_point(|sample| sample.t < t),
            _ => self.samples.len(),
        };
        if self.samples.get(at).is_none_or(|sample| sample.t != t) {
            self.samples.insert(at, Sample { t, log_time, pose });
        }
        // One before the time that is asked for next is needed.
        while let (Some(first), Some(second)) = (self.samples.front(), self.samples.get(1)) {
            let passed = keep.from.is_some_and(|from| second.t <= from);
            let old = log_time.saturating_sub(first.log_time) > keep.memory;
            if !(passed || old || self.samples.len() > MOST) {
                break;
            }
            self.samples.pop_front();
        }
    }

    /// The pose at `t`, between those before and after it, both within `max_gap` nanoseconds.
    pub(super) fn at(&self, t: i64, max_gap: u64) -> Option<Rigid> {
        let next = self.samples.partition_point(|sample| sample.t < t);
        let after = self.samples.get(next)?;
        if after.t == t {
            return Some(after.pose);
        }
        let before = self.samples.get(next.checked_sub(1)?)?;
        let (since, until) = (t.abs_diff(before.t), after.t.abs_diff(t));
        if since > max_gap || until > max_gap {
            return None;
        }
        let share = since as f64 / after.t.abs_diff(before.t) as f64;
        Some(before.pose.towards(&after.pose, share))
    }

    /// The only pose there is, if there is but one.
    pub(super) fn only(&self) -> Option<Rigid> {
        self.samples.front().filter(|_| self.samples.len() == 1).map(|sample| sample.pose)
    }

    pub(super) fn is_empty(&self) -> bool {
        self.samples.is_empty()
    }

    pub(super) fn clear(&mut self) {
        self.samples.clear();
    }
}

//! One moving frame's poses, as far back as they are still needed.

use std::collections::VecDeque;

use super::rigid::Rigid;
use crate::track::{Between, Periods, PoseLimits, PoseMiss, Step};

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
    periods: Periods,
    doubts: Doubts,
    /// Times of the pose that came last: in itself, and of its recording.
    latest: Option<(i64, i64)>,
}

/// What speaks for two sources of one frame's poses.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Doubts {
    /// Poses that another one has the time of, with other values.
    pub(super) contradicted: u64,
    /// Poses that go back to where the last but one was.
    pub(super) returning: u64,
    /// Poses that are a noteworthy step from the last.
    steps: u64,
    /// The widest such step, in metres.
    pub(super) widest: f64,
}

impl Doubts {
    /// Shorter steps are noise, in metres.
    const NOTEWORTHY: f64 = 0.05;
    /// Poses within this share of a step are the same place.
    const BACK: f64 = 0.2;
    /// As many have to speak for it.
    const ENOUGH: u64 = 8;

    /// Whether three poses in a row go to another place and back.
    fn alternates(poses: [&Rigid; 3]) -> Option<f64> {
        let [first, second, third] = poses;
        let (there, back) = (first.step_to(second).distance, second.step_to(third).distance);
        let step = there.min(back);
        let is_back = step > Self::NOTEWORTHY && first.step_to(third).distance < Self::BACK * step;
        is_back.then_some(step)
    }

    /// Whether most steps go to and fro.
    pub(super) const fn alternate(&self) -> bool {
        self.returning * 2 > self.steps
    }

    /// Whether there is more than one source, as far as can be told.
    pub(super) const fn are_serious(&self) -> bool {
        (self.returning >= Self::ENOUGH && self.alternate()) || self.contradicted >= Self::ENOUGH
    }
}

impl History {
    /// Takes a pose in at its place; of two at one time the first one counts.
    pub(super) fn add(&mut self, t: i64, log_time: i64, pose: Rigid, keep: Keep) {
        let at = match self.samples.back() {
            Some(last) if last.t >= t => self.samples.partition_point(|sample| sample.t < t),
            _ => self.samples.len(),
        };
        if self.latest.is_none_or(|(_, latest)| latest <= log_time) {
            self.latest = Some((t, log_time));
        }
        match self.samples.get(at).filter(|sample| sample.t == t) {
            Some(known) => {
                let step = known.pose.step_to(&pose);
                let differs = step.distance > Doubts::NOTEWORTHY || step.turn > Doubts::NOTEWORTHY;
                self.doubts.contradicted += u64::from(differs);
            }
            None => {
                self.samples.insert(at, Sample { t, log_time, pose });
                self.periods.tick(t);
                self.look_back(at);
            }
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

    /// Looks whether the poses before this newest one go to and fro.
    fn look_back(&mut self, at: usize) {
        let back = |count: usize| self.samples.get(at.checked_sub(count)?);
        let (Some(third), Some(second), true) = (back(0), back(1), at + 1 == self.samples.len()) else { return };
        let step = second.pose.step_to(&third.pose).distance;
        self.doubts.steps += u64::from(step > Doubts::NOTEWORTHY);
        if let Some(first) = back(2)
            && let Some(step) = Doubts::alternates([&first.pose, &second.pose, &third.pose])
        {
            self.doubts.returning += 1;
            self.doubts.widest = self.doubts.widest.max(step);
        }
    }

    /// What speaks for two sources.
    pub(super) const fn doubts(&self) -> Doubts {
        self.doubts
    }

    /// By how much the pose that came last is later than the time of its recording, in nanoseconds.
    pub(super) fn offset(&self) -> Option<i64> {
        self.latest.map(|(t, log_time)| t.saturating_sub(log_time))
    }

    /// The pose at `t`, between those before and after it; and where they are farther apart than usual, how far.
    pub(super) fn at(&self, t: i64, limits: &PoseLimits) -> Result<(Rigid, Option<(u64, Step)>), PoseMiss> {
        let next = self.samples.partition_point(|sample| sample.t < t);
        let (before, after) = (next.checked_sub(1).and_then(|before| self.samples.get(before)), self.samples.get(next));
        let (before, after) = match (before, after) {
            (_, Some(after)) if after.t == t => {
                self.doubt(next.saturating_sub(1), next)?;
                return Ok((after.pose, None));
            }
            (Some(before), Some(after)) => (before, after),
            (Some(before), None) => return Err(PoseMiss::After(t.abs_diff(before.t))),
            (None, Some(after)) => return Err(PoseMiss::Before(t.abs_diff(after.t))),
            (None, None) => return Err(PoseMiss::None),
        };
        let at = Between { since: t.abs_diff(before.t), until: after.t.abs_diff(t) };
        let (step, within) = (before.pose.step_to(&after.pose), after.t.abs_diff(before.t));
        let is_wide = limits.check(at, step, &self.periods)?;
        self.doubt(next - 1, next)?;
        let share = at.since as f64 / within as f64;
        Ok((before.pose.towards(&after.pose, share), is_wide.then_some((within, step))))
    }

    /// Refuses what lies between two poses, by their places in the list, of which one is out of line with its neighbours, where
    /// that is so of most.
    fn doubt(&self, before: usize, after: usize) -> Result<(), PoseMiss> {
        if !self.doubts.alternate() {
            return Ok(());
        }
        let around = [before.wrapping_sub(1), before, after, after + 1].map(|index| self.samples.get(index));
        let alternates = around.windows(3).any(|three| match three {
            [Some(first), Some(second), Some(third)] => {
                Doubts::alternates([&first.pose, &second.pose, &third.pose]).is_some()
            }
            _ => false,
        });
        match around {
            [_, Some(before), Some(after), _] if alternates => Err(PoseMiss::Alternating {
                step: before.pose.step_to(&after.pose),
                within: after.t.abs_diff(before.t),
            }),
            _ => Ok(()),
        }
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
        self.periods.restart();
        self.latest = None;
    }
}

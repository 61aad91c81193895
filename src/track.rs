//! Where the robot was: poses as a stream, merged with readings in time order.
mod limits;

use std::{collections::VecDeque, f64::consts::TAU};

pub(crate) use self::limits::{Between, Periods, seconds};
pub use self::limits::{GapLimit, MotionLimit, PoseLimits, PoseMiss, Step};
use crate::error::{Place, Problem, Reason, Result};

/// Records in a row, earlier than the latest usable one but in order among themselves, that make a clock reset.
pub const RESET_RUN: u32 = 16;

/// The robot's pose in the log's fixed frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Position in metres.
    pub x: f64,
    /// Position in metres.
    pub y: f64,
    /// Heading in radians, counter-clockwise; any turn.
    pub yaw: f64,
}

/// What a [`Clock`] says of a record's time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tick {
    /// Not earlier than the latest usable record: usable.
    Forward,
    /// Earlier: unusable.
    Backward,
    /// The last of [`RESET_RUN`] earlier ones: unusable too, but time goes on from here.
    Reset,
}

/// The order of time in a log.
///
/// A record earlier than the latest usable one is unusable. [`RESET_RUN`] such records in a row, each not earlier than the one before,
/// are a clock reset. A usable record in between ends the run; one out of order within the run begins it anew.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Clock {
    now: Option<i64>,
    /// The latest of the run of earlier records, and how many they are.
    run_last: i64,
    run: u32,
}

impl Clock {
    /// A clock that takes any first record.
    pub fn new() -> Self {
        Self::default()
    }

    /// Time of the latest usable record, or of the last reset, in nanoseconds.
    pub fn now(&self) -> Option<i64> {
        self.now
    }

    /// Whether a record of this time, in nanoseconds, would be [`Tick::Forward`].
    pub fn is_forward(&self, t: i64) -> bool {
        self.now.is_none_or(|now| t >= now)
    }

    /// Takes the time of the next record, in nanoseconds.
    pub fn admit(&mut self, t: i64) -> Tick {
        if self.is_forward(t) {
            self.now = Some(t);
            self.run = 0;
            return Tick::Forward;
        }
        self.run = if self.run > 0 && t >= self.run_last { self.run + 1 } else { 1 };
        self.run_last = t;
        if self.run < RESET_RUN {
            return Tick::Backward;
        }
        self.now = Some(t);
        self.run = 0;
        Tick::Reset
    }
}

/// A pose, its time in nanoseconds, and where it stands.
#[derive(Debug, Clone, PartialEq)]
pub struct StampedPose {
    /// Nanoseconds.
    pub t: i64,
    /// Finite.
    pub pose: Pose,
    /// Where its record begins.
    pub place: Place,
}

/// Poses in the order of their file.
pub trait PoseStream {
    /// The next pose that can be read, `None` at the end; those that can't go to `problems`. Errors where the file can't be read on.
    fn next_pose(&mut self, problems: &mut dyn FnMut(Problem)) -> Result<Option<StampedPose>>;
}

impl<P: PoseStream + ?Sized> PoseStream for Box<P> {
    fn next_pose(&mut self, problems: &mut dyn FnMut(Problem)) -> Result<Option<StampedPose>> {
        (**self).next_pose(problems)
    }
}

/// One pose with the number of clock resets before it.
#[derive(Debug, Clone, Copy)]
struct Waypoint {
    epoch: u32,
    t: i64,
    pose: Pose,
}

impl Waypoint {
    const fn key(&self) -> (u32, i64) {
        (self.epoch, self.t)
    }
}

/// Poses that are read ahead for one reading, at most, and kept in case that its time was wrong.
const LOOKAHEAD: usize = 1 << 16;

/// A trajectory that is asked for poses in time order, and read only as far as needed.
pub struct Track<P> {
    stream: P,
    limits: PoseLimits,
    periods: Periods,
    /// Why the last time that was asked for has no pose.
    miss: PoseMiss,
    /// Longest time between poses that were used though they are farther apart than usual, and the farthest step between them.
    bridged: Option<(u64, Step)>,
    clock: Clock,
    epoch: u32,
    /// The last pose before the latest time that had one, and those read since.
    window: VecDeque<Waypoint>,
    /// Some time had a pose already.
    begun: bool,
    /// The last time asked for lay beyond the lookahead.
    gave_up: bool,
}

impl<P: PoseStream> Track<P> {
    /// A track over `stream` that answers only where the poses on both sides keep to `limits`; a number is the largest gap in
    /// nanoseconds.
    pub fn new(stream: P, limits: impl Into<PoseLimits>) -> Self {
        Self {
            stream,
            limits: limits.into(),
            periods: Periods::default(),
            miss: PoseMiss::None,
            bridged: None,
            clock: Clock::new(),
            epoch: 0,
            window: VecDeque::new(),
            begun: false,
            gave_up: false,
        }
    }

    /// Why the last time that was asked for has no pose.
    pub fn miss(&self) -> PoseMiss {
        self.miss
    }

    /// Longest time in nanoseconds between poses that were used though they are farther apart than usual, and the farthest step
    /// between such poses.
    pub fn bridged(&self) -> Option<(u64, Step)> {
        self.bridged
    }

    /// Clock resets in the poses read so far.
    pub fn resets(&self) -> u32 {
        self.epoch
    }

    /// The pose at `t`, in nanoseconds, after `epoch` clock resets; the n-th epoch of the readings is that of the poses.
    ///
    /// Position is interpolated linearly, yaw the shorter way. `None` where there is no pose within the gap at or before `t` or none at
    /// or after it. Times that have a pose must not go back within an epoch, nor epochs. Unusable poses that were passed go to
    /// `problems`; errors where the stream has one.
    ///
    /// A single time that is wrong and far ahead does no harm: up to 65,536 poses are read for it and kept. Only where the time
    /// after it is as far ahead are they left behind.
    pub fn pose_at(&mut self, epoch: u32, t: i64, problems: &mut dyn FnMut(Problem)) -> Result<Option<Pose>> {
        let reached = self.read_up_to((epoch, t), problems)?;
        self.gave_up = !reached;
        let next = self.window.partition_point(|waypoint| waypoint.key() < (epoch, t));
        let pose = self.interpolate(next, epoch, t);
        if pose.is_ok() {
            self.begun = true;
            self.window.drain(..next.saturating_sub(1));
        }
        Ok(pose.map_err(|miss| self.miss = miss).ok())
    }

    /// Reads until there is a pose at or after `key`; `false` where that is beyond the lookahead.
    fn read_up_to(&mut self, key: (u32, i64), problems: &mut dyn FnMut(Problem)) -> Result<bool> {
        while self.window.back().is_none_or(|last| last.key() < key) {
            let patient = !self.begun || self.gave_up;
            if patient {
                self.window.drain(..self.window.len().saturating_sub(1));
            } else if self.window.len() > LOOKAHEAD {
                return Ok(false);
            }
            match self.next_waypoint(problems)? {
                Some(waypoint) => self.window.push_back(waypoint),
                None => break,
            }
        }
        Ok(true)
    }

    /// Between the pose of this index in the window and the one before it.
    fn interpolate(&mut self, next: usize, epoch: u32, t: i64) -> Result<Pose, PoseMiss> {
        let of_epoch = |index: usize| self.window.get(index).filter(|waypoint| waypoint.epoch == epoch);
        let (before, after) = (next.checked_sub(1).and_then(of_epoch), of_epoch(next));
        let (before, after) = match (before, after) {
            (_, Some(after)) if after.t == t => return Ok(after.pose),
            (Some(before), Some(after)) => (*before, *after),
            (Some(before), None) => return Err(PoseMiss::After(t.abs_diff(before.t))),
            (None, Some(after)) => return Err(PoseMiss::Before(t.abs_diff(after.t))),
            (None, None) => return Err(PoseMiss::None),
        };
        let at = Between { since: t.abs_diff(before.t), until: after.t.abs_diff(t) };
        let step = before.pose.step_to(&after.pose);
        if self.limits.check(at, step, &self.periods)? {
            Step::note(&mut self.bridged, after.t.abs_diff(before.t), step);
        }
        let share = at.since as f64 / after.t.abs_diff(before.t) as f64;
        before.pose.towards(after.pose, share).ok_or(PoseMiss::None)
    }

    /// The next pose in time order.
    fn next_waypoint(&mut self, problems: &mut dyn FnMut(Problem)) -> Result<Option<Waypoint>> {
        while let Some(StampedPose { t, pose, place }) = self.stream.next_pose(problems)? {
            let latest = self.clock.now();
            match self.clock.admit(t) {
                Tick::Forward => {
                    self.periods.tick(t);
                    return Ok(Some(Waypoint { epoch: self.epoch, t, pose }));
                }
                Tick::Backward => {}
                Tick::Reset => {
                    self.periods.restart();
                    self.epoch = self.epoch.saturating_add(1);
                }
            }
            problems(time_backwards(t, latest, place));
        }
        Ok(None)
    }
}

/// The problem of a record that is earlier than the latest usable one; times in nanoseconds.
pub fn time_backwards(t: i64, latest: Option<i64>, place: Place) -> Problem {
    let seconds = |t| {
        let mut text = Vec::new();
        crate::stamp::write(t, &mut text);
        String::from_utf8_lossy(&text).into_owned()
    };
    let value = match latest {
        Some(latest) => format!("t {} after {}", seconds(t), seconds(latest)),
        None => format!("t {}", seconds(t)),
    };
    Problem { reason: Reason::TimeBackwards, place, value }
}

impl Pose {
    /// The way to another, turning the shorter way.
    pub fn step_to(&self, other: &Self) -> Step {
        let turn = libm::remainder(other.yaw - self.yaw, TAU).abs();
        Step { distance: libm::hypot(other.x - self.x, other.y - self.y), turn }
    }

    /// The pose this share of the way to another, `share` in [0, 1]; `None` where the poses are too far apart for an `f64`.
    pub(crate) fn towards(self, other: Self, share: f64) -> Option<Self> {
        // The remainder is exact, and within ±half a turn: the shorter way.
        let turn = libm::remainder(other.yaw - self.yaw, TAU);
        let pose = Self {
            x: self.x + share * (other.x - self.x),
            y: self.y + share * (other.y - self.y),
            yaw: self.yaw + share * turn,
        };
        (pose.x.is_finite() && pose.y.is_finite() && pose.yaw.is_finite()).then_some(pose)
    }
}

#[cfg(test)]
mod tests;

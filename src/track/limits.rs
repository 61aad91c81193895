//! How far apart in time poses may be, and how fast they may move, for a reading between them to be placed.

use std::fmt;

use crate::{sample::Sample, stamp};

/// Fastest motion that is believed of a robot: poses that move faster are another robot's, another source's, or a mistake.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionLimit {
    /// Metres a second; +∞ where anything is believed.
    speed: f64,
}

impl MotionLimit {
    /// Anything is believed.
    pub const NONE: Self = Self { speed: f64::INFINITY };
    /// 10 m/s: faster than any robot with sonars drives.
    pub const DEFAULT: Self = Self { speed: 10.0 };
    /// 20 rad/s, or 2 rad for each metre of a higher speed: three turns a second.
    const TURN_RATE: f64 = 20.0;
    const TURN_BY_SPEED: f64 = 2.0;
    /// Stamps jitter: a step of 5 cm, or of 0.1 rad, is believed in no time.
    const STEP: f64 = 0.05;
    const TURN: f64 = 0.1;

    /// A bound in metres a second; `None` where it is not above zero.
    pub fn new(speed: f64) -> Option<Self> {
        (speed > 0.0).then_some(Self { speed })
    }

    /// Metres a second; +∞ where anything is believed.
    pub fn speed(self) -> f64 {
        self.speed
    }

    /// Whether a robot can do the step within this time, in nanoseconds.
    pub fn allows(self, step: Step, within: u64) -> bool {
        let seconds = within as f64 * 1e-9;
        let turn_rate = Self::TURN_RATE.max(Self::TURN_BY_SPEED * self.speed);
        step.distance <= Self::STEP + self.speed * seconds && step.turn <= Self::TURN + turn_rate * seconds
    }
}

impl Default for MotionLimit {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// The way from one pose to the next.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Step {
    /// Metres, at least 0.
    pub distance: f64,
    /// Radians, the shorter way, at least 0.
    pub turn: f64,
}

impl Step {
    /// Keeps the longest time and the farthest step.
    pub(crate) fn note(most: &mut Option<(u64, Self)>, within: u64, step: Self) {
        let (time, farthest) = most.get_or_insert((within, step));
        *time = within.max(*time);
        farthest.distance = farthest.distance.max(step.distance);
        farthest.turn = farthest.turn.max(step.turn);
    }
}

/// How far the poses on both sides of a reading may be from it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GapLimit {
    /// Nanoseconds.
    max: u64,
    /// Poses that come regularly, but less often, do as well.
    adapts: bool,
}

impl GapLimit {
    /// 0.5 s, in nanoseconds.
    pub const FLOOR: u64 = 500_000_000;
    /// Between poses that are farther apart nothing is taken for granted: 3 s, in nanoseconds.
    const LONGEST: u64 = 3_000_000_000;
    /// Nor where the robot has moved by more than this in between, in metres and radians: no straight line any more.
    const FARTHEST: Step = Step { distance: 0.5, turn: std::f64::consts::FRAC_PI_6 };

    /// Within this many nanoseconds, and no more.
    pub const fn exactly(max: u64) -> Self {
        Self { max, adapts: false }
    }

    /// The bound that somebody named, in nanoseconds; without one 0.5 s, more where poses come less often.
    pub fn of(named: Option<u64>) -> Self {
        named.map_or(Self { max: Self::FLOOR, adapts: true }, Self::exactly)
    }

    /// Nanoseconds.
    pub const fn max(self) -> u64 {
        self.max
    }

    /// Whether poses `between` nanoseconds apart are near enough though they are beyond the bound: they mostly come this
    /// seldom, and the robot has hardly moved.
    fn adapts_to(self, between: u64, step: Step, periods: &Periods) -> bool {
        let usual = || periods.usual().is_some_and(|period| between <= period.saturating_add(period / 2));
        self.adapts
            && between <= Self::LONGEST
            && step.distance <= Self::FARTHEST.distance
            && step.turn <= Self::FARTHEST.turn
            && usual()
    }
}

impl Default for GapLimit {
    fn default() -> Self {
        Self::of(None)
    }
}

/// What a pose between two others has to keep to.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PoseLimits {
    /// How near they have to be.
    pub gap: GapLimit,
    /// How fast they may move.
    pub motion: MotionLimit,
}

impl From<u64> for PoseLimits {
    /// Within exactly this many nanoseconds, and as fast as they like.
    fn from(max_gap: u64) -> Self {
        Self { gap: GapLimit::exactly(max_gap), motion: MotionLimit::NONE }
    }
}

/// Where a time lies between two poses, in nanoseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Between {
    /// From the pose before it.
    pub(crate) since: u64,
    /// To the pose after it.
    pub(crate) until: u64,
}

impl PoseLimits {
    /// Whether a time between two poses, with this step from the first to the second, has a pose; `true` where only a wider gap
    /// than usual allowed it.
    pub(crate) fn check(&self, at: Between, step: Step, periods: &Periods) -> Result<bool, PoseMiss> {
        let between = at.since.saturating_add(at.until);
        if !self.motion.allows(step, between) {
            return Err(PoseMiss::TooFast { step, within: between });
        }
        if at.since <= self.gap.max && at.until <= self.gap.max {
            return Ok(false);
        }
        match self.gap.adapts_to(between, step, periods) {
            true => Ok(true),
            false => Err(PoseMiss::Gap { between, step }),
        }
    }
}

/// How often poses come.
#[derive(Debug, Clone, Default)]
pub(crate) struct Periods {
    last: Option<i64>,
    sample: Sample<u64>,
}

impl Periods {
    /// The next pose has this time, in nanoseconds. One that is not later than the last counts for nothing.
    pub(crate) fn tick(&mut self, t: i64) {
        if let Some(last) = self.last.filter(|last| *last < t) {
            self.sample.add(t.abs_diff(last));
        }
        self.last = Some(self.last.map_or(t, |last| last.max(t)));
    }

    /// Time begins anew.
    pub(crate) fn restart(&mut self) {
        self.last = None;
    }

    /// The median time between two poses, in nanoseconds; `None` below three poses, which say nothing of what is usual.
    pub(crate) fn usual(&self) -> Option<u64> {
        (self.sample.count() >= 2).then(|| self.sample.median()).flatten()
    }
}

/// Why there is no pose for a time. Shown as what is to be known of the poses around it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum PoseMiss {
    /// There is none at all.
    None,
    /// All are before it, the last one this many nanoseconds.
    After(u64),
    /// All are after it, the first one this many nanoseconds.
    Before(u64),
    /// Those around it are too far apart.
    Gap {
        /// Nanoseconds.
        between: u64,
        /// How far the robot moved.
        step: Step,
    },
    /// The robot can't have moved like that.
    TooFast {
        /// How far it moved.
        step: Step,
        /// Nanoseconds.
        within: u64,
    },
    /// Poses jump to and fro, as those of two sources that are mixed do.
    Alternating {
        /// How far they jump.
        step: Step,
        /// Nanoseconds.
        within: u64,
    },
}

impl PoseMiss {
    /// Whether there are poses, but none that a robot can have.
    pub const fn is_impossible(self) -> bool {
        matches!(self, Self::TooFast { .. } | Self::Alternating { .. })
    }
}

/// Nanoseconds as seconds, with as many digits as matter.
pub(crate) fn seconds(nanoseconds: u64) -> String {
    let seconds = nanoseconds as f64 * 1e-9;
    if seconds >= 100.0 { format!("{seconds:.0} s") } else { format!("{seconds:.3} s") }
}

/// Seconds as a flag takes them, not less than these nanoseconds.
fn at_least(nanoseconds: u64) -> String {
    let milliseconds = nanoseconds.div_ceil(1_000_000);
    stamp::text(i64::try_from(milliseconds.saturating_mul(1_000_000)).unwrap_or(i64::MAX)) + "s"
}

impl fmt::Display for PoseMiss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::None => write!(f, "there is none"),
            Self::After(by) => write!(f, "the last one before it is {} earlier, and none comes after it", seconds(by)),
            Self::Before(by) => write!(f, "the first one after it is {} later, and none is before it", seconds(by)),
            Self::Gap { between, step } => write!(
                f,
                "those around it are {} apart, and the robot moved {:.2} m and {:.0}deg in between; --max-gap {} bridges that",
                seconds(between),
                step.distance,
                step.turn.to_degrees(),
                at_least(between),
            ),
            Self::TooFast { step, within } => write!(
                f,
                "it moves {:.2} m and {:.0}deg in {}, which is faster than --max-speed",
                step.distance,
                step.turn.to_degrees(),
                seconds(within),
            ),
            Self::Alternating { step, within } => write!(
                f,
                "it jumps {:.2} m to and fro, within {}, as if two sources published it",
                step.distance,
                seconds(within),
            ),
        }
    }
}

#[cfg(test)]
mod tests;

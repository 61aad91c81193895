//! The catalogue: each cause with its evidence.

use crate::{
    error::{Problem, Reason},
    log::mcap::Finding,
};

/// How a heading is written that was taken for radians counter-clockwise from x.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HeadingForm {
    /// Degrees.
    Degrees,
    /// Radians clockwise.
    Clockwise,
    /// Degrees clockwise.
    DegreesClockwise,
    /// Radians clockwise from y, as a compass has it.
    Compass,
    /// Degrees clockwise from y.
    DegreesCompass,
}

/// Why little was resolved, the likeliest cause alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unresolved {
    /// The local map spans less travel, in metres, than crossings at the sensors' reach take.
    ShortMap {
        /// What it spans.
        spans: f64,
        /// What is needed.
        needs: f64,
        /// At which distance.
        reach: f64,
        /// It holds a number of readings, at whatever rate they come.
        by_count: bool,
    },
    /// The whole path is shorter than that, in metres.
    ShortPath {
        /// Its length.
        path: f64,
        /// What is needed.
        needs: f64,
        /// At which distance.
        reach: f64,
    },
    /// Most arcs are crossed by nothing.
    Uncrossed,
    /// Most arcs are crossed, but at no angle that counts.
    Shallow,
    /// Arcs are crossed steeply, and mostly by two others.
    Pairs {
        /// Arcs with exactly two crossings.
        count: u64,
    },
    /// None of these.
    Unknown,
}

/// What is likely wrong, with its numbers.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Diagnosis {
    /// Records that can't be used.
    Unusable {
        /// Why.
        reason: Reason,
        /// How many.
        count: u64,
        /// The first.
        first: Problem,
    },
    /// What a recording's format finds out.
    Recording(Finding),
    /// Nothing says where the robot was.
    NoPoses {
        /// Readings without a pose.
        readings: u64,
    },
    /// Sensors of the rig that have no readings.
    Silent {
        /// Their ids.
        sensors: Vec<String>,
    },
    /// The first line of a live source without a header was left out.
    FirstLine {
        /// The line, shortened.
        line: String,
    },
    /// The clock was set back.
    ClockSetBack {
        /// How often.
        times: u64,
    },
    /// All readings of a sensor come before all of the next: the clock is set back with each sensor.
    SortedBySensor {
        /// Clock resets with a change of the sensor.
        times: u64,
    },
    /// Ranges at or beyond the maximum, nearly all of them: another unit.
    RangeUnit {
        /// Ranges at or beyond the maximum.
        beyond: u64,
        /// Finite ranges.
        ranges: u64,
        /// The maximum in metres; +∞ where there is none.
        max: f64,
        /// The range in the middle, in what was taken for metres.
        median: f64,
        /// The unit in which they would fit.
        unit: Option<&'static str>,
    },
    /// Ranges below the minimum, nearly all of them.
    TooClose {
        /// Ranges below the minimum, and −∞.
        close: u64,
        /// Those of them that are −∞.
        minus_infinite: u64,
        /// Readings.
        readings: u64,
        /// The smallest minimum in metres.
        min: f64,
    },
    /// No reading has an echo, and none a finite range either.
    NoEcho {
        /// Readings.
        readings: u64,
        /// Those that are +∞.
        infinite: u64,
        /// Those that are NaN or negative.
        invalid: u64,
    },
    /// Ranges pile up at one value below the maximum.
    Clipped {
        /// The value in metres.
        value: f64,
        /// Echoes with it.
        count: u64,
        /// Echoes.
        echoes: u64,
        /// The maximum in metres; +∞ where there is none.
        max: f64,
    },
    /// Sensors repeat their values while the robot moves.
    Held {
        /// Echoes equal to their sensor's previous reading.
        held: u64,
        /// Echoes.
        echoes: u64,
        /// Sensors that repeat more than a third.
        sensors: u64,
    },
    /// Second readings of a sensor at one time and pose.
    Duplicates {
        /// How many.
        count: u64,
        /// Readings in all.
        readings: u64,
    },
    /// Poses change, and times hardly.
    TimeStandsStill {
        /// Changes of the pose.
        poses: u64,
        /// Different times.
        times: u64,
        /// The last of them in nanoseconds.
        at: i64,
    },
    /// The robot does not move.
    PosesStandStill {
        /// What the path covers, in metres.
        extent: [f64; 2],
        /// Readings on it.
        readings: u64,
    },
    /// Positions are latitude and longitude.
    Geographic {
        /// The last position, as it is written.
        extent: [f64; 2],
        /// What the extent is in metres, if its degrees are degrees.
        metres: f64,
    },
    /// Positions are in a smaller unit than metres.
    PoseUnit {
        /// Mean speed, in metres a second as they are written.
        speed: f64,
        /// The unit in which that is a robot's.
        unit: &'static str,
    },
    /// Headings fit the direction of travel only when read otherwise.
    Heading {
        /// How.
        form: HeadingForm,
        /// How well they fit then, up to 1.
        fit: f64,
        /// How well they fit as they are, from −1.
        as_is: f64,
        /// Steps of the path on which that was seen.
        steps: u64,
    },
    /// The range resolution was a guess, and makes many echoes near.
    GuessedResolution {
        /// Echoes of kind `near`.
        near: u64,
        /// Echoes.
        echoes: u64,
    },
    /// Hardly any echo is resolved.
    LittleResolved {
        /// Echoes that are.
        resolved: u64,
        /// Echoes and ignored arcs.
        arcs: u64,
        /// In a sample: arcs that nothing crosses, and arcs that are crossed at small angles only, of how many.
        sample: [u64; 3],
        /// The smallest angle that counts, in radians.
        min_angle: f64,
        /// Why.
        why: Unresolved,
    },
}

impl Diagnosis {
    /// How many readings it costs, as far as that can be told: the costliest is told first.
    pub const fn cost(&self) -> u64 {
        match self {
            Self::Unusable { count, .. } | Self::Clipped { count, .. } | Self::Duplicates { count, .. } => *count,
            Self::RangeUnit { beyond, .. } => *beyond,
            Self::TooClose { close, .. } => *close,
            Self::NoPoses { readings } | Self::NoEcho { readings, .. } | Self::PosesStandStill { readings, .. } => {
                *readings
            }
            Self::Held { held, .. } => *held,
            Self::GuessedResolution { near, .. } => *near,
            // What makes every echo wrong.
            Self::Heading { .. }
            | Self::Geographic { .. }
            | Self::PoseUnit { .. }
            | Self::SortedBySensor { .. }
            | Self::TimeStandsStill { .. } => u64::MAX,
            Self::LittleResolved { arcs, resolved, .. } => arcs.saturating_sub(*resolved),
            Self::Recording(finding) => finding.cost(),
            Self::FirstLine { .. } => 1,
            Self::ClockSetBack { .. } | Self::Silent { .. } => 0,
        }
    }

    /// The flag of `atm fuse` that cures it as it stands, where one does.
    pub const fn command_flag(&self) -> Option<&'static str> {
        match self {
            Self::Held { .. } => Some("--drop-held"),
            Self::Unusable { reason: Reason::NoStamp, .. } => Some("--clock log"),
            _ => None,
        }
    }
}

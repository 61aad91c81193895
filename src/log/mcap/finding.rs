//! What a person should know of how a recording was read: what was found, with the evidence.

use std::fmt;

use crate::{
    diagnose::Advice,
    track::{Step, seconds},
};

/// Something that was found out while a recording was read. Shown as one line: what was found, what that probably means, and what
/// cures it.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Finding {
    /// Stamps and times of recording are of different clocks.
    OtherClock {
        /// A topic whose stamps are far from the times of recording.
        topic: String,
        /// By how much its stamps are later, in nanoseconds.
        offset: i64,
        /// A topic whose stamps are not.
        other: Option<String>,
        /// The recording has a simulated time.
        simulated: bool,
        /// The stamps are what counts.
        by_stamp: bool,
    },
    /// Stamps of readings are off those of their poses, measured against the times of recording.
    ClockOffset {
        /// The topic of readings with the largest offset.
        topic: String,
        /// Topics that are off besides.
        others: usize,
        /// By how much its stamps are later than those of its poses, in nanoseconds.
        offset: i64,
    },
    /// Poses were used that are farther apart than usual.
    SparsePoses {
        /// The longest time between two, in nanoseconds.
        within: u64,
        /// How far the robot moved in between, at most.
        step: Step,
    },
    /// Poses seem to have two sources.
    TwoSources {
        /// Which poses, in words.
        what: String,
        /// Poses that went back to where the last but one was.
        returning: u64,
        /// By how much, at most, in metres.
        widest: f64,
        /// Poses that another one has the time of, with other values.
        contradicted: u64,
    },
    /// Transforms of a namespace are used for readings of another.
    BorrowedTransforms {
        /// The namespaces of the transforms.
        namespaces: Vec<String>,
    },
    /// Sensors of the rig of which there is no reading.
    IdleSensors {
        /// Their ids.
        ids: Vec<String>,
    },
    /// A beam that neither rig nor messages say.
    AssumedBeam {
        /// Whose.
        ids: Vec<String>,
        /// The full angle, in radians.
        beam: f64,
    },
    /// A beam that is wider than any sonar's.
    WideBeam {
        /// The sensor's id.
        id: String,
        /// As its messages say it, in radians.
        beam: f64,
    },
    /// Every number that a sensor gives is far beyond its maximum.
    AllBeyondMaximum {
        /// The sensor's id.
        id: String,
        /// Such readings.
        readings: u64,
        /// One of them, and the maximum, in metres.
        example: (f64, f64),
    },
    /// Every reading of a sensor is closer than its minimum.
    AllTooClose {
        /// The sensor's id.
        id: String,
        /// Its readings.
        readings: u64,
        /// Those that are -Inf.
        infinite: u64,
    },
    /// A sensor gives its minimum where something is closer.
    ClampedAtMinimum {
        /// The sensor's id.
        id: String,
        /// Readings that are exactly the minimum, and all that are echoes.
        readings: (u64, u64),
        /// The minimum, in metres.
        minimum: f64,
    },
    /// Sensors in frames that by their name look along z.
    OpticalFrames {
        /// The frames.
        frames: Vec<String>,
    },
}

impl Finding {
    /// Whether the echoes may be wrong, or missing, because of it.
    pub const fn is_warning(&self) -> bool {
        !matches!(self, Self::OtherClock { .. } | Self::SparsePoses { .. } | Self::AssumedBeam { .. })
    }
}

impl Finding {
    /// Whether it is about the ranges of a sensor.
    pub const fn is_of_ranges(&self) -> bool {
        matches!(self, Self::AllBeyondMaximum { .. } | Self::AllTooClose { .. } | Self::ClampedAtMinimum { .. })
    }

    /// How many readings it costs, as far as that is known.
    pub(crate) const fn cost(&self) -> u64 {
        match self {
            Self::AllBeyondMaximum { readings, .. } | Self::AllTooClose { readings, .. } => *readings,
            Self::ClampedAtMinimum { readings: (clamped, _), .. } => *clamped,
            // What makes every echo wrong.
            Self::ClockOffset { .. }
            | Self::TwoSources { .. }
            | Self::BorrowedTransforms { .. }
            | Self::OpticalFrames { .. }
            | Self::WideBeam { .. } => u64::MAX,
            _ => 0,
        }
    }

    /// Cause, evidence and cure.
    pub(crate) fn advice(&self) -> Advice {
        let (cause, flag) = match self {
            Self::OtherClock { .. } => {
                ("stamps are of another clock than the recording", Some("--clock log".to_owned()))
            }
            Self::ClockOffset { .. } => {
                ("stamps of readings are off those of the poses", Some("--clock log".to_owned()))
            }
            Self::SparsePoses { .. } => ("poses are sparse", Some("--max-gap".to_owned())),
            Self::TwoSources { .. } => {
                ("poses have two sources", Some("--tf-topics or --pose-topic, which choose one".to_owned()))
            }
            Self::BorrowedTransforms { .. } => {
                ("transforms are of another namespace than the readings", Some("--tf-topics".to_owned()))
            }
            Self::IdleSensors { .. } => {
                ("sensors of the rig have no readings", Some("topic, in the rig's [[sensor]]".to_owned()))
            }
            Self::AssumedBeam { .. } => ("a beam is assumed", Some("--fov".to_owned())),
            Self::WideBeam { .. } => ("a beam is in degrees", Some("field_of_view in a rig (--rig)".to_owned())),
            Self::AllBeyondMaximum { example: (range, max), .. } => {
                let (_, unit) = likely_unit(range / max);
                (
                    "ranges are in another unit than their limits",
                    Some(format!(
                        "--rig with [log] range_unit = \"{unit}\" and the sensor's limits, or --range-unit {unit}"
                    )),
                )
            }
            Self::AllTooClose { .. } => {
                ("a sensor is blocked, or its driver says -inf", Some("min_range in a rig".to_owned()))
            }
            Self::ClampedAtMinimum { .. } => {
                ("ranges are clamped at the minimum", Some("a larger min_range in a rig".to_owned()))
            }
            Self::OpticalFrames { .. } => ("frames may look along z", Some("--boresight z".to_owned())),
        };
        let text = self.to_string();
        let evidence = text.strip_prefix("warning: ").unwrap_or(&text).to_owned();
        Advice { cause: cause.to_owned(), evidence, flag }
    }
}

/// What a length that is so many times too large may be in.
fn likely_unit(ratio: f64) -> (&'static str, &'static str) {
    if ratio > 100.0 { ("millimetres", "mm") } else { ("centimetres", "cm") }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OtherClock { topic, offset, other, simulated, by_stamp } => {
                let seconds = *offset as f64 * 1e-9;
                let simulated = if *simulated { ", which are of a simulated time" } else { "" };
                match other {
                    None => write!(f, "clock     the stamps{simulated} are {seconds:.0} s from the times of recording"),
                    Some(other) => write!(
                        f,
                        "clock     the stamps of {topic} are {seconds:.0} s from the times of recording, those of {other} are not: one \
                         of them is of another clock{}",
                        if *by_stamp { "; --clock log puts both on the recorder's" } else { "" }
                    ),
                }
            }
            Self::ClockOffset { topic, others, offset } => write!(
                f,
                "warning: the stamps of {topic}{} are {} {} those of its poses, measured against the times of recording: if its \
                 clock is wrong, --clock log is right; if its messages only come late, the stamps are",
                match others {
                    0 => String::new(),
                    1 => " (and of one more topic)".to_owned(),
                    others => format!(" (and of {others} more topics)"),
                },
                seconds(offset.unsigned_abs()),
                if *offset > 0 { "ahead of" } else { "behind" },
            ),
            Self::SparsePoses { within, step } => write!(
                f,
                "gaps      poses up to {} apart are used, between which the robot moved {:.2} m and {:.0}deg at most; --max-gap \
                 bounds that",
                seconds(*within),
                step.distance,
                step.turn.to_degrees(),
            ),
            Self::TwoSources { what, returning, widest, contradicted } => {
                write!(f, "warning: the {what} ")?;
                match returning {
                    0 => write!(f, "have other values at the same time, {contradicted} times")?,
                    returning => write!(f, "jump to and fro {returning} times, by up to {widest:.2} m")?,
                }
                write!(
                    f,
                    ": two sources publish them; leave one out with --tf-topics or --pose-topic, or record it alone"
                )
            }
            Self::BorrowedTransforms { namespaces } => write!(
                f,
                "warning: transforms under {} are used for readings under another namespace; --tf-topics says which belong to them",
                namespaces.join(", ")
            ),
            Self::IdleSensors { ids } => write!(
                f,
                "warning: no reading is of the rig's {}: no topic and no frame is called like its `topic` or `id`",
                ids.join(", ")
            ),
            Self::AssumedBeam { ids, beam } => write!(
                f,
                "beam      {:.1}deg is assumed of {}, whose messages do not say it",
                beam.to_degrees(),
                ids.join(", ")
            ),
            Self::WideBeam { id, beam } => write!(
                f,
                "warning: the messages of {id} have a field_of_view of {beam}, which in radians is {:.1}deg: {beam} degrees? Give it \
                 as field_of_view in a rig (--rig)",
                beam.to_degrees()
            ),
            Self::AllBeyondMaximum { id, readings, example: (range, max) } => {
                let (words, unit) = likely_unit(range / max);
                write!(
                    f,
                    "warning: all {readings} readings of {id} that are numbers are at or above max_range, like {range} m with a \
                     max_range of {max} m: {words}? A rig with `[log] range_unit = \"{unit}\"`, and with min_range and max_range of the \
                     sensor, cures it (--rig); where the limits are in {words}, too, --range-unit {unit} does"
                )
            }
            Self::AllTooClose { id, readings, infinite } => write!(
                f,
                "warning: {readings} of {readings} readings of {id} are too close, {infinite} of them -Inf: a blocked sensor, or a \
                 driver that gives -Inf for \"nothing there\"; min_range in a rig says otherwise (--rig)"
            ),
            Self::ClampedAtMinimum { id, readings: (clamped, echoes), minimum } => write!(
                f,
                "warning: {clamped} of {echoes} echoes of {id} are exactly its min_range, {minimum} m: clamped? What is closer is not \
                 there; a rig's min_range just above leaves them out (--rig)"
            ),
            Self::OpticalFrames { frames } => write!(
                f,
                "warning: {} by the name looks along z, and is read as looking along x, as sensor_msgs/Range has it; --boresight z \
                 reads it the other way",
                frames.join(", ")
            ),
        }
    }
}

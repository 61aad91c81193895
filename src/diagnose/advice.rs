//! The catalogue in words: cause, evidence and cure.

use super::{
    Advice, Diagnosis, HeadingForm, Unresolved,
    words::{count, digits, length, percent},
};
use crate::{
    error::{Problem, Reason},
    stamp,
};

impl Diagnosis {
    /// Cause, evidence and cure in words.
    pub fn advice(&self) -> Advice {
        let (cause, evidence, flag) = match self {
            Self::Unusable { reason, count: number, first } => unusable(*reason, *number, first),
            Self::Recording(finding) => return finding.advice(),
            Self::NoPoses { readings } => (
                "nothing says where the robot was".into(),
                format!("{} without a pose, and no columns x, y, yaw", count(*readings, "reading")),
                Some("--poses FILE".into()),
            ),
            Self::FirstLine { line } => (
                "the first line of a source that runs already is not used: it may be cut".into(),
                format!("there is no header, and the line is {line}"),
                Some("a header, or the log as a file".into()),
            ),
            Self::Silent { sensors } => {
                ("sensors are silent".into(), format!("no readings from {}", sensors.join(", ")), None)
            }
            Self::ClockSetBack { times } => (
                "the clock was set back".into(),
                format!("{}; the local map began anew each time", count(*times, "time")),
                None,
            ),
            Self::SortedBySensor { times } => (
                "the rows are sorted by sensor, not by time".into(),
                format!("the time went back {}, each time with another sensor", count(*times, "time")),
                Some("the log sorted by t: (head -n1 LOG; tail -n+2 LOG | sort -t, -sgk1,1)".into()),
            ),
            Self::RangeUnit { .. }
            | Self::TooClose { .. }
            | Self::NoEcho { .. }
            | Self::Clipped { .. }
            | Self::Held { .. }
            | Self::Duplicates { .. } => self.of_ranges(),
            Self::LittleResolved { .. } | Self::GuessedResolution { .. } => self.of_echoes(),
            _ => self.of_poses(),
        };
        Advice { cause, evidence, flag }
    }

    fn of_ranges(&self) -> Words {
        match self {
            Self::RangeUnit { beyond, ranges, max, median, unit } => {
                let limit = if max.is_finite() {
                    format!(
                        "{} of {} are at or beyond the maximum of {}",
                        beyond,
                        count(*ranges, "range"),
                        length(*max)
                    )
                } else {
                    format!("the middle one of {} is {}", count(*ranges, "range"), length(*median))
                };
                let (cause, flag) = match unit {
                    Some(unit) => (format!("the ranges are in {unit}, not in m"), format!("--range-unit {unit}")),
                    None => (
                        "the ranges do not fit the rig".into(),
                        "[log] range_unit, or another max_range, in the rig".into(),
                    ),
                };
                (cause, format!("{limit}, the median is {}", digits(*median)), Some(flag))
            }
            Self::TooClose { close, minus_infinite, readings, min } => {
                let what = if minus_infinite * 2 > *close {
                    "-inf".to_owned()
                } else {
                    format!("below the minimum of {}", length(*min))
                };
                (
                    "nearly all readings are too close".into(),
                    format!("{close} of {} are {what}", count(*readings, "reading")),
                    Some("[log] range_unit, or another min_range, in the rig".into()),
                )
            }
            Self::NoEcho { readings, infinite, invalid } => (
                "no reading has an echo".into(),
                format!("of {}, {infinite} are inf and {invalid} nan or negative", count(*readings, "reading")),
                None,
            ),
            Self::Clipped { value, count: number, echoes, max } => (
                format!("a range of {} stands for nothing there", length(*value)),
                format!(
                    "{number} of {} ({}) have it, hardly any is a little less{}",
                    count(*echoes, "echo"),
                    percent(*number, *echoes),
                    if max.is_finite() { format!(", and the maximum is {}", length(*max)) } else { String::new() }
                ),
                Some(format!("max_range = \"{value}m\" in the rig")),
            ),
            Self::Held { held, echoes, sensors } => (
                "sensors repeat their last value until they have a new one".into(),
                format!(
                    "{held} of {} ({}) equal the one before although the robot moved, of {}",
                    count(*echoes, "echo"),
                    percent(*held, *echoes),
                    count(*sensors, "sensor")
                ),
                Some("--drop-held".into()),
            ),
            Self::Duplicates { count: number, readings } => (
                "readings are there twice".into(),
                format!(
                    "{number} of {} are second ones of their sensor at the same time and pose, and not used",
                    count(*readings, "reading")
                ),
                None,
            ),
            _ => (String::new(), String::new(), None),
        }
    }

    fn of_poses(&self) -> Words {
        match self {
            Self::TimeStandsStill { poses, times, at } => (
                "the times have lost their digits".into(),
                format!(
                    "{} of pose at {}, the last {} s",
                    count(*poses, "change"),
                    count(*times, "time"),
                    stamp::text(*at)
                ),
                Some("times written with all their digits (in Python float64 and not float32, no %g)".into()),
            ),
            Self::PosesStandStill { extent: [x, y], readings } => (
                "the poses do not move: arcs from one place do not cross".into(),
                format!("{} within {} by {}", count(*readings, "reading"), length(*x), length(*y)),
                Some("--poses FILE with the robot's path".into()),
            ),
            Self::Geographic { extent: [x, y], metres } => (
                "the positions are latitude and longitude, not metres".into(),
                format!(
                    "they cover {} by {} at that place: in degrees a drive of {}",
                    digits(*x),
                    digits(*y),
                    length(*metres)
                ),
                Some("--poses FILE with positions in metres (UTM, or odometry)".into()),
            ),
            Self::PoseUnit { speed, unit } => (
                format!("the positions are in {unit}, not in m"),
                format!("the mean speed would be {} m/s", digits(*speed)),
                Some(format!("[log] pose_unit = \"{unit}\" in the rig")),
            ),
            Self::Heading { form, fit, as_is, steps } => {
                let (cause, flag) = heading(*form);
                (
                    cause.into(),
                    format!(
                        "read so, they fit the direction of travel ({fit:.2} of 1 over {}), as they are they do not ({as_is:.2})",
                        count(*steps, "step")
                    ),
                    Some(flag.into()),
                )
            }
            _ => (String::new(), String::new(), None),
        }
    }

    fn of_echoes(&self) -> Words {
        match self {
            Self::GuessedResolution { near, echoes } => (
                "a range resolution of 1in was assumed, and makes echoes near".into(),
                format!("{near} of {}", count(*echoes, "echo")),
                Some("--range-resolution, if the ranges are finer".into()),
            ),
            Self::LittleResolved { resolved, arcs, sample: [none, shallow, of], min_angle, why } => {
                let angle = format!("{:.0}deg", min_angle.to_degrees());
                let mut evidence = format!("{resolved} of {} ({})", count(*arcs, "arc"), percent(*resolved, *arcs));
                if *of > 0 {
                    evidence += &format!(
                        "; {} are crossed by nothing on the way, {} below {angle} only",
                        percent(*none, *of),
                        percent(*shallow, *of)
                    );
                }
                let (more, flag) = unresolved(why, &angle);
                ("hardly anything is resolved".into(), evidence + &more, flag)
            }
            _ => (String::new(), String::new(), None),
        }
    }
}

/// Cause, evidence and cure.
type Words = (String, String, Option<String>);

const fn heading(form: HeadingForm) -> (&'static str, &'static str) {
    match form {
        HeadingForm::Degrees => ("the headings are in degrees", "[log] yaw_unit = \"1deg\" in the rig"),
        HeadingForm::Clockwise => ("the headings go clockwise", "[log] yaw_unit = \"-1rad\" in the rig"),
        HeadingForm::DegreesClockwise => {
            ("the headings are in degrees and go clockwise", "[log] yaw_unit = \"-1deg\" in the rig")
        }
        HeadingForm::Compass => {
            ("the headings are a compass's: clockwise from north", "a yaw of 90 degrees less the heading, in the log")
        }
        HeadingForm::DegreesCompass => (
            "the headings are a compass's: degrees clockwise from north",
            "a yaw of 90 degrees less the heading, in the log",
        ),
    }
}

/// What a cause of little being resolved adds to the evidence, and its cure.
fn unresolved(why: &Unresolved, angle: &str) -> (String, Option<String>) {
    match why {
        Unresolved::ShortMap { spans, needs, reach, by_count } => (
            format!(
                "; the local map spans {} of travel, crossings of {angle} at {} take {}",
                length(*spans),
                length(*reach),
                length(*needs)
            ),
            Some(if *by_count {
                "--history auto".into()
            } else {
                format!("--reach {}", length(*reach).replace(' ', ""))
            }),
        ),
        Unresolved::ShortPath { path, needs, reach } => (
            format!(
                "; the path is {} long, crossings of {angle} at {} take {}",
                length(*path),
                length(*reach),
                length(*needs)
            ),
            Some("a longer drive, or a smaller --min-angle".into()),
        ),
        Unresolved::Shallow => (String::new(), Some("a smaller --min-angle".into())),
        Unresolved::Pairs { count: pairs } => {
            (format!("; {} crossed by exactly two others", count(*pairs, "arc")), Some("--on-two mean".into()))
        }
        Unresolved::Uncrossed | Unresolved::Unknown => {
            (String::new(), Some("atm info, and the rig's field_of_view and mounts".into()))
        }
    }
}

/// Records that can't be used, with the usual cure of their kind.
fn unusable(reason: Reason, number: u64, first: &Problem) -> Words {
    let evidence = format!("{number} {}, first at {}: {}", reason.key(), first.place, first.value);
    let (cause, flag) = match reason {
        Reason::BadNumber => ("cells that are no numbers", Some("[log] in the rig, which says how a table is written")),
        Reason::BadPose => ("poses that are not finite", None),
        Reason::MissingField => {
            ("records that end early", Some("[log] delimiter in the rig, if cells are separated otherwise"))
        }
        Reason::UnknownSensor => {
            ("readings of sensors that the rig does not have", Some("--rig with a [[sensor]] of this id"))
        }
        Reason::NoPose => {
            ("readings without a pose on both sides", Some("--max-gap, if the robot is slow between its poses"))
        }
        Reason::TimeBackwards => ("records that are earlier than those before them", Some("the log sorted by t")),
        Reason::TooLong => ("records that are too long", None),
        Reason::ImpossibleMotion => (
            "poses that move faster than a robot does",
            Some("--max-speed, or [log] pose_unit and yaw_unit in the rig if the poses are in other units"),
        ),
        Reason::OtherRobot => ("readings of another robot", Some("--range-topics and --tf-topics of one robot")),
        Reason::TrailingData => ("bytes behind the end of the recording", None),
        Reason::NoStamp => ("messages without a time stamp", Some("--clock log")),
        Reason::SharedFrame => ("sensors that share a frame", Some("--range-topics, or --rig with topic")),
        Reason::BadLimits => {
            ("limits or beams that are none", Some("--rig with field_of_view, min_range and max_range"))
        }
        Reason::Tilted => ("sensors that look out of the plane", Some("--rig with the sensors' mounts")),
        Reason::NoTransform => (
            "sensors that no transform connects with the poses",
            Some("--rig with the sensors' mounts, --fixed-frame, or --poses"),
        ),
        Reason::Truncated | Reason::BadChunk => ("the file is damaged or ends early", None),
        _ => ("records that can't be used", None),
    };
    (cause.into(), evidence, flag.map(Into::into))
}

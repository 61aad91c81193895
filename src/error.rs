//! What can go wrong with a file, and where in it.
use std::{fmt, io, sync::Arc};

use thiserror::Error;

/// A place in a file: its name, the line, and the byte at which the record begins.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The file as the user named it; `-` is shown as `standard input`.
    pub file: Arc<str>,
    /// Line, from 1; 0 where lines mean nothing.
    pub line: u64,
    /// Offset of the record's first byte, from 0.
    pub byte: u64,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            0 => write!(f, "{}, byte {}", self.file, self.byte),
            line => write!(f, "{}:{line}", self.file),
        }
    }
}

/// Why one record of a log can't be used. The record is skipped and counted; the run goes on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Reason {
    /// A cell that should hold a number does not, or the number does not fit.
    BadNumber,
    /// A pose that is not finite.
    BadPose,
    /// The record ends before a column that is needed.
    MissingField,
    /// The rig has no sensor of this id.
    UnknownSensor,
    /// A truth file's cause that is none.
    UnknownCause,
    /// No pose within the gap on both sides of the reading.
    NoPose,
    /// The poses around the reading, or its own, move faster than a robot can.
    ImpossibleMotion,
    /// A reading of another robot than the one whose poses are used.
    OtherRobot,
    /// Bytes behind the end of a recording that are no recording.
    TrailingData,
    /// Earlier than the latest usable record.
    TimeBackwards,
    /// A record longer than [`crate::log::table::MAX_RECORD`] bytes, or than a recording's messages may be.
    TooLong,
    /// A message that is not what its schema says, or that nothing describes.
    BadMessage,
    /// A channel whose type can't be read.
    BadSchema,
    /// A chunk that can't be unpacked, or whose checksum is wrong.
    BadChunk,
    /// The file ends in the middle of something, or what follows is no record.
    Truncated,
    /// A message without a time stamp.
    NoStamp,
    /// A transform that is none, or that the tree of frames has no place for.
    BadTransform,
    /// The sensor's frame does not hang together with the frame of the poses.
    NoTransform,
    /// A sensor's readings under a second topic.
    SharedFrame,
    /// Limits that leave no range, or a beam that is none.
    BadLimits,
    /// A sensor that only says whether something is there (REP 117).
    FixedDistance,
    /// The boresight points out of the plane.
    Tilted,
}

impl Reason {
    /// The key under which the reason is counted in a summary.
    pub const fn key(self) -> &'static str {
        match self {
            Self::BadNumber => "bad_number",
            Self::BadPose => "bad_pose",
            Self::MissingField => "missing_field",
            Self::UnknownSensor => "unknown_sensor",
            Self::UnknownCause => "unknown_cause",
            Self::NoPose => "no_pose",
            Self::ImpossibleMotion => "impossible_motion",
            Self::OtherRobot => "other_robot",
            Self::TrailingData => "trailing_data",
            Self::TimeBackwards => "time_backwards",
            Self::TooLong => "too_long",
            Self::BadMessage => "bad_message",
            Self::BadSchema => "bad_schema",
            Self::BadChunk => "bad_chunk",
            Self::Truncated => "truncated",
            Self::NoStamp => "no_stamp",
            Self::BadTransform => "bad_transform",
            Self::NoTransform => "no_transform",
            Self::SharedFrame => "shared_frame",
            Self::BadLimits => "bad_limits",
            Self::FixedDistance => "fixed_distance",
            Self::Tilted => "tilted",
        }
    }
}

/// One unusable record: why, where, and what stood there.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// Why it can't be used.
    pub reason: Reason,
    /// Where it begins.
    pub place: Place,
    /// The offending value as it stands in the file (shortened), with its column where there is one.
    pub value: String,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}: {}", self.place, self.reason.key(), self.value)
    }
}

/// Why a run can't go on.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// The operating system's word on a file.
    #[error("{file}: {source}")]
    Io {
        /// The file.
        file: Arc<str>,
        /// What the system said.
        source: io::Error,
    },
    /// A file that is not what it has to be: encoding, header, columns.
    #[error("{place}: {message}")]
    Format {
        /// Where.
        place: Place,
        /// What is wrong, and what was expected.
        message: String,
    },
    /// A rig that can't be used.
    #[error("{file}: {message}")]
    Rig {
        /// The rig's file or name, with line where known.
        file: Arc<str>,
        /// The key, its value, and what was expected.
        message: String,
    },
    /// A world that can't be used.
    #[error("{file}: {message}")]
    World {
        /// The world's file or name, with line where known.
        file: Arc<str>,
        /// The key, its value, and what was expected.
        message: String,
    },
    /// Settings that contradict each other or ask for too much.
    #[error("{message}")]
    Settings {
        /// What is wrong.
        message: String,
    },
    /// A map that can't be had.
    #[error("{message}")]
    Map {
        /// What is wrong, and what would do.
        message: String,
    },
    /// Whoever watches the run has ended it.
    #[error("interrupted")]
    Interrupted,
    /// The first unusable record, where that is to end the run.
    #[error("{problem}")]
    Strict {
        /// The record.
        problem: Problem,
    },
}

/// Shorthand for this library.
pub type Result<T, E = Error> = std::result::Result<T, E>;

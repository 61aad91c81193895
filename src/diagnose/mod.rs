//! One catalogue of what is likely wrong with a log, with the evidence for it and what cures it.
//!
//! [`Evidence`] is gathered while a log is read, in memory that grows with the sensors alone. [`diagnose`] turns it into
//! [`Diagnosis`]es, each typed and with its numbers, and [`Diagnosis::advice`] puts them in words. `atm info`, the end of
//! `atm fuse`, its summary and Python say the same of the same log. A format that finds out more adds its own through
//! [`crate::log::Source::diagnoses`].
mod advice;
mod crossings;
mod diagnosis;
mod evidence;
mod heading;
mod histogram;
mod poses;
mod rules;
mod sensor;
pub(crate) mod words;

use std::fmt;

use serde::{Serialize, Serializer};

pub use self::{
    crossings::CrossingEvidence,
    diagnosis::{Diagnosis, HeadingForm, Unresolved},
    evidence::Evidence,
    poses::PoseEvidence,
    rules::{MapSpan, PAPER_REACH, Run, diagnose, guessed_resolution, map_travel},
    sensor::SensorEvidence,
};

/// A diagnosis in words.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Advice {
    /// What is likely wrong.
    pub cause: String,
    /// The numbers that say so.
    pub evidence: String,
    /// The flag or the rig's line that cures it, as it is to be written; `None` where the log itself has to change.
    pub flag: Option<String>,
}

impl fmt::Display for Advice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.cause, self.evidence)?;
        match &self.flag {
            Some(flag) => write!(f, "; try {flag}"),
            None => Ok(()),
        }
    }
}

impl fmt::Display for Diagnosis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.advice().fmt(f)
    }
}

/// As its [`Advice`].
impl Serialize for Diagnosis {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.advice().serialize(serializer)
    }
}

#[cfg(test)]
mod tests;

//! Echoes out of a recording that [`super::write`] made.

use std::sync::Arc;

use nalgebra::Point2;

use super::{
    decode::Sort,
    points::{Fault, Points, Wanted},
    write::{
        points::{KINDS, names},
        topics::ECHOES,
    },
};
use crate::{
    error::{Problem, Reason, Result},
    log::{Input, echo_table::Estimate},
};

/// What is read of a point, in this order.
const WANTED: [Wanted; 7] = [
    (&[names::EXACT_X, names::X], Sort::Real),
    (&[names::EXACT_Y, names::Y], Sort::Real),
    (&[names::RANGE], Sort::Real),
    (&[names::AZIMUTH], Sort::Real),
    (&[names::T], Sort::Whole),
    (&[names::SENSOR], Sort::Whole),
    (&[names::KIND], Sort::Whole),
];

/// The echoes of a recording, one after another in the order of the file, in bounded memory: the same as those of the table of
/// the same run.
///
/// They are read by the names of their fields; other fields are ignored.
pub struct McapEchoes {
    points: Points<{ WANTED.len() }>,
    /// The words for kinds, by their numbers.
    kinds: Vec<Arc<str>>,
}

impl McapEchoes {
    /// Opens the recording at `path`, which is read as a file where it is one, else the `input` that was opened for it.
    ///
    /// # Errors
    /// It can't be read, is no recording, or, where its summary tells, has no echoes.
    pub fn open(path: &str, input: Input) -> Result<Self> {
        let kinds = KINDS.iter().copied().map(Arc::from).collect();
        Ok(Self { points: Points::open(path, input, ECHOES, &WANTED)?, kinds })
    }

    /// The next usable echo, `None` at the end; those that can't be used are passed over and go to `problems`, as does what of the
    /// recording can't be used.
    ///
    /// # Errors
    /// The recording can't be read on, or has no echoes, or lacks a field of theirs.
    pub fn next_estimate(&mut self, problems: &mut dyn FnMut(Problem)) -> Result<Option<Estimate>> {
        while let Some(numbers) = self.points.next(problems)? {
            match self.estimate(numbers) {
                Ok(estimate) => return Ok(Some(estimate)),
                Err(fault) => problems(self.points.problem(fault)),
            }
        }
        Ok(None)
    }

    fn estimate(&self, [x, y, range, azimuth, t, sensor, kind]: [f64; WANTED.len()]) -> Result<Estimate, Fault> {
        let position = Point2::new(finite(names::X, x)?, finite(names::Y, y)?);
        let (range, azimuth) = (finite(names::RANGE, range)?, finite(names::AZIMUTH, azimuth)?);
        let key = (self.points.time(names::T, t)?, self.points.sensor(sensor)?);
        let word = self.kinds.get(kind as usize).map(Arc::clone);
        let word = word.ok_or_else(|| (Reason::BadNumber, format!("{} {kind}", names::KIND)))?;
        Ok(Estimate { position, key: Some(key), azimuth: Some(azimuth), range: Some(range), kind: Some(word) })
    }
}

/// A number that has to be one.
pub(super) fn finite(name: &str, value: f64) -> Result<f64, Fault> {
    if value.is_finite() { Ok(value) } else { Err((Reason::BadNumber, format!("{name} {value}"))) }
}

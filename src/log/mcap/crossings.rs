//! Crossings out of a recording that [`super::write`] made.

use nalgebra::Point2;

use super::{
    decode::Sort,
    echoes::finite,
    points::{Fault, Points, Wanted},
    write::{points::names, topics::CROSSING_POINTS},
};
use crate::{
    error::{Problem, Result},
    log::{Input, crossing_table::Crossing},
};

/// What is read of a point, in this order.
const WANTED: [Wanted; 6] = [
    (&[names::EXACT_X, names::X], Sort::Real),
    (&[names::EXACT_Y, names::Y], Sort::Real),
    (&[names::T], Sort::Whole),
    (&[names::SENSOR], Sort::Whole),
    (&[names::T_OTHER], Sort::Real),
    (&[names::SENSOR_OTHER], Sort::Whole),
];

/// The crossings of a recording, one after another in the order of the file, in bounded memory: the same as those of the table of
/// the same run, where their readings lie within 104 days.
pub struct McapCrossings {
    points: Points<{ WANTED.len() }>,
}

impl McapCrossings {
    /// Opens the recording at `path`, which is read as a file where it is one, else the `input` that was opened for it.
    ///
    /// # Errors
    /// It can't be read, is no recording, or, where its summary tells, has no crossings.
    pub fn open(path: &str, input: Input) -> Result<Self> {
        Ok(Self { points: Points::open(path, input, CROSSING_POINTS, &WANTED)? })
    }

    /// The next usable crossing, `None` at the end; those that can't be used are passed over and go to `problems`, as does what of
    /// the recording can't be used.
    ///
    /// # Errors
    /// The recording can't be read on, or has no crossings, or lacks a field of theirs.
    pub fn next_crossing(&mut self, problems: &mut dyn FnMut(Problem)) -> Result<Option<Crossing>> {
        while let Some(numbers) = self.points.next(problems)? {
            match self.crossing(numbers) {
                Ok(crossing) => return Ok(Some(crossing)),
                Err(fault) => problems(self.points.problem(fault)),
            }
        }
        Ok(None)
    }

    fn crossing(&self, [x, y, t, sensor, t_other, other]: [f64; WANTED.len()]) -> Result<Crossing, Fault> {
        let position = Point2::new(finite(names::X, x)?, finite(names::Y, y)?);
        let on = (self.points.time(names::T, t)?, self.points.sensor(sensor)?);
        let with = (self.points.time(names::T_OTHER, t_other)?, self.points.sensor(other)?);
        Ok(Crossing { on, with, position })
    }
}

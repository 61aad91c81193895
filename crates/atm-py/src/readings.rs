//! Readings in arrays: what Python hands over, checked, and looked at in place.

use atm::{rig::Rig, stamp, track::Pose};
use pyo3::prelude::*;

use crate::{
    argument,
    column::{Column, Held, HeldTimes, Shape, numbers, times},
    raise::{self, Fault},
    sensors::{ids, indices},
    time::{Clock, time_unit},
};

/// The arguments of a call, held for its time.
pub struct Arguments<'py> {
    times: HeldTimes<'py>,
    sensors: Vec<u16>,
    range: Held<'py, f64>,
    x: Held<'py, f64>,
    y: Held<'py, f64>,
    yaw: Held<'py, f64>,
    len: usize,
    /// Whether every argument was a single value.
    single: bool,
}

/// The arguments as Python gives them.
pub struct Given<'a, 'py> {
    pub t: &'a Bound<'py, PyAny>,
    pub sensor: &'a Bound<'py, PyAny>,
    pub range: &'a Bound<'py, PyAny>,
    pub x: &'a Bound<'py, PyAny>,
    pub y: &'a Bound<'py, PyAny>,
    pub yaw: &'a Bound<'py, PyAny>,
    pub sensor_index: Option<&'a Bound<'py, PyAny>>,
    pub t_unit: Option<&'a str>,
}

impl<'py> Arguments<'py> {
    /// Takes the arguments in; no copy of what is `float64` already.
    pub fn new(given: &Given<'_, 'py>, rig: &Rig, shape: Shape) -> PyResult<Self> {
        let times = times(given.t, shape, time_unit(given.t_unit)?)?;
        let sensors = match (given.sensor_index, given.sensor.is_none()) {
            (Some(index), true) => indices("sensor_index", index, rig, shape)?,
            (None, false) => ids(given.sensor, rig, shape)?,
            (Some(_), false) => return Err(raise::kind("sensor_index", "goes with sensor=None, not beside ids")),
            (None, true) => return Err(raise::kind("sensor", "None, and no sensor_index either")),
        };
        let (range, x) = (numbers("range_", given.range, shape)?, numbers("x", given.x, shape)?);
        let (y, yaw) = (numbers("y", given.y, shape)?, numbers("yaw", given.yaw, shape)?);
        let sensor_name = if given.sensor_index.is_some() { "sensor_index" } else { "sensor" };
        let lengths = [
            ("t", times.len()),
            (sensor_name, sensors.len()),
            ("range_", range.len()),
            ("x", x.len()),
            ("y", y.len()),
            ("yaw", yaw.len()),
        ];
        let len = common_length(&lengths)?;
        let sensors = sensors.spread(len.unwrap_or(1));
        Ok(Self { times, sensors, range, x, y, yaw, len: len.unwrap_or(1), single: len.is_none() })
    }

    /// How times were given.
    pub const fn clock(&self) -> Clock {
        self.times.clock
    }

    /// The readings.
    pub fn readings(&self) -> Readings<'_> {
        Readings {
            times: self.times.column(),
            sensors: &self.sensors,
            range: self.range.column(),
            x: self.x.column(),
            y: self.y.column(),
            yaw: self.yaw.column(),
            len: self.len,
            single: self.single,
        }
    }
}

fn common_length(lengths: &[(&str, Option<usize>)]) -> PyResult<Option<usize>> {
    let mut first: Option<(&str, usize)> = None;
    for &(name, len) in lengths {
        let Some(len) = len else { continue };
        match first {
            None => first = Some((name, len)),
            Some((_, expected)) if expected == len => {}
            Some((other, expected)) => {
                let message = format!("{len} items, but {other} has {expected}: from index {} on", len.min(expected));
                return Err(raise::value(name, message));
            }
        }
    }
    Ok(first.map(|(_, len)| len))
}

/// Readings side by side, in the order in which they were taken.
#[derive(Clone, Copy)]
pub struct Readings<'a> {
    times: Column<'a, i64>,
    sensors: &'a [u16],
    range: Column<'a, f64>,
    x: Column<'a, f64>,
    y: Column<'a, f64>,
    yaw: Column<'a, f64>,
    len: usize,
    single: bool,
}

impl Readings<'_> {
    /// How many.
    pub const fn len(&self) -> usize {
        self.len
    }

    /// Time in nanoseconds of one of them.
    #[inline]
    pub fn time(&self, index: usize) -> i64 {
        self.times.get(index, i64::MAX)
    }

    /// Its sensor and range.
    #[inline]
    pub fn measured(&self, index: usize) -> (u16, f64) {
        (self.sensors.get(index).copied().unwrap_or(u16::MAX), self.range.get(index, f64::NAN))
    }

    /// The robot's pose then.
    #[inline]
    pub fn pose(&self, index: usize) -> Pose {
        Pose { x: self.x.get(index, f64::NAN), y: self.y.get(index, f64::NAN), yaw: self.yaw.get(index, f64::NAN) }
    }

    /// A fault of one item of an argument, by its index where there is more than one.
    pub fn fault(&self, argument: &'static str, index: usize, message: String) -> Fault {
        Fault { argument, index: (!self.single).then_some(index), message }
    }

    /// Refuses times that go back, before `earliest` too, and poses that are not finite.
    pub fn check(&self, earliest: Option<i64>) -> Result<(), Fault> {
        self.check_order(earliest)?;
        for (argument, column) in [("x", &self.x), ("y", &self.y), ("yaw", &self.yaw)] {
            let wrong = |value: f64| (!value.is_finite()).then(|| format!("{} is not finite", argument::float(value)));
            if let Some((index, message)) = column.first(wrong) {
                return Err(Fault { argument, index, message });
            }
        }
        Ok(())
    }

    fn check_order(&self, earliest: Option<i64>) -> Result<(), Fault> {
        let mut latest = earliest.unwrap_or(i64::MIN);
        for index in 0..self.len {
            let t = self.time(index);
            if t < latest {
                let before = if index == 0 { "what was pushed before".into() } else { format!("t[{}]", index - 1) };
                let message = format!("{} s is earlier than {before}, {} s", stamp::text(t), stamp::text(latest));
                return Err(self.fault("t", index, message));
            }
            latest = t;
        }
        Ok(())
    }
}

//! The sensors of a robot: where they sit, what they see, and how its logs are written.
//!
//! A rig comes from TOML ([`Rig::load`]), from the built-in ones ([`Rig::builtin`]), or from code ([`Rig::ring`], [`Rig::new`]).
//! Whichever way, its invariants hold from then on: nothing behind a getter has to be checked again.
mod format;
mod read;

use std::{
    collections::HashMap,
    f64::consts::{PI, TAU},
    sync::Arc,
};

use nalgebra::{Isometry2, Translation2, UnitComplex};

pub use self::format::{LogFormats, TableFormat};
use crate::{
    error::{Error, Result},
    toml_document::{self, Kind},
};

/// Most sensors of a rig: their indices are 16 bits wide, and the count is, too.
pub const MAX_SENSORS: usize = u16::MAX as usize;
/// Largest rig file that is read, in bytes.
pub const MAX_FILE: u64 = toml_document::MAX_FILE;
/// Rig files.
const KIND: Kind = Kind { name: "rig", builtin: &Rig::BUILTIN, error: |file, message| Error::Rig { file, message } };

/// What a sensor sees: its beam and the ranges it measures. Checked where a [`Sensor`] is made of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ranging {
    /// Full beam angle, in radians, within (0, π]; `None` where the log or the command line has to say it.
    pub field_of_view: Option<f64>,
    /// Smallest range that is an echo, in metres, at least 0 and below `max_range`.
    pub min_range: f64,
    /// A reading at this range or beyond is no echo, in metres; +∞ without such a bound.
    pub max_range: f64,
    /// Step in which the sensor quantises ranges, in metres, above 0; `None` where it is not known.
    pub range_resolution: Option<f64>,
}

impl Default for Ranging {
    /// Unknown beam and step, every range from 0 on.
    fn default() -> Self {
        Self { field_of_view: None, min_range: 0.0, max_range: f64::INFINITY, range_resolution: None }
    }
}

/// A value out of its domain, by the key it has in a rig file.
struct Invalid {
    key: &'static str,
    message: &'static str,
}

impl Ranging {
    /// The first value out of its domain, if there is one. NaN is out of all of them.
    fn check(&self) -> Result<(), Invalid> {
        let invalid = |key, message| Err(Invalid { key, message });
        if self.field_of_view.is_some_and(|angle| !(angle > 0.0 && angle <= PI)) {
            return invalid("field_of_view", "must be above 0deg and at most 180deg");
        }
        if !(self.min_range >= 0.0 && self.min_range.is_finite()) {
            return invalid("min_range", "must be finite and not negative");
        }
        if self.max_range.is_nan() || self.max_range <= 0.0 {
            return invalid("max_range", "must be above zero");
        }
        if self.min_range >= self.max_range {
            return invalid("min_range", "must be less than max_range");
        }
        if self.range_resolution.is_some_and(|step| !(step > 0.0 && step.is_finite())) {
            return invalid("range_resolution", "must be finite and above zero");
        }
        Ok(())
    }
}

/// Which values of a sensor somebody gave. What is left open comes from the log where it says it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Given {
    mount: bool,
    min_range: bool,
    max_range: bool,
}

impl Given {
    /// A mount, and each limit that excludes anything.
    fn of(ranging: &Ranging) -> Self {
        Self { mount: true, min_range: ranging.min_range > 0.0, max_range: ranging.max_range.is_finite() }
    }
}

/// One range sensor on the robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensor {
    id: String,
    mount: Isometry2<f64>,
    ranging: Ranging,
    topic: Option<String>,
    given: Given,
}

impl Sensor {
    /// A sensor by its id in logs, its pose in the robot frame (metres; boresight along its x axis) and what it sees.
    ///
    /// Errors: an empty id, a mount that is not finite, a value of `ranging` out of its domain.
    pub fn new(id: impl Into<String>, mount: Isometry2<f64>, ranging: Ranging) -> Result<Self> {
        let id = id.into();
        let refuse = |message: String| Err(rig_error(&format!("sensor `{id}`"), message));
        if id.is_empty() {
            return refuse("the id must not be empty".to_owned());
        }
        let (position, boresight) = (mount.translation.vector, mount.rotation);
        if ![position.x, position.y, boresight.re, boresight.im].iter().all(|part| part.is_finite()) {
            return refuse("the mount must be finite".to_owned());
        }
        match ranging.check() {
            Ok(()) => Ok(Self { id, mount, ranging, topic: None, given: Given::of(&ranging) }),
            Err(Invalid { key, message }) => refuse(format!("{key} {message}")),
        }
    }

    /// The same sensor, found in logs under a topic or frame id.
    pub fn with_topic(self, topic: impl Into<String>) -> Self {
        Self { topic: Some(topic.into()), ..self }
    }

    /// The same sensor, with its mount left to the log. [`Self::mount`] stays as it is, for logs that say none.
    pub fn with_open_mount(mut self) -> Self {
        self.given.mount = false;
        self
    }

    /// The same sensor, with limits that somebody gave, even where they exclude nothing.
    fn with_given_limits(mut self, min_range: bool, max_range: bool) -> Self {
        self.given.min_range |= min_range;
        self.given.max_range |= max_range;
        self
    }

    /// Whether the rig says where the sensor sits; else a recording's transforms do.
    pub fn has_mount(&self) -> bool {
        self.given.mount
    }

    /// Smallest range that is an echo, in metres, where the rig says it.
    pub fn given_min_range(&self) -> Option<f64> {
        self.given.min_range.then_some(self.ranging.min_range)
    }

    /// Range from which on a reading is no echo, in metres, where the rig says it.
    pub fn given_max_range(&self) -> Option<f64> {
        self.given.max_range.then_some(self.ranging.max_range)
    }

    /// The id by which logs and outputs name the sensor; never empty.
    pub fn id(&self) -> &str {
        &self.id
    }

    /// Pose in the robot frame, in metres; the boresight is its x axis.
    pub fn mount(&self) -> Isometry2<f64> {
        self.mount
    }

    /// Beam and ranges.
    pub fn ranging(&self) -> Ranging {
        self.ranging
    }

    /// Full beam angle, in radians, within (0, π]; `None` where the rig does not say it.
    pub fn field_of_view(&self) -> Option<f64> {
        self.ranging.field_of_view
    }

    /// Smallest range that is an echo, in metres; at least 0.
    pub fn min_range(&self) -> f64 {
        self.ranging.min_range
    }

    /// Range from which on a reading is no echo, in metres, above [`Self::min_range`]; may be +∞.
    pub fn max_range(&self) -> f64 {
        self.ranging.max_range
    }

    /// Step of the ranges, in metres, above 0; `None` where the rig does not say it.
    pub fn range_resolution(&self) -> Option<f64> {
        self.ranging.range_resolution
    }

    /// Log topic or frame id of the sensor, where it is not its id.
    pub fn topic(&self) -> Option<&str> {
        self.topic.as_deref()
    }
}

/// All range sensors of a robot: 1 to [`MAX_SENSORS`] of them, each with an id of its own.
#[derive(Debug, Clone)]
pub struct Rig {
    name: String,
    sensors: Vec<Sensor>,
    log: Option<LogFormats>,
    log_keys: Vec<String>,
    ids: Vec<Arc<str>>,
    by_id: HashMap<Arc<str>, u16>,
}

impl Rig {
    /// Names of the built-in rigs.
    pub const BUILTIN: [&str; 2] = ["nomad200", "robond8"];

    /// A rig of the given sensors, whose indices are their places in the list.
    ///
    /// Errors: no sensors, more than [`MAX_SENSORS`], or two with one id.
    pub fn new(name: impl Into<String>, sensors: Vec<Sensor>) -> Result<Self> {
        let name = name.into();
        if sensors.is_empty() || sensors.len() > MAX_SENSORS {
            return Err(rig_error(&name, format!("{} sensors: must be 1 to {MAX_SENSORS}", sensors.len())));
        }
        let ids: Vec<Arc<str>> = sensors.iter().map(|sensor| Arc::from(sensor.id())).collect();
        let mut by_id = HashMap::with_capacity(sensors.len());
        for (index, id) in (0..=u16::MAX).zip(&ids) {
            if by_id.insert(id.clone(), index).is_some() {
                return Err(rig_error(&name, format!("two sensors have the id `{id}`")));
            }
        }
        Ok(Self { name, sensors, log: None, log_keys: Vec::new(), ids, by_id })
    }

    /// A rig named `ring`: sensors evenly on a circle of `radius` metres, looking outwards.
    ///
    /// Sensor i has the id of its number and sits at yaw `first_yaw` (radians) + i·2π/count, so they go counter-clockwise.
    ///
    /// Errors: a count outside 1 to [`MAX_SENSORS`], a radius that is negative or not finite, a yaw that is not finite, a
    /// value of `ranging` out of its domain.
    pub fn ring(count: usize, radius: f64, first_yaw: f64, ranging: Ranging) -> Result<Self> {
        const NAME: &str = "ring";
        match ring_sensors(count, radius, first_yaw, ranging) {
            Ok(sensors) => Self::new(NAME, sensors),
            Err(Invalid { key, message }) => Err(rig_error(NAME, format!("{key} {message}"))),
        }
    }

    /// A built-in rig; `None` where the name is not in [`Rig::BUILTIN`].
    pub fn builtin(name: &str) -> Option<Self> {
        let text = match name {
            "nomad200" => include_str!("../rig/nomad200.toml"),
            "robond8" => include_str!("../rig/robond8.toml"),
            _ => return None,
        };
        Self::parse(text, name).ok()
    }

    /// The built-in rig of this name, else the rig in this file (`./nomad200` is always a file).
    ///
    /// Errors: what the system says of the file, and what [`Rig::parse`] says of its content; a file above [`MAX_FILE`], a
    /// directory, text that is not UTF-8.
    pub fn load(name_or_path: &str) -> Result<Self> {
        match Self::builtin(name_or_path) {
            Some(rig) => Ok(rig),
            None => Self::parse(&KIND.read(name_or_path)?, name_or_path),
        }
    }

    /// The rig a TOML text describes; `file` is what errors call it, and its stem the name of a rig that has none.
    ///
    /// Errors name file, line and key: no TOML, an unknown key, a value of another kind or out of its domain, both a ring
    /// and single sensors or neither, two sensors with one id.
    pub fn parse(text: &str, file: &str) -> Result<Self> {
        read::rig(text, file)
    }

    /// The same rig under another name.
    pub fn with_name(self, name: impl Into<String>) -> Self {
        Self { name: name.into(), ..self }
    }

    /// The same rig, with how its logs are written.
    pub fn with_log(self, log: LogFormats) -> Self {
        Self { log: Some(log), ..self }
    }

    /// The same rig, with the keys that its file's `[log]` section has.
    fn with_log_keys(self, log_keys: Vec<String>) -> Self {
        Self { log_keys, ..self }
    }

    /// The keys of the rig file's `[log]` section; none where the formats come from code.
    pub fn log_keys(&self) -> &[String] {
        &self.log_keys
    }

    /// The same rig, with a beam, in radians within (0, π], for the sensors of which it does not say theirs.
    pub fn with_field_of_view(mut self, field_of_view: f64) -> Self {
        for sensor in &mut self.sensors {
            sensor.ranging.field_of_view.get_or_insert(field_of_view);
        }
        self
    }

    /// The rig's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The sensors, in the order of their indices; at least one.
    pub fn sensors(&self) -> &[Sensor] {
        &self.sensors
    }

    /// The sensors' ids, in the order of their indices.
    pub fn ids(&self) -> &[Arc<str>] {
        &self.ids
    }

    /// How a foreign table of this robot is written; `None` where it is not foreign.
    pub fn log(&self) -> Option<&LogFormats> {
        self.log.as_ref()
    }

    /// Index in [`Rig::sensors`] of the sensor with this id, in constant time.
    pub fn index_of(&self, id: &str) -> Option<u16> {
        self.by_id.get(id).copied()
    }
}

/// The sensors of [`Rig::ring`].
fn ring_sensors(count: usize, radius: f64, first_yaw: f64, ranging: Ranging) -> Result<Vec<Sensor>, Invalid> {
    let invalid = |key, message| Err(Invalid { key, message });
    if !(1..=MAX_SENSORS).contains(&count) {
        return invalid("count", "must be 1 to 65535");
    }
    if !(radius >= 0.0 && radius.is_finite()) {
        return invalid("radius", "must be finite and not negative");
    }
    if !first_yaw.is_finite() {
        return invalid("first_yaw", "must be finite");
    }
    ranging.check()?;
    let sensor = |i: usize| {
        let boresight = direction(first_yaw + i as f64 * TAU / count as f64);
        let position = Translation2::new(radius * boresight.re, radius * boresight.im);
        let mount = Isometry2::from_parts(position, boresight);
        Sensor { id: i.to_string(), mount, ranging, topic: None, given: Given::of(&ranging) }
    };
    Ok((0..count).map(sensor).collect())
}

/// The unit vector at an angle in radians: through libm, as the system's sine differs from machine to machine.
fn direction(yaw: f64) -> UnitComplex<f64> {
    UnitComplex::from_cos_sin_unchecked(libm::cos(yaw), libm::sin(yaw))
}

fn rig_error(file: &str, message: String) -> Error {
    Error::Rig { file: file.into(), message }
}

#[cfg(test)]
mod tests;

//! Which sensor a reading is of, and what it can see.

use std::{collections::BTreeMap, sync::Arc};

use atm_core::{Beam, Limits, RangeResolution};

use super::{decode::Measured, finding::Finding, rigid::Rigid, tally::Tally};
use crate::{
    error::Reason,
    log::csv::MAX_ID,
    pipeline::Defaults,
    rig::{Rig, Sensor},
    units::Scale,
};

/// What a reading's sensor sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sight {
    pub(super) limits: Limits<f64>,
    pub(super) beam: Beam<f64>,
    pub(super) range_resolution: RangeResolution<f64>,
}

/// How a recording's ranges are written, where a rig or an option says that they are not as their type has it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RangeFormat {
    /// From raw ranges and limits to metres.
    pub(super) unit: Scale,
    /// Raw ranges that stand for "no echo".
    pub(super) no_echo: Vec<f64>,
}

impl Default for RangeFormat {
    /// Metres, as `sensor_msgs/Range` has them.
    fn default() -> Self {
        Self { unit: Scale::SI, no_echo: Vec::new() }
    }
}

impl RangeFormat {
    /// As the rig's `[log]` section says; `unit` beats its `range_unit`.
    pub(super) fn new(rig: Option<&Rig>, unit: Option<Scale>) -> Self {
        let format = rig.and_then(Rig::log).map(|formats| &formats.readings);
        let own = Self::default();
        Self {
            unit: unit.or(format.map(|format| format.range)).unwrap_or(own.unit),
            no_echo: format.map(|format| format.no_echo.clone()).unwrap_or(own.no_echo),
        }
    }

    /// What a message says, in metres; a range that stands for "no echo" is infinite.
    pub(super) fn read(&self, raw: Measured) -> Measured {
        let metres = |raw: f64| if self.unit == Scale::SI { raw } else { self.unit.apply(raw) };
        // A decimal number is not the same one in 32 bits, as which most messages have it.
        let is = |value: f64| value == raw.range || (value as f32 == raw.range as f32 && single(raw.range));
        let range = if self.no_echo.iter().any(|value| is(*value)) { f64::INFINITY } else { metres(raw.range) };
        Measured { min: metres(raw.min), max: metres(raw.max), range, ..raw }
    }
}

/// Whether a number has no more bits than one of 32 bits can have.
fn single(value: f64) -> bool {
    f64::from(value as f32) == value
}

/// Why a reading is of no sensor, or can't be used.
pub(super) type Fault = (Reason, String);

/// The sensors of a recording: those of a rig, or those whose frames are named.
pub(super) struct Sensors {
    rig: Option<Arc<Rig>>,
    defaults: Defaults,
    format: RangeFormat,
    ids: Vec<Arc<str>>,
    /// By topic, frame and id.
    by_name: BTreeMap<Arc<str>, u16>,
    /// The topic of each sensor, once it has had a reading.
    topics: Vec<Option<Arc<str>>>,
    /// The beam that a sensor's last reading had.
    beams: Vec<Option<Beam<f64>>>,
    /// Sensors whose readings do not say their beam.
    blind: Vec<u16>,
    tallies: Vec<Tally>,
}

impl Sensors {
    pub(super) fn new(rig: Option<Arc<Rig>>, defaults: Defaults, unit: Option<Scale>) -> Self {
        let mut sensors = Self {
            rig: None,
            defaults,
            format: RangeFormat::new(rig.as_deref(), unit),
            ids: Vec::new(),
            by_name: BTreeMap::new(),
            topics: Vec::new(),
            beams: Vec::new(),
            blind: Vec::new(),
            tallies: Vec::new(),
        };
        if let Some(rig) = rig {
            for (index, sensor) in (0..=u16::MAX).zip(rig.sensors()) {
                sensors.by_name.entry(sensor.id().into()).or_insert(index);
            }
            // What a rig calls a sensor in logs comes before what it calls it itself.
            for (index, sensor) in (0..=u16::MAX).zip(rig.sensors()) {
                if let Some(topic) = sensor.topic() {
                    sensors.by_name.insert(topic.into(), index);
                }
            }
            sensors.ids = rig.ids().to_vec();
            sensors.rig = Some(rig);
        }
        sensors.grow();
        sensors
    }

    fn grow(&mut self) {
        self.topics.resize(self.ids.len(), None);
        self.beams.resize(self.ids.len(), None);
        self.tallies.resize(self.ids.len(), Tally::default());
    }

    pub(super) fn ids(&self) -> &[Arc<str>] {
        &self.ids
    }

    /// The topic of a sensor, once it has had a reading.
    pub(super) fn topic(&self, sensor: u16) -> Option<&Arc<str>> {
        self.topics.get(usize::from(sensor))?.as_ref()
    }

    fn of_rig(&self, sensor: u16) -> Option<&Sensor> {
        self.rig.as_ref()?.sensors().get(usize::from(sensor))
    }

    /// Where a sensor is on the robot, where a rig says that.
    pub(super) fn mount(&self, sensor: u16) -> Option<Rigid> {
        self.of_rig(sensor).filter(|sensor| sensor.has_mount()).map(|sensor| {
            let (at, boresight) = (sensor.mount().translation.vector, sensor.mount().rotation);
            Rigid::flat(at.x, at.y, boresight.re, boresight.im)
        })
    }

    /// The sensor of a reading: of the rig by its topic or frame, else by its frame.
    pub(super) fn find(&mut self, topic: &Arc<str>, frame: &str) -> Result<u16, Fault> {
        let frame = frame.strip_prefix('/').unwrap_or(frame);
        let known = self.by_name.get(&**topic).filter(|_| self.rig.is_some()).or_else(|| self.by_name.get(frame));
        let sensor = match known {
            Some(sensor) => *sensor,
            // A rig that says something of one sensor leaves the others to the recording.
            None => self.discover(frame)?,
        };
        let Some(owner) = self.topics.get_mut(usize::from(sensor)) else { return Ok(sensor) };
        match owner {
            Some(owner) if *owner != *topic => {
                let words = format!(
                    "the sensor of frame `{frame}` has its readings under {owner}; a rig with `topic = \"{topic}\"` and a mount \
                         makes another sensor of it (--rig), and --range-topics chooses"
                );
                Err((Reason::SharedFrame, words))
            }
            _ => {
                owner.get_or_insert_with(|| topic.clone());
                Ok(sensor)
            }
        }
    }

    /// A sensor that was not known before.
    fn discover(&mut self, frame: &str) -> Result<u16, Fault> {
        if frame.is_empty() || frame.len() > MAX_ID {
            let words = format!("a frame_id of {} bytes names no sensor; give a rig that knows the topic", frame.len());
            return Err((Reason::UnknownSensor, words));
        }
        let index = u16::try_from(self.ids.len()).ok().filter(|index| *index < u16::MAX);
        let index = index.ok_or_else(|| (Reason::UnknownSensor, "more sensors than there may be".to_owned()))?;
        let id: Arc<str> = frame.into();
        self.ids.push(id.clone());
        self.by_name.insert(id, index);
        self.grow();
        Ok(index)
    }

    /// A reading in metres, with "no echo" as the rig's `[log]` section says it.
    pub(super) fn in_metres(&self, raw: Measured) -> Measured {
        self.format.read(raw)
    }

    /// Ids of the rig's sensors that had no reading, and how many sensors the rig has.
    pub(super) fn unmatched(&self) -> (Vec<&str>, usize) {
        let count = self.rig.as_ref().map_or(0, |rig| rig.sensors().len());
        let silent = self.ids.iter().zip(&self.topics).take(count).filter(|(_, topic)| topic.is_none());
        (silent.map(|(id, _)| &**id).collect(), count)
    }

    /// What the sensor of a reading sees: as the rig says, else the reading, else the defaults.
    pub(super) fn sight(&mut self, sensor: u16, measured: Measured) -> Result<Sight, Fault> {
        let bad = |words: String| (Reason::BadLimits, words);
        let limits = limits(measured, self.of_rig(sensor))?;
        let ours = self.of_rig(sensor).and_then(Sensor::field_of_view);
        let theirs = Some(measured.field_of_view).filter(|angle| *angle != 0.0 && !angle.is_nan());
        let angle = match (ours, theirs, self.defaults.field_of_view) {
            (Some(angle), ..) | (None, Some(angle), _) => angle,
            (None, None, default) => {
                if let Err(at) = self.blind.binary_search(&sensor) {
                    self.blind.insert(at, sensor);
                }
                default.map_or(Defaults::FIELD_OF_VIEW, |beam| beam.field_of_view())
            }
        };
        let kept = self.beams.get(usize::from(sensor)).copied().flatten();
        let beam = match kept.filter(|beam| beam.field_of_view() == angle) {
            Some(beam) => beam,
            None => Beam::new(angle)
                .map_err(|error| bad(format!("a field_of_view of {angle}: {error}{}", beam_cure(angle))))?,
        };
        if let Some(kept) = self.beams.get_mut(usize::from(sensor)) {
            *kept = Some(beam);
        }
        let step = self.of_rig(sensor).and_then(Sensor::range_resolution).unwrap_or(Defaults::RANGE_RESOLUTION);
        let resolution = self.defaults.range_resolution.map_or_else(|| RangeResolution::new(step), Ok);
        let range_resolution = resolution.map_err(|error| bad(error.to_string()))?;
        let sight = Sight { limits, beam, range_resolution };
        if let Some(tally) = self.tallies.get_mut(usize::from(sensor)) {
            tally.add(&measured, &sight, ours.is_none() && theirs.is_some());
        }
        Ok(sight)
    }

    /// What is wrong with all readings of a sensor.
    pub(super) fn findings(&self) -> impl Iterator<Item = Finding> {
        self.ids.iter().zip(&self.tallies).flat_map(|(id, tally)| tally.findings(id))
    }

    /// Ids of sensors for whose beam a default had to do.
    pub(super) fn without_beam(&self) -> Vec<&str> {
        self.blind.iter().filter_map(|sensor| self.ids.get(usize::from(*sensor))).map(|id| &**id).collect()
    }
}

/// Between which distances a reading is an echo. A limit that the rig leaves open is the reading's; a reading whose limits are both
/// 0 says nothing.
fn limits(measured: Measured, sensor: Option<&Sensor>) -> Result<Limits<f64>, Fault> {
    let says_nothing = measured.min == 0.0 && measured.max == 0.0;
    let said = if says_nothing { (0.0, f64::INFINITY) } else { (measured.min, measured.max) };
    let min = sensor.and_then(Sensor::given_min_range).unwrap_or(said.0);
    let max = sensor.and_then(Sensor::given_max_range).unwrap_or(said.1);
    if min == max {
        let words = format!("min_range and max_range are both {min}: it only says whether something is there");
        return Err((Reason::FixedDistance, words));
    }
    Limits::new(min, max).map_err(|_| {
        let is = if min > max { "is above" } else { "goes with" };
        let cure = "min_range and max_range in a rig cure it (--rig)";
        (Reason::BadLimits, format!("min_range {min} {is} max_range {max}; {cure}"))
    })
}

/// What a beam that is none may be, and what to do.
fn beam_cure(angle: f64) -> String {
    let degrees = if angle > 0.0 && angle <= 180.0 { format!("; {angle} degrees?") } else { String::new() };
    format!("{degrees} A field_of_view in a rig cures it (--rig)")
}

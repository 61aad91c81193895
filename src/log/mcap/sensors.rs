//! Which sensor a reading is of, and what it can see.

use std::{collections::BTreeMap, sync::Arc};

use atm_core::{Beam, Limits, RangeResolution};

use super::{decode::Measured, rigid::Rigid};
use crate::{
    error::Reason,
    log::csv::MAX_ID,
    pipeline::Defaults,
    rig::{Rig, Sensor},
};

/// What a reading's sensor sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sight {
    pub(super) limits: Limits<f64>,
    pub(super) beam: Beam<f64>,
    pub(super) range_resolution: RangeResolution<f64>,
}

/// Why a reading is of no sensor, or can't be used.
pub(super) type Fault = (Reason, String);

/// The sensors of a recording: those of a rig, or those whose frames are named.
pub(super) struct Sensors {
    rig: Option<Arc<Rig>>,
    defaults: Defaults,
    ids: Vec<Arc<str>>,
    /// By topic, frame and id.
    by_name: BTreeMap<Arc<str>, u16>,
    /// The topic of each sensor, once it has had a reading.
    topics: Vec<Option<Arc<str>>>,
    /// The beam that a sensor's last reading had.
    beams: Vec<Option<Beam<f64>>>,
    /// Sensors whose readings do not say their beam.
    blind: Vec<u16>,
}

impl Sensors {
    pub(super) fn new(rig: Option<Arc<Rig>>, defaults: Defaults) -> Self {
        let mut sensors = Self {
            rig: None,
            defaults,
            ids: Vec::new(),
            by_name: BTreeMap::new(),
            topics: Vec::new(),
            beams: Vec::new(),
            blind: Vec::new(),
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
        self.of_rig(sensor).map(|sensor| {
            let (at, boresight) = (sensor.mount().translation.vector, sensor.mount().rotation);
            Rigid::flat(at.x, at.y, boresight.re, boresight.im)
        })
    }

    /// The sensor of a reading.
    pub(super) fn find(&mut self, topic: &Arc<str>, frame: &str) -> Result<u16, Fault> {
        let frame = frame.strip_prefix('/').unwrap_or(frame);
        let known = self.by_name.get(&**topic).filter(|_| self.rig.is_some()).or_else(|| self.by_name.get(frame));
        let sensor = match known {
            Some(sensor) => *sensor,
            None if self.rig.is_some() => {
                return Err((
                    Reason::UnknownSensor,
                    format!("the rig has no sensor of this topic or of frame `{frame}`"),
                ));
            }
            None => self.discover(frame)?,
        };
        let Some(owner) = self.topics.get_mut(usize::from(sensor)) else { return Ok(sensor) };
        match owner {
            Some(owner) if *owner != *topic => {
                let words =
                    format!("the sensor of frame `{frame}` has its readings under {owner}; choose with --range-topics");
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
            None => Beam::new(angle).map_err(|error| bad(format!("a field_of_view of {angle}: {error}")))?,
        };
        if let Some(kept) = self.beams.get_mut(usize::from(sensor)) {
            *kept = Some(beam);
        }
        let step = self.of_rig(sensor).and_then(Sensor::range_resolution).unwrap_or(Defaults::RANGE_RESOLUTION);
        let resolution = self.defaults.range_resolution.map_or_else(|| RangeResolution::new(step), Ok);
        let range_resolution = resolution.map_err(|error| bad(error.to_string()))?;
        Ok(Sight { limits, beam, range_resolution })
    }

    /// Ids of sensors for whose beam a default had to do.
    pub(super) fn without_beam(&self) -> Vec<&str> {
        self.blind.iter().filter_map(|sensor| self.ids.get(usize::from(*sensor))).map(|id| &**id).collect()
    }
}

/// Between which distances a reading is an echo. A rig that leaves both ends open leaves them to the reading; a reading whose
/// limits are both 0 says nothing.
fn limits(measured: Measured, sensor: Option<&Sensor>) -> Result<Limits<f64>, Fault> {
    if let Some(sensor) = sensor.filter(|sensor| sensor.min_range() > 0.0 || sensor.max_range().is_finite()) {
        let limits = Limits::new(sensor.min_range(), sensor.max_range());
        return limits.map_err(|error| (Reason::BadLimits, error.to_string()));
    }
    let Measured { min, max, .. } = measured;
    if min == 0.0 && max == 0.0 {
        return Ok(Limits::NONE);
    }
    if min == max {
        let words = format!("min_range and max_range are both {min}: it only says whether something is there");
        return Err((Reason::FixedDistance, words));
    }
    Limits::new(min, max).map_err(|_| (Reason::BadLimits, format!("min_range {min}, max_range {max}")))
}

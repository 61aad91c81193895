//! Sensors by their indices: their names, their frames, and where they sit.

use std::{collections::BTreeMap, sync::Arc};

use atm_core::Isometry2;

use super::{super::raw::Metadata, content::pose_of};
use crate::track::Pose;

/// The name of the metadata that hold sensors' ids by their indices, in decimal. A file may have several: sensors that became
/// known on the way.
pub const SENSORS: &str = "atm.sensors";

/// What is known of the sensors.
#[derive(Debug, Default)]
pub(super) struct Sensors {
    ids: Vec<Arc<str>>,
    /// Of the first ones, where they sit on the robot.
    mounts: Vec<Isometry2<f64>>,
}

impl Sensors {
    pub(super) fn new(mounts: Vec<Isometry2<f64>>) -> Self {
        Self { ids: Vec::new(), mounts }
    }

    /// Takes the ids of all sensors known now. Returns what has to be written of the new ones.
    pub(super) fn learn(&mut self, ids: &[Arc<str>]) -> Option<Metadata> {
        let known = self.ids.len();
        let new = ids.get(known..).filter(|new| !new.is_empty())?;
        self.ids.extend_from_slice(new);
        let entries: BTreeMap<String, String> =
            (known..).zip(new).map(|(index, id)| (index.to_string(), id.to_string())).collect();
        Some(Metadata { name: SENSORS.to_owned(), entries })
    }

    /// The id; the index in decimal where it is not known.
    pub(super) fn id(&self, sensor: u16) -> String {
        self.ids.get(usize::from(sensor)).map_or_else(|| sensor.to_string(), |id| id.to_string())
    }

    /// The frame: named as the sensor, but never as one of the frames it hangs on.
    pub(super) fn frame(&self, sensor: u16, above: [&str; 2]) -> String {
        let id = self.id(sensor);
        if above.contains(&id.as_str()) { format!("sensor/{id}") } else { id }
    }

    /// Whether it is known where the sensor sits without a reading of it.
    pub(super) fn is_mounted(&self, sensor: u16) -> bool {
        usize::from(sensor) < self.mounts.len()
    }

    /// The sensors of which that is known.
    pub(super) fn mounted(&self) -> impl Iterator<Item = (u16, Pose)> + '_ {
        (0..=u16::MAX).zip(&self.mounts).map(|(sensor, mount)| (sensor, pose_of(mount)))
    }
}

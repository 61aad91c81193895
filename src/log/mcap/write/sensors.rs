//! Sensors by their indices: their names and their frames.

use std::{collections::BTreeMap, sync::Arc};

use super::{super::raw::Metadata, options::Frames};

/// The name of the metadata that hold sensors' ids by their indices, in decimal. A file may have several: sensors that became
/// known on the way.
pub const SENSORS: &str = "atm.sensors";

/// What is known of the sensors.
#[derive(Debug, Default)]
pub(super) struct Sensors {
    ids: Vec<Arc<str>>,
}

impl Sensors {
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
    pub(super) fn frame(&self, sensor: u16, frames: &Frames) -> String {
        let id = self.id(sensor);
        if [&frames.fixed, &frames.robot].contains(&&id) { format!("sensor/{id}") } else { id }
    }
}

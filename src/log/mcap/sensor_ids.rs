//! The ids of sensors by the numbers under which a recording of echoes has them.

use std::{collections::BTreeMap, sync::Arc};

use super::{raw::Metadata, write::SENSORS};

/// Bytes of ids that are held, at most.
const MOST: usize = 16 << 20;

/// What is known of the sensors.
#[derive(Debug, Default)]
pub(super) struct SensorIds {
    /// `None` where two were told.
    ids: BTreeMap<u16, Option<Arc<str>>>,
    taken: usize,
}

impl SensorIds {
    /// Takes in what the recording says of its sensors; other metadata are not looked at. The words are what is wrong.
    pub(super) fn learn(&mut self, metadata: &Metadata) -> Result<(), String> {
        if metadata.name != SENSORS {
            return Ok(());
        }
        let mut wrong = None;
        for (index, id) in &metadata.entries {
            let Ok(index) = index.parse() else {
                wrong = Some(format!("the metadata {SENSORS} have {index:.40?}, which is no sensor's number"));
                continue;
            };
            match self.ids.get_mut(&index) {
                Some(Some(known)) if **known == **id => {}
                Some(known) => {
                    *known = None;
                    wrong = Some(format!("the metadata {SENSORS} have two ids of sensor {index}, such as {id:.40?}"));
                }
                None => {
                    self.taken += id.len();
                    if self.taken > MOST {
                        return Err(format!("the metadata {SENSORS} hold more than {} MiB of ids", MOST >> 20));
                    }
                    self.ids.insert(index, Some(Arc::from(id.as_str())));
                }
            }
        }
        wrong.map_or(Ok(()), Err)
    }

    /// The id of a sensor, by its number; the words are why there is none.
    pub(super) fn get(&self, index: f64) -> Result<Arc<str>, String> {
        // Indices are whole; what is beyond the largest is no sensor's.
        let number = (index <= f64::from(u16::MAX)).then_some(index as u16);
        match number.and_then(|number| self.ids.get(&number)) {
            Some(Some(id)) => Ok(Arc::clone(id)),
            Some(None) => Err(format!("sensor {index} has two ids")),
            None => Err(format!("sensor {index} has no id in the metadata {SENSORS} before it")),
        }
    }
}

//! A simulated drive as a recording, without a file between.

use std::sync::Arc;

use atm::{error::Result, intake::Defaults, log::Row};

use super::recording::{Recording, Replay};
use crate::{simulate::Simulation, truth::Truth};

/// The readings of a whole drive, and where each of them came from: what `atm simulate` would write, read back.
///
/// # Errors
/// A sensor that would be inside or behind a surface, or a drive that is too long to be kept.
pub fn simulated(simulation: &Simulation) -> Result<(Recording, Truth)> {
    let ids: Vec<Arc<str>> = simulation.rig().ids().to_vec();
    let (mut rows, mut truth) = (Vec::new(), Truth::default());
    for sweep in simulation.sweeps() {
        let sweep = sweep?;
        for ((sensor, _), point) in sweep.readings.iter().zip(&sweep.truth) {
            if let (Some(id), Some(point)) = (ids.get(usize::from(*sensor)), point) {
                truth.insert(sweep.t, id, *point);
            }
        }
        let (t, pose, readings) = (sweep.t, Some(sweep.pose), sweep.readings);
        rows.push(Row { t, log_time: t, pose, readings, ..Row::default() });
    }
    let sensors = Defaults::default().complete(simulation.rig())?;
    let mut log = Replay::new(&ids, &rows);
    Ok((Recording::read(&mut log, None, &sensors, false, &mut |_| ())?, truth))
}

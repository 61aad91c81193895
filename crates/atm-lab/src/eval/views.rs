//! From where a drive has looked, and what it could have seen from there.
use atm::{
    error::Result,
    intake::{self, AnyTrack, Consumer, Defaults, SensorModel},
    log::{Row, Source, View},
    rig::Rig,
    summary::{Dropped, Summary},
};
use atm_core::{Isometry2, Limits, Reading, UnitComplex, Vector2};

use crate::{thinned::Thinned, world::World};

/// The built-in rig whose beams look around where nothing is said of another.
pub const RIG: &str = "nomad200";
/// Most sweeps of a path that are looked from; of more, evenly spaced ones.
const MOST_SWEEPS: u64 = 10_000;

/// What the sensors of [`RIG`] see along the path of a world.
pub fn of_world(world: &World) -> Vec<View> {
    let rig = Rig::builtin(RIG);
    let sensors = rig.and_then(|rig| Defaults::default().complete(&rig).ok()).unwrap_or_default();
    let (path, mut views) = (world.path(), Vec::new());
    let step = usize::try_from(path.sweep_count().div_ceil(MOST_SWEEPS)).unwrap_or(usize::MAX);
    for (_, pose) in path.sweeps().step_by(step) {
        let heading = UnitComplex::from_cos_sin_unchecked(libm::cos(pose.yaw), libm::sin(pose.yaw));
        let robot = Isometry2::from_parts(Vector2::new(pose.x, pose.y).into(), heading);
        views.extend(sensors.iter().map(|sensor| View {
            pose: robot * sensor.mount,
            limits: sensor.limits,
            beam: sensor.beam,
            range_resolution: sensor.range_resolution,
        }));
    }
    views
}

/// What the readings of a log could have seen, those without an echo included, and the records that can't be used; of very
/// many readings, evenly spaced ones.
///
/// # Errors
/// The log can't be read on.
pub fn of_log(
    source: &mut dyn Source,
    track: Option<&mut AnyTrack>,
    sensors: &[SensorModel],
) -> Result<(Vec<View>, Dropped)> {
    let (mut looks, mut summary) = (Looks { sensors, views: Thinned::new() }, Summary::default());
    intake::read(source, track, sensors, false, &mut looks, &mut summary, &mut |_| {})?;
    Ok((looks.views.iter().copied().collect(), summary.dropped))
}

struct Looks<'a> {
    sensors: &'a [SensorModel],
    views: Thinned<View>,
}

impl Consumer for Looks<'_> {
    fn reading(&mut self, row: &Row, reading: &Reading<f64>, _summary: &mut Summary) -> Result<()> {
        let index = row.readings.iter().position(|(sensor, _)| *sensor == reading.sensor);
        let said = index.and_then(|index| row.views.get(index)).map(|view| view.limits);
        let modelled = self.sensors.get(usize::from(reading.sensor)).map(|sensor| sensor.limits);
        self.views.push(View {
            pose: reading.pose,
            limits: said.or(modelled).unwrap_or(Limits::NONE),
            beam: reading.beam,
            range_resolution: reading.range_resolution,
        });
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use atm::log::{
        Input,
        csv::{CsvReadings, PoseUse},
    };

    use super::*;

    #[test]
    fn a_path_is_looked_from_by_every_sensor_at_every_sweep() {
        let world = World::load("doorway", &[]).unwrap();
        let views = of_world(&world);
        assert_eq!(views.len() as u64, 16 * world.path().sweep_count());
        // Sensor 4 of the first sweep looks to the left from the rim of the ring, 9 in from its middle.
        let at = views[4].pose.translation.vector;
        assert!(at.x.abs() < 1e-12 && (at.y - 0.2286).abs() < 1e-12 && views[4].pose.rotation.re.abs() < 1e-12);
    }

    #[test]
    fn a_log_is_looked_from_by_every_reading_within_its_sensors_limits() {
        let rig = std::sync::Arc::new(Rig::builtin(RIG).unwrap());
        let sensors = Defaults::default().complete(&rig).unwrap();
        let text: &[u8] = b"t,sensor,range,x,y,yaw\n0,0,1,2,3,0\n1,0,inf,4,3,0\n2,0,soon,4,3,0\n";
        let input = Input { reader: Box::new(text), name: "log.csv".into(), length: None };
        let mut log = CsvReadings::new(input, &Default::default(), PoseUse::Needed, None, rig).unwrap();
        let (views, dropped) = of_log(&mut log, None, &sensors).unwrap();
        let places: Vec<f64> = views.iter().map(|view| view.pose.translation.vector.x).collect();
        assert_eq!((places, dropped.total()), (vec![2.2286, 4.2286], 1));
        assert_eq!(views[0].limits, sensors[0].limits);
    }
}

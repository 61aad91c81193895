//! Drives through worlds: what each beam hears, what disturbs it, and what the sensor makes of it.
//!
//! ```text
//! World ─ seed ─▶ Scene ─ beam ─▶ Reflection ─ layers ─▶ Sound ─ rounding, limits ─▶ reading
//! Path ─▶ true pose ─▶ beam          └────────────────────▶ truth
//!              └─ odometry ─▶ logged pose
//! ```
//! Whatever disturbs a drive is off unless it is asked for, and has random numbers of its own. The same world, rig, effects
//! and seed give the same bits on every machine.
mod beam;
mod dice;
mod diffuse;
mod effects;
mod layer;
mod multipath;
mod odometry;
mod scene;

use nalgebra::Isometry2;

pub use self::{
    beam::{Beam, MIRROR_SHARE},
    effects::Effects,
    scene::{Bump, MAX_DEPTH, MAX_SPACING, MIN_SPACING, Reflection, Scene},
};
use atm::{
    error::{Error, Result},
    intake::Defaults,
    rig::{Rig, Sensor},
    stamp,
    track::Pose,
};

use self::{
    dice::{Dice, Purpose},
    layer::{Layer, Listener, Sound},
    odometry::{Odometry, isometry},
};
use crate::{truth::TruthPoint, world::World};

/// Ranges are whole multiples of the sensor's step, and then whole nanometres, so that logs hold short decimals.
const NANOMETRES: f64 = 1e9;

/// A robot's drive through a world.
#[derive(Debug, Clone)]
pub struct Simulation {
    scene: Scene,
    rig: Rig,
    effects: Effects,
    seed: u64,
}

/// The readings of one instant.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// Time in nanoseconds, from 0 on.
    pub t: i64,
    /// Where the robot really is.
    pub true_pose: Pose,
    /// Where it believes to be.
    pub pose: Pose,
    /// Sensor index and range in metres, one for each sensor. +Inf is nothing in reach, −Inf something too close.
    pub readings: Vec<(u16, f64)>,
    /// What each of the readings came from; `None` where it is no echo.
    pub truth: Vec<Option<TruthPoint>>,
}

impl Simulation {
    /// The drive of a robot along the world's path; `field_of_view` is the full beam of sensors of which the rig does not
    /// say it, in radians, within (0, π].
    pub fn new(world: World, rig: Rig, field_of_view: f64, effects: Effects, seed: u64) -> Self {
        let rig = rig.with_field_of_view(field_of_view);
        Self { scene: Scene::new(world, seed), rig, effects, seed }
    }

    /// The world with its bumps drawn.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The sensors, their beams completed.
    pub fn rig(&self) -> &Rig {
        &self.rig
    }

    /// All sweeps of the drive, from the first on.
    ///
    /// # Errors
    /// A sensor that would be inside or behind a surface.
    pub fn sweeps(&self) -> impl Iterator<Item = Result<Sweep>> {
        let mut layers = self.effects.layers(self.seed);
        let mut odometry = Odometry::new(&self.effects, Dice::new(self.seed, Purpose::Odometry));
        self.scene.world().path().sweeps().map(move |(t, true_pose)| {
            let pose = odometry.believe(true_pose);
            let mut sweep = Sweep { t, true_pose, pose, readings: Vec::new(), truth: Vec::new() };
            for (index, sensor) in (0..=u16::MAX).zip(self.rig.sensors()) {
                let (range, truth) = self.reading(t, true_pose, sensor, &mut layers)?;
                sweep.readings.push((index, range));
                sweep.truth.push(truth);
            }
            Ok(sweep)
        })
    }

    /// What one sensor reports at a pose, and what it comes from.
    fn reading(
        &self,
        t: i64,
        robot: Pose,
        sensor: &Sensor,
        layers: &mut [Box<dyn Layer>],
    ) -> Result<(f64, Option<TruthPoint>)> {
        let robot = isometry(robot);
        let listener =
            Listener { pose: robot * sensor.mount(), min_range: sensor.min_range(), max_range: sensor.max_range() };
        self.check(t, &robot, &listener, sensor)?;
        let beam = Beam::new(&listener.pose, sensor.field_of_view().unwrap_or(Defaults::FIELD_OF_VIEW));
        let source = self.reflection(&beam, listener.max_range);
        let mut sound = Sound { range: source.map(|source| source.range), source };
        for layer in layers {
            layer.apply(&mut sound, &listener);
        }
        let range = reported(sound.range, sensor);
        let truth = sound.source.filter(|_| range.is_finite()).map(|source| TruthPoint {
            position: source.point,
            azimuth: source.azimuth,
            cause: source.cause,
        });
        Ok((range, truth))
    }

    /// The nearest point that a beam hears; over mirrors, too, where that is switched on.
    fn reflection(&self, beam: &Beam, max_range: f64) -> Option<Reflection> {
        let direct = self.scene.direct(beam, f64::INFINITY);
        if !self.effects.multipath {
            return direct;
        }
        let limit = direct.map_or(max_range, |reflection| reflection.range);
        multipath::nearest(&self.scene, beam, limit).or(direct)
    }

    /// Refuses a sensor that something separates from its robot.
    fn check(&self, t: i64, robot: &Isometry2<f64>, listener: &Listener, sensor: &Sensor) -> Result<()> {
        let world = self.scene.world();
        let (middle, at) = (robot.translation.vector.into(), listener.pose.translation.vector.into());
        if world.sees(middle, at, &[]) {
            return Ok(());
        }
        let (id, time) = (sensor.id(), stamp::text(t));
        let message =
            format!("at t = {time} s sensor {id} would be inside or behind a surface: the path is too close to it");
        Err(Error::World { file: world.name().into(), message })
    }
}

/// What a sensor reports of an echo: a whole number of its steps, +∞ at or beyond its reach or without an echo, −∞ below it.
fn reported(range: Option<f64>, sensor: &Sensor) -> f64 {
    let Some(range) = range else { return f64::INFINITY };
    let range = match sensor.range_resolution() {
        Some(step) => (((range / step).round() * step) * NANOMETRES).round() / NANOMETRES,
        None => range,
    };
    if range >= sensor.max_range() {
        f64::INFINITY
    } else if range < sensor.min_range() {
        f64::NEG_INFINITY
    } else {
        range
    }
}

#[cfg(test)]
mod tests;

//! Random logs: rigs, paths, worlds of a few points, and every way in which sensors fire, fall silent and fail.

use std::f64::consts::{PI, TAU};

use atm::core::{OnNone, OnTwo};
use rand_chacha::{
    ChaCha8Rng,
    rand_core::{Rng, SeedableRng},
};

use crate::log::{Log, Rules, Sample};

/// Random numbers that are the same on every run and machine.
pub struct Draws(ChaCha8Rng);

impl Draws {
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64)
    }

    fn chance(&mut self, share: f64) -> bool {
        self.between(0.0, 1.0) < share
    }

    fn below(&mut self, count: usize) -> usize {
        (self.0.next_u64() % count as u64) as usize
    }

    fn one_of<V: Copy>(&mut self, values: &[V]) -> V {
        values[self.below(values.len())]
    }
}

/// What is fixed about a log before it is drawn.
#[derive(Debug, Clone, Copy)]
pub struct Frame {
    /// Sensors and H, where they are not free.
    pub size: Option<(usize, usize)>,
    /// The smallest θmin, in radians.
    pub least_angle: f64,
}

struct Sensor {
    mount: [f64; 3],
    field_of_view: f64,
    range_resolution: f64,
    limits: [f64; 2],
    weight: f64,
}

#[derive(Clone, Copy, PartialEq)]
enum Motion {
    Walk,
    Straight,
    Turn,
    Still,
    StopAndGo,
}

#[derive(Clone, Copy, PartialEq)]
enum Firing {
    RoundRobin,
    Any,
    Uneven,
    Bursts,
}

struct Robot {
    motion: Motion,
    pace: f64,
    going: bool,
    position: [f64; 2],
    yaw: f64,
}

/// One random log.
pub fn log(frame: Frame, draws: &mut Draws) -> Log {
    let firing = draws.one_of(&[Firing::RoundRobin, Firing::Any, Firing::Uneven, Firing::Bursts]);
    let free = draws.below(8) + 1;
    let deep = if matches!(firing, Firing::Uneven | Firing::Bursts) { 4 } else { 20 };
    let (sensors, history) = frame.size.unwrap_or((free, draws.below(deep) + 1));
    let rig = rig(sensors, firing, draws);
    let rules = rules(sensors, history, frame, draws);
    let samples = samples(&rig, firing, (sensors * history * 3).clamp(60, 240), draws);
    let snapshots = (0..3).map(|_| draws.below(samples.len())).collect();
    Log { rules, samples, snapshots }
}

fn rules(sensors: usize, history: usize, frame: Frame, draws: &mut Draws) -> Rules {
    let min_angle = match draws.below(3) {
        0 => 30f64.to_radians(),
        1 => draws.between(frame.least_angle, PI / 4.0),
        _ => draws.between(frame.least_angle, PI / 2.0),
    };
    Rules {
        sensors,
        history,
        min_angle,
        on_none: draws.one_of(&[OnNone::Center, OnNone::Center, OnNone::Drop]),
        on_two: draws.one_of(&[OnTwo::Drop, OnTwo::Center, OnTwo::Mean]),
        // Whole ticks, so that ages equal to the bound occur.
        max_age: draws.chance(0.3).then(|| TICK as u64 * (1 + draws.below(60) as u64)),
        max_travel: draws.chance(0.3).then(|| draws.between(0.1, 2.0)),
        min_step: draws.chance(0.2).then(|| draws.between(0.005, 0.1)),
        drop_held: draws.chance(0.2),
        span: draws.chance(0.5).then(|| [draws.between(0.1, 3.0), 0.0]),
    }
}

fn rig(sensors: usize, firing: Firing, draws: &mut Draws) -> Vec<Sensor> {
    let beam = |draws: &mut Draws| match draws.below(4) {
        0 => 22.5f64.to_radians(),
        1 => PI,
        2 => draws.between(45.0, 180.0).to_radians(),
        _ => draws.between(2.0, 180.0).to_radians(),
    };
    let step = |draws: &mut Draws| draws.one_of(&[0.005, 0.01, 0.0254, 0.05]);
    let (shared_beam, shared_step, ring) = (beam(draws), step(draws), draws.chance(0.3));
    (0..sensors)
        .map(|index| {
            let direction = TAU * index as f64 / sensors as f64;
            let anywhere = [draws.between(-0.3, 0.3), draws.between(-0.3, 0.3), draws.between(-PI, PI)];
            let on_ring = [0.2286 * libm::cos(direction), 0.2286 * libm::sin(direction), direction];
            Sensor {
                mount: if ring { on_ring } else { anywhere },
                field_of_view: if draws.chance(0.3) { beam(draws) } else { shared_beam },
                range_resolution: if draws.chance(0.3) { step(draws) } else { shared_step },
                limits: draws.one_of(&[[0.0, f64::INFINITY], [0.15, 6.477], [0.0, 4.0]]),
                weight: if firing == Firing::Uneven && draws.chance(0.5) { 0.02 } else { 1.0 },
            }
        })
        .collect()
}

/// Nanoseconds; times are whole multiples of it.
const TICK: i64 = 10_000_000;

fn samples(rig: &[Sensor], firing: Firing, count: usize, draws: &mut Draws) -> Vec<Sample> {
    let motion =
        draws.one_of(&[Motion::Walk, Motion::Walk, Motion::Straight, Motion::Turn, Motion::Still, Motion::StopAndGo]);
    let (x, y, yaw) = (draws.between(-2.0, 2.0), draws.between(-2.0, 2.0), draws.between(-PI, PI));
    let mut robot = Robot { motion, pace: draws.between(0.005, 0.15), going: true, position: [x, y], yaw };
    let world: Vec<[f64; 2]> =
        (0..draws.below(12) + 2).map(|_| [draws.between(-4.0, 4.0), draws.between(-4.0, 4.0)]).collect();
    let noise = draws.one_of(&[0.0, 0.004, 0.02]);
    let quantised = draws.chance(0.5);
    let coarsening = if draws.chance(0.2) { 0.01 } else { 0.0 };
    let at_one_pose = if draws.chance(0.3) { rig.len() } else { 1 };
    let mut t = draws.one_of(&[0, -3_000_000_000, 1_700_000_000_000_000_000]);
    let mut samples = Vec::with_capacity(count);
    let mut fires = 0;
    for index in 0..count {
        fires = next_to_fire(fires, index, rig, firing, draws);
        if index % at_one_pose == 0 {
            robot.go(draws);
            t += TICK * draws.below(4) as i64;
        }
        let sensor = &rig[fires];
        let (sin, cos) = libm::sincos(robot.yaw);
        let [x, y, turn] = sensor.mount;
        let position = [robot.position[0] + cos * x - sin * y, robot.position[1] + sin * x + cos * y];
        let boresight = robot.yaw + turn;
        let distance = nearest(&world, position, boresight, sensor.field_of_view)
            .map(|distance| distance + draws.between(-noise, noise))
            .filter(|_| draws.chance(0.9))
            .unwrap_or_else(|| draws.between(0.1, 5.0));
        let range_resolution = sensor.range_resolution + coarsening * distance;
        let step = sensor.range_resolution;
        let mut sample = Sample {
            t,
            sensor: fires as u16,
            range: if quantised { libm::round(distance / step) * step } else { distance },
            limits: sensor.limits,
            position,
            boresight: [libm::cos(boresight), libm::sin(boresight)],
            robot: robot.position,
            field_of_view: sensor.field_of_view,
            range_resolution,
        };
        if draws.chance(0.08) {
            sample.range = no_echo(sensor.limits, draws);
        }
        if draws.chance(0.02) {
            spoil(&mut sample, rig.len(), draws);
        }
        samples.push(sample);
    }
    samples
}

fn next_to_fire(last: usize, index: usize, rig: &[Sensor], firing: Firing, draws: &mut Draws) -> usize {
    match firing {
        Firing::RoundRobin => index % rig.len(),
        Firing::Any => draws.below(rig.len()),
        Firing::Bursts => {
            if draws.chance(0.92) {
                last
            } else {
                draws.below(rig.len())
            }
        }
        Firing::Uneven => loop {
            let sensor = draws.below(rig.len());
            if draws.chance(rig[sensor].weight) {
                return sensor;
            }
        },
    }
}

impl Robot {
    fn go(&mut self, draws: &mut Draws) {
        if self.motion == Motion::StopAndGo && draws.chance(0.1) {
            self.going = !self.going;
        }
        if self.motion == Motion::Still || !self.going {
            return;
        }
        if self.motion == Motion::Turn {
            self.yaw += self.pace;
            return;
        }
        // Back into the world.
        if libm::hypot(self.position[0], self.position[1]) > 4.0 {
            self.yaw = libm::atan2(-self.position[1], -self.position[0]);
        }
        let mut stride = self.pace;
        if self.motion != Motion::Straight {
            self.yaw += draws.between(-0.4, 0.4);
            stride *= draws.between(0.0, 2.0);
        }
        self.position[0] += stride * libm::cos(self.yaw);
        self.position[1] += stride * libm::sin(self.yaw);
    }
}

/// Distance of the nearest point of the world within the beam.
fn nearest(world: &[[f64; 2]], from: [f64; 2], boresight: f64, field_of_view: f64) -> Option<f64> {
    world
        .iter()
        .map(|point| [point[0] - from[0], point[1] - from[1]])
        .filter(|[x, y]| libm::remainder(libm::atan2(*y, *x) - boresight, TAU).abs() <= field_of_view / 2.0)
        .map(|[x, y]| libm::hypot(x, y))
        .min_by(f64::total_cmp)
}

/// Every way of saying that there was no echo.
fn no_echo([min, max]: [f64; 2], draws: &mut Draws) -> f64 {
    draws.one_of(&[f64::INFINITY, max, max + 1.0, f64::NEG_INFINITY, min * 0.9, 0.0, f64::NAN, -0.5])
}

/// Makes a record unusable.
fn spoil(sample: &mut Sample, sensors: usize, draws: &mut Draws) {
    match draws.below(6) {
        0 => sample.sensor = (sensors + draws.below(3)) as u16,
        1 => sample.position[draws.below(2)] = draws.one_of(&[f64::NAN, f64::INFINITY]),
        2 => sample.robot[draws.below(2)] = draws.one_of(&[f64::NAN, f64::NEG_INFINITY]),
        3 => sample.boresight = [0.0, 0.0],
        4 => sample.boresight = [1.1, 0.3],
        _ => sample.t -= 1 + draws.below(5) as i64 * TICK,
    }
}

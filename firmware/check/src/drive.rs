//! The recorded log: a ring of sonars driven to and fro through the corridor of the sample log, past the doorway.

use std::f64::consts::PI;

use atm::{error::Result, units::inches};
use atm_lab::{
    simulate::{Beam, Scene},
    world::World,
};
use nalgebra::{Isometry2, Point2, UnitComplex, Vector2};
use replay::{HEADER, SENSORS, Sweep};

/// Seed of the sample log's world.
const SEED: u64 = 1;
/// Radius of the ring.
const RING_RADIUS: f64 = inches(9.0);
/// Full beam of one sensor, as wide as the step from one sensor to the next.
const FIELD_OF_VIEW: f64 = PI / 8.0;
/// Length of one weave: the far jamb of the opening.
const WEAVE: f64 = inches(138.0);

/// Lanes that are driven, the odd ones backwards along x.
const LANES: u32 = 5;
/// Sweeps along a lane, 5 in apart, as in the sample log.
const ALONG: u32 = 48;
/// Sweeps in which the robot turns round at a lane's end, on the spot.
const TURN: u32 = 6;

/// The log's bytes. The same on every machine: trigonometry goes through `libm`.
///
/// # Errors
/// None that is known: the world is built in.
pub fn record() -> Result<Vec<u8>> {
    let scene = Scene::new(World::load("doorway", &[])?, SEED);
    let mut log = HEADER.to_vec();
    for (number, (position, yaw)) in poses().into_iter().enumerate() {
        log.extend(sweep(&scene, number as u32, position, yaw).to_bytes());
    }
    Ok(log)
}

/// Where the robot is at each sweep: a weaving lane, half a turn, the next lane back.
fn poses() -> Vec<(Point2<f64>, f64)> {
    let mut poses = Vec::new();
    for lane in 0..LANES {
        let middle = inches(8.0 * f64::from(lane) - 12.0);
        let backwards = lane % 2 == 1;
        let along = |step: u32| inches(5.0) * f64::from(if backwards { ALONG - step } else { step });
        let weave = |x: f64| (inches(3.0) * libm::sin(x * 2.0 * PI / WEAVE) + middle, x);
        for step in 0..ALONG {
            let ((y, x), (ahead_y, ahead_x)) = (weave(along(step)), weave(along(step + 1)));
            poses.push((Point2::new(x, y), libm::atan2(ahead_y - y, ahead_x - x)));
        }
        let (y, x) = weave(along(ALONG));
        let from = if backwards { PI } else { 0.0 };
        for step in 0..TURN {
            let turned = PI * f64::from(step) / f64::from(TURN);
            poses.push((Point2::new(x, y), if backwards { from + turned } else { from - turned }));
        }
    }
    poses
}

fn sweep(scene: &Scene, number: u32, position: Point2<f64>, yaw: f64) -> Sweep {
    let mut ranges = [f32::NAN; SENSORS];
    for (sensor, range) in (0u32..).zip(&mut ranges) {
        let look = yaw + FIELD_OF_VIEW * f64::from(sensor);
        let mount = Vector2::new(libm::cos(look), libm::sin(look)) * RING_RADIUS;
        let turn = UnitComplex::from_cos_sin_unchecked(libm::cos(look), libm::sin(look));
        let beam = Beam::new(&Isometry2::from_parts((position + mount).into(), turn), FIELD_OF_VIEW);
        *range = reading(scene.direct(&beam, f64::INFINITY).map(|heard| heard.range));
    }
    Sweep {
        milliseconds: number * 1000,
        position: [position.x as f32, position.y as f32],
        heading: [libm::cos(yaw) as f32, libm::sin(yaw) as f32],
        ranges,
    }
}

/// What the sonar reports of an echo at `range` metres: whole inches; −∞ nearer than 6 in, +∞ from 255 in on.
fn reading(range: Option<f64>) -> f32 {
    match range.map(|range| (range / inches(1.0)).round()) {
        None => f32::INFINITY,
        Some(count) if count >= 255.0 => f32::INFINITY,
        Some(count) if count < 6.0 => f32::NEG_INFINITY,
        Some(count) => inches(count) as f32,
    }
}

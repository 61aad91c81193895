//! Readings to fuse, as the pipeline hands them over, without a file or a parser in the way.

use std::sync::Arc;

use atm::{
    core::{
        Beam, Bounds, Echo, Fuser, Isometry2, Limits, Point2, RangeResolution, Reading, Storage, TransversalMedian,
        Vector2,
    },
    log::{
        Input, Next, Row, Source,
        csv::{CsvReadings, PoseUse},
    },
    pipeline::{Defaults, readings},
    rig::{Rig, TableFormat},
};

/// An inch, in metres: the quantisation step of the ranges.
const INCH: f64 = 0.0254;

/// The sample's readings: 16 sensors.
pub fn doorway() -> Vec<Reading<f64>> {
    let rig = Arc::new(Rig::builtin("nomad200").expect("it is built in"));
    let sensors = Defaults::default().complete(&rig).expect("the built-in rig is complete");
    let input = Input::open(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/doorway.csv")).expect("the sample is there");
    let mut log = CsvReadings::new(input, &TableFormat::default(), PoseUse::Needed, None, rig).expect("it is a log");
    let (mut row, mut all) = (Row::default(), Vec::new());
    while log.next_row(&mut row, &mut |problem| panic!("{problem}")).expect("it can be read") == Next::Record {
        all.extend(readings(&row, row.pose.expect("it has poses"), &sensors));
    }
    all
}

/// `sweeps` sweeps of a ring of `sensors`, driven round a room of 8 m by 6 m, an inch between two sweeps.
pub fn room(sensors: u16, sweeps: u32) -> Vec<Reading<f64>> {
    let beam = Beam::new(22.5f64.to_radians()).expect("a beam");
    let range_resolution = RangeResolution::new(INCH).expect("a step");
    let limits = Limits::new(0.15, 6.5).expect("limits");
    let mut all = Vec::new();
    for sweep in 0..sweeps {
        let along = f64::from(sweep) * INCH / 2.0;
        let robot = Isometry2::new(Vector2::new(2.0 * libm::cos(along), 1.5 * libm::sin(along)), along + 1.6);
        for sensor in 0..sensors {
            let mount = std::f64::consts::TAU * f64::from(sensor) / f64::from(sensors);
            let pose = robot * Isometry2::new(Vector2::new(libm::cos(mount), libm::sin(mount)) * 0.23, mount);
            all.push(Reading {
                t: i64::from(sweep) * 100_000_000,
                sensor,
                range: limits.classify((wall(&pose) / INCH).round() * INCH),
                pose,
                robot: Point2::from(robot.translation.vector),
                beam,
                range_resolution,
            });
        }
    }
    all
}

/// How far it is along the boresight to the wall of the room.
fn wall(pose: &Isometry2<f64>) -> f64 {
    let (position, ahead) = (pose.translation.vector, pose.rotation);
    let along = |half: f64, from: f64, step: f64| (half.copysign(step) - from) / step;
    along(4.0, position.x, ahead.re).min(along(3.0, position.y, ahead.im))
}

/// A fuser of the paper's estimator in one of the two modes over the readings; the sum of all x.
pub fn run<S: Storage<f64>>(mut fuser: Fuser<f64, S>, readings: &[Reading<f64>]) -> f64 {
    let mut sum = 0.0;
    let mut sink = |echo: &Echo<f64>| sum += echo.position.x;
    for reading in readings {
        // Every reading can be used.
        let _ = std::hint::black_box(fuser.push(std::hint::black_box(reading), &mut sink));
    }
    fuser.finish(&mut sink);
    sum
}

/// The estimator and bounds of every run here.
pub const PAPER: (TransversalMedian<f64>, Bounds<f64>) = (TransversalMedian::PAPER, Bounds::NONE);

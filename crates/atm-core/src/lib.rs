//! The arc-transversal median (Choset, Nagatani, Lazar: *The Arc-Transversal Median Algorithm: A Geometric Approach to
//! Increasing Ultrasonic Sensor Azimuth Accuracy*, IEEE Transactions on Robotics and Automation 19(3), 2003): sharp echo
//! points from wide-beam range sensors on a moving robot. `no_std`, no heap, no panics.
//!
//! # The pipeline
//! ```text
//! Reading ─ Limits::classify ─▶ Range ─ Arc::new ─▶ Arc ─▶ local map ─▶ crossings ─▶ median ─▶ Echo ─▶ Sink
//! ```
//! | step | where | in the paper |
//! |---|---|---|
//! | a reading is an arc | [`Arc`] | Sec. II-C |
//! | the last H readings of every sensor | [`Storage`], [`Bounds`] | Sec. IV-D |
//! | where two arcs cross, and how steeply | [`crossings`], [`MinAngle`] | Sec. III-A, III-C |
//! | the median of the crossings on an arc | [`TransversalMedian`], [`median()`] | Sec. III-B |
//! | how sharp that is | [`resolution`] | Sec. IV-B |
//! | how sure | [`significance`] | Sec. IV-A |
//! | all of it, reading by reading | [`Fuser`] | Sec. III |
//!
//! # What it does not do
//! Open files, know sensors by name, correct odometry, find walls or corners, draw random numbers, or allocate. The `atm`
//! crate does the first two.
//!
//! # Numbers
//! Metres, radians, nanoseconds. Generic over `f32` and `f64`; the same input gives the same bits on every machine:
//! no fused multiply-add, and `libm` for what is not exactly rounded. The path of a reading in `latest` calls no
//! trigonometry at all.
//!
//! # Example
//! ```
//! use atm_core::*;
//! # fn main() -> Result<(), DomainError> {
//! let mut fuser = Fuser::latest(TransversalMedian::PAPER, Bounds::NONE, LatestArrays::<f64, 1, 10>::new());
//! let (beam, range_resolution) = (Beam::new(60f64.to_radians())?, RangeResolution::new(0.01)?);
//! // A pole at (0, 2), passed by a sensor that looks to the left.
//! let mut echoes = Vec::new();
//! for step in -4i32..=4 {
//!     let robot = Isometry2::new(Vector2::new(f64::from(step) * 0.25, 0.0), 90f64.to_radians());
//!     let distance = (Point2::new(0.0, 2.0) - Point2::from(robot.translation.vector)).norm();
//!     let reading = Reading {
//!         t: i64::from(step) * 100_000_000,
//!         sensor: 0,
//!         range: Limits::NONE.classify(distance),
//!         pose: robot,
//!         robot: Point2::from(robot.translation.vector),
//!         beam,
//!         range_resolution,
//!     };
//!     fuser.push(&reading, &mut |echo: &Echo<f64>| echoes.push(*echo)).unwrap();
//! }
//! let last = echoes.last().unwrap();
//! assert_eq!(last.kind, Kind::Median);
//! assert!((last.position - Point2::new(0.0, 2.0)).norm() < 1e-12);
//! # Ok(())
//! # }
//! ```
#![no_std]
// `!(x <= limit)` is how a guard is written here: it holds for NaN too.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

#[cfg(any(feature = "std", test))]
extern crate std;

mod arc;
mod columns;
mod consensus;
mod crossing;
mod echo;
mod error;
mod estimator;
mod fuser;
mod local_map;
mod median;
mod partners;
mod pose;
pub mod resolution;
mod scalar;
mod sensor;
pub mod significance;
mod storage;
mod sweep;

pub use nalgebra::{Isometry2, Point2, UnitComplex, Vector2};

pub use crate::{
    arc::{Arc, Bearing, ReportedArc},
    columns::{Columns, Ring, Waiting},
    consensus::{Consensus, ConsensusEcho, Reflector},
    crossing::{Crossing, MinAngle, crossings},
    echo::{Echo, Kind},
    error::{DomainError, Rejected},
    estimator::{Estimator, OnNone, OnTwo, TransversalMedian, Verdict},
    fuser::{ArcCrossing, Arrival, Fuser, Reading, Sink},
    local_map::{Bounds, Held, Span},
    median::median,
    partners::Partners,
    pose::{Anchor, Travel},
    scalar::Scalar,
    sensor::{Beam, Limits, Meaning, Range, RangeResolution},
    storage::{Arrays, LOG_BLOCKS, LatestArrays, SETTLED_BLOCKS, SettledStorage, SnapshotStorage, Storage},
    sweep::{BLOCK, Boxes, Instructions},
};

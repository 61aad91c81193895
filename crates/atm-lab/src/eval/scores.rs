//! The scores of a set of points, and how they come about.
use std::collections::BTreeMap;

use atm::{
    log::{View, echo_table::Estimate},
    units::inches,
};
use atm_core::Point2;
use serde::Serialize;

use super::{observable::Observable, spread::Spread, views};
use crate::{
    truth::{Cause, Truth},
    world::{Gap, World},
};

/// A point farther than this from every surface is a ghost, in metres.
pub const GHOST: f64 = inches(6.0);

/// How good some points are. As JSON, one object with these keys; lengths in metres.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Metrics {
    /// How many points there are.
    pub points: usize,
    /// How far along the arc a point lies from where the reading's echo really came from: |azimuth − true azimuth| · range.
    /// Of points whose reading is in the truth, and no crosstalk.
    pub azimuth_error_m: Spread,
    /// How far a point lies from the nearest surface.
    pub surface_error_m: Spread,
    /// Share of the observable surface within 3 in of a point; `None` where nothing could be observed.
    pub coverage: Option<f64>,
    /// Points over 6 in from every surface.
    pub ghosts: usize,
    /// The widest stretch of the opening without a point, 0 where a jamb has no point; the least of them where there are several
    /// openings, `None` where there is none.
    pub doorway_width_m: Option<f64>,
}

/// The metrics of all points, and of those of each kind.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Scores {
    /// Of all points together.
    #[serde(flatten)]
    pub all: Metrics,
    /// Of the points of each kind by themselves; those without a kind are in none.
    pub by_kind: BTreeMap<String, Metrics>,
}

/// Judges points by what is known of the world, and of where each reading's echo came from.
#[derive(Debug, Clone)]
pub struct Judge<'a> {
    world: &'a World,
    truth: Option<&'a Truth>,
    observable: Observable,
}

impl<'a> Judge<'a> {
    /// A judge for a drive whose beams were `views`; without a truth, there are no azimuth errors.
    pub fn new(world: &'a World, truth: Option<&'a Truth>, views: &[View]) -> Self {
        let observable = Observable::new(world.surfaces().iter().map(|surface| &surface.shape), views);
        Self { world, truth, observable }
    }

    /// The scores of these points.
    pub fn scores(&self, estimates: &[Estimate]) -> Scores {
        let mut kinds: BTreeMap<&str, Vec<&Estimate>> = BTreeMap::new();
        for estimate in estimates {
            if let Some(kind) = &estimate.kind {
                kinds.entry(kind).or_default().push(estimate);
            }
        }
        let by_kind = kinds.into_iter().map(|(kind, estimates)| (kind.to_owned(), self.metrics(&estimates)));
        Scores { all: self.metrics(&estimates.iter().collect::<Vec<_>>()), by_kind: by_kind.collect() }
    }

    /// The share of the observable surface that these points cover; `None` where nothing could be observed.
    pub fn coverage(&self, points: impl IntoIterator<Item = Point2<f64>>) -> Option<f64> {
        self.observable.coverage(points)
    }

    fn metrics(&self, estimates: &[&Estimate]) -> Metrics {
        let points: Vec<Point2<f64>> = estimates.iter().map(|estimate| estimate.position).collect();
        let distances: Vec<f64> = points.iter().map(|point| self.world.distance(*point)).collect();
        let widths = self.world.openings().iter().map(|opening| Gap::between(opening.jambs, &points).width());
        Metrics {
            points: points.len(),
            azimuth_error_m: Spread::of(estimates.iter().filter_map(|estimate| self.azimuth_error(estimate))),
            surface_error_m: Spread::of(distances.iter().copied()),
            coverage: self.observable.coverage(points.iter().copied()),
            ghosts: distances.iter().filter(|distance| **distance > GHOST).count(),
            doorway_width_m: widths.min_by(f64::total_cmp),
        }
    }

    fn azimuth_error(&self, estimate: &Estimate) -> Option<f64> {
        let (t, sensor) = estimate.key.as_ref()?;
        let truth = self.truth?.get(*t, sensor)?;
        // Another sensor's sound has no place from which it came.
        if truth.cause == Cause::Crosstalk {
            return None;
        }
        let turn = libm::remainder(estimate.azimuth? - truth.azimuth, std::f64::consts::TAU);
        Some(turn.abs() * estimate.range?)
    }
}

/// The scores of points against a world: azimuth errors where there is a truth, coverage of what the world's own path shows to
/// [`views::RIG`] from every sweep.
///
/// For a drive with another rig or along another way, see [`Judge`] and [`views::of_log`].
pub fn evaluate(estimates: &[Estimate], world: &World, truth: Option<&Truth>) -> Scores {
    Judge::new(world, truth, &views::of_world(world)).scores(estimates)
}

//! How good each method's points are, or, where nobody knows the world, how far they agree.

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};

use atm::{error::Result, log::View};
use atm_core::Point2;
use serde::Serialize;

use super::{
    agreement::Places,
    method::Name,
    recording::Recording,
    run::{Outcome, estimate},
};
use crate::{
    baseline::Evidence,
    eval::{COVERED, Estimate, Judge, Scores, Spread},
    map::spread_bits,
    truth::Truth,
    world::World,
};

/// What is said of one method. What does not apply to it is `None`.
#[derive(Debug, Clone, Default)]
pub struct Assessment {
    /// How many points it gives; those of a grid are its occupied cells. `None` where it does not apply to the log.
    pub points: Option<usize>,
    /// Against the world, where it is known.
    pub scores: Option<Scores>,
    /// Time for a reading, in seconds, by the clock on the wall.
    pub seconds_per_reading: f64,
    /// Of a grid: the threshold that fits the world best, and the scores with it.
    pub best: Option<Best>,
    /// Of a method whose points speak of readings: how it does on the readings that it answers, beside others on the same.
    pub same_readings: Option<SameReadings>,
    /// How spread out its points are.
    pub map_entropy_bits: Sharpness,
    /// The share of its points that have one of the other method's within 4 in.
    pub agreement: Option<BTreeMap<&'static str, Option<f64>>>,
}

/// The entropy of how the points are distributed over cells, in bits; see [`spread_bits`].
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Sharpness {
    /// Of cells 5 cm wide.
    #[serde(rename = "5cm")]
    pub at_5_cm: Option<f64>,
    /// Of cells 10 cm wide.
    #[serde(rename = "10cm")]
    pub at_10_cm: Option<f64>,
}

/// A grid by the threshold that was found best with the world at hand, which no robot has.
#[derive(Debug, Clone, Serialize)]
pub struct Best {
    /// Cells above this are occupied.
    pub threshold: f64,
    /// With it.
    #[serde(flatten)]
    pub scores: Scores,
}

/// Azimuth errors on the readings that one method answers: whoever leaves the hard ones out has to be compared on the others.
#[derive(Debug, Clone, Serialize)]
pub struct SameReadings {
    /// The share of the readings with an echo that it answers.
    pub answered: f64,
    /// Of the method itself.
    pub azimuth_error_m: Spread,
    /// Of the centres of the cones on the same readings.
    pub centerline_azimuth_error_m: Spread,
    /// Of the arc-transversal median as in the paper on the same readings.
    pub atm_azimuth_error_m: Spread,
}

/// The reading that an estimate speaks of.
type Key = (i64, Arc<str>);

/// Assesses what the methods say of a recording: against the world where it is known, else among themselves.
///
/// # Errors
/// A point that no map can hold.
pub fn assess(
    outcomes: &[Outcome],
    recording: &Recording,
    world: Option<&World>,
    truth: Option<&Truth>,
) -> Result<Vec<Assessment>> {
    let Some(world) = world else {
        return among_themselves(outcomes, recording.readings());
    };
    let views: Vec<View> = recording.views().iter().copied().collect();
    let judge = Judge::new(world, truth, &views);
    against_world(outcomes, &judge, world, recording.readings(), recording.ids())
}

/// Assesses what the methods say of a drive through a known world.
///
/// # Errors
/// A point that no map can hold.
pub fn against_world(
    outcomes: &[Outcome],
    judge: &Judge<'_>,
    world: &World,
    readings: u64,
    ids: &[Arc<str>],
) -> Result<Vec<Assessment>> {
    let centerline = find(outcomes, Name::Centerline);
    let atm = find(outcomes, Name::Atm);
    let mut assessments = Vec::new();
    for outcome in outcomes {
        let mut assessment = plain(outcome, readings)?;
        if let Some(estimates) = &outcome.estimates {
            assessment.scores = Some(judge.scores(estimates));
            assessment.best = outcome.evidence.as_ref().map(|evidence| best(evidence, judge, world, ids));
            assessment.same_readings = same_readings(estimates, centerline, atm, judge);
        }
        assessments.push(assessment);
    }
    Ok(assessments)
}

/// Assesses what the methods say of a drive of which nothing else is known.
///
/// # Errors
/// As [`against_world`].
pub fn among_themselves(outcomes: &[Outcome], readings: u64) -> Result<Vec<Assessment>> {
    let points: Vec<Option<Vec<Point2<f64>>>> = outcomes.iter().map(positions).collect();
    let places: Vec<Option<Places<'_>>> = points.iter().map(|points| points.as_deref().map(Places::new)).collect();
    let mut assessments = Vec::new();
    for (outcome, points) in outcomes.iter().zip(&points) {
        let mut assessment = plain(outcome, readings)?;
        if let Some(points) = points {
            let others = outcomes.iter().zip(&places).filter(|(other, _)| other.name != outcome.name);
            let share = |places: &Option<Places<'_>>| places.as_ref().and_then(|places| places.share_near(points));
            assessment.agreement = Some(others.map(|(other, places)| (other.name.word(), share(places))).collect());
        }
        assessments.push(assessment);
    }
    Ok(assessments)
}

/// What needs neither a world nor other methods.
fn plain(outcome: &Outcome, readings: u64) -> Result<Assessment> {
    let points = || outcome.estimates.iter().flatten().map(|estimate| estimate.position);
    Ok(Assessment {
        points: outcome.estimates.as_ref().map(Vec::len),
        seconds_per_reading: outcome.seconds / readings.max(1) as f64,
        map_entropy_bits: Sharpness { at_5_cm: spread_bits(points(), 0.05)?, at_10_cm: spread_bits(points(), 0.1)? },
        ..Assessment::default()
    })
}

fn positions(outcome: &Outcome) -> Option<Vec<Point2<f64>>> {
    outcome.estimates.as_ref().map(|estimates| estimates.iter().map(|estimate| estimate.position).collect())
}

fn find(outcomes: &[Outcome], name: Name) -> &[Estimate] {
    let found = outcomes.iter().find(|outcome| outcome.name == name);
    found.and_then(|outcome| outcome.estimates.as_deref()).unwrap_or_default()
}

/// Most thresholds that are tried.
const THRESHOLDS: usize = 64;

/// Sweeps a grid's threshold once: the best has the largest harmonic mean of the share of points within [`COVERED`] of a
/// surface and the share of the surface within [`COVERED`] of a point.
fn best(evidence: &Evidence, judge: &Judge<'_>, world: &World, ids: &[Arc<str>]) -> Best {
    let mut cells: Vec<(f64, Point2<f64>, bool)> = Vec::new();
    for (cell, value) in evidence.grid.cells().filter(|(_, value)| !value.is_nan()) {
        let point = evidence.grid.center(cell);
        cells.push((value, point, world.distance(point) <= COVERED));
    }
    // The strongest first: what is above a threshold is a beginning of them.
    cells.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut best = (0.0, evidence.occupied_above);
    for threshold in thresholds(&cells, evidence.occupied_above) {
        let above = cells.partition_point(|(value, ..)| *value > threshold);
        let points = cells.get(..above).unwrap_or_default();
        let near = points.iter().filter(|(.., near)| *near).count();
        let precision = near as f64 / above.max(1) as f64;
        // With full coverage the mean would be this.
        if 2.0 * precision / (precision + 1.0) <= best.0 {
            continue;
        }
        let coverage = judge.coverage(points.iter().map(|(_, point, _)| *point)).unwrap_or(0.0);
        let mean = 2.0 * precision * coverage / (precision + coverage).max(f64::MIN_POSITIVE);
        if mean > best.0 {
            best = (mean, threshold);
        }
    }
    let threshold = best.1;
    let estimates: Vec<Estimate> = evidence.marks(threshold).iter().map(|mark| estimate(mark, ids)).collect();
    Best { threshold, scores: judge.scores(&estimates) }
}

/// The method's own threshold, then evenly spaced ones among the values that there are, from the strongest.
fn thresholds(cells: &[(f64, Point2<f64>, bool)], own: f64) -> impl Iterator<Item = f64> {
    let mut values: Vec<f64> = cells.iter().map(|(value, ..)| *value).collect();
    values.dedup();
    let step = values.len().div_ceil(THRESHOLDS).max(1);
    [own].into_iter().chain(values.into_iter().step_by(step))
}

/// How a method does on the readings that it answers; `None` where its points speak of none.
fn same_readings(
    estimates: &[Estimate],
    centerline: &[Estimate],
    atm: &[Estimate],
    judge: &Judge<'_>,
) -> Option<SameReadings> {
    let answered: BTreeSet<&Key> = estimates.iter().filter_map(|estimate| estimate.key.as_ref()).collect();
    if answered.is_empty() || centerline.is_empty() {
        return None;
    }
    let errors = |of: &[Estimate]| {
        let same: Vec<Estimate> =
            of.iter().filter(|one| one.key.as_ref().is_some_and(|key| answered.contains(key))).cloned().collect();
        judge.scores(&same).all.azimuth_error_m
    };
    Some(SameReadings {
        answered: answered.len() as f64 / centerline.len() as f64,
        azimuth_error_m: errors(estimates),
        centerline_azimuth_error_m: errors(centerline),
        atm_azimuth_error_m: errors(atm),
    })
}

//! From evidence to diagnoses.

use atm_core::{MinAngle, resolution};

use super::{Diagnosis, Evidence, Unresolved, histogram::Histogram};
use crate::{error::Reason, summary::Dropped};

/// Share of echoes that are resolved below which that deserves a word.
const RESOLVED: f64 = 0.02;
/// Fewest readings of which anything is said that takes a share of them.
const FEWEST: u64 = 20;
/// Fewest arcs of which it is said that hardly any is resolved.
const FEWEST_ARCS: u64 = 100;
/// Share from which on nearly all is meant.
const NEARLY_ALL: f64 = 0.9;
/// 100 in: as far as the paper looks, in metres.
pub const PAPER_REACH: f64 = 2.54;
/// Share of echoes of kind `near` above which a guessed range resolution deserves a word.
const MANY_NEAR: f64 = 0.2;
/// No robot has this mean speed, in metres a second.
const FASTEST: f64 = 100.0;
/// Metres in a degree of latitude.
const DEGREE: f64 = 111_195.0;

/// What bounds the local map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MapSpan {
    /// So many readings of each sensor.
    Readings(usize),
    /// So much travel, in metres.
    Travel(f64),
}

/// What a run made of a log.
#[derive(Debug, Clone, Copy)]
pub struct Run {
    /// Echoes that are resolved: medians and singles, points and walls.
    pub resolved: u64,
    /// Arcs: echoes and what was ignored.
    pub arcs: u64,
    /// Arcs that were ignored for having exactly two crossings.
    pub pairs: u64,
    /// Echoes that are short enough as they are.
    pub near: u64,
    /// What bounds the local map.
    pub span: MapSpan,
    /// The smallest angle that counts.
    pub min_angle: MinAngle<f64>,
}

/// What is likely wrong with a log, the costliest first.
///
/// `dropped`: its unusable records; `resets`: how often its clock was set back; `drops_held`: whether repeated values are left
/// out; `run`: what was made of it, where it was fused. `found` is what its format found out itself.
pub fn diagnose(
    evidence: &Evidence,
    dropped: &Dropped,
    resets: u64,
    drops_held: bool,
    run: Option<&Run>,
    found: Vec<Diagnosis>,
) -> Vec<Diagnosis> {
    let mut all = found;
    all.extend(time(evidence, resets));
    let sorted = all.iter().any(|found| matches!(found, Diagnosis::SortedBySensor { .. }));
    // What is told of the order of the rows need not be told of each of them.
    let unusable = dropped.iter().filter(|(reason, ..)| !(sorted && *reason == Reason::TimeBackwards));
    all.extend(unusable.map(|(reason, count, first)| Diagnosis::Unusable { reason, count, first: first.clone() }));
    // What a format says of the ranges of each sensor is closer than what all of them show together.
    let told = all.iter().any(|found| matches!(found, Diagnosis::Recording(finding) if finding.is_of_ranges()));
    let (poses, ranges) = (poses(evidence), ranges(evidence).filter(|_| !told));
    let fits = ranges.is_none() && !told;
    all.extend(poses);
    all.extend(ranges);
    all.extend(duplicates(evidence));
    // Values that do not fit, or are there twice, are equal to one another for another reason.
    if fits && !drops_held && duplicates(evidence).is_none() {
        all.extend(held(evidence));
    }
    if fits {
        all.extend(clipped(evidence));
    }
    if let Some(run) = run {
        // A cause that was found is a better word than that there is an effect.
        let is_cause = |found: &Diagnosis| {
            !matches!(
                found,
                Diagnosis::Unusable { .. }
                    | Diagnosis::ClockSetBack { .. }
                    | Diagnosis::Clipped { .. }
                    | Diagnosis::FirstLine { .. }
            )
        };
        if !all.iter().any(is_cause) {
            all.extend(little_resolved(evidence, run));
        }
    }
    all.sort_by_key(|found| std::cmp::Reverse(found.cost()));
    all
}

/// Of a range resolution that was a guess, if that makes many echoes near.
pub fn guessed_resolution(near: u64, echoes: u64) -> Option<Diagnosis> {
    (near as f64 > MANY_NEAR * echoes as f64).then_some(Diagnosis::GuessedResolution { near, echoes })
}

fn time(evidence: &Evidence, resets: u64) -> Vec<Diagnosis> {
    let mut found = Vec::new();
    let by_sensor = evidence.resets_by_sensor;
    // The last of them may have no record after it that tells its sensor.
    if by_sensor > 0 && 2 * by_sensor >= resets {
        found.push(Diagnosis::SortedBySensor { times: by_sensor });
    } else if resets > 0 {
        found.push(Diagnosis::ClockSetBack { times: resets });
    }
    let changes = evidence.poses.changes;
    if changes >= FEWEST
        && evidence.instants < changes / 4
        && let Some((_, at)) = evidence.span
    {
        found.push(Diagnosis::TimeStandsStill { poses: changes, times: evidence.instants, at });
    }
    found
}

fn poses(evidence: &Evidence) -> Option<Diagnosis> {
    let (poses, readings) = (&evidence.poses, evidence.readings());
    let extent @ [x, y] = poses.extent()?;
    let seconds = poses.duration as f64 * 1e-9;
    if let Some([(west, east), (south, north)]) = poses.bounds
        && poses.changes >= FEWEST
        && x.max(y) < 0.1
        && (west.abs() > 100.0 * x.max(y) || south.abs() > 100.0 * x.max(y))
        && west >= -180.0 && east <= 180.0 && south >= -180.0 && north <= 180.0
        // A metre or more, at a robot's pace: what stands and trembles would fly.
        && (1.0..60.0 * seconds.max(1.0)).contains(&(poses.path * DEGREE))
    {
        return Some(Diagnosis::Geographic { extent, metres: poses.path * DEGREE });
    }
    if readings >= FEWEST && x.max(y) < 0.01 {
        return Some(Diagnosis::PosesStandStill { extent, readings });
    }
    if let Some((form, fit)) = poses.headings.misread() {
        let (as_is, steps) = (poses.headings.as_is(), poses.headings.steps());
        return Some(Diagnosis::Heading { form, fit, as_is, steps });
    }
    // No robot is as fast as this; slow ones in millimetres are.
    let speed = poses.speed().filter(|speed| poses.changes >= FEWEST && (FASTEST..1000.0 * FASTEST).contains(speed))?;
    Some(Diagnosis::PoseUnit { speed, unit: "mm" })
}

/// Whether ranges fit the sensors' limits at all.
fn ranges(evidence: &Evidence) -> Option<Diagnosis> {
    let sum = |of: fn(&super::SensorEvidence) -> u64| evidence.sensors.iter().map(of).sum::<u64>();
    let (readings, echoes) = (evidence.readings(), evidence.echoes());
    let (beyond, finite) = (sum(|sensor| sensor.beyond), sum(|sensor| sensor.finite()));
    let (infinite, minus) = (sum(|sensor| sensor.infinite), sum(|sensor| sensor.minus_infinite));
    let close = sum(|sensor| sensor.too_close) + minus;
    if readings < FEWEST {
        return None;
    }
    let all = all_ranges(evidence);
    let median = all.quantile(0.5, 0.0, f64::INFINITY).unwrap_or(0.0);
    let max = evidence.reach().unwrap_or(f64::INFINITY);
    // A sensor that says its maximum where there is nothing is in order; one that says ten times as much is not.
    let is_far = median > 1.5 * max || median > 300.0;
    if finite >= FEWEST && is_far && (beyond as f64 > NEARLY_ALL * finite as f64 || !max.is_finite()) {
        let unit = fitting_unit(&all, max);
        return Some(Diagnosis::RangeUnit { beyond, ranges: finite, max, median, unit });
    }
    let min = evidence.sensors.iter().filter_map(|sensor| sensor.sight).map(|(limits, _)| limits.min());
    if close as f64 > NEARLY_ALL * readings as f64 {
        let min = min.min_by(f64::total_cmp).unwrap_or(0.0);
        return Some(Diagnosis::TooClose { close, minus_infinite: minus, readings, min });
    }
    if echoes == 0 && finite == 0 {
        let invalid = sum(|sensor| sensor.invalid);
        return Some(Diagnosis::NoEcho { readings, infinite, invalid });
    }
    None
}

/// The unit in which nearly all ranges are below the maximum, the largest of those that are usual.
fn fitting_unit(ranges: &Histogram, max: f64) -> Option<&'static str> {
    let typical = ranges.quantile(0.9, 0.0, f64::INFINITY)?;
    let max = if max.is_finite() { max } else { 10.0 };
    // A few at the maximum of the sensor are at it in its unit, too.
    [("cm", 0.01), ("mm", 0.001)].into_iter().find(|(_, scale)| typical * scale <= 1.02 * max).map(|(unit, _)| unit)
}

fn all_ranges(evidence: &Evidence) -> Histogram {
    let mut all = Histogram::new();
    evidence.sensors.iter().filter_map(|sensor| sensor.ranges()).for_each(|ranges| all.merge(ranges));
    all
}

/// A largest range that comes again and again, of several sensors, with hardly anything a little below it.
fn clipped(evidence: &Evidence) -> Option<Diagnosis> {
    let echoes = evidence.echoes();
    let value = evidence.sensors.iter().map(|sensor| sensor.highest().0).max_by(f64::total_cmp)?;
    let at = evidence.sensors.iter().map(|sensor| sensor.highest()).filter(|(metres, ..)| *metres == value);
    let (mut count, mut runs, mut sensors) = (0, 0, 0);
    for (_, of_sensor, times, _) in at {
        (count, runs, sensors) = (count + of_sensor, runs + times, sensors + 1);
    }
    let near: u64 = evidence
        .sensors
        .iter()
        .filter_map(|sensor| sensor.ranges())
        .map(|ranges| ranges.between(0.97 * value, 1.02 * value))
        .sum();
    let below = near.saturating_sub(count);
    let beyond: u64 = evidence.sensors.iter().map(|sensor| sensor.beyond + sensor.infinite).sum();
    let several = sensors >= 2.min(evidence.sensors.len());
    let piles_up = count >= 10 && runs >= 3 && count as f64 > 0.03 * echoes as f64 && 3 * below < count;
    // Who says the maximum or nothing, too, has a word for nothing there.
    (piles_up && several && 10 * beyond < count).then_some(Diagnosis::Clipped {
        value,
        count,
        echoes,
        max: evidence.reach().unwrap_or(f64::INFINITY),
    })
}

/// Values that are repeated while the robot moves, by most of the sensors: along a smooth wall one or two do so honestly.
fn held(evidence: &Evidence) -> Option<Diagnosis> {
    let active = || evidence.sensors.iter().filter(|sensor| sensor.echoes >= FEWEST);
    let sensors = active().filter(|sensor| 3 * sensor.held > sensor.echoes).count() as u64;
    let (held, echoes) = active().fold((0, 0), |(held, echoes), sensor| (held + sensor.held, echoes + sensor.echoes));
    // A value that hardly ever changes is a wall's.
    let changes = 10 * held < 9 * echoes;
    (2 * sensors > active().count() as u64 && 5 * held > echoes && changes).then_some(Diagnosis::Held {
        held,
        echoes,
        sensors,
    })
}

fn duplicates(evidence: &Evidence) -> Option<Diagnosis> {
    let readings = evidence.readings();
    let count: u64 = evidence.sensors.iter().map(|sensor| sensor.duplicates).sum();
    (100 * count > readings).then_some(Diagnosis::Duplicates { count, readings })
}

fn little_resolved(evidence: &Evidence, run: &Run) -> Option<Diagnosis> {
    let arcs = run.arcs.saturating_sub(run.near);
    if arcs < FEWEST_ARCS || run.resolved as f64 >= RESOLVED * arcs as f64 {
        return None;
    }
    let crossings = &evidence.crossings;
    let sample = [crossings.uncrossed, crossings.shallow, crossings.arcs];
    let min_angle = run.min_angle.radians();
    let why = why(evidence, run, sample);
    Some(Diagnosis::LittleResolved { resolved: run.resolved, arcs, sample, min_angle, why })
}

fn why(evidence: &Evidence, run: &Run, [uncrossed, shallow, of]: [u64; 3]) -> Unresolved {
    let reach = evidence.reach().map_or(PAPER_REACH, |reach| reach.min(PAPER_REACH));
    let path = evidence.poses.path;
    if let Ok(needs) = resolution::travel(reach, &run.min_angle) {
        if path < needs {
            return Unresolved::ShortPath { path, needs, reach };
        }
        let spans = map_travel(evidence, run.span);
        if spans < 0.7 * needs {
            let by_count = matches!(run.span, MapSpan::Readings(_));
            return Unresolved::ShortMap { spans, needs, reach, by_count };
        }
    }
    match () {
        () if 2 * uncrossed > of => Unresolved::Uncrossed,
        () if 2 * shallow > of => Unresolved::Shallow,
        () if 2 * run.pairs > run.arcs => Unresolved::Pairs { count: run.pairs },
        () => Unresolved::Unknown,
    }
}

/// The travel that the local map spans on this path, in metres.
pub fn map_travel(evidence: &Evidence, span: MapSpan) -> f64 {
    match span {
        MapSpan::Travel(travel) => travel,
        MapSpan::Readings(history) => {
            let most = evidence.sensors.iter().map(|sensor| sensor.readings).max().unwrap_or(0);
            evidence.poses.path * (history as f64 / most.max(1) as f64).min(1.0)
        }
    }
}

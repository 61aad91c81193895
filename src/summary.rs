//! What a run has counted.

use std::collections::BTreeMap;

use atm_core::{Kind, Reflector};
use serde::{Serialize, Serializer, ser::SerializeMap};

use crate::{
    diagnose::Diagnosis,
    echo::AnyEstimator,
    error::{Problem, Reason},
};

/// The counts of one run. As JSON, one object with these keys.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Summary {
    /// Readings that entered the local map, those without echo included.
    pub readings: u64,
    /// Readings without an echo: nothing there, too close, or no number.
    pub no_echo: u64,
    /// Echoes of each kind, before any are left out.
    #[serde(serialize_with = "by_kind")]
    pub echoes: Counts,
    /// Echoes written.
    pub written: u64,
    /// Arcs that gave no echo because of exactly two crossings.
    pub ignored_pairs: u64,
    /// Arcs that gave no echo because nothing crossed them, where that was asked for.
    pub ignored_none: u64,
    /// Usable readings that took no slot.
    pub skipped: Skipped,
    /// Second readings of a sensor at one time and place, which were not used.
    pub duplicates: u64,
    /// The travel that the local map spans, in metres; `None` where it holds a number of readings.
    pub map_travel_m: Option<f64>,
    /// Unusable records.
    #[serde(serialize_with = "by_reason")]
    pub dropped: Dropped,
    /// Times at which the clock was taken to have been set back.
    pub clock_resets: u64,
    /// Whether the input ends in the middle of something, or some of it can't be unpacked.
    pub input_damaged: bool,
    /// What is likely wrong, the costliest first, and what cures it.
    pub advice: Vec<Diagnosis>,
}

/// Readings that were usable and still took no slot in the local map.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Skipped {
    /// Equal to the sensor's previous reading.
    pub held: u64,
    /// The sensor had moved less than the smallest step.
    pub min_step: u64,
    /// Empty cells: sensors that did not fire.
    pub empty: u64,
}

/// Kinds of echoes whose place on the arc is known, of either estimator.
const RESOLVED: [&str; 4] = [Kind::Median.name(), Kind::Single.name(), Reflector::Point.name(), Reflector::Wall.name()];

/// Most kinds that an estimator's echoes have.
const MOST_KINDS: usize = 5;

/// A count for each kind of echo of one estimator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Counts {
    kinds: &'static [&'static str],
    counts: [u64; MOST_KINDS],
}

impl Default for Counts {
    /// Of the median's kinds.
    fn default() -> Self {
        Self::of(AnyEstimator::PAPER.kinds())
    }
}

impl Counts {
    /// None of these kinds, of which the first five can be counted.
    pub const fn of(kinds: &'static [&'static str]) -> Self {
        Self { kinds, counts: [0; MOST_KINDS] }
    }

    /// Counts one of the kind at this place of the list.
    pub fn add(&mut self, place: usize) {
        if let Some(count) = self.counts.get_mut(place) {
            *count += 1;
        }
    }

    /// Each kind's word with its count.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, u64)> {
        self.kinds.iter().copied().zip(self.counts)
    }

    /// The count of one kind.
    pub fn get(&self, kind: &str) -> u64 {
        self.iter().filter(|&(listed, _)| listed == kind).map(|(_, count)| count).sum()
    }

    /// All together.
    pub fn total(&self) -> u64 {
        self.counts.iter().sum()
    }
}

/// Unusable records by reason, with the first of each.
#[derive(Debug, Clone, Default)]
pub struct Dropped(BTreeMap<Reason, (u64, Problem)>);

impl Dropped {
    /// Counts one.
    pub fn add(&mut self, problem: Problem) {
        self.0.entry(problem.reason).and_modify(|(count, _)| *count += 1).or_insert((1, problem));
    }

    /// Counts what another file had after it; the first of each reason stays.
    pub fn extend(&mut self, other: Self) {
        for (reason, (count, first)) in other.0 {
            self.0.entry(reason).and_modify(|(all, _)| *all += count).or_insert((count, first));
        }
    }

    /// Each reason met, with its count and its first record.
    pub fn iter(&self) -> impl Iterator<Item = (Reason, u64, &Problem)> {
        self.0.iter().map(|(&reason, (count, first))| (reason, *count, first))
    }

    /// The count of one reason.
    pub fn get(&self, reason: Reason) -> u64 {
        self.0.get(&reason).map_or(0, |(count, _)| *count)
    }

    /// All together.
    pub fn total(&self) -> u64 {
        self.0.values().map(|(count, _)| count).sum()
    }
}

impl Summary {
    /// Counts something that can't be used.
    pub fn drop(&mut self, problem: Problem) {
        self.input_damaged |= matches!(problem.reason, Reason::Truncated | Reason::BadChunk);
        self.dropped.add(problem);
    }

    /// Echoes that are resolved: medians and singles, or points and walls.
    pub fn resolved(&self) -> u64 {
        RESOLVED.iter().map(|kind| self.echoes.get(kind)).sum()
    }

    /// Whether every record of the input could be used.
    pub fn is_clean(&self) -> bool {
        self.dropped.total() == 0 && !self.input_damaged
    }
}

fn by_kind<S: Serializer>(counts: &Counts, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(counts.iter())
}

fn by_reason<S: Serializer>(dropped: &Dropped, serializer: S) -> Result<S::Ok, S::Error> {
    let mut map = serializer.serialize_map(Some(dropped.0.len()))?;
    for (reason, count, _) in dropped.iter() {
        map.serialize_entry(reason.key(), &count)?;
    }
    map.end()
}

//! What was compared, and how often: an agreement about nothing would be none.

use std::collections::BTreeMap;

use atm::core::Kind;

use crate::{
    history::{Fate, History},
    log::Log,
};

/// The modes, in the order of the counts.
pub const MODES: [&str; 3] = ["settled", "latest", "snapshot"];

#[derive(Debug, Default)]
pub struct Tally {
    pub logs: u64,
    pub logs_left_out: u64,
    /// By mode.
    pub arcs: [u64; 3],
    pub arcs_left_out: [u64; 3],
    /// By mode and kind, in the order of [`Kind::ALL`].
    pub kinds: [[u64; 5]; 3],
    /// By mode and count of crossings.
    pub ignored: [[u64; 3]; 3],
    pub crossings: u64,
    pub arcs_crossed_twice_by_one: u64,
    pub arcs_crossed_by_own_sensor: u64,
    pub significances: u64,
    pub significances_left_out: u64,
    /// Those where not every crossing on the arc lies in the interval.
    pub significances_of_some: u64,
    /// Readings sent away by one rule alone, (a) to (d).
    pub left_by: [u64; 4],
    pub left_by_several: u64,
    /// Readings that stayed although their age was the bound itself.
    pub stayed_at_max_age: u64,
    /// By name.
    pub fates: BTreeMap<&'static str, u64>,
    pub without_echo: u64,
    pub worst_position: f64,
    pub worst_crossing: f64,
    pub worst_angle: f64,
}

impl Tally {
    pub fn count_history(&mut self, history: &History, log: &Log) {
        for (fate, sample) in history.fates.iter().zip(&log.samples) {
            let name = match fate {
                Fate::UnknownSensor => "unknown sensor",
                Fate::BadPose => "bad pose",
                Fate::TimeBackwards => "time going back",
                Fate::Held => "held",
                Fate::Still => "still",
                Fate::Duplicate => "duplicate",
                Fate::Arrived(_) => "arrived",
            };
            *self.fates.entry(name).or_default() += 1;
            self.without_echo += u64::from(matches!(fate, Fate::Arrived(_)) && sample.echo().is_none());
        }
        for (arrival, stay) in history.stays.iter().enumerate() {
            match stay.causes.iter().filter(|&&cause| cause).count() {
                0 => {}
                1 => stay.causes.iter().zip(&mut self.left_by).for_each(|(&cause, count)| *count += u64::from(cause)),
                _ => self.left_by_several += 1,
            }
            let aged_to_the_bound = history.stays[arrival + 1..].iter().enumerate().any(|(later, other)| {
                let age = log.samples[other.sample].t - log.samples[stay.sample].t;
                history.met(arrival, arrival + 1 + later) && log.rules.max_age.is_some_and(|limit| age as u64 == limit)
            });
            self.stayed_at_max_age += u64::from(aged_to_the_bound);
        }
    }

    /// The share left out, of whatever is compared.
    pub fn assert_left_out_below(&self, limit: f64) {
        let mut counts = vec![
            ("logs", self.logs_left_out, self.logs),
            ("significances", self.significances_left_out, self.significances),
        ];
        counts.extend((0..3).map(|mode| (MODES[mode], self.arcs_left_out[mode], self.arcs[mode])));
        for (what, left_out, all) in counts {
            assert!((left_out as f64) < limit * all as f64, "{left_out} of {all} {what} left out");
        }
    }

    /// Every rule and kind has been put to the test this often.
    pub fn assert_everything_occurred_at_least(&self, least: u64) {
        let mut counts = vec![
            ("arcs crossed twice by one partner", self.arcs_crossed_twice_by_one),
            ("arcs crossed by their own sensor", self.arcs_crossed_by_own_sensor),
            ("significances of some crossings only", self.significances_of_some),
            ("left by several rules", self.left_by_several),
            ("stayed at the bound of age", self.stayed_at_max_age),
            ("without echo", self.without_echo),
        ];
        counts.extend(["left by (a)", "left by (b)", "left by (c)", "left by (d)"].into_iter().zip(self.left_by));
        for mode in 0..3 {
            counts.extend(Kind::ALL.iter().map(|kind| kind.name()).zip(self.kinds[mode]));
            counts.extend([("dropped", self.ignored[mode][0]), ("ignored pair", self.ignored[mode][2])]);
        }
        let fates = ["arrived", "held", "still", "unknown sensor", "bad pose", "time going back"];
        counts.extend(fates.map(|fate| (fate, self.fates.get(fate).copied().unwrap_or(0))));
        for (what, count) in counts {
            assert!(count >= least, "{what}: {count}");
        }
    }

    pub fn print(&self, name: &str) {
        println!("{name}: {} logs, {} left out", self.logs, self.logs_left_out);
        for (mode, title) in MODES.iter().enumerate() {
            let kinds: Vec<_> = Kind::ALL.iter().zip(self.kinds[mode]).map(|(kind, n)| (kind.name(), n)).collect();
            println!(
                "  {title}: {} arcs, {} left out; {kinds:?}; ignored by count of crossings {:?}",
                self.arcs[mode], self.arcs_left_out[mode], self.ignored[mode]
            );
        }
        println!(
            "  {} crossings; arcs crossed twice by one partner {}, by their own sensor {}",
            self.crossings, self.arcs_crossed_twice_by_one, self.arcs_crossed_by_own_sensor
        );
        println!(
            "  significances: {}, {} of them of some crossings only; {} left out",
            self.significances, self.significances_of_some, self.significances_left_out
        );
        println!(
            "  left by (a) to (d) alone: {:?}, by several: {}; stayed at the very bound of age: {}",
            self.left_by, self.left_by_several, self.stayed_at_max_age
        );
        println!("  {:?}, {} of those that arrived without echo", self.fates, self.without_echo);
        println!(
            "  farthest apart: echoes {:.1e} m, crossings {:.1e} m, crossing angles {:.1e} rad",
            self.worst_position, self.worst_crossing, self.worst_angle
        );
    }
}

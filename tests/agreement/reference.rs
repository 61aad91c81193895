//! The method computed a second time, from its words: every pair of arcs of the whole log, lists of crossings kept for
//! each arc, sorted azimuths, angles throughout, always in `f64`.

use std::f64::consts::PI;

use atm::core::{Kind, OnNone, OnTwo};

use crate::{
    cut::{Cut, Span, cuts},
    history::{Fate, History},
    log::Log,
    margin::Margins,
};

/// A crossing as one arc sees it.
#[derive(Debug, Clone, Copy)]
pub struct OnArc {
    /// The other arc's number among the arrivals.
    pub partner: usize,
    pub azimuth: f64,
    pub position: [f64; 2],
    pub angle: f64,
    pub doubtful: bool,
}

/// Which arcs an arc is crossed with.
#[derive(Debug, Clone, Copy)]
pub enum Company {
    /// All that it met.
    Settled,
    /// Those in the local map at its arrival.
    Latest,
    /// Those in the local map after this many arrivals.
    Snapshot(usize),
}

/// The echo of an arc.
#[derive(Debug, Clone, Copy)]
pub struct Placed {
    pub kind: Kind,
    pub azimuth: f64,
    pub position: [f64; 2],
    pub resolution: f64,
    /// n of equation (1), and whether rounding may change it.
    pub within: u32,
    pub within_doubtful: bool,
    /// Natural logarithm of equation (1).
    pub log_significance: f64,
    /// The chance that some interval holds as many; `None` where fewer are no more than the average, for which the
    /// approximation is not made.
    pub scan_significance: Option<f64>,
}

/// What is said of one arc.
#[derive(Debug)]
pub struct Statement {
    pub arrival: usize,
    pub crossings: Vec<OnArc>,
    pub placed: Option<Placed>,
    /// Whether rounding may decide otherwise.
    pub doubtful: bool,
}

pub struct Reference<'a> {
    pub log: &'a Log,
    pub history: History,
    /// For each arrival.
    spans: Vec<Option<Span>>,
    on_arc: Vec<Vec<OnArc>>,
    margins: Margins,
}

impl<'a> Reference<'a> {
    pub fn of(log: &'a Log, margins: Margins) -> Self {
        let history = History::of(log, &margins);
        let spans: Vec<_> = history.stays.iter().map(|stay| Span::of(&log.samples[stay.sample])).collect();
        let mut on_arc = vec![Vec::new(); spans.len()];
        for (later, b) in spans.iter().enumerate() {
            for (earlier, a) in spans.iter().enumerate().take(later) {
                // By travel, who is crossed with whom depends on when: see the statements.
                let met = log.rules.span.is_some() || history.met(earlier, later);
                let (true, Some(a), Some(b)) = (met, a, b) else { continue };
                for cut in cuts(a, b, log.rules.min_angle, &margins) {
                    let Cut { azimuths, position, angle, .. } = cut;
                    for (arc, partner, azimuth) in [(earlier, later, azimuths[0]), (later, earlier, azimuths[1])] {
                        let doubtful = cut.doubtful || PI / 2.0 - azimuth.abs() <= margins.flat;
                        on_arc[arc].push(OnArc { partner, azimuth, position, angle, doubtful });
                    }
                }
            }
        }
        Self { log, history, spans, on_arc, margins }
    }

    /// What `settled` reports while a sample is taken in; `None`: at the end.
    pub fn settled(&self, sample: Option<usize>) -> Vec<Statement> {
        let caused = sample.map(|sample| self.history.fates[sample]);
        let leaves = match caused {
            None => None,
            Some(Fate::Arrived(arrival)) => Some(arrival),
            Some(_) => return Vec::new(),
        };
        let leavers = (0..self.spans.len()).filter(|&arrival| {
            let stay = &self.history.stays[arrival];
            (if self.log.rules.span.is_some() { stay.due } else { stay.leaves }) == leaves
        });
        leavers.filter_map(|arrival| self.statement(arrival, Company::Settled)).collect()
    }

    /// What `latest` reports while a sample is taken in.
    pub fn latest(&self, sample: usize) -> Vec<Statement> {
        match self.history.fates[sample] {
            Fate::Arrived(arrival) => self.statement(arrival, Company::Latest).into_iter().collect(),
            _ => Vec::new(),
        }
    }

    /// What a snapshot after a sample reports.
    pub fn snapshot(&self, sample: usize) -> Vec<Statement> {
        let arrivals = self.history.arrivals_until(sample);
        let present = (0..arrivals).filter(|&arrival| self.history.present(arrival, arrivals));
        present.filter_map(|arrival| self.statement(arrival, Company::Snapshot(arrivals))).collect()
    }

    fn statement(&self, arrival: usize, company: Company) -> Option<Statement> {
        let span = self.spans[arrival].as_ref()?;
        let counts = |crossing: &&OnArc| match company {
            Company::Settled if self.log.rules.span.is_some() => self.history.settled_with(arrival, crossing.partner),
            Company::Settled => true,
            Company::Latest => crossing.partner < arrival && self.history.met(crossing.partner, arrival),
            Company::Snapshot(arrivals) => self.history.present(crossing.partner, arrivals),
        };
        let mut crossings: Vec<OnArc> = self.on_arc[arrival].iter().filter(counts).copied().collect();
        crossings.sort_by(|a, b| a.azimuth.total_cmp(&b.azimuth));
        let delta = self.log.samples[self.history.stays[arrival].sample].range_resolution;
        let min_angle = self.log.rules.min_angle;
        let interval = delta * (1.0 / min_angle.sin() + 1.0 / min_angle.tan());
        let arc_length = 2.0 * span.half_beam * span.radius;
        let doubtful = (arc_length - interval).abs() <= self.margins.length * interval
            || crossings.iter().any(|crossing| crossing.doubtful);
        let azimuths: Vec<f64> = crossings.iter().map(|crossing| crossing.azimuth).collect();
        let placed = self.place(span, &azimuths, interval, arc_length);
        Some(Statement { arrival, crossings, placed, doubtful })
    }

    fn place(&self, span: &Span, azimuths: &[f64], interval: f64, arc_length: f64) -> Option<Placed> {
        let rules = &self.log.rules;
        let (kind, azimuth, resolution) = match (azimuths.len(), rules.on_none, rules.on_two) {
            _ if arc_length <= interval => (Kind::Near, 0.0, arc_length),
            (0, OnNone::Drop, _) | (2, _, OnTwo::Drop) => return None,
            (0, OnNone::Center, _) => (Kind::Center, 0.0, arc_length),
            (1, ..) => (Kind::Single, azimuths[0], interval),
            (2, _, OnTwo::Center) => (Kind::Pair, 0.0, arc_length),
            (2, _, OnTwo::Mean) => {
                let spacing = span.radius * (azimuths[1] - azimuths[0]);
                (Kind::Pair, (azimuths[0] + azimuths[1]) / 2.0, interval + spacing)
            }
            (count, ..) if count % 2 == 1 => (Kind::Median, azimuths[count / 2], interval),
            (count, ..) => (Kind::Median, (azimuths[count / 2 - 1] + azimuths[count / 2]) / 2.0, interval),
        };
        let half = interval / 2.0 / span.radius;
        let offsets = || azimuths.iter().map(|other| (other - azimuth).abs());
        let within = offsets().filter(|&offset| offset <= half).count() as u32;
        let share = interval / arc_length;
        let (log_significance, scan_significance) = match kind {
            Kind::Center | Kind::Near => (0.0, Some(1.0)),
            _ => (f64::from(within) * share.ln(), scan(within as usize, azimuths.len(), share)),
        };
        Some(Placed {
            kind,
            azimuth,
            position: span.point(azimuth),
            resolution,
            within,
            within_doubtful: offsets().any(|offset| (offset - half).abs() <= self.margins.angle),
            log_significance,
            scan_significance,
        })
    }
}

/// P ≈ min(1, (n/w − N − 1) b(n; N, w) + 2 P(Bin(N, w) ≥ n)); 1 where w ≥ 1 or n < 2.
fn scan(within: usize, crossings: usize, share: f64) -> Option<f64> {
    if share >= 1.0 || within < 2 {
        return Some(1.0);
    }
    let binomial = |successes: usize| {
        let failures = crossings - successes;
        let ways = (1..=successes).fold(1.0, |ways, place| ways * (failures + place) as f64 / place as f64);
        ways * share.powi(successes as i32) * (1.0 - share).powi(failures as i32)
    };
    let at_least: f64 = (within..=crossings).map(binomial).sum();
    let places = within as f64 / share - crossings as f64 - 1.0;
    (places > 0.0).then(|| (places * binomial(within) + 2.0 * at_least).min(1.0))
}

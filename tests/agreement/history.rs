//! Who is in the local map when, by counting over the whole log (the rules word by word, in quadratic time).

use crate::{
    log::{Log, Sample},
    margin::Margins,
};

/// What becomes of a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fate {
    UnknownSensor,
    BadPose,
    TimeBackwards,
    Held,
    Still,
    /// A second reading of its sensor at one time and place.
    Duplicate,
    /// With its number among those that arrived.
    Arrived(usize),
}

/// Why a reading left: (a) its own sensor's H-th later reading, (b) another's 4 H-th, (c) age, (d) path.
pub type Causes = [bool; 4];

/// One reading that arrived.
#[derive(Debug, Clone, Copy)]
pub struct Stay {
    /// Its place in the log.
    pub sample: usize,
    /// The path until then, in metres.
    path: f64,
    /// The number of the arrival at which it leaves.
    pub leaves: Option<usize>,
    /// By travel: whether its sensor's next reading takes its place, and the number of the arrival at which it is reported.
    pub(crate) replaced: bool,
    pub due: Option<usize>,
    pub causes: Causes,
}

#[derive(Debug)]
pub struct History {
    pub fates: Vec<Fate>,
    pub stays: Vec<Stay>,
    /// Whether a decision lies within the margin of its threshold, so that everything after it may differ.
    pub doubtful: bool,
    /// By travel: those whose sensor's next reading takes their place.
    passing: Vec<usize>,
}

impl History {
    pub fn of(log: &Log, margins: &Margins) -> Self {
        let mut history = Self { fates: Vec::new(), stays: Vec::new(), doubtful: false, passing: Vec::new() };
        let mut path = 0.0;
        let (mut last_usable, mut latest): (Option<usize>, Option<i64>) = (None, None);
        for (index, sample) in log.samples.iter().enumerate() {
            let fate = if usize::from(sample.sensor) >= log.rules.sensors {
                Fate::UnknownSensor
            } else if !has_pose(sample) {
                Fate::BadPose
            } else if latest.is_some_and(|latest| sample.t < latest) {
                Fate::TimeBackwards
            } else if history.repeats(log, index) {
                Fate::Duplicate
            } else {
                let last = last_usable.unwrap_or(index);
                let step = distance(log.samples[last].robot, sample.robot);
                let [least, most] =
                    log.rules.span.map_or([0.0, f64::INFINITY], |[travel, step]| [step / 2.0, longest_step(travel)]);
                history.doubtful |= log.rules.span.is_some() && (step - least).abs() <= margins.step;
                if step > least || log.rules.span.is_none() {
                    path += step.min(most);
                    last_usable = Some(index);
                } else {
                    last_usable = Some(last);
                }
                history.fate_of_usable(log, index, margins)
            };
            if let Fate::Arrived(_) = fate {
                let (causes, replaced, due) = ([false; 4], false, None);
                history.stays.push(Stay { sample: index, path, leaves: None, replaced, due, causes });
                if let Some(span) = log.rules.span {
                    history.enter_spaced(log, span, margins);
                }
            }
            if !matches!(fate, Fate::UnknownSensor | Fate::BadPose | Fate::TimeBackwards) {
                latest = Some(sample.t);
            }
            history.fates.push(fate);
        }
        if log.rules.span.is_some() {
            return history;
        }
        for arrival in 0..history.stays.len() {
            let (end, doubtful) = history.end_of(log, arrival, margins);
            history.doubtful |= doubtful;
            if let Some((leaves, causes)) = end {
                history.stays[arrival].leaves = Some(leaves);
                history.stays[arrival].causes = causes;
            }
        }
        history
    }

    /// A reading whose sensor moved less than `min_step` since its last one in the local map, or that repeats its
    /// sensor's previous one, takes no slot.
    fn fate_of_usable(&mut self, log: &Log, index: usize, margins: &Margins) -> Fate {
        let sample = &log.samples[index];
        let previous = self.fates.iter().zip(&log.samples).rev().find_map(|(fate, earlier)| {
            let usable = matches!(fate, Fate::Held | Fate::Still | Fate::Arrived(_));
            (usable && earlier.sensor == sample.sensor).then_some(earlier)
        });
        if log.rules.drop_held && previous.is_some_and(|previous| previous.echo() == sample.echo()) {
            return Fate::Held;
        }
        if let Some(min_step) = log.rules.min_step {
            let last = (0..self.stays.len()).rev().find(|&a| log.samples[self.stays[a].sample].sensor == sample.sensor);
            let last_in_map = last.filter(|&arrival| match log.rules.span {
                Some(_) => self.stays[arrival].leaves.is_none(),
                None => self.end_of(log, arrival, margins).0.is_none(),
            });
            if let Some(arrival) = last_in_map {
                let step = distance(log.samples[self.stays[arrival].sample].position, sample.position);
                self.doubtful |= (step - min_step).abs() <= margins.step;
                if step < min_step {
                    return Fate::Still;
                }
            }
        }
        Fate::Arrived(self.stays.len())
    }

    /// Whether its sensor's last reading that arrived was taken at the same time and place.
    fn repeats(&self, log: &Log, index: usize) -> bool {
        let sample = &log.samples[index];
        let arrived = self.stays.iter().rev().map(|stay| &log.samples[stay.sample]);
        let last = arrived.into_iter().find(|earlier| earlier.sensor == sample.sensor);
        last.is_some_and(|last| last.t == sample.t && last.position == sample.position)
    }

    /// What the last reading that arrived does to the others, in a map by travel.
    fn enter_spaced(&mut self, log: &Log, [travel, step]: [f64; 2], margins: &Margins) {
        let (newcomer, history) = (self.stays.len() - 1, log.rules.history);
        let sample = |stay: &Stay| &log.samples[stay.sample];
        let (new, path) = (sample(&self.stays[newcomer]), self.stays[newcomer].path);
        let longest = log.rules.max_travel.map_or(travel, |most| most.min(travel));
        let past = |stay: &Stay| {
            let aged = log.rules.max_age.is_some_and(|limit| new.t - sample(stay).t > limit as i64);
            // Ten of the longest steps are the span itself, or up to ten micrometres less: never past it.
            let (passed, longest_steps) = (path - stay.path, (path - stay.path) / longest_step(travel));
            let whole = (longest_steps - longest_steps.round()).abs() < 1e-9;
            (aged || (passed > longest && !(whole && passed - longest < 1e-9)), {
                !whole && (passed - longest).abs() <= margins.path
            })
        };
        // Who is too old or too far back leaves; who has met all that could cross it is reported.
        for stay in &mut self.stays[..newcomer] {
            let (is_past, doubtful) = past(stay);
            self.doubtful |= doubtful;
            if is_past {
                stay.leaves = stay.leaves.or(Some(newcomer));
                stay.due = stay.due.or(Some(newcomer));
            }
        }
        // The sensor's readings in the map; all but the newest stayed.
        let of_sensor = |stay: &Stay| sample(stay).sensor == new.sensor;
        let present: Vec<usize> =
            (0..newcomer).filter(|&a| of_sensor(&self.stays[a]) && self.stays[a].leaves.is_none()).collect();
        let replaces = present.last().copied().filter(|&newest| self.passing.contains(&newest));
        let stayed = present.iter().rev().find(|&&arrival| Some(arrival) != replaces);
        let stays = stayed.is_none_or(|&arrival| {
            let old = sample(&self.stays[arrival]);
            let moved = distance(old.position, new.position);
            let cos = old.boresight[0] * new.boresight[0] + old.boresight[1] * new.boresight[1];
            let cross = old.boresight[0] * new.boresight[1] - old.boresight[1] * new.boresight[0];
            let turned = cross.atan2(cos).abs() - new.field_of_view / 2.0;
            self.doubtful |= (moved - step).abs() <= margins.step || (moved < step && turned.abs() <= margins.angle);
            moved >= step || turned >= 0.0
        });
        match replaces {
            Some(newest) => {
                self.stays[newest].leaves = Some(newcomer);
                self.stays[newest].replaced = true;
            }
            None => {
                // The slot that this one takes: whoever still needs its reading is reported before.
                let slots: Vec<usize> =
                    (0..newcomer).filter(|&a| of_sensor(&self.stays[a]) && !self.stays[a].replaced).collect();
                let lost = slots.len().checked_sub(2 * history).and_then(|place| self.stays[slots[place]].leaves);
                for arrival in 0..lost.unwrap_or(0) {
                    self.stays[arrival].due = self.stays[arrival].due.or(Some(newcomer));
                }
                if present.len() >= history {
                    self.stays[present[0]].leaves = Some(newcomer);
                }
            }
        }
        if !stays {
            self.passing.push(newcomer);
        }
    }

    /// Whether an arc is crossed with a partner when it is reported as settled.
    pub fn settled_with(&self, arc: usize, partner: usize) -> bool {
        let (reported, leaves) = (self.stays[arc].due.unwrap_or(usize::MAX), self.stays[partner].leaves);
        let still_there = leaves.is_none_or(|leaves| match self.stays[partner].replaced {
            true => leaves >= reported,
            false => leaves > arc,
        });
        arc != partner && partner < reported && still_there
    }

    /// The first arrival so far that makes this one leave, and why; and whether a path came close to its bound.
    fn end_of(&self, log: &Log, arrival: usize, margins: &Margins) -> (Option<(usize, Causes)>, bool) {
        let sample = |arrival: usize| &log.samples[self.stays[arrival].sample];
        let (own, rules) = (sample(arrival), &log.rules);
        let mut later = vec![0; rules.sensors];
        let mut doubtful = false;
        for newcomer in arrival + 1..self.stays.len() {
            let new = sample(newcomer);
            let of_sensor = &mut later[usize::from(new.sensor)];
            *of_sensor += 1;
            let path = self.stays[newcomer].path - self.stays[arrival].path;
            doubtful |= rules.max_travel.is_some_and(|limit| (path - limit).abs() <= margins.path);
            let causes = [
                new.sensor == own.sensor && *of_sensor == rules.history,
                new.sensor != own.sensor && *of_sensor == 4 * rules.history,
                rules.max_age.is_some_and(|limit| i128::from(new.t) - i128::from(own.t) > i128::from(limit)),
                rules.max_travel.is_some_and(|limit| path > limit),
            ];
            if causes.contains(&true) {
                return (Some((newcomer, causes)), doubtful);
            }
        }
        (None, doubtful)
    }

    /// Whether each of two arrived before the other left.
    pub fn met(&self, a: usize, b: usize) -> bool {
        let (earlier, later) = (a.min(b), a.max(b));
        earlier != later && self.stays[earlier].leaves.is_none_or(|leaves| later < leaves)
    }

    /// Whether a reading is in the local map once the first `arrivals` have arrived.
    pub fn present(&self, arrival: usize, arrivals: usize) -> bool {
        arrival < arrivals && self.stays[arrival].leaves.is_none_or(|leaves| leaves >= arrivals)
    }

    /// How many have arrived once this sample has been taken in.
    pub fn arrivals_until(&self, sample: usize) -> usize {
        self.stays.iter().filter(|stay| stay.sample <= sample).count()
    }
}

fn has_pose(sample: &Sample) -> bool {
    let numbers = [sample.position, sample.robot, sample.boresight];
    let length = sample.boresight[0].hypot(sample.boresight[1]);
    numbers.as_flattened().iter().all(|number| number.is_finite()) && (length - 1.0).abs() < 1e-4
}

/// What a step counts as at most in a map that spans `travel`, in metres: a tenth of it, in whole micrometres.
fn longest_step(travel: f64) -> f64 {
    ((travel * 1e6).round() / 10.0).floor() / 1e6
}

pub fn distance(from: [f64; 2], to: [f64; 2]) -> f64 {
    (to[0] - from[0]).hypot(to[1] - from[1])
}

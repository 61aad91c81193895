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
    pub causes: Causes,
}

#[derive(Debug)]
pub struct History {
    pub fates: Vec<Fate>,
    pub stays: Vec<Stay>,
    /// Whether a decision lies within the margin of its threshold, so that everything after it may differ.
    pub doubtful: bool,
}

impl History {
    pub fn of(log: &Log, margins: &Margins) -> Self {
        let mut history = Self { fates: Vec::new(), stays: Vec::new(), doubtful: false };
        let mut path = 0.0;
        let mut last_usable: Option<usize> = None;
        for (index, sample) in log.samples.iter().enumerate() {
            let fate = if usize::from(sample.sensor) >= log.rules.sensors {
                Fate::UnknownSensor
            } else if !has_pose(sample) {
                Fate::BadPose
            } else if last_usable.is_some_and(|last| sample.t < log.samples[last].t) {
                Fate::TimeBackwards
            } else {
                if let Some(last) = last_usable.replace(index) {
                    path += distance(log.samples[last].robot, sample.robot);
                }
                history.fate_of_usable(log, index, margins)
            };
            if let Fate::Arrived(_) = fate {
                history.stays.push(Stay { sample: index, path, leaves: None, causes: [false; 4] });
            }
            history.fates.push(fate);
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
            let last_in_map = last.filter(|&arrival| self.end_of(log, arrival, margins).0.is_none());
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

pub fn distance(from: [f64; 2], to: [f64; 2]) -> f64 {
    (to[0] - from[0]).hypot(to[1] - from[1])
}

//! A replay: one HTML file that shows a drive in any browser, offline.
//!
//! The log is fused once by each estimator that is asked for; what came of it is packed into columns (their format:
//! `docs/view.md`) and put into a page whose script is bundled from `web/view`.
mod columns;
mod gather;
mod page;

use std::fmt::Write as _;

use atm::{
    echo::AnyEstimator,
    error::{Error, Problem, Result},
    intake::SensorModel,
    job::{LogJob, OpenLog, Progress, Watched, poses_of},
    log::{Input, echo_table::EchoTable},
    pipeline::{self, EchoSink, Emit, Settings},
    summary::Summary,
};
use atm_core::Point2;

pub use self::gather::MOST_READINGS;
use self::gather::{Again, Found, Gathering};
use crate::world::World;

/// What a panel of a replay can show.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// The centre of each reading's cone.
    Centerline,
    /// The arc-transversal median.
    Atm,
    /// The consensus of points and walls.
    Consensus,
}

impl Method {
    /// All, as they stand from left to right.
    pub const ALL: [Self; 3] = [Self::Centerline, Self::Atm, Self::Consensus];

    /// Its word, the one of `atm compare`.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Centerline => "centerline",
            Self::Atm => "atm",
            Self::Consensus => "consensus",
        }
    }
}

/// Units of lengths that are shown to a person.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Units {
    /// Metres and centimetres.
    Metric,
    /// Inches.
    Inches,
}

impl Units {
    /// Inches where a sensor's range resolution is some of them, and no whole number of millimetres; else metric ones.
    pub fn of(sensors: &[SensorModel]) -> Self {
        let whole = |value: f64| (value - value.round()).abs() < 1e-6 && value.round() > 0.0;
        let in_inches = |sensor: &SensorModel| {
            let step = sensor.range_resolution.metres();
            whole(step / atm::units::inches(0.125)) && !whole(step * 1000.0)
        };
        if sensors.iter().any(in_inches) { Self::Inches } else { Self::Metric }
    }
}

/// How a replay is made.
#[derive(Debug)]
pub struct ViewJob {
    /// The log.
    pub log: LogJob,
    /// How it is fused; the estimator by which it is fused is each method's, with all else the same.
    pub settings: Settings,
    /// The estimators, one for each fused method that is wanted.
    pub estimators: Vec<AnyEstimator>,
    /// What panels can show, at least one.
    pub methods: Vec<Method>,
    /// What made it, as it can be typed again.
    pub command: String,
    /// The walls, where they are known.
    pub world: Option<World>,
    /// Where echoes really came from: a table.
    pub truth: Option<String>,
    /// Units shown, where they are not to follow the sensors.
    pub units: Option<Units>,
    /// Most readings that it holds.
    pub most: usize,
}

/// A replay that was made.
#[derive(Debug)]
pub struct Replay {
    /// The page.
    pub html: String,
    /// What each fused method has counted.
    pub summaries: Vec<(Method, Summary)>,
    /// Readings of the log, and one of how many of a sensor's is shown.
    pub thinned: (u64, u64),
    /// What a person should know of how the log was read.
    pub notes: Vec<String>,
}

/// All that is put into the page.
struct Contents {
    drive: Gathering,
    /// Method, kinds, echoes, counts.
    fused: Vec<(Method, &'static [&'static str], Vec<Found>, Summary)>,
    truth: Vec<Point2<f64>>,
    units: Units,
}

impl ViewJob {
    /// Fuses the log and writes the page; `progress` is told bytes read and the log's length in each pass, and may end the
    /// run.
    ///
    /// # Errors
    /// The log can't be read, or has nothing that could be shown; standard input where it has to be read more than once.
    pub fn run(&self, progress: &mut Progress<'_>) -> Result<Replay> {
        self.check()?;
        let mut drive = Gathering::new(self.most);
        // Without any, the drive is fused all the same: what is in the local map comes of it.
        let first = self.estimators.first().copied().unwrap_or(self.settings.estimator);
        let mut notes = Vec::new();
        let (summary, sensors) = self.pass(first, &mut drive, progress, Some(&mut notes))?;
        drive.finish();
        let mut fused = Vec::new();
        let found = std::mem::take(&mut drive.found);
        if let Some(estimator) = self.estimators.first() {
            fused.push((method_of(estimator), estimator.kinds(), found, summary.clone()));
        }
        for estimator in self.estimators.iter().skip(1) {
            let mut again = Again::new(&mut drive);
            let (summary, _) = self.pass(*estimator, &mut again, progress, None)?;
            let found = again.found;
            fused.push((method_of(estimator), estimator.kinds(), found, summary));
        }
        let truth = self.truth.as_deref().map(truth).transpose()?.unwrap_or_default();
        let units = self.units.unwrap_or_else(|| Units::of(&sensors));
        let mut summaries: Vec<(Method, Summary)> =
            fused.iter().map(|(method, _, _, summary)| (*method, summary.clone())).collect();
        if summaries.is_empty() {
            summaries.push((Method::Centerline, summary));
        }
        let thinned = (drive.offered, drive.stride);
        let html = page::write(self, &Contents { drive, fused, truth, units })?;
        Ok(Replay { html, summaries, thinned, notes })
    }

    fn check(&self) -> Result<()> {
        let refuse = |message: &str| Err(Error::Settings { message: message.into() });
        if self.methods.is_empty() {
            return refuse("a replay needs a method to show");
        }
        if self.log.input == "-" && self.estimators.len() > 1 {
            return refuse("standard input can be read once only: name one of atm and consensus with --methods");
        }
        Ok(())
    }

    /// Reads the log once. Returns what was counted, and the sensors.
    fn pass(
        &self,
        estimator: AnyEstimator,
        sink: &mut dyn EchoSink,
        progress: &mut Progress<'_>,
        notes: Option<&mut Vec<String>>,
    ) -> Result<(Summary, Vec<SensorModel>)> {
        let (format, input) = self.log.open()?;
        let length = input.length;
        let mut log = self.log.readings(format, input, false)?;
        let sensors = self.log.sensors()?;
        let settings = Settings { emit: Emit::Settled, estimator, ..self.settings };
        let (source, track) = log.source();
        let mut watched = Watched::new(source, length, progress);
        let (summary, result) = pipeline::fuse(&mut watched, track, &sensors, &settings, sink, &mut |_| {});
        result.and_then(|()| watched.finish())?;
        if let (OpenLog::Mcap(log), Some(notes)) = (&log, notes) {
            notes.extend(poses_of(log).map(|source| format!("poses     {source}")));
            notes.extend(log.notes());
        }
        Ok((summary, sensors))
    }
}

fn method_of(estimator: &AnyEstimator) -> Method {
    if estimator.is_consensus() { Method::Consensus } else { Method::Atm }
}

/// The points of a table of the truth.
fn truth(path: &str) -> Result<Vec<Point2<f64>>> {
    let mut table = EchoTable::new(Input::open(path)?)?;
    let (mut points, mut bad) = (Vec::new(), None);
    while let Some(estimate) = table.next_estimate(&mut |problem: Problem| bad = bad.take().or(Some(problem)))? {
        if points.len() < MOST_READINGS {
            points.push(estimate.position);
        }
    }
    match bad {
        Some(problem) => Err(Error::Strict { problem }),
        None => Ok(points),
    }
}

/// A command line as a shell takes it.
pub fn quoted<'a>(words: impl IntoIterator<Item = &'a str>) -> String {
    let mut line = String::new();
    for word in words {
        if !line.is_empty() {
            line.push(' ');
        }
        let plain = |letter: char| letter.is_ascii_alphanumeric() || "-_./=:,+@%".contains(letter);
        if !word.is_empty() && word.chars().all(plain) {
            line.push_str(word);
        } else {
            // A `String` takes whatever is written.
            let _ = write!(line, "'{}'", word.replace('\'', r"'\''"));
        }
    }
    line
}

#[cfg(test)]
mod tests;

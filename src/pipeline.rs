//! From a log to echoes: source → pose → fuser → sink, in one pass and bounded memory.

use std::sync::Arc;

use atm_core::{
    ArcCrossing, Arrival, Bounds, DomainError, Estimator, Fuser, Held, Kind, Meaning, Reading, Rejected, Sink, Span,
    Storage,
};

pub use crate::intake::{AnyTrack, Defaults, SensorModel, min_angle_for, readings};
use crate::{
    diagnose::{Diagnosis, Evidence, MapSpan, Run, diagnose},
    echo::{AnyEcho, AnyEstimator},
    error::{Error, Problem, Reason, Result},
    intake::{Consumer, read},
    log::{Row, Source},
    stamp,
    storage::{LatestSlots, SettledSlots, Slots, StorageError},
    summary::{Counts, Summary},
    track::Pose,
};

/// When echoes are reported.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Emit {
    /// When the reading leaves the local map, from every arc it met.
    #[default]
    Settled,
    /// At the reading's arrival, from the arcs in the local map then.
    Latest,
}

/// Which readings the local map holds (Sec. IV-D, length of sonar history).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum History {
    /// Spaced readings over the travel that crossings of θmin take at a distance: the same at any rate and speed.
    ByTravel {
        /// That distance, in metres; `None` for the largest range of the sensors, 100 in at most.
        reach: Option<f64>,
        /// The most readings of each sensor, 1 to 10,000.
        most: usize,
    },
    /// The last H readings of every sensor, 1 to 10,000: the paper's rule, for its robot's pace.
    ByCount(usize),
}

impl History {
    /// The paper's, by count (Sec. IV-D).
    pub const PAPER: Self = Self::ByCount(10);
    /// The most readings of a sensor that a map by travel holds, where nobody says how many.
    pub const MOST: usize = 50;
    /// How many times the travel of a crossing at the reach the map spans: a median takes three crossings, and readings fall
    /// where they fall. Measured (docs/paper.md): with 1 a doorway passed exactly abreast reads half as wide as with 1.25.
    pub const MARGIN: f64 = 1.25;
    /// The longest distance for which the map spans the travel, where nobody says more: 100 in, in metres (Sec. IV-D).
    pub const MAX_REACH: f64 = 2.54;

    /// The most readings of a sensor in the local map.
    pub const fn most(&self) -> usize {
        match self {
            Self::ByTravel { most, .. } | Self::ByCount(most) => *most,
        }
    }
}

impl Default for History {
    /// By travel, for the sensors' own range.
    fn default() -> Self {
        Self::ByTravel { reach: None, most: Self::MOST }
    }
}

/// How to fuse.
#[derive(Debug, Clone, Copy)]
pub struct Settings {
    /// When echoes are reported.
    pub emit: Emit,
    /// Which readings the local map holds.
    pub history: History,
    /// More bounds on the local map.
    pub bounds: Bounds<f64>,
    /// Who says where on its arc an echo came from.
    pub estimator: AnyEstimator,
    /// Whether the first unusable record ends the run.
    pub strict: bool,
}

impl Settings {
    /// The travel that the local map spans with sensors of which the largest range is `max_range` (metres, possibly +∞);
    /// `None` by count.
    ///
    /// # Errors
    /// A reach that is no positive number, or a travel above 1000 m.
    pub fn span(&self, max_range: f64) -> Result<Option<Span<f64>>, DomainError> {
        let History::ByTravel { reach, most } = self.history else { return Ok(None) };
        let reach = reach.unwrap_or_else(|| max_range.min(History::MAX_REACH));
        let most = u16::try_from(most).unwrap_or(u16::MAX);
        Span::for_reach(reach * History::MARGIN, self.estimator.min_angle(), most).map(Some)
    }

    /// The bounds on the local map, its span with them.
    ///
    /// # Errors
    /// As [`Settings::span`].
    pub fn bounds(&self, max_range: f64) -> Result<Bounds<f64>, DomainError> {
        Ok(self.span(max_range)?.map_or(self.bounds, |span| self.bounds.with_span(span)))
    }
}

/// The largest range of some sensors, in metres; 100 in without any.
pub fn largest_range(sensors: &[SensorModel]) -> f64 {
    let ranges = sensors.iter().map(|sensor| sensor.limits.max());
    ranges.reduce(f64::max).unwrap_or(History::MAX_REACH)
}

/// Where the echoes of a log go, and, for those who draw them, what they came from.
pub trait EchoSink {
    /// More sensors are known: `ids` are all of them, in order of their indices. Comes before their first echo.
    fn sensors(&mut self, _ids: &[Arc<str>]) -> Result<()> {
        Ok(())
    }

    /// A usable record before its readings: its times, and where the robot was. Reports that follow are due to it.
    fn record(&mut self, _row: &Row, _pose: Pose) -> Result<()> {
        Ok(())
    }

    /// A reading that has entered the local map.
    fn reading(&mut self, _reading: &Reading<f64>) -> Result<()> {
        Ok(())
    }

    /// An echo. Returns whether it was written.
    fn echo(&mut self, echo: &AnyEcho) -> Result<bool>;

    /// Whether [`EchoSink::crossings`] is to be called.
    fn wants_crossings(&self) -> bool {
        false
    }

    /// The crossings on one arc, ordered by the other arc's time, its sensor and the azimuth.
    fn crossings(&mut self, _crossings: &[ArcCrossing<f64>]) -> Result<()> {
        Ok(())
    }

    /// Hands everything on: the input has nothing more to give for now.
    fn flush(&mut self) -> Result<()>;
}

/// Fuses the whole of `source` into `sink`; `progress` is told the bytes read, now and then.
///
/// The summary counts what came before an error, too: nothing that was computed is lost.
pub fn fuse(
    source: &mut dyn Source,
    track: Option<&mut AnyTrack>,
    sensors: &[SensorModel],
    settings: &Settings,
    sink: &mut dyn EchoSink,
    progress: &mut dyn FnMut(u64),
) -> (Summary, Result<()>) {
    let mut evidence = Evidence::new(Some(*settings.estimator.min_angle()));
    let observed = (&mut evidence, sink);
    let (mut summary, result) = match settings.estimator {
        AnyEstimator::Median(median) => fuse_by(median, source, track, sensors, settings, observed, progress),
        AnyEstimator::Consensus(consensus) => fuse_by(consensus, source, track, sensors, settings, observed, progress),
    };
    summary.advice = advice(&evidence, &summary, settings, source.diagnoses());
    (summary, result)
}

/// What is likely wrong with a log that was fused.
fn advice(evidence: &Evidence, summary: &Summary, settings: &Settings, found: Vec<Diagnosis>) -> Vec<Diagnosis> {
    let run = Run {
        resolved: summary.resolved(),
        arcs: summary.echoes.total() + summary.ignored_pairs + summary.ignored_none,
        pairs: summary.ignored_pairs,
        near: summary.echoes.get(Kind::Near.name()),
        span: summary.map_travel_m.map_or(MapSpan::Readings(settings.history.most()), MapSpan::Travel),
        min_angle: *settings.estimator.min_angle(),
    };
    let drops_held = settings.bounds.held() != Held::Keep;
    diagnose(evidence, &summary.dropped, summary.clock_resets, drops_held, Some(&run), found)
}

fn fuse_by<E: Estimator<f64>>(
    estimator: E,
    source: &mut dyn Source,
    track: Option<&mut AnyTrack>,
    sensors: &[SensorModel],
    settings: &Settings,
    (evidence, sink): (&mut Evidence, &mut dyn EchoSink),
    progress: &mut dyn FnMut(u64),
) -> (Summary, Result<()>)
where
    E::Echo: Copy + Into<AnyEcho>,
{
    let mut summary = Summary { echoes: Counts::of(settings.estimator.kinds()), ..Summary::default() };
    let result = match settings.emit {
        Emit::Latest => latest_fuser(estimator, settings, sensors).and_then(|fuser| {
            let fusing = Fusing::new(fuser, settings, Observed { evidence, sensors }, sink);
            fusing.run(source, track, sensors, settings.strict, &mut summary, progress)
        }),
        Emit::Settled => settled_fuser(estimator, settings, sensors).and_then(|fuser| {
            let fusing = Fusing::new(fuser, settings, Observed { evidence, sensors }, sink);
            fusing.run(source, track, sensors, settings.strict, &mut summary, progress)
        }),
    };
    (summary, result)
}

/// A fuser that reports at arrival, with room for these sensors.
///
/// # Errors
/// A local map that can't be had.
pub fn latest_fuser<E: Estimator<f64>>(
    estimator: E,
    settings: &Settings,
    sensors: &[SensorModel],
) -> Result<Fuser<f64, LatestSlots<f64>, E>> {
    let storage = storage(settings, sensors).map_err(too_large)?;
    Ok(Fuser::latest(estimator, bounds_for(settings, sensors)?, storage))
}

/// A fuser that reports when a reading has met all that could cross it, with room for these sensors.
///
/// # Errors
/// A local map that can't be had.
pub fn settled_fuser<E: Estimator<f64>>(
    estimator: E,
    settings: &Settings,
    sensors: &[SensorModel],
) -> Result<Fuser<f64, SettledSlots<f64>, E>> {
    let storage = storage(settings, sensors).map_err(too_large)?;
    Ok(Fuser::settled(estimator, bounds_for(settings, sensors)?, storage))
}

fn bounds_for(settings: &Settings, sensors: &[SensorModel]) -> Result<Bounds<f64>> {
    settings.bounds(largest_range(sensors)).map_err(|error| Error::Settings { message: error.to_string() })
}

/// Room for these sensors; those that become known on the way are added then.
fn storage<const B: usize>(settings: &Settings, sensors: &[SensorModel]) -> Result<Slots<f64, B>, StorageError> {
    let count = sensors.len().max(1);
    match settings.history {
        History::ByTravel { most, .. } => Slots::by_travel(count, most),
        History::ByCount(history) => Slots::new(count, history),
    }
}

fn too_large(error: StorageError) -> Error {
    Error::Settings { message: error.to_string() }
}

/// What is seen of the log on the way.
struct Observed<'a> {
    evidence: &'a mut Evidence,
    sensors: &'a [SensorModel],
}

/// The consumer that fuses.
struct Fusing<'a, E, const B: usize> {
    fuser: Fuser<f64, Slots<f64, B>, E>,
    observed: Observed<'a>,
    /// Sensors that the fuser has room for.
    room: usize,
    settings: &'a Settings,
    /// The largest range of the sensors so far, in metres; `None` where the map's span does not wait for it.
    max_range: Option<f64>,
    sink: &'a mut dyn EchoSink,
    wants_crossings: bool,
    crossings: Vec<ArcCrossing<f64>>,
}

impl<'a, E: Estimator<f64>, const B: usize> Fusing<'a, E, B>
where
    Slots<f64, B>: Storage<f64>,
    E::Echo: Copy + Into<AnyEcho>,
{
    fn new(
        fuser: Fuser<f64, Slots<f64, B>, E>,
        settings: &'a Settings,
        observed: Observed<'a>,
        sink: &'a mut dyn EchoSink,
    ) -> Self {
        let wants_crossings = sink.wants_crossings();
        // What a rig says of its sensors is known; what a recording says comes with its readings.
        let max_range = observed.sensors.is_empty().then_some(0.0);
        let room = observed.sensors.len().max(1);
        Self { fuser, observed, room, settings, max_range, sink, wants_crossings, crossings: Vec::new() }
    }

    /// The local map spans what the farthest of the sensors takes, once that is known.
    fn reach_farther(&mut self, row: &Row) -> Result<()> {
        let Some(known) = self.max_range.filter(|known| *known < History::MAX_REACH) else { return Ok(()) };
        let farthest = row.views.iter().map(|view| view.limits.max()).fold(known, f64::max);
        if farthest > known {
            self.max_range = Some(farthest);
            let span = self.settings.span(farthest);
            let span = span.map_err(|error| Error::Settings { message: error.to_string() })?;
            self.fuser.set_span(span);
        }
        Ok(())
    }

    /// Reads to the end, and reports what is in the local map then. A run that fails reports no more: what it has
    /// written is the beginning of what an undisturbed run writes.
    fn run(
        mut self,
        source: &mut dyn Source,
        track: Option<&mut AnyTrack>,
        sensors: &[SensorModel],
        strict: bool,
        summary: &mut Summary,
        progress: &mut dyn FnMut(u64),
    ) -> Result<()> {
        let read = read(source, track, sensors, strict, &mut self, summary, progress);
        if read.is_ok() {
            self.finish(summary)?;
        }
        summary.map_travel_m = self.fuser.span().map(|span| span.travel());
        self.sink.flush()?;
        read
    }

    /// Works with the fuser and the sink of its reports.
    fn reporting<R>(
        &mut self,
        summary: &mut Summary,
        work: impl FnOnce(&mut Fuser<f64, Slots<f64, B>, E>, &mut Reports<'_>) -> R,
    ) -> Result<R> {
        let mut reports = Reports {
            sink: &mut *self.sink,
            summary,
            wants_crossings: self.wants_crossings,
            crossings: &mut self.crossings,
            failed: None,
        };
        let result = work(&mut self.fuser, &mut reports);
        reports.failed.map_or(Ok(result), Err)
    }

    /// Reports what is in the local map, and empties it.
    fn finish(&mut self, summary: &mut Summary) -> Result<()> {
        self.reporting(summary, |fuser, reports| fuser.finish(reports))
    }
}

impl<E: Estimator<f64>, const B: usize> Consumer for Fusing<'_, E, B>
where
    Slots<f64, B>: Storage<f64>,
    E::Echo: Copy + Into<AnyEcho>,
{
    fn sensors(&mut self, ids: &[Arc<str>]) -> Result<()> {
        if ids.len() > self.room {
            let mut grown = Ok(());
            self.fuser.grow(|storage| grown = storage.grow(ids.len()));
            grown.map_err(too_large)?;
            self.room = ids.len();
        }
        self.sink.sensors(ids)
    }

    fn record(&mut self, row: &Row, pose: Pose) -> Result<()> {
        self.observed.evidence.record(row, Some(pose), self.observed.sensors);
        self.reach_farther(row)?;
        self.sink.record(row, pose)
    }

    fn reading(&mut self, row: &Row, reading: &Reading<f64>, summary: &mut Summary) -> Result<()> {
        match self.reporting(summary, |fuser, reports| fuser.push(reading, reports))? {
            Ok(Arrival::Entered) => {
                summary.readings += 1;
                summary.no_echo += u64::from(reading.range.meaning() != Meaning::Echo);
                self.sink.reading(reading)?;
            }
            Ok(Arrival::Replaced) => {
                summary.skipped.held += 1;
                self.sink.reading(reading)?;
            }
            Ok(Arrival::Held) => summary.skipped.held += 1,
            Ok(Arrival::Duplicate) => summary.duplicates += 1,
            Ok(_) => summary.skipped.min_step += 1,
            Err(rejected) => summary.dropped.add(refused(row, reading, rejected)),
        }
        Ok(())
    }

    fn clock_reset(&mut self, summary: &mut Summary) -> Result<()> {
        self.observed.evidence.clock_reset();
        self.finish(summary)
    }

    fn wait(&mut self) -> Result<()> {
        self.sink.flush()
    }
}

/// The problem of a reading that the fuser can't use.
fn refused(row: &Row, reading: &Reading<f64>, rejected: Rejected) -> Problem {
    let reason = match rejected {
        Rejected::UnknownSensor => Reason::UnknownSensor,
        Rejected::TimeBackwards => Reason::TimeBackwards,
        _ => Reason::BadPose,
    };
    let value = format!("sensor number {} at t {}: {rejected}", reading.sensor, stamp::text(row.t));
    Problem { reason, place: row.place.clone(), value }
}

/// The fuser's sink: counts, and hands on. It can't fail, so an error waits until somebody asks.
struct Reports<'a> {
    sink: &'a mut dyn EchoSink,
    summary: &'a mut Summary,
    wants_crossings: bool,
    crossings: &'a mut Vec<ArcCrossing<f64>>,
    failed: Option<Error>,
}

impl Reports<'_> {
    /// The crossings of the arc that is reported now, in an order that does not depend on how the local map is stored.
    fn hand_on_crossings(&mut self) {
        if self.crossings.is_empty() {
            return;
        }
        self.crossings.sort_unstable_by(|a, b| {
            let key = |crossing: &ArcCrossing<f64>| (crossing.t_other, crossing.sensor_other);
            key(a).cmp(&key(b)).then(a.bearing.sin().total_cmp(&b.bearing.sin()))
        });
        if self.failed.is_none() {
            self.failed = self.sink.crossings(self.crossings).err();
        }
        self.crossings.clear();
    }
}

impl<E: Copy + Into<AnyEcho>> Sink<f64, E> for Reports<'_> {
    fn echo(&mut self, echo: &E) {
        self.hand_on_crossings();
        let echo = (*echo).into();
        self.summary.echoes.add(echo.place());
        if self.failed.is_some() {
            return;
        }
        match self.sink.echo(&echo) {
            Ok(written) => self.summary.written += u64::from(written),
            Err(error) => self.failed = Some(error),
        }
    }

    fn ignored(&mut self, crossings: u32) {
        self.hand_on_crossings();
        match crossings {
            0 => self.summary.ignored_none += 1,
            _ => self.summary.ignored_pairs += 1,
        }
    }

    fn wants_crossings(&self) -> bool {
        self.wants_crossings
    }

    fn crossing(&mut self, crossing: &ArcCrossing<f64>) {
        self.crossings.push(*crossing);
    }
}

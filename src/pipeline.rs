//! From a log to echoes: source → pose → fuser → sink, in one pass and bounded memory.

use std::sync::Arc;

use atm_core::{ArcCrossing, Arrival, Bounds, Estimator, Fuser, Held, Kind, Meaning, Reading, Rejected, Sink, Storage};

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

/// How to fuse.
#[derive(Debug, Clone, Copy)]
pub struct Settings {
    /// When echoes are reported.
    pub emit: Emit,
    /// H, 1 to 10,000.
    pub history: usize,
    /// More bounds on the local map.
    pub bounds: Bounds<f64>,
    /// Who says where on its arc an echo came from.
    pub estimator: AnyEstimator,
    /// Whether the first unusable record ends the run.
    pub strict: bool,
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
    let mut evidence = Evidence::new(Some(settings.estimator.min_angle()));
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
        span: MapSpan::Readings(settings.history),
        min_angle: settings.estimator.min_angle(),
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
    let (bounds, history) = (settings.bounds, settings.history);
    // Sensors that become known on the way are added then.
    let count = sensors.len().max(1);
    let result = match settings.emit {
        Emit::Latest => LatestSlots::new(count, history).map_err(too_large).and_then(|storage| {
            let observed = Observed { evidence, sensors };
            let fusing = Fusing::new(Fuser::latest(estimator, bounds, storage), count, observed, sink);
            fusing.run(source, track, sensors, settings.strict, &mut summary, progress)
        }),
        Emit::Settled => SettledSlots::new(count, history).map_err(too_large).and_then(|storage| {
            let observed = Observed { evidence, sensors };
            let fusing = Fusing::new(Fuser::settled(estimator, bounds, storage), count, observed, sink);
            fusing.run(source, track, sensors, settings.strict, &mut summary, progress)
        }),
    };
    (summary, result)
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
        room: usize,
        observed: Observed<'a>,
        sink: &'a mut dyn EchoSink,
    ) -> Self {
        let wants_crossings = sink.wants_crossings();
        Self { fuser, observed, room, sink, wants_crossings, crossings: Vec::new() }
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

//! From a log to echoes: source → pose → fuser → sink, in one pass and bounded memory.

use atm_core::{
    ArcCrossing, Arrival, Beam, Bounds, DomainError, Echo, Fuser, Isometry2, Limits, Meaning, MinAngle, Point2,
    RangeResolution, Reading, Rejected, Sink, Storage, TransversalMedian, UnitComplex, Vector2, resolution,
};

use crate::{
    error::{Error, Problem, Reason, Result},
    log::{Next, Row, Source},
    rig::Rig,
    stamp,
    storage::{LatestSlots, SettledSlots},
    summary::Summary,
    track::{Clock, Pose, PoseStream, Tick, Track, time_backwards},
};

/// The robot's path, from whatever file.
pub type AnyTrack = Track<Box<dyn PoseStream>>;

/// When echoes are reported.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Emit {
    /// When the reading leaves the local map, from every arc it met.
    #[default]
    Settled,
    /// At the reading's arrival, from the arcs in the local map then.
    Latest,
}

/// A sensor with all that its readings need.
#[derive(Debug, Clone, Copy)]
pub struct SensorModel {
    /// Its pose in the robot frame, boresight along +x.
    pub mount: Isometry2<f64>,
    /// Between which distances a reading is an echo.
    pub limits: Limits<f64>,
    /// Its beam.
    pub beam: Beam<f64>,
    /// Its range resolution.
    pub range_resolution: RangeResolution<f64>,
}

/// What holds for sensors of which a rig says nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct Defaults {
    /// The beam, where a rig gives none; [`Defaults::FIELD_OF_VIEW`] where this is not given either.
    pub field_of_view: Option<Beam<f64>>,
    /// Beats the rig's where it is given.
    pub range_resolution: Option<RangeResolution<f64>>,
}

impl Defaults {
    /// 22.5°, the Polaroid's (Sec. II), in radians.
    pub const FIELD_OF_VIEW: f64 = std::f64::consts::PI / 8.0;
    /// 1 in, the Nomad's (Sec. IV-B), in metres.
    pub const RANGE_RESOLUTION: f64 = 0.0254;

    /// The rig's sensors, completed.
    ///
    /// # Errors
    /// A value of the rig that is outside its domain, by the sensor's id.
    pub fn complete(&self, rig: &Rig) -> Result<Vec<SensorModel>> {
        rig.sensors()
            .iter()
            .map(|sensor| self.complete_one(sensor).map_err(|error| named(rig, sensor.id(), error)))
            .collect()
    }

    fn complete_one(&self, sensor: &crate::rig::Sensor) -> Result<SensorModel, DomainError> {
        let beam = || self.field_of_view.map_or_else(|| Beam::new(Self::FIELD_OF_VIEW), Ok);
        let resolution = || RangeResolution::new(sensor.range_resolution().unwrap_or(Self::RANGE_RESOLUTION));
        Ok(SensorModel {
            mount: sensor.mount(),
            limits: Limits::new(sensor.min_range(), sensor.max_range())?,
            beam: sensor.field_of_view().map_or_else(beam, Beam::new)?,
            range_resolution: self.range_resolution.map_or_else(resolution, Ok)?,
        })
    }

    /// Whether some sensor's range resolution is neither given nor in the rig.
    pub fn guesses_resolution(&self, rig: &Rig) -> bool {
        self.range_resolution.is_none() && rig.sensors().iter().any(|sensor| sensor.range_resolution().is_none())
    }
}

/// The angle that gives every sensor the wanted improvement at a distance in metres: the largest of theirs, and 30° where there
/// are none (equation 2, inverse).
///
/// # Errors
/// As [`resolution::min_angle_for`], of the first sensor for which there is no such angle.
pub fn min_angle_for(improvement: f64, distance: f64, sensors: &[SensorModel]) -> Result<MinAngle<f64>, DomainError> {
    let mut widest: Option<MinAngle<f64>> = None;
    for sensor in sensors {
        let angle = resolution::min_angle_for(improvement, distance, &sensor.beam, sensor.range_resolution)?;
        if widest.is_none_or(|widest| angle.radians() > widest.radians()) {
            widest = Some(angle);
        }
    }
    Ok(widest.unwrap_or(MinAngle::PAPER))
}

fn named(rig: &Rig, id: &str, error: DomainError) -> Error {
    Error::Rig { file: rig.name().into(), message: format!("sensor {id}: {error}") }
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
    /// θmin and the options of Sec. III-B.
    pub estimator: TransversalMedian<f64>,
    /// Whether the first unusable record ends the run.
    pub strict: bool,
}

/// Where the echoes of a log go.
pub trait EchoSink {
    /// An echo. Returns whether it was written.
    fn echo(&mut self, echo: &Echo<f64>) -> Result<bool>;

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
    let mut summary = Summary::default();
    let (estimator, bounds) = (settings.estimator, settings.bounds);
    let storage_error = |error: crate::storage::StorageError| Error::Settings { message: error.to_string() };
    let result = match settings.emit {
        Emit::Latest => LatestSlots::new(sensors.len(), settings.history).map_err(storage_error).and_then(|storage| {
            let fuser = Fuser::latest(estimator, bounds, storage);
            Run::new(fuser, track, sensors, settings.strict, sink, &mut summary).read(source, progress)
        }),
        Emit::Settled => {
            SettledSlots::new(sensors.len(), settings.history).map_err(storage_error).and_then(|storage| {
                let fuser = Fuser::settled(estimator, bounds, storage);
                Run::new(fuser, track, sensors, settings.strict, sink, &mut summary).read(source, progress)
            })
        }
    };
    (summary, result)
}

/// Rows between two reports of progress.
const PROGRESS_EVERY: u64 = 4096;

struct Run<'a, S> {
    fuser: Fuser<f64, S>,
    track: Option<&'a mut AnyTrack>,
    sensors: &'a [SensorModel],
    strict: bool,
    clock: Clock,
    /// Clock resets so far: poses and readings of the same epoch belong together.
    epoch: u32,
    reports: Reports<'a>,
}

impl<'a, S: Storage<f64>> Run<'a, S> {
    fn new(
        fuser: Fuser<f64, S>,
        track: Option<&'a mut AnyTrack>,
        sensors: &'a [SensorModel],
        strict: bool,
        sink: &'a mut dyn EchoSink,
        summary: &'a mut Summary,
    ) -> Self {
        let wants_crossings = sink.wants_crossings();
        let reports = Reports { sink, summary, wants_crossings, crossings: Vec::new(), failed: None };
        Self { fuser, track, sensors, strict, clock: Clock::default(), epoch: 0, reports }
    }

    /// Reads to the end, and reports what is in the local map then. A run that fails reports no more: what it has
    /// written is the beginning of what an undisturbed run writes.
    fn read(mut self, source: &mut dyn Source, progress: &mut dyn FnMut(u64)) -> Result<()> {
        let read = self.rows(source, progress);
        if read.is_ok() {
            self.fuser.finish(&mut self.reports);
            self.reports.check()?;
        }
        self.reports.sink.flush()?;
        read
    }

    fn rows(&mut self, source: &mut dyn Source, progress: &mut dyn FnMut(u64)) -> Result<()> {
        let mut row = Row::default();
        let mut count = 0u64;
        loop {
            if source.drained() {
                self.reports.sink.flush()?;
            }
            let summary = &mut *self.reports.summary;
            let next = source.next_row(&mut row, &mut |problem| summary.dropped.add(problem))?;
            match next {
                Next::Record => self.take(&row)?,
                Next::Unusable => {}
                Next::End => return Ok(()),
            }
            self.reports.check()?;
            if self.strict
                && let Some((_, _, problem)) = self.reports.summary.dropped.iter().next()
            {
                return Err(Error::Strict { problem: problem.clone() });
            }
            count += 1;
            if count.is_multiple_of(PROGRESS_EVERY) {
                progress(source.position());
            }
        }
    }

    /// One record: its time, its pose, its readings.
    fn take(&mut self, row: &Row) -> Result<()> {
        if !self.clock.is_forward(row.t) {
            self.turn_back(row);
            return Ok(());
        }
        let Some(pose) = self.pose(row)? else {
            self.reports.summary.dropped.add(no_pose(row));
            return Ok(());
        };
        self.reports.summary.skipped.empty += row.empty;
        // A record without a usable reading does not set the clock.
        if !row.readings.is_empty() {
            self.clock.admit(row.t);
        }
        for reading in readings(row, pose, self.sensors) {
            self.push(row, &reading);
        }
        Ok(())
    }

    /// A record that is earlier than the latest usable one.
    fn turn_back(&mut self, row: &Row) {
        let problem = time_backwards(row.t, self.clock.now(), row.place.clone());
        self.reports.summary.dropped.add(problem);
        if self.clock.admit(row.t) == Tick::Reset {
            self.reports.summary.clock_resets += 1;
            self.epoch = self.epoch.saturating_add(1);
            self.fuser.finish(&mut self.reports);
        }
    }

    fn pose(&mut self, row: &Row) -> Result<Option<Pose>> {
        let Some(track) = self.track.as_deref_mut() else {
            return Ok(row.pose);
        };
        let summary = &mut *self.reports.summary;
        track.pose_at(self.epoch, row.t, &mut |problem| summary.dropped.add(problem))
    }

    fn push(&mut self, row: &Row, reading: &Reading<f64>) {
        match self.fuser.push(reading, &mut self.reports) {
            Ok(Arrival::Entered) => {
                let summary = &mut *self.reports.summary;
                summary.readings += 1;
                summary.no_echo += u64::from(reading.range.meaning() != Meaning::Echo);
            }
            Ok(Arrival::Held) => self.reports.summary.skipped.held += 1,
            Ok(_) => self.reports.summary.skipped.min_step += 1,
            Err(rejected) => {
                let reason = match rejected {
                    Rejected::UnknownSensor => Reason::UnknownSensor,
                    Rejected::TimeBackwards => Reason::TimeBackwards,
                    _ => Reason::BadPose,
                };
                self.drop_value(
                    row,
                    reason,
                    format!("sensor number {} at t {}: {rejected}", reading.sensor, stamp::text(row.t)),
                );
            }
        }
    }

    fn drop_value(&mut self, row: &Row, reason: Reason, value: String) {
        self.reports.summary.dropped.add(Problem { reason, place: row.place.clone(), value });
    }
}

/// A record's readings as the fuser takes them, with the robot at `pose`; a sensor beyond `sensors` gives none.
pub fn readings<'a>(row: &'a Row, pose: Pose, sensors: &'a [SensorModel]) -> impl Iterator<Item = Reading<f64>> + 'a {
    let robot = Isometry2::from_parts(
        Vector2::new(pose.x, pose.y).into(),
        UnitComplex::from_cos_sin_unchecked(libm::cos(pose.yaw), libm::sin(pose.yaw)),
    );
    row.readings.iter().filter_map(move |&(sensor, range)| {
        let model = sensors.get(usize::from(sensor))?;
        Some(Reading {
            t: row.t,
            sensor,
            range: model.limits.classify(range),
            pose: robot * model.mount,
            robot: Point2::from(robot.translation.vector),
            beam: model.beam,
            range_resolution: model.range_resolution,
        })
    })
}

/// The problem of a record for whose time there is no pose.
pub(crate) fn no_pose(row: &Row) -> Problem {
    Problem { reason: Reason::NoPose, place: row.place.clone(), value: format!("t {}", stamp::text(row.t)) }
}

/// The fuser's sink: counts, and hands on. It can't fail, so an error waits until somebody asks.
struct Reports<'a> {
    sink: &'a mut dyn EchoSink,
    summary: &'a mut Summary,
    wants_crossings: bool,
    crossings: Vec<ArcCrossing<f64>>,
    failed: Option<Error>,
}

impl Reports<'_> {
    fn check(&mut self) -> Result<()> {
        self.failed.take().map_or(Ok(()), Err)
    }

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
            self.failed = self.sink.crossings(&self.crossings).err();
        }
        self.crossings.clear();
    }
}

impl Sink<f64, Echo<f64>> for Reports<'_> {
    fn echo(&mut self, echo: &Echo<f64>) {
        self.hand_on_crossings();
        self.summary.echoes.add(echo.kind);
        if self.failed.is_some() {
            return;
        }
        match self.sink.echo(echo) {
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

//! From a log to readings: source → pose → readings, in the order of the log and in bounded memory.

use atm_core::{
    Beam, DomainError, Isometry2, Limits, MinAngle, Point2, RangeResolution, Reading, UnitComplex, Vector2, resolution,
};

use std::sync::Arc;

use crate::{
    error::{Error, Problem, Reason, Result},
    log::{Next, Row, Source, View},
    rig::Rig,
    stamp,
    summary::Summary,
    track::{Clock, Pose, PoseMiss, PoseStream, Tick, Track, time_backwards},
};

/// The robot's path, from whatever file.
pub type AnyTrack = Track<Box<dyn PoseStream>>;

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

impl SensorModel {
    /// The mount, turned by an angle in radians.
    pub fn mount_at(&self, angle: f64) -> Isometry2<f64> {
        if angle == 0.0 {
            return self.mount;
        }
        self.mount * UnitComplex::from_cos_sin_unchecked(libm::cos(angle), libm::sin(angle))
    }
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

/// Takes the readings of a log in, one after another. What it counts goes into the summary of the run.
pub trait Consumer {
    /// More sensors are known: `ids` are all of them, in order of their indices.
    fn sensors(&mut self, _ids: &[Arc<str>]) -> Result<()> {
        Ok(())
    }

    /// A usable record, before its readings: its times, and where the robot was.
    fn record(&mut self, _row: &Row, _pose: Pose) -> Result<()> {
        Ok(())
    }

    /// A reading of that record.
    fn reading(&mut self, row: &Row, reading: &Reading<f64>, summary: &mut Summary) -> Result<()>;

    /// The clock was set back: what comes next has nothing to do with what came before.
    fn clock_reset(&mut self, _summary: &mut Summary) -> Result<()> {
        Ok(())
    }

    /// The log has nothing more to give for now.
    fn wait(&mut self) -> Result<()> {
        Ok(())
    }
}

/// Records between two reports of progress.
const PROGRESS_EVERY: u64 = 4096;

/// Reads the whole of `source` into `consumer`; `progress` is told the bytes read, now and then.
///
/// `strict`: the first unusable record ends the run. The summary counts what came before an error, too.
///
/// # Errors
/// The log can't be read on, or the consumer's.
pub fn read(
    source: &mut dyn Source,
    track: Option<&mut AnyTrack>,
    sensors: &[SensorModel],
    strict: bool,
    consumer: &mut impl Consumer,
    summary: &mut Summary,
    progress: &mut dyn FnMut(u64),
) -> Result<()> {
    let mut intake = Intake { track, sensors, clock: Clock::default(), epoch: 0, robot: None, consumer, summary };
    let mut row = Row::default();
    let (mut records, mut known) = (0u64, 0);
    loop {
        if source.drained() {
            intake.consumer.wait()?;
        }
        let next = source.next_row(&mut row, &mut |problem| intake.summary.drop(problem))?;
        if source.ids().len() > known {
            known = source.ids().len();
            intake.consumer.sensors(source.ids())?;
        }
        match next {
            Next::Record => intake.take(&row)?,
            Next::Unusable => {}
            Next::End => return Ok(()),
        }
        if strict && let Some((_, _, problem)) = intake.summary.dropped.iter().next() {
            return Err(Error::Strict { problem: problem.clone() });
        }
        records += 1;
        if records.is_multiple_of(PROGRESS_EVERY) {
            progress(source.position());
        }
    }
}

struct Intake<'a, C> {
    track: Option<&'a mut AnyTrack>,
    sensors: &'a [SensorModel],
    clock: Clock,
    /// Clock resets so far: poses and readings of the same epoch belong together.
    epoch: u32,
    /// The last pose, and what it is as a motion: the rows of a sweep have the same.
    robot: Option<(Pose, Isometry2<f64>)>,
    consumer: &'a mut C,
    summary: &'a mut Summary,
}

impl<C: Consumer> Intake<'_, C> {
    /// One record: its time, its pose, its readings.
    fn take(&mut self, row: &Row) -> Result<()> {
        if !self.clock.is_forward(row.t) {
            return self.turn_back(row);
        }
        let Some(pose) = self.pose(row)? else {
            let miss = self.track.as_deref().map(Track::miss);
            self.summary.dropped.add(no_pose(row, miss));
            return Ok(());
        };
        self.summary.skipped.empty += row.empty;
        // A record without a usable reading does not set the clock.
        if !row.readings.is_empty() {
            self.clock.admit(row.t);
        }
        self.consumer.record(row, pose)?;
        let robot = match self.robot {
            Some((last, robot)) if last == pose => robot,
            _ => self.robot.insert((pose, isometry(pose))).1,
        };
        for reading in readings_at(row, robot, self.sensors) {
            self.consumer.reading(row, &reading, self.summary)?;
        }
        Ok(())
    }

    /// A record that is earlier than the latest usable one.
    fn turn_back(&mut self, row: &Row) -> Result<()> {
        let problem = time_backwards(row.t, self.clock.now(), row.place.clone());
        self.summary.dropped.add(problem);
        if self.clock.admit(row.t) == Tick::Reset {
            self.summary.clock_resets += 1;
            self.epoch = self.epoch.saturating_add(1);
            self.consumer.clock_reset(self.summary)?;
        }
        Ok(())
    }

    fn pose(&mut self, row: &Row) -> Result<Option<Pose>> {
        let Some(track) = self.track.as_deref_mut() else {
            return Ok(row.pose);
        };
        let summary = &mut *self.summary;
        track.pose_at(self.epoch, row.t, &mut |problem| summary.drop(problem))
    }
}

/// A record's readings as the fuser takes them, with the robot at `pose`; a sensor beyond `sensors` gives none where the
/// record does not say itself what it saw.
pub fn readings<'a>(row: &'a Row, pose: Pose, sensors: &'a [SensorModel]) -> impl Iterator<Item = Reading<f64>> + 'a {
    readings_at(row, isometry(pose), sensors)
}

/// From the robot's frame to the fixed one.
pub(crate) fn isometry(pose: Pose) -> Isometry2<f64> {
    Isometry2::from_parts(
        Vector2::new(pose.x, pose.y).into(),
        UnitComplex::from_cos_sin_unchecked(libm::cos(pose.yaw), libm::sin(pose.yaw)),
    )
}

fn readings_at<'a>(
    row: &'a Row,
    robot: Isometry2<f64>,
    sensors: &'a [SensorModel],
) -> impl Iterator<Item = Reading<f64>> + 'a {
    let modelled = move |sensor: u16| {
        let model = sensors.get(usize::from(sensor))?;
        Some(View {
            pose: robot * model.mount_at(row.angle),
            limits: model.limits,
            beam: model.beam,
            range_resolution: model.range_resolution,
        })
    };
    row.readings.iter().enumerate().filter_map(move |(index, &(sensor, range))| {
        let view = row.views.get(index).copied().or_else(|| modelled(sensor))?;
        Some(Reading {
            t: row.t,
            sensor,
            range: view.limits.classify(range),
            pose: view.pose,
            robot: Point2::from(robot.translation.vector),
            beam: view.beam,
            range_resolution: view.range_resolution,
        })
    })
}

/// The problem of a record for whose time there is no pose, with what is known of the poses around it.
pub(crate) fn no_pose(row: &Row, miss: Option<PoseMiss>) -> Problem {
    let impossible = miss.is_some_and(PoseMiss::is_impossible);
    let reason = if impossible { Reason::ImpossibleMotion } else { Reason::NoPose };
    let words = miss.map(|miss| format!(": of the poses {miss}")).unwrap_or_default();
    Problem { reason, place: row.place.clone(), value: format!("t {}{words}", stamp::text(row.t)) }
}

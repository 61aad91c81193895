//! What is gathered while a log is read.

use atm_core::{Arc, Limits, Meaning, MinAngle};

use super::{crossings::CrossingEvidence, poses::PoseEvidence, sensor::SensorEvidence};
use crate::{
    intake::{SensorModel, isometry},
    log::Row,
    track::Pose,
};

/// Sensors whose ranges are counted by size, at most: 7 kB each.
const HISTOGRAMS: usize = 1024;
/// A pose from which arcs are kept to be crossed has moved by this share of a sensor's range since the last one.
const APART: f64 = 0.02;

/// What a log shows of itself, in memory that grows with its sensors alone.
#[derive(Debug, Clone, Default)]
pub struct Evidence {
    /// By the sensor's index.
    pub sensors: Vec<SensorEvidence>,
    /// The robot's path.
    pub poses: PoseEvidence,
    /// How arcs cross.
    pub crossings: CrossingEvidence,
    /// Time of the first record and of the last, in nanoseconds.
    pub span: Option<(i64, i64)>,
    /// Instants, and times a reading was of another sensor than the one before.
    pub(super) instants: u64,
    /// Clock resets at which the sensor changed, too.
    pub(super) resets_by_sensor: u64,
    last_sensor: Option<u16>,
    last_reset: bool,
    /// Where arcs were kept last.
    kept_at: Option<Pose>,
    /// The largest maximum range so far, in metres.
    reach: Option<f64>,
    min_angle: Option<MinAngle<f64>>,
}

impl Evidence {
    /// Evidence of nothing yet. `min_angle`: from where on crossings count; `None` where arcs are not crossed.
    pub fn new(min_angle: Option<MinAngle<f64>>) -> Self {
        Self { min_angle, ..Self::default() }
    }

    /// Takes a usable record in. `pose`: where the robot was, where that is known; `models` describe the sensors of which the
    /// record does not say itself what they saw.
    pub fn record(&mut self, row: &Row, pose: Option<Pose>, models: &[SensorModel]) {
        let t = row.t;
        self.instants += u64::from(self.span.is_none_or(|(_, last)| last != t));
        self.span = Some((self.span.map_or(t, |(first, _)| first), t));
        if let Some(pose) = pose {
            self.poses.add(pose, t);
        }
        for number in 0..row.readings.len() {
            self.reading(row, number, pose, models);
        }
        if let (Some(_), Some(pose)) = (self.min_angle, pose) {
            self.keep_arcs(row, pose, models);
        }
    }

    /// Takes one of a record's readings in.
    #[inline]
    fn reading(&mut self, row: &Row, number: usize, pose: Option<Pose>, models: &[SensorModel]) {
        let Some(&(sensor, range)) = row.readings.get(number) else { return };
        let index = usize::from(sensor);
        if index >= self.sensors.len() {
            self.sensors.resize_with(index + 1, SensorEvidence::default);
        }
        let Some(seen) = self.sensors.get_mut(index) else { return };
        let (view, model) = (row.views.get(number), models.get(index));
        let sight = view.map(|view| (view.limits, view.beam)).or(model.map(|model| (model.limits, model.beam)));
        seen.sight = sight.or(seen.sight);
        let limits = sight.map_or(Limits::NONE, |(limits, _)| limits);
        if limits.max().is_finite() && self.reach.is_none_or(|reach| limits.max() > reach) {
            self.reach = Some(limits.max());
        }
        seen.add(range, &limits, row.t, self.poses.changes, index < HISTOGRAMS);
        if self.last_reset {
            self.resets_by_sensor += u64::from(self.last_sensor.is_some_and(|last| last != sensor));
            self.last_reset = false;
        }
        self.last_sensor = Some(sensor);
        if let (Some(min_angle), Some(pose)) = (self.min_angle, pose)
            && limits.classify(range).meaning() == Meaning::Echo
            && self.crossings.wants()
            && let Some(arc) = arc(row, number, pose, models)
        {
            self.crossings.sample(&arc, &min_angle);
        }
    }

    /// Keeps the record's arcs to be crossed, where the robot has moved since the last that were.
    fn keep_arcs(&mut self, row: &Row, pose: Pose, models: &[SensorModel]) {
        let reach = self.reach.unwrap_or(1.0);
        let has_moved = self.kept_at.is_none_or(|last| {
            let (dx, dy) = (pose.x - last.x, pose.y - last.y);
            // The record of the same pose: another sensor of the same sweep.
            last == pose || dx * dx + dy * dy >= (APART * reach).powi(2) || (pose.yaw - last.yaw).abs() > 0.2
        });
        if !has_moved {
            return;
        }
        self.kept_at = Some(pose);
        for number in 0..row.readings.len() {
            if let Some(arc) = arc(row, number, pose, models) {
                self.crossings.keep(arc);
            }
        }
    }

    /// The clock was set back.
    pub fn clock_reset(&mut self) {
        self.last_reset = true;
        self.poses.lift();
        self.crossings.forget();
        self.kept_at = None;
    }

    /// Readings of all sensors.
    pub fn readings(&self) -> u64 {
        self.sensors.iter().map(|sensor| sensor.readings).sum()
    }

    /// Echoes of all sensors.
    pub fn echoes(&self) -> u64 {
        self.sensors.iter().map(|sensor| sensor.echoes).sum()
    }

    /// The largest maximum range of the sensors, in metres; `None` where none has one.
    pub const fn reach(&self) -> Option<f64> {
        self.reach
    }
}

/// The arc of one of a record's readings; `None` where it has no echo, or nothing says what its sensor sees.
fn arc(row: &Row, number: usize, pose: Pose, models: &[SensorModel]) -> Option<Arc<f64>> {
    let &(sensor, range) = row.readings.get(number)?;
    if let Some(view) = row.views.get(number) {
        let radius = view.limits.classify(range).echo()?;
        return Some(Arc::new(&view.pose, radius, &view.beam));
    }
    let model = models.get(usize::from(sensor))?;
    let radius = model.limits.classify(range).echo()?;
    Some(Arc::new(&(isometry(pose) * model.mount_at(row.angle)), radius, &model.beam))
}

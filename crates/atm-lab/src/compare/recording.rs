//! A log in memory, to be read as often as there are methods.

use std::{collections::HashMap, sync::Arc};

use atm::{
    error::{Error, Problem, Result},
    intake::{AnyTrack, Consumer, SensorModel, read},
    log::{Next, Row, Source, View},
    summary::Summary,
    track::Pose,
};
use atm_core::{Limits, Meaning, Point2, Reading};

use crate::thinned::Thinned;

/// Most readings that are kept.
const MOST_READINGS: u64 = 1 << 22;

/// The usable readings of a log with their poses, apart where the clock was set back.
#[derive(Debug, Default)]
pub struct Recording {
    ids: Vec<Arc<str>>,
    sensors: Vec<SensorModel>,
    parts: Vec<Vec<Row>>,
    views: Thinned<View>,
    readings: u64,
    /// What was counted while it was read.
    pub summary: Summary,
}

impl Recording {
    /// Reads the whole of `source`; `drop_held` leaves readings out that equal their sensor's previous one.
    ///
    /// # Errors
    /// The log can't be read on, or has more than 4 million readings.
    pub fn read(
        source: &mut dyn Source,
        track: Option<&mut AnyTrack>,
        sensors: &[SensorModel],
        drop_held: bool,
        progress: &mut dyn FnMut(u64),
    ) -> Result<Self> {
        let mut recorder = Recorder { drop_held, ..Recorder::default() };
        recorder.recording.sensors = sensors.to_vec();
        recorder.recording.parts.push(Vec::new());
        let mut summary = Summary::default();
        read(source, track, sensors, false, &mut recorder, &mut summary, progress)?;
        Ok(Self { summary, ..recorder.recording })
    }

    /// The sensors' ids, in order of their indices.
    pub fn ids(&self) -> &[Arc<str>] {
        &self.ids
    }

    /// The sensors, as the rig knows them.
    pub fn sensors(&self) -> &[SensorModel] {
        &self.sensors
    }

    /// How many readings there are.
    pub const fn readings(&self) -> u64 {
        self.readings
    }

    /// Where the readings were taken from, and what could be seen from there; of very many, evenly spaced ones.
    pub const fn views(&self) -> &Thinned<View> {
        &self.views
    }

    /// The range limits of each sensor; none where neither rig nor log has them.
    pub fn limits(&self) -> Vec<Limits<f64>> {
        let mut limits: Vec<Limits<f64>> = self.sensors.iter().map(|sensor| sensor.limits).collect();
        limits.resize(self.ids.len().max(limits.len()), Limits::NONE);
        for row in self.parts.iter().flatten() {
            for (&(sensor, _), view) in row.readings.iter().zip(&row.views) {
                if let Some(limit) = limits.get_mut(usize::from(sensor)) {
                    *limit = view.limits;
                }
            }
        }
        limits
    }

    /// Where the robot was, record by record; `None` where the clock was set back.
    pub fn path(&self) -> Vec<Option<Point2<f64>>> {
        let place = |row: &Row| row.pose.map(|pose| Point2::new(pose.x, pose.y));
        self.parts.iter().flat_map(|part| part.iter().map(place).chain([None])).collect()
    }

    /// The parts of the log between which the clock was set back, each as a log of its own.
    pub fn parts(&self) -> impl Iterator<Item = Replay<'_>> {
        self.parts.iter().map(|rows| Replay::new(&self.ids, rows))
    }
}

/// A log that is in memory.
pub struct Replay<'a> {
    ids: &'a [Arc<str>],
    rows: std::slice::Iter<'a, Row>,
    position: u64,
}

impl<'a> Replay<'a> {
    /// A log of these records, whose sensors are `ids`.
    pub fn new(ids: &'a [Arc<str>], rows: &'a [Row]) -> Self {
        Self { ids, rows: rows.iter(), position: 0 }
    }
}

impl Source for Replay<'_> {
    fn next_row(&mut self, row: &mut Row, _: &mut dyn FnMut(Problem)) -> Result<Next> {
        let Some(next) = self.rows.next() else {
            return Ok(Next::End);
        };
        row.clone_from(next);
        self.position = next.place.byte;
        Ok(Next::Record)
    }

    fn drained(&self) -> bool {
        false
    }

    fn position(&self) -> u64 {
        self.position
    }

    fn has_poses(&self) -> bool {
        true
    }

    fn ids(&self) -> &[Arc<str>] {
        self.ids
    }
}

/// The consumer that records.
#[derive(Default)]
struct Recorder {
    recording: Recording,
    drop_held: bool,
    /// What each sensor said last.
    last: HashMap<u16, (Meaning, Option<f64>)>,
    /// Readings of the current record that were looked at.
    looked_at: usize,
}

impl Recorder {
    /// The reading as it stands in the record, with its view if it has its own; the record's readings come in its order.
    fn raw(&mut self, row: &Row, sensor: u16) -> Option<((u16, f64), Option<View>)> {
        let rest = row.readings.iter().enumerate().skip(self.looked_at);
        let (index, raw) = rest.into_iter().find(|(_, (of, _))| *of == sensor)?;
        self.looked_at = index + 1;
        Some((*raw, row.views.get(index).copied()))
    }
}

impl Consumer for Recorder {
    fn sensors(&mut self, ids: &[Arc<str>]) -> Result<()> {
        self.recording.ids = ids.to_vec();
        Ok(())
    }

    fn record(&mut self, row: &Row, pose: Pose) -> Result<()> {
        self.looked_at = 0;
        let kept = Row { pose: Some(pose), readings: Vec::new(), views: Vec::new(), ..row.clone() };
        if let Some(part) = self.recording.parts.last_mut() {
            part.push(kept);
        }
        Ok(())
    }

    fn reading(&mut self, row: &Row, reading: &Reading<f64>, summary: &mut Summary) -> Result<()> {
        let Some((raw, view)) = self.raw(row, reading.sensor) else {
            return Ok(());
        };
        let said = (reading.range.meaning(), reading.range.echo());
        if self.last.insert(reading.sensor, said) == Some(said) && self.drop_held {
            summary.skipped.held += 1;
            return Ok(());
        }
        if self.recording.readings >= MOST_READINGS {
            return Err(Error::Settings {
                message: format!("a log of more than {MOST_READINGS} readings can't be compared"),
            });
        }
        self.recording.readings += 1;
        summary.readings += 1;
        summary.no_echo += u64::from(said.0 != Meaning::Echo);
        let limits =
            view.map(|view| view.limits).or_else(|| Some(self.recording.sensors.get(usize::from(raw.0))?.limits));
        self.recording.views.push(View {
            pose: reading.pose,
            limits: limits.unwrap_or(Limits::NONE),
            beam: reading.beam,
            range_resolution: reading.range_resolution,
        });
        if let Some(kept) = self.recording.parts.last_mut().and_then(|part| part.last_mut()) {
            kept.readings.push(raw);
            kept.views.extend(view);
        }
        Ok(())
    }

    fn clock_reset(&mut self, _: &mut Summary) -> Result<()> {
        self.last.clear();
        self.recording.parts.push(Vec::new());
        Ok(())
    }
}

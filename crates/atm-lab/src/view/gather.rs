//! What a replay shows, gathered while a log is fused: poses, readings, crossings and echoes.
use std::{collections::HashMap, sync::Arc};

use atm::{echo::AnyEcho, error::Result, log::Row, pipeline::EchoSink, track::Pose};
use atm_core::{ArcCrossing, Isometry2, Point2, Reading, UnitComplex, Vector2};

/// Most readings that a replay holds; of more, every second of each sensor is left out, and so on.
pub const MOST_READINGS: usize = 300_000;

/// Lengths are whole numbers of this many metres, and angles of this many radians.
pub(super) const STEP: f64 = 1e-4;
pub(super) const TURN: f64 = 1e-6;
/// Azimuths are whole numbers of this part of half the beam.
pub(super) const AZIMUTHS: f64 = 32_767.0;
/// Nobody has reported the reading yet.
const UNKNOWN: u32 = u32::MAX;

/// Where the robot was.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    /// In nanoseconds.
    pub(super) t: i64,
    pub(super) pose: Pose,
}

/// Where a sensor sits on the robot, and half its beam: in steps, so that equal ones are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Mount {
    pub(super) x: i64,
    pub(super) y: i64,
    pub(super) yaw: i64,
    pub(super) half_beam: i64,
}

/// One reading of the local map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Shot {
    pub(super) pose: u32,
    pub(super) mount: u32,
    pub(super) sensor: u16,
    /// In steps; 0 is no echo.
    pub(super) range: u32,
    /// The pose at which it left the local map.
    pub(super) left: u32,
    /// Its number among its sensor's.
    nth: u64,
}

/// Two readings that cross, the later one first, with the azimuth on its arc.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Meeting {
    pub(super) on: u32,
    pub(super) with: u32,
    pub(super) azimuth: i16,
}

/// What one estimator made of a reading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Found {
    pub(super) shot: u32,
    pub(super) kind: &'static str,
    pub(super) azimuth: i16,
    pub(super) crossings: u32,
    pub(super) resolution: f64,
    pub(super) significance: f64,
}

/// Which reading is meant: how often the clock had been set back, its time and its sensor.
type Key = (u32, i64, u16);

/// Counts how often the clock was set back.
#[derive(Debug, Default)]
struct Epochs {
    epoch: u32,
    last: Option<i64>,
}

impl Epochs {
    /// Takes a record's time in. Returns whether the clock was set back before it.
    fn at(&mut self, t: i64) -> bool {
        let back = self.last.is_some_and(|last| t < last);
        self.epoch += u32::from(back);
        self.last = Some(t);
        back
    }
}

/// The drive, with the echoes of the first estimator.
#[derive(Debug)]
pub(super) struct Gathering {
    pub(super) ids: Vec<Arc<str>>,
    pub(super) places: Vec<Place>,
    /// Poses before which the clock was set back.
    pub(super) resets: Vec<u32>,
    pub(super) mounts: Vec<Mount>,
    pub(super) shots: Vec<Shot>,
    pub(super) meetings: Vec<Meeting>,
    pub(super) found: Vec<Found>,
    /// One reading of each sensor in so many is kept.
    pub(super) stride: u64,
    /// Readings, kept or not.
    pub(super) offered: u64,
    most: usize,
    now: Option<Place>,
    robot: Isometry2<f64>,
    pushed: bool,
    reset: bool,
    nth: Vec<u64>,
    known: HashMap<Mount, u32>,
    index: HashMap<Key, u32>,
    epochs: Epochs,
}

/// A length or an angle in whole steps; what no step can say becomes the nearest that can.
pub(super) fn steps(value: f64, step: f64) -> i64 {
    let most = f64::from(i32::MAX);
    (value / step).round().clamp(-most, most) as i64
}

/// An azimuth in parts of half a beam.
fn part(azimuth: f64, half_beam: f64) -> i16 {
    (azimuth / half_beam * AZIMUTHS).round().clamp(-AZIMUTHS, AZIMUTHS) as i16
}

impl Gathering {
    /// Of at most `most` readings.
    pub(super) fn new(most: usize) -> Self {
        Self {
            ids: Vec::new(),
            places: Vec::new(),
            resets: Vec::new(),
            mounts: Vec::new(),
            shots: Vec::new(),
            meetings: Vec::new(),
            found: Vec::new(),
            stride: 1,
            offered: 0,
            most: most.max(2),
            now: None,
            robot: Isometry2::identity(),
            pushed: false,
            reset: false,
            nth: Vec::new(),
            known: HashMap::new(),
            index: HashMap::new(),
            epochs: Epochs::default(),
        }
    }

    /// The index of the pose that holds now.
    fn pose_now(&mut self) -> u32 {
        if let (false, Some(now)) = (self.pushed, self.now) {
            if self.reset {
                self.resets.push(self.places.len() as u32);
                self.reset = false;
            }
            self.places.push(now);
            self.pushed = true;
        }
        self.latest()
    }

    fn latest(&self) -> u32 {
        (self.places.len().max(1) - 1) as u32
    }

    fn mount(&mut self, reading: &Reading<f64>) -> u32 {
        let mount = self.robot.inv_mul(&reading.pose);
        let at = mount.translation.vector;
        let mount = Mount {
            x: steps(at.x, STEP),
            y: steps(at.y, STEP),
            yaw: steps(libm::atan2(mount.rotation.im, mount.rotation.re), TURN),
            half_beam: steps(reading.beam.field_of_view() / 2.0, TURN),
        };
        *self.known.entry(mount).or_insert_with(|| {
            self.mounts.push(mount);
            (self.mounts.len() - 1) as u32
        })
    }

    /// The kept reading's index and half its beam in radians.
    fn shot(&self, t: i64, sensor: u16) -> Option<(u32, f64)> {
        let index = *self.index.get(&(self.epochs.epoch, t, sensor))?;
        let mount = self.mounts.get(self.shots.get(index as usize)?.mount as usize)?;
        Some((index, mount.half_beam as f64 * TURN))
    }

    fn found(&self, echo: &AnyEcho) -> Option<Found> {
        let usual = echo.usual();
        let (shot, half_beam) = self.shot(usual.t, usual.sensor)?;
        Some(Found {
            shot,
            kind: usual.kind,
            azimuth: part(usual.azimuth, half_beam),
            crossings: usual.crossings,
            resolution: usual.resolution,
            significance: usual.significance,
        })
    }

    /// Leaves every second reading of each sensor out, with what hangs on it.
    fn halve(&mut self) {
        self.stride *= 2;
        let stride = self.stride;
        let kept: Vec<bool> = self.shots.iter().map(|shot| shot.nth.is_multiple_of(stride)).collect();
        let shots = renumbered(&kept);
        let mut needed = vec![false; self.places.len()];
        for (shot, _) in self.shots.iter().zip(&kept).filter(|(_, kept)| **kept) {
            if let Some(needed) = needed.get_mut(shot.pose as usize) {
                *needed = true;
            }
        }
        let poses = renumbered(&needed);
        let new = |map: &[(u32, bool)], old: u32| map.get(old as usize).map_or(old, |(new, _)| *new);
        let stays = |old: u32| shots.get(old as usize).is_some_and(|(_, stays)| *stays);
        filter_by(&mut self.places, &needed);
        filter_by(&mut self.shots, &kept);
        for shot in &mut self.shots {
            shot.pose = new(&poses, shot.pose);
            if shot.left != UNKNOWN {
                shot.left = new(&poses, shot.left);
            }
        }
        self.resets.iter_mut().for_each(|reset| *reset = new(&poses, *reset));
        self.index.retain(|_, old| stays(*old));
        self.index.values_mut().for_each(|old| *old = new(&shots, *old));
        self.found.retain(|found| stays(found.shot));
        self.found.iter_mut().for_each(|found| found.shot = new(&shots, found.shot));
        self.meetings.retain(|meeting| stays(meeting.on) && stays(meeting.with));
        for meeting in &mut self.meetings {
            meeting.on = new(&shots, meeting.on);
            meeting.with = new(&shots, meeting.with);
        }
        self.pushed = self.places.last() == self.now.as_ref();
    }

    /// The log has ended: readings of which no report came left with the next of their sensor that had one.
    pub(super) fn finish(&mut self) {
        let last = self.latest();
        let mut left: HashMap<u16, u32> = HashMap::new();
        for shot in self.shots.iter_mut().rev() {
            let next = left.entry(shot.sensor).or_insert(last);
            if shot.left == UNKNOWN {
                shot.left = *next;
            }
            *next = shot.left;
        }
        self.epochs = Epochs::default();
    }
}

/// For each item its place among the kept ones (of others, that of the kept one before it), and whether it is kept.
fn renumbered(kept: &[bool]) -> Vec<(u32, bool)> {
    let mut count = 0_u32;
    let number = |&kept: &bool| {
        count += u32::from(kept);
        (count.saturating_sub(1), kept)
    };
    kept.iter().map(number).collect()
}

fn filter_by<T>(items: &mut Vec<T>, kept: &[bool]) {
    let mut kept = kept.iter();
    items.retain(|_| kept.next().copied().unwrap_or(false));
}

impl EchoSink for Gathering {
    fn sensors(&mut self, ids: &[Arc<str>]) -> Result<()> {
        self.ids = ids.to_vec();
        Ok(())
    }

    fn record(&mut self, row: &Row, pose: Pose) -> Result<()> {
        self.reset |= self.epochs.at(row.t);
        let now = Place { t: row.t, pose };
        // A long table repeats time and pose with every sensor.
        if self.now != Some(now) {
            (self.now, self.pushed) = (Some(now), false);
            let heading = UnitComplex::from_cos_sin_unchecked(libm::cos(pose.yaw), libm::sin(pose.yaw));
            self.robot = Isometry2::from_parts(Vector2::new(pose.x, pose.y).into(), heading);
        }
        Ok(())
    }

    fn reading(&mut self, reading: &Reading<f64>) -> Result<()> {
        self.offered += 1;
        let sensor = usize::from(reading.sensor);
        if sensor >= self.nth.len() {
            self.nth.resize(sensor + 1, 0);
        }
        let nth = self.nth.get_mut(sensor).map_or(0, |next| std::mem::replace(next, *next + 1));
        if nth.is_multiple_of(self.stride) && self.shots.len() >= self.most {
            self.halve();
        }
        // Just halved, it may be that the reading is no longer due.
        if !nth.is_multiple_of(self.stride) {
            return Ok(());
        }
        let range = reading.range.echo().map_or(0, |range| steps(range, STEP).max(1) as u32);
        let shot = Shot {
            pose: self.pose_now(),
            mount: self.mount(reading),
            sensor: reading.sensor,
            range,
            left: UNKNOWN,
            nth,
        };
        self.index.insert((self.epochs.epoch, reading.t, reading.sensor), self.shots.len() as u32);
        self.shots.push(shot);
        Ok(())
    }

    fn echo(&mut self, echo: &AnyEcho) -> Result<bool> {
        let latest = self.latest();
        if let Some(found) = self.found(echo) {
            if let Some(shot) = self.shots.get_mut(found.shot as usize) {
                shot.left = latest.max(shot.pose);
            }
            self.found.push(found);
        }
        Ok(true)
    }

    fn wants_crossings(&self) -> bool {
        true
    }

    fn crossings(&mut self, crossings: &[ArcCrossing<f64>]) -> Result<()> {
        // Each crossing is reported with either of its arcs; with the later one it is taken.
        for crossing in crossings {
            let (Some((on, half_beam)), Some((with, _))) =
                (self.shot(crossing.t, crossing.sensor), self.shot(crossing.t_other, crossing.sensor_other))
            else {
                continue;
            };
            if with < on {
                self.meetings.push(Meeting { on, with, azimuth: part(crossing.bearing.azimuth(), half_beam) });
            }
        }
        Ok(())
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}

/// Another estimator's echoes, over the same drive.
pub(super) struct Again<'a> {
    drive: &'a mut Gathering,
    pub(super) found: Vec<Found>,
}

impl<'a> Again<'a> {
    pub(super) fn new(drive: &'a mut Gathering) -> Self {
        Self { drive, found: Vec::new() }
    }
}

impl EchoSink for Again<'_> {
    fn record(&mut self, row: &Row, _: Pose) -> Result<()> {
        self.drive.epochs.at(row.t);
        Ok(())
    }

    fn echo(&mut self, echo: &AnyEcho) -> Result<bool> {
        self.found.extend(self.drive.found(echo));
        Ok(true)
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}

/// Where it lies in the fixed frame, from the replay's origin, in steps.
pub(super) fn place_of(point: Point2<f64>, origin: Point2<f64>) -> [i64; 2] {
    [steps(point.x - origin.x, STEP), steps(point.y - origin.y, STEP)]
}

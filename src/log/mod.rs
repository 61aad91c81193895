//! Logs in and out, one file a format.
pub mod ahead;
pub mod behind;
mod buffer;
pub mod cell;
pub mod columns;
pub mod content;
pub mod crossing_log;
pub mod crossing_table;
pub mod csv;
pub mod echo_log;
pub mod echo_table;
pub mod echoes;
pub mod format;
pub mod joined;
mod line;
pub mod mcap;
pub mod output;
pub(crate) mod plausible;
pub mod poses;
mod record;
pub mod sorted;
pub mod table;
mod times;
pub mod writer;

use std::{fs, io, sync::Arc};

use atm_core::{Beam, Isometry2, Limits, RangeResolution};

use crate::{
    diagnose::Diagnosis,
    error::{Error, Place, Problem, Result},
    track::Pose,
};

/// What a log, asked for one record, has to say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Next {
    /// The next record was read.
    Record,
    /// What comes next gives no record: it can't be used, and its problem was reported, or it is no reading. The log can be
    /// asked on.
    Unusable,
    /// There are no more records.
    End,
}

/// Where a reading was taken from, and what could be seen from there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// The SENSOR's pose in the fixed frame, boresight along +x.
    pub pose: Isometry2<f64>,
    /// Between which distances the reading is an echo.
    pub limits: Limits<f64>,
    /// The beam.
    pub beam: Beam<f64>,
    /// The range resolution.
    pub range_resolution: RangeResolution<f64>,
}

/// What the frames of a log are called, where it names them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frames {
    /// The frame of the poses.
    pub fixed: Arc<str>,
    /// The robot.
    pub robot: Arc<str>,
    /// The log itself has transforms that say where the robot is.
    pub has_robot: bool,
    /// The log itself has transforms that say where the sensors sit.
    pub has_mounts: bool,
}

/// One record of a log: the readings of one instant, and where the robot was. Reused from record to record.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Time of the readings in nanoseconds.
    pub t: i64,
    /// Time at which the record was logged, in nanoseconds; `t` where the log does not say.
    pub log_time: i64,
    /// Pose in the log's fixed frame; `None` where the poses aren't taken from this log.
    pub pose: Option<Pose>,
    /// By how much the sensors are turned on their mounts, in radians: those of a servo.
    pub angle: f64,
    /// Sensor index and range in metres, in the order of the log. NaN and ±Inf are readings without an echo.
    pub readings: Vec<(u16, f64)>,
    /// One for each of `readings` where the log says itself where its sensors were and what they saw; else empty, and that
    /// follows from `pose` and the sensors' models.
    pub views: Vec<View>,
    /// What its frames are called, where the log names them.
    pub frames: Option<Arc<Frames>>,
    /// Empty cells that were skipped: sensors that did not fire.
    pub empty: u64,
    /// Where the record begins.
    pub place: Place,
}

impl Default for Row {
    fn default() -> Self {
        let place = Place { file: Arc::from(""), line: 0, byte: 0 };
        Self {
            t: 0,
            log_time: 0,
            pose: None,
            angle: 0.0,
            readings: Vec::new(),
            views: Vec::new(),
            frames: None,
            empty: 0,
            place,
        }
    }
}

/// A log of readings, as a stream of [`Row`]s.
pub trait Source {
    /// Reads one record into `row`, whose earlier contents are gone whatever is returned; problems go to `problems`.
    ///
    /// Returns after every record, usable or not, so that a caller can flush its output before the log has to wait for more.
    /// A [`Next::Record`] may come with problems of single cells, and without any reading. Errors where the log can't be read on.
    fn next_row(&mut self, row: &mut Row, problems: &mut dyn FnMut(Problem)) -> Result<Next>;

    /// Whether the next record has to be waited for: nothing of what was read from the file so far holds a complete one.
    fn drained(&self) -> bool;

    /// Bytes of the file used so far.
    fn position(&self) -> u64;

    /// Whether the rows carry poses.
    fn has_poses(&self) -> bool;

    /// The ids of the sensors known so far, in order of their indices; more may become known with any record.
    fn ids(&self) -> &[Arc<str>];

    /// What the format itself finds likely to be wrong, once the log is read.
    fn diagnoses(&self) -> Vec<Diagnosis> {
        Vec::new()
    }
}

/// A file (or standard input) that was opened for reading.
pub struct Input {
    /// Its bytes.
    pub reader: Box<dyn io::Read + Send>,
    /// Its name in messages.
    pub name: Arc<str>,
    /// Its length in bytes, where that is known beforehand.
    pub length: Option<u64>,
}

impl Input {
    /// Opens the file at `path`; `-` is standard input. Errors where there is none, it may not be read, or it is a directory.
    pub fn open(path: &str) -> Result<Self> {
        if path == "-" {
            let name = Arc::from("standard input");
            return Ok(Self { reader: Box::new(io::stdin()), name, length: length_of_standard_input() });
        }
        let name: Arc<str> = Arc::from(path);
        let failed = |source| Error::Io { file: name.clone(), source };
        let file = fs::File::open(path).map_err(failed)?;
        let metadata = file.metadata().map_err(failed)?;
        if metadata.is_dir() {
            return Err(failed(io::Error::new(io::ErrorKind::IsADirectory, "is a directory, not a file")));
        }
        let length = metadata.is_file().then_some(metadata.len());
        Ok(Self { reader: Box::new(file), name, length })
    }
}

/// The length of standard input where a regular file was put there, which nobody writes to meanwhile.
#[cfg(unix)]
fn length_of_standard_input() -> Option<u64> {
    use std::os::fd::AsFd;
    let file = fs::File::from(io::stdin().as_fd().try_clone_to_owned().ok()?);
    file.metadata().ok().filter(fs::Metadata::is_file).map(|metadata| metadata.len())
}

#[cfg(not(unix))]
fn length_of_standard_input() -> Option<u64> {
    None
}

#[cfg(test)]
mod tests;

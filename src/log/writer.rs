//! Logs of readings out.
use std::{io::Write, sync::Arc};

use super::{echoes::quoted, mcap::write::RecordingWriter};
use crate::{
    error::{Error, Result},
    rig::Rig,
    stamp,
    track::Pose,
};

/// A log that is being written.
pub trait LogWriter<W> {
    /// Writes the readings of one instant: time in nanoseconds, the robot's pose in the log's fixed frame, and each sensor's
    /// index with its range in metres. +Inf is nothing in reach, −Inf something too close (REP 117).
    ///
    /// # Errors
    /// What the system says of the output.
    fn sweep(&mut self, t: i64, pose: Pose, readings: &[(u16, f64)]) -> Result<()>;

    /// Writes what has to stand at the end, and returns what the log was written to.
    ///
    /// # Errors
    /// What the system says of the output.
    fn finish(self: Box<Self>) -> Result<W>;
}

/// A recording of ROS 2, ranges in single precision.
impl<W: Write> LogWriter<W> for RecordingWriter<W> {
    fn sweep(&mut self, t: i64, pose: Pose, readings: &[(u16, f64)]) -> Result<()> {
        self.pose(t, pose)?;
        readings.iter().try_for_each(|&(sensor, range)| self.range(t, sensor, range))
    }

    fn finish(self: Box<Self>) -> Result<W> {
        (*self).finish()
    }
}

/// The columns of a log, in order.
pub const LOG_COLUMNS: &str = "t,sensor,range,x,y,yaw";

/// A log as a long CSV table; floats as the shortest decimals that read back as the same bits, each with a point.
#[derive(Debug)]
pub struct CsvLog<W> {
    out: W,
    name: Arc<str>,
    row: Vec<u8>,
    /// The sensors' ids, quoted where CSV needs it.
    ids: Vec<Vec<u8>>,
}

impl<W: Write> CsvLog<W> {
    /// A log of a rig's sensors, its header written; `name` is what errors call the output.
    ///
    /// # Errors
    /// What the system says of the output.
    pub fn create(out: W, name: Arc<str>, rig: &Rig) -> Result<Self> {
        let ids = rig.ids().iter().map(|id| quoted(id)).collect();
        let mut log = Self { out, name, row: Vec::with_capacity(128), ids };
        log.row.extend_from_slice(LOG_COLUMNS.as_bytes());
        log.end()?;
        Ok(log)
    }

    /// Ends the row, and hands it on.
    fn end(&mut self) -> Result<()> {
        self.row.push(b'\n');
        let written = self.out.write_all(&self.row);
        self.row.clear();
        written.map_err(|source| Error::Io { file: Arc::clone(&self.name), source })
    }
}

impl<W: Write> LogWriter<W> for CsvLog<W> {
    fn sweep(&mut self, t: i64, pose: Pose, readings: &[(u16, f64)]) -> Result<()> {
        for &(sensor, range) in readings {
            stamp::write_decimal(t, &mut self.row);
            self.row.push(b',');
            self.row.extend_from_slice(self.ids.get(usize::from(sensor)).map_or(&[][..], |id| id));
            // A vector takes whatever is written.
            let _ = write!(self.row, ",{range:?},{:?},{:?},{:?}", pose.x, pose.y, pose.yaw);
            self.end()?;
        }
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<W> {
        Ok(self.out)
    }
}

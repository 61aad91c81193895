//! Logs of readings out.
use std::{
    io::{self, Write},
    sync::Arc,
};

use super::echoes::quoted;
use crate::{rig::Rig, stamp, track::Pose};

/// A log that is being written.
pub trait LogWriter {
    /// Writes the readings of one instant: time in nanoseconds, the robot's pose in the log's fixed frame, and each sensor's
    /// index with its range in metres. +Inf is nothing in reach, −Inf something too close (REP 117).
    ///
    /// # Errors
    /// What the system says of the output.
    fn sweep(&mut self, t: i64, pose: Pose, readings: &[(u16, f64)]) -> io::Result<()>;

    /// Writes what has to stand at the end. Nothing may be written after it.
    ///
    /// # Errors
    /// What the system says of the output.
    fn finish(&mut self) -> io::Result<()>;
}

/// The columns of a log, in order.
pub const LOG_COLUMNS: &str = "t,sensor,range,x,y,yaw";

/// A log as a long CSV table; floats as the shortest decimals that read back as the same bits.
#[derive(Debug)]
pub struct CsvLog<W> {
    out: W,
    row: Vec<u8>,
    /// The sensors' ids, quoted where CSV needs it.
    ids: Vec<Vec<u8>>,
}

impl<W: Write> CsvLog<W> {
    /// A log of a rig's sensors, its header written.
    ///
    /// # Errors
    /// What the system says of the output.
    pub fn new(mut out: W, rig: &Rig) -> io::Result<Self> {
        writeln!(out, "{LOG_COLUMNS}")?;
        Ok(Self { out, row: Vec::with_capacity(128), ids: rig.ids().iter().map(|id: &Arc<str>| quoted(id)).collect() })
    }

    /// What the log was written to.
    pub fn into_inner(self) -> W {
        self.out
    }

    /// What the log is written to.
    pub const fn get_ref(&self) -> &W {
        &self.out
    }
}

impl<W: Write> LogWriter for CsvLog<W> {
    fn sweep(&mut self, t: i64, pose: Pose, readings: &[(u16, f64)]) -> io::Result<()> {
        for &(sensor, range) in readings {
            self.row.clear();
            stamp::write(t, &mut self.row);
            self.row.push(b',');
            self.row.extend_from_slice(self.ids.get(usize::from(sensor)).map_or(&[][..], |id| id));
            writeln!(self.row, ",{range},{},{},{}", pose.x, pose.y, pose.yaw)?;
            self.out.write_all(&self.row)?;
        }
        Ok(())
    }

    fn finish(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

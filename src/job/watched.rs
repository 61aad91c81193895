//! A log that somebody watches.

use std::sync::Arc;

use super::Progress;
use crate::{
    diagnose::Diagnosis,
    error::{Error, Problem, Result},
    log::{Next, Row, Source},
};

/// Records and readings between two reports.
const BATCH: u32 = 256;

/// A log that tells how far it was read, and can be stopped.
pub struct Watched<'a, 'p> {
    log: &'a mut dyn Source,
    length: Option<u64>,
    progress: &'a mut Progress<'p>,
    /// Records and readings since the last report, and the bytes at it.
    unwatched: u32,
    told: u64,
}

/// Bytes between two reports.
const STRETCH: u64 = 1 << 20;

impl<'a, 'p> Watched<'a, 'p> {
    /// The log, of a length in bytes where that is known, watched by `progress`.
    pub fn new(log: &'a mut dyn Source, length: Option<u64>, progress: &'a mut Progress<'p>) -> Self {
        Self { log, length, progress, unwatched: 0, told: 0 }
    }

    /// Reports that all was read.
    ///
    /// # Errors
    /// [`Error::Interrupted`] where the run is to end.
    pub fn finish(&mut self) -> Result<()> {
        self.tell()
    }

    fn tell(&mut self) -> Result<()> {
        let position = self.log.position();
        (self.unwatched, self.told) = (0, position);
        if (self.progress)(position, self.length) {
            return Ok(());
        }
        Err(Error::Interrupted)
    }
}

impl Source for Watched<'_, '_> {
    fn next_row(&mut self, row: &mut Row, problems: &mut dyn FnMut(Problem)) -> Result<Next> {
        self.unwatched += 1;
        if self.unwatched >= BATCH || self.log.position() >= self.told + STRETCH {
            self.tell()?;
        }
        let next = self.log.next_row(row, problems);
        // A record may take as long as it has readings.
        self.unwatched = self.unwatched.saturating_add(u32::try_from(row.readings.len()).unwrap_or(u32::MAX));
        next
    }

    fn drained(&self) -> bool {
        self.log.drained()
    }

    fn position(&self) -> u64 {
        self.log.position()
    }

    fn has_poses(&self) -> bool {
        self.log.has_poses()
    }

    fn ids(&self) -> &[Arc<str>] {
        self.log.ids()
    }

    fn diagnoses(&self) -> Vec<Diagnosis> {
        self.log.diagnoses()
    }
}

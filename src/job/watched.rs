//! A log that somebody watches.

use std::sync::Arc;

use super::Progress;
use crate::{
    error::{Error, Problem, Result},
    log::{Next, Row, Source},
};

/// Records between two reports.
const BATCH: u32 = 256;

/// A log that tells how far it was read, and can be stopped.
pub(super) struct Watched<'a, 'p> {
    log: &'a mut dyn Source,
    length: Option<u64>,
    progress: &'a mut Progress<'p>,
    /// Records and bytes at the last report.
    unwatched: u32,
    told: u64,
}

/// Bytes between two reports.
const STRETCH: u64 = 1 << 20;

impl<'a, 'p> Watched<'a, 'p> {
    pub(super) fn new(log: &'a mut dyn Source, length: Option<u64>, progress: &'a mut Progress<'p>) -> Self {
        Self { log, length, progress, unwatched: 0, told: 0 }
    }

    /// Reports that all was read.
    pub(super) fn finish(&mut self) -> Result<()> {
        self.tell()
    }

    fn tell(&mut self) -> Result<()> {
        let position = self.log.position();
        (self.unwatched, self.told) = (0, position);
        if (self.progress)(position, self.length) {
            return Ok(());
        }
        Err(Error::Settings { message: "interrupted".into() })
    }
}

impl Source for Watched<'_, '_> {
    fn next_row(&mut self, row: &mut Row, problems: &mut dyn FnMut(Problem)) -> Result<Next> {
        self.unwatched += 1;
        if self.unwatched >= BATCH || self.log.position() >= self.told + STRETCH {
            self.tell()?;
        }
        self.log.next_row(row, problems)
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
}

//! A log read ahead on a thread of its own, a bounded number of records before whoever takes them.

use std::{
    io,
    panic::resume_unwind,
    sync::{
        Arc,
        mpsc::{Receiver, Sender, SyncSender, channel, sync_channel},
    },
    thread::{self, JoinHandle},
};

use super::{Next, Row, Source};
use crate::{
    diagnose::Diagnosis,
    error::{Error, Problem, Result},
};

/// Records that are handed over together, at most.
const RECORDS: usize = 256;
/// Readings and problems in them after which no further record is added.
const WEIGHT: usize = 4096;
/// Batches that may wait between the threads.
const WAITING: usize = 2;

/// One record as the source gave it.
struct Entry {
    row: Row,
    problems: Vec<Problem>,
    next: Next,
    /// Sensors known after it.
    known: usize,
    position: u64,
}

/// Records in the order of the log. Reused, with all the memory they hold.
#[derive(Default)]
struct Batch {
    entries: Vec<Entry>,
    /// How many of the entries are filled.
    filled: usize,
    /// All sensors' ids, where more have become known since the last batch.
    ids: Option<Vec<Arc<str>>>,
    /// After the last entry the log had nothing more to give.
    drained: bool,
    /// Why there are no more entries.
    failed: Option<Error>,
    /// With the last one: what the source found out.
    found: Vec<Diagnosis>,
}

/// A source that reads ahead of its caller: the same records, problems and errors in the same order.
///
/// Dropped before its end, it leaves its thread behind until that has read a batch more: nobody waits for a live log.
pub struct Ahead {
    full: Receiver<Batch>,
    empty: Sender<Batch>,
    worker: Option<JoinHandle<()>>,
    batch: Batch,
    /// The next entry of the batch.
    at: usize,
    ids: Vec<Arc<str>>,
    known: usize,
    position: u64,
    has_poses: bool,
    /// What the source found out, once it has ended.
    found: Vec<Diagnosis>,
    ended: bool,
}

impl Ahead {
    /// Reads `source` ahead. `live`: somebody may wait for what its records give while its next one is yet to come, so none
    /// is held back; where that is known to be false, as for a file, [`Source::drained`] is never true.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn new(source: impl Source + Send + 'static, live: bool) -> Result<Self> {
        let (full_sender, full) = sync_channel(WAITING);
        let (empty, empty_receiver) = channel();
        let (ids, position, has_poses) = (source.ids().to_vec(), source.position(), source.has_poses());
        let (known, drained) = (ids.len(), live && source.drained());
        let worker = thread::Builder::new()
            .name("reading".into())
            .spawn(move || read(source, live, &full_sender, &empty_receiver))
            .map_err(no_thread)?;
        let batch = Batch { drained, ..Batch::default() };
        let worker = Some(worker);
        Ok(Self { full, empty, worker, batch, at: 0, ids, known, position, has_poses, found: Vec::new(), ended: false })
    }

    /// Waits for the next batch; the one that is used up goes back.
    fn turn_over(&mut self) {
        match self.full.recv() {
            Ok(batch) => {
                // Where the thread has ended already, nobody needs it.
                let _ = self.empty.send(std::mem::replace(&mut self.batch, batch));
                self.at = 0;
                if let Some(ids) = self.batch.ids.take() {
                    self.ids = ids;
                }
                self.found.append(&mut self.batch.found);
            }
            // The thread sends the log's end, or an error, before it ends: it must have panicked.
            Err(_) => match self.worker.take().map(JoinHandle::join) {
                Some(Err(panic)) => resume_unwind(panic),
                _ => self.ended = true,
            },
        }
    }
}

/// The error of a thread that can't be had.
pub(super) fn no_thread(source: io::Error) -> Error {
    Error::Io { file: Arc::from("a thread"), source }
}

/// Reads the source to its end, as long as somebody takes the batches.
fn read(mut source: impl Source, live: bool, full: &SyncSender<Batch>, empty: &Receiver<Batch>) {
    let mut told = source.ids().len();
    loop {
        let mut batch = empty.try_recv().unwrap_or_default();
        let more = batch.fill(&mut source, live);
        if !more {
            batch.found = source.diagnoses();
        }
        if source.ids().len() > told {
            told = source.ids().len();
            batch.ids = Some(source.ids().to_vec());
        }
        if full.send(batch).is_err() || !more {
            return;
        }
    }
}

impl Batch {
    /// Reads records until there are enough, or the next one has to be waited for; `false` where there are no more.
    fn fill(&mut self, source: &mut impl Source, live: bool) -> bool {
        (self.filled, self.drained, self.failed) = (0, false, None);
        let mut weight = 0;
        while self.filled < RECORDS && weight < WEIGHT {
            let entry = self.blank();
            match source.next_row(&mut entry.row, &mut |problem| entry.problems.push(problem)) {
                Ok(next) => entry.next = next,
                Err(error) => {
                    self.failed = Some(error);
                    return false;
                }
            }
            (entry.known, entry.position) = (source.ids().len(), source.position());
            weight += entry.row.readings.len() + entry.problems.len();
            let ended = entry.next == Next::End;
            if ended {
                return false;
            }
            self.drained = live && source.drained();
            if self.drained {
                break;
            }
        }
        true
    }

    /// The next entry, emptied.
    fn blank(&mut self) -> &mut Entry {
        if self.filled == self.entries.len() {
            let (row, problems) = (Row::default(), Vec::new());
            self.entries.push(Entry { row, problems, next: Next::End, known: 0, position: 0 });
        }
        self.filled += 1;
        let entry = &mut self.entries[self.filled - 1];
        entry.problems.clear();
        entry
    }
}

impl Source for Ahead {
    fn next_row(&mut self, row: &mut Row, problems: &mut dyn FnMut(Problem)) -> Result<Next> {
        if self.at == self.batch.filled && !self.ended {
            self.turn_over();
        }
        let last = self.at + 1 == self.batch.filled;
        let Some(entry) = self.batch.entries.get_mut(self.at).filter(|_| self.at < self.batch.filled) else {
            return Ok(Next::End);
        };
        self.at += 1;
        entry.problems.drain(..).for_each(&mut *problems);
        if last && let Some(error) = self.batch.failed.take() {
            self.ended = true;
            return Err(error);
        }
        std::mem::swap(row, &mut entry.row);
        (self.known, self.position) = (entry.known, entry.position);
        self.ended |= entry.next == Next::End;
        Ok(entry.next)
    }

    fn drained(&self) -> bool {
        self.at == self.batch.filled && self.batch.drained
    }

    fn position(&self) -> u64 {
        self.position
    }

    fn has_poses(&self) -> bool {
        self.has_poses
    }

    fn ids(&self) -> &[Arc<str>] {
        self.ids.get(..self.known).unwrap_or(&self.ids)
    }

    fn diagnoses(&self) -> Vec<Diagnosis> {
        self.found.clone()
    }
}

#[cfg(test)]
mod tests;

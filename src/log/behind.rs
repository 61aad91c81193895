//! A table that is formatted and written on a thread of its own, a bounded number of rows behind whoever makes them.

use std::{
    io::{self, Write},
    mem,
    panic::resume_unwind,
    sync::{
        Arc,
        mpsc::{Receiver, Sender, SyncSender, channel, sync_channel},
    },
    thread::{self, JoinHandle},
};

use super::{
    ahead::no_thread,
    echoes::{Line, TableWriter},
};
use crate::error::Result;

/// Rows that are handed over together.
const ROWS: usize = 512;
/// Batches that may wait between the threads.
const WAITING: usize = 2;

/// What the thread is told.
enum Order<R> {
    Write(Vec<R>),
    /// More sensors are known: these are all of them.
    Ids(Vec<Arc<str>>),
    /// Hand everything on, and say so.
    Flush(SyncSender<()>),
}

/// Writes the rows of a table on another thread: the same bytes in the same order. What goes wrong there is said at one of the
/// next calls.
pub struct Behind<R, W> {
    rows: Vec<R>,
    orders: Option<SyncSender<Order<R>>>,
    spare: Receiver<Vec<R>>,
    worker: Option<Worker<W>>,
    /// The table, when its thread has ended.
    table: Option<TableWriter<W>>,
    /// What went wrong.
    failed: Option<(io::ErrorKind, Option<i32>)>,
}

type Worker<W> = JoinHandle<(TableWriter<W>, io::Result<()>)>;

impl<R: Line + Send + 'static, W: Write + Send + 'static> Behind<R, W> {
    /// Takes over a table.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn new(table: TableWriter<W>) -> Result<Self> {
        let (orders, taken) = sync_channel(WAITING);
        let (done, spare) = channel();
        let worker = thread::Builder::new()
            .name("writing".into())
            .spawn(move || write(table, &taken, &done))
            .map_err(no_thread)?;
        let (orders, worker) = (Some(orders), Some(worker));
        Ok(Self { rows: Vec::with_capacity(ROWS), orders, spare, worker, table: None, failed: None })
    }

    /// Writes one row, later.
    #[inline]
    pub fn push(&mut self, row: R) -> io::Result<()> {
        self.rows.push(row);
        if self.rows.len() < ROWS { Ok(()) } else { self.hand_over() }
    }

    /// More sensors are known, from the next row on: `ids` are all of them.
    pub fn set_ids(&mut self, ids: &[Arc<str>]) -> io::Result<()> {
        self.hand_over()?;
        self.order(Order::Ids(ids.to_vec()))
    }

    /// Hands everything written so far on, and waits until that is done.
    pub fn flush(&mut self) -> io::Result<()> {
        self.hand_over()?;
        let (done, wait) = sync_channel(1);
        self.order(Order::Flush(done))?;
        wait.recv().or_else(|_| self.end())
    }

    /// Ends the thread; the table, for what is still to be done with it, `None` where its thread has panicked.
    pub fn into_table(mut self) -> io::Result<Option<TableWriter<W>>> {
        self.hand_over()?;
        self.end()?;
        Ok(self.table.take())
    }

    fn hand_over(&mut self) -> io::Result<()> {
        if self.rows.is_empty() {
            return Ok(());
        }
        let spare = self.spare.try_recv().unwrap_or_else(|_| Vec::with_capacity(ROWS));
        let rows = mem::replace(&mut self.rows, spare);
        self.order(Order::Write(rows))
    }

    fn order(&mut self, order: Order<R>) -> io::Result<()> {
        match self.orders.as_ref().map(|orders| orders.send(order)) {
            Some(Ok(())) => Ok(()),
            _ => self.end(),
        }
    }

    /// Waits for the thread's end, and says what went wrong there; after that, says it again.
    fn end(&mut self) -> io::Result<()> {
        self.orders = None;
        match self.worker.take().map(JoinHandle::join) {
            Some(Ok((table, result))) => {
                self.table = Some(table);
                self.failed = result.as_ref().err().map(|error| (error.kind(), error.raw_os_error()));
                result
            }
            Some(Err(panic)) => resume_unwind(panic),
            None => match self.failed {
                Some((_, Some(code))) => Err(io::Error::from_raw_os_error(code)),
                Some((kind, None)) => Err(kind.into()),
                None => Ok(()),
            },
        }
    }
}

/// Does what it is told until nobody tells it anything any more, or something goes wrong.
fn write<R: Line, W: Write>(
    mut table: TableWriter<W>,
    orders: &Receiver<Order<R>>,
    done: &Sender<Vec<R>>,
) -> (TableWriter<W>, io::Result<()>) {
    let result = orders.iter().try_for_each(|order| match order {
        Order::Write(mut rows) => {
            rows.iter().try_for_each(|row| row.write(&mut table))?;
            rows.clear();
            // Where nobody makes rows any more, nobody needs it.
            let _ = done.send(rows);
            Ok(())
        }
        Order::Ids(ids) => {
            table.set_ids(ids.iter().map(|id| &**id));
            Ok(())
        }
        Order::Flush(said) => {
            table.flush()?;
            let _ = said.send(());
            Ok(())
        }
    });
    (table, result)
}

#[cfg(test)]
mod tests;

//! Chunks that are unpacked ahead of whoever takes them, on threads of their own.
//!
//! A scout finds the chunks that are not passed over, in the order of the file; whichever thread is free sends it on to the
//! next one, says which that is, and unpacks it whole. What can't be unpacked in one go, or is not exactly what its head says,
//! is not handed over: the reader unpacks it itself, and says what is wrong with it.

use std::{
    cmp::Ordering,
    fs::File,
    io,
    path::{Path, PathBuf},
    sync::{
        Arc, Mutex,
        mpsc::{Receiver, Sender, SyncSender, channel, sync_channel},
    },
    thread,
};

use super::{
    body::Compression,
    chunk_head::{ChunkHead, holds_nothing},
    op,
    records::{HEAD, framed},
    unpacker::Unpacker,
    window::{Recording, Window},
};
use crate::log::output::is_same;

/// Threads that unpack.
const THREADS: usize = 2;
/// Chunks that may wait between the threads, unpacked or not yet.
const WAITING: usize = 3;
/// Largest chunk that is unpacked in one go, in bytes before and after.
const LARGEST: u64 = 8 << 20;

/// Bytes that the scout reads at a time: heads and indexes, and as little as can be of what is between.
const GLIMPSE: usize = 4096;

/// A chunk, and where what is in it comes from: nothing comes where it can't be unpacked here.
type Order = (ChunkHead, Receiver<Vec<u8>>);

/// The chunks of a recording, unpacked ahead where that can be done.
pub(super) enum Ahead {
    /// That can't be done.
    Never,
    /// The file has this path, and no chunk of it was asked for.
    NotYet(PathBuf),
    Begun(Unpacking),
}

impl Ahead {
    /// Of the file at `path`, where the machine can do two things at once.
    pub(super) fn of(path: &str) -> Self {
        let cores = thread::available_parallelism().map_or(1, usize::from);
        if cores > 1 { Self::NotYet(path.into()) } else { Self::Never }
    }

    /// What is in a chunk, whose `head` was found in `recording`. From the first one that is asked for all are unpacked except
    /// those that hold messages of `unwanted` channels only. `None` where it was not, or not from this chunk's head.
    pub(super) fn take(
        &mut self,
        head: &ChunkHead,
        recording: &Recording,
        unwanted: impl FnOnce() -> Vec<u16>,
    ) -> Option<Vec<u8>> {
        if !fits(head) {
            return None;
        }
        if let Self::NotYet(path) = self {
            *self = match recording {
                Recording::File(file, length) => Unpacking::begin(path, (file, *length), head.byte, unwanted()),
                Recording::Stream(_) => None,
            }
            .map_or(Self::Never, Self::Begun);
        }
        match self {
            Self::Begun(unpacking) => unpacking.take(head),
            _ => None,
        }
    }

    /// The memory of a chunk that is used up.
    pub(super) fn give_back(&self, bytes: Vec<u8>) {
        if let Self::Begun(unpacking) = self {
            // Where the threads have ended, nobody needs it.
            let _ = unpacking.spare.send(bytes);
        }
    }
}

/// Threads that unpack chunks ahead. Dropped before the end, it leaves them behind until each has unpacked its chunk.
pub(super) struct Unpacking {
    orders: Receiver<Order>,
    /// One that was received too early.
    next: Option<Order>,
    spare: Sender<Vec<u8>>,
}

impl Unpacking {
    /// Begins with the record at `from`. `None` where the system gives no threads, or the path no longer leads to `file`.
    fn begin(path: &Path, (file, length): (&File, u64), from: u64, unwanted: Vec<u16>) -> Option<Self> {
        let identity = file.metadata().ok()?;
        let open = || {
            let file = File::open(path).ok()?;
            is_same(&file.metadata().ok()?, &identity).then_some(file)
        };
        let (orders_sender, orders) = sync_channel(WAITING);
        let (spare, spare_receiver) = channel();
        let mut window = Window::of_size(Recording::File(open()?, length), GLIMPSE);
        window.go_to(from).ok()?;
        let scout = Scout { window: Some(window), length, unwanted, orders: orders_sender, spare: spare_receiver };
        let scout = Arc::new(Mutex::new(scout));
        for _ in 0..THREADS {
            let (scout, unpacker) = (Arc::clone(&scout), Unpacker::new(open()?));
            thread::Builder::new().name("unpacking".into()).spawn(move || work(&scout, unpacker)).ok()?;
        }
        Some(Self { orders, next: None, spare })
    }

    fn take(&mut self, head: &ChunkHead) -> Option<Vec<u8>> {
        loop {
            let (there, bytes) = self.next.take().or_else(|| self.orders.recv().ok())?;
            match there.byte.cmp(&head.byte) {
                // It was passed over.
                Ordering::Less => {}
                Ordering::Equal => return bytes.recv().ok().filter(|_| there == *head),
                Ordering::Greater => {
                    self.next = Some((there, bytes));
                    return None;
                }
            }
        }
    }
}

/// Whether a chunk can be unpacked in one go.
fn fits(head: &ChunkHead) -> bool {
    let known = Compression::named(&head.compression).is_some();
    known && head.packed <= LARGEST && (1..=LARGEST).contains(&head.unpacked)
}

/// Goes through the file ahead of the reader.
struct Scout {
    /// `None` at the end.
    window: Option<Window<Recording>>,
    length: u64,
    /// Channels whose messages nobody wants, in the order of their numbers.
    unwanted: Vec<u16>,
    orders: SyncSender<Order>,
    spare: Receiver<Vec<u8>>,
}

impl Scout {
    /// The next chunk, memory for what is in it, and where that is to go. Waits where enough chunks are under way; `None` where
    /// there are no more, or nobody takes them.
    fn next(&mut self) -> Option<(ChunkHead, Vec<u8>, SyncSender<Vec<u8>>)> {
        let mut window = self.window.take()?;
        let head = self.find(&mut window).ok()??;
        let (done, bytes) = sync_channel(1);
        self.orders.send((head.clone(), bytes)).ok()?;
        self.window = Some(window);
        Some((head, self.spare.try_recv().unwrap_or_default(), done))
    }

    /// The next chunk that fits and is not passed over; the reader comes to it by the same way.
    fn find(&self, window: &mut Window<Recording>) -> io::Result<Option<ChunkHead>> {
        while let Some(head) = window.peek::<HEAD>()? {
            let frame = framed(head, window.position());
            if matches!(frame.opcode, op::DATA_END | 0) || frame.end() >= self.length {
                break;
            }
            if frame.opcode != op::CHUNK {
                window.skip(frame.end() - frame.byte)?;
                continue;
            }
            let head = ChunkHead::read(window, &frame)?.ok().filter(fits);
            if !holds_nothing(window, frame.end(), |id| self.unwanted.binary_search(&id).is_ok())? {
                window.go_to(frame.end())?;
                if head.is_some() {
                    return Ok(head);
                }
            }
        }
        Ok(None)
    }
}

/// Unpacks one chunk after another until there are no more.
fn work(scout: &Mutex<Scout>, mut unpacker: Unpacker) {
    // Not in the loop's own condition: the scout must not be kept while a chunk is unpacked.
    let next = || scout.lock().ok()?.next();
    while let Some((head, mut bytes, done)) = next() {
        if unpacker.unpack(&head, &mut bytes).is_ok_and(|right| right) {
            // Where it was passed over, nobody takes it.
            let _ = done.send(bytes);
        }
    }
}

#[cfg(test)]
mod tests;

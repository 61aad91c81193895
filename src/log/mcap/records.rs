//! The records of a recording, in the order of the file: out of chunks and outside of them, in bounded memory.
//!
//! Of a chunk only what is wanted is kept while it is unpacked, and handed on when its checksum is right. Where more than
//! [`super::arena::ARENA`] bytes of it are wanted, they are handed on before.

use std::{collections::VecDeque, io, sync::Arc};

use super::{
    arena::{Arena, Item, Kept, parsed},
    chunk::Chunk,
    fields::Fields,
    op,
    registry::{Interest, Registry},
    unpacking::Ahead,
    window::{Origin, Recording, Window},
};
use crate::{
    error::{Error, Place, Problem, Reason, Result},
    log::format::MCAP_MAGIC,
};

/// What a recording begins and ends with.
pub(super) const MAGIC: [u8; 8] = *MCAP_MAGIC;
/// Opcode and length.
pub(super) const HEAD: usize = 9;
/// What comes next.
pub(super) enum Stage {
    /// A record of the file.
    File(Window<Recording>),
    /// A record of a chunk.
    Chunk(Box<Chunk>),
    /// A record behind the end of the data.
    Summary(Window<Recording>),
    /// What is behind the end of the recording.
    Behind(Window<Recording>),
    Ended,
}

/// Where a record stands, and how it is kept.
pub(super) struct Frame {
    pub(super) opcode: u8,
    pub(super) length: u64,
    pub(super) byte: u64,
}

impl Frame {
    /// Where the record behind it begins.
    pub(super) fn end(&self) -> u64 {
        self.byte.saturating_add(HEAD as u64).saturating_add(self.length)
    }
}

/// What became of the next record.
pub(super) enum Step {
    Taken,
    /// The bytes ended before it did.
    Cut,
}

/// How a recording is read.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    /// Longest record that is taken in, in bytes.
    pub(super) max_message: u64,
    /// Whether all is wanted that a [`super::raw::Tap`] is told.
    pub(super) everything: bool,
    /// Whether named texts are wanted, whatever else is.
    pub(super) metadata: bool,
}

/// The records of a recording.
pub(super) struct Records {
    name: Arc<str>,
    stage: Stage,
    pub(super) position: u64,
    pub(super) registry: Registry,
    /// The summary has told all channels there are.
    pub(super) complete: bool,
    pub(super) limits: Limits,
    pub(super) ahead: Ahead,
    pub(super) arena: Arena,
    /// Channels that were handed on.
    told: Vec<u64>,
    damaged: bool,
    /// Recordings that go on where this one ends.
    parts: VecDeque<Part>,
    /// Bytes of the parts before this one.
    before: u64,
}

/// One of several recordings that are read as one.
pub(super) struct Part {
    pub(super) name: Arc<str>,
    pub(super) recording: Recording,
    pub(super) ahead: Ahead,
}

impl Records {
    /// Checks the first bytes, and reads the summary where there is one and the file can be read from anywhere.
    ///
    /// Errors where the file can't be read, or is no recording. One that ends within its first bytes is a damaged one.
    pub(super) fn open(
        recording: Recording,
        name: Arc<str>,
        mut registry: Registry,
        limits: Limits,
        ahead: Ahead,
    ) -> Result<Self> {
        let failed = |source| Error::Io { file: name.clone(), source };
        let mut window = Window::new(recording, false);
        let statistics = super::summary::read(&mut window, &mut registry).map_err(failed)?;
        let complete = statistics.is_some_and(|count| count as usize == registry.channels().count());
        window.go_to(0).map_err(failed)?;
        window.begin_checksum();
        let mut arena = Arena::default();
        let start = window.need(MAGIC.len()).map_err(failed)?;
        let stage = if start == MAGIC {
            window.use_up(MAGIC.len());
            Stage::File(window)
        } else if MAGIC.starts_with(start) {
            let count = start.len();
            arena.problem(Reason::Truncated, 0, format!("the file ends after {count} bytes, before its first record"));
            Stage::Ended
        } else {
            let place = Place { file: name, line: 0, byte: 0 };
            return Err(Error::Format { place, message: "no MCAP recording: it does not begin as one".into() });
        };
        Ok(Self {
            name,
            stage,
            position: 0,
            registry,
            complete,
            limits,
            ahead,
            arena,
            told: vec![0; 1 << 10],
            damaged: false,
            parts: VecDeque::new(),
            before: 0,
        })
    }

    /// From where this recording ends on, `part` is read: the next one of several that are one.
    pub(super) fn then(&mut self, part: Part) {
        self.parts.push_back(part);
        // Another part may have other channels.
        self.complete = false;
    }

    /// Begins with the next part, where there is one.
    fn next_part(&mut self) -> Result<bool> {
        let Some(Part { name, recording, ahead }) = self.parts.pop_front() else { return Ok(false) };
        self.before += self.position;
        self.position = 0;
        self.name = name;
        self.ahead = ahead;
        self.forget_channels();
        let failed = |source| Error::Io { file: self.name.clone(), source };
        let mut window = Window::new(recording, true);
        let start = window.need(MAGIC.len()).map_err(failed)?;
        if start != MAGIC {
            let place = Place { file: self.name.clone(), line: 0, byte: 0 };
            return Err(Error::Format { place, message: "no MCAP recording: it does not begin as one".into() });
        }
        window.use_up(MAGIC.len());
        self.stage = Stage::File(window);
        Ok(true)
    }

    /// What comes is another recording, with channels of its own.
    fn forget_channels(&mut self) {
        self.registry.clear();
        self.complete = false;
        self.told.fill(0);
        self.arena.push(Kept::Restart, self.arena.bytes.len(), 0);
    }

    /// The channels known so far.
    pub(super) fn registry(&self) -> &Registry {
        &self.registry
    }

    /// Whether all channels of the file are known.
    pub(super) fn is_complete(&self) -> bool {
        self.complete
    }

    /// Whether some of the file is lost: it ended before it should have, or a chunk can't be used.
    pub(super) fn is_damaged(&self) -> bool {
        self.damaged
    }

    /// Bytes used so far, those of all parts.
    pub(super) fn position(&self) -> u64 {
        let here = match &self.stage {
            Stage::File(window) | Stage::Summary(window) | Stage::Behind(window) => window.position(),
            _ => self.position,
        };
        self.before + here
    }

    /// Whether the next record has to be waited for.
    pub(super) fn drained(&self) -> bool {
        let waits = |window: &Window<Recording>| {
            let mut head = Fields(window.rest());
            let length = head.bytes(1).and_then(|_| head.u64());
            window.length().is_none() && length.is_none_or(|length| length > head.0.len() as u64)
        };
        match &self.stage {
            _ if !self.arena.entries.is_empty() => false,
            Stage::File(window) | Stage::Summary(window) | Stage::Behind(window) => waits(window),
            Stage::Chunk(_) | Stage::Ended => false,
        }
    }

    /// The next item and where it, or its chunk, begins; `None` at the end. Errors where the file can't be read on.
    ///
    /// Takes one record in at most, so that a caller can look after its output before the file has to wait for more.
    pub(super) fn next(&mut self) -> Result<Option<(Item<'_>, u64)>> {
        if self.arena.entries.is_empty() {
            self.arena.clear();
        }
        if self.arena.entries.is_empty() {
            let stage = std::mem::replace(&mut self.stage, Stage::Ended);
            let next = match stage {
                Stage::File(window) => self.file_record(window),
                Stage::Chunk(chunk) => self.chunk_records(chunk),
                Stage::Summary(window) => self.summary_record(window),
                Stage::Behind(window) => self.behind(window),
                Stage::Ended if self.next_part()? => return Ok(Some((Item::Nothing, 0))),
                Stage::Ended => return Ok(None),
            };
            self.stage = next.map_err(|source| Error::Io { file: self.name.clone(), source })?;
        }
        let Some(entry) = self.arena.entries.pop_front() else { return Ok(Some((Item::Nothing, self.position()))) };
        self.damaged |= matches!(entry.what, Kept::Problem(Reason::Truncated | Reason::BadChunk, _));
        let (byte, name) = (entry.byte, self.name.clone());
        let problem =
            |reason, value| Item::Problem(Problem { reason, place: Place { file: name, line: 0, byte }, value });
        let bytes = self.arena.bytes.get(entry.range).unwrap_or_default();
        let item = match entry.what {
            Kept::Restart => Item::Restart(self.name.clone()),
            Kept::Problem(reason, words) => problem(reason, words),
            Kept::Channel(id) => match self.registry.channel(id) {
                Some(channel) => Item::Channel(channel),
                None => problem(Reason::BadMessage, format!("channel {id} is gone")),
            },
            Kept::Record(opcode) => match parsed(opcode, bytes, &self.registry) {
                Some(item) => item,
                None => {
                    problem(Reason::BadMessage, format!("a record (opcode {opcode}) that ends early or is no text"))
                }
            },
        };
        Ok(Some((item, byte)))
    }

    /// Takes the file's next record in.
    fn file_record(&mut self, mut window: Window<Recording>) -> io::Result<Stage> {
        let byte = window.position();
        let Some(head) = window.peek::<HEAD>()? else {
            return Ok(self.cut(window, byte, "a record"));
        };
        let frame = framed(head, byte);
        match frame.opcode {
            op::CHUNK => return self.chunk(window, &frame),
            op::DATA_END => {
                let checksum = window.take_checksum();
                window.use_up(HEAD);
                return self.data_end(window, &frame, checksum);
            }
            0 => {
                let lost = self.lost_from(&mut window, byte);
                let words = format!("no record begins here; the {lost} bytes from here on are lost");
                self.arena.problem(Reason::Truncated, byte, words);
                return Ok(Stage::Ended);
            }
            _ => {}
        }
        if window.length().is_some_and(|length| frame.length > length.saturating_sub(byte + HEAD as u64)) {
            return Ok(self.cut(window, byte, what(frame.opcode)));
        }
        window.use_up(HEAD);
        match self.record(&mut window, &frame)? {
            Step::Taken => Ok(Stage::File(window)),
            Step::Cut => Ok(self.cut(window, byte, what(frame.opcode))),
        }
    }

    /// The file ends within the record that begins at `byte`.
    pub(super) fn cut(&mut self, mut window: Window<Recording>, byte: u64, what: &str) -> Stage {
        let lost = self.lost_from(&mut window, byte);
        let words = match lost {
            0 => "cut off: the file ends without an end of the data; 0 bytes are lost".to_owned(),
            _ => format!("cut off: the last {lost} bytes, the beginning of {what}, are lost"),
        };
        self.arena.problem(Reason::Truncated, byte, words);
        Stage::Ended
    }

    /// The file ends behind its data, within what begins at `byte`.
    fn cut_summary(&mut self, mut window: Window<Recording>, byte: u64) -> Stage {
        let lost = self.lost_from(&mut window, byte);
        let words = format!("cut off behind the data: no message is lost, and of the summary the last {lost} bytes");
        self.arena.problem(Reason::Truncated, byte, words);
        Stage::Ended
    }

    /// Bytes from `byte` to the end.
    fn lost_from(&mut self, window: &mut Window<Recording>, byte: u64) -> u64 {
        let end = window.length().unwrap_or_else(|| {
            // What can't be read any more can't be counted.
            let _ = window.skip(u64::MAX);
            window.position()
        });
        self.position = end;
        end.saturating_sub(byte)
    }

    /// Takes one record in, its head used up: keeps it, or passes over it.
    pub(super) fn record<R: Origin>(&mut self, window: &mut Window<R>, frame: &Frame) -> io::Result<Step> {
        let wanted = match frame.opcode {
            op::SCHEMA | op::CHANNEL => true,
            op::METADATA if self.limits.metadata => true,
            op::HEADER | op::ATTACHMENT | op::METADATA => self.limits.everything,
            op::MESSAGE => match window.peek::<2>()? {
                None => return Ok(Step::Cut),
                Some(_) if frame.length < 2 => false,
                Some(id) => self.wants(u16::from_le_bytes(id), frame.byte),
            },
            _ => false,
        };
        if wanted && frame.length > self.limits.max_message {
            let words = format!("{} of {} bytes: longer than --max-message", what(frame.opcode), frame.length);
            self.arena.problem(Reason::TooLong, frame.byte, words);
        } else if wanted {
            let from = self.arena.bytes.len();
            if window.copy(frame.length, &mut self.arena.bytes)? < frame.length {
                self.arena.bytes.truncate(from);
                return Ok(Step::Cut);
            }
            self.keep(frame, from);
            return Ok(Step::Taken);
        }
        let passed = window.skip(frame.length)?;
        Ok(if passed < frame.length { Step::Cut } else { Step::Taken })
    }

    fn wants(&mut self, id: u16, byte: u64) -> bool {
        match self.registry.interest(id) {
            Interest::Wanted => true,
            Interest::Unwanted => false,
            Interest::Unknown => {
                self.arena.problem(Reason::BadMessage, byte, format!("a message of channel {id}, which there is not"));
                false
            }
        }
    }

    /// Keeps the record that was appended to the arena, or registers what it describes.
    fn keep(&mut self, frame: &Frame, from: usize) {
        let record = self.arena.bytes.get(from..).unwrap_or_default();
        let outcome = match frame.opcode {
            op::SCHEMA => self.registry.add_schema(record).map(|()| None),
            op::CHANNEL => self.registry.add_channel(record).map(|id| Some(id).filter(|id| self.is_news(*id))),
            opcode => {
                self.arena.push(Kept::Record(opcode), from, frame.byte);
                return;
            }
        };
        self.arena.bytes.truncate(from);
        match outcome {
            Ok(Some(id)) => self.arena.push(Kept::Channel(id), from, frame.byte),
            Ok(None) => {}
            Err(words) => self.arena.problem(Reason::BadSchema, frame.byte, words),
        }
    }

    /// What was kept is not handed on.
    pub(super) fn forget_arena(&mut self) {
        for entry in &self.arena.entries {
            if let Kept::Channel(id) = entry.what
                && let Some(word) = self.told.get_mut(usize::from(id >> 6))
            {
                *word &= !(1 << (id & 63));
            }
        }
        self.arena.clear();
    }

    /// Whether the channel is handed on for the first time.
    fn is_news(&mut self, id: u16) -> bool {
        let (word, bit) = (usize::from(id >> 6), 1u64 << (id & 63));
        self.told.get_mut(word).is_some_and(|word| {
            let news = *word & bit == 0;
            *word |= bit;
            news
        })
    }

    /// The end of the data: its checksum, and then the summary.
    fn data_end(&mut self, mut window: Window<Recording>, frame: &Frame, found: Option<u32>) -> io::Result<Stage> {
        if frame.length >= 4 {
            let Some(expected) = window.peek::<4>()?.map(u32::from_le_bytes) else {
                return Ok(self.cut(window, frame.byte, "the end of the data"));
            };
            if let Some(found) = found.filter(|found| expected != 0 && *found != expected) {
                let words =
                    format!("the data has the checksum {found:08x} and not {expected:08x}: something in it is wrong");
                self.arena.problem(Reason::BadChunk, frame.byte, words);
            }
        }
        window.drop_checksum();
        let passed = window.skip(frame.length)?;
        let whole = window.length().is_none_or(|length| window.position() <= length);
        Ok(if passed < frame.length || !whole {
            self.cut(window, frame.byte, "the end of the data")
        } else {
            Stage::Summary(window)
        })
    }

    /// Passes over a record of the summary, and sees whether the file is whole.
    fn summary_record(&mut self, mut window: Window<Recording>) -> io::Result<Stage> {
        let byte = window.position();
        let Some(head) = window.peek::<HEAD>()? else {
            return Ok(self.cut_summary(window, byte));
        };
        let frame = framed(head, byte);
        let cut = window.length().is_some_and(|length| frame.end() > length);
        window.use_up(HEAD);
        if cut || window.skip(frame.length)? < frame.length {
            return Ok(self.cut_summary(window, byte));
        }
        if frame.opcode != op::FOOTER {
            return Ok(Stage::Summary(window));
        }
        let byte = window.position();
        if window.peek()? != Some(MAGIC) {
            return Ok(self.cut_summary(window, byte));
        }
        window.use_up(MAGIC.len());
        self.position = window.position();
        Ok(Stage::Behind(window))
    }

    /// What is behind the end of a recording: nothing, another recording, or what nobody can read.
    fn behind(&mut self, mut window: Window<Recording>) -> io::Result<Stage> {
        let byte = window.position();
        if window.peek()? == Some(MAGIC) {
            window.begin_checksum();
            window.use_up(MAGIC.len());
            self.ahead = Ahead::Never;
            self.forget_channels();
            return Ok(Stage::File(window));
        }
        if window.need(1)?.is_empty() {
            return Ok(Stage::Ended);
        }
        let more = self.lost_from(&mut window, byte);
        let words = format!("{more} bytes behind the end of the recording begin as none, and are not read");
        self.arena.problem(Reason::TrailingData, byte, words);
        Ok(Stage::Ended)
    }
}

/// The head of the record that begins at `byte`.
pub(super) fn framed(head: [u8; HEAD], byte: u64) -> Frame {
    let [opcode, length @ ..] = head;
    Frame { opcode, length: u64::from_le_bytes(length), byte }
}

/// What a record is called.
fn what(opcode: u8) -> &'static str {
    match opcode {
        op::SCHEMA => "a schema",
        op::CHANNEL => "a channel",
        op::MESSAGE => "a message",
        op::ATTACHMENT => "an attachment",
        op::METADATA => "metadata",
        _ => "a record",
    }
}

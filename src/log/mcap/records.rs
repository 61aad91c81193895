//! The records of a recording, in the order of the file: out of chunks and outside of them, in bounded memory.
//!
//! Of a chunk only what is wanted is kept while it is unpacked, and handed on when its checksum is right. Where more than
//! [`ARENA`] bytes of it are wanted, they are handed on before.

use std::{collections::VecDeque, io, ops::Range, sync::Arc};

use super::{
    body::Body,
    fields::Fields,
    raw::{Attachment, Channel, Message, Metadata},
    registry::{Interest, Registry},
    window::{Origin, Recording, Window},
};
use crate::{
    error::{Error, Place, Problem, Reason, Result},
    log::format::MCAP_MAGIC,
};

/// What a recording begins and ends with.
pub(super) const MAGIC: [u8; 8] = *MCAP_MAGIC;
/// Bytes that are kept of one chunk before its checksum is known.
const ARENA: usize = 16 << 20;
/// Items that are kept of it, at most.
const MOST_ENTRIES: usize = 1 << 16;
/// Opcode and length.
const HEAD: usize = 9;
/// A chunk's fields before its compression.
const CHUNK_HEAD: usize = 32;
/// Longest name of a compression.
const LONGEST_NAME: usize = 32;

/// Opcodes (mcap.dev/spec, "Records").
pub(super) mod op {
    pub(in super::super) const HEADER: u8 = 0x01;
    pub(in super::super) const FOOTER: u8 = 0x02;
    pub(in super::super) const SCHEMA: u8 = 0x03;
    pub(in super::super) const CHANNEL: u8 = 0x04;
    pub(in super::super) const MESSAGE: u8 = 0x05;
    pub(in super::super) const CHUNK: u8 = 0x06;
    pub(in super::super) const MESSAGE_INDEX: u8 = 0x07;
    pub(in super::super) const ATTACHMENT: u8 = 0x09;
    pub(in super::super) const STATISTICS: u8 = 0x0b;
    pub(in super::super) const METADATA: u8 = 0x0c;
    pub(in super::super) const DATA_END: u8 = 0x0f;
}

/// Something that a recording holds.
pub(super) enum Item<'a> {
    /// Profile and library.
    Header(&'a str, &'a str),
    Channel(&'a Arc<Channel>),
    Message(&'a Arc<Channel>, Message<'a>),
    Metadata(Metadata),
    Attachment(Attachment<'a>),
    /// Something that can't be used.
    Problem(Problem),
}

/// What an entry of the arena is.
enum Kept {
    Record(u8),
    Channel(u16),
    Problem(Reason, String),
}

struct Entry {
    what: Kept,
    range: Range<usize>,
    /// Where it, or its chunk, begins in the file.
    byte: u64,
}

/// What was read and is not yet handed on.
#[derive(Default)]
struct Arena {
    bytes: Vec<u8>,
    entries: VecDeque<Entry>,
}

impl Arena {
    fn push(&mut self, what: Kept, from: usize, byte: u64) {
        self.entries.push_back(Entry { what, range: from..self.bytes.len(), byte });
    }

    fn problem(&mut self, reason: Reason, byte: u64, words: impl Into<String>) {
        let end = self.bytes.len();
        self.push(Kept::Problem(reason, words.into()), end, byte);
    }

    fn clear(&mut self) {
        self.bytes.clear();
        self.bytes.shrink_to(ARENA);
        self.entries.clear();
    }
}

/// A chunk that is being unpacked.
struct Chunk {
    window: Window<Body>,
    /// Where it begins in the file, and where the record behind it does.
    byte: u64,
    end: u64,
    /// The checksum it should have; 0 for none.
    checksum: u32,
    /// Unpacked bytes still to come.
    left: u64,
    /// Records of it that were handed on before its checksum was known.
    early: bool,
}

/// What comes next.
enum Stage {
    /// A record of the file.
    File(Window<Recording>),
    /// A record of a chunk.
    Chunk(Box<Chunk>),
    /// A record behind the end of the data.
    Summary(Window<Recording>),
    Ended,
}

/// Where a record stands, and how it is kept.
struct Frame {
    opcode: u8,
    length: u64,
    byte: u64,
}

/// What became of the next record.
enum Step {
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
}

/// The records of a recording.
pub(super) struct Records {
    name: Arc<str>,
    stage: Stage,
    position: u64,
    registry: Registry,
    /// The summary has told all channels there are.
    complete: bool,
    limits: Limits,
    arena: Arena,
    /// Channels that were handed on.
    told: Vec<u64>,
    damaged: bool,
}

impl Records {
    /// Checks the first bytes, and reads the summary where there is one and the file can be read from anywhere.
    ///
    /// Errors where the file can't be read, or is no recording. One that ends within its first bytes is a damaged one.
    pub(super) fn open(recording: Recording, name: Arc<str>, mut registry: Registry, limits: Limits) -> Result<Self> {
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
        Ok(Self { name, stage, position: 0, registry, complete, limits, arena, told: vec![0; 1 << 10], damaged: false })
    }

    /// The channels known so far.
    pub(super) fn registry(&self) -> &Registry {
        &self.registry
    }

    /// Whether all channels of the file are known.
    pub(super) fn is_complete(&self) -> bool {
        self.complete
    }

    /// Whether the file ended before it should have.
    pub(super) fn is_damaged(&self) -> bool {
        self.damaged
    }

    /// Bytes of the file used so far.
    pub(super) fn position(&self) -> u64 {
        match &self.stage {
            Stage::File(window) | Stage::Summary(window) => window.position(),
            _ => self.position,
        }
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
            Stage::File(window) | Stage::Summary(window) => waits(window),
            Stage::Chunk(_) | Stage::Ended => false,
        }
    }

    /// The next item and where it, or its chunk, begins; `None` at the end. Errors where the file can't be read on.
    pub(super) fn next(&mut self) -> Result<Option<(Item<'_>, u64)>> {
        if self.arena.entries.is_empty() {
            self.arena.clear();
        }
        while self.arena.entries.is_empty() {
            let stage = std::mem::replace(&mut self.stage, Stage::Ended);
            let next = match stage {
                Stage::File(window) => self.file_record(window),
                Stage::Chunk(chunk) => self.chunk_records(chunk),
                Stage::Summary(window) => self.summary_record(window),
                Stage::Ended => return Ok(None),
            };
            self.stage = next.map_err(|source| Error::Io { file: self.name.clone(), source })?;
        }
        let Some(entry) = self.arena.entries.pop_front() else { return Ok(None) };
        self.damaged |= matches!(entry.what, Kept::Problem(Reason::Truncated, _));
        let (byte, name) = (entry.byte, self.name.clone());
        let problem =
            |reason, value| Item::Problem(Problem { reason, place: Place { file: name, line: 0, byte }, value });
        let bytes = self.arena.bytes.get(entry.range).unwrap_or_default();
        let item = match entry.what {
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
    fn cut(&mut self, mut window: Window<Recording>, byte: u64, what: &str) -> Stage {
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
    fn record<R: Origin>(&mut self, window: &mut Window<R>, frame: &Frame) -> io::Result<Step> {
        let wanted = match frame.opcode {
            op::SCHEMA | op::CHANNEL => true,
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
        let end = byte.saturating_add(HEAD as u64).saturating_add(frame.length);
        let cut = window.length().is_some_and(|length| end > length);
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
        Ok(Stage::Ended)
    }

    /// Begins with a chunk, or passes over it.
    fn chunk(&mut self, mut window: Window<Recording>, frame: &Frame) -> io::Result<Stage> {
        let head: [u8; HEAD + CHUNK_HEAD] = match window.peek()? {
            Some(head) => head,
            None => return Ok(self.cut(window, frame.byte, "a chunk")),
        };
        let end = frame.byte.saturating_add(HEAD as u64).saturating_add(frame.length);
        let mut fields = Fields(head.get(HEAD + 16..).unwrap_or_default());
        let parts = (|| Some((fields.u64()?, fields.u32()?, usize::try_from(fields.u32()?).ok()?)))();
        let Some((left, checksum, name)) = parts.filter(|(.., name)| *name <= LONGEST_NAME) else {
            return self.bad_chunk(window, frame.byte, end, "its compression has no name that is known");
        };
        let names = HEAD + CHUNK_HEAD..HEAD + CHUNK_HEAD + name;
        let head = window.need(names.end + 8)?.to_vec();
        let (Some(compression), Some(size)) = (head.get(names.clone()), head.get(names.end..)) else {
            return Ok(self.cut(window, frame.byte, "a chunk"));
        };
        let Some(size) = Fields(size).u64() else {
            return Ok(self.cut(window, frame.byte, "a chunk"));
        };
        if size > frame.length.saturating_sub(head.len() as u64 - HEAD as u64) {
            return self.bad_chunk(window, frame.byte, end, "its content reaches beyond its end");
        }
        if self.passes_over(&mut window, end)? {
            return Ok(Stage::File(window));
        }
        window.skip(head.len() as u64)?;
        self.position = window.position();
        self.registry.begin_chunk();
        match Body::new(window, size, compression)? {
            Ok(body) => {
                let window = Window::new(body, true);
                let byte = frame.byte;
                Ok(Stage::Chunk(Box::new(Chunk { window, byte, end, checksum, left, early: false })))
            }
            Err(packed) => {
                let words = format!("its compression is {}, which is not known", String::from_utf8_lossy(compression));
                self.bad_chunk(packed.into_inner(), frame.byte, end, &words)
            }
        }
    }

    /// Counts a chunk as unusable, and goes on behind it.
    fn bad_chunk(&mut self, mut window: Window<Recording>, byte: u64, end: u64, words: &str) -> io::Result<Stage> {
        let length = window.length();
        let left = end.saturating_sub(window.position());
        if length.is_some_and(|length| end > length) || window.skip(left)? < left {
            return Ok(self.cut(window, byte, "a chunk"));
        }
        self.arena.problem(Reason::BadChunk, byte, format!("a chunk is not used: {words}"));
        Ok(Stage::File(window))
    }

    /// Passes over the chunk that ends at `end` where the indexes behind it say that it holds no message that is wanted.
    fn passes_over(&mut self, window: &mut Window<Recording>, end: u64) -> io::Result<bool> {
        let start = window.position();
        if !self.complete || self.limits.everything || window.length().is_none_or(|length| end >= length) {
            return Ok(false);
        }
        window.drop_checksum();
        window.skip(end - start)?;
        let mut indexes = 0;
        while let Some(head) = window.peek::<HEAD>()? {
            let frame = framed(head, window.position());
            if frame.opcode != op::MESSAGE_INDEX || frame.length < 6 {
                break;
            }
            window.use_up(HEAD);
            let mut fields = Fields(window.need(6)?);
            let (Some(id), Some(size)) = (fields.u16(), fields.u32()) else { break };
            if size > 0 && self.registry.interest(id) != Interest::Unwanted {
                indexes = 0;
                break;
            }
            indexes += 1;
            window.skip(frame.length)?;
        }
        if indexes == 0 {
            window.go_to(start)?;
        }
        Ok(indexes > 0)
    }

    /// Unpacks a chunk until it ends or enough of it is kept.
    fn chunk_records(&mut self, mut chunk: Box<Chunk>) -> io::Result<Stage> {
        loop {
            if self.arena.bytes.len() > ARENA || self.arena.entries.len() > MOST_ENTRIES {
                chunk.early = true;
                return Ok(Stage::Chunk(chunk));
            }
            if chunk.left == 0 {
                return self.chunk_end(*chunk, None);
            }
            let step = self.chunk_record(&mut chunk);
            let words = match step {
                Ok(Ok(Step::Taken)) => continue,
                Ok(Ok(Step::Cut)) => "it ends before its records do".to_owned(),
                Ok(Err(words)) => words.to_owned(),
                // What the decompressors say of what they can't unpack.
                Err(error) => error.to_string(),
            };
            return self.chunk_end(*chunk, Some(words));
        }
    }

    /// Takes the next record of a chunk in; the words are what is wrong with it.
    fn chunk_record(&mut self, chunk: &mut Chunk) -> io::Result<Result<Step, &'static str>> {
        let Some(head) = chunk.window.peek::<HEAD>()? else { return Ok(Ok(Step::Cut)) };
        let frame = framed(head, chunk.byte);
        let Some(left) = frame.length.checked_add(HEAD as u64).and_then(|used| chunk.left.checked_sub(used)) else {
            return Ok(Err("a record reaches beyond its end"));
        };
        if frame.opcode == op::CHUNK {
            return Ok(Err("there is a chunk in it"));
        }
        chunk.window.use_up(HEAD);
        let step = self.record(&mut chunk.window, &frame)?;
        chunk.left = left;
        Ok(Ok(step))
    }

    /// The end of a chunk, come to or not: checks it, and goes on behind it.
    fn chunk_end(&mut self, mut chunk: Chunk, fault: Option<String>) -> io::Result<Stage> {
        let found = chunk.window.take_checksum().unwrap_or_default();
        let is_cut = fault.is_some() && chunk.window.origin().is_cut();
        let (mut window, left) = chunk.window.into_origin().into_file();
        if is_cut {
            return Ok(self.cut_chunk(window, chunk.byte));
        }
        let fault = fault.or_else(|| {
            let wrong = chunk.checksum != 0 && found != chunk.checksum;
            wrong.then(|| format!("its checksum is {found:08x} and not {:08x}", chunk.checksum))
        });
        if let Some(fault) = fault {
            self.arena.clear();
            self.registry.forget_chunk();
            let early = if chunk.early { "; its first messages had been used before that was found" } else { "" };
            return self.bad_chunk(window, chunk.byte, chunk.end, &format!("{fault}{early}"));
        }
        let left = chunk.end.saturating_sub(window.position()).max(left);
        if window.skip(left)? < left || window.length().is_some_and(|length| window.position() > length) {
            return Ok(self.cut(window, chunk.byte, "a chunk (all of its messages are used)"));
        }
        Ok(Stage::File(window))
    }

    /// The file ends within a chunk: what of it is complete is used.
    fn cut_chunk(&mut self, window: Window<Recording>, byte: u64) -> Stage {
        let saved = self.arena.entries.iter().filter(|entry| matches!(entry.what, Kept::Record(op::MESSAGE))).count();
        self.cut(window, byte, &format!("a chunk of which {saved} messages could be read"))
    }
}

fn framed(head: [u8; HEAD], byte: u64) -> Frame {
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

/// A record that was kept; `None` where it ends early or is no text.
fn parsed<'a>(opcode: u8, bytes: &'a [u8], registry: &'a Registry) -> Option<Item<'a>> {
    let mut fields = Fields(bytes);
    match opcode {
        op::HEADER => Some(Item::Header(fields.text()?, fields.text()?)),
        op::MESSAGE => {
            let (channel, sequence) = (fields.u16()?, fields.u32()?);
            let (log_time, publish_time) = (fields.u64()?, fields.u64()?);
            let message = Message { channel, sequence, log_time, publish_time, data: fields.0 };
            Some(Item::Message(registry.channel(channel)?, message))
        }
        op::METADATA => Some(Item::Metadata(Metadata { name: fields.text()?.to_owned(), entries: fields.map()? })),
        op::ATTACHMENT => {
            let (log_time, create_time) = (fields.u64()?, fields.u64()?);
            let (name, media_type) = (fields.text()?, fields.text()?);
            let size = usize::try_from(fields.u64()?).ok()?;
            let data = fields.bytes(size)?;
            let checked = bytes.get(..bytes.len() - fields.0.len())?;
            let checksum = fields.u32()?;
            let right = checksum == 0 || crc32fast::hash(checked) == checksum;
            right.then_some(Item::Attachment(Attachment { log_time, create_time, name, media_type, data }))
        }
        _ => None,
    }
}

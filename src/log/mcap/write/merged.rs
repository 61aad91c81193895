//! Messages of this program's own and of another recording, in one file in the order of their log times.

use std::{
    cmp::Reverse,
    collections::{BTreeMap, BTreeSet, BinaryHeap},
    io::Write,
};

use super::{
    super::raw::{Attachment, Channel, Message, Metadata},
    file::{McapFile, SchemaText},
    recording::{ORIGIN, origin},
    ros2::qos::Words,
    schema::SchemaKind,
};
use crate::error::Result;

/// Bytes of another recording that wait for their turn, at most, the last message aside.
const MOST_HELD: usize = 48 * 1024 * 1024;

/// What is put before a topic of another recording that would collide with one of this program's own.
pub const COLLISION_PREFIX: &str = "/input";

/// Another recording's message that waits for its turn. Ordered by log time, and as they came where these are equal.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Held {
    log_time: u64,
    arrival: u64,
    channel: u16,
    sequence: u32,
    publish_time: u64,
    data: Vec<u8>,
}

/// A file that two write to.
pub(super) struct Merged<W: Write> {
    file: McapFile<W>,
    /// No message that is written in its turn is earlier.
    written: u64,
    held: BinaryHeap<Reverse<Held>>,
    held_bytes: usize,
    /// How much earlier than one that came before it another recording's message may be, in nanoseconds, and still be put in order.
    window: u64,
    /// The latest log time of the other recording.
    newest: u64,
    arrivals: u64,
    late: u64,
    /// Numbers of the channels written so far.
    numbers: BTreeSet<u16>,
    /// From the other recording's channels to their numbers here.
    foreign: BTreeMap<u16, u16>,
    own_topics: BTreeSet<String>,
    kind: SchemaKind,
    words: Words,
    /// The other recording says where it comes from.
    has_origin: bool,
}

impl<W: Write> Merged<W> {
    /// `own_topics` are those of this program, with messages of `kind`.
    pub(super) fn new(file: McapFile<W>, kind: SchemaKind, window: u64, own_topics: BTreeSet<String>) -> Self {
        Self {
            file,
            written: 0,
            held: BinaryHeap::new(),
            held_bytes: 0,
            window,
            newest: 0,
            arrivals: 0,
            late: 0,
            numbers: BTreeSet::new(),
            foreign: BTreeMap::new(),
            own_topics,
            kind,
            words: Words::default(),
            has_origin: false,
        }
    }

    /// How policies are written in this file; where that is by number, it says so.
    pub(super) fn agree_on_words(&mut self) -> Result<Words> {
        if self.kind == SchemaKind::Ros2 && self.words == Words::Numbers && !self.has_origin {
            self.file.metadata(&origin())?;
        }
        Ok(self.words)
    }

    /// Messages of the other recording that came later than the window allows, and stand out of order.
    pub(super) const fn late(&self) -> u64 {
        self.late
    }

    /// A channel of this program's own.
    pub(super) fn channel(
        &mut self,
        topic: &str,
        schema: &SchemaText,
        encoding: &str,
        metadata: &BTreeMap<String, String>,
    ) -> Result<u16> {
        let number = self.file.channel(topic, schema, encoding, metadata)?;
        self.numbers.insert(number);
        Ok(number)
    }

    /// Writes a message of this program's own; it is logged at `log_time`, or with what is already written where that is later.
    pub(super) fn write(&mut self, channel: u16, log_time: u64, data: &[u8]) -> Result<()> {
        while self.held.peek().is_some_and(|Reverse(first)| first.log_time <= log_time) {
            self.release()?;
        }
        self.written = self.written.max(log_time);
        self.file.write(channel, self.written, data)
    }

    pub(super) fn metadata(&mut self, metadata: &Metadata) -> Result<()> {
        self.file.metadata(metadata)
    }

    pub(super) fn flush(&mut self) -> Result<()> {
        self.file.flush()
    }

    /// Writes what is held and the summary.
    pub(super) fn finish(mut self) -> Result<W> {
        while !self.held.is_empty() {
            self.release()?;
        }
        self.file.finish()
    }

    /// Takes over the other recording's profile where it is this program's own: it promises something of every channel.
    pub(super) fn add_foreign_profile(&mut self, profile: &str) {
        if profile == self.kind.profile() {
            self.file.set_profile(profile);
        }
    }

    /// Takes over a channel of the other recording. It keeps its number where that is free.
    pub(super) fn add_foreign_channel(&mut self, channel: &Channel) -> Result<()> {
        if let Some(words) = Words::of(&channel.metadata) {
            self.words = words;
        }
        let schema = match &channel.schema {
            Some(schema) => self.file.foreign_schema(&schema.name, &schema.encoding, &schema.data)?,
            None => 0,
        };
        let number = std::iter::once(channel.id).chain(1..=u16::MAX).find(|number| !self.numbers.contains(number));
        // With all numbers taken, the file says so itself.
        let number = number.unwrap_or(channel.id);
        let collides = self.own_topics.contains(&channel.topic);
        let topic = if collides { format!("{COLLISION_PREFIX}{}", channel.topic) } else { channel.topic.clone() };
        self.file.foreign_channel(number, schema, &topic, &channel.encoding, &channel.metadata)?;
        self.numbers.insert(number);
        self.foreign.insert(channel.id, number);
        Ok(())
    }

    /// Takes over a message of the other recording, to be written in its turn. One of an unknown channel is dropped.
    pub(super) fn add_foreign(&mut self, message: Message<'_>) -> Result<()> {
        let Some(&channel) = self.foreign.get(&message.channel) else { return Ok(()) };
        let message = Message { channel, ..message };
        if message.log_time < self.written {
            self.late += 1;
            return self.file.copy(message);
        }
        self.newest = self.newest.max(message.log_time);
        self.hold(message);
        while let Some(Reverse(first)) = self.held.peek() {
            let is_due = self.newest - first.log_time > self.window;
            if !is_due && self.held_bytes <= MOST_HELD {
                break;
            }
            self.release()?;
        }
        Ok(())
    }

    /// Copies named texts of the other recording.
    pub(super) fn add_foreign_metadata(&mut self, metadata: &Metadata) -> Result<()> {
        self.has_origin |= metadata.name == ORIGIN;
        self.file.metadata(metadata)
    }

    /// Copies a file within the other recording.
    pub(super) fn add_foreign_attachment(&mut self, attachment: Attachment<'_>) -> Result<()> {
        self.file.attachment(attachment)
    }

    fn hold(&mut self, message: Message<'_>) {
        let Message { channel, sequence, log_time, publish_time, data } = message;
        self.held_bytes += data.len();
        self.arrivals += 1;
        let arrival = self.arrivals;
        self.held.push(Reverse(Held { log_time, arrival, channel, sequence, publish_time, data: data.to_vec() }));
    }

    /// Writes the earliest message that is held.
    fn release(&mut self) -> Result<()> {
        let Some(Reverse(held)) = self.held.pop() else { return Ok(()) };
        let Held { log_time, channel, sequence, publish_time, data, .. } = held;
        self.held_bytes -= data.len();
        self.written = self.written.max(log_time);
        self.file.copy(Message { channel, sequence, log_time, publish_time, data: &data })
    }
}

//! What was read of a recording and is not yet handed on.

use std::{collections::VecDeque, ops::Range, sync::Arc};

use super::{
    fields::Fields,
    op,
    raw::{Attachment, Channel, Message, Metadata},
    registry::Registry,
};
use crate::error::{Problem, Reason};

/// Bytes that are kept of one chunk before its checksum is known.
pub(super) const ARENA: usize = 16 << 20;
/// Items that are kept of it, at most.
pub(super) const MOST_ENTRIES: usize = 1 << 16;

/// Something that a recording holds.
#[derive(Debug)]
pub(super) enum Item<'a> {
    /// Profile and library.
    Header(&'a str, &'a str),
    Channel(&'a Arc<Channel>),
    Message(&'a Arc<Channel>, Message<'a>),
    Metadata(Metadata),
    Attachment(Attachment<'a>),
    /// Another recording begins, in the file of this name: numbers of channels mean others from here on.
    Restart(Arc<str>),
    /// A record that nobody wants.
    Nothing,
    /// Something that can't be used.
    Problem(Problem),
}

/// What an entry of the arena is.
pub(super) enum Kept {
    Record(u8),
    Channel(u16),
    Problem(Reason, String),
    /// Another recording begins.
    Restart,
}

pub(super) struct Entry {
    pub(super) what: Kept,
    pub(super) range: Range<usize>,
    /// Where it, or its chunk, begins in the file.
    pub(super) byte: u64,
}

/// What was read and is not yet handed on.
#[derive(Default)]
pub(super) struct Arena {
    pub(super) bytes: Vec<u8>,
    pub(super) entries: VecDeque<Entry>,
}

impl Arena {
    pub(super) fn push(&mut self, what: Kept, from: usize, byte: u64) {
        self.entries.push_back(Entry { what, range: from..self.bytes.len(), byte });
    }

    pub(super) fn problem(&mut self, reason: Reason, byte: u64, words: impl Into<String>) {
        let end = self.bytes.len();
        self.push(Kept::Problem(reason, words.into()), end, byte);
    }

    pub(super) fn clear(&mut self) {
        self.bytes.clear();
        self.bytes.shrink_to(ARENA);
        self.entries.clear();
    }
}

/// A record that was kept; `None` where it ends early or is no text.
pub(super) fn parsed<'a>(opcode: u8, bytes: &'a [u8], registry: &'a Registry) -> Option<Item<'a>> {
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

//! What stands before a chunk's content, and what the indexes behind a chunk say of it.

use std::io;

use super::{
    fields::Fields,
    op,
    records::{Frame, HEAD, framed},
    window::{Recording, Window},
};

/// A chunk's fields before its compression.
const FIXED: usize = 32;
/// Longest name of a compression.
const LONGEST_NAME: usize = 32;

/// The head of a chunk.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct ChunkHead {
    /// Where it begins in the file, where its content does, and where the record behind it does.
    pub(super) byte: u64,
    pub(super) content: u64,
    pub(super) end: u64,
    /// How many bytes its content has in the file, and unpacked.
    pub(super) packed: u64,
    pub(super) unpacked: u64,
    /// The checksum of the unpacked content; 0 for none.
    pub(super) checksum: u32,
    pub(super) compression: Vec<u8>,
}

/// Why a chunk has no head.
pub(super) enum Headless {
    /// The file ends within it.
    Cut,
    /// It can't be, in words.
    Wrong(&'static str),
}

impl ChunkHead {
    /// The head of the chunk that comes next; nothing of it is used up.
    pub(super) fn read(window: &mut Window<Recording>, frame: &Frame) -> io::Result<Result<Self, Headless>> {
        let Some(fixed) = window.peek::<{ HEAD + FIXED }>()? else { return Ok(Err(Headless::Cut)) };
        let mut fields = Fields(fixed.get(HEAD + 16..).unwrap_or_default());
        let parts = (|| Some((fields.u64()?, fields.u32()?, usize::try_from(fields.u32()?).ok()?)))();
        let Some((unpacked, checksum, name)) = parts.filter(|(.., name)| *name <= LONGEST_NAME) else {
            return Ok(Err(Headless::Wrong("its compression has no name that is known")));
        };
        let length = HEAD + FIXED + name + 8;
        let mut fields = Fields(window.need(length)?.get(HEAD + FIXED..).unwrap_or_default());
        let (Some(compression), Some(packed)) = (fields.bytes(name), fields.u64()) else {
            return Ok(Err(Headless::Cut));
        };
        if packed > frame.length.saturating_sub(length as u64 - HEAD as u64) {
            return Ok(Err(Headless::Wrong("its content reaches beyond its end")));
        }
        let compression = compression.to_vec();
        let (byte, content) = (frame.byte, frame.byte.saturating_add(length as u64));
        Ok(Ok(Self { byte, content, end: frame.end(), packed, unpacked, checksum, compression }))
    }
}

/// Whether the indexes behind the chunk that ends at `end` say that it holds messages, and all of them of channels that are
/// `unwanted`. If so, the window stands behind these indexes, and else anywhere.
pub(super) fn holds_nothing(
    window: &mut Window<Recording>,
    end: u64,
    unwanted: impl Fn(u16) -> bool,
) -> io::Result<bool> {
    window.go_to(end)?;
    let mut indexes = 0;
    while let Some(head) = window.peek::<HEAD>()? {
        let frame = framed(head, window.position());
        if frame.opcode != op::MESSAGE_INDEX || frame.length < 6 {
            break;
        }
        window.use_up(HEAD);
        let mut fields = Fields(window.need(6)?);
        let (Some(id), Some(size)) = (fields.u16(), fields.u32()) else { break };
        if size > 0 && !unwanted(id) {
            return Ok(false);
        }
        indexes += 1;
        window.skip(frame.length)?;
    }
    Ok(indexes > 0)
}

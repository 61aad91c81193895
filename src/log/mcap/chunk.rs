//! Chunks: unpacked in a window of fixed size, and passed over where nothing in them is wanted.

use std::io;

use super::{
    arena::{ARENA, Kept, MOST_ENTRIES},
    body::Body,
    fields::Fields,
    op,
    records::{Frame, HEAD, Records, Stage, Step, framed},
    registry::Interest,
    window::{Recording, Window},
};
use crate::error::Reason;

/// A chunk's fields before its compression.
const CHUNK_HEAD: usize = 32;
/// Longest name of a compression.
const LONGEST_NAME: usize = 32;

/// A chunk that is being unpacked.
pub(super) struct Chunk {
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

impl Records {
    /// Begins with a chunk, or passes over it.
    pub(super) fn chunk(&mut self, mut window: Window<Recording>, frame: &Frame) -> io::Result<Stage> {
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
    pub(super) fn chunk_records(&mut self, mut chunk: Box<Chunk>) -> io::Result<Stage> {
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
        let fault = fault.or_else(|| rest_of(&mut chunk.window));
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
            self.forget_arena();
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

/// What is wrong with a chunk behind its last record. A decompressor may have looked at it already or not, which depends on how
/// much of the file was read at a time: the outcome must not.
fn rest_of(window: &mut Window<Body>) -> Option<String> {
    match window.need(1).map(<[u8]>::is_empty) {
        Ok(true) => None,
        Ok(false) => Some("it holds more than it says".to_owned()),
        Err(_) if window.origin().is_cut() => None,
        Err(error) => Some(error.to_string()),
    }
}

#[cfg(test)]
mod tests;

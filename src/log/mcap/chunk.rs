//! Chunks: unpacked in a window of fixed size, and passed over where nothing in them is wanted.

use std::io;

use super::{
    arena::{ARENA, Kept, MOST_ENTRIES},
    body::{Body, Compression},
    chunk_head::{ChunkHead, Headless, holds_nothing},
    op,
    records::{Frame, HEAD, Records, Stage, Step, framed},
    registry::Interest,
    window::{Recording, Window},
};
use crate::error::Reason;

/// A chunk that is being unpacked.
pub(super) struct Chunk {
    window: Window<Body>,
    /// Where it begins in the file, and where the record behind it does.
    byte: u64,
    end: u64,
    /// The checksum it should have; 0 for none, and for one that was found to be right.
    checksum: u32,
    /// Unpacked bytes still to come.
    left: u64,
    /// Records of it that were handed on before its checksum was known.
    early: bool,
}

impl Chunk {
    fn new(window: Window<Body>, head: &ChunkHead) -> Self {
        let ChunkHead { byte, end, unpacked: left, checksum, .. } = *head;
        Self { window, byte, end, checksum, left, early: false }
    }
}

impl Records {
    /// Begins with a chunk, or passes over it.
    pub(super) fn chunk(&mut self, mut window: Window<Recording>, frame: &Frame) -> io::Result<Stage> {
        let head = match ChunkHead::read(&mut window, frame)? {
            Ok(head) => head,
            Err(Headless::Cut) => return Ok(self.cut(window, frame.byte, "a chunk")),
            Err(Headless::Wrong(words)) => return self.bad_chunk(window, frame.byte, frame.end(), words),
        };
        if self.can_pass_over(&window, head.end) {
            window.drop_checksum();
            if holds_nothing(&mut window, head.end, |id| self.registry.interest(id) == Interest::Unwanted)? {
                return Ok(Stage::File(window));
            }
            if let Some(bytes) = self.ahead.take(&head, window.origin(), || self.registry.unwanted()) {
                window.go_to(head.end)?;
                let chunk = Chunk { checksum: 0, ..Chunk::new(Window::whole(Body::Behind(window), bytes), &head) };
                return Ok(self.begin_chunk(chunk, head.content));
            }
            window.go_to(head.byte)?;
        }
        window.skip(head.content - head.byte)?;
        let content = window.position();
        let Some(compression) = Compression::named(&head.compression) else {
            self.registry.begin_chunk();
            let words =
                format!("its compression is {}, which is not known", String::from_utf8_lossy(&head.compression));
            return self.bad_chunk(window, head.byte, head.end, &words);
        };
        let body = Body::new(window, head.packed, compression)?;
        Ok(self.begin_chunk(Chunk::new(Window::new(body, true), &head), content))
    }

    fn begin_chunk(&mut self, chunk: Chunk, content: u64) -> Stage {
        self.position = content;
        self.registry.begin_chunk();
        Stage::Chunk(Box::new(chunk))
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

    /// Whether the chunk that ends at `end` may be passed over where the indexes behind it say that nothing in it is wanted.
    fn can_pass_over(&self, window: &Window<Recording>, end: u64) -> bool {
        self.complete && !self.limits.everything && window.length().is_some_and(|length| end < length)
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
        let (body, bytes) = chunk.window.into_parts();
        if matches!(body, Body::Behind(_)) {
            self.ahead.give_back(bytes);
        }
        let (mut window, left) = body.into_file();
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

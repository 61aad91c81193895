//! What was read from a file and is not yet used.
use std::{
    io::{self, Read},
    sync::Arc,
};

use crate::error::{Error, Result};

/// Bytes that are asked for in one read.
const SIZE: usize = 64 * 1024;

/// A window of fixed size onto a file, which is read once from front to back.
pub(super) struct Buffer {
    reader: Box<dyn Read + Send>,
    name: Arc<str>,
    bytes: Box<[u8]>,
    /// What was read and is not yet used: `bytes[start..end]`.
    start: usize,
    end: usize,
    /// The reader has said that there is no more.
    ended: bool,
    position: u64,
    fills: u64,
    tabs_to_blanks: bool,
}

impl Buffer {
    pub(super) fn new(reader: Box<dyn Read + Send>, name: Arc<str>) -> Self {
        let bytes = vec![0; SIZE].into_boxed_slice();
        Self { reader, name, bytes, start: 0, end: 0, ended: false, position: 0, fills: 0, tabs_to_blanks: false }
    }

    /// The file's name in messages.
    pub(super) fn name(&self) -> &Arc<str> {
        &self.name
    }

    /// What is there to be used.
    #[inline]
    pub(super) fn rest(&self) -> &[u8] {
        &self.bytes[self.start..self.end]
    }

    /// The next byte; reads more where there is none, `None` at the end of the file.
    #[inline]
    pub(super) fn peek(&mut self) -> Result<Option<u8>> {
        if self.start == self.end && !self.fill()? {
            return Ok(None);
        }
        Ok(self.rest().first().copied())
    }

    /// Bytes used so far.
    #[inline]
    pub(super) fn position(&self) -> u64 {
        self.position
    }

    /// How many times more was asked for: what [`Buffer::rest`] holds changes with it.
    #[inline]
    pub(super) fn fills(&self) -> u64 {
        self.fills
    }

    /// The last `count` bytes used: there until more is read.
    #[inline]
    pub(super) fn used(&self, count: usize) -> &[u8] {
        let from = self.start.saturating_sub(count);
        &self.bytes[from..self.start]
    }

    /// Whether the end of the file was read.
    pub(super) fn ended(&self) -> bool {
        self.ended
    }

    /// Whether more fits behind what is there.
    pub(super) fn full(&self) -> bool {
        self.end - self.start == self.bytes.len()
    }

    /// Counts the next bytes as used, as many as there are.
    #[inline]
    pub(super) fn use_up(&mut self, count: usize) {
        let count = count.min(self.end - self.start);
        self.start += count;
        self.position += count as u64;
    }

    /// From here on, a tab is read as a blank.
    pub(super) fn turn_tabs_to_blanks(&mut self) {
        self.tabs_to_blanks = true;
        self.turn_tabs(self.start);
    }

    /// Reads more behind what is there, once; `false` at the end of the file and where the buffer is full.
    pub(super) fn fill(&mut self) -> Result<bool> {
        if self.ended || self.full() {
            return Ok(false);
        }
        self.bytes.copy_within(self.start..self.end, 0);
        self.end -= self.start;
        self.start = 0;
        self.fills += 1;
        loop {
            match self.reader.read(&mut self.bytes[self.end..]) {
                Ok(count) => {
                    let fresh = self.end;
                    // A reader that claims more than it was asked for is not believed.
                    self.end = self.bytes.len().min(fresh + count);
                    self.ended = count == 0;
                    self.turn_tabs(fresh);
                    return Ok(!self.ended);
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(source) => return Err(Error::Io { file: self.name.clone(), source }),
            }
        }
    }

    fn turn_tabs(&mut self, from: usize) {
        if self.tabs_to_blanks {
            for byte in &mut self.bytes[from..self.end] {
                if *byte == b'\t' {
                    *byte = b' ';
                }
            }
        }
    }
}

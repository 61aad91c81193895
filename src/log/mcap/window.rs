//! A window of fixed size onto bytes that are read once from front to back.

use std::{
    fs::File,
    io::{self, BufRead, Read, Seek, SeekFrom},
};

use crate::{
    error::{Error, Result},
    log::Input,
};

/// Bytes that are asked for in one read.
const SIZE: usize = 64 * 1024;

/// Where the bytes come from.
pub(super) trait Origin: Read {
    /// Passes over `count` bytes without reading them; `false` where that can't be done.
    fn pass(&mut self, _count: u64) -> io::Result<bool> {
        Ok(false)
    }
}

/// A file, or something that only comes once.
pub(super) enum Recording {
    /// A file and its length.
    File(File, u64),
    /// A pipe.
    Stream(Box<dyn Read + Send>),
}

impl Recording {
    /// The file at `path` where it is one, else the `input` that was opened for it.
    pub(super) fn open(path: &str, input: Input) -> Result<Self> {
        Ok(match input.length {
            Some(length) if path != "-" => {
                Self::File(File::open(path).map_err(|source| Error::Io { file: input.name, source })?, length)
            }
            _ => Self::Stream(input.reader),
        })
    }
}

impl Read for Recording {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::File(file, _) => file.read(into),
            Self::Stream(stream) => stream.read(into),
        }
    }
}

impl Origin for Recording {
    fn pass(&mut self, count: u64) -> io::Result<bool> {
        match (self, i64::try_from(count)) {
            (Self::File(file, _), Ok(count)) => file.seek_relative(count).map(|()| true),
            _ => Ok(false),
        }
    }
}

/// The window: what was read and is not yet used, and how far it is.
pub(super) struct Window<R> {
    origin: R,
    bytes: Vec<u8>,
    start: usize,
    end: usize,
    /// The origin has said that there is no more.
    ended: bool,
    position: u64,
    /// Over all that was used, where that is of interest and nothing was passed over.
    hasher: Option<crc32fast::Hasher>,
}

impl<R: Origin> Window<R> {
    pub(super) fn new(origin: R, hash: bool) -> Self {
        Self { hasher: hash.then(crc32fast::Hasher::new), ..Self::of_size(origin, SIZE) }
    }

    /// A window of another size, in bytes.
    pub(super) fn of_size(origin: R, size: usize) -> Self {
        Self { origin, bytes: vec![0; size], start: 0, end: 0, ended: false, position: 0, hasher: None }
    }

    /// A window that is all of `bytes`, with nothing behind them.
    pub(super) fn whole(origin: R, bytes: Vec<u8>) -> Self {
        let end = bytes.len();
        Self { origin, bytes, start: 0, end, ended: true, position: 0, hasher: None }
    }

    /// What the bytes come from.
    pub(super) fn origin(&self) -> &R {
        &self.origin
    }

    /// What the bytes come from, with what was read of it and not used gone, and the window's memory.
    pub(super) fn into_parts(self) -> (R, Vec<u8>) {
        (self.origin, self.bytes)
    }

    /// Bytes used so far.
    pub(super) fn position(&self) -> u64 {
        self.position
    }

    /// The checksum of all that was used, where it was kept; none is kept from then on.
    pub(super) fn take_checksum(&mut self) -> Option<u32> {
        self.hasher.take().map(crc32fast::Hasher::finalize)
    }

    /// What is there to be used.
    pub(super) fn rest(&self) -> &[u8] {
        self.bytes.get(self.start..self.end).unwrap_or_default()
    }

    /// Whether all was used.
    pub(super) fn is_over(&self) -> bool {
        self.ended && self.start == self.end
    }

    /// The next `count` bytes, at most a window full of them; fewer only at the end.
    pub(super) fn need(&mut self, count: usize) -> io::Result<&[u8]> {
        while self.end - self.start < count && self.fill()? {}
        let rest = self.rest();
        Ok(rest.get(..count).unwrap_or(rest))
    }

    /// The next `N` bytes, `None` where there are fewer left.
    pub(super) fn peek<const N: usize>(&mut self) -> io::Result<Option<[u8; N]>> {
        Ok(self.need(N)?.first_chunk().copied())
    }

    /// Counts bytes of [`Window::rest`] as used.
    pub(super) fn use_up(&mut self, count: usize) {
        let count = count.min(self.end - self.start);
        if let Some(hasher) = &mut self.hasher {
            hasher.update(self.bytes.get(self.start..self.start + count).unwrap_or_default());
        }
        self.start += count;
        self.position += count as u64;
    }

    /// Appends the next `count` bytes to `into`, which grows only as they come; says how many there were.
    pub(super) fn copy(&mut self, count: u64, into: &mut Vec<u8>) -> io::Result<u64> {
        self.walk(count, |bytes| into.extend_from_slice(bytes))
    }

    /// Uses up the next `count` bytes, read or not; says how many there were as far as that is known.
    pub(super) fn skip(&mut self, count: u64) -> io::Result<u64> {
        let there = (self.end - self.start) as u64;
        if count > there + self.bytes.len() as u64 && self.hasher.is_none() {
            self.use_up(self.end - self.start);
            // What was read before does not lie before what comes now.
            (self.start, self.end) = (0, 0);
            if self.origin.pass(count - there)? {
                self.position += count - there;
                return Ok(count);
            }
            return Ok(there + self.walk(count - there, |_| ())?);
        }
        self.walk(count, |_| ())
    }

    fn walk(&mut self, count: u64, mut take: impl FnMut(&[u8])) -> io::Result<u64> {
        let mut left = count;
        while left > 0 {
            if self.start == self.end && !self.fill()? {
                break;
            }
            let step = usize::try_from(left).unwrap_or(usize::MAX).min(self.end - self.start);
            take(self.bytes.get(self.start..self.start + step).unwrap_or_default());
            self.use_up(step);
            left -= step as u64;
        }
        Ok(count - left)
    }

    /// Reads more behind what is there, once; `false` at the end and where there is no room.
    fn fill(&mut self) -> io::Result<bool> {
        if self.ended {
            return Ok(false);
        }
        self.bytes.copy_within(self.start..self.end, 0);
        self.end -= self.start;
        self.start = 0;
        let Some(room) = self.bytes.get_mut(self.end..).filter(|room| !room.is_empty()) else {
            return Ok(false);
        };
        let most = room.len();
        let count = loop {
            match self.origin.read(room) {
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                read => break read?,
            }
        };
        // A reader that claims more than it was asked for is not believed.
        self.end += count.min(most);
        self.ended = count == 0;
        Ok(!self.ended)
    }
}

impl Window<Recording> {
    /// The length of the whole, where it is a file.
    pub(super) fn length(&self) -> Option<u64> {
        match self.origin {
            Recording::File(_, length) => Some(length),
            Recording::Stream(_) => None,
        }
    }

    /// Goes to a place of the file, which costs nothing within the window; `false` where it is none. No checksum is kept from
    /// then on.
    pub(super) fn go_to(&mut self, position: u64) -> io::Result<bool> {
        let Recording::File(file, _) = &mut self.origin else { return Ok(false) };
        let first = self.position - self.start as u64;
        match position.checked_sub(first) {
            Some(there) if there <= self.end as u64 => self.start = there as usize,
            _ => {
                file.seek(SeekFrom::Start(position))?;
                (self.start, self.end) = (0, 0);
            }
        }
        (self.ended, self.position, self.hasher) = (false, position, None);
        Ok(true)
    }

    /// Forgets what was used so far: the checksum begins here.
    pub(super) fn begin_checksum(&mut self) {
        self.hasher = Some(crc32fast::Hasher::new());
    }

    /// No checksum is kept from here on, so that bytes can be passed over.
    pub(super) fn drop_checksum(&mut self) {
        self.hasher = None;
    }
}

impl<R: Origin> Read for Window<R> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let rest = self.fill_buf()?;
        let count = rest.len().min(into.len());
        if let (Some(into), Some(rest)) = (into.get_mut(..count), rest.get(..count)) {
            into.copy_from_slice(rest);
        }
        self.use_up(count);
        Ok(count)
    }
}

impl<R: Origin> BufRead for Window<R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.start == self.end {
            self.fill()?;
        }
        Ok(self.rest())
    }

    fn consume(&mut self, count: usize) {
        self.use_up(count);
    }
}

#[cfg(test)]
mod tests;

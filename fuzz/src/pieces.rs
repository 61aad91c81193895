//! Input that comes whole, and the same input that comes in pieces.

use std::{
    io,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
};

use atm::log::Input;

/// Bytes in pieces of at most `most` bytes, whose lengths follow from the pattern; each call counts.
struct Pieces {
    bytes: Arc<[u8]>,
    at: usize,
    pattern: u8,
    reads: Arc<AtomicU64>,
}

impl io::Read for Pieces {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.reads.fetch_add(1, Ordering::Relaxed);
        let rest = &self.bytes[self.at..];
        // The lowest bits are the length, the others change it from read to read.
        let most = usize::from(self.pattern & 7) + 1;
        self.pattern = self.pattern.rotate_left(3);
        let count = rest.len().min(buffer.len()).min(most);
        buffer[..count].copy_from_slice(&rest[..count]);
        self.at += count;
        Ok(count)
    }
}

/// All at once.
pub fn whole(bytes: &[u8]) -> Input {
    Input { reader: Box::new(io::Cursor::new(bytes.to_vec())), name: "whole".into(), length: None }
}

/// In pieces of one to eight bytes; the second value counts the reads.
pub fn pieces(bytes: &[u8], pattern: u8) -> (Input, Arc<AtomicU64>) {
    let reads = Arc::new(AtomicU64::new(0));
    let reader = Pieces { bytes: bytes.into(), at: 0, pattern, reads: Arc::clone(&reads) };
    (Input { reader: Box::new(reader), name: "whole".into(), length: None }, reads)
}

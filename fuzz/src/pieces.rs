//! Input that comes whole, and the same input that comes in pieces.

use std::{cell::Cell, io, rc::Rc, sync::Arc};

use atm::log::Input;

/// Bytes in pieces of at most `most` bytes, whose lengths follow from the pattern; each call counts.
struct Pieces {
    bytes: Arc<[u8]>,
    at: usize,
    pattern: u8,
    reads: Rc<Cell<u64>>,
}

impl io::Read for Pieces {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.reads.set(self.reads.get() + 1);
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
pub fn pieces(bytes: &[u8], pattern: u8) -> (Input, Rc<Cell<u64>>) {
    let reads = Rc::new(Cell::new(0));
    let reader = Pieces { bytes: bytes.into(), at: 0, pattern, reads: Rc::clone(&reads) };
    (Input { reader: Box::new(reader), name: "whole".into(), length: None }, reads)
}

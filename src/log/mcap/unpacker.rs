//! A chunk, unpacked in one go.

use std::{
    fs::File,
    io::{self, Read, Seek, SeekFrom},
};

use super::{
    body::{Compression, WINDOW_LOG_MAX},
    chunk_head::ChunkHead,
};

/// The mark of a compressed frame, one byte of flags, and one that says how large its window is (RFC 8878, section 3.1.1.1).
const FLAGS: usize = 4;
const WINDOW: usize = 5;
/// The flag of a frame without that byte: its window is all that it holds.
const SINGLE_SEGMENT: u8 = 1 << 5;
/// What that byte says of the largest window that is used: a power of two from 10 on, above three bits of eighths.
const LARGEST_WINDOW: u8 = ((WINDOW_LOG_MAX - 10) << 3) as u8;

/// Unpacks one chunk after another of a file.
pub(super) struct Unpacker {
    file: File,
    packed: Vec<u8>,
    zstd: zstd::bulk::Decompressor<'static>,
}

impl Unpacker {
    pub(super) fn new(file: File) -> Self {
        Self { file, packed: Vec::new(), zstd: zstd::bulk::Decompressor::default() }
    }

    /// Unpacks the chunk that `head` is of; `false`, or an error, where it is not one piece, or not what its head says.
    ///
    /// Takes as much memory as the head says.
    pub(super) fn unpack(&mut self, head: &ChunkHead, into: &mut Vec<u8>) -> io::Result<bool> {
        let sizes = (usize::try_from(head.packed), usize::try_from(head.unpacked));
        let ((Ok(packed), Ok(unpacked)), Some(compression)) = (sizes, Compression::named(&head.compression)) else {
            return Ok(false);
        };
        self.file.seek(SeekFrom::Start(head.content))?;
        into.resize(unpacked, 0);
        let whole = match compression {
            Compression::None => packed == unpacked && self.file.read_exact(into).is_ok(),
            Compression::Lz4 => {
                let mut decoder = lz4::Decoder::new(self.packed(packed)?)?;
                decoder.read_exact(into)?;
                decoder.read(&mut [0])? == 0
            }
            Compression::Zstd => {
                self.packed(packed)?;
                is_one_frame(&self.packed) && self.zstd.decompress_to_buffer(&self.packed, &mut **into)? == unpacked
            }
        };
        Ok(whole && (head.checksum == 0 || crc32fast::hash(into) == head.checksum))
    }

    /// The next `count` bytes of the file.
    fn packed(&mut self, count: usize) -> io::Result<&[u8]> {
        self.packed.resize(count, 0);
        self.file.read_exact(&mut self.packed)?;
        Ok(&self.packed)
    }
}

/// Whether the bytes are one compressed frame, and nothing else, of a window that is not too large. Unpacked in one go, a frame
/// takes no window, and none would be found to be too large.
fn is_one_frame(bytes: &[u8]) -> bool {
    let fits = match (bytes.get(FLAGS), bytes.get(WINDOW)) {
        (Some(flags), Some(window)) => flags & SINGLE_SEGMENT != 0 || *window <= LARGEST_WINDOW,
        _ => false,
    };
    fits && zstd::zstd_safe::find_frame_compressed_size(bytes) == Ok(bytes.len())
}

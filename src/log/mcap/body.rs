//! What is in a chunk: its bytes, unpacked as they are asked for.

use std::io::{self, Read, Take};

use super::window::{Origin, Recording, Window};

/// Largest window of a compressed frame, as a power of two: 64 MiB, more than any setting below "ultra" asks for. The frame
/// says how large it is, and is not believed beyond.
const WINDOW_LOG_MAX: u32 = 26;

type Packed = Take<Window<Recording>>;

/// A chunk's records, unpacked.
pub(super) enum Body {
    Plain(Packed),
    Zstd(Box<zstd::Decoder<'static, Packed>>),
    Lz4(Box<lz4::Decoder<Packed>>),
}

impl Body {
    /// The body of the chunk whose packed bytes are the next `size` of the file; the file comes back where nobody knows the
    /// compression.
    pub(super) fn new(bytes: Window<Recording>, size: u64, compression: &[u8]) -> io::Result<Result<Self, Packed>> {
        let packed = bytes.take(size);
        Ok(Ok(match compression {
            b"" => Self::Plain(packed),
            b"lz4" => Self::Lz4(Box::new(lz4::Decoder::new(packed)?)),
            b"zstd" => {
                let mut decoder = zstd::Decoder::with_buffer(packed)?;
                decoder.window_log_max(WINDOW_LOG_MAX)?;
                Self::Zstd(Box::new(decoder))
            }
            _ => return Ok(Err(packed)),
        }))
    }

    fn packed(&self) -> &Packed {
        match self {
            Self::Plain(packed) => packed,
            Self::Zstd(decoder) => decoder.get_ref(),
            Self::Lz4(decoder) => decoder.reader(),
        }
    }

    /// Whether the file ended before the chunk did.
    pub(super) fn is_cut(&self) -> bool {
        self.packed().limit() > 0 && self.packed().get_ref().is_over()
    }

    /// The file, and how many packed bytes are still before the chunk's end.
    pub(super) fn into_file(self) -> (Window<Recording>, u64) {
        let packed = match self {
            Self::Plain(packed) => packed,
            Self::Zstd(decoder) => decoder.finish(),
            Self::Lz4(decoder) => decoder.finish().0,
        };
        let left = packed.limit();
        (packed.into_inner(), left)
    }
}

impl Read for Body {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::Plain(packed) => packed.read(into),
            Self::Zstd(decoder) => decoder.read(into),
            Self::Lz4(decoder) => decoder.read(into),
        }
    }
}

impl Origin for Body {}

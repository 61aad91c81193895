//! What is in a chunk: its bytes, unpacked as they are asked for.

use std::io::{self, Read, Take};

use super::window::{Origin, Recording, Window};

/// Largest window of a compressed frame, as a power of two: 64 MiB, more than any setting below "ultra" asks for. The frame
/// says how large it is, and is not believed beyond.
pub(super) const WINDOW_LOG_MAX: u32 = 26;

/// How a chunk's content is packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Compression {
    None,
    Lz4,
    Zstd,
}

impl Compression {
    /// The compression that files call by this name; `None` where nobody knows it.
    pub(super) fn named(name: &[u8]) -> Option<Self> {
        match name {
            b"" => Some(Self::None),
            b"lz4" => Some(Self::Lz4),
            b"zstd" => Some(Self::Zstd),
            _ => None,
        }
    }
}

type Packed = Take<Window<Recording>>;

/// A chunk's records, unpacked.
pub(super) enum Body {
    Plain(Packed),
    Zstd(Box<zstd::Decoder<'static, Packed>>),
    Lz4(Box<lz4::Decoder<Packed>>),
    /// Nothing: all is unpacked already. The file stands behind the chunk.
    Behind(Window<Recording>),
}

impl Body {
    /// The body of the chunk whose packed bytes are the next `size` of the file.
    pub(super) fn new(bytes: Window<Recording>, size: u64, compression: Compression) -> io::Result<Self> {
        let packed = bytes.take(size);
        Ok(match compression {
            Compression::None => Self::Plain(packed),
            Compression::Lz4 => Self::Lz4(Box::new(lz4::Decoder::new(packed)?)),
            Compression::Zstd => {
                let mut decoder = zstd::Decoder::with_buffer(packed)?;
                decoder.window_log_max(WINDOW_LOG_MAX)?;
                Self::Zstd(Box::new(decoder))
            }
        })
    }

    fn packed(&self) -> Option<&Packed> {
        match self {
            Self::Plain(packed) => Some(packed),
            Self::Zstd(decoder) => Some(decoder.get_ref()),
            Self::Lz4(decoder) => Some(decoder.reader()),
            Self::Behind(_) => None,
        }
    }

    /// Whether the file ended before the chunk did.
    pub(super) fn is_cut(&self) -> bool {
        self.packed().is_some_and(|packed| packed.limit() > 0 && packed.get_ref().is_over())
    }

    /// The file, and how many packed bytes are still before the chunk's end.
    pub(super) fn into_file(self) -> (Window<Recording>, u64) {
        let packed = match self {
            Self::Plain(packed) => packed,
            Self::Zstd(decoder) => decoder.finish(),
            Self::Lz4(decoder) => decoder.finish().0,
            Self::Behind(window) => return (window, 0),
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
            Self::Behind(_) => Ok(0),
        }
    }
}

impl Origin for Body {}

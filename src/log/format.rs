//! What kind of file it is, by its content.

use std::io::{self, Cursor, Read};

use super::Input;
use crate::error::{Error, Result};

/// The first bytes of an MCAP file (mcap.dev/spec).
pub const MCAP_MAGIC: &[u8; 8] = b"\x89MCAP0\r\n";

/// What zstd's files begin with (RFC 8878).
const ZSTD_MAGIC: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];
/// Largest window of a compressed file, as a power of two: 128 MiB, as the command zstd takes it.
const WINDOW_LOG_MAX: u32 = 27;

/// The formats that can be told apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// A text table.
    Csv,
    /// An MCAP recording.
    Mcap,
}

impl Format {
    /// The ending of its files' names, without the dot.
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Mcap => "mcap",
        }
    }

    /// What a file is by its name.
    pub fn of_name(path: &str) -> Self {
        if path.to_ascii_lowercase().ends_with(".mcap") { Self::Mcap } else { Self::Csv }
    }
}

/// What a file is by its first bytes.
fn format_of(start: &[u8]) -> Format {
    if start == MCAP_MAGIC { Format::Mcap } else { Format::Csv }
}

impl Input {
    /// What the first bytes say it is; they are still there to be read.
    ///
    /// # Errors
    /// The file can't be read.
    pub fn sniff(self) -> Result<(Format, Self)> {
        let (start, input) = self.start()?;
        if start.get(..ZSTD_MAGIC.len()) == Some(&ZSTD_MAGIC) {
            let (start, input) = input.unpacked()?.start()?;
            return Ok((format_of(&start), input));
        }
        Ok((format_of(&start), input))
    }

    /// What it holds, unpacked as it is read: it is compressed by zstd as a whole.
    fn unpacked(self) -> Result<Self> {
        let Self { reader, name, .. } = self;
        let decoder = zstd::Decoder::new(reader).and_then(|mut decoder| {
            decoder.window_log_max(WINDOW_LOG_MAX)?;
            Ok(decoder)
        });
        let decoder = decoder.map_err(|source| Error::Io { file: name.clone(), source })?;
        // How long it is, and where in it something stands, is not known before it is read.
        Ok(Self { reader: Box::new(decoder), name, length: None })
    }

    /// Its first bytes, which are still there to be read.
    fn start(mut self) -> Result<(Vec<u8>, Self)> {
        let mut start = Vec::with_capacity(MCAP_MAGIC.len());
        let magic = MCAP_MAGIC.len() as u64;
        let mut reader = self.reader;
        reader
            .by_ref()
            .take(magic)
            .read_to_end(&mut start)
            .map_err(|source| Error::Io { file: self.name.clone(), source })?;
        self.reader = Box::new(Cursor::new(start.clone()).chain(reader)) as Box<dyn io::Read + Send>;
        Ok((start, self))
    }

    /// What it is by its first bytes; what was cut off before it could say goes by its name, which is `path`.
    ///
    /// # Errors
    /// The file can't be read.
    pub fn recognize(self, path: &str) -> Result<(Format, Self)> {
        let (found, input) = self.sniff()?;
        let is_cut = input.length.is_some_and(|length| length < MCAP_MAGIC.len() as u64);
        Ok((if is_cut { Format::of_name(path) } else { found }, input))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sniffed(bytes: &'static [u8]) -> (Format, Vec<u8>) {
        let input = Input { reader: Box::new(bytes), name: "log".into(), length: None };
        let (format, mut input) = input.sniff().unwrap();
        let mut read = Vec::new();
        input.reader.read_to_end(&mut read).unwrap();
        (format, read)
    }

    #[test]
    fn mcap_is_known_by_its_magic_and_nothing_is_lost() {
        assert_eq!(sniffed(b"\x89MCAP0\r\nrest"), (Format::Mcap, b"\x89MCAP0\r\nrest".to_vec()));
        assert_eq!(sniffed(b"t,sensor,range\n"), (Format::Csv, b"t,sensor,range\n".to_vec()));
        assert_eq!(sniffed(b"t,"), (Format::Csv, b"t,".to_vec()));
        assert_eq!(sniffed(b""), (Format::Csv, Vec::new()));
    }
}

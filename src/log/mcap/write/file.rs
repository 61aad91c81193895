//! The file itself: chunks, indexes, checksums, and nothing in it of the machine or the hour.

use std::{
    collections::BTreeMap,
    io::{self, Write},
    sync::Arc,
};

use mcap::{
    Compression, McapError, WriteOptions, Writer,
    records::{AttachmentHeader, MessageHeader, Metadata as MetadataRecord},
    write::NoSeek,
};

use super::super::raw::{Attachment, Message, Metadata};
use crate::error::{Error, Result};

/// What the file says of its writer.
const LIBRARY: &str = concat!("atm ", env!("CARGO_PKG_VERSION"));

/// How a file's records are laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Layout {
    /// Compressed chunks with an index: for files, and for pipes whose reader can wait for a megabyte.
    #[default]
    Chunked,
    /// Each record as it comes, so that a reader at the other end of a pipe has it at once. Nothing is kept for an index, so memory
    /// does not grow however long the stream lasts.
    Immediate,
}

/// A message type as a file describes it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct SchemaText {
    pub(super) name: String,
    pub(super) encoding: &'static str,
    pub(super) data: Vec<u8>,
}

/// How far a file is.
enum State<W: Write> {
    /// Nothing is written yet.
    Waiting {
        out: W,
        options: WriteOptions,
    },
    Begun(Box<Writer<NoSeek<W>>>),
    /// It could not be begun.
    Failed,
}

/// An MCAP file that is written front to back, from the first thing on that is written to it. Dropped without
/// [`McapFile::finish`], it is left without a summary, as a file that was cut off.
pub(super) struct McapFile<W: Write> {
    state: State<W>,
    /// In messages.
    name: Arc<str>,
    /// Messages so far by channel.
    sequences: BTreeMap<u16, u32>,
}

impl<W: Write> McapFile<W> {
    /// A file; `name` is what errors call it.
    pub(super) fn new(out: W, name: Arc<str>, profile: &str, layout: Layout) -> Self {
        let options = WriteOptions::new()
            .profile(profile)
            .library(LIBRARY)
            .compression(Some(Compression::Zstd))
            // Several threads cut the input of the compressor differently, and so give other bytes.
            .compression_threads(0)
            .use_chunks(layout == Layout::Chunked)
            .disable_seeking(true);
        Self { state: State::Waiting { out, options }, name, sequences: BTreeMap::new() }
    }

    /// Changes what the header says of the channels; too late where it is written.
    pub(super) fn set_profile(&mut self, profile: &str) {
        if let State::Waiting { options, .. } = &mut self.state {
            *options = options.clone().profile(profile);
        }
    }

    fn with<T>(&mut self, work: impl FnOnce(&mut Writer<NoSeek<W>>) -> Result<T, McapError>) -> Result<T> {
        let result = match self.writer() {
            Ok(writer) => work(writer),
            Err(error) => Err(error),
        };
        result.map_err(|error| named(&self.name, error))
    }

    /// The writer, with which the file begins.
    fn writer(&mut self) -> Result<&mut Writer<NoSeek<W>>, McapError> {
        if matches!(self.state, State::Waiting { .. })
            && let State::Waiting { out, options } = std::mem::replace(&mut self.state, State::Failed)
        {
            self.state = State::Begun(Box::new(options.create(NoSeek::new(out))?));
        }
        match &mut self.state {
            State::Begun(writer) => Ok(writer),
            _ => Err(McapError::AttemptedWriteAfterFailure),
        }
    }

    /// A channel's number; it is written at its first mention.
    pub(super) fn channel(
        &mut self,
        topic: &str,
        schema: &SchemaText,
        encoding: &str,
        metadata: &BTreeMap<String, String>,
    ) -> Result<u16> {
        self.with(|writer| {
            let schema = writer.add_schema(&schema.name, schema.encoding, &schema.data)?;
            writer.add_channel(schema, topic, encoding, metadata)
        })
    }

    /// Another file's schema, under a number of this file.
    pub(super) fn foreign_schema(&mut self, name: &str, encoding: &str, data: &[u8]) -> Result<u16> {
        self.with(|writer| writer.add_schema(name, encoding, data))
    }

    /// Another file's channel under `number`, which no channel has yet.
    pub(super) fn foreign_channel(
        &mut self,
        number: u16,
        schema: u16,
        topic: &str,
        encoding: &str,
        metadata: &BTreeMap<String, String>,
    ) -> Result<()> {
        self.with(|writer| writer.add_channel_with_id(number, schema, topic, encoding, metadata).map(|_| ()))
    }

    /// Writes a message of this program's own, logged and sent at `log_time`.
    pub(super) fn write(&mut self, channel: u16, log_time: u64, data: &[u8]) -> Result<()> {
        let sequence = self.sequences.entry(channel).or_default();
        let message = Message { channel, sequence: *sequence, log_time, publish_time: log_time, data };
        *sequence = sequence.wrapping_add(1);
        self.copy(message)
    }

    /// Writes a message as it is.
    pub(super) fn copy(&mut self, message: Message<'_>) -> Result<()> {
        let Message { channel: channel_id, sequence, log_time, publish_time, data } = message;
        let header = MessageHeader { channel_id, sequence, log_time, publish_time };
        self.with(|writer| writer.write_to_known_channel(&header, data))
    }

    pub(super) fn metadata(&mut self, metadata: &Metadata) -> Result<()> {
        let record = MetadataRecord { name: metadata.name.clone(), metadata: metadata.entries.clone() };
        self.with(|writer| writer.write_metadata(&record))
    }

    pub(super) fn attachment(&mut self, attachment: Attachment<'_>) -> Result<()> {
        let Attachment { log_time, create_time, name, media_type, data } = attachment;
        let header =
            AttachmentHeader { log_time, create_time, name: name.to_owned(), media_type: media_type.to_owned() };
        self.with(|writer| {
            writer.start_attachment(data.len() as u64, header)?;
            writer.put_attachment_bytes(data)?;
            writer.finish_attachment()
        })
    }

    /// Hands everything written so far on, which ends a chunk.
    pub(super) fn flush(&mut self) -> Result<()> {
        self.with(Writer::flush)
    }

    /// Writes the summary, and returns what the file was written to.
    pub(super) fn finish(mut self) -> Result<W> {
        // A file without anything in it has a beginning and an end.
        self.with(|_| Ok(()))?;
        let State::Begun(mut writer) = std::mem::replace(&mut self.state, State::Failed) else {
            return Err(named(&self.name, McapError::AttemptedWriteAfterFailure));
        };
        let finished = writer.finish();
        // Whatever came of it, the writer must not try again when it is dropped.
        let out = writer.into_inner().into_inner();
        finished.map(|_| out).map_err(|error| named(&self.name, error))
    }
}

impl<W: Write> Drop for McapFile<W> {
    fn drop(&mut self) {
        if let State::Begun(mut writer) = std::mem::replace(&mut self.state, State::Failed) {
            // What can still be saved of a run that failed: its error is known already.
            let _ = writer.flush();
            // Dropped as it is, the writer would end the file as if it were whole.
            drop(writer.into_inner());
        }
    }
}

fn named(name: &Arc<str>, error: McapError) -> Error {
    let source = match error {
        McapError::Io(source) => source,
        other => io::Error::other(other),
    };
    Error::Io { file: Arc::clone(name), source }
}

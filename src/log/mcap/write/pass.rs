//! Another recording's contents on their way into a file that is written.

use std::{
    io::Write,
    sync::{Arc, Mutex, PoisonError},
};

use super::{
    super::raw::{Attachment, Channel, Message, Metadata, Tap},
    merged::Merged,
    sensors::SENSORS,
};
use crate::error::{Error, Result};

/// A file that two write to, and that is gone once it is finished.
pub(super) struct Shared<W: Write>(Arc<Mutex<Option<Merged<W>>>>);

impl<W: Write> Clone for Shared<W> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<W: Write> Shared<W> {
    pub(super) fn new(merged: Merged<W>) -> Self {
        Self(Arc::new(Mutex::new(Some(merged))))
    }

    /// Works with the file.
    pub(super) fn with<T>(&self, work: impl FnOnce(&mut Merged<W>) -> Result<T>) -> Result<T> {
        // A panic in the middle of a write leaves a file that says itself that it can't go on.
        let mut merged = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        merged.as_mut().map_or_else(|| Err(finished()), work)
    }

    /// The file, which is gone then.
    pub(super) fn take(&self) -> Result<Merged<W>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take().ok_or_else(finished)
    }
}

fn finished() -> Error {
    Error::Settings { message: "the recording is finished: nothing more can be written to it".to_owned() }
}

/// Copies what it is told of: channels, messages, metadata and attachments, unchanged.
///
/// Messages are put in order of their log times as far as the window reaches. A topic that this program writes itself gets
/// [`super::COLLISION_PREFIX`] before it.
pub struct PassThrough<W: Write> {
    file: Shared<W>,
}

impl<W: Write> PassThrough<W> {
    pub(super) const fn new(file: Shared<W>) -> Self {
        Self { file }
    }
}

impl<W: Write> Tap for PassThrough<W> {
    fn header(&mut self, profile: &str, _library: &str) -> Result<()> {
        self.file.with(|file| {
            file.add_foreign_profile(profile);
            Ok(())
        })
    }

    fn channel(&mut self, channel: &Arc<Channel>) -> Result<()> {
        self.file.with(|file| file.add_foreign_channel(channel))
    }

    fn message(&mut self, message: Message<'_>) -> Result<()> {
        self.file.with(|file| file.add_foreign(message))
    }

    fn metadata(&mut self, metadata: &Metadata) -> Result<()> {
        let mut metadata = metadata.clone();
        if metadata.name == SENSORS {
            metadata.name = format!("input.{SENSORS}");
        }
        self.file.with(|file| file.add_foreign_metadata(&metadata))
    }

    fn attachment(&mut self, attachment: Attachment<'_>) -> Result<()> {
        self.file.with(|file| file.add_foreign_attachment(attachment))
    }
}

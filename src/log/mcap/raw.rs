//! What a recording holds, as it stands there: schemas, channels, messages, and the rest.

use std::{collections::BTreeMap, sync::Arc};

use crate::error::Result;

/// The description of a message type.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Schema {
    /// Its number in the file, above 0.
    pub id: u16,
    /// The type's name.
    pub name: String,
    /// How `data` describes it: `ros2msg`, `ros2idl`, `ros1msg`, `protobuf`, `jsonschema`, …
    pub encoding: String,
    /// The description; empty where it was not kept.
    pub data: Vec<u8>,
}

/// A stream of messages of one type under one topic.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Channel {
    /// Its number in the file.
    pub id: u16,
    /// What its messages are; `None` where the file does not say.
    pub schema: Option<Arc<Schema>>,
    /// Its name.
    pub topic: String,
    /// How its messages are written: `cdr`, `ros1`, `protobuf`, `json`, …
    pub encoding: String,
    /// What else is said of it, such as `offered_qos_profiles`.
    pub metadata: BTreeMap<String, String>,
}

/// One message as it stands in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Message<'a> {
    /// Its channel's number.
    pub channel: u16,
    /// Its number among those of its publisher; 0 where nobody counts.
    pub sequence: u32,
    /// When it was recorded, in nanoseconds.
    pub log_time: u64,
    /// When it was sent, in nanoseconds.
    pub publish_time: u64,
    /// Its content.
    pub data: &'a [u8],
}

/// Named texts about a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Metadata {
    /// What they are about.
    pub name: String,
    /// The texts by their keys.
    pub entries: BTreeMap<String, String>,
}

/// A file in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Attachment<'a> {
    /// When it was recorded, in nanoseconds.
    pub log_time: u64,
    /// When it was made, in nanoseconds.
    pub create_time: u64,
    /// Its name.
    pub name: &'a str,
    /// Its media type (RFC 6838).
    pub media_type: &'a str,
    /// Its content.
    pub data: &'a [u8],
}

/// Is told all that a recording holds, in the order of the file, as it is read: ahead of the readings by the time within which
/// these are put in order.
///
/// An error ends the run.
pub trait Tap {
    /// The file's profile and the library that wrote it; comes first.
    fn header(&mut self, _profile: &str, _library: &str) -> Result<()> {
        Ok(())
    }

    /// A channel, before its first message, once.
    fn channel(&mut self, channel: &Arc<Channel>) -> Result<()>;

    /// A message.
    fn message(&mut self, message: Message<'_>) -> Result<()>;

    /// Named texts.
    fn metadata(&mut self, _metadata: &Metadata) -> Result<()> {
        Ok(())
    }

    /// A file in the file.
    fn attachment(&mut self, _attachment: Attachment<'_>) -> Result<()> {
        Ok(())
    }
}

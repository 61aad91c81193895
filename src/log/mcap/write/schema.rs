//! The two kinds of messages a recording can be made of.

use std::collections::BTreeMap;

use super::{
    cdr::CdrWriter,
    content::{Content, Sort},
    file::SchemaText,
    foxglove,
    protobuf::ProtoWriter,
    ros2::{
        self,
        qos::{self, Durability, Words},
    },
};

/// The kind of messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SchemaKind {
    /// Foxglove's, in protobuf: drawn by Foxglove, Lichtblick and Rerun.
    #[default]
    Foxglove,
    /// ROS 2's: can be played back with `ros2 bag play`, and is drawn by RViz besides.
    Ros2,
}

impl SchemaKind {
    /// The profile of a file that holds nothing else.
    pub(super) const fn profile(self) -> &'static str {
        match self {
            Self::Foxglove => "",
            Self::Ros2 => ros2::PROFILE,
        }
    }

    /// The message encoding of its channels.
    pub(super) const fn encoding(self) -> &'static str {
        match self {
            Self::Foxglove => foxglove::ENCODING,
            Self::Ros2 => ros2::ENCODING,
        }
    }

    /// The message type of a sort of content.
    pub(super) fn schema(self, sort: Sort) -> SchemaText {
        match self {
            Self::Foxglove => foxglove::schema(sort),
            Self::Ros2 => ros2::schema(ros2::definition(sort)),
        }
    }

    /// The metadata of a channel.
    pub(super) fn metadata(self, durability: Durability, words: Words) -> BTreeMap<String, String> {
        match self {
            Self::Foxglove => BTreeMap::new(),
            Self::Ros2 => qos::metadata(durability, words),
        }
    }
}

/// Turns content into messages, in memory that is used again and again.
pub(super) enum Encoder {
    Foxglove(ProtoWriter),
    Ros2(CdrWriter),
}

impl Encoder {
    pub(super) fn new(kind: SchemaKind) -> Self {
        match kind {
            SchemaKind::Foxglove => Self::Foxglove(ProtoWriter::default()),
            SchemaKind::Ros2 => Self::Ros2(CdrWriter::new()),
        }
    }

    pub(super) fn encode(&mut self, content: &Content<'_>) -> &[u8] {
        match self {
            Self::Foxglove(out) => {
                foxglove::write(content, out);
                out.bytes()
            }
            Self::Ros2(out) => {
                ros2::write(content, out);
                out.bytes()
            }
        }
    }
}

//! Recordings in MCAP (mcap.dev/spec): robot logs of ROS 2, ROS 1 and Foxglove.
//!
//! A message's way in: records (in chunks or not) → decoder (by the channel's schema) → a reading waits for its turn, a
//! transform or pose goes into the tree of frames → the reading is placed, and handed on as a record.
//!
//! What was written here is read back as points: clouds under one topic → the numbers of each point → an echo or a crossing.
mod arena;
mod body;
#[cfg(test)]
mod built;
mod chunk;
mod chunk_head;
mod clocks;
mod crossings;
mod decode;
mod echoes;
mod fields;
mod finding;
mod history;
mod holds;
mod home;
mod namespace;
mod op;
mod options;
mod order;
mod plane;
mod points;
mod raw;
mod reader;
mod records;
mod registry;
mod rigid;
mod sensor_ids;
mod sensors;
mod source;
mod summary;
mod tally;
mod topics;
mod tree;
mod unpacker;
mod unpacking;
mod whereabouts;
mod window;
pub mod write;

pub use self::{
    clocks::ClockChoice,
    crossings::McapCrossings,
    echoes::McapEchoes,
    finding::Finding,
    options::{Boresight, Options},
    raw::{Attachment, Channel, Message, Metadata, Schema, Tap},
    source::McapReadings,
};

//! Recordings in MCAP (mcap.dev/spec): robot logs of ROS 2, ROS 1 and Foxglove.
mod raw;
pub mod write;

pub use self::raw::{Attachment, Channel, Message, Metadata, Schema, Tap};

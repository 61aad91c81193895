//! Recordings out: what is fused, for the viewers that people use, and what a simulated robot measures.
pub mod cdr;
mod content;
mod file;
mod foxglove;
pub mod points;
mod protobuf;
mod recording;
mod ros2;
mod schema;

pub use self::{
    file::Layout,
    recording::{FIXED_FRAME, ROBOT_FRAME, RecordingWriter},
    schema::SchemaKind,
};

//! Recordings out: what is fused, for the viewers that people use, and what a simulated robot measures.
pub mod cdr;
mod clouds;
mod content;
mod file;
mod foxglove;
mod merged;
mod options;
mod pass;
pub mod points;
mod protobuf;
mod recording;
mod ros2;
mod schema;
mod sensors;
mod sink;
mod so_far;
mod sweep;
pub mod topics;

pub use self::{
    file::Layout,
    merged::COLLISION_PREFIX,
    options::{Contents, Frames, Options, Transforms},
    pass::PassThrough,
    recording::{FIXED_FRAME, ROBOT_FRAME, RecordingWriter},
    schema::SchemaKind,
    sensors::SENSORS,
    sink::McapSink,
};

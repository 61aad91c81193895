//! How a recording is written.

use atm_core::Isometry2;

use super::{
    file::Layout,
    recording::{FIXED_FRAME, ROBOT_FRAME},
    schema::SchemaKind,
};

/// What a recording is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Contents {
    /// Echoes, arcs, crossings, transforms and path: all that a viewer needs.
    #[default]
    Everything,
    /// Crossings alone.
    Crossings,
}

/// Which transforms are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Transforms {
    /// From the fixed frame to the robot's, and from there to each sensor's.
    #[default]
    All,
    /// From the fixed frame to the robot's: another recording that is copied says where the sensors sit.
    Robot,
    /// None: another recording that is copied has them all. A second parent for a frame would tear the tree.
    None,
}

/// Another recording that is copied into the file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Passing {
    /// The profile in its header.
    pub profile: String,
    /// Within this time, in nanoseconds, its messages are put in order.
    pub window: u64,
}

/// How a recording is written.
#[derive(Debug, Clone)]
pub struct Options {
    /// The kind of messages.
    pub kind: SchemaKind,
    /// How records are laid out; [`Layout::Immediate`] also hands everything on at each [`EchoSink::flush`].
    pub layout: Layout,
    /// What is written.
    pub contents: Contents,
    /// The frame of the echoes.
    pub fixed_frame: String,
    /// The robot's own frame.
    pub robot_frame: String,
    /// Where sensors sit on the robot, by their indices. Where the others sit follows from their readings.
    pub mounts: Vec<Isometry2<f64>>,
    /// Which transforms are written.
    pub transforms: Transforms,
    /// H: so many arcs of each sensor stay drawn.
    pub history: usize,
    /// Another recording that is copied; [`McapSink::pass_through`] takes it in.
    pub passing: Option<Passing>,
}

impl Default for Options {
    /// Everything, for Foxglove, in a file, with frames `odom` and `base_link`, and H of the paper.
    fn default() -> Self {
        Self {
            kind: SchemaKind::default(),
            layout: Layout::default(),
            contents: Contents::default(),
            fixed_frame: FIXED_FRAME.to_owned(),
            robot_frame: ROBOT_FRAME.to_owned(),
            mounts: Vec::new(),
            transforms: Transforms::default(),
            history: 10,
            passing: None,
        }
    }
}

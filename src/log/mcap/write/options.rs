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

/// Names of frames, and what is written of how they lie to each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Frames {
    /// The frame of the echoes.
    pub fixed: String,
    /// The robot's own frame.
    pub robot: String,
    /// Where sensors sit on the robot, by their indices. Where the others sit follows from their readings.
    pub mounts: Vec<Isometry2<f64>>,
    /// Which transforms are written.
    pub transforms: Transforms,
}

impl Default for Frames {
    /// `odom` and `base_link`; all transforms.
    fn default() -> Self {
        Self {
            fixed: FIXED_FRAME.to_owned(),
            robot: ROBOT_FRAME.to_owned(),
            mounts: Vec::new(),
            transforms: Transforms::default(),
        }
    }
}

/// How a recording is written.
#[derive(Debug, Clone)]
pub struct Options {
    /// The kind of messages.
    pub kind: SchemaKind,
    /// How records are laid out; [`Layout::Immediate`] also hands everything on at each flush.
    pub layout: Layout,
    /// What is written.
    pub contents: Contents,
    /// The echoes are the consensus's, with the fields that it has besides.
    pub consensus: bool,
    /// The frames, as far as they are known beforehand.
    pub frames: Frames,
    /// H: so many arcs of each sensor stay drawn.
    pub history: usize,
    /// Where another recording is copied: within this time, in nanoseconds, its messages are put in order.
    pub pass_window: Option<u64>,
}

impl Default for Options {
    /// Everything of the median, for Foxglove, in a file, with the default frames, and H of the paper.
    fn default() -> Self {
        Self {
            kind: SchemaKind::default(),
            layout: Layout::default(),
            contents: Contents::default(),
            consensus: false,
            frames: Frames::default(),
            history: 10,
            pass_window: None,
        }
    }
}

//! What is written under which name.

use super::{
    content::{Color, Sort},
    options::{Contents, Options, Transforms},
    points::Points,
    schema::SchemaKind,
};
use crate::style;

/// Echoes as points, by sweep: the echo table.
pub const ECHOES: &str = "/atm/echoes";
/// Crossings as points, by sweep: the table of crossings.
pub const CROSSING_POINTS: &str = "/atm/crossings/points";

pub(super) const PATH_COLOR: Color = Color::new(style::PATH.on_dark, 0xff);

/// A topic.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Topic {
    /// Where the sensors sit on the robot.
    Mounts,
    /// Where the robot is, and sensors of which that is not known beforehand.
    Robot,
    Pose,
    Path,
    PathPoints,
    Echoes,
    /// The echoes so far.
    Map,
    Arcs,
    ArcPoints,
    Crossings,
    CrossingPoints,
}

impl Topic {
    pub(super) const ALL: [Self; 11] = [
        Self::Mounts,
        Self::Robot,
        Self::Pose,
        Self::Path,
        Self::PathPoints,
        Self::Echoes,
        Self::Map,
        Self::Arcs,
        Self::ArcPoints,
        Self::Crossings,
        Self::CrossingPoints,
    ];

    /// Transforms are looked for under these two names alone in ROS. Beside another recording's, those of another kind have names
    /// of their own.
    pub(super) fn name(self, options: &Options) -> String {
        let apart = self.is_transforms() && options.pass_window.is_some() && options.kind == SchemaKind::Foxglove;
        let name = match self {
            Self::Mounts => "/tf_static",
            Self::Robot => "/tf",
            Self::Pose => "/atm/pose",
            Self::Path => "/atm/path",
            Self::PathPoints => "/atm/path/points",
            Self::Echoes => ECHOES,
            Self::Map => "/atm/map",
            Self::Arcs => "/atm/arcs",
            Self::ArcPoints => "/atm/arcs/points",
            Self::Crossings => "/atm/crossings",
            Self::CrossingPoints => CROSSING_POINTS,
        };
        if apart { format!("/atm{name}") } else { name.to_owned() }
    }

    pub(super) const fn sort(self) -> Sort {
        match self {
            Self::Mounts | Self::Robot => Sort::Transforms,
            Self::Pose => Sort::Pose,
            Self::Path => Sort::Path,
            Self::Arcs | Self::Crossings => Sort::Scene,
            Self::PathPoints | Self::Echoes | Self::Map | Self::ArcPoints | Self::CrossingPoints => Sort::Cloud,
        }
    }

    /// What a cloud of the topic is made of.
    pub(super) const fn points(self, options: &Options) -> Points {
        match self {
            Self::Echoes if options.consensus => Points::Consensus,
            Self::Echoes => Points::Echoes,
            Self::CrossingPoints => Points::Crossings,
            _ => Points::Dots,
        }
    }

    pub(super) const fn is_transforms(self) -> bool {
        matches!(self, Self::Mounts | Self::Robot)
    }

    /// Whether the options ask for it.
    pub(super) fn is_wanted(self, options: &Options) -> bool {
        match self {
            Self::Crossings | Self::CrossingPoints => true,
            _ if options.contents == Contents::Crossings => false,
            Self::Mounts => options.frames.transforms == Transforms::All && !options.frames.mounts.is_empty(),
            Self::Robot => options.frames.transforms != Transforms::None,
            _ => true,
        }
    }
}

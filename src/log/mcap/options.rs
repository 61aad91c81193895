//! How a recording is read.

use super::clocks::ClockChoice;
use crate::{log::csv::PoseUse, pipeline::Defaults, track::PoseLimits, units::Scale};

/// How a recording is read.
#[derive(Debug, Clone)]
pub struct Options {
    /// Topics of readings; all there are where it is empty.
    pub range_topics: Vec<String>,
    /// The topic of the poses, instead of a choice.
    pub pose_topic: Option<String>,
    /// The frame of the poses, instead of a choice.
    pub fixed_frame: Option<String>,
    /// Which time of a message counts.
    pub clock: ClockChoice,
    /// How much later than others a message may be recorded and still be put in order, in nanoseconds.
    pub reorder: u64,
    /// Longest message that is read, in bytes.
    pub max_message: u64,
    /// The topics of transforms, with those of static ones around them; all there are where it is empty.
    pub tf_topics: Vec<String>,
    /// How near poses have to be, and how fast they may move.
    pub limits: PoseLimits,
    /// From raw ranges and limits to metres, instead of what the rig says.
    pub range_unit: Option<Scale>,
    /// What is made of the recording's own poses.
    pub poses: PoseUse,
    /// Whether a [`super::Tap`] is to be told all that the recording holds.
    pub everything: bool,
    /// What holds where neither rig nor recording says more.
    pub defaults: Defaults,
}

impl Options {
    /// 2 s, in nanoseconds.
    pub const REORDER: u64 = 2_000_000_000;
    /// 64 MiB.
    pub const MAX_MESSAGE: u64 = 64 << 20;
}

impl Default for Options {
    fn default() -> Self {
        Self {
            range_topics: Vec::new(),
            pose_topic: None,
            fixed_frame: None,
            clock: ClockChoice::Header,
            reorder: Self::REORDER,
            max_message: Self::MAX_MESSAGE,
            tf_topics: Vec::new(),
            limits: PoseLimits::default(),
            range_unit: None,
            poses: PoseUse::Needed,
            everything: false,
            defaults: Defaults::default(),
        }
    }
}

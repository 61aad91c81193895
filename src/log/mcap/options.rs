//! How a recording is read.

use super::clocks::ClockChoice;
use crate::{log::csv::PoseUse, pipeline::Defaults};

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
    /// A reading without a pose within this on both sides, in nanoseconds, has none.
    pub max_gap: u64,
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
            max_gap: 500_000_000,
            poses: PoseUse::Needed,
            everything: false,
            defaults: Defaults::default(),
        }
    }
}

//! How a recording is read.

use super::{clocks::ClockChoice, rigid::Rigid};
use crate::{log::csv::PoseUse, pipeline::Defaults, track::PoseLimits, units::Scale};

/// The axis of a sensor's frame along which it looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Boresight {
    /// Forward, as `sensor_msgs/Range` has it.
    #[default]
    X,
    /// To the left.
    Y,
    /// Upward; forward in frames of cameras (REP 103).
    Z,
    /// Backward.
    MinusX,
    /// To the right.
    MinusY,
    /// Downward.
    MinusZ,
}

impl Boresight {
    /// From the frame to one that looks along its x axis; `None` where it does.
    pub(super) fn rotation(self) -> Option<Rigid> {
        let (half, whole) = (std::f64::consts::FRAC_1_SQRT_2, 1.0);
        let quaternion = match self {
            Self::X => return None,
            Self::Y => [0.0, 0.0, half, half],
            Self::Z => [0.0, -half, 0.0, half],
            Self::MinusX => [0.0, 0.0, whole, 0.0],
            Self::MinusY => [0.0, 0.0, -half, half],
            Self::MinusZ => [0.0, half, 0.0, half],
        };
        Rigid::new([0.0; 3], quaternion).ok()
    }
}

/// How a recording is read.
#[derive(Debug, Clone)]
pub struct Options {
    /// Topics of readings; all there are where it is empty.
    pub range_topics: Vec<String>,
    /// Topics of `sensor_msgs/LaserScan` whose beams are cones.
    pub scan_topics: Vec<String>,
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
    /// Along which axis of their frames sensors look whose mounts come from the recording.
    pub boresight: Boresight,
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
            scan_topics: Vec::new(),
            pose_topic: None,
            fixed_frame: None,
            clock: ClockChoice::Header,
            reorder: Self::REORDER,
            max_message: Self::MAX_MESSAGE,
            tf_topics: Vec::new(),
            limits: PoseLimits::default(),
            boresight: Boresight::X,
            range_unit: None,
            poses: PoseUse::Needed,
            everything: false,
            defaults: Defaults::default(),
        }
    }
}

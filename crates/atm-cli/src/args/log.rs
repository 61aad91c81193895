//! How a log is to be read: what several commands take.

use std::sync::Arc;

use atm::{
    core::{Beam, RangeResolution},
    error::Result,
    intake::Defaults,
    job::{LogJob, McapWishes},
    log::{
        Input,
        csv::EmptyCell,
        format,
        mcap::{Boresight, ClockChoice},
    },
    rig::Rig,
    stamp,
    track::MotionLimit,
    units::Scale,
};
use clap::{Args, ValueEnum};

use super::values::{beam, bytes, duration, length_unit, max_speed};

/// A format of files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// A text table.
    Csv,
    /// A ROS or Foxglove recording.
    Mcap,
}

/// How a log is to be read.
#[derive(Debug, Args)]
pub struct LogArgs {
    /// The sensors: a built-in rig (nomad200, robond8) or a TOML file
    #[arg(long, value_name = "NAME|FILE")]
    pub rig: Option<String>,
    /// Poses from a second file: CSV t,x,y,yaw or TUM [default: the log's own]
    #[arg(long, value_name = "FILE")]
    pub poses: Option<String>,
    /// Drop a reading that has no pose within this on both sides [default: 0.5s, more where poses come less often and the robot
    /// hardly moves in between]
    #[arg(long, value_name = "T", value_parser = duration)]
    pub max_gap: Option<u64>,
    /// Drop a reading between poses that move faster than this
    #[arg(long, value_name = "V", default_value = "10m/s", value_parser = max_speed)]
    pub max_speed: MotionLimit,
    /// What an empty range cell is [default: no-echo in long tables, skip in wide ones]
    #[arg(long, value_enum)]
    pub empty: Option<Empty>,
    /// Full beam of sensors of which neither rig nor log says it
    #[arg(long, value_name = "A", default_value = "22.5deg", value_parser = beam)]
    pub fov: Beam<f64>,
    /// Recordings: topics of readings [default: all of sensor_msgs/Range]
    #[arg(long, value_name = "TOPIC", value_delimiter = ',')]
    pub range_topics: Vec<String>,
    /// Recordings: topics of sensor_msgs/LaserScan whose beams are a sonar's cones
    #[arg(long, value_name = "TOPIC", value_delimiter = ',')]
    pub scan_topics: Vec<String>,
    /// Recordings: topic of the poses [default: transforms, else odometry, else poses]
    #[arg(long, value_name = "TOPIC")]
    pub pose_topic: Option<String>,
    /// Recordings: topics of transforms, each with the static ones of its namespace [default: those of the readings' namespace]
    #[arg(long, value_name = "TOPIC", value_delimiter = ',')]
    pub tf_topics: Vec<String>,
    /// Recordings: frame of the poses [default: odom, else the topmost]
    #[arg(long, value_name = "FRAME")]
    pub fixed_frame: Option<String>,
    /// Recordings: which time of a message counts [default: header]
    #[arg(long, value_enum)]
    pub clock: Option<Clock>,
    /// Recordings: how much later than others a message may come and still be put in order [default: 2s]
    #[arg(long, value_name = "T", value_parser = duration)]
    pub reorder: Option<u64>,
    /// Recordings: axis of their frames along which sensors look [default: x]
    #[arg(long, value_enum, allow_hyphen_values = true)]
    pub boresight: Option<Axis>,
    /// Unit of ranges that are not in metres (cm, mm, in), and of the limits in a recording [default: the rig's, else m]
    #[arg(long, value_name = "UNIT", value_parser = length_unit)]
    pub range_unit: Option<Scale>,
    /// Recordings: longest message that is read, in bytes or with k, M, G [default: 64M]
    #[arg(long, value_name = "BYTES", value_parser = bytes)]
    pub max_message: Option<u64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Clock {
    /// The stamp in its header: when it was measured
    Header,
    /// When it was recorded
    Log,
    /// When it was sent
    Publish,
}

impl LogArgs {
    /// The flags for recordings that were given, as they are written.
    pub fn others(&self) -> Vec<String> {
        let mut words = Vec::new();
        if let Some(gap) = self.max_gap {
            words.push(format!("--max-gap {}s", stamp::text(i64::try_from(gap).unwrap_or(i64::MAX))));
        }
        if !self.tf_topics.is_empty() {
            words.push(format!("--tf-topics {}", self.tf_topics.join(",")));
        }
        if !self.scan_topics.is_empty() {
            words.push(format!("--scan-topics {}", self.scan_topics.join(",")));
        }
        if !self.range_topics.is_empty() {
            words.push(format!("--range-topics {}", self.range_topics.join(",")));
        }
        words.extend(self.pose_topic.iter().map(|topic| format!("--pose-topic {topic}")));
        words.extend(self.fixed_frame.iter().map(|frame| format!("--fixed-frame {frame}")));
        words.extend(
            self.clock.and_then(|clock| clock.to_possible_value()).map(|clock| format!("--clock {}", clock.get_name())),
        );
        words
    }

    /// How the log is to be read. `range_resolution` is what beats the rig's.
    pub fn job(
        &self,
        input: &str,
        from: Option<Format>,
        range_resolution: Option<RangeResolution<f64>>,
    ) -> Result<LogJob> {
        Ok(LogJob {
            input: input.to_owned(),
            parts: Vec::new(),
            opens: Input::open,
            from: from.map(format::Format::from),
            rig: self.rig.as_deref().map(Rig::load).transpose()?.map(Arc::new),
            poses: self.poses.clone(),
            max_gap: self.max_gap,
            max_speed: self.max_speed,
            empty: self.empty.map(EmptyCell::from),
            defaults: Defaults { field_of_view: Some(self.fov), range_resolution },
            mcap: McapWishes {
                range_topics: self.range_topics.clone(),
                scan_topics: self.scan_topics.clone(),
                pose_topic: self.pose_topic.clone(),
                tf_topics: self.tf_topics.clone(),
                fixed_frame: self.fixed_frame.clone(),
                clock: self.clock.map(ClockChoice::from),
                reorder: self.reorder,
                max_message: self.max_message,
                range_unit: self.range_unit,
                boresight: self.boresight.map(Boresight::from),
            },
        })
    }
}

impl From<Format> for format::Format {
    fn from(format: Format) -> Self {
        match format {
            Format::Csv => Self::Csv,
            Format::Mcap => Self::Mcap,
        }
    }
}

/// An axis of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Axis {
    /// Forward, as sensor_msgs/Range has it
    X,
    /// To the left
    Y,
    /// Upward; forward in frames of cameras
    Z,
    /// Backward
    #[value(name = "-x")]
    MinusX,
    /// To the right
    #[value(name = "-y")]
    MinusY,
    /// Downward
    #[value(name = "-z")]
    MinusZ,
}

impl From<Axis> for Boresight {
    fn from(axis: Axis) -> Self {
        match axis {
            Axis::X => Self::X,
            Axis::Y => Self::Y,
            Axis::Z => Self::Z,
            Axis::MinusX => Self::MinusX,
            Axis::MinusY => Self::MinusY,
            Axis::MinusZ => Self::MinusZ,
        }
    }
}

impl From<Clock> for ClockChoice {
    fn from(clock: Clock) -> Self {
        match clock {
            Clock::Header => Self::Header,
            Clock::Log => Self::Log,
            Clock::Publish => Self::Publish,
        }
    }
}

impl From<Empty> for EmptyCell {
    fn from(empty: Empty) -> Self {
        match empty {
            Empty::NoEcho => Self::NoEcho,
            Empty::Skip => Self::Skip,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Empty {
    /// A reading without an echo
    NoEcho,
    /// A sensor that did not fire
    Skip,
}

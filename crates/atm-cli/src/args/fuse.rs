use std::{num::NonZeroUsize, path::PathBuf};

use atm::{
    core::{Bounds, Consensus, DomainError, Held, MinAngle, OnNone, OnTwo, RangeResolution, TransversalMedian, Travel},
    echo::AnyEstimator,
    log::mcap::write::SchemaKind,
};
use clap::{Args, ValueEnum};

use super::{
    local_map::LocalMapArgs,
    log::{Format, LogArgs},
    values::{
        confidence, error_length, kind, min_angle, positive_duration, positive_length, positive_number,
        range_resolution, travel,
    },
};

#[derive(Debug, Args)]
#[command(after_help = "\
Recordings (MCAP) of ROS 2, ROS 1 and Foxglove need no more. \
Long tables have the columns t,sensor,range,x,y,yaw, wide ones t,x,y,yaw and one for each sensor; rigs may describe others. \
Out comes t,sensor,x,y,kind,range,azimuth,crossings,resolution,significance. For driving, --keep median,single: \
a reading without crossings falls back to the centre of its cone, and shuts openings as the cone does. \
With --estimator consensus the kinds are point, wall and center, and \
support,against,sigma_azimuth,sigma_range,normal_x,normal_y follow the other columns.")]
pub struct Fuse {
    /// The log: a path, or - for standard input. Several recordings are the parts of one, in their order; with --out-dir each is a
    /// log of its own
    #[arg(required = true, value_name = "INPUT")]
    pub inputs: Vec<String>,
    /// Where the echoes go: a path, or - for standard output
    #[arg(short, long, value_name = "OUT", default_value = "-", conflicts_with = "out_dir")]
    pub output: String,
    /// Fuse each log on its own, into a file of its name in this directory
    #[arg(long, value_name = "DIR", conflicts_with_all = ["crossings", "summary", "poses"])]
    pub out_dir: Option<PathBuf>,
    /// With --out-dir: logs that are fused at the same time [default: one for each core]
    #[arg(short, long, value_name = "N", requires = "out_dir")]
    pub jobs: Option<NonZeroUsize>,
    /// Format of the input, instead of what its content says
    #[arg(long, value_enum)]
    pub from: Option<Format>,
    /// Format of the output, instead of what its name says
    #[arg(long, value_enum)]
    pub to: Option<Format>,
    /// The messages of a recording that is written
    #[arg(long, value_enum, default_value = "foxglove")]
    pub schema: Schema,
    /// Copy all that the recording holds into the recording that is written
    #[arg(long)]
    pub passthrough: bool,
    #[command(flatten)]
    pub log: LogArgs,
    #[command(flatten)]
    pub local_map: LocalMapArgs,
    /// A reading leaves the local map after this time
    #[arg(long, value_name = "T", value_parser = positive_duration)]
    pub max_age: Option<u64>,
    /// A reading leaves the local map after this much path
    #[arg(long, value_name = "L", value_parser = travel)]
    pub max_travel: Option<Travel>,
    /// Skip a reading whose sensor moved less than this since its last one in the local map
    #[arg(long, value_name = "L", value_parser = positive_length)]
    pub min_step: Option<f64>,
    /// Skip a reading equal to its sensor's previous one, for rings that repeat held values: --held drop
    #[arg(long, conflicts_with = "held")]
    pub drop_held: bool,
    /// What becomes of a reading equal to its sensor's previous one
    #[arg(long, value_enum, default_value = "keep")]
    pub held: HeldOption,
    /// Who says where on its arc an echo came from
    #[arg(long, value_enum, default_value = "atm")]
    pub estimator: EstimatorOption,
    /// The least confidence of a point or wall of the consensus [default: 0.9]
    #[arg(long, value_name = "SHARE", value_parser = confidence)]
    pub confidence: Option<f64>,
    /// By how much ranges are wrong beyond their rounding, as a standard deviation, for the consensus [default: 0]
    #[arg(long, value_name = "L", value_parser = error_length)]
    pub range_error: Option<f64>,
    /// Crossings count from this angle on [default: 30deg]
    #[arg(long, value_name = "A", value_parser = min_angle, conflicts_with = "improvement")]
    pub min_angle: Option<MinAngle<f64>>,
    /// Choose the angle for this gain in resolution at the distance --at
    #[arg(long, value_name = "N", value_parser = positive_number, requires = "at")]
    pub improvement: Option<f64>,
    /// The distance for --improvement
    #[arg(long, value_name = "L", value_parser = positive_length, requires = "improvement")]
    pub at: Option<f64>,
    /// Quantisation step of the ranges; beats the rig's [default: the rig's, else 1in]
    #[arg(long, value_name = "L", value_parser = range_resolution)]
    pub range_resolution: Option<RangeResolution<f64>>,
    /// When echoes are reported
    #[arg(long, value_enum, default_value = "settled")]
    pub emit: Emit,
    /// What a reading without crossings gives
    #[arg(long, value_enum, default_value = "center")]
    pub on_none: NoneOption,
    /// What a reading with exactly two crossings gives
    #[arg(long, value_enum, default_value = "drop")]
    pub on_two: TwoOption,
    /// Write only these kinds of echoes [default: all]
    #[arg(long, value_name = "KIND", value_delimiter = ',', value_parser = kind)]
    pub keep: Vec<&'static str>,
    /// Also write every transversal crossing, as CSV, or as a recording where the name ends in .mcap
    #[arg(long, value_name = "FILE")]
    pub crossings: Option<String>,
    /// Stop at the first unusable record
    #[arg(long)]
    pub strict: bool,
    /// No progress and no closing summary
    #[arg(short, long)]
    pub quiet: bool,
    /// Write the counts as JSON
    #[arg(long, value_name = "FILE")]
    pub summary: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Schema {
    /// Foxglove's, in protobuf: for Foxglove, Lichtblick and Rerun
    Foxglove,
    /// ROS 2's: for RViz, and to be played back, as well
    Ros2,
}

impl From<Schema> for SchemaKind {
    fn from(schema: Schema) -> Self {
        match schema {
            Schema::Foxglove => Self::Foxglove,
            Schema::Ros2 => Self::Ros2,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Emit {
    /// When the reading leaves the local map, from every arc it met
    Settled,
    /// At the reading's arrival, from the arcs before it
    Latest,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum HeldOption {
    /// It is a reading like any other
    Keep,
    /// It is skipped
    Drop,
    /// Of a run of them the first stays, and the last before a change
    Edges,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum EstimatorOption {
    /// The median of the arc's transversal crossings
    Atm,
    /// Points and walls that the readings agree on, with their uncertainty
    Consensus,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum NoneOption {
    /// The arc's centre
    Center,
    /// No echo
    Drop,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum TwoOption {
    /// No echo
    Drop,
    /// The arc's centre
    Center,
    /// Their mean
    Mean,
}

impl From<NoneOption> for OnNone {
    fn from(option: NoneOption) -> Self {
        match option {
            NoneOption::Center => Self::Center,
            NoneOption::Drop => Self::Drop,
        }
    }
}

impl From<TwoOption> for OnTwo {
    fn from(option: TwoOption) -> Self {
        match option {
            TwoOption::Drop => Self::Drop,
            TwoOption::Center => Self::Center,
            TwoOption::Mean => Self::Mean,
        }
    }
}

impl Fuse {
    /// The estimator, for the smallest angle of crossings or the resolution that goes with it.
    pub fn estimator(&self, min_angle: MinAngle<f64>) -> Result<AnyEstimator, DomainError> {
        if self.estimator == EstimatorOption::Atm {
            let (on_none, on_two) = (self.on_none.into(), self.on_two.into());
            return Ok(AnyEstimator::Median(TransversalMedian { min_angle, on_none, on_two }));
        }
        let mut consensus = Consensus::new(min_angle);
        if let Some(confidence) = self.confidence {
            consensus = consensus.with_min_confidence(confidence)?;
        }
        consensus.with_range_error(self.range_error.unwrap_or(0.0)).map(AnyEstimator::Consensus)
    }

    /// The bounds on the local map.
    pub fn bounds(&self) -> Result<Bounds<f64>, DomainError> {
        let mut bounds = Bounds::NONE.with_held(match self.held {
            _ if self.drop_held => Held::Drop,
            HeldOption::Keep => Held::Keep,
            HeldOption::Drop => Held::Drop,
            HeldOption::Edges => Held::Edges,
        });
        if let Some(age) = self.max_age {
            bounds = bounds.with_max_age(age);
        }
        if let Some(travel) = self.max_travel {
            bounds = bounds.with_max_travel(travel);
        }
        match self.min_step {
            Some(step) => bounds.with_min_step(step),
            None => Ok(bounds),
        }
    }
}

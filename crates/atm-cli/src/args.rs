//! What can stand on the command line.

use std::{fmt::Display, str::FromStr};

use atm::{
    core::{Beam, Bounds, DomainError, Kind, MinAngle, OnNone, OnTwo, RangeResolution, Travel},
    storage::LatestSlots,
    units,
};
use clap::{Args, Parser, Subcommand, ValueEnum};

/// Sharp echo points from wide-beam range sensors on a moving robot: the arc-transversal median.
#[derive(Debug, Parser)]
#[command(name = "atm", version, max_term_width = 100, after_help = UNITS)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
}

const UNITS: &str = "\
Lengths take m, cm, mm, in or ft; angles deg or rad; times s or ms; speeds m/s or in/s; rates Hz. \
A bare number is SI, except for angles, which need their unit.

Exit status: 0 done; 1 failed; 2 wrong arguments; 3 done, but part of the input was unusable.";

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Turn a log of range readings into echo points
    Fuse(Box<Fuse>),
    /// What resolution to expect at a distance, and what it takes: equation (2) both ways
    Plan(Plan),
    /// What is in a log
    Info(Info),
}

/// A format of files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// A text table.
    Csv,
    /// A ROS or Foxglove recording (not supported yet).
    Mcap,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Long tables have the columns t,sensor,range,x,y,yaw, wide ones t,x,y,yaw and one for each sensor; rigs may describe others. \
Out comes t,sensor,x,y,kind,range,azimuth,crossings,resolution,significance. For driving, --keep median,single: \
a reading without crossings falls back to the centre of its cone, and shuts openings as the cone does.")]
pub struct Fuse {
    /// The log: a path, or - for standard input
    pub input: String,
    /// Where the echoes go: a path, or - for standard output
    #[arg(short, long, value_name = "OUT", default_value = "-")]
    pub output: String,
    /// Format of the input, instead of what its content says
    #[arg(long, value_enum)]
    pub from: Option<Format>,
    /// Format of the output, instead of what its name says
    #[arg(long, value_enum)]
    pub to: Option<Format>,
    #[command(flatten)]
    pub log: LogArgs,
    /// H: the local map holds the last H readings of every sensor
    #[arg(long, value_name = "N", default_value = "10", value_parser = history)]
    pub history: usize,
    /// A reading leaves the local map after this time
    #[arg(long, value_name = "T", value_parser = positive_duration)]
    pub max_age: Option<u64>,
    /// A reading leaves the local map after this much path
    #[arg(long, value_name = "L", value_parser = travel)]
    pub max_travel: Option<Travel>,
    /// Skip a reading whose sensor moved less than this since its last one in the local map
    #[arg(long, value_name = "L", value_parser = positive_length)]
    pub min_step: Option<f64>,
    /// Skip a reading equal to its sensor's previous one, for rings that repeat held values
    #[arg(long)]
    pub drop_held: bool,
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
    pub keep: Vec<Kind>,
    /// Also write every transversal crossing, as CSV
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

/// How a log is to be read.
#[derive(Debug, Args)]
pub struct LogArgs {
    /// The sensors: a built-in rig (nomad200, robond8) or a TOML file
    #[arg(long, value_name = "NAME|FILE")]
    pub rig: Option<String>,
    /// Poses from a second file: CSV t,x,y,yaw or TUM [default: the log's own]
    #[arg(long, value_name = "FILE")]
    pub poses: Option<String>,
    /// Drop a reading that has no pose within this on both sides
    #[arg(long, value_name = "T", default_value = "0.5s", value_parser = duration)]
    pub max_gap: u64,
    /// What an empty range cell is [default: no-echo in long tables, skip in wide ones]
    #[arg(long, value_enum)]
    pub empty: Option<Empty>,
    /// Full beam of sensors of which neither rig nor log says it
    #[arg(long, value_name = "A", default_value = "22.5deg", value_parser = beam)]
    pub fov: Beam<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Empty {
    /// A reading without an echo
    NoEcho,
    /// A sensor that did not fire
    Skip,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Emit {
    /// When the reading leaves the local map, from every arc it met
    Settled,
    /// At the reading's arrival, from the arcs before it
    Latest,
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

#[derive(Debug, Args)]
#[command(group = clap::ArgGroup::new("angle").required(true).args(["min_angle", "improvement"]))]
pub struct Plan {
    /// Distance of what is to be seen
    #[arg(long, value_name = "L", value_parser = positive_length)]
    pub distance: f64,
    /// Full beam
    #[arg(long, value_name = "A", default_value = "22.5deg", value_parser = beam)]
    pub fov: Beam<f64>,
    /// Quantisation step of the ranges
    #[arg(long, value_name = "L", default_value = "1in", value_parser = range_resolution)]
    pub range_resolution: RangeResolution<f64>,
    /// Smallest crossing angle: what does it give?
    #[arg(long, value_name = "A", value_parser = min_angle)]
    pub min_angle: Option<MinAngle<f64>>,
    /// Wanted gain in resolution: what angle does it take?
    #[arg(long, value_name = "N", value_parser = positive_number)]
    pub improvement: Option<f64>,
    /// Speed of the robot
    #[arg(long, value_name = "V", value_parser = positive_speed, requires = "rate")]
    pub speed: Option<f64>,
    /// Readings of one sensor in a second
    #[arg(long, value_name = "F", value_parser = positive_rate, requires = "speed")]
    pub rate: Option<f64>,
    /// As JSON, in SI units
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub struct Info {
    /// The log: a path, or - for standard input
    pub input: String,
    /// Format of the input, instead of what its content says
    #[arg(long, value_enum)]
    pub from: Option<Format>,
    #[command(flatten)]
    pub log: LogArgs,
    /// As JSON, in SI units
    #[arg(long)]
    pub json: bool,
}

fn history(text: &str) -> Result<usize, String> {
    let most = LatestSlots::<f64>::MAX_HISTORY;
    match text.parse() {
        Ok(history) if (1..=most).contains(&history) => Ok(history),
        _ => Err(format!("{text} is no whole number from 1 to {most}")),
    }
}

fn kind(text: &str) -> Result<Kind, String> {
    let kinds = Kind::ALL.map(Kind::name).join(", ");
    Kind::ALL.into_iter().find(|kind| kind.name() == text).ok_or_else(|| format!("{text} is none of {kinds}"))
}

fn words(error: impl Display) -> String {
    error.to_string()
}

fn positive(value: f64, text: &str) -> Result<f64, String> {
    if value > 0.0 { Ok(value) } else { Err(format!("{text} is not positive")) }
}

fn positive_number(text: &str) -> Result<f64, String> {
    match f64::from_str(text) {
        Ok(number) if number.is_finite() => positive(number, text),
        _ => Err(format!("{text} is no number")),
    }
}

fn positive_length(text: &str) -> Result<f64, String> {
    positive(units::length(text).map_err(words)?, text)
}

fn positive_speed(text: &str) -> Result<f64, String> {
    positive(units::speed(text).map_err(words)?, text)
}

fn positive_rate(text: &str) -> Result<f64, String> {
    positive(units::rate(text).map_err(words)?, text)
}

fn duration(text: &str) -> Result<u64, String> {
    u64::try_from(units::duration(text).map_err(words)?).map_err(|_| format!("{text} is negative"))
}

fn positive_duration(text: &str) -> Result<u64, String> {
    match duration(text)? {
        0 => Err(format!("{text} is not positive")),
        nanoseconds => Ok(nanoseconds),
    }
}

fn travel(text: &str) -> Result<Travel, String> {
    Travel::from_metres(units::length(text).map_err(words)?).map_err(words)
}

fn range_resolution(text: &str) -> Result<RangeResolution<f64>, String> {
    RangeResolution::new(units::length(text).map_err(words)?).map_err(words)
}

fn beam(text: &str) -> Result<Beam<f64>, String> {
    Beam::new(units::angle(text).map_err(words)?).map_err(words)
}

fn min_angle(text: &str) -> Result<MinAngle<f64>, String> {
    MinAngle::new(units::angle(text).map_err(words)?).map_err(words)
}

impl Fuse {
    /// The bounds on the local map.
    pub fn bounds(&self) -> Result<Bounds<f64>, DomainError> {
        let mut bounds = Bounds::NONE.with_held_dropped(self.drop_held);
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

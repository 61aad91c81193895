//! How a log is to be read: what several commands take.

use atm::core::Beam;
use clap::{Args, ValueEnum};

use super::values::{beam, duration};

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

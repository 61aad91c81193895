use atm::core::{MinAngle, RangeResolution};
use atm_lab::view::{Method, Units};
use clap::{Args, ValueEnum};

use super::{
    fuse::HeldOption,
    local_map::LocalMapArgs,
    log::{Format, LogArgs},
    values::{error_length, min_angle, parameter, range_resolution},
};

#[derive(Debug, Args)]
#[command(after_help = "\
The file needs no network and no other file: mail it, keep it beside the log, open it in any browser of 2023 or later. Space plays; the \
arrows step, with Shift by ten; Home and End go to the ends; + and - zoom, F fits; ? lists all keys. \
Logs of more than 300,000 readings are thinned, and the page says so.")]
pub struct View {
    /// The log: a path, or - for standard input
    pub input: String,
    /// The page [default: the log's name with .html, in this directory]
    #[arg(short, long, value_name = "OUT.html")]
    pub output: Option<String>,
    /// Open the page in the browser
    #[arg(long)]
    pub open: bool,
    /// What the panels can show [default: all; of standard input, centerline and atm]
    #[arg(long, value_name = "METHOD", value_delimiter = ',', value_enum)]
    pub methods: Vec<MethodOption>,
    /// The walls: a built-in world or a TOML file
    #[arg(long, value_name = "NAME|FILE")]
    pub world: Option<String>,
    /// A parameter of the world, such as opening=30in
    #[arg(long, value_name = "KEY=VALUE", value_parser = parameter, requires = "world")]
    pub set: Vec<(String, String)>,
    /// Where each reading's echo really came from, as atm simulate --truth writes it
    #[arg(long, value_name = "FILE")]
    pub truth: Option<String>,
    /// Units of the lengths shown [default: those of the sensors]
    #[arg(long, value_enum)]
    pub units: Option<UnitsOption>,
    /// Format of the input, instead of what its content says
    #[arg(long, value_enum)]
    pub from: Option<Format>,
    #[command(flatten)]
    pub log: LogArgs,
    #[command(flatten)]
    pub local_map: LocalMapArgs,
    /// Crossings count from this angle on
    #[arg(long, value_name = "A", default_value = "30deg", value_parser = min_angle)]
    pub min_angle: MinAngle<f64>,
    /// Quantisation step of the ranges; beats the rig's [default: the rig's, else 1in]
    #[arg(long, value_name = "L", value_parser = range_resolution)]
    pub range_resolution: Option<RangeResolution<f64>>,
    /// By how much ranges are wrong beyond their rounding, as a standard deviation, for the consensus
    #[arg(long, value_name = "L", default_value = "0m", value_parser = error_length)]
    pub range_error: f64,
    /// What becomes of a reading equal to its sensor's previous one
    #[arg(long, value_enum, default_value = "keep")]
    pub held: HeldOption,
    /// No progress and no closing words
    #[arg(short, long)]
    pub quiet: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MethodOption {
    /// The centre of each cone
    Centerline,
    /// The arc-transversal median
    Atm,
    /// Points and walls that the readings agree on
    Consensus,
}

impl From<MethodOption> for Method {
    fn from(option: MethodOption) -> Self {
        match option {
            MethodOption::Centerline => Self::Centerline,
            MethodOption::Atm => Self::Atm,
            MethodOption::Consensus => Self::Consensus,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum UnitsOption {
    /// Metres and centimetres
    Metric,
    /// Inches
    Inches,
}

impl From<UnitsOption> for Units {
    fn from(option: UnitsOption) -> Self {
        match option {
            UnitsOption::Metric => Self::Metric,
            UnitsOption::Inches => Self::Inches,
        }
    }
}

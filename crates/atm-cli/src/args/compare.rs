use atm::core::{MinAngle, RangeResolution};
use atm_lab::compare::Name;
use clap::Args;

use super::{
    local_map::LocalMapArgs,
    log::{Format, LogArgs},
    values::{error_length, min_angle, parameter, positive_length, range_resolution},
};

#[derive(Debug, Args)]
#[command(after_help = "\
Methods: atm as in the paper, and with its options: atm-median-single (only these kinds), atm-none-drop, atm-two-center, \
atm-two-mean, atm-latest; consensus, which is atm fuse --estimator consensus, and consensus-point-wall; centerline, interleave, intersections, mckerrow, rcd, tbf, directional-maximum; and the grids uniform, \
moravec-elfes, elfes, himm, voting, morphology, range-layer. What does not apply to a method is shown as -, and null in JSON. \
Without --world the methods are compared with one another.")]
pub struct Compare {
    /// The log: a path, or - for standard input
    pub input: String,
    /// Where the points should lie: a built-in world or a TOML file
    #[arg(long, value_name = "NAME|FILE")]
    pub world: Option<String>,
    /// A parameter of the world, such as opening=30in
    #[arg(long, value_name = "KEY=VALUE", value_parser = parameter, requires = "world")]
    pub set: Vec<(String, String)>,
    /// Where each reading's echo really came from, as atm simulate --truth writes it
    #[arg(long, value_name = "FILE", requires = "world")]
    pub truth: Option<String>,
    /// Only these methods [default: all]
    #[arg(long, value_name = "NAME", value_delimiter = ',', value_parser = method)]
    pub methods: Vec<Name>,
    /// As JSON, in SI units
    #[arg(long)]
    pub json: bool,
    /// Draw each method into this directory as SVG, and all of them side by side as SVG and PNG
    #[arg(long, value_name = "DIR")]
    pub draw: Option<String>,
    /// Write each grid into this directory, as map.pgm and map.yaml for ROS's map server, and as map.png
    #[arg(long, value_name = "DIR")]
    pub map: Option<String>,
    /// Width of the cells of every grid [default: 5cm; himm 10cm]
    #[arg(long, value_name = "L", value_parser = positive_length)]
    pub cell: Option<f64>,
    /// Format of the input, instead of what its content says
    #[arg(long, value_enum)]
    pub from: Option<Format>,
    #[command(flatten)]
    pub log: LogArgs,
    #[command(flatten)]
    pub local_map: LocalMapArgs,
    /// Crossings count from this angle on in atm [default: 30deg]
    #[arg(long, value_name = "A", value_parser = min_angle)]
    pub min_angle: Option<MinAngle<f64>>,
    /// By how much ranges are wrong beyond their rounding, as a standard deviation, for consensus
    #[arg(long, value_name = "L", value_parser = error_length, default_value = "0m")]
    pub range_error: f64,
    /// Quantisation step of the ranges; beats the rig's [default: the rig's, else 1in]
    #[arg(long, value_name = "L", value_parser = range_resolution)]
    pub range_resolution: Option<RangeResolution<f64>>,
    /// Skip a reading equal to its sensor's previous one, for rings that repeat held values
    #[arg(long)]
    pub drop_held: bool,
    /// No progress
    #[arg(short, long)]
    pub quiet: bool,
}

fn method(text: &str) -> Result<Name, String> {
    let known = || Name::ALL.map(Name::word).join(", ");
    Name::from_word(text).ok_or_else(|| format!("{text} is none of {}", known()))
}

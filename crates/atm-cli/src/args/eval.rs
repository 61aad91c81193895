use clap::Args;

use super::{log::LogArgs, values::parameter};

#[derive(Debug, Args)]
#[command(after_help = "\
A table needs the columns x and y; azimuth errors need t, sensor, range and azimuth as well, and a truth file from the same \
simulation. A point over 6 in from every surface is a ghost; the surface that counts for coverage is what the beams of --log \
could have seen, else those of a nomad200 on the world's own path.")]
pub struct Eval {
    /// The points: a table or a recording such as atm fuse writes, or - for standard input
    pub input: String,
    /// Where they should lie: a built-in world or a TOML file
    #[arg(long, value_name = "NAME|FILE")]
    pub world: String,
    /// A parameter of the world, such as opening=30in
    #[arg(long, value_name = "KEY=VALUE", value_parser = parameter)]
    pub set: Vec<(String, String)>,
    /// Where each reading's echo really came from, as atm simulate --truth writes it
    #[arg(long, value_name = "FILE")]
    pub truth: Option<String>,
    /// The log from which the points come: coverage is about what its beams could have seen
    #[arg(long = "log", value_name = "LOG", requires = "rig")]
    pub drive: Option<String>,
    #[command(flatten)]
    pub log: LogArgs,
    /// As JSON, in SI units
    #[arg(long)]
    pub json: bool,
}

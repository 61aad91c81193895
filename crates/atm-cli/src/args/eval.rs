use clap::Args;

use super::values::setting;

#[derive(Debug, Args)]
#[command(after_help = "\
The table needs the columns x and y; azimuth errors need t, sensor, range and azimuth as well, and a truth file from the same \
simulation. A point over 6 in from every surface is a ghost; the surface that counts for coverage is what the beams of the \
world's own path could have seen.")]
pub struct Eval {
    /// The points: a table such as atm fuse writes, or - for standard input
    pub input: String,
    /// Where they should lie: a built-in world or a TOML file
    #[arg(long, value_name = "NAME|FILE")]
    pub world: String,
    /// A parameter of the world, such as opening=30in
    #[arg(long, value_name = "KEY=VALUE", value_parser = setting)]
    pub set: Vec<(String, String)>,
    /// Where each reading's echo really came from, as atm simulate --truth writes it
    #[arg(long, value_name = "FILE")]
    pub truth: Option<String>,
    /// As JSON, in SI units
    #[arg(long)]
    pub json: bool,
}

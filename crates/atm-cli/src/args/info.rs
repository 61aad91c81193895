use clap::Args;

use super::log::{Format, LogArgs};

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

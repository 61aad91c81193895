//! Which readings the local map holds.

use atm::{pipeline::History, storage::LatestSlots};
use clap::{Args, ValueEnum};

use super::values::positive_length;

#[derive(Debug, Clone, Args)]
pub struct LocalMapArgs {
    /// The local map spans the travel that crossings of --min-angle take at this distance [default: the sensors' largest
    /// range, at most 100in]
    #[arg(long, value_name = "L", value_parser = positive_length)]
    pub reach: Option<f64>,
    /// The most readings of each sensor in the local map, spaced evenly over its travel; a number without --reach: the last N
    /// of every sensor, wherever they were taken, as in the paper [default: auto, which is 50]
    #[arg(long, value_name = "N|auto", value_parser = history)]
    pub history: Option<HistoryOption>,
    /// paper: the last 10 readings of every sensor, for a robot at 5 in/s that reads once a second
    #[arg(long, value_enum, conflicts_with_all = ["reach", "history"])]
    pub preset: Option<Preset>,
}

/// What --history says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HistoryOption {
    /// As many as serve.
    Auto,
    /// So many.
    Most(usize),
}

/// A number of readings, or `auto`.
fn history(text: &str) -> Result<HistoryOption, String> {
    let most = LatestSlots::<f64>::MAX_HISTORY;
    match text.parse() {
        _ if text == "auto" => Ok(HistoryOption::Auto),
        Ok(history) if (1..=most).contains(&history) => Ok(HistoryOption::Most(history)),
        _ => Err(format!("{text} is neither auto nor in 1..={most}")),
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Preset {
    /// The last 10 readings of every sensor
    Paper,
}

impl LocalMapArgs {
    /// The rule.
    pub fn history(&self) -> History {
        let most = match self.history {
            Some(HistoryOption::Most(most)) => Some(most),
            Some(HistoryOption::Auto) | None => None,
        };
        match (self.preset, self.reach, most) {
            (Some(Preset::Paper), ..) => History::PAPER,
            (None, None, Some(count)) => History::ByCount(count),
            (None, reach, most) => History::ByTravel { reach, most: most.unwrap_or(History::MOST) },
        }
    }
}

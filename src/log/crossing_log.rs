//! Crossings in, from a table or a recording.

use super::{
    Input,
    crossing_table::{Crossing, CrossingTable},
    format::Format,
    mcap::McapCrossings,
};
use crate::error::{Problem, Result};

/// Crossings of arcs, read one after another in bounded memory.
pub enum CrossingLog {
    /// A table.
    Table(Box<CrossingTable>),
    /// A recording.
    Mcap(Box<McapCrossings>),
}

impl CrossingLog {
    /// Reads an input that was opened for `path` and is of the format.
    ///
    /// # Errors
    /// A table as [`CrossingTable::new`], a recording as [`McapCrossings::open`].
    pub fn new(path: &str, format: Format, input: Input) -> Result<Self> {
        Ok(match format {
            Format::Csv => Self::Table(Box::new(CrossingTable::new(input)?)),
            Format::Mcap => Self::Mcap(Box::new(McapCrossings::open(path, input)?)),
        })
    }

    /// The next usable crossing, `None` at the end; those that can't be used are passed over and go to `problems`.
    ///
    /// # Errors
    /// The file can't be read on.
    pub fn next_crossing(&mut self, problems: &mut dyn FnMut(Problem)) -> Result<Option<Crossing>> {
        match self {
            Self::Table(table) => table.next_crossing(problems),
            Self::Mcap(crossings) => crossings.next_crossing(problems),
        }
    }
}

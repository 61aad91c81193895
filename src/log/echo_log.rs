//! Echoes in, from a table or a recording.

use super::{
    Input,
    echo_table::{EchoTable, Estimate},
    format::Format,
    mcap::McapEchoes,
};
use crate::error::{Problem, Result};

/// Points at which a method says that something stands, read one after another in bounded memory.
pub enum EchoLog {
    /// A table.
    Table(Box<EchoTable>),
    /// A recording.
    Mcap(Box<McapEchoes>),
}

impl EchoLog {
    /// Opens the file at `path`, whichever it is by its content; `-` is standard input.
    ///
    /// # Errors
    /// It can't be read; a table as [`EchoTable::new`], a recording as [`McapEchoes::open`].
    pub fn open(path: &str) -> Result<Self> {
        let (format, input) = Input::open(path)?.recognize(path)?;
        Self::new(path, format, input)
    }

    /// The same of an input that was opened for `path` and is of the format.
    ///
    /// # Errors
    /// As [`EchoLog::open`].
    pub fn new(path: &str, format: Format, input: Input) -> Result<Self> {
        Ok(match format {
            Format::Csv => Self::Table(Box::new(EchoTable::new(input)?)),
            Format::Mcap => Self::Mcap(Box::new(McapEchoes::open(path, input)?)),
        })
    }

    /// The next usable point, `None` at the end; those that can't be used are passed over and go to `problems`.
    ///
    /// # Errors
    /// The file can't be read on.
    pub fn next_estimate(&mut self, problems: &mut dyn FnMut(Problem)) -> Result<Option<Estimate>> {
        match self {
            Self::Table(table) => table.next_estimate(problems),
            Self::Mcap(echoes) => echoes.next_estimate(problems),
        }
    }

    /// The usable points one after another, up to the first error; those that can't be used go to `problems`.
    pub fn estimates(mut self, mut problems: impl FnMut(Problem)) -> impl Iterator<Item = Result<Estimate>> {
        let mut failed = false;
        std::iter::from_fn(move || {
            let next = if failed { None } else { self.next_estimate(&mut problems).transpose() };
            failed |= matches!(next, Some(Err(_)));
            next
        })
    }
}

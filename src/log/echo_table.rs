//! Echoes in: the table that [`super::echoes`] writes, and any other with the columns `x` and `y`.
use std::{collections::BTreeSet, sync::Arc};

use nalgebra::Point2;

use super::{
    Input, Next,
    cell::{Fault, check_width, number},
    columns::{Columns, list},
    table::{Record, Table},
};
use crate::{
    error::{Problem, Reason, Result},
    rig::TableFormat,
    stamp,
};

/// Most different words (sensor ids, kinds) that are held once for all their rows; further ones are held row by row.
const WORDS: usize = 65_536;

/// A point at which a method says that something stands, in the fixed frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Where, in metres; finite.
    pub position: Point2<f64>,
    /// The reading it belongs to: its time in nanoseconds and its sensor's id. `None` for points of a grid or a map.
    pub key: Option<(i64, Arc<str>)>,
    /// Where on the reading's arc: angle from the sensor's axis, counter-clockwise, in radians; finite.
    pub azimuth: Option<f64>,
    /// The reading, in metres; finite.
    pub range: Option<f64>,
    /// How it was found.
    pub kind: Option<Arc<str>>,
}

/// A table of points that is read row by row, in bounded memory.
///
/// It needs the columns `x` and `y`; `t` with `sensor`, `kind`, `range` and `azimuth` are read where they are there, and
/// an empty cell in one of them says nothing. Other columns are ignored.
pub struct EchoTable {
    table: Table,
    layout: Layout,
    words: Words,
}

impl EchoTable {
    /// Reads the header.
    ///
    /// # Errors
    /// The file can't be read, is empty or no text; a column is missing or there twice.
    pub fn new(input: Input) -> Result<Self> {
        Self::with_kinds(input, "kind")
    }

    /// The same for a table in which another column says what a point is, such as `cause` in a truth file.
    ///
    /// # Errors
    /// As [`EchoTable::new`].
    pub fn with_kinds(input: Input, kind: &str) -> Result<Self> {
        let mut table = Table::new(input.reader, input.name)?;
        table.set_delimiter(None)?;
        let columns = Columns::read(&mut table, &TableFormat::default())?;
        Ok(Self { layout: Layout::find(&columns, kind)?, table, words: Words::default() })
    }

    /// The next usable row, `None` at the end; rows that can't be used are passed over and go to `problems`.
    ///
    /// # Errors
    /// The file can't be read on.
    pub fn next_estimate(&mut self, problems: &mut dyn FnMut(Problem)) -> Result<Option<Estimate>> {
        loop {
            match self.table.next_record(problems)? {
                Next::End => return Ok(None),
                Next::Unusable => continue,
                Next::Record => {}
            }
            match self.layout.read(&self.table, &mut self.words) {
                Ok(estimate) => return Ok(Some(estimate)),
                Err(fault) => problems(fault.at(&self.table)),
            }
        }
    }
}

/// Which column is which.
struct Layout {
    x: usize,
    y: usize,
    /// Time and sensor.
    key: Option<(usize, usize)>,
    azimuth: Option<usize>,
    range: Option<usize>,
    kind: Option<usize>,
    /// Number of columns a record must have.
    width: usize,
}

impl Layout {
    fn find(columns: &Columns, kind: &str) -> Result<Self> {
        let (x, y) = match (columns.find("x")?, columns.find("y")?) {
            (Some(x), Some(y)) => (x, y),
            (x, y) => {
                let missing: Vec<_> = [(x, "x"), (y, "y")].into_iter().filter(|(at, _)| at.is_none()).collect();
                let missing = list(&missing.into_iter().map(|(_, name)| name).collect::<Vec<_>>());
                return Err(columns.error(&format!("not a table of points: no column {missing}")));
            }
        };
        let key = columns.find("t")?.zip(columns.find("sensor")?);
        let (azimuth, range, kind) = (columns.find("azimuth")?, columns.find("range")?, columns.find(kind)?);
        let last = [key.map(|(t, sensor)| t.max(sensor)), azimuth, range, kind].into_iter().flatten();
        let width = 1 + last.fold(x.max(y), usize::max);
        Ok(Self { x, y, key, azimuth, range, kind, width })
    }

    /// Reads the record that is in the table.
    fn read(&self, table: &Table, words: &mut Words) -> Result<Estimate, Fault> {
        let record = check_width(table, self.width)?;
        let optional = |column: Option<usize>, name| {
            let cell = column.map(|column| cell(record, column)).filter(|cell| !cell.is_empty());
            cell.map(|cell| finite(cell, name)).transpose()
        };
        let position = Point2::new(finite(cell(record, self.x), "x")?, finite(cell(record, self.y), "y")?);
        let (azimuth, range) = (optional(self.azimuth, "azimuth")?, optional(self.range, "range")?);
        // Words last: a record that can't be used makes none known.
        let key = self.key.map(|(t, sensor)| key(cell(record, t), cell(record, sensor), words)).transpose()?;
        let kind = self.kind.and_then(|kind| words.take(cell(record, kind)));
        Ok(Estimate { position, key: key.flatten(), azimuth, range, kind })
    }
}

/// The reading a row belongs to, where it says both its time and its sensor.
pub(super) fn key(t: &[u8], sensor: &[u8], words: &mut Words) -> Result<Option<(i64, Arc<str>)>, Fault> {
    if t.is_empty() {
        return Ok(None);
    }
    let t = stamp::parse(t, stamp::SECOND_SHIFT).ok_or_else(|| Fault::cell(Reason::BadNumber, "t", t))?;
    Ok(words.take(sensor).map(|sensor| (t, sensor)))
}

pub(super) fn cell(record: Record<'_>, column: usize) -> &[u8] {
    record.get(column).unwrap_or_default()
}

pub(super) fn finite(cell: &[u8], column: &str) -> Result<f64, Fault> {
    let value = number(cell).filter(|value| value.is_finite());
    value.ok_or_else(|| Fault::cell(Reason::BadNumber, column, cell))
}

/// Words that rows share.
#[derive(Default)]
pub(super) struct Words(BTreeSet<Arc<str>>);

impl Words {
    /// The word in a cell; `None` where it is empty.
    fn take(&mut self, cell: &[u8]) -> Option<Arc<str>> {
        if cell.is_empty() {
            return None;
        }
        let word = String::from_utf8_lossy(cell);
        if let Some(held) = self.0.get(&*word) {
            return Some(Arc::clone(held));
        }
        let held: Arc<str> = Arc::from(word);
        if self.0.len() < WORDS {
            self.0.insert(Arc::clone(&held));
        }
        Some(held)
    }
}

#[cfg(test)]
mod tests;

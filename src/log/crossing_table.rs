//! Crossings in: the table that [`super::echoes`] writes beside the echoes.
use std::sync::Arc;

use nalgebra::Point2;

use super::{
    Input, Next,
    cell::{Fault, check_width},
    columns::{Columns, list},
    echo_table::{Words, cell, finite, key},
    table::Table,
};
use crate::{
    error::{Problem, Reason, Result},
    rig::TableFormat,
};

/// A crossing as it stands in a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Crossing {
    /// The reading on whose arc it counts: its time in nanoseconds and its sensor's id.
    pub on: (i64, Arc<str>),
    /// The reading whose arc crosses that one.
    pub with: (i64, Arc<str>),
    /// Where, in metres, in the fixed frame; finite.
    pub position: Point2<f64>,
}

/// The columns that are read.
const COLUMNS: [&str; 6] = ["t", "sensor", "t_other", "sensor_other", "x", "y"];

/// A table of crossings that is read row by row, in bounded memory.
pub struct CrossingTable {
    table: Table,
    /// Where [`COLUMNS`] stand.
    columns: [usize; COLUMNS.len()],
    words: Words,
}

impl CrossingTable {
    /// Reads the header.
    ///
    /// # Errors
    /// The file can't be read, is empty or no text; a column is missing or there twice.
    pub fn new(input: Input) -> Result<Self> {
        let mut table = Table::new(input.reader, input.name)?;
        table.set_delimiter(None)?;
        let header = Columns::read(&mut table, &TableFormat::default())?;
        let (mut columns, mut missing) = ([0; COLUMNS.len()], Vec::new());
        for (column, name) in columns.iter_mut().zip(COLUMNS) {
            match header.find(name)? {
                Some(found) => *column = found,
                None => missing.push(name),
            }
        }
        if !missing.is_empty() {
            return Err(header.error(&format!("not a table of crossings: no column {}", list(&missing))));
        }
        Ok(Self { table, columns, words: Words::default() })
    }

    /// The next usable row, `None` at the end; rows that can't be used are passed over and go to `problems`.
    ///
    /// # Errors
    /// The file can't be read on.
    pub fn next_crossing(&mut self, problems: &mut dyn FnMut(Problem)) -> Result<Option<Crossing>> {
        loop {
            match self.table.next_record(problems)? {
                Next::End => return Ok(None),
                Next::Unusable => continue,
                Next::Record => {}
            }
            match self.read() {
                Ok(crossing) => return Ok(Some(crossing)),
                Err(fault) => problems(fault.at(&self.table)),
            }
        }
    }

    fn read(&mut self) -> Result<Crossing, Fault> {
        let width = 1 + self.columns.into_iter().fold(0, usize::max);
        let record = check_width(&self.table, width)?;
        let [t, sensor, t_other, sensor_other, x, y] = self.columns.map(|column| cell(record, column));
        let position = Point2::new(finite(x, "x")?, finite(y, "y")?);
        let mut needed = |name: &'static str, t, sensor| {
            let key = key(t, sensor, &mut self.words)?;
            key.ok_or_else(|| Fault::cell(Reason::MissingField, name, b""))
        };
        Ok(Crossing { on: needed("t", t, sensor)?, with: needed("t_other", t_other, sensor_other)?, position })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::{
        echoes::CROSSING_COLUMNS,
        tests::{input, message},
    };

    #[test]
    fn rows_are_read_and_those_that_cannot_be_used_are_named() {
        let rows = "1.5,\"a,b\",2,c,3,-4,0.1,0.9\n1,a,,c,3,4,0,1\n1,a,2,c,x,4,0,1\n";
        let mut table = CrossingTable::new(input(format!("{CROSSING_COLUMNS}\n{rows}"))).unwrap();
        let mut problems = Vec::new();
        let mut next = || table.next_crossing(&mut |problem| problems.push(problem.to_string())).unwrap();
        let expected = Crossing {
            on: (1_500_000_000, "a,b".into()),
            with: (2_000_000_000, "c".into()),
            position: Point2::new(3.0, -4.0),
        };
        assert_eq!(next(), Some(expected));
        assert_eq!(next(), None);
        assert_eq!(problems, ["log.csv:3: missing_field: t_other \"\"", "log.csv:4: bad_number: x \"x\""]);
    }

    #[test]
    fn missing_columns_are_named() {
        let refused = message(CrossingTable::new(input("t,sensor,t_other,x\n")));
        assert!(refused.contains("no column sensor_other, y"), "{refused}");
    }
}

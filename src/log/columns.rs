//! The columns of a table by name.
use super::{Next, cell::number, table::Table};
use crate::{
    error::{Error, Place, Result},
    rig::TableFormat,
};

use super::cell::{PoseCells, Quantity};

/// Most columns that a message lists.
const LISTED: usize = 24;
/// Most characters of a column's name that a message shows.
const NAME_SHOWN: usize = 40;

/// The names of a table's columns, from its header or from its format.
pub struct Columns {
    names: Vec<String>,
    place: Place,
    /// Commas do not separate cells: they are decimal points.
    pub(super) comma: bool,
}

impl Columns {
    /// Reads the header, or takes the names the format gives; where it gives names and has a header, the names count.
    pub fn read(table: &mut Table, format: &TableFormat) -> Result<Self> {
        let commented = if format.header && format.columns.is_none() { commented_header(table)? } else { None };
        if let Some(names) = commented {
            return Ok(Self { names, place: table.place(), comma: table.delimiter() != b',' });
        }
        if format.header {
            let mut too_long = None;
            match table.next_record(&mut |problem| too_long = Some(problem.value))? {
                Next::Record => {}
                Next::Unusable => {
                    return Err(table.format_error(format!("the header is {}", too_long.unwrap_or_default())));
                }
                Next::End => return Err(table.format_error("holds no header, only blank lines and comments")),
            }
        }
        let names = match (&format.columns, format.header) {
            (Some(names), _) => names.clone(),
            (None, true) => table.record().fields().map(|name| String::from_utf8_lossy(name).into_owned()).collect(),
            (None, false) => return Err(table.format_error("a table without a header needs the names of its columns")),
        };
        Ok(Self { names, place: table.place(), comma: table.delimiter() != b',' })
    }

    /// The names in order.
    pub(super) fn names(&self) -> &[String] {
        &self.names
    }

    /// The name of one column.
    pub(super) fn name(&self, index: usize) -> &str {
        self.names.get(index).map_or("", String::as_str)
    }

    /// The column of this name. Errors where there are two.
    pub fn find(&self, name: &str) -> Result<Option<usize>> {
        let mut found = self.names.iter().enumerate().filter(|(_, column)| *column == name).map(|(index, _)| index);
        match (found.next(), found.next()) {
            (_, Some(_)) => Err(self.error(&format!("two columns are named `{name}`"))),
            (first, None) => Ok(first),
        }
    }

    /// The columns of the pose; `Err` inside holds the names of those that are missing.
    pub(super) fn pose(&self, format: &TableFormat) -> Result<Result<PoseCells, Vec<&'static str>>> {
        let found = [("x", self.find("x")?), ("y", self.find("y")?), ("yaw", self.find("yaw")?)];
        if let [(_, Some(x)), (_, Some(y)), (_, Some(yaw))] = found {
            let (length, angle) = (Quantity::length(format.pose, self.comma), Quantity::angle(format.yaw, self.comma));
            return Ok(Ok(PoseCells { x, y, yaw, length, angle }));
        }
        Ok(Err(found.into_iter().filter(|(_, at)| at.is_none()).map(|(name, _)| name).collect()))
    }

    /// An error about the columns, which it lists.
    pub fn error(&self, message: &str) -> Error {
        let listed = list(&self.names);
        // A first line of numbers is a file without a header.
        let numbers = self.names.iter().all(|name| number(name.as_bytes()).is_some());
        let hint = match numbers {
            true => "; a table without a header needs a rig whose [log] section names the columns",
            false => "",
        };
        Error::Format { place: self.place.clone(), message: format!("{message}; the columns are: {listed}{hint}") }
    }
}

/// The names in the comment right above a first record that has none, as `numpy.savetxt` writes its header: as many as the record
/// has fields, the time `t` among them.
fn commented_header(table: &mut Table) -> Result<Option<Vec<String>>> {
    let delimiter = table.delimiter();
    let fields = |line: &[u8]| -> Vec<Vec<u8>> {
        let cells = line.split(|byte| *byte == delimiter || (delimiter == b' ' && *byte == b'\t'));
        let cells = cells.map(|cell| cell.trim_ascii().to_vec());
        cells.filter(|cell| delimiter != b' ' || !cell.is_empty()).collect()
    };
    let first = fields(table.first_line()?);
    // A first record that names the time is the header.
    let is_header = first.iter().any(|cell| cell == b"t");
    let Some(names) = table.comment().filter(|_| !is_header && first.len() > 1).map(fields) else { return Ok(None) };
    let names: Vec<String> = names.iter().map(|name| String::from_utf8_lossy(name).into_owned()).collect();
    Ok((names.len() == first.len() && names.iter().any(|name| name == "t")).then_some(names))
}

/// Names in a row, long ones and many of them cut short.
pub fn list(names: &[impl AsRef<str>]) -> String {
    let mut listed = Vec::new();
    for name in names.iter().take(LISTED) {
        let name = name.as_ref();
        let shown: String = name.chars().take(NAME_SHOWN).flat_map(char::escape_debug).collect();
        let cut = if name.chars().nth(NAME_SHOWN).is_some() { "…" } else { "" };
        listed.push(format!("{shown}{cut}"));
    }
    if names.len() > LISTED {
        listed.push(format!("… ({} in all)", names.len()));
    }
    listed.join(", ")
}

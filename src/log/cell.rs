//! Single cells of a table: numbers, poses, and how a bad one is shown.
use std::fmt::Write;

use memchr::memchr2;

use super::table::{Record, Table};
use crate::{
    error::{Problem, Reason},
    track::Pose,
    units::Scale,
};

/// Most characters of a cell that a message shows.
const SHOWN: usize = 40;

/// Why a cell, and with it mostly its record, can't be used.
#[derive(Debug, PartialEq)]
pub(super) struct Fault {
    reason: Reason,
    value: String,
}

impl Fault {
    /// A fault of a whole record.
    pub(super) fn new(reason: Reason, value: String) -> Self {
        Self { reason, value }
    }

    /// A fault of one cell: its column, and its text.
    pub(super) fn cell(reason: Reason, column: &str, cell: &[u8]) -> Self {
        Self::new(reason, format!("{column} {}", shorten(cell)))
    }

    /// The fault with the place of the table's last record.
    pub(super) fn at(self, table: &Table) -> Problem {
        Problem { reason: self.reason, place: table.place(), value: self.value }
    }
}

/// A cell's text in quotes, with control characters escaped, and cut where it is long.
pub(super) fn shorten(cell: &[u8]) -> String {
    // Four bytes are the longest character.
    let text = String::from_utf8_lossy(&cell[..cell.len().min(4 * (SHOWN + 1))]);
    let mut shown = String::from("\"");
    for (index, character) in text.chars().enumerate() {
        if index == SHOWN {
            shown.push('…');
            break;
        }
        // A `String` takes whatever is written.
        let _ = write!(shown, "{}", character.escape_debug());
    }
    shown.push('"');
    shown
}

/// Reads a number. NaN and ±Inf only where they are spelled: digits that overflow are no number.
#[inline]
pub(super) fn number(cell: &[u8]) -> Option<f64> {
    let value: f64 = fast_float2::parse(cell).ok()?;
    if value.is_finite() {
        return Some(value);
    }
    // `nan` and `inf` in any spelling have an n, digits have none.
    memchr2(b'n', b'N', cell)?;
    Some(if value.is_nan() { f64::NAN } else { value })
}

/// A number in SI units. What overflows by its unit is no number either.
#[inline]
pub(super) fn scaled(raw: f64, scale: Scale) -> Option<f64> {
    let value = scale.apply(raw);
    (value.is_finite() || !raw.is_finite()).then_some(value)
}

/// Refuses a record that ends before the last of `needed` columns.
#[inline]
pub(super) fn check_width(table: &Table, needed: usize) -> Result<Record<'_>, Fault> {
    let record = table.record();
    if record.len() >= needed {
        return Ok(record);
    }
    let mut value = format!("{} fields, {needed} needed", record.len());
    let lines = table.lines_of_record();
    if lines > 1 {
        let _ = write!(value, "; it extends over {lines} lines: is a quote left open?");
    }
    Err(Fault::new(Reason::MissingField, value))
}

/// The columns of a pose, and their units.
#[derive(Debug, Clone, Copy)]
pub(super) struct PoseCells {
    pub x: usize,
    pub y: usize,
    pub yaw: usize,
    pub length: Scale,
    pub angle: Scale,
}

impl PoseCells {
    /// Number of columns a record must have to hold the pose.
    pub(super) fn width(&self) -> usize {
        1 + self.x.max(self.y).max(self.yaw)
    }

    #[inline]
    pub(super) fn read(&self, record: Record<'_>) -> Result<Pose, Fault> {
        Ok(Pose {
            x: coordinate(record, self.x, "x", self.length)?,
            y: coordinate(record, self.y, "y", self.length)?,
            yaw: coordinate(record, self.yaw, "yaw", self.angle)?,
        })
    }
}

/// One finite number of a pose.
#[inline]
pub(super) fn coordinate(record: Record<'_>, index: usize, column: &str, scale: Scale) -> Result<f64, Fault> {
    let cell = record.get(index).unwrap_or_default();
    match number(cell).and_then(|raw| scaled(raw, scale)) {
        Some(value) if value.is_finite() => Ok(value),
        Some(_) => Err(Fault::cell(Reason::BadPose, column, cell)),
        None => Err(Fault::cell(Reason::BadNumber, column, cell)),
    }
}

#[cfg(test)]
mod tests;

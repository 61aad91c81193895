//! Single cells of a table: numbers, poses, and how a bad one is shown.
use std::fmt::Write;

use memchr::memchr2;

use super::table::{Record, Table};
use crate::{
    error::{Problem, Reason},
    track::Pose,
    units::{self, Scale, UnitError},
};

/// Most characters of a cell that a message shows.
const SHOWN: usize = 40;

/// Why a cell, and with it mostly its record, can't be used.
#[derive(Debug, PartialEq)]
pub struct Fault {
    reason: Reason,
    value: String,
}

impl Fault {
    /// A fault of a whole record.
    pub fn new(reason: Reason, value: String) -> Self {
        Self { reason, value }
    }

    /// A fault of one cell: its column, and its text.
    pub fn cell(reason: Reason, column: &str, cell: &[u8]) -> Self {
        Self::new(reason, format!("{column} {}", shorten(cell)))
    }

    /// The fault with the place of the table's last record.
    pub fn at(self, table: &Table) -> Problem {
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
pub fn number(cell: &[u8]) -> Option<f64> {
    if let Some(value) = short_number(cell) {
        return Some(value);
    }
    let value: f64 = fast_float2::parse(cell).ok()?;
    if value.is_finite() {
        return Some(value);
    }
    // `nan` and `inf` in any spelling have an n, digits have none.
    memchr2(b'n', b'N', cell)?;
    Some(if value.is_nan() { f64::NAN } else { value })
}

/// Powers of ten that are exact in an `f64`, as far as they are needed.
const TENS: [f64; MOST_DIGITS] = [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14];
/// Digits that any `f64` holds.
const MOST_DIGITS: usize = 15;

/// The ordinary case of [`number`]: a sign or none, and up to 15 digits with a point or none among them. Both the digits and
/// the power of ten are exact then, so that their quotient is rounded once (W. D. Clinger, *How to read floating point
/// numbers accurately*, PLDI 1990).
#[inline]
fn short_number(cell: &[u8]) -> Option<f64> {
    let (negative, text) = match cell {
        [b'-', text @ ..] => (true, text),
        text => (false, text),
    };
    if text.len() > MOST_DIGITS + 1 {
        return None;
    }
    let (mut digits, mut point) = (0u64, None);
    for (at, &byte) in text.iter().enumerate() {
        match byte {
            b'0'..=b'9' => digits = digits * 10 + u64::from(byte - b'0'),
            b'.' if point.is_none() => point = Some(at),
            _ => return None,
        }
    }
    let magnitude = match point {
        None if (1..=MOST_DIGITS).contains(&text.len()) => digits as f64,
        Some(at) if text.len() > 1 => digits as f64 / TENS.get(text.len() - 1 - at)?,
        _ => return None,
    };
    Some(if negative { -magnitude } else { magnitude })
}

/// A number in SI units. What overflows by its unit is no number either.
#[inline]
pub(super) fn scaled(raw: f64, scale: Scale) -> Option<f64> {
    let value = scale.apply(raw);
    (value.is_finite() || !raw.is_finite()).then_some(value)
}

/// Whether a text is a number with a unit behind it: `551cm`, `-3.5 deg`.
pub(super) fn is_measured(text: &str) -> bool {
    let (first, last) = (text.bytes().next(), text.bytes().next_back());
    first.is_some_and(|byte| byte.is_ascii_digit() || b"+-.".contains(&byte))
        && last.is_some_and(|byte| byte.is_ascii_alphabetic())
}

/// A quantity as a cell of a table may hold it: a number in the table's unit, or one with a unit of its own.
#[derive(Debug, Clone, Copy)]
pub(super) struct Quantity {
    /// The table's unit.
    pub scale: Scale,
    /// Reads a number with a unit.
    own: fn(&str) -> Result<f64, UnitError>,
    /// A comma is a decimal point: it does not separate cells.
    pub comma: bool,
}

impl Quantity {
    pub(super) fn length(scale: Scale, comma: bool) -> Self {
        Self { scale, own: units::length, comma }
    }

    pub(super) fn angle(scale: Scale, comma: bool) -> Self {
        Self { scale, own: units::angle, comma }
    }

    /// The number as it stands in the cell; `None` where it is none, or has a unit.
    #[inline]
    pub(super) fn raw(&self, cell: &[u8]) -> Option<f64> {
        number(cell).or_else(|| self.with_comma(cell))
    }

    #[cold]
    fn with_comma(&self, cell: &[u8]) -> Option<f64> {
        let at = cell.iter().position(|byte| *byte == b',').filter(|_| self.comma && !cell.contains(&b'.'))?;
        let mut cell = cell.to_vec();
        *cell.get_mut(at)? = b'.';
        number(&cell)
    }

    /// The quantity in SI; `None` where the cell holds none, or one too large.
    #[inline]
    pub(super) fn read(&self, cell: &[u8]) -> Option<f64> {
        match self.raw(cell) {
            Some(raw) => scaled(raw, self.scale),
            None => self.measured(cell),
        }
    }

    /// The quantity of a cell with a unit.
    #[cold]
    pub(super) fn measured(&self, cell: &[u8]) -> Option<f64> {
        let text = std::str::from_utf8(cell).ok().filter(|text| is_measured(text))?;
        if self.comma && text.contains(',') && !text.contains('.') {
            return (self.own)(&text.replacen(',', ".", 1)).ok();
        }
        (self.own)(text).ok()
    }
}

/// Refuses a record that ends before the last of `needed` columns.
#[inline]
pub fn check_width(table: &Table, needed: usize) -> Result<Record<'_>, Fault> {
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
    pub length: Quantity,
    pub angle: Quantity,
}

impl PoseCells {
    /// Number of columns a record must have to hold the pose.
    pub(super) fn width(&self) -> usize {
        1 + self.x.max(self.y).max(self.yaw)
    }

    /// Whether the record has nothing in all three: of another table, joined with this one.
    pub(super) fn are_blank(&self, record: Record<'_>) -> bool {
        [self.x, self.y, self.yaw].iter().all(|column| record.get(*column).is_some_and(<[u8]>::is_empty))
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

/// The last pose that was read, with its text: the readings of a sweep have the same.
#[derive(Debug, Default)]
pub(super) struct LastPose {
    text: Vec<u8>,
    pose: Option<Pose>,
}

impl LastPose {
    /// [`PoseCells::read`], where the text is another one.
    #[inline]
    pub(super) fn read(&mut self, cells: &PoseCells, record: Record<'_>) -> Result<Pose, Fault> {
        let (first, last) = (cells.x.min(cells.y).min(cells.yaw), cells.x.max(cells.y).max(cells.yaw));
        let text = record.span(first, last).filter(|_| last - first == 2);
        if let (Some(pose), Some(text)) = (self.pose, text)
            && text == self.text
        {
            return Ok(pose);
        }
        self.pose = None;
        let pose = cells.read(record)?;
        if let Some(text) = text {
            self.text.clear();
            self.text.extend_from_slice(text);
            self.pose = Some(pose);
        }
        Ok(pose)
    }
}

/// One finite number of a pose.
#[inline]
pub(super) fn coordinate(record: Record<'_>, index: usize, column: &str, as_a: Quantity) -> Result<f64, Fault> {
    let cell = record.get(index).unwrap_or_default();
    match as_a.read(cell) {
        Some(value) if value.is_finite() => Ok(value),
        Some(_) => Err(Fault::cell(Reason::BadPose, column, cell)),
        None => Err(Fault::cell(Reason::BadNumber, column, cell)),
    }
}

#[cfg(test)]
mod tests;

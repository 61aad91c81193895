//! The times of a table: numbers, numbers with a unit, dates, and times of day.

use jiff::{Timestamp, civil, tz::TimeZone};

use super::cell::is_measured;
use crate::{stamp, units};

/// Nanoseconds in a day, and in half of one.
const DAY: i64 = 86_400_000_000_000;
const HALF_DAY: i64 = DAY / 2;

/// Reads the times of one table, in nanoseconds.
#[derive(Debug, Clone)]
pub(super) struct Times {
    /// Decimal shift from the table's unit to nanoseconds.
    shift: i32,
    /// A comma is a decimal point.
    comma: bool,
    /// The last time of day, and the midnights before it.
    day: Option<i64>,
    midnights: i64,
}

impl Times {
    pub(super) fn new(shift: i32, comma: bool) -> Self {
        Self { shift, comma, day: None, midnights: 0 }
    }

    /// The time in a cell; `None` where it is none.
    #[inline]
    pub(super) fn read(&mut self, cell: &[u8]) -> Option<i64> {
        stamp::parse(cell, self.shift).or_else(|| self.read_other(cell))
    }

    /// What is no plain number: `12,5` where commas do not separate cells, `12.5s`, `2024-05-01T12:34:00Z`, `12:34:00.5`.
    #[cold]
    fn read_other(&mut self, cell: &[u8]) -> Option<i64> {
        let text = std::str::from_utf8(cell).ok()?;
        if self.comma && text.contains(',') && !text.contains(['.', ':']) {
            return stamp::parse(text.replacen(',', ".", 1).as_bytes(), self.shift);
        }
        if text.contains(':') {
            return date(text).or_else(|| self.time_of_day(text));
        }
        is_measured(text).then(|| units::duration(text).ok()).flatten()
    }

    /// A time of day, from the first day's midnight on: half a day back is the next day.
    fn time_of_day(&mut self, text: &str) -> Option<i64> {
        let time: civil::Time = text.parse().ok()?;
        let seconds = i64::from(time.hour()) * 3600 + i64::from(time.minute()) * 60 + i64::from(time.second());
        let t = seconds * 1_000_000_000 + i64::from(time.subsec_nanosecond());
        if self.day.is_some_and(|last| t < last - HALF_DAY) {
            self.midnights += 1;
        }
        self.day = Some(t);
        self.midnights.checked_mul(DAY)?.checked_add(t)
    }
}

/// A date with its time (RFC 3339, ISO 8601), since 1970. Without an offset it is taken for UTC: what counts are differences.
fn date(text: &str) -> Option<i64> {
    let timestamp = match text.parse::<Timestamp>() {
        Ok(timestamp) => timestamp,
        Err(_) => TimeZone::UTC.to_timestamp(text.parse().ok()?).ok()?,
    };
    i64::try_from(timestamp.as_nanosecond()).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(cells: &[&str]) -> Vec<Option<i64>> {
        let mut times = Times::new(9, true);
        cells.iter().map(|cell| times.read(cell.as_bytes())).collect()
    }

    const SECOND: i64 = 1_000_000_000;

    #[test]
    fn dates_are_read_to_the_nanosecond_whatever_their_offset() {
        let may = 1_714_566_840 * SECOND;
        let cells = ["2024-05-01T12:34:00.000Z", "2024-05-01 12:34:00", "2024-05-01T14:34:00.000000001+02:00"];
        assert_eq!(read(&cells), [Some(may), Some(may), Some(may + 1)]);
    }

    #[test]
    fn times_of_day_go_on_behind_midnight() {
        let t = (23 * 3600 + 59 * 60 + 59) * SECOND;
        let cells = ["23:59:59.5", "00:00:00.25", "00:00:00.125", "12:00:00", "23:00:00", "01:00"];
        let expected = [
            t + SECOND / 2,
            DAY + SECOND / 4,
            DAY + SECOND / 8,
            DAY + HALF_DAY,
            DAY + DAY / 24 * 23,
            2 * DAY + DAY / 24,
        ];
        assert_eq!(read(&cells), expected.map(Some));
    }

    #[test]
    fn units_and_commas_are_read_where_there_are_any() {
        assert_eq!(
            read(&["1,5", "1.5", "250ms", "2min"]),
            [SECOND * 3 / 2, SECOND * 3 / 2, SECOND / 4, 120 * SECOND].map(Some)
        );
    }

    #[test]
    fn what_is_no_time_is_none() {
        let cells = ["", "nan", "12:34:xx", "25:00:00", "2024-13-01T00:00:00Z", "1,2,3", "s", "2024-05-01", "5m", "::"];
        assert_eq!(read(&cells), [None; 10]);
    }
}

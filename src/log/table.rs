//! Text tables as a stream of records, in bounded memory.
//!
//! Quotes are read as `csv-core` reads them, and lines without a quote stay where they are; comments and blank lines are passed over here, so that each record's line
//! and byte are those it really begins at.
mod quotes;

use std::{cell::Cell, io::Read, sync::Arc};

use csv_core::{ReadRecordResult, ReaderBuilder};
use memchr::{memchr, memchr2, memrchr2};

use self::quotes::Quotes;
pub use super::record::Record;
use super::{Next, buffer::Buffer, line};
use crate::error::{Error, Place, Problem, Reason, Result};

/// Longest record that is read, in bytes, its line end aside.
pub const MAX_RECORD: usize = 1 << 20;
/// Most fields a record may have.
pub const MAX_FIELDS: usize = 131_072;

/// Bytes that tell the encoding.
const MARK: usize = 4;
/// Delimiters that are looked for in a header.
const DELIMITERS: [u8; 3] = [b',', b';', b'\t'];

/// How the reading of one record ended.
enum Outcome {
    Complete,
    TooLong,
}

/// A table that is read record by record. Its memory is bounded by [`MAX_RECORD`] and [`MAX_FIELDS`].
pub struct Table {
    buffer: Buffer,
    /// Line of the next unused byte, from 1.
    line: u64,
    /// The last byte used was a carriage return that ended a line: a newline right after belongs to it.
    after_return: bool,
    delimiter: u8,
    /// The delimiter is a run of blanks.
    blanks: bool,
    parser: csv_core::Reader,
    /// The last record lies in the buffer, and is so many bytes long with the end of its line.
    in_place: Option<usize>,
    /// Otherwise: its fields one after the other. And where each ends.
    fields: Vec<u8>,
    ends: Vec<usize>,
    field_count: usize,
    record_line: u64,
    record_byte: u64,
    /// The last comment before the first record, without its mark.
    comment: Option<Vec<u8>>,
    /// After so many reads of the buffer, the file's bytes up to here belong to complete records: see [`Table::drained`].
    complete: Cell<(u64, u64)>,
}

impl Table {
    /// A table over `reader`, whose name in messages is `name`; comma-separated until [`Table::set_delimiter`] says otherwise.
    ///
    /// Reads the first bytes. A byte-order mark is passed over. Errors where nothing can be read, where the file is empty, and
    /// where it is UTF-16.
    pub fn new(reader: Box<dyn Read + Send>, name: Arc<str>) -> Result<Self> {
        let mut table = Self {
            buffer: Buffer::new(reader, name),
            line: 1,
            after_return: false,
            delimiter: b',',
            blanks: false,
            parser: parser(b','),
            in_place: None,
            fields: vec![0; 1024],
            ends: vec![0; 64],
            field_count: 0,
            record_line: 1,
            record_byte: 0,
            comment: None,
            complete: Cell::new((0, 0)),
        };
        table.check_encoding()?;
        Ok(table)
    }

    /// Sets the delimiter; `b' '` stands for runs of blanks and tabs, which count once. `None` looks for the most frequent of
    /// comma, semicolon and tab in the first record, and takes blanks where there is none of them.
    ///
    /// To be called before the first record is read.
    pub fn set_delimiter(&mut self, delimiter: Option<u8>) -> Result<()> {
        let delimiter = match delimiter {
            Some(delimiter) => delimiter,
            None => delimiter_of(self.first_line()?),
        };
        self.parser = parser(delimiter);
        self.delimiter = delimiter;
        self.blanks = delimiter == b' ';
        if self.blanks {
            self.buffer.turn_tabs_to_blanks();
        }
        Ok(())
    }

    /// What separates cells; `b' '` stands for runs of blanks and tabs.
    pub fn delimiter(&self) -> u8 {
        self.delimiter
    }

    /// The comment that was passed over last before the first record, without its mark; `None` without one, or where it is
    /// longer than a buffer.
    pub fn comment(&self) -> Option<&[u8]> {
        self.comment.as_deref()
    }

    /// The line of the next record, without using it; as much of it as fits the buffer, and empty at the end of the file.
    pub fn first_line(&mut self) -> Result<&[u8]> {
        self.skip_to_record()?;
        let mut searched = 0;
        loop {
            let rest = self.buffer.rest();
            if let Some(at) = memchr2(b'\n', b'\r', &rest[searched..]) {
                return Ok(&self.buffer.rest()[..searched + at]);
            }
            searched = rest.len();
            if !self.buffer.fill()? {
                return Ok(self.buffer.rest());
            }
        }
    }

    /// Reads the next record. One that is too long is passed over, and reported as a problem.
    pub fn next_record(&mut self, problems: &mut dyn FnMut(Problem)) -> Result<Next> {
        loop {
            if !self.skip_to_record()? {
                return Ok(Next::End);
            }
            self.record_line = self.line;
            self.record_byte = self.buffer.position();
            if self.read_line() {
                if self.is_blank() {
                    continue;
                }
                return Ok(Next::Record);
            }
            match self.read_record()? {
                Outcome::Complete => {}
                Outcome::TooLong => {
                    problems(self.pass_over()?);
                    return Ok(Next::Unusable);
                }
            }
            if self.blanks {
                self.drop_empty_fields();
            }
            if !self.is_blank() {
                return Ok(Next::Record);
            }
        }
    }

    /// A line of nothing but blanks is a blank line.
    fn is_blank(&self) -> bool {
        self.field_count < 2 && self.record().get(0).is_none_or(<[u8]>::is_empty)
    }

    /// The record that was read last.
    #[inline]
    pub fn record(&self) -> Record<'_> {
        let ends = self.ends.get(..self.field_count).unwrap_or_default();
        match self.in_place {
            Some(length) => Record { bytes: self.buffer.used(length), ends, gap: 1 },
            None => Record { bytes: &self.fields, ends, gap: 0 },
        }
    }

    /// Where the last record begins.
    pub fn place(&self) -> Place {
        Place { file: self.buffer.name().clone(), line: self.record_line, byte: self.record_byte }
    }

    /// Writes [`Table::place`] over another place, without a new reference to the name where it is the same.
    #[inline]
    pub(super) fn write_place(&self, place: &mut Place) {
        if !Arc::ptr_eq(&place.file, self.buffer.name()) {
            place.file = self.buffer.name().clone();
        }
        place.line = self.record_line;
        place.byte = self.record_byte;
    }

    /// Lines the last record extends over: more than 1 where a quoted field holds line ends.
    pub fn lines_of_record(&self) -> u64 {
        (self.line - self.record_line).max(1)
    }

    /// Whether the next record has to be waited for: what was read from the file so far holds no complete one.
    pub fn drained(&self) -> bool {
        if self.buffer.ended() {
            return self.buffer.rest().is_empty();
        }
        // Asked after every record, but searched once for each read of the buffer where nothing is quoted or left out.
        let (fills, end) = self.complete.get();
        if fills == self.buffer.fills() {
            return self.buffer.position() >= end;
        }
        let rest = self.buffer.rest();
        if memchr2(b'"', b'#', rest).is_some() {
            return self.holds_no_record(rest);
        }
        let lines = rest.get(..memrchr2(b'\n', b'\r', rest).unwrap_or(0)).unwrap_or_default();
        let end = self.buffer.position() + lines.trim_ascii_end().len() as u64;
        self.complete.set((self.buffer.fills(), end));
        self.buffer.position() >= end
    }

    /// Whether there is no complete record in `rest`, line by line.
    fn holds_no_record(&self, mut rest: &[u8]) -> bool {
        let mut record = Quotes::default();
        while let Some(at) = memchr2(b'\n', b'\r', rest) {
            let (mut line, after) = rest.split_at(at);
            if record.is_new() && self.blanks {
                line = line.trim_ascii_start();
            }
            if !(record.is_new() && line.starts_with(b"#")) {
                record.take(line, self.delimiter);
            }
            if !record.are_open() {
                if !record.may_be_blank() {
                    return false;
                }
                record = Quotes::default();
            }
            rest = after.get(1..).unwrap_or_default();
        }
        true
    }

    /// Bytes used so far.
    pub fn position(&self) -> u64 {
        self.buffer.position()
    }

    /// An error about the file's form, at the last record.
    pub fn format_error(&self, message: impl Into<String>) -> Error {
        Error::Format { place: self.place(), message: message.into() }
    }

    fn check_encoding(&mut self) -> Result<()> {
        while self.buffer.rest().len() < MARK && self.buffer.fill()? {}
        let rest = self.buffer.rest();
        let mark = &rest[..rest.len().min(MARK)];
        if mark.starts_with(b"\xff\xfe") || mark.starts_with(b"\xfe\xff") || memchr(0, mark).is_some() {
            return Err(self.format_error("is UTF-16, or no text at all: convert it to UTF-8"));
        }
        if mark.starts_with(b"\xef\xbb\xbf") {
            self.buffer.use_up(3);
        }
        match self.buffer.peek()? {
            Some(_) => Ok(()),
            None => Err(self.format_error("is empty")),
        }
    }

    /// Passes over line ends and comments; `false` at the end of the file.
    fn skip_to_record(&mut self) -> Result<bool> {
        while let Some(byte) = self.buffer.peek()? {
            match byte {
                b'\n' | b'\r' => self.use_line_end(byte),
                b'#' => self.skip_comment()?,
                b' ' if self.blanks => self.buffer.use_up(1),
                _ => {
                    self.after_return = false;
                    return Ok(true);
                }
            }
        }
        Ok(false)
    }

    /// Uses the line end that comes next, and counts it; CR LF counts once.
    fn use_line_end(&mut self, byte: u8) {
        if !(byte == b'\n' && self.after_return) {
            self.line += 1;
        }
        self.after_return = byte == b'\r';
        self.buffer.use_up(1);
    }

    /// Passes over a comment; before the first record it is kept, as it may be the header.
    fn skip_comment(&mut self) -> Result<()> {
        if self.field_count > 0 {
            return self.skip_line();
        }
        while memchr2(b'\n', b'\r', self.buffer.rest()).is_none() && self.buffer.fill()? {}
        let rest = self.buffer.rest();
        let end = memchr2(b'\n', b'\r', rest).unwrap_or(rest.len());
        let whole = !self.buffer.full() || end < rest.len();
        self.comment = rest.get(1..end).filter(|_| whole).map(<[u8]>::to_vec);
        self.skip_line()
    }

    /// Passes over the rest of a line, up to its end.
    fn skip_line(&mut self) -> Result<()> {
        self.after_return = false;
        while self.buffer.peek()?.is_some() {
            let rest = self.buffer.rest();
            let end = memchr2(b'\n', b'\r', rest);
            let count = end.unwrap_or(rest.len());
            self.buffer.use_up(count);
            if end.is_some() {
                break;
            }
        }
        Ok(())
    }

    /// Reads a record where it lies, if it is an ordinary line that is complete in the buffer.
    #[inline]
    fn read_line(&mut self) -> bool {
        // The first record is the parser's, which knows of byte-order marks.
        if self.blanks || self.field_count == 0 {
            return false;
        }
        let rest = self.buffer.rest();
        let Some(count) = line::split(rest, self.delimiter, &mut self.ends) else {
            return false;
        };
        let end = count.checked_sub(1).and_then(|last| self.ends.get(last)).copied().unwrap_or(0);
        self.after_return = rest.get(end) == Some(&b'\r');
        self.line += 1;
        self.field_count = count;
        self.in_place = Some(end + 1);
        self.buffer.use_up(end + 1);
        true
    }

    fn read_record(&mut self) -> Result<Outcome> {
        self.in_place = None;
        let (mut used, mut field_bytes, mut field_count) = (0, 0, 0);
        self.parser.set_line(self.line);
        loop {
            self.buffer.peek()?;
            // One byte more than the longest record: its line end.
            let budget = MAX_RECORD + 1 - used;
            if budget == 0 {
                return Ok(Outcome::TooLong);
            }
            let rest = self.buffer.rest();
            let input = &rest[..rest.len().min(budget)];
            let output = self.fields.get_mut(field_bytes..).unwrap_or_default();
            let ends = self.ends.get_mut(field_count..).unwrap_or_default();
            let (result, read, written, ended) = self.parser.read_record(input, output, ends);
            let returned = input[..read].last() == Some(&b'\r');
            used += read;
            field_bytes += written;
            field_count += ended;
            self.buffer.use_up(read);
            match result {
                ReadRecordResult::InputEmpty => {}
                ReadRecordResult::OutputFull => self.fields.resize(2 * self.fields.len(), 0),
                ReadRecordResult::OutputEndsFull if field_count >= MAX_FIELDS => return Ok(Outcome::TooLong),
                ReadRecordResult::OutputEndsFull => self.ends.resize(2 * self.ends.len(), 0),
                ReadRecordResult::Record | ReadRecordResult::End => {
                    self.field_count = field_count;
                    // The parser counts newlines alone.
                    self.line = self.parser.line() + u64::from(returned);
                    self.after_return = returned;
                    return Ok(Outcome::Complete);
                }
            }
        }
    }

    /// Passes over what is left of a record that is too long, to the end of the line, whatever its quotes say: a quote left
    /// open does not swallow the rest of the file.
    fn pass_over(&mut self) -> Result<Problem> {
        self.line = self.parser.line();
        self.field_count = 0;
        begin(&mut self.parser);
        self.skip_line()?;
        let bytes = self.buffer.position() - self.record_byte;
        let value = format!("a record of {bytes} bytes; it may have {MAX_RECORD} bytes and {MAX_FIELDS} fields");
        Ok(Problem { reason: Reason::TooLong, place: self.place(), value })
    }

    /// Fields lie one after the other without gaps, so an empty one ends where the one before it does.
    fn drop_empty_fields(&mut self) {
        let (mut kept, mut last) = (0, 0);
        for index in 0..self.field_count {
            let end = self.ends[index];
            if end != last {
                self.ends[kept] = end;
                kept += 1;
                last = end;
            }
        }
        self.field_count = kept;
    }
}

fn parser(delimiter: u8) -> csv_core::Reader {
    let mut parser = ReaderBuilder::new().delimiter(delimiter).build();
    begin(&mut parser);
    parser
}

/// Begins a record. The first call of a parser would pass over a byte-order mark, if it got all of it at once: it gets a blank line.
fn begin(parser: &mut csv_core::Reader) {
    parser.reset();
    parser.read_record(b"\n", &mut [0], &mut [0]);
}

/// The most frequent of [`DELIMITERS`] outside quotes, the earlier one where two are; a blank where there is none.
fn delimiter_of(line: &[u8]) -> u8 {
    let mut counts = [0; DELIMITERS.len()];
    let mut quoted = false;
    for byte in line {
        quoted ^= *byte == b'"';
        if let Some(index) = DELIMITERS.iter().position(|delimiter| !quoted && delimiter == byte) {
            counts[index] += 1;
        }
    }
    let (mut best, mut most) = (b' ', 0);
    for (delimiter, count) in DELIMITERS.into_iter().zip(counts) {
        if count > most {
            (best, most) = (delimiter, count);
        }
    }
    best
}

#[cfg(test)]
mod tests;

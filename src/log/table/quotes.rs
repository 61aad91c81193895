//! Whether a record goes on behind a line end, as `csv-core` would have it, found out without reading it.
use memchr::memchr;

/// Where in a record a byte stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Place {
    /// Where a quote opens a quoted field.
    #[default]
    FieldStart,
    /// Behind its first byte: a quote is text.
    Plain,
    /// Behind an open quote: a line end is text.
    Quoted,
    /// Behind a quote in a quoted field: a second one is text, anything else finds it closed.
    Closed,
}

/// The lines of a record so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Quotes {
    place: Place,
    begun: bool,
    /// There was more than blanks and quotes.
    text: bool,
}

impl Quotes {
    /// Takes the record's next line in, without its end.
    pub(super) fn take(&mut self, line: &[u8], delimiter: u8) {
        self.begun = true;
        if self.place != Place::Quoted && memchr(b'"', line).is_none() {
            self.place = Place::Plain;
            self.text |= !line.trim_ascii().is_empty();
            return;
        }
        for &byte in line {
            self.text |= byte != b'"' && !byte.is_ascii_whitespace();
            self.place = match (self.place, byte) {
                (Place::FieldStart | Place::Closed, b'"') => Place::Quoted,
                (Place::Quoted, b'"') => Place::Closed,
                (Place::Quoted, _) => Place::Quoted,
                (_, byte) if byte == delimiter => Place::FieldStart,
                _ => Place::Plain,
            };
        }
    }

    /// Whether nothing was taken in yet.
    pub(super) fn is_new(&self) -> bool {
        !self.begun
    }

    /// Whether the record goes on in the next line.
    pub(super) fn are_open(&self) -> bool {
        self.place == Place::Quoted
    }

    /// Whether the record may be one that is passed over as blank.
    pub(super) fn may_be_blank(&self) -> bool {
        !self.text
    }
}

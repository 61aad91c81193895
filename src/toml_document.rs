//! A TOML document whose every value knows its line and its key, so that errors can name both.
use std::{
    fs,
    io::{self, Read},
    ops::Range,
    path::Path,
    sync::Arc,
};

use toml::{
    Spanned,
    de::{DeTable, DeValue},
};

use crate::{
    error::{Error, Result},
    units::{self, UnitError},
};

/// The text of a file, and the file's name.
#[derive(Clone, Copy)]
pub struct Document<'a> {
    /// Its name in messages.
    pub file: &'a str,
    /// What stands in it.
    pub text: &'a str,
    /// What it describes.
    pub kind: &'static Kind,
}

/// A kind of file that is written in TOML.
pub struct Kind {
    /// What messages call it: `rig`.
    pub name: &'static str,
    /// Those of its kind that need no file.
    pub builtin: &'static [&'static str],
    /// An error of such a file: its name, with the line where known, and the message.
    pub error: fn(Arc<str>, String) -> Error,
}

/// Largest file that is read, in bytes.
pub const MAX_FILE: u64 = 16 * 1024 * 1024;

impl Kind {
    /// Reads a file of this kind, of bounded size even where the system can't tell it (a pipe, a device).
    pub fn read(&self, file: &str) -> Result<String> {
        let io_error = |source| Error::Io { file: file.into(), source };
        let refuse = |place: String, message: String| Err((self.error)(place.into(), message));
        if Path::new(file).is_dir() {
            return refuse(file.to_owned(), format!("is a directory, not a {} file", self.name));
        }
        let source = fs::File::open(file).map_err(|error| match error.kind() {
            io::ErrorKind::NotFound => io_error(self.not_found()),
            _ => io_error(error),
        })?;
        let mut bytes = Vec::new();
        source.take(MAX_FILE + 1).read_to_end(&mut bytes).map_err(io_error)?;
        if bytes.len() as u64 > MAX_FILE {
            return refuse(file.to_owned(), format!("larger than {} MiB: no {} file", MAX_FILE >> 20, self.name));
        }
        String::from_utf8(bytes).or_else(|error| {
            let valid = error.utf8_error().valid_up_to();
            let line = line_of(error.as_bytes(), valid);
            refuse(format!("{file}:{line}"), format!("not UTF-8 text (byte {valid})"))
        })
    }

    /// What to say of a name that is neither built in nor a file.
    fn not_found(&self) -> io::Error {
        let (name, builtin) = (self.name, self.builtin.join(", "));
        let message = format!("no such {name} file, and no built-in {name} of this name ({builtin})");
        io::Error::new(io::ErrorKind::NotFound, message)
    }
}

impl<'a> Document<'a> {
    /// Parses the text; an error names the line.
    pub fn parse(self) -> Result<DeTable<'a>> {
        match DeTable::parse(self.text) {
            Ok(root) => Ok(root.into_inner()),
            Err(error) => {
                let message = format!("no TOML: {}", error.message().trim_end());
                Err(self.error(error.span().map(|span| span.start), message))
            }
        }
    }

    /// An error at a byte of the text, or of the file as a whole.
    pub fn error(self, byte: Option<usize>, message: String) -> Error {
        let file = match byte {
            Some(byte) => format!("{}:{}", self.file, line_of(self.text.as_bytes(), byte)),
            None => self.file.to_owned(),
        };
        (self.kind.error)(file.into(), message)
    }

    fn error_at(self, span: Range<usize>, message: String) -> Error {
        self.error(Some(span.start), message)
    }
}

/// Line of a byte of a text, from 1.
pub fn line_of(text: &[u8], byte: usize) -> usize {
    let before = text.get(..byte).unwrap_or(text);
    memchr::memchr_iter(b'\n', before).count() + 1
}

/// One table of the document.
#[derive(Clone)]
pub struct Section<'a> {
    document: Document<'a>,
    /// Its header as the user writes it; empty for the top level.
    header: String,
    /// What its keys begin with in a message: `ring.`; empty for the top level.
    prefix: String,
    table: &'a DeTable<'a>,
    /// Where it begins; `None` for the top level.
    start: Option<usize>,
}

impl<'a> Section<'a> {
    /// The top level of a document.
    pub fn root(document: Document<'a>, table: &'a DeTable<'a>) -> Self {
        Self { document, header: String::new(), prefix: String::new(), table, start: None }
    }

    /// Refuses keys that are not in these lists: the first one in the file is named.
    pub fn only(&self, known: &[&[&str]]) -> Result<()> {
        let known = known.concat();
        let unknown = self.table.keys().filter(|key| !known.contains(&key.get_ref().as_ref()));
        let Some(key) = unknown.min_by_key(|key| key.span().start) else { return Ok(()) };
        let place = if self.header.is_empty() { String::new() } else { format!(" in {}", self.header) };
        let key_name = units::shorten(key.get_ref());
        let message = format!("unknown key `{key_name}`{place}; expected one of {}", known.join(", "));
        Err(self.document.error_at(key.span(), message))
    }

    /// The value of a key, if it is there.
    pub fn get(&self, key: &str) -> Option<Entry<'a>> {
        let (name, value) = self.table.get_key_value(key)?;
        Some(Entry { document: self.document, key: format!("{}{key}", self.prefix), at: name.span(), value })
    }

    /// The value of a key that has to be there.
    pub fn require(&self, key: &str) -> Result<Entry<'a>> {
        self.get(key).ok_or_else(|| self.error(format!("`{key}` is missing")))
    }

    /// An error of the section as a whole.
    pub fn error(&self, message: String) -> Error {
        let place = if self.header.is_empty() { String::new() } else { format!("{}: ", self.header) };
        self.document.error(self.start, format!("{place}{message}"))
    }
}

/// One value of the document, with its key.
#[derive(Clone)]
pub struct Entry<'a> {
    document: Document<'a>,
    /// Dotted, as messages show it.
    key: String,
    /// Where the key stands.
    at: Range<usize>,
    value: &'a Spanned<DeValue<'a>>,
}

impl<'a> Entry<'a> {
    /// An error of this value: what it has to be.
    pub fn error(&self, message: &str) -> Error {
        let is_table = matches!(self.value.get_ref(), DeValue::Table(_));
        let shown = self.document.text.get(self.value.span()).filter(|_| !is_table);
        let shown = shown.map(|text| format!(" = {}", units::shorten(text))).unwrap_or_default();
        // Values that span lines are named by the line of their key.
        self.document.error_at(self.at.clone(), format!("`{}`{shown}: {message}", self.key))
    }

    /// Line of the key, from 1. Counts from the top of the file: for messages only.
    pub fn line(&self) -> usize {
        line_of(self.document.text.as_bytes(), self.at.start)
    }

    fn expected<T>(&self, what: &str) -> Result<T> {
        Err(self.error(&format!("expected {what}, found {}", type_name(self.value.get_ref()))))
    }

    /// The value as text. Errors where it is none.
    pub fn text(&self) -> Result<&'a str> {
        match self.value.get_ref() {
            DeValue::String(text) => Ok(text),
            _ => self.expected("a string"),
        }
    }

    /// The value as true or false. Errors where it is neither.
    pub fn flag(&self) -> Result<bool> {
        match self.value.get_ref() {
            DeValue::Boolean(flag) => Ok(*flag),
            _ => self.expected("true or false"),
        }
    }

    /// A whole number of at least 0; one that does not fit counts as the largest that does.
    pub fn count(&self) -> Result<usize> {
        match self.value.get_ref() {
            DeValue::Integer(_) => {
                let value = self.number()?;
                // Saturates; `as` would hide a negative number.
                if value < 0.0 { Err(self.error("must not be negative")) } else { Ok(value as usize) }
            }
            _ => self.expected("a whole number"),
        }
    }

    /// A finite number.
    pub fn number(&self) -> Result<f64> {
        let Some(number) = number(self.value.get_ref()) else { return self.expected("a number") };
        if number.is_finite() { Ok(number) } else { Err(self.error("must be finite")) }
    }

    /// A length in metres: a string with a unit, or a number of metres.
    pub fn length(&self) -> Result<f64> {
        self.quantity(units::length)
    }

    /// An angle in radians: a string with its unit.
    pub fn angle(&self) -> Result<f64> {
        self.quantity(units::angle)
    }

    /// What a parser of units makes of a string, or of a bare number as it stands in the file.
    pub fn quantity<T>(&self, parse: impl Fn(&str) -> Result<T, UnitError>) -> Result<T> {
        let parsed = match self.value.get_ref() {
            DeValue::String(text) => parse(text),
            DeValue::Float(_) | DeValue::Integer(_) => parse(&shortest(self.number()?)),
            _ => return self.expected("a string with a number and a unit, or a number"),
        };
        parsed.map_err(|error| self.error(&error.to_string()))
    }

    /// The table under the key.
    pub fn section(&self) -> Result<Section<'a>> {
        match self.value.get_ref() {
            DeValue::Table(table) => Ok(self.subsection(format!("[{}]", self.key), table, self.at.start)),
            _ => self.expected(&format!("a table ([{}])", self.key)),
        }
    }

    /// The tables of an array of tables, at least one.
    pub fn sections(&self) -> Result<Vec<Section<'a>>> {
        let what = format!("tables, each under [[{}]]", self.key);
        let DeValue::Array(array) = self.value.get_ref() else { return self.expected(&what) };
        if array.is_empty() {
            return Err(self.error(&format!("expected {what}")));
        }
        let section = |item: &'a Spanned<DeValue<'a>>| match item.get_ref() {
            DeValue::Table(table) => Ok(self.subsection(format!("[[{}]]", self.key), table, item.span().start)),
            _ => self.expected(&what),
        };
        array.iter().map(section).collect()
    }

    fn subsection(&self, header: String, table: &'a DeTable<'a>, start: usize) -> Section<'a> {
        Section { document: self.document, header, prefix: format!("{}.", self.key), table, start: Some(start) }
    }

    /// The values of an array of at most `most`.
    pub fn items_up_to(&self, most: usize) -> Result<Vec<Entry<'a>>> {
        match self.value.get_ref() {
            DeValue::Array(array) if array.len() > most => {
                Err(self.error(&format!("{} values: at most {most}", array.len())))
            }
            _ => self.items(),
        }
    }

    /// The values of an array.
    pub fn items(&self) -> Result<Vec<Entry<'a>>> {
        let DeValue::Array(array) = self.value.get_ref() else { return self.expected("an array") };
        let item = |value: &'a Spanned<DeValue<'a>>| Self {
            document: self.document,
            key: self.key.clone(),
            at: value.span(),
            value,
        };
        Ok(array.iter().map(item).collect())
    }
}

/// A TOML integer or float; the nearest f64, infinite where it is beyond.
fn number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(float) => float.as_str().parse().ok(),
        DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().parse().ok(),
        DeValue::Integer(integer) => {
            i64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|value| value as f64)
        }
        _ => None,
    }
}

/// The shortest text that reads back as this number.
fn shortest(number: f64) -> String {
    format!("{number}")
}

/// What a value is, in words.
fn type_name(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "a string",
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "a truth value",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "an array",
        DeValue::Table(_) => "a table",
    }
}

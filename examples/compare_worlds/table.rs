//! A table in Markdown that reads as one in its source, too.

use std::fmt;

/// Words, then numbers.
pub struct Table {
    /// What the page calls it.
    pub name: &'static str,
    pub title: &'static str,
    pub header: Vec<String>,
    /// So many columns are words, and stand to the left.
    pub words: usize,
    pub rows: Vec<Vec<String>>,
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lines = || [&self.header].into_iter().chain(&self.rows);
        let width = |column: usize| lines().filter_map(|cells| Some(cells.get(column)?.chars().count())).max();
        let widths: Vec<usize> = (0..self.header.len()).map(|column| width(column).unwrap_or(0)).collect();
        writeln!(f, "**{}**\n", self.title)?;
        for (line, cells) in lines().enumerate() {
            for (column, (cell, width)) in cells.iter().zip(&widths).enumerate() {
                if column < self.words { write!(f, "| {cell:width$} ") } else { write!(f, "| {cell:>width$} ") }?;
            }
            writeln!(f, "|")?;
            if line == 0 {
                let numbers = self.header.len() - self.words;
                writeln!(f, "|{}{}", "---|".repeat(self.words), "--:|".repeat(numbers))?;
            }
        }
        Ok(())
    }
}

/// The headings of a table.
pub fn headings(words: &[&str]) -> Vec<String> {
    words.iter().map(|word| (*word).to_owned()).collect()
}

/// A cell; `-` where there is nothing.
pub fn text(number: Option<f64>, digits: usize) -> String {
    number.map_or_else(|| "-".to_owned(), |number| format!("{number:.digits$}"))
}

/// Metres in centimetres.
pub fn cm(metres: Option<f64>) -> Option<f64> {
    metres.map(|metres| 100.0 * metres)
}

//! The page that shows these tables.

use std::{fs, io};

use atm_lab::simulate::Effects;

use crate::table::Table;

/// Where it is.
pub const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/methods.md");
/// Set to write the tables into the page instead of printing them.
pub const WRITE: &str = "ATM_WRITE_PAGE";

/// What the page calls these drives.
pub fn called(effects: Effects) -> &'static str {
    if effects == Effects::default() { "exact" } else { "noise" }
}

/// What stands before the table of a name, the table, and what stands after it; `None` where the page has no place for it.
pub fn split<'a>(page: &'a str, name: &str) -> Option<(&'a str, &'a str, &'a str)> {
    let begin = format!("<!-- measured: {name} -->\n");
    let start = page.find(&begin)? + begin.len();
    let end = start + page.get(start..)?.find("<!-- end -->")?;
    Some((page.get(..start)?, page.get(start..end)?, page.get(end..)?))
}

/// Puts the tables into their places.
pub fn write(tables: &[Table], effects: Effects) -> io::Result<()> {
    let mut page = fs::read_to_string(PAGE)?;
    for table in tables {
        let name = format!("{} {}", called(effects), table.name);
        page = match split(&page, &name) {
            Some((before, _, after)) => format!("{before}{table}{after}"),
            None => page,
        };
    }
    fs::write(PAGE, page)
}

//! The tables of docs/paper.md, which are what these tests measure.

use std::{fs, sync::Mutex};

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/paper.md");
/// Set to write the tables into the page instead of holding them against it: `scripts/paper` does.
const WRITE: &str = "ATM_WRITE_PAGE";

/// Tests run side by side, and write one at a time.
static WRITING: Mutex<()> = Mutex::new(());

/// Insists that the page shows this table under this name.
#[track_caller]
pub fn shows(name: &str, header: &[&str], rows: &[Vec<String>]) {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let header: Vec<String> = header.iter().map(|cell| (*cell).to_owned()).collect();
    let rule = format!("|{}\n", "---|".repeat(header.len()));
    let table = line(&header) + &rule + &rows.iter().map(|row| line(row)).collect::<String>();
    let _guard = WRITING.lock();
    let page = fs::read_to_string(PAGE).unwrap_or_else(|error| panic!("{PAGE}: {error}"));
    let (begin, end) = (format!("<!-- measured: {name} -->\n"), "<!-- end -->");
    let (before, rest) = page.split_once(&begin).unwrap_or_else(|| panic!("no place for `{name}` in docs/paper.md"));
    let (shown, after) = rest.split_once(end).unwrap_or_else(|| panic!("`{name}` has no end in docs/paper.md"));
    if std::env::var_os(WRITE).is_some_and(|set| !set.is_empty()) {
        fs::write(PAGE, format!("{before}{begin}{table}{end}{after}")).expect("the page can be written");
        return;
    }
    assert!(shown == table, "docs/paper.md does not show what was measured (scripts/paper writes it):\n{table}");
}

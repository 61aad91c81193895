//! What a file is about, by its columns.

use std::io::{Cursor, Read};

use super::{Input, columns::Columns, table::Table};
use crate::{
    error::{Error, Result},
    rig::TableFormat,
};

/// Most bytes in which a header is looked for.
const LOOKED_AT: u64 = 256 * 1024;

/// What the rows of a table are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Content {
    /// Range readings, with or without poses: everything else, so that a log without a header is known as well.
    Readings,
    /// Crossings of two arcs: there is a column `t_other`.
    Crossings,
    /// Where readings really came from: there is a column `cause`.
    Truth,
    /// Echoes and other points: there are `x` and `y`, and no heading.
    Points,
}

impl Input {
    /// What the table is about, by its header; its bytes are all still there to be read.
    ///
    /// # Errors
    /// The file can't be read, is empty, or no text.
    pub fn content(mut self) -> Result<(Content, Self)> {
        let mut start = Vec::new();
        let looked = self.reader.by_ref().take(LOOKED_AT).read_to_end(&mut start);
        looked.map_err(|source| Error::Io { file: self.name.clone(), source })?;
        let mut table = Table::new(Box::new(Cursor::new(start.clone())), self.name.clone())?;
        table.set_delimiter(None)?;
        let content = of(&Columns::read(&mut table, &TableFormat::default())?)?;
        self.reader = Box::new(Cursor::new(start).chain(self.reader));
        Ok((content, self))
    }
}

fn of(columns: &Columns) -> Result<Content> {
    let has = |name| Ok(columns.find(name)?.is_some());
    Ok(if has("t_other")? {
        Content::Crossings
    } else if has("cause")? {
        Content::Truth
    } else if has("x")? && has("y")? && !has("yaw")? {
        Content::Points
    } else {
        Content::Readings
    })
}

#[cfg(test)]
mod tests {
    use super::{super::tests::input, *};
    use crate::log::echoes::{CROSSING_COLUMNS, ECHO_COLUMNS};

    fn content(text: &str) -> Content {
        let (content, mut input) = input(text).content().unwrap();
        let mut read = String::new();
        input.reader.read_to_string(&mut read).unwrap();
        assert_eq!(read, text, "something was lost");
        content
    }

    #[test]
    fn tables_are_known_by_their_columns() {
        assert_eq!(content("t,sensor,range,x,y,yaw\n1,0,2,0,0,0\n"), Content::Readings);
        assert_eq!(content("t,x,y,yaw,left,right\n"), Content::Readings);
        assert_eq!(content("# poses are elsewhere\nt;sensor;range\n"), Content::Readings);
        assert_eq!(content(&format!("{ECHO_COLUMNS}\n")), Content::Points);
        assert_eq!(content("y,x\n1,2\n"), Content::Points);
        assert_eq!(content(&format!("{CROSSING_COLUMNS}\n")), Content::Crossings);
        assert_eq!(content("t,sensor,x,y,azimuth,cause\n"), Content::Truth);
    }

    #[test]
    fn a_log_without_a_header_is_readings() {
        assert_eq!(content("33 1 2 3\n34 1 2 3\n"), Content::Readings);
    }

    #[test]
    fn an_empty_file_is_refused_by_its_name() {
        let error = input("").content().map(|found| found.0).unwrap_err();
        assert_eq!(error.to_string(), "log.csv:1: is empty");
    }
}

//! Echoes and crossings out, as CSV.

use std::io::{self, Write};

use atm_core::{ArcCrossing, Echo};

use crate::stamp;

/// The columns of an echo table, in order.
pub const ECHO_COLUMNS: &str = "t,sensor,x,y,kind,range,azimuth,crossings,resolution,significance";

/// The columns of a table of crossings, in order.
pub const CROSSING_COLUMNS: &str = "t,sensor,t_other,sensor_other,x,y,azimuth,angle";

/// Writes one kind of table: seconds, metres, radians; floats as the shortest decimals that read back as the same bits.
#[derive(Debug)]
pub struct TableWriter<W> {
    out: W,
    row: Vec<u8>,
    /// The sensors' ids, quoted where CSV needs it.
    ids: Vec<Vec<u8>>,
}

impl<W: Write> TableWriter<W> {
    /// A table of echoes of the sensors `ids`, its header written.
    pub fn echoes<'a>(out: W, ids: impl IntoIterator<Item = &'a str>) -> io::Result<Self> {
        Self::new(out, ids, ECHO_COLUMNS)
    }

    /// A table of crossings between arcs of the sensors `ids`, its header written.
    pub fn crossings<'a>(out: W, ids: impl IntoIterator<Item = &'a str>) -> io::Result<Self> {
        Self::new(out, ids, CROSSING_COLUMNS)
    }

    fn new<'a>(mut out: W, ids: impl IntoIterator<Item = &'a str>, columns: &str) -> io::Result<Self> {
        writeln!(out, "{columns}")?;
        Ok(Self { out, row: Vec::with_capacity(256), ids: ids.into_iter().map(quoted).collect() })
    }

    /// Writes one echo.
    pub fn echo(&mut self, echo: &Echo<f64>) -> io::Result<()> {
        self.row.clear();
        stamp::write(echo.t, &mut self.row);
        self.id(echo.sensor);
        self.float(echo.position.x);
        self.float(echo.position.y);
        self.row.push(b',');
        self.row.extend_from_slice(echo.kind.name().as_bytes());
        self.float(echo.range);
        self.float(echo.azimuth());
        write!(self.row, ",{}", echo.crossings)?;
        self.float(echo.resolution);
        self.float(echo.significance());
        self.end()
    }

    /// Writes one crossing.
    pub fn crossing(&mut self, crossing: &ArcCrossing<f64>) -> io::Result<()> {
        self.row.clear();
        stamp::write(crossing.t, &mut self.row);
        self.id(crossing.sensor);
        self.row.push(b',');
        stamp::write(crossing.t_other, &mut self.row);
        self.id(crossing.sensor_other);
        self.float(crossing.position.x);
        self.float(crossing.position.y);
        self.float(crossing.bearing.azimuth());
        self.float(crossing.angle);
        self.end()
    }

    /// Hands everything written so far on.
    pub fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }

    /// What the table is written to.
    pub const fn get_ref(&self) -> &W {
        &self.out
    }

    /// What the table was written to.
    pub fn into_inner(self) -> W {
        self.out
    }

    fn id(&mut self, sensor: u16) {
        self.row.push(b',');
        if let Some(id) = self.ids.get(usize::from(sensor)) {
            self.row.extend_from_slice(id);
        }
    }

    fn float(&mut self, value: f64) {
        self.row.push(b',');
        self.row.extend_from_slice(zmij::Buffer::new().format(value).as_bytes());
    }

    fn end(&mut self) -> io::Result<()> {
        self.row.push(b'\n');
        self.out.write_all(&self.row)
    }
}

/// A field as CSV wants it (RFC 4180): in quotes where it holds a comma, a quote or a line's end.
pub(super) fn quoted(field: &str) -> Vec<u8> {
    if field.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\"")).into_bytes()
    } else {
        field.as_bytes().to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_quoted_only_where_csv_needs_it() {
        assert_eq!(quoted("left"), b"left");
        assert_eq!(quoted("left, \"low\""), b"\"left, \"\"low\"\"\"");
    }

    #[test]
    fn header_is_written_at_once() {
        let table = TableWriter::echoes(Vec::new(), ["0"]).unwrap();
        assert_eq!(table.into_inner(), format!("{ECHO_COLUMNS}\n").into_bytes());
    }
}

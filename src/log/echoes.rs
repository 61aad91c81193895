//! Echoes and crossings out, as CSV.

use std::io::{self, Write};

use atm_core::ArcCrossing;

use crate::{echo::AnyEcho, stamp};

/// The columns of an echo table, in order.
pub const ECHO_COLUMNS: &str = "t,sensor,x,y,kind,range,azimuth,crossings,resolution,significance";

/// The columns of a table of the consensus's echoes, in order: the usual ones first.
///
/// In them `crossings` counts the readings that agree, as `support` does, `resolution` is the length that holds the echo
/// with 95 %, and `significance` is what is missing of full confidence. The normal's columns are empty but for walls.
pub const CONSENSUS_COLUMNS: &str = "t,sensor,x,y,kind,range,azimuth,crossings,resolution,significance,support,against,\
                                     sigma_azimuth,sigma_range,normal_x,normal_y";

/// The columns of a table of crossings, in order.
pub const CROSSING_COLUMNS: &str = "t,sensor,t_other,sensor_other,x,y,azimuth,angle";

/// What is a line of a table.
pub trait Line {
    /// Writes it.
    fn write<W: Write>(&self, table: &mut TableWriter<W>) -> io::Result<()>;
}

impl Line for AnyEcho {
    fn write<W: Write>(&self, table: &mut TableWriter<W>) -> io::Result<()> {
        table.echo(self)
    }
}

impl Line for ArcCrossing<f64> {
    fn write<W: Write>(&self, table: &mut TableWriter<W>) -> io::Result<()> {
        table.crossing(self)
    }
}

/// Writes one kind of table: seconds, metres, radians; floats as the shortest decimals that read back as the same bits.
#[derive(Debug)]
pub struct TableWriter<W> {
    out: W,
    row: Vec<u8>,
    /// The sensors' ids, quoted where CSV needs it.
    ids: Vec<Vec<u8>>,
    shown: Box<[Shown]>,
}

/// Longest text of a number.
const LONGEST: usize = 24;

/// A number that was written, and how.
#[derive(Debug, Clone, Copy)]
struct Shown {
    bits: u64,
    length: u8,
    text: [u8; LONGEST],
}

impl Shown {
    /// Those kept: as many as a ring's quantised ranges give, in the nearest cache of a processor.
    const KEPT: usize = 512;
    /// A NaN that nothing here computes; with no text.
    const NONE: Self = Self { bits: u64::MAX, length: 0, text: [0; LONGEST] };

    /// Where a number is kept (multiplicative hashing: Knuth, *The Art of Computer Programming* 3, 6.4).
    const fn place(bits: u64) -> usize {
        const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;
        (bits.wrapping_mul(GOLDEN) >> (u64::BITS - Self::KEPT.trailing_zeros())) as usize
    }
}

impl<W: Write> TableWriter<W> {
    /// A table of echoes of the sensors `ids`, its header written.
    pub fn echoes<'a>(out: W, ids: impl IntoIterator<Item = &'a str>) -> io::Result<Self> {
        Self::new(out, ids, ECHO_COLUMNS)
    }

    /// A table of the consensus's echoes of the sensors `ids`, its header written.
    pub fn consensus<'a>(out: W, ids: impl IntoIterator<Item = &'a str>) -> io::Result<Self> {
        Self::new(out, ids, CONSENSUS_COLUMNS)
    }

    /// A table of crossings between arcs of the sensors `ids`, its header written.
    pub fn crossings<'a>(out: W, ids: impl IntoIterator<Item = &'a str>) -> io::Result<Self> {
        Self::new(out, ids, CROSSING_COLUMNS)
    }

    fn new<'a>(mut out: W, ids: impl IntoIterator<Item = &'a str>, columns: &str) -> io::Result<Self> {
        writeln!(out, "{columns}")?;
        let shown = vec![Shown::NONE; Shown::KEPT].into_boxed_slice();
        Ok(Self { out, row: Vec::with_capacity(256), ids: ids.into_iter().map(quoted).collect(), shown })
    }

    /// More sensors are known: `ids` are all of them.
    pub fn set_ids<'a>(&mut self, ids: impl IntoIterator<Item = &'a str>) {
        self.ids = ids.into_iter().map(quoted).collect();
    }

    /// Writes one echo, with what its estimator has to say of it.
    pub fn echo(&mut self, echo: &AnyEcho) -> io::Result<()> {
        let usual = echo.usual();
        self.row.clear();
        stamp::write_decimal(usual.t, &mut self.row);
        self.id(usual.sensor);
        self.float(usual.position.x);
        self.float(usual.position.y);
        self.row.push(b',');
        self.row.extend_from_slice(usual.kind.as_bytes());
        self.frequent(usual.range);
        self.frequent(usual.azimuth);
        self.count(usual.crossings);
        self.frequent(usual.resolution);
        self.frequent(usual.significance);
        if let Some(echo) = echo.consensus() {
            self.count(echo.support);
            self.count(echo.against);
            self.float(echo.sigma_azimuth);
            self.float(echo.sigma_range);
            match echo.normal {
                Some(normal) => {
                    self.float(normal.x);
                    self.float(normal.y);
                }
                None => self.row.extend_from_slice(b",,"),
            }
        }
        self.end()
    }

    /// Writes one crossing.
    pub fn crossing(&mut self, crossing: &ArcCrossing<f64>) -> io::Result<()> {
        self.row.clear();
        stamp::write_decimal(crossing.t, &mut self.row);
        self.id(crossing.sensor);
        self.row.push(b',');
        stamp::write_decimal(crossing.t_other, &mut self.row);
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

    fn count(&mut self, count: u32) {
        self.row.push(b',');
        let mut digits = [0; 10];
        let (mut start, mut rest) = (digits.len(), count);
        while start == digits.len() || rest > 0 {
            start -= 1;
            digits[start] = b'0' + (rest % 10) as u8;
            rest /= 10;
        }
        self.row.extend_from_slice(&digits[start..]);
    }

    fn float(&mut self, value: f64) {
        self.row.push(b',');
        self.row.extend_from_slice(zmij::Buffer::new().format(value).as_bytes());
    }

    /// A number that is likely to come again: ranges are quantised, and what follows from them alone repeats with them.
    fn frequent(&mut self, value: f64) {
        let bits = value.to_bits();
        let Some(shown) = self.shown.get_mut(Shown::place(bits)) else { return };
        if shown.bits != bits || shown.length == 0 {
            let mut buffer = zmij::Buffer::new();
            let text = buffer.format(value).as_bytes();
            let Some(place) = shown.text.get_mut(..text.len()) else { return self.float(value) };
            place.copy_from_slice(text);
            (shown.bits, shown.length) = (bits, text.len() as u8);
        }
        self.row.push(b',');
        // A copy of a size that the compiler knows, cut back: no call.
        let end = self.row.len() + usize::from(shown.length);
        self.row.extend_from_slice(&shown.text);
        self.row.truncate(end);
    }

    fn end(&mut self) -> io::Result<()> {
        self.row.push(b'\n');
        self.out.write_all(&self.row)
    }
}

/// A field as CSV wants it (RFC 4180): in quotes where it holds a comma, a quote or a line's end.
pub fn quoted(field: &str) -> Vec<u8> {
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
    fn counts_are_written_as_the_standard_library_writes_them() {
        for count in [0, 1, 9, 10, 318, 4_294_967_295] {
            let mut table = TableWriter::new(Vec::new(), [], "").unwrap();
            table.count(count);
            assert_eq!(table.row, format!(",{count}").into_bytes());
        }
    }

    #[test]
    fn numbers_that_come_again_are_written_alike() {
        let values =
            [0.0, -0.0, 1.0, 0.0254, f64::MIN_POSITIVE, -1.234_567_890_123_456_7e-308, f64::NAN, f64::INFINITY];
        let many = (0..4000).map(|step| f64::from(step % 1500) * 0.0254).chain(values).chain(values);
        let (mut once, mut again) = [(); 2].map(|()| TableWriter::new(Vec::new(), [], "").unwrap()).into();
        for value in many {
            once.float(value);
            again.frequent(value);
        }
        assert!(once.row == again.row);
    }

    #[test]
    fn header_is_written_at_once() {
        let table = TableWriter::echoes(Vec::new(), ["0"]).unwrap();
        assert_eq!(table.into_inner(), format!("{ECHO_COLUMNS}\n").into_bytes());
    }
}

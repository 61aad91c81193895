//! Where the readings of a log really came from: CSV `t,sensor,x,y,azimuth,cause`, one row for each reading that is an echo.
//!
//! x and y are in the WORLD's frame, in which the robot really drives; a log's poses drift from it where the odometry is
//! noisy. The azimuth is about the sensor's axis as it really stood, so it can be compared whatever the odometry does.
use std::{
    collections::{BTreeMap, HashMap},
    fmt,
    io::{self, Write},
    sync::Arc,
};

use atm::{
    error::{Error, Reason, Result},
    log::{
        Input, Next,
        cell::{Fault, check_width, number},
        columns::{Columns, list},
        echoes::quoted,
        table::Table,
    },
    rig::TableFormat,
    stamp,
};
use nalgebra::Point2;

/// The columns of a truth file, in order.
pub const TRUTH_COLUMNS: &str = "t,sensor,x,y,azimuth,cause";

/// What a reading came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Cause {
    /// A smooth wall.
    Wall,
    /// A corner, convex or concave, such as the jamb of an opening.
    Corner,
    /// A pole.
    Pole,
    /// A bump on a rough surface.
    Scatterer,
    /// Sound that came back by way of other surfaces.
    Multipath,
    /// Another sensor's sound.
    Crosstalk,
}

impl Cause {
    /// All causes.
    pub const ALL: [Self; 6] =
        [Self::Wall, Self::Corner, Self::Pole, Self::Scatterer, Self::Multipath, Self::Crosstalk];

    /// Its name in a truth file.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Wall => "wall",
            Self::Corner => "corner",
            Self::Pole => "pole",
            Self::Scatterer => "scatterer",
            Self::Multipath => "multipath",
            Self::Crosstalk => "crosstalk",
        }
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Where one reading really came from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TruthPoint {
    /// Where the sound turned back, in the world's frame, in metres; of sound that took a detour, the surface half way.
    /// Nothing stands there where the cause is crosstalk.
    pub position: Point2<f64>,
    /// The direction in which the sound left, from the sensor's axis as it really stood, counter-clockwise, in radians.
    pub azimuth: f64,
    /// What stands there.
    pub cause: Cause,
}

/// A truth file, held in memory.
#[derive(Debug, Clone, Default)]
pub struct Truth {
    sensors: HashMap<Arc<str>, BTreeMap<i64, TruthPoint>>,
}

impl Truth {
    /// Reads a truth file; `-` is standard input.
    ///
    /// # Errors
    /// The file can't be read; a column is missing; a row can't be used, with its line.
    pub fn read(path: &str) -> Result<Self> {
        let input = Input::open(path)?;
        let mut table = Table::new(input.reader, input.name)?;
        table.set_delimiter(None)?;
        let layout = Layout::find(&Columns::read(&mut table, &TableFormat::default())?)?;
        let (mut truth, mut unusable) = (Self::default(), None);
        loop {
            let next = table.next_record(&mut |problem| unusable = Some(problem))?;
            if let Some(problem) = unusable {
                return Err(Error::Strict { problem });
            }
            if next == Next::End {
                return Ok(truth);
            }
            let row = layout.read(&table).map_err(|fault| Error::Strict { problem: fault.at(&table) });
            let (t, sensor, point) = row?;
            truth.insert(t, &sensor, point);
        }
    }

    /// Where the reading of a sensor at a time, in nanoseconds, came from; `None` where it is no echo or not known.
    pub fn get(&self, t: i64, sensor: &str) -> Option<&TruthPoint> {
        self.sensors.get(sensor)?.get(&t)
    }

    /// Adds the truth of one reading, or replaces it.
    pub fn insert(&mut self, t: i64, sensor: &str, point: TruthPoint) {
        match self.sensors.get_mut(sensor) {
            Some(points) => points.insert(t, point),
            None => self.sensors.entry(Arc::from(sensor)).or_default().insert(t, point),
        };
    }

    /// The points, in no order that means anything but always the same.
    pub fn points(&self) -> impl Iterator<Item = (i64, &str, &TruthPoint)> {
        let mut sensors: Vec<_> = self.sensors.iter().collect();
        sensors.sort_by_key(|(sensor, _)| *sensor);
        sensors.into_iter().flat_map(|(sensor, points)| points.iter().map(move |(t, point)| (*t, &**sensor, point)))
    }

    /// Number of readings it knows.
    pub fn len(&self) -> usize {
        self.sensors.values().map(BTreeMap::len).sum()
    }

    /// Whether it knows none.
    pub fn is_empty(&self) -> bool {
        self.sensors.is_empty()
    }
}

/// Which column is which.
struct Layout {
    /// In the order of [`TRUTH_COLUMNS`].
    columns: [usize; 6],
    width: usize,
}

impl Layout {
    fn find(columns: &Columns) -> Result<Self> {
        let (mut found, mut missing) = ([0; 6], Vec::new());
        for (place, name) in found.iter_mut().zip(TRUTH_COLUMNS.split(',')) {
            match columns.find(name)? {
                Some(column) => *place = column,
                None => missing.push(name),
            }
        }
        if !missing.is_empty() {
            return Err(columns.error(&format!("no truth file: no column {}", list(&missing))));
        }
        Ok(Self { columns: found, width: 1 + found.into_iter().max().unwrap_or(0) })
    }

    fn read(&self, table: &Table) -> Result<(i64, String, TruthPoint), Fault> {
        let record = check_width(table, self.width)?;
        let [t, sensor, x, y, azimuth, cause] = self.columns.map(|column| record.get(column).unwrap_or_default());
        let finite = |name, cell| match number(cell) {
            Some(value) if value.is_finite() => Ok(value),
            _ => Err(Fault::cell(Reason::BadNumber, name, cell)),
        };
        let time = stamp::parse(t, stamp::SECOND_SHIFT).ok_or_else(|| Fault::cell(Reason::BadNumber, "t", t))?;
        let known = Cause::ALL.into_iter().find(|known| known.name().as_bytes() == cause);
        let point = TruthPoint {
            position: Point2::new(finite("x", x)?, finite("y", y)?),
            azimuth: finite("azimuth", azimuth)?,
            cause: known.ok_or_else(|| Fault::cell(Reason::UnknownCause, "cause", cause))?,
        };
        Ok((time, String::from_utf8_lossy(sensor).into_owned(), point))
    }
}

/// Writes a truth file; floats as the shortest decimals that read back as the same bits.
#[derive(Debug)]
pub struct TruthWriter<W> {
    out: W,
    row: Vec<u8>,
}

impl<W: Write> TruthWriter<W> {
    /// A truth file, its header written.
    pub fn new(mut out: W) -> io::Result<Self> {
        writeln!(out, "{TRUTH_COLUMNS}")?;
        Ok(Self { out, row: Vec::with_capacity(128) })
    }

    /// Writes the truth of the reading of a sensor at a time in nanoseconds.
    pub fn write(&mut self, t: i64, sensor: &str, point: &TruthPoint) -> io::Result<()> {
        self.row.clear();
        stamp::write_decimal(t, &mut self.row);
        self.row.push(b',');
        self.row.extend_from_slice(&quoted(sensor));
        let TruthPoint { position, azimuth, cause } = point;
        writeln!(self.row, ",{:?},{:?},{azimuth:?},{cause}", position.x, position.y)?;
        self.out.write_all(&self.row)
    }

    /// What the file is written to.
    pub const fn get_ref(&self) -> &W {
        &self.out
    }

    /// What the file was written to.
    pub fn into_inner(self) -> W {
        self.out
    }
}

#[cfg(test)]
mod tests;

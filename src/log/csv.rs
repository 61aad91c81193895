//! Readings from text tables: one reading a record (long), or all sensors side by side (wide).
//!
//! Long: the columns `t`, `sensor`, `range`, and `x`, `y`, `yaw`. Wide: `t`, `x`, `y`, `yaw`, and one column per sensor.
use std::{
    collections::{HashMap, HashSet},
    sync::Arc,
};

use super::{
    Input, Next, Row, Source,
    cell::{Fault, LastPose, PoseCells, Quantity, check_width, coordinate, scaled, shorten},
    columns::{Columns, list},
    table::{Record, Table},
    times::Times,
};
use crate::{
    diagnose::Diagnosis,
    error::{Problem, Reason, Result},
    rig::{Rig, TableFormat},
};

/// Longest sensor id that [`Discover`] takes, in bytes.
pub const MAX_ID: usize = 255;

/// What stands in the columns that aren't sensors of a wide table.
const RESERVED: [&str; 4] = ["t", "x", "y", "yaw"];

/// What an empty range cell is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EmptyCell {
    /// A reading without an echo: passed on as NaN. The default of a long table.
    NoEcho,
    /// A sensor that did not fire: skipped and counted. The default of a wide table.
    Skip,
}

/// What is made of the columns `x`, `y` and `yaw`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PoseUse {
    /// They are needed, all three.
    Needed,
    /// They are used where all three are there.
    IfThere,
    /// They are ignored: the poses come from elsewhere.
    Ignored,
}

/// Sensor ids and the indices they stand for.
pub trait SensorNames {
    /// The index of a sensor, `None` where there is no such sensor.
    fn index(&mut self, id: &str) -> Option<u16>;

    /// All ids in order of index, where they are known before the log is read.
    fn known(&self) -> Option<&[Arc<str>]>;

    /// The ids known so far, in order of index.
    fn ids(&self) -> &[Arc<str>];
}

/// The sensors of a rig.
impl SensorNames for Arc<Rig> {
    fn index(&mut self, id: &str) -> Option<u16> {
        self.index_of(id)
    }

    fn known(&self) -> Option<&[Arc<str>]> {
        Some(Rig::ids(self))
    }

    fn ids(&self) -> &[Arc<str>] {
        Rig::ids(self)
    }
}

/// Sensors as they come, for a log without a rig: at most 65,535, with ids of at most [`MAX_ID`] bytes.
#[derive(Debug, Clone, Default)]
pub struct Discover {
    ids: Vec<Arc<str>>,
    indices: HashMap<Arc<str>, u16>,
}

impl SensorNames for Discover {
    fn index(&mut self, id: &str) -> Option<u16> {
        if let Some(index) = self.indices.get(id) {
            return Some(*index);
        }
        let index = u16::try_from(self.ids.len()).ok().filter(|index| *index < u16::MAX)?;
        if id.is_empty() || id.len() > MAX_ID {
            return None;
        }
        let id: Arc<str> = Arc::from(id);
        self.ids.push(id.clone());
        self.indices.insert(id, index);
        Some(index)
    }

    fn known(&self) -> Option<&[Arc<str>]> {
        None
    }

    fn ids(&self) -> &[Arc<str>] {
        &self.ids
    }
}

/// Where the ranges stand.
enum Layout {
    Long {
        /// `None`: the only sensor's.
        sensor: Option<usize>,
        range: usize,
    },
    /// Sensor and column, in the order of the columns.
    Wide(Vec<(u16, usize)>),
}

/// A text table of readings.
pub struct CsvReadings<N> {
    table: Table,
    format: TableFormat,
    columns: Columns,
    time: usize,
    times: Times,
    range: Quantity,
    pose: Option<PoseCells>,
    /// The column of the angle by which sensors are turned on their mounts.
    angle: Option<(usize, Quantity)>,
    layout: Layout,
    /// Number of columns a record must have.
    width: usize,
    empty: EmptyCell,
    names: N,
    /// Where the next record's sensor is looked for first: sensors mostly take turns.
    turn: usize,
    last_pose: LastPose,
    /// The first record may be the rest of a line, and was or will be left out.
    first_line: FirstLine,
}

/// The first record of a source that was joined midway.
enum FirstLine {
    Trusted,
    /// It is yet to come.
    Awaited,
    /// It was left out.
    LeftOut(String),
}

impl<N: SensorNames> CsvReadings<N> {
    /// Reads the header. `empty` is by default what suits the layout.
    ///
    /// Errors where the file can't be read or is no text, and where a needed column is missing or there twice. A wide table needs a
    /// column for every sensor that is known.
    pub fn new(
        input: Input,
        format: &TableFormat,
        poses: PoseUse,
        empty: Option<EmptyCell>,
        mut names: N,
    ) -> Result<Self> {
        let mut table = Table::new(input.reader, input.name)?;
        table.set_delimiter(format.delimiter)?;
        let columns = Columns::read(&mut table, format)?;
        let (time, layout) = layout(&columns, &mut names)?;
        let pose = match (poses, columns.pose(format)) {
            (PoseUse::Ignored, _) => None,
            (PoseUse::IfThere, found) => found?.ok(),
            (PoseUse::Needed, found) => match found? {
                Ok(cells) => Some(cells),
                Err(missing) => {
                    let missing = list(&missing);
                    return Err(columns.error(&format!(
                        "no column for the pose ({missing}); poses in a second file come with --poses"
                    )));
                }
            },
        };
        let angle = angle(&columns, format)?;
        let ranges = match &layout {
            Layout::Long { sensor, range } => sensor.unwrap_or(0).max(*range),
            Layout::Wide(sensors) => sensors.iter().map(|(_, column)| *column).max().unwrap_or(0),
        };
        let ranges = ranges.max(angle.map_or(0, |(column, _)| column));
        let width = (1 + time.max(ranges)).max(pose.map_or(0, |pose| pose.width()));
        let default = if matches!(layout, Layout::Long { .. }) { EmptyCell::NoEcho } else { EmptyCell::Skip };
        let empty = empty.unwrap_or(default);
        Ok(Self {
            table,
            format: format.clone(),
            times: Times::new(format.time_shift, columns.comma),
            range: Quantity::length(format.range, columns.comma),
            columns,
            time,
            pose,
            angle,
            layout,
            width,
            empty,
            names,
            turn: 0,
            last_pose: LastPose::default(),
            first_line: FirstLine::Trusted,
        })
    }

    /// The table comes from a source that runs already: without a header its first line, which may be the rest of one or two
    /// halves glued together, is left out.
    pub fn joined_midway(mut self) -> Self {
        if !self.format.header {
            self.first_line = FirstLine::Awaited;
        }
        self
    }

    /// The sensors' names.
    pub fn names(&self) -> &N {
        &self.names
    }

    /// Whether the table is wide: a column per sensor.
    pub fn is_wide(&self) -> bool {
        matches!(self.layout, Layout::Wide(_))
    }

    /// Reads the record that is in the table; problems of single cells are reported, the fault of the whole is returned.
    fn read_row(&mut self, row: &mut Row, problems: &mut dyn FnMut(Problem)) -> Result<(), Fault> {
        let record = check_width(&self.table, self.width)?;
        let time = record.get(self.time).unwrap_or_default();
        row.t = self.times.read(time).ok_or_else(|| Fault::cell(Reason::BadNumber, "t", time))?;
        row.log_time = row.t;
        // A record without a pose is of another table, joined with that of the poses.
        let cells = self.pose.as_ref().filter(|cells| !cells.are_blank(record));
        row.pose = cells.map(|cells| self.last_pose.read(cells, record)).transpose()?;
        row.angle = match &self.angle {
            Some((column, as_a)) => coordinate(record, *column, self.columns.name(*column), *as_a)?,
            None => 0.0,
        };
        match &self.layout {
            // A record of a pose alone.
            Layout::Long { sensor: Some(sensor), range }
                if row.pose.is_some() && [sensor, range].iter().all(|column| is_empty(record, **column)) => {}
            Layout::Long { sensor: None, range } => row.add(0, self.range(record, *range)?),
            Layout::Long { sensor: Some(sensor), range } => {
                let range = self.range(record, *range)?;
                // Looked up last: a record with a bad number makes no sensor known.
                let id = record.get(*sensor).unwrap_or_default();
                let index = index_of(id, &mut self.names, &mut self.turn);
                let index = index.ok_or_else(|| Fault::cell(Reason::UnknownSensor, "sensor", id))?;
                row.add(index, range);
            }
            Layout::Wide(sensors) => {
                for (index, column) in sensors {
                    match self.range(record, *column) {
                        Ok(range) => row.add(*index, range),
                        Err(fault) => problems(fault.at(&self.table)),
                    }
                }
            }
        }
        Ok(())
    }

    /// The range in one cell in metres; `None` where it is empty and skipped.
    #[inline]
    fn range(&self, record: Record<'_>, column: usize) -> Result<Option<f64>, Fault> {
        let cell = record.get(column).unwrap_or_default();
        if cell.is_empty() {
            return Ok((self.empty == EmptyCell::NoEcho).then_some(f64::NAN));
        }
        let range = match self.range.raw(cell) {
            // The values that stand for "no echo" are in the units of the file.
            Some(raw) if self.format.no_echo.contains(&raw) => Some(f64::INFINITY),
            Some(raw) => scaled(raw, self.format.range),
            None => self.range.measured(cell),
        };
        match range {
            Some(range) => Ok(Some(range)),
            None => Err(Fault::cell(Reason::BadNumber, self.columns.name(column), cell)),
        }
    }
}

fn is_empty(record: Record<'_>, column: usize) -> bool {
    record.get(column).is_none_or(<[u8]>::is_empty)
}

/// The column of the angle by which sensors are turned on their mounts, where the format names one.
fn angle(columns: &Columns, format: &TableFormat) -> Result<Option<(usize, Quantity)>> {
    let Some(name) = &format.angle else { return Ok(None) };
    let column =
        columns.find(name)?.ok_or_else(|| columns.error(&format!("no column `{name}` of the sensors' angle")))?;
    Ok(Some((column, Quantity::angle(format.angle_unit, columns.comma))))
}

/// The index of the sensor named in a cell; `turn` says where to look first, and is left at the one after it.
#[inline]
fn index_of(cell: &[u8], names: &mut impl SensorNames, turn: &mut usize) -> Option<u16> {
    let index = match names.ids().get(*turn) {
        Some(id) if id.as_bytes() == cell => u16::try_from(*turn).ok(),
        _ => std::str::from_utf8(cell).ok().and_then(|id| names.index(id)),
    }?;
    let next = usize::from(index) + 1;
    *turn = if next < names.ids().len() { next } else { 0 };
    Some(index)
}

impl Row {
    /// Takes one sensor's range in, or counts it as empty.
    #[inline]
    fn add(&mut self, sensor: u16, range: Option<f64>) {
        match range {
            Some(range) => self.readings.push((sensor, range)),
            None => self.empty += 1,
        }
    }
}

impl<N: SensorNames> Source for CsvReadings<N> {
    fn next_row(&mut self, row: &mut Row, problems: &mut dyn FnMut(Problem)) -> Result<Next> {
        row.readings.clear();
        (row.pose, row.empty, row.angle) = (None, 0, 0.0);
        let next = self.table.next_record(problems)?;
        if next != Next::Record {
            return Ok(next);
        }
        if matches!(self.first_line, FirstLine::Awaited) {
            let cells: Vec<&[u8]> = self.table.record().fields().collect();
            self.first_line = FirstLine::LeftOut(shorten(&cells.join(&self.table.delimiter())));
            return Ok(Next::Unusable);
        }
        self.table.write_place(&mut row.place);
        if let Err(fault) = self.read_row(row, problems) {
            row.readings.clear();
            row.empty = 0;
            problems(fault.at(&self.table));
            return Ok(Next::Unusable);
        }
        Ok(Next::Record)
    }

    fn drained(&self) -> bool {
        self.table.drained()
    }

    fn position(&self) -> u64 {
        self.table.position()
    }

    fn has_poses(&self) -> bool {
        self.pose.is_some()
    }

    fn ids(&self) -> &[Arc<str>] {
        self.names.ids()
    }

    fn diagnoses(&self) -> Vec<Diagnosis> {
        match &self.first_line {
            FirstLine::LeftOut(line) => vec![Diagnosis::FirstLine { line: line.clone() }],
            _ => Vec::new(),
        }
    }
}

/// Finds out the layout, and the column of the time.
fn layout(columns: &Columns, names: &mut impl SensorNames) -> Result<(usize, Layout)> {
    let known = names.known().map(<[_]>::to_vec);
    let (sensor, range) = (columns.find("sensor")?, columns.find("range")?);
    let layout = match (sensor, range) {
        (Some(_), Some(range)) => Layout::Long { sensor, range },
        // The readings of the rig's only sensor need not name it.
        (None, Some(range)) if known.as_ref().is_some_and(|ids| ids.len() == 1) => Layout::Long { sensor: None, range },
        // One of the two alone is a sensor of that name, if the rig has it; else the other one is missing.
        (Some(_), None) if !is_known(&known, "sensor") => return Err(columns.error("no column `range`")),
        (None, Some(_)) if !is_known(&known, "range") => return Err(columns.error("no column `sensor`")),
        _ => Layout::Wide(wide(columns, names, known)?),
    };
    let time = columns.find("t")?.ok_or_else(|| columns.error("no column `t`"))?;
    Ok((time, layout))
}

fn is_known(known: &Option<Vec<Arc<str>>>, id: &str) -> bool {
    known.iter().flatten().any(|known| **known == *id)
}

/// The sensors of a wide table and their columns.
fn wide(columns: &Columns, names: &mut impl SensorNames, known: Option<Vec<Arc<str>>>) -> Result<Vec<(u16, usize)>> {
    let mut sensors = Vec::new();
    let mut found = HashSet::new();
    for (column, name) in columns.names().iter().enumerate() {
        if name.is_empty() || RESERVED.contains(&name.as_str()) {
            continue;
        }
        match names.index(name) {
            Some(index) => sensors.push((index, column)),
            // Of a rig's log, further columns are ignored.
            None if known.is_some() => continue,
            None => return Err(columns.error("too many columns, or a name too long for a sensor")),
        }
        if !found.insert(name.as_str()) {
            return Err(columns.error(&format!("two columns are named `{name}`")));
        }
    }
    if sensors.is_empty() {
        let message = "neither a long table (`t`, `sensor`, `range`) nor a wide one (`t` and a column per sensor); the rig's [log] \
                       names columns otherwise, in their order: columns = [\"t\", \"sensor\", \"range\", …]";
        return Err(columns.error(message));
    }
    let missing: Vec<_> = known.iter().flatten().filter(|id| !found.contains(&***id)).collect();
    if !missing.is_empty() {
        let missing = list(&missing);
        let message = format!("no column for the sensors {missing}: another rig's log, or columns are missing");
        return Err(columns.error(&message));
    }
    Ok(sensors)
}

#[cfg(test)]
mod tests;

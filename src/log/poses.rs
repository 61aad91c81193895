//! Trajectory files: CSV `t,x,y,yaw`, or TUM (`t x y z qx qy qz qw`).
use super::{
    Input, Next,
    cell::{Fault, PoseCells, Quantity, check_width, coordinate, number, shorten},
    columns::{Columns, list},
    table::{Record, Table},
    times::Times,
};
use crate::{
    error::{Problem, Reason, Result},
    rig::TableFormat,
    track::{Pose, PoseStream, StampedPose},
    units::Scale,
};

/// Numbers in a record of a TUM file, and their names.
const TUM_FIELDS: usize = 8;
const TUM: [&str; TUM_FIELDS] = ["t", "x", "y", "z", "qx", "qy", "qz", "qw"];
/// Decimal shift from seconds to nanoseconds.
const SECONDS: i32 = 9;

/// How the poses are written.
enum Layout {
    Csv { time: usize, pose: PoseCells },
    Tum,
}

/// A trajectory file.
pub struct PoseLog {
    table: Table,
    layout: Layout,
    times: Times,
    /// Number of columns a record must have.
    width: usize,
}

impl PoseLog {
    /// Finds out what the file is by its first record: eight numbers between blanks are TUM, except where `format` names eight columns.
    /// Anything else is CSV, written as `format` says, by default with a header.
    ///
    /// Errors where the file can't be read or is no text, and where a column is missing or there twice.
    pub fn new(input: Input, format: Option<&TableFormat>) -> Result<Self> {
        let mut table = Table::new(input.reader, input.name)?;
        let default = TableFormat::default();
        let format = format.unwrap_or(&default);
        let named = format.columns.as_ref().is_some_and(|columns| columns.len() == TUM_FIELDS);
        if !named && is_tum(table.first_line()?) {
            table.set_delimiter(Some(b' '))?;
            return Ok(Self { table, layout: Layout::Tum, times: Times::new(SECONDS, false), width: TUM_FIELDS });
        }
        table.set_delimiter(format.delimiter)?;
        let columns = Columns::read(&mut table, format)?;
        let time = columns.find("t")?;
        match (time, columns.pose(format)?) {
            (Some(time), Ok(pose)) => {
                let width = pose.width().max(time + 1);
                let times = Times::new(format.time_shift, columns.comma);
                Ok(Self { table, layout: Layout::Csv { time, pose }, times, width })
            }
            (time, pose) => {
                let missing = time.is_none().then_some("t").into_iter().chain(pose.err().into_iter().flatten());
                let missing = list(&missing.collect::<Vec<_>>());
                let message =
                    format!("neither TUM (t x y z qx qy qz qw) nor CSV with t, x, y, yaw: no column {missing}");
                Err(columns.error(&message))
            }
        }
    }

    /// Whether the file is TUM.
    pub fn is_tum(&self) -> bool {
        matches!(self.layout, Layout::Tum)
    }

    /// Bytes of the file used so far.
    pub fn position(&self) -> u64 {
        self.table.position()
    }

    /// Reads the record that is in the table; `None` where it has no pose: a table that was joined with one of readings.
    fn read(&mut self) -> Result<Option<(i64, Pose)>, Fault> {
        let record = check_width(&self.table, self.width)?;
        let time = match &self.layout {
            Layout::Csv { pose, .. } if pose.are_blank(record) => return Ok(None),
            Layout::Csv { time, .. } => record.get(*time),
            Layout::Tum => record.get(0),
        };
        let time = time.unwrap_or_default();
        let t = self.times.read(time).ok_or_else(|| Fault::cell(Reason::BadNumber, "t", time))?;
        let pose = match &self.layout {
            Layout::Csv { pose, .. } => pose.read(record)?,
            Layout::Tum => tum_pose(record)?,
        };
        Ok(Some((t, pose)))
    }
}

impl PoseStream for PoseLog {
    fn next_pose(&mut self, problems: &mut dyn FnMut(Problem)) -> Result<Option<StampedPose>> {
        loop {
            match self.table.next_record(problems)? {
                Next::End => return Ok(None),
                Next::Unusable => continue,
                Next::Record => {}
            }
            match self.read() {
                Ok(Some((t, pose))) => return Ok(Some(StampedPose { t, pose, place: self.table.place() })),
                Ok(None) => {}
                Err(fault) => problems(fault.at(&self.table)),
            }
        }
    }
}

fn is_tum(line: &[u8]) -> bool {
    let mut fields = line.split(u8::is_ascii_whitespace).filter(|field| !field.is_empty());
    let numbers = fields.by_ref().take(TUM_FIELDS).filter(|field| number(field).is_some()).count();
    numbers == TUM_FIELDS && fields.next().is_none()
}

/// The pose of a TUM record: z is dropped, and so are roll and pitch.
fn tum_pose(record: Record<'_>) -> Result<Pose, Fault> {
    let cell = |index: usize| {
        coordinate(record, index, TUM.get(index).copied().unwrap_or_default(), Quantity::length(Scale::SI, false))
    };
    let (x, y, _) = (cell(1)?, cell(2)?, cell(3)?);
    let (qx, qy, qz, qw) = (cell(4)?, cell(5)?, cell(6)?, cell(7)?);
    let norm = (qx * qx + qy * qy + qz * qz + qw * qw).sqrt();
    if !(norm.is_finite() && norm > 0.0) {
        let shown: Vec<_> = (4..TUM_FIELDS).map(|index| shorten(record.get(index).unwrap_or_default())).collect();
        return Err(Fault::new(Reason::BadPose, format!("quaternion {} has no direction", shown.join(" "))));
    }
    let (qx, qy, qz, qw) = (qx / norm, qy / norm, qz / norm, qw / norm);
    let yaw = libm::atan2(2.0 * (qw * qz + qx * qy), 1.0 - 2.0 * (qy * qy + qz * qz));
    Ok(Pose { x, y, yaw })
}

#[cfg(test)]
mod tests;

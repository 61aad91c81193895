//! How the tables of a robot's logs are written.
use crate::units::Scale;

/// The two tables of a log.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LogFormats {
    /// The table of readings.
    pub readings: TableFormat,
    /// The table of poses, where they come from a file of their own.
    pub poses: TableFormat,
}

/// How one table is written. The default has a header, and is in seconds, metres and radians.
#[derive(Debug, Clone, PartialEq)]
pub struct TableFormat {
    /// Whether the first line names the columns. Never false without `columns` where it comes from a rig file.
    pub header: bool,
    /// What separates cells, an ASCII character; a blank stands for runs of blanks. `None`: found out from the first line.
    pub delimiter: Option<u8>,
    /// Names of the columns, no two alike. With a header they stand in for the names there.
    pub columns: Option<Vec<String>>,
    /// Decimal shift from the table's unit of time to nanoseconds: 9 for seconds ([`crate::stamp::decimal_shift`]).
    pub time_shift: i32,
    /// From raw ranges to metres.
    pub range: Scale,
    /// From raw x and y to metres.
    pub pose: Scale,
    /// From raw yaw to radians, counter-clockwise.
    pub yaw: Scale,
    /// Raw ranges that stand for "no echo".
    pub no_echo: Vec<f64>,
    /// The column of an angle that adds to the yaw of the sensors' mounts: of a servo that pans them.
    pub angle: Option<String>,
    /// From raw angles of that column to radians, counter-clockwise.
    pub angle_unit: Scale,
}

impl Default for TableFormat {
    fn default() -> Self {
        Self {
            header: true,
            delimiter: None,
            columns: None,
            time_shift: crate::stamp::SECOND_SHIFT,
            range: Scale::SI,
            pose: Scale::SI,
            yaw: Scale::SI,
            no_echo: Vec::new(),
            angle: None,
            angle_unit: Scale::SI,
        }
    }
}

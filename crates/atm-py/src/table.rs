//! Echoes and crossings as structured arrays: the columns of the command's tables.

use std::iter;

use atm::{
    core::ArcCrossing,
    echo::{AnyEcho, AnyEstimator},
    error::Result,
    pipeline::EchoSink,
    rig::Rig,
};
use atm_lab::{
    simulate::Sweep,
    truth::{Cause, TruthPoint},
};
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::time::Clock;

/// Characters of the longest kind's name.
const KIND_WIDTH: usize = 6;

/// And of the longest cause's.
const CAUSE_WIDTH: usize = 10;

/// Numbers in a row of echoes: time, position, range, azimuth, count, resolution, significance.
const ECHO_NUMBERS: usize = 8;

/// The columns of a table of echoes.
const ECHO_COLUMNS: [(&str, Type); 10] = [
    ("t", Type::Time),
    ("sensor", Type::Id),
    ("x", Type::Float),
    ("y", Type::Float),
    ("kind", Type::Kind),
    ("range", Type::Float),
    ("azimuth", Type::Float),
    ("crossings", Type::Count),
    ("resolution", Type::Float),
    ("significance", Type::Float),
];

/// And what follows them in one of the consensus's echoes.
const CONSENSUS_COLUMNS: [(&str, Type); 6] = [
    ("support", Type::Count),
    ("against", Type::Count),
    ("sigma_azimuth", Type::Float),
    ("sigma_range", Type::Float),
    ("normal_x", Type::Float),
    ("normal_y", Type::Float),
];

/// A text as numpy's `U` holds it: four bytes a character, zeros behind.
fn wide(text: &str, width: usize) -> Vec<u8> {
    text.chars().map(u32::from).chain(iter::repeat(0)).take(width).flat_map(u32::to_ne_bytes).collect()
}

/// Rows of one table, byte by byte as numpy has them.
struct Rows {
    bytes: Vec<u8>,
    clock: Clock,
    /// The sensors' ids, all of one width.
    ids: Vec<Vec<u8>>,
    id_width: usize,
}

impl Rows {
    fn new(rig: &Rig, clock: Clock) -> Self {
        let ids = || rig.sensors().iter().map(|sensor| sensor.id());
        let id_width = ids().map(|id| id.chars().count()).max().unwrap_or(0).max(1);
        Self { bytes: Vec::new(), clock, ids: ids().map(|id| wide(id, id_width)).collect(), id_width }
    }

    /// Makes room for `rows` of `floats` numbers of 8 bytes and a kind each; memory that is not used is never touched.
    fn reserve(&mut self, rows: usize, floats: usize) {
        let id = self.ids.first().map_or(0, Vec::len);
        let width = id + 8 * floats + 4 * KIND_WIDTH;
        // Where there is no such room, the table grows as it can.
        let _ = self.bytes.try_reserve_exact(rows.saturating_mul(width));
    }

    #[inline]
    fn time(&mut self, ns: i64) {
        self.bytes.extend_from_slice(&self.clock.bytes(ns));
    }

    #[inline]
    fn id(&mut self, sensor: u16) {
        // Every sensor of the fuser is one of the rig.
        if let Some(id) = self.ids.get(usize::from(sensor)) {
            self.bytes.extend_from_slice(id);
        }
    }

    #[inline]
    fn count(&mut self, value: u32) {
        self.bytes.extend_from_slice(&value.to_ne_bytes());
    }

    #[inline]
    fn float(&mut self, value: f64) {
        self.bytes.extend_from_slice(&value.to_ne_bytes());
    }

    /// The rows as a structured array, without copying them. `columns` are names and types; `id` and `time` are filled in.
    fn into_array<'py>(self, py: Python<'py>, columns: &[(&str, Type)]) -> PyResult<Bound<'py, PyAny>> {
        let time = if self.clock == Clock::Seconds { "f8" } else { "i8" };
        let fields: Vec<(&str, String)> = columns
            .iter()
            .map(|&(name, kind)| {
                let code = match kind {
                    Type::Time => time.to_owned(),
                    Type::Id => format!("U{}", self.id_width),
                    Type::Kind => format!("U{KIND_WIDTH}"),
                    Type::Cause => format!("U{CAUSE_WIDTH}"),
                    Type::Float => "f8".to_owned(),
                    Type::Count => "u4".to_owned(),
                };
                (name, code)
            })
            .collect();
        let dtype = py.import("numpy")?.call_method1("dtype", (fields,))?;
        PyArray1::from_vec(py, self.bytes).call_method1("view", (dtype,))
    }
}

/// What a column holds.
#[derive(Clone, Copy)]
enum Type {
    Time,
    Id,
    Kind,
    Cause,
    Float,
    Count,
}

/// The echoes of a run.
pub struct Echoes {
    rows: Rows,
    /// The kinds' words as the array has them.
    kinds: Vec<Vec<u8>>,
    /// Kinds to keep; all where there are none given.
    keep: Option<Vec<&'static str>>,
    is_consensus: bool,
}

impl Echoes {
    /// An empty table of the estimator's echoes, with room for those of `readings`.
    pub fn new(
        rig: &Rig,
        clock: Clock,
        estimator: &AnyEstimator,
        keep: Option<Vec<&'static str>>,
        readings: usize,
    ) -> Self {
        let mut rows = Rows::new(rig, clock);
        let is_consensus = estimator.is_consensus();
        // Where only some kinds are kept, nobody knows how many there will be.
        if keep.is_none() {
            rows.reserve(readings, ECHO_NUMBERS + if is_consensus { CONSENSUS_COLUMNS.len() } else { 0 });
        }
        let kinds = estimator.kinds().iter().map(|kind| wide(kind, KIND_WIDTH)).collect();
        Self { rows, kinds, keep, is_consensus }
    }

    /// The table as numpy has it.
    pub fn into_array(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        let more: &[(&str, Type)] = if self.is_consensus { &CONSENSUS_COLUMNS } else { &[] };
        let columns: Vec<(&str, Type)> = ECHO_COLUMNS.iter().chain(more).copied().collect();
        self.rows.into_array(py, &columns)
    }
}

impl EchoSink for Echoes {
    fn echo(&mut self, echo: &AnyEcho) -> Result<bool> {
        let usual = echo.usual();
        if self.keep.as_ref().is_some_and(|keep| !keep.contains(&usual.kind)) {
            return Ok(false);
        }
        let rows = &mut self.rows;
        rows.time(usual.t);
        rows.id(usual.sensor);
        rows.float(usual.position.x);
        rows.float(usual.position.y);
        if let Some(kind) = self.kinds.get(echo.place()) {
            rows.bytes.extend_from_slice(kind);
        }
        rows.float(usual.range);
        rows.float(usual.azimuth);
        rows.count(usual.crossings);
        rows.float(usual.resolution);
        rows.float(usual.significance);
        if let Some(echo) = echo.consensus() {
            rows.count(echo.support);
            rows.count(echo.against);
            rows.float(echo.sigma_azimuth);
            rows.float(echo.sigma_range);
            for component in echo.normal.map_or([f64::NAN; 2], |normal| [normal.x, normal.y]) {
                rows.float(component);
            }
        }
        Ok(true)
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}

/// The crossings of a run.
pub struct Crossings(Rows);

impl Crossings {
    /// An empty table.
    pub fn new(rig: &Rig, clock: Clock) -> Self {
        Self(Rows::new(rig, clock))
    }

    /// The table as numpy has it.
    pub fn into_array(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        let columns = [
            ("t", Type::Time),
            ("sensor", Type::Id),
            ("t_other", Type::Time),
            ("sensor_other", Type::Id),
            ("x", Type::Float),
            ("y", Type::Float),
            ("azimuth", Type::Float),
            ("angle", Type::Float),
        ];
        self.0.into_array(py, &columns)
    }
}

impl EchoSink for Crossings {
    fn echo(&mut self, _echo: &AnyEcho) -> Result<bool> {
        Ok(false)
    }

    fn wants_crossings(&self) -> bool {
        true
    }

    fn crossings(&mut self, crossings: &[ArcCrossing<f64>]) -> Result<()> {
        for crossing in crossings {
            let rows = &mut self.0;
            rows.time(crossing.t);
            rows.id(crossing.sensor);
            rows.time(crossing.t_other);
            rows.id(crossing.sensor_other);
            rows.float(crossing.position.x);
            rows.float(crossing.position.y);
            rows.float(crossing.bearing.azimuth());
            rows.float(crossing.angle);
        }
        Ok(())
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}

/// A simulated log: a row for each reading.
pub struct Log(Rows);

impl Log {
    /// An empty table.
    pub fn new(rig: &Rig, clock: Clock) -> Self {
        Self(Rows::new(rig, clock))
    }

    /// Takes the readings of one instant in.
    pub fn sweep(&mut self, sweep: &Sweep) {
        let (rows, pose) = (&mut self.0, sweep.pose);
        for &(sensor, range) in &sweep.readings {
            rows.time(sweep.t);
            rows.id(sensor);
            for value in [range, pose.x, pose.y, pose.yaw] {
                rows.float(value);
            }
        }
    }

    /// The table as numpy has it.
    pub fn into_array(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        let [range, x, y, yaw] = ["range", "x", "y", "yaw"].map(|name| (name, Type::Float));
        self.0.into_array(py, &[("t", Type::Time), ("sensor", Type::Id), range, x, y, yaw])
    }
}

/// Where the readings of a simulated log came from: a row for each that is an echo.
pub struct Truths(Rows);

impl Truths {
    /// An empty table.
    pub fn new(rig: &Rig, clock: Clock) -> Self {
        Self(Rows::new(rig, clock))
    }

    /// Takes the truth of one reading in.
    pub fn point(&mut self, t: i64, sensor: u16, point: &TruthPoint) {
        let rows = &mut self.0;
        rows.time(t);
        rows.id(sensor);
        for value in [point.position.x, point.position.y, point.azimuth] {
            rows.float(value);
        }
        rows.bytes.extend_from_slice(&wide(Cause::name(point.cause), CAUSE_WIDTH));
    }

    /// The table as numpy has it.
    pub fn into_array(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        let [x, y, azimuth] = ["x", "y", "azimuth"].map(|name| (name, Type::Float));
        self.0.into_array(py, &[("t", Type::Time), ("sensor", Type::Id), x, y, azimuth, ("cause", Type::Cause)])
    }
}

//! One million readings in columns to echoes in rows, in memory: what `atm.fuse` does, from Rust.
//!
//! `cargo bench --bench columns`; `crates/atm-py/benches/million.py` sets Python's time beside it. The readings are the doorway
//! sample's, one drive after another. As in Python, a row holds all that an echo table has, azimuth and significance included.
use std::{hint::black_box, sync::Arc};

use atm::{
    core::Bounds,
    echo::{AnyEcho, AnyEstimator, Usual},
    error::{Problem, Result},
    log::{
        Input, Next, Row, Source,
        csv::{CsvReadings, PoseUse},
    },
    pipeline::{Defaults, EchoSink, Emit, History, SensorModel, Settings, fuse},
    rig::{Rig, TableFormat},
    track::Pose,
};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};

const READINGS: usize = 1_000_000;
/// From one drive to the next, in nanoseconds.
const PAUSE: i64 = 1_000_000_000;

/// Readings as numpy holds them: a column for each of their parts.
#[derive(Default)]
struct Readings {
    t: Vec<i64>,
    sensor: Vec<u16>,
    range: Vec<f64>,
    pose: [Vec<f64>; 3],
}

impl Readings {
    fn push(&mut self, t: i64, (sensor, range): (u16, f64), pose: Pose) {
        self.t.push(t);
        self.sensor.push(sensor);
        self.range.push(range);
        for (column, value) in self.pose.iter_mut().zip([pose.x, pose.y, pose.yaw]) {
            column.push(value);
        }
    }

    /// The sample, again and again.
    fn of_the_sample(rig: &Arc<Rig>) -> Self {
        let input = Input::open(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/doorway.csv")).expect("the sample");
        let format = TableFormat::default();
        let mut log = CsvReadings::new(input, &format, PoseUse::Needed, None, Arc::clone(rig)).expect("a log");
        let (mut rows, mut row) = (Vec::new(), Row::default());
        while log.next_row(&mut row, &mut |problem| panic!("{problem}")).expect("readable") == Next::Record {
            rows.push(row.clone());
        }
        let drive = rows.last().map_or(0, |row| row.t) + PAUSE;
        let mut readings = Self::default();
        for round in 0.. {
            for row in &rows {
                for &reading in &row.readings {
                    if readings.t.len() == READINGS {
                        return readings;
                    }
                    readings.push(round * drive + row.t, reading, row.pose.expect("it has poses"));
                }
            }
        }
        readings
    }
}

/// The readings as a log: those of one time and pose are one record.
struct Columns<'a> {
    readings: &'a Readings,
    next: usize,
}

impl Columns<'_> {
    fn pose(&self, index: usize) -> Pose {
        let [x, y, yaw] = [0, 1, 2].map(|column: usize| self.readings.pose[column][index]);
        Pose { x, y, yaw }
    }
}

impl Source for Columns<'_> {
    fn next_row(&mut self, row: &mut Row, _problems: &mut dyn FnMut(Problem)) -> Result<Next> {
        row.readings.clear();
        let Some(&t) = self.readings.t.get(self.next) else { return Ok(Next::End) };
        (row.t, row.log_time) = (t, t);
        let pose = self.pose(self.next);
        row.pose = Some(pose);
        while self.readings.t.get(self.next) == Some(&t) && self.pose(self.next) == pose {
            row.readings.push((self.readings.sensor[self.next], self.readings.range[self.next]));
            self.next += 1;
        }
        Ok(Next::Record)
    }

    fn drained(&self) -> bool {
        false
    }

    fn position(&self) -> u64 {
        self.next as u64
    }

    fn has_poses(&self) -> bool {
        true
    }

    fn ids(&self) -> &[Arc<str>] {
        &[]
    }
}

/// Rows of an echo table.
struct Rows(Vec<Usual>);

impl EchoSink for Rows {
    fn echo(&mut self, echo: &AnyEcho) -> Result<bool> {
        self.0.push(echo.usual());
        Ok(true)
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}

fn echoes(readings: &Readings, sensors: &[SensorModel], emit: Emit) -> usize {
    let settings =
        Settings { emit, history: History::PAPER, bounds: Bounds::NONE, estimator: AnyEstimator::PAPER, strict: true };
    let mut rows = Rows(Vec::new());
    let mut source = Columns { readings, next: 0 };
    let (_, result) = fuse(&mut source, None, sensors, &settings, &mut rows, &mut |_| {});
    result.expect("every reading of the sample can be used");
    black_box(rows.0).len()
}

fn columns(criterion: &mut Criterion) {
    let rig = Arc::new(Rig::builtin("nomad200").expect("it is built in"));
    let sensors = Defaults::default().complete(&rig).expect("the built-in rig is complete");
    let readings = Readings::of_the_sample(&rig);
    let mut group = criterion.benchmark_group("columns");
    group.sample_size(10).throughput(Throughput::Elements(READINGS as u64));
    for (name, emit) in [("latest", Emit::Latest), ("settled", Emit::Settled)] {
        group.bench_function(BenchmarkId::new(name, "million"), |bencher| {
            bencher.iter(|| echoes(&readings, &sensors, emit));
        });
    }
    group.finish();
}

criterion_group!(benches, columns);
criterion_main!(benches);

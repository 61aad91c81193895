//! Readings per second through the fuser: 16 sensors, H = 10, double precision, one core.
//!
//! `cargo bench --bench fusing`. The readings are the doorway sample's.
use std::{hint::black_box, sync::Arc};

use atm::{
    core::{Bounds, Echo, Fuser, Reading, Storage, TransversalMedian},
    log::{
        Input, Next, Row, Source,
        csv::{CsvReadings, PoseUse},
    },
    pipeline::{Defaults, readings},
    rig::{Rig, TableFormat},
    storage::{LatestSlots, SettledSlots},
};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};

const SENSORS: usize = 16;
const H: usize = 10;

/// The sample's readings, as the pipeline hands them to the fuser.
fn doorway() -> Vec<Reading<f64>> {
    let rig = Arc::new(Rig::builtin("nomad200").expect("it is built in"));
    let sensors = Defaults::default().complete(&rig).expect("the built-in rig is complete");
    let input = Input::open(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/doorway.csv")).expect("the sample is there");
    let mut log = CsvReadings::new(input, &TableFormat::default(), PoseUse::Needed, None, rig).expect("it is a log");
    let (mut row, mut all) = (Row::default(), Vec::new());
    while log.next_row(&mut row, &mut |problem| panic!("{problem}")).expect("it can be read") == Next::Record {
        all.extend(readings(&row, row.pose.expect("it has poses"), &sensors));
    }
    all
}

fn run<S: Storage<f64>>(mut fuser: Fuser<f64, S>, readings: &[Reading<f64>]) -> f64 {
    let mut sum = 0.0;
    let mut sink = |echo: &Echo<f64>| sum += echo.position.x;
    for reading in readings {
        // Every reading of the sample can be used.
        let _ = black_box(fuser.push(black_box(reading), &mut sink));
    }
    fuser.finish(&mut sink);
    sum
}

fn fusing(criterion: &mut Criterion) {
    let readings = doorway();
    let mut group = criterion.benchmark_group("fusing");
    group.throughput(Throughput::Elements(readings.len() as u64));
    group.bench_function(BenchmarkId::new("latest", "16x10"), |bencher| {
        bencher.iter(|| {
            let storage = LatestSlots::new(SENSORS, H).expect("a small local map");
            run(Fuser::latest(TransversalMedian::PAPER, Bounds::NONE, storage), &readings)
        });
    });
    group.bench_function(BenchmarkId::new("settled", "16x10"), |bencher| {
        bencher.iter(|| {
            let storage = SettledSlots::new(SENSORS, H).expect("a small local map");
            run(Fuser::settled(TransversalMedian::PAPER, Bounds::NONE, storage), &readings)
        });
    });
    group.finish();
}

criterion_group!(benches, fusing);
criterion_main!(benches);

//! Readings per second through the fuser: double precision, one core.
//!
//! `cargo bench --bench fusing`. The readings are the doorway sample's, and those of a larger room where sensors and H grow.

mod drive;

use atm::{
    core::{Fuser, Instructions, Reading},
    storage::{LatestSlots, SettledSlots},
};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};

use crate::drive::{PAPER, doorway, room, run};

fn latest(readings: &[Reading<f64>], sensors: u16, history: usize, instructions: Instructions) -> f64 {
    let storage = LatestSlots::new(sensors.into(), history).expect("a small local map");
    run(Fuser::latest(PAPER.0, PAPER.1, storage.with_instructions(instructions)), readings)
}

fn settled(readings: &[Reading<f64>], sensors: u16, history: usize, instructions: Instructions) -> f64 {
    let storage = SettledSlots::new(sensors.into(), history).expect("a small local map");
    run(Fuser::settled(PAPER.0, PAPER.1, storage.with_instructions(instructions)), readings)
}

/// 16 sensors, H = 10, with each set of instructions that this processor has.
fn fusing(criterion: &mut Criterion) {
    let readings = doorway();
    let mut group = criterion.benchmark_group("fusing");
    group.throughput(Throughput::Elements(readings.len() as u64));
    for instructions in Instructions::available() {
        let name = instructions.name();
        group.bench_function(BenchmarkId::new("latest_16x10", name), |bencher| {
            bencher.iter(|| latest(&readings, 16, 10, instructions));
        });
        group.bench_function(BenchmarkId::new("settled_16x10", name), |bencher| {
            bencher.iter(|| settled(&readings, 16, 10, instructions));
        });
    }
    group.finish();
}

/// More sensors, and a longer history.
fn growing(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("growing");
    for (sensors, history) in [(16, 10), (16, 50), (64, 10), (64, 50)] {
        let readings = room(sensors, 400);
        group.throughput(Throughput::Elements(readings.len() as u64));
        let case = format!("{sensors}x{history}");
        for instructions in Instructions::available() {
            let case = format!("{case}/{}", instructions.name());
            group.bench_function(BenchmarkId::new("latest", &case), |bencher| {
                bencher.iter(|| latest(&readings, sensors, history, instructions));
            });
            group.bench_function(BenchmarkId::new("settled", &case), |bencher| {
                bencher.iter(|| settled(&readings, sensors, history, instructions));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, fusing, growing);
criterion_main!(benches);

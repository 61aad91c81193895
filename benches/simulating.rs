//! A million beams against the built-in world `room`, whose walls are of all materials, on one core.
//!
//! `cargo bench --bench simulating`. Beside it the readings of one drive through it with mirrors.
use std::{f64::consts::PI, hint::black_box};

use atm::{
    core::{Isometry2, Vector2},
    rig::Rig,
};
use atm_lab::{
    simulate::{Beam, Effects, Scene, Simulation},
    world::World,
};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

const BEAMS: u32 = 1_000_000;

fn room() -> World {
    World::load("room", &[]).expect("it is built in")
}

/// Beams of 22.5° from a grid of places in the free middle of the room, in directions that repeat after 16 of them.
fn beams() -> Vec<Beam> {
    let beam = |index: u32| {
        let (column, row) = (index / 16 % 250, index / 16 / 250);
        let at = Vector2::new(1.0 + f64::from(column) * 0.015, 0.8 + f64::from(row) * 0.002);
        Beam::new(&Isometry2::new(at, f64::from(index % 16) * PI / 8.0), PI / 8.0)
    };
    (0..BEAMS).map(beam).collect()
}

fn simulating(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("simulating");
    group.sample_size(10);
    let (scene, beams) = (Scene::new(room(), 1), beams());
    group.throughput(Throughput::Elements(u64::from(BEAMS)));
    group.bench_function("million beams, room", |bencher| {
        bencher.iter(|| beams.iter().filter(|beam| scene.direct(black_box(beam), f64::INFINITY).is_some()).count());
    });
    let rig = Rig::builtin("nomad200").expect("it is built in");
    let effects = Effects { multipath: true, ..Effects::default() };
    let simulation = Simulation::new(room(), rig, PI / 8.0, effects, 1);
    let readings = 16 * room().path().sweep_count();
    group.throughput(Throughput::Elements(readings));
    group.bench_function("a drive with mirrors, room", |bencher| bencher.iter(|| simulation.sweeps().count()));
    group.finish();
}

criterion_group!(benches, simulating);
criterion_main!(benches);

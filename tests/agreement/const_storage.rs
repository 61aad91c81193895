//! Arrays of const size and vectors of run-time size hold the same local map: the same bits come out of either, whatever
//! instructions the pass over it uses.

use atm::core::{Arrays, Fuser, Instructions, LatestArrays, SETTLED_BLOCKS, SnapshotStorage, Storage};
use atm::storage::{LatestSlots, SettledSlots};

use crate::{
    draw::{self, Draws, Frame},
    log::{Float, Log},
    record::run,
};

fn latest<T: Float>(log: &Log, storage: impl SnapshotStorage<T>) -> Vec<u64> {
    let mut fuser = Fuser::latest(log.rules.estimator(), log.rules.bounds(), storage);
    run(log, &mut fuser, |fuser, recorder| fuser.snapshot(recorder)).bits()
}

fn latest_without_snapshots<T: Float>(log: &Log, storage: impl Storage<T>) -> Vec<u64> {
    let mut fuser = Fuser::latest(log.rules.estimator(), log.rules.bounds(), storage);
    run(log, &mut fuser, |_, _| {}).bits()
}

/// Compares every storage that fits `S` sensors and H readings of each.
fn same_bits<T: Float, const S: usize, const H: usize>() {
    for index in 0..40 {
        let seed = 2_000_000 + 1000 * (S * 100 + H) as u64 + index;
        let frame = Frame { size: Some((S, H)), least_angle: 5f64.to_radians() };
        let log = draw::log(frame, &mut Draws::new(seed)).rounded::<T>();
        let small = || LatestSlots::<T>::new(S, H).expect("small");
        let large = || SettledSlots::<T>::new(S, H).expect("small");

        let expected = latest(&log, small());
        for instructions in Instructions::available() {
            let with = latest(&log, small().with_instructions(instructions));
            assert!(with == expected, "{}, seed {seed}", instructions.name());
        }
        assert!(latest(&log, Arrays::<T, S, H, 1, 0>::new()) == expected, "arrays, seed {seed}");
        assert!(latest(&log, Arrays::<T, S, H, SETTLED_BLOCKS, 0>::new()) == expected, "large arrays, seed {seed}");
        assert!(latest(&log, large()) == expected, "large slots, seed {seed}");

        let causal = latest_without_snapshots(&log, LatestArrays::<T, S, H>::new());
        assert!(latest_without_snapshots(&log, small()) == causal, "causal arrays, seed {seed}");

        if log.rules.span.is_some() {
            let spaced = latest(&log, LatestSlots::<T>::by_travel(S, H).expect("small"));
            assert!(spaced == expected, "slots by travel, seed {seed}");
        }

        let (estimator, bounds) = (log.rules.estimator(), log.rules.bounds());
        let mut slots = Fuser::settled(estimator, bounds, large());
        let mut arrays = Fuser::settled(estimator, bounds, Arrays::<T, S, H, SETTLED_BLOCKS, 240>::new());
        let on_slots = run(&log, &mut slots, |fuser, recorder| fuser.snapshot(recorder)).bits();
        let on_arrays = run(&log, &mut arrays, |fuser, recorder| fuser.snapshot(recorder)).bits();
        assert!(on_arrays == on_slots, "settled arrays, seed {seed}");
        for instructions in Instructions::available() {
            let mut with = Fuser::settled(estimator, bounds, large().with_instructions(instructions));
            let with = run(&log, &mut with, |fuser, recorder| fuser.snapshot(recorder)).bits();
            assert!(with == on_slots, "settled, {}, seed {seed}", instructions.name());
        }
    }
}

#[test]
fn const_storage_gives_the_same_bits_in_double_precision() {
    same_bits::<f64, 1, 1>();
    same_bits::<f64, 1, 10>();
    same_bits::<f64, 3, 2>();
    same_bits::<f64, 5, 4>();
    same_bits::<f64, 8, 10>();
    // More slots than one sweep goes over.
    same_bits::<f64, 4, 50>();
}

#[test]
fn const_storage_gives_the_same_bits_in_single_precision() {
    same_bits::<f32, 2, 1>();
    same_bits::<f32, 4, 3>();
    same_bits::<f32, 8, 10>();
}

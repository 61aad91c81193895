//! A fixed run, for counting its instructions: `scripts/instructions` does that.
//!
//! `counted latest|settled INSTRUCTIONS` fuses the doorway sample 50 times over, with the named set of instructions; `SENSORS H`
//! behind it takes as many sensors round the larger room instead.

mod drive;

use std::{env, hint::black_box, process::ExitCode};

use atm::{
    core::{Fuser, Instructions, Reading},
    storage::{LatestSlots, SettledSlots},
};

use crate::drive::{PAPER, doorway, room, run};

/// Passes over the sample, so that filling the local map counts for little.
const PASSES: i64 = 50;
/// Sweeps round the room.
const SWEEPS: u32 = 400;
/// From one pass to the next, in nanoseconds: longer than the sample.
const LATER: i64 = 100_000_000_000;

fn main() -> ExitCode {
    let words: Vec<String> = env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let [mode, name, size @ ..] = words.as_slice() else {
        println!("nothing to measure here: see scripts/instructions");
        return ExitCode::SUCCESS;
    };
    let Some(instructions) = Instructions::available().find(|instructions| instructions.name() == name) else {
        println!("absent");
        return ExitCode::SUCCESS;
    };
    let (readings, sensors, history) = match size {
        [sensors, history] => {
            let (sensors, history) = (sensors.parse().expect("sensors"), history.parse().expect("a history"));
            (room(sensors, SWEEPS), sensors, history)
        }
        _ => (sample_again_and_again(), 16, 10),
    };
    match mode.as_str() {
        "latest" => black_box(latest(&readings, sensors, history, instructions)),
        "settled" => black_box(settled(&readings, sensors, history, instructions)),
        _ => return ExitCode::FAILURE,
    };
    println!("readings {}", readings.len());
    ExitCode::SUCCESS
}

fn sample_again_and_again() -> Vec<Reading<f64>> {
    let sample = doorway();
    let again = |pass| sample.iter().map(move |reading| Reading { t: reading.t + pass * LATER, ..*reading });
    (0..PASSES).flat_map(again).collect()
}

/// What is counted: nothing but this function and what it calls.
#[inline(never)]
fn latest(readings: &[Reading<f64>], sensors: u16, history: usize, instructions: Instructions) -> f64 {
    let storage = LatestSlots::new(sensors.into(), history).expect("a small local map");
    run(Fuser::latest(PAPER.0, PAPER.1, storage.with_instructions(instructions)), readings)
}

/// The same.
#[inline(never)]
fn settled(readings: &[Reading<f64>], sensors: u16, history: usize, instructions: Instructions) -> f64 {
    let storage = SettledSlots::new(sensors.into(), history).expect("a small local map");
    run(Fuser::settled(PAPER.0, PAPER.1, storage.with_instructions(instructions)), readings)
}

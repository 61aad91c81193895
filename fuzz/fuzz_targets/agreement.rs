//! The fuser in both precisions against the independent computation of `tests/agreement`, on logs drawn from the fuzzer's seed.
#![no_main]
#![allow(dead_code)]

#[path = "../../tests/agreement/compare.rs"]
mod compare;
#[path = "../../tests/agreement/cut.rs"]
mod cut;
#[path = "../../tests/agreement/draw.rs"]
mod draw;
#[path = "../../tests/agreement/history.rs"]
mod history;
#[path = "../../tests/agreement/log.rs"]
mod log;
#[path = "../../tests/agreement/margin.rs"]
mod margin;
#[path = "../../tests/agreement/record.rs"]
mod record;
#[path = "../../tests/agreement/reference.rs"]
mod reference;
#[path = "../../tests/agreement/tally.rs"]
mod tally;

use draw::{Draws, Frame};
use log::Float;
use tally::Tally;

libfuzzer_sys::fuzz_target!(|case: (u64, bool, Option<(u8, u8)>)| {
    let (seed, single, size) = case;
    let size = size.map(|(sensors, history)| (usize::from(sensors % 6) + 1, usize::from(history % 12) + 1));
    if single { compare::<f32>(seed, size, 5.0) } else { compare::<f64>(seed, size, 1.0) }
});

fn compare<T: Float>(seed: u64, size: Option<(usize, usize)>, least_angle_deg: f64) {
    let frame = Frame { size, least_angle: least_angle_deg.to_radians() };
    let log = draw::log(frame, &mut Draws::new(seed)).rounded::<T>();
    compare::compare::<T>(&log, &mut Tally::default());
}

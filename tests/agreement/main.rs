//! The fuser against an independent computation of the whole method, on random logs; and the local map case by case.

mod cases;
mod compare;
mod const_storage;
mod cut;
mod draw;
mod history;
mod log;
mod margin;
mod record;
mod reference;
mod tally;

use crate::{
    compare::compare,
    draw::{Draws, Frame},
    log::Float,
    tally::Tally,
};

/// Names the log at hand if the comparison panics.
struct AtHand {
    seed: u64,
}

impl Drop for AtHand {
    fn drop(&mut self) {
        if std::thread::panicking() {
            println!("in the log of seed {}", self.seed);
        }
    }
}

fn compare_many<T: Float>(logs: u64, first_seed: u64, least_angle_deg: f64) -> Tally {
    let mut tally = Tally::default();
    for seed in first_seed..first_seed + logs {
        let _at_hand = AtHand { seed };
        let frame = Frame { size: None, least_angle: least_angle_deg.to_radians() };
        let log = draw::log(frame, &mut Draws::new(seed)).rounded::<T>();
        compare::<T>(&log, &mut tally);
    }
    tally
}

#[test]
fn double_precision_agrees_with_the_reference() {
    let tally = compare_many::<f64>(3000, 0, 1.0);
    tally.print("f64");
    tally.assert_left_out_below(0.002);
    tally.assert_everything_occurred_at_least(500);
}

#[test]
fn single_precision_agrees_with_the_reference() {
    let tally = compare_many::<f32>(1500, 1_000_000, 5.0);
    tally.print("f32");
    tally.assert_left_out_below(0.01);
    tally.assert_everything_occurred_at_least(200);
}

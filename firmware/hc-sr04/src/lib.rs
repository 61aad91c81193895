//! The HC-SR04 and its kin: ultrasonic sensors with a trigger and an echo line, on `embedded-hal` 1.0. `no_std`, no heap,
//! nothing blocks.
//!
//! | step | where |
//! |---|---|
//! | a pulse on the trigger line, the width of the one on the echo line | [`HcSr04`] |
//! | that time as a range in air of some temperature | [`Air`] |
//! | one sensor after another, so that none hears another's sound | [`Turns`], [`Bank`] |
//!
//! Time is what the caller's clock says: microseconds that wrap, as a `u32`. Nothing here waits: [`HcSr04::poll`] looks at
//! the echo line and returns. Call it in the interrupt of the echo line's edges, with the captured time, and once more at
//! [`HcSr04::deadline`] for the edge that does not come. So it fits an interrupt-driven framework (RTIC: a hardware task
//! for the pin, a software task for the deadline), an asynchronous one (Embassy: `select` of
//! `sensor.echo_pin().wait_for_any_edge()` and a timer at the deadline), and a plain loop, where the loop's period is the
//! error of the time: 1 µs is 0.17 mm.
//!
//! ```
//! use hc_sr04::{Air, Measurement};
//! let air = Air::at_celsius(20.0)?;
//! // 5.83 ms there and back.
//! let range = Measurement::Echo { microseconds: 5_830 }.range(&air);
//! assert!((range - 1.0).abs() < 0.001);
//! # Ok::<(), hc_sr04::TemperatureOutOfRange>(())
//! ```
#![no_std]
#![forbid(unsafe_code)]

mod air;
mod bank;
mod sensor;
mod turns;

pub use crate::{
    air::{Air, TemperatureOutOfRange},
    bank::Bank,
    sensor::{Error, HcSr04, Look, Measurement},
    turns::Turns,
};

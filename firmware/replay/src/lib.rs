//! What the firmware image and the host both run, so that their output can be compared byte for byte: the recorded log,
//! the same log with faults, the worst case, and how an echo is written down. `no_std`, no heap, no panics.
//!
//! ```text
//! Log ─▶ Event ─ Ring::reading ─▶ Reading ─ Fuser ─▶ Outcome ─▶ Line
//! ```
#![no_std]
#![forbid(unsafe_code)]

mod adversary;
mod dice;
mod event;
mod faults;
mod line;
mod log;
mod outcome;
mod ring;

use atm_core::{DomainError, Scalar, Span};

pub use crate::{
    adversary::{Adversary, WORST_CROSSINGS, WORST_SUPPORT},
    event::Event,
    faults::{Fault, Faults},
    line::{Line, Written},
    log::{HEADER, Log, RECORD, Sweep},
    outcome::{Outcome, fuse},
    ring::Ring,
};

/// Sensors of the ring.
pub const SENSORS: usize = 16;

/// H: readings of each sensor in the local map.
pub const HISTORY: usize = 10;

/// What the local map spans over the recorded log: the 50 in (1.27 m) over which the paper's robot takes ten readings
/// (Sec. IV-D), with a spacing a little below the 5 in from one sweep to the next, so that each reading stays.
///
/// # Errors
/// None: the numbers are within their domains.
pub fn span<T: Scalar>() -> Result<Span<T>, DomainError> {
    let centimetres = |count| T::from_count(count) / T::from_count(100);
    Span::new(centimetres(127), HISTORY as u16)?.with_step(centimetres(12))
}

/// The fuser under test: `latest`, in single precision, on storage of const size.
pub type Fuser32<E> = atm_core::Fuser<f32, Store32, E>;

/// Its storage.
pub type Store32 = atm_core::LatestArrays<f32, SENSORS, HISTORY>;

#[cfg(test)]
mod tests {
    extern crate std;

    use atm_core::{Arrays, LatestArrays};

    use super::*;

    /// What `docs/firmware.md` says of memory, without the few bytes that do not grow.
    #[test]
    fn memory_grows_with_sensors_and_history_as_documented() {
        const fn latest<const S: usize, const H: usize>() -> (usize, usize) {
            (size_of::<LatestArrays<f32, S, H>>(), 48 * S * H + 20 * S)
        }
        for (size, expected) in [latest::<16, 10>(), latest::<8, 20>(), latest::<24, 12>()] {
            assert_eq!(size, expected);
        }
        assert_eq!(size_of::<Arrays<f32, 16, 10, 5>>(), 308 * 160 + 16 * 20);
    }

    #[test]
    fn sweep_comes_back_from_its_bytes() {
        let sweep =
            Sweep { milliseconds: 7000, position: [1.5, -2.0], heading: [0.6, 0.8], ranges: [f32::INFINITY; SENSORS] };
        let mut bytes = [0; HEADER.len() + 2 * RECORD];
        bytes[..HEADER.len()].copy_from_slice(&HEADER);
        bytes[HEADER.len() + RECORD..].copy_from_slice(&sweep.to_bytes());
        let log = Log::new(&bytes).unwrap();
        assert_eq!(log.sweeps(), 2);
        let last = log.event(31).unwrap();
        let expected =
            Event { t: 7_000_000_000, sensor: 15, range: f32::INFINITY, position: [1.5, -2.0], heading: [0.6, 0.8] };
        assert_eq!(last, expected);
        assert!(log.event(32).is_none());
        assert!(Log::new(&bytes[..bytes.len() - 1]).is_none(), "cut short");
        assert!(Log::new(&bytes[1..]).is_none(), "no header");
    }

    #[test]
    fn mounts_are_unit_vectors_a_sixteenth_of_a_turn_apart() {
        let ring = Ring::<f64>::nomad200().unwrap();
        let look = |sensor: u16| {
            let event = Event { t: 0, sensor, range: 1.0, position: [0.0; 2], heading: [1.0, 0.0] };
            ring.reading(&event).pose.rotation
        };
        for sensor in 0..SENSORS as u16 {
            let (here, next) = (look(sensor), look((sensor + 1) % SENSORS as u16));
            assert!((here.re.hypot(here.im) - 1.0).abs() < 1e-15);
            assert!((here.angle_to(&next) - core::f64::consts::PI / 8.0).abs() < 1e-15, "{sensor}");
        }
    }
}

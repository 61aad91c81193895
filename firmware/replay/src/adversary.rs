//! The worst a reading can meet: a full local map, every arc of which crosses it twice; or agrees with it on one point.

use atm_core::Scalar;

use crate::{HISTORY, SENSORS, dice::Dice, event::Event, ring::Ring};

/// How many readings meet the worst, of either sort in turn.
const ROUNDS: usize = SENSORS;

/// Readings that agree with each of the second sort.
pub const WORST_SUPPORT: u32 = (SENSORS * HISTORY - 1) as u32;

/// Crossings that each of those has: two with every other arc of a full local map.
pub const WORST_CROSSINGS: u32 = 2 * WORST_SUPPORT;

/// Readings for [`Ring::boundless`]: sensors about (1.2 m, 0) that look back towards the origin fill the local map, and
/// then one at the origin looks at them; once for each sensor.
///
/// Two circles of about 1 m, 1.2 m apart, cross at (0.6, ±0.8), at some 74°, within both half-turn beams: 159 partners,
/// 318 crossings, in no order. In every second round all of them hear what stands at (0.6, 0.8), within a few millimetres.
#[derive(Debug, Clone, Copy)]
pub struct Adversary {
    dice: Dice,
}

impl Adversary {
    /// The adversary of the test.
    pub const fn new() -> Self {
        Self { dice: Dice(1) }
    }

    /// Reading number `index`, which must count up from 0; `None` past the end.
    pub fn event(&mut self, ring: &Ring<f32>, index: u32) -> Option<Event<f32>> {
        const FILLING: usize = SENSORS * HISTORY;
        let (round, place) = (index as usize / (FILLING + 1), index as usize % (FILLING + 1));
        if round == ROUNDS {
            return None;
        }
        let mut about = |middle: f32| middle + (self.dice.share() - 0.5) * 0.2;
        let (any, x, y) = (about(1.0), about(1.2), about(0.0));
        let agreed = |at: [f32; 2]| {
            let [ahead, aside] = [at[0] - 0.6, at[1] - 0.8];
            (ahead * ahead + aside * aside).square_root() + (any - 1.0) * 0.05
        };
        let range = |at| if round % 2 == 0 { any } else { agreed(at) };
        Some(if place == FILLING {
            ring.aimed(i64::from(index), round as u16, [0.0, 0.0], [1.0, 0.0], range([0.0, 0.0]))
        } else {
            ring.aimed(i64::from(index), (place % SENSORS) as u16, [x, y], [-1.0, 0.0], range([x, y]))
        })
    }
}

impl Default for Adversary {
    fn default() -> Self {
        Self::new()
    }
}

//! The worst a reading can meet: a full local map, every arc of which crosses it twice.

use crate::{HISTORY, SENSORS, dice::Dice, event::Event, ring::Ring};

/// How many readings meet the worst.
const ROUNDS: usize = SENSORS;

/// Crossings that each of those has: two with every other arc of a full local map.
pub const WORST_CROSSINGS: u32 = 2 * (SENSORS * HISTORY - 1) as u32;

/// Readings for [`Ring::boundless`]: sensors about (1.2 m, 0) that look back towards the origin fill the local map, and
/// then one at the origin looks at them; once for each sensor.
///
/// Two circles of about 1 m, 1.2 m apart, cross at (0.6, ±0.8), at some 74°, within both half-turn beams: 159 partners,
/// 318 crossings, in no order.
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
        let range = about(1.0);
        Some(if place == FILLING {
            ring.aimed(i64::from(index), round as u16, [0.0, 0.0], [1.0, 0.0], range)
        } else {
            let at = [about(1.2), about(0.0)];
            ring.aimed(i64::from(index), (place % SENSORS) as u16, at, [-1.0, 0.0], range)
        })
    }
}

impl Default for Adversary {
    fn default() -> Self {
        Self::new()
    }
}

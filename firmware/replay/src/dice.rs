//! Numbers that look random and are the same everywhere.

/// A linear congruential generator (Numerical Recipes' constants).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Dice(pub u32);

impl Dice {
    /// The next sixteen bits.
    pub(crate) const fn bits(&mut self) -> u16 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 16) as u16
    }

    /// The next number from [0, 1).
    pub(crate) fn share(&mut self) -> f32 {
        f32::from(self.bits()) / 65_536.0
    }
}

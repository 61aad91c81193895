//! Random numbers that are the same on every machine: one stream of ChaCha8 for each effect.
use std::f64::consts::TAU;

use rand_chacha::{
    ChaCha8Rng,
    rand_core::{Rng, SeedableRng},
};

/// What numbers are drawn for. Each has a stream of its own, so that switching one effect on leaves the others' draws alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Purpose {
    Bumps = 0,
    RangeNoise = 1,
    Dropout = 2,
    Crosstalk = 3,
    Odometry = 4,
}

/// A stream of random numbers.
#[derive(Debug, Clone)]
pub(super) struct Dice(ChaCha8Rng);

impl Dice {
    /// The stream of a seed for one purpose. Seeds are independent of each other: the seed is the cipher's key.
    pub fn new(seed: u64, purpose: Purpose) -> Self {
        let mut key = [0; 32];
        for (byte, part) in key.iter_mut().zip(seed.to_le_bytes()) {
            *byte = part;
        }
        let mut random = ChaCha8Rng::from_seed(key);
        random.set_stream(purpose as u64);
        Self(random)
    }

    /// A draw from [low, high): 53 random bits over 2⁵³.
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        let share = (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        low + (high - low) * share
    }

    /// A draw from the normal distribution of mean 0 and deviation 1 (Box and Muller 1958); always two numbers.
    pub fn normal(&mut self) -> f64 {
        // In (0, 1], so that the logarithm is finite.
        let radius = (-2.0 * libm::log(1.0 - self.uniform(0.0, 1.0))).sqrt();
        radius * libm::cos(self.uniform(0.0, TAU))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_and_seeds_differ_and_repeat() {
        let first = |seed, purpose| Dice::new(seed, purpose).uniform(0.0, 1.0);
        assert_eq!(first(1, Purpose::Bumps), first(1, Purpose::Bumps));
        assert_ne!(first(1, Purpose::Bumps), first(2, Purpose::Bumps));
        assert_ne!(first(1, Purpose::Bumps), first(1, Purpose::Dropout));
    }

    #[test]
    fn normal_has_mean_0_and_deviation_1() {
        let mut dice = Dice::new(7, Purpose::RangeNoise);
        let draws: Vec<f64> = (0..100_000).map(|_| dice.normal()).collect();
        let mean = draws.iter().sum::<f64>() / 1e5;
        let variance = draws.iter().map(|draw| (draw - mean).powi(2)).sum::<f64>() / 1e5;
        // Five deviations of the mean's own scatter, 1 / √n, and of the variance's, √(2/n).
        assert!(mean.abs() < 0.016 && (variance - 1.0).abs() < 0.023, "{mean} {variance}");
        let beyond = draws.iter().filter(|draw| draw.abs() > 1.959_964).count();
        assert!((4650..5350).contains(&beyond), "5 % lie beyond 1.96 deviations: {beyond}");
    }
}

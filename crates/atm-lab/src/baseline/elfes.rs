//! The Bayesian occupancy grid (Elfes, *Using Occupancy Grids for Mobile Robot Perception and Navigation*, IEEE Computer 22(6), 1989;
//! Sec. II-B).

use atm::error::Result;
use atm_core::{Limits, Meaning, Point2, Reading};

use super::{Evidence, Findings, Method, Sight, sight::freed};
use crate::map::{BeamCell, Footprint, Grid};

/// Cells with the log-odds of being occupied, ½ at first, to which each reading adds its own.
///
/// The sensor is p(r | z, α) ∝ exp(−½ ((r − z)²/σr² + α²/σα²)). A sensor without error says 0 before the echo, 1 at it and ½ behind it.
/// Averaged over the error of the range that is P(ρ) = ½ Φ(ρ⁻) + Φ(ρ⁺) − Φ(ρ⁻), with ρ∓ = (ρ ∓ cell/2 − r)/σr; off the boresight it
/// fades towards ½ with w = exp(−½ α²/σα²): ½ + w (P − ½), clamped to \[0.02, 0.98\].
#[derive(Debug)]
pub struct Elfes {
    grid: Grid<f64>,
    limits: Vec<Limits<f64>>,
}

impl Elfes {
    /// The least that one reading may say; the most is as far from 1.
    const LEAST: f64 = 0.02;
    /// σα as a share of the full beam φ.
    const SPREAD: f64 = 0.25;

    /// A grid of cells `cell` metres wide, for sensors with these `limits`.
    ///
    /// # Errors
    /// As [`Grid::new`].
    pub fn new(cell: f64, limits: Vec<Limits<f64>>) -> Result<Self> {
        Ok(Self { grid: Grid::new(cell, Point2::origin(), f64::NAN)?, limits })
    }

    /// Adds what a reading says of the cells up to `to` metres; `on_axis` is P(ρ).
    fn update(&mut self, footprint: &Footprint, to: f64, on_axis: impl Fn(f64) -> f64) -> Result<()> {
        let spread = Self::SPREAD * 2.0 * footprint.half_beam;
        footprint.cells(&mut self.grid, 0.0, to, |grid, BeamCell { cell, distance, azimuth }| {
            let share = azimuth / spread;
            let weight = libm::exp(-0.5 * share * share);
            let says = (0.5 + weight * (on_axis(distance) - 0.5)).clamp(Self::LEAST, 1.0 - Self::LEAST);
            let odds = grid.get_mut(cell)?;
            // The first to speak of the cell finds it at ½, whose log-odds are 0.
            *odds = if odds.is_nan() { 0.0 } else { *odds } + libm::log(says / (1.0 - says));
            Ok(())
        })
    }
}

/// Φ, the standard normal distribution.
fn normal(x: f64) -> f64 {
    0.5 * (1.0 + libm::erf(x / std::f64::consts::SQRT_2))
}

impl Method for Elfes {
    fn take(&mut self, reading: &Reading<f64>) -> Result<()> {
        let cell = self.grid.resolution();
        if let Some(sight) = Sight::new(reading) {
            let sigma = sight.resolution.max(cell);
            let profile = |distance: f64| {
                // Four σ and a cell before it nothing is left of the echo, to four places.
                if distance < sight.range - 4.0 * sigma - cell {
                    return 0.0;
                }
                let [near, far] = [-1.0, 1.0].map(|side| normal((distance + side * cell / 2.0 - sight.range) / sigma));
                0.5 * near + far - near
            };
            // And as far behind it everything is ½.
            return self.update(&sight.footprint(), sight.range + 4.0 * sigma, profile);
        }
        match self.limits.get(usize::from(reading.sensor)).map(Limits::max) {
            Some(reach) if reading.range.meaning() == Meaning::Beyond && reach.is_finite() => {
                self.update(&freed(reading), reach, |_| 0.0)
            }
            _ => Ok(()),
        }
    }

    fn finish(self: Box<Self>) -> Result<Option<Findings>> {
        let mut grid = self.grid;
        let odds: Vec<_> = grid.cells().filter(|(_, odds)| !odds.is_nan()).collect();
        for (cell, odds) in odds {
            *grid.get_mut(cell)? = 1.0 / (1.0 + libm::exp(-odds));
        }
        Ok(Some(Findings::map(Evidence { grid, occupied_above: 0.5, free_below: 0.5 })))
    }
}

//! What robots run today: the update rule of ROS's range layer (`range_sensor_layer` of `navigation_layers` for ROS, the plugin
//! of the same name of `nav2_costmap_2d` for ROS 2), by its formulas.

use atm::error::Result;
use atm_core::{Point2, Reading, Vector2};

use super::{Evidence, Findings, Method, Sight};
use crate::map::{Cell, Grid};

/// A cost map in bytes, each cell of which a reading updates by Bayes' rule with an inverse model of its cone.
///
/// With γ(θ) = 1 − (θ/β)², 0 beyond β, δ(ρ) = 1 − (1 + tanh(2 (ρ − 1.2))) / 2, λ = δ γ and the cell's width w as a relative error:
/// before r (1 − 2 w) the model says ½ (1 − λ); up to r (1 − w) it rises, λ/2 ((ρ − r (1 − 2 w)) / (r w))² + ½ (1 − λ); up to
/// r (1 + w) it is ½ + λ (½ − ½ ((r − ρ) / (r w))²); behind that ½. The cell on the axis at r is set to a cost of 233 first.
///
/// All cells of the box around the cone are updated. Those of which the model says ½ are, too: their costs go through
/// probabilities and back, and what is cut off there is lost.
#[derive(Debug)]
pub struct RangeLayer {
    grid: Grid<u8>,
    /// What becomes of each cost where the model says ½.
    unmoved: [u8; 256],
}

/// A cost of which nothing is known, and at which cells begin: ½ of 254, rounded down.
const BEGINNING: u8 = 127;
/// The cost that the target's cell is set to.
const TARGET: u8 = 233;
/// The cost of certainty.
const CERTAIN: f64 = 254.0;
/// φ, the distance in metres at which trust has fallen to half; the layer's default.
const TRUSTED: f64 = 1.2;
/// The box of cells that are updated reaches so many times as far as the reading.
const BOX: f64 = 1.2;
/// Thresholds of the layer's defaults.
const MARK: f64 = 0.8;
const CLEAR: f64 = 0.2;

/// The model's probability that a cell at `distance` and `azimuth` is occupied.
fn model(range: f64, half_beam: f64, width: f64, distance: f64, azimuth: f64) -> f64 {
    let off = azimuth / half_beam;
    let gamma = if azimuth.abs() > half_beam { 0.0 } else { 1.0 - off * off };
    let delta = 1.0 - (1.0 + libm::tanh(2.0 * (distance - TRUSTED))) / 2.0;
    let lambda = delta * gamma;
    let error = width * range;
    if distance < range - 2.0 * error {
        0.5 * (1.0 - lambda)
    } else if distance < range - error {
        let risen = (distance - (range - 2.0 * error)) / error;
        lambda * 0.5 * risen * risen + 0.5 * (1.0 - lambda)
    } else if distance < range + error {
        let fallen = (range - distance) / error;
        lambda * (0.5 - 0.5 * fallen * fallen) + 0.5
    } else {
        0.5
    }
}

/// A probability as a cost: the fraction is cut off.
fn cost(probability: f64) -> u8 {
    (probability * CERTAIN) as u8
}

fn probability(cost: u8) -> f64 {
    f64::from(cost) / CERTAIN
}

impl RangeLayer {
    /// A cost map of cells `cell` metres wide.
    ///
    /// # Errors
    /// As [`Grid::new`].
    pub fn new(cell: f64) -> Result<Self> {
        let mut unmoved = [0; 256];
        for (cost, next) in (0..=u8::MAX).zip(&mut unmoved) {
            *next = updated(0.5, cost);
        }
        Ok(Self { grid: Grid::new(cell, Point2::origin(), BEGINNING)?, unmoved })
    }

    fn update(&mut self, sight: &Sight, cell: Cell) -> Result<()> {
        let point = self.grid.center(cell);
        let before = self.grid.get(cell);
        let width = self.grid.resolution();
        let distance = (point - sight.position).norm();
        let silent = !sight.sees(point) || distance >= sight.range + width * sight.range;
        let after = if silent {
            self.unmoved.get(usize::from(before)).copied().unwrap_or(before)
        } else {
            updated(model(sight.range, sight.half_beam, width, distance, sight.azimuth(point)), before)
        };
        if after != before {
            *self.grid.get_mut(cell)? = after;
        }
        Ok(())
    }
}

/// Bayes' rule on costs.
fn updated(says: f64, before: u8) -> u8 {
    let prior = probability(before);
    let (occupied, not) = (says * prior, (1.0 - says) * (1.0 - prior));
    cost(occupied / (occupied + not))
}

impl Method for RangeLayer {
    fn take(&mut self, reading: &Reading<f64>) -> Result<()> {
        let Some(sight) = Sight::new(reading) else {
            return Ok(());
        };
        let target = self.grid.cell(sight.middle())?;
        *self.grid.get_mut(target)? = TARGET;
        // The box around the cone's tip and its two sides.
        let (sin, cos) = libm::sincos(sight.half_beam);
        let aside = Vector2::new(-sight.boresight.y, sight.boresight.x);
        let side = |side: f64| sight.position + (sight.boresight * cos + aside * (side * sin)) * (sight.range * BOX);
        let corners = [sight.position, side(-1.0), side(1.0)];
        let mut cells = [target; 3];
        for (cell, corner) in cells.iter_mut().zip(corners) {
            *cell = self.grid.cell(corner)?;
        }
        let [tip, right, left] = cells;
        for row in tip.row.min(right.row).min(left.row)..=tip.row.max(right.row).max(left.row) {
            for column in tip.column.min(right.column).min(left.column)..=tip.column.max(right.column).max(left.column)
            {
                self.update(&sight, Cell { row, column })?;
            }
        }
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<Option<Findings>> {
        let mut grid = Grid::new(self.grid.resolution(), Point2::origin(), f64::NAN)?;
        for (cell, cost) in self.grid.cells().filter(|&(_, cost)| cost != BEGINNING) {
            *grid.get_mut(cell)? = probability(cost);
        }
        // The layer compares costs: above the one of the mark threshold is lethal, below that of the clear threshold is free.
        let (mark, clear) = (probability(cost(MARK)), probability(cost(CLEAR)));
        Ok(Some(Findings::map(Evidence { grid, occupied_above: mark, free_below: clear })))
    }
}

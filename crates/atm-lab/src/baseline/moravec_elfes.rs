//! The first occupancy grid (Moravec and Elfes, *High Resolution Maps from Wide Angle Sonar*, IEEE International Conference on Robotics
//! and Automation, 1985; Sec. II-B).

use atm::error::{Error, Result};
use atm_core::{Limits, Point2, Reading};

use super::{Evidence, Findings, MOST_READINGS, Method, Sight};
use crate::map::{BeamCell, Grid};

/// How empty and how occupied a cell is believed to be.
#[derive(Debug, Clone, Copy, Default)]
struct Belief {
    empty: f64,
    occupied: f64,
}

/// Cells in \[−1, 1\]: 0 unknown, below empty, above occupied.
///
/// For a cell at distance ρ and angle θ off the boresight of a reading R with error ε and beam ω:
/// E = (1 − ((ρ − Rmin) / (R − ε − Rmin))²)(1 − (2θ/ω)²) up to R − ε, O = (1 − ((ρ − R)/ε)²)(1 − (2θ/ω)²) within R ± ε.
/// First all readings are superposed as empty, Emp ← Emp + E − Emp E; then each as occupied: O ← O (1 − Emp), divided by its sum over
/// the beam, Occ ← Occ + O − Occ O. A cell is Occ where Occ ≥ Emp, else −Emp. Readings beyond the largest range are left out, as there.
#[derive(Debug)]
pub struct MoravecElfes {
    cell: f64,
    limits: Vec<Limits<f64>>,
    sights: Vec<Sight>,
}

impl MoravecElfes {
    /// A map of cells `cell` metres wide, for sensors with these `limits`.
    pub const fn new(cell: f64, limits: Vec<Limits<f64>>) -> Self {
        Self { cell, limits, sights: Vec::new() }
    }

    /// ε, in metres: the step of the ranges, and so much at least that a cell is hit in every direction.
    fn error(&self, sight: &Sight) -> f64 {
        sight.resolution.max(self.cell)
    }

    /// Superposes the reading as empty.
    fn empty(&self, grid: &mut Grid<Belief>, sight: &Sight) -> Result<()> {
        let nearest = self.limits.get(usize::from(sight.sensor)).map_or(0.0, Limits::min);
        let clear = sight.range - self.error(sight);
        if clear <= nearest {
            return Ok(());
        }
        sight.footprint().cells(grid, 0.0, clear, |grid, at| {
            // Nearer than the sensor can measure is as empty as can be.
            let share = ((at.distance - nearest) / (clear - nearest)).max(0.0);
            let empty = (1.0 - share * share) * off_axis(&at, sight);
            let belief = grid.get_mut(at.cell)?;
            belief.empty += empty - belief.empty * empty;
            Ok(())
        })
    }

    /// Superposes the reading as occupied, where the map is not empty.
    fn occupy(&self, grid: &mut Grid<Belief>, sight: &Sight) -> Result<()> {
        let error = self.error(sight);
        let mut cells = Vec::new();
        sight.footprint().cells(grid, sight.range - error, sight.range + error, |grid, at| {
            let share = (at.distance - sight.range) / error;
            let occupied = (1.0 - share * share) * off_axis(&at, sight) * (1.0 - grid.get(at.cell).empty);
            cells.push((at.cell, occupied));
            Ok(())
        })?;
        let sum: f64 = cells.iter().map(|(_, occupied)| occupied).sum();
        if !(sum > 0.0) {
            return Ok(());
        }
        for (cell, occupied) in cells {
            let belief = grid.get_mut(cell)?;
            belief.occupied += occupied / sum - belief.occupied * (occupied / sum);
        }
        Ok(())
    }
}

/// 1 − (2θ/ω)².
fn off_axis(at: &BeamCell, sight: &Sight) -> f64 {
    let share = at.azimuth / sight.half_beam;
    1.0 - share * share
}

impl Method for MoravecElfes {
    fn take(&mut self, reading: &Reading<f64>) -> Result<()> {
        if self.sights.len() >= MOST_READINGS {
            return Err(Error::Map { message: format!("more than {MOST_READINGS} readings to superpose") });
        }
        self.sights.extend(Sight::new(reading));
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<Option<Findings>> {
        let mut beliefs = Grid::new(self.cell, Point2::origin(), Belief::default())?;
        for sight in &self.sights {
            self.empty(&mut beliefs, sight)?;
        }
        for sight in &self.sights {
            self.occupy(&mut beliefs, sight)?;
        }
        let mut grid = Grid::new(self.cell, Point2::origin(), f64::NAN)?;
        for (cell, Belief { empty, occupied }) in beliefs.cells() {
            if empty > 0.0 || occupied > 0.0 {
                *grid.get_mut(cell)? = if occupied >= empty { occupied } else { -empty };
            }
        }
        Ok(Some(Findings::map(Evidence { grid, occupied_above: 0.0, free_below: 0.0 })))
    }
}

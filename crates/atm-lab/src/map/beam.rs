//! How the sector of one beam lies on a grid.

use atm::error::Result;
use atm_core::{Point2, Vector2};

use super::grid::{Cell, Grid};

/// One cell under a beam.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeamCell {
    /// The cell.
    pub cell: Cell,
    /// Distance of its middle from the sensor, in metres.
    pub distance: f64,
    /// Angle of its middle off the boresight, counter-clockwise, in radians.
    pub azimuth: f64,
}

/// The sector that a beam covers up to some distance.
#[derive(Debug, Clone, Copy)]
pub struct Footprint {
    /// Where the sensor is.
    pub sensor: Point2<f64>,
    /// Unit vector of the boresight.
    pub boresight: Vector2<f64>,
    /// Half the beam, in radians, at most a quarter turn.
    pub half_beam: f64,
}

impl Footprint {
    /// Visits the cells whose middles lie in the beam, at `from`..=`to` metres from the sensor, row by row.
    ///
    /// # Errors
    /// The sector reaches farther than the grid can, or the visitor's.
    pub fn cells<T: Copy>(
        &self,
        grid: &mut Grid<T>,
        from: f64,
        to: f64,
        mut visit: impl FnMut(&mut Grid<T>, BeamCell) -> Result<()>,
    ) -> Result<()> {
        let (low, high) = self.bounds(to);
        let (first, last) = (grid.cell(low)?, grid.cell(high)?);
        // With |azimuth| ≤ half a beam ≤ 90°: ahead² ≥ cos² · distance², without a root for cells off the beam.
        let cos_half = libm::cos(self.half_beam);
        let cos_squared = cos_half * cos_half;
        for row in first.row..=last.row {
            for column in first.column..=last.column {
                let cell = Cell { row, column };
                let offset = grid.center(cell) - self.sensor;
                let ahead = self.boresight.dot(&offset);
                let squared = offset.norm_squared();
                if !(ahead >= 0.0 && ahead * ahead >= cos_squared * squared) {
                    continue;
                }
                let distance = libm::sqrt(squared);
                if !(distance >= from && distance <= to) {
                    continue;
                }
                let azimuth = libm::atan2(self.boresight.perp(&offset), ahead);
                visit(grid, BeamCell { cell, distance, azimuth })?;
            }
        }
        Ok(())
    }

    /// Opposite corners of a box around the sector: its tip, the ends of its arc, and where the arc runs farthest along an axis.
    fn bounds(&self, to: f64) -> (Point2<f64>, Point2<f64>) {
        let (sin, cos) = libm::sincos(self.half_beam);
        let aside = Vector2::new(-self.boresight.y, self.boresight.x);
        let ends = [1.0, -1.0].map(|side| self.boresight * cos + aside * (side * sin));
        let axes = [Vector2::x(), Vector2::y(), -Vector2::x(), -Vector2::y()];
        let farthest = axes.into_iter().filter(|axis| self.boresight.dot(axis) >= cos);
        let (mut low, mut high) = (self.sensor, self.sensor);
        for direction in ends.into_iter().chain(farthest) {
            let point = self.sensor + direction * to;
            low = Point2::new(low.x.min(point.x), low.y.min(point.y));
            high = Point2::new(high.x.max(point.x), high.y.max(point.y));
        }
        (low, high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_middle_in_the_sector_is_visited_once_and_no_other() {
        // Compared with a test of every cell of a wide square, by angles.
        for (yaw_deg, half_deg) in [(0.0f64, 11.25f64), (90.0, 40.0), (200.0, 90.0), (-47.0, 5.0)] {
            let yaw = yaw_deg.to_radians();
            let footprint = Footprint {
                sensor: Point2::new(0.31, -0.22),
                boresight: Vector2::new(yaw.cos(), yaw.sin()),
                half_beam: half_deg.to_radians(),
            };
            let mut grid = Grid::new(0.05, Point2::origin(), 0u32).unwrap();
            let count = |grid: &mut Grid<u32>, at: BeamCell| {
                *grid.get_mut(at.cell)? += 1;
                Ok(())
            };
            footprint.cells(&mut grid, 0.4, 1.1, count).unwrap();
            for row in -40..40 {
                for column in -40..40 {
                    let cell = Cell { row, column };
                    let offset = grid.center(cell) - footprint.sensor;
                    let off = (offset.y.atan2(offset.x) - yaw).rem_euclid(std::f64::consts::TAU);
                    let off = off.min(std::f64::consts::TAU - off);
                    let inside = off <= footprint.half_beam && (0.4..=1.1).contains(&offset.norm());
                    assert_eq!(grid.get(cell), u32::from(inside), "{yaw_deg} {half_deg} {cell:?}");
                }
            }
        }
    }
}

//! What a method can say: points, segments, a grid of evidence.

use atm::error::{Error, Result};
use atm_core::Point2;

use super::sight::Sight;
use crate::map::{Grid, Occupancy};

/// A point at which a method believes something to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mark {
    /// Where, in the fixed frame, in metres.
    pub position: Point2<f64>,
    /// Time in nanoseconds and sensor of the reading that it speaks of, where it speaks of one.
    pub key: Option<(i64, u16)>,
    /// Its direction from that reading's boresight, counter-clockwise, in radians.
    pub azimuth: Option<f64>,
    /// That reading, in metres.
    pub range: Option<f64>,
}

impl Mark {
    /// A point that speaks of no reading in particular.
    pub const fn anonymous(position: Point2<f64>) -> Self {
        Self { position, key: None, azimuth: None, range: None }
    }

    /// A point that speaks of the reading `sight`, seen from there.
    pub fn of(sight: &Sight, position: Point2<f64>) -> Self {
        Self {
            position,
            key: Some((sight.t, sight.sensor)),
            azimuth: Some(sight.azimuth(position)),
            range: Some(sight.range),
        }
    }
}

/// A straight piece of surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// Its ends: the echoes of the two readings that it was found from.
    pub ends: [Mark; 2],
}

impl Segment {
    /// Distance of the points by which a segment is scored, in metres: the cells' width of the grid methods.
    const SPACING: f64 = super::CELL;

    /// Its ends, and points between them no farther apart than [`super::CELL`].
    ///
    /// # Errors
    /// More than a million: no robot saw that.
    pub fn marks(&self) -> Result<Vec<Mark>> {
        const MOST: f64 = 1e6;
        let [from, to] = self.ends;
        let along = to.position - from.position;
        let steps = libm::ceil(along.norm() / Self::SPACING);
        if !(steps <= MOST) {
            return Err(Error::Map { message: format!("a segment of {} m is too long to be scored", along.norm()) });
        }
        let between = (1..steps as u32).map(|step| Mark::anonymous(from.position + along * (f64::from(step) / steps)));
        Ok([from].into_iter().chain(between).chain([to]).collect())
    }
}

/// Evidence in cells: NaN where there is none, else a number that grows with the belief that something is there.
#[derive(Debug, Clone)]
pub struct Evidence {
    /// The cells.
    pub grid: Grid<f64>,
    /// Above this a cell is occupied: the method's own threshold.
    pub occupied_above: f64,
    /// Below this a cell is free; −∞ where the method knows no free space.
    pub free_below: f64,
}

impl Evidence {
    /// The middles of the cells above `threshold`.
    pub fn marks(&self, threshold: f64) -> Vec<Mark> {
        let occupied = self.grid.cells().filter(|&(_, value)| value > threshold);
        occupied.map(|(cell, _)| Mark::anonymous(self.grid.center(cell))).collect()
    }

    /// Which cells are occupied and which free, by the method's own thresholds.
    ///
    /// # Errors
    /// As [`Occupancy::new`].
    pub fn occupancy(&self) -> Result<Occupancy> {
        Occupancy::new(&self.grid, |value| {
            let occupied = (value > self.occupied_above).then_some(true);
            occupied.or_else(|| (value < self.free_below).then_some(false))
        })
    }
}

/// All that a method found.
#[derive(Debug, Clone, Default)]
pub struct Findings {
    /// Points, in the order of their readings where they have some.
    pub points: Vec<Mark>,
    /// Straight pieces.
    pub segments: Vec<Segment>,
    /// A map.
    pub evidence: Option<Evidence>,
}

impl Findings {
    /// Points alone.
    pub fn points(points: Vec<Mark>) -> Self {
        Self { points, ..Self::default() }
    }

    /// A map alone.
    pub fn map(evidence: Evidence) -> Self {
        Self { evidence: Some(evidence), ..Self::default() }
    }

    /// Everything as points: those of segments no farther apart than [`super::CELL`], those of a map by its own threshold.
    ///
    /// # Errors
    /// As [`Segment::marks`].
    pub fn marks(&self) -> Result<Vec<Mark>> {
        let mut marks = self.points.clone();
        for segment in &self.segments {
            marks.extend(segment.marks()?);
        }
        if let Some(evidence) = &self.evidence {
            marks.extend(evidence.marks(evidence.occupied_above));
        }
        Ok(marks)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::Cell;

    #[test]
    fn a_segment_is_scored_by_points_one_cell_apart() {
        let mark = |x: f64| Mark::anonymous(Point2::new(x, 1.0));
        let marks = Segment { ends: [mark(0.0), mark(0.12)] }.marks().unwrap();
        let at: Vec<f64> = marks.iter().map(|mark| (mark.position.x * 1e6).round() / 1e6).collect();
        assert_eq!(at, [0.0, 0.04, 0.08, 0.12]);
        assert!(Segment { ends: [mark(0.0), mark(1e9)] }.marks().is_err());
    }

    #[test]
    fn cells_above_the_threshold_are_points_and_cells_below_the_other_are_free() {
        let mut grid = Grid::new(1.0, Point2::origin(), f64::NAN).unwrap();
        for (column, value) in [(0, 0.2), (1, 0.5), (2, 0.9)] {
            *grid.get_mut(Cell { row: 0, column }).unwrap() = value;
        }
        let evidence = Evidence { grid, occupied_above: 0.5, free_below: 0.3 };
        assert_eq!(evidence.marks(0.5), [Mark::anonymous(Point2::new(2.5, 0.5))], "the threshold itself is not above");
        assert_eq!(evidence.occupancy().unwrap().pgm(), [b"P5\n3 1\n255\n".as_slice(), &[254, 205, 0]].concat());
    }
}

//! Directional maximum (Barshan, *Directional Processing of Ultrasonic Arc Maps and Its Comparison with Existing Techniques*,
//! International Journal of Robotics Research 26(8), 2007).

use std::collections::BTreeMap;

use atm::error::{Error, Result};
use atm_core::{Point2, Reading, Vector2};

use super::{Findings, MOST_READINGS, Mark, Method, Sight, arc_map::ArcMap};
use crate::map::Cell;

/// Of each column of the arc map along the direction of interest only the cell with the most arcs stays.
///
/// The direction of interest points away from the path, square to its principal axis, on either side. Of cells with as many arcs the
/// one nearest to the path stays.
#[derive(Debug)]
pub struct DirectionalMaximum {
    cell: f64,
    sights: Vec<Sight>,
}

/// A frame whose x axis is the principal axis of the path.
struct Axis {
    middle: Point2<f64>,
    along: Vector2<f64>,
}

impl Axis {
    /// The axis of largest variance of the robot's positions, one for each echo.
    fn of(sights: &[Sight]) -> Self {
        let count = sights.len().max(1) as f64;
        let middle = Point2::from(sights.iter().fold(Vector2::zeros(), |sum, sight| sum + sight.robot.coords) / count);
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for offset in sights.iter().map(|sight| sight.robot - middle) {
            xx += offset.x * offset.x;
            xy += offset.x * offset.y;
            yy += offset.y * offset.y;
        }
        let (sin, cos) = libm::sincos(0.5 * libm::atan2(2.0 * xy, xx - yy));
        Self { middle, along: Vector2::new(cos, sin) }
    }

    fn turned(&self, vector: Vector2<f64>) -> Vector2<f64> {
        Vector2::new(self.along.dot(&vector), self.along.perp(&vector))
    }

    fn enter(&self, sight: &Sight) -> Sight {
        Sight {
            position: Point2::from(self.turned(sight.position - self.middle)),
            boresight: self.turned(sight.boresight),
            robot: Point2::from(self.turned(sight.robot - self.middle)),
            ..*sight
        }
    }

    fn leave(&self, point: Point2<f64>) -> Point2<f64> {
        self.middle + self.along * point.x + Vector2::new(-self.along.y, self.along.x) * point.y
    }
}

impl DirectionalMaximum {
    /// A map of cells `cell` metres wide.
    pub const fn new(cell: f64) -> Self {
        Self { cell, sights: Vec::new() }
    }

    /// The row of the path in each column that it passes, on average.
    fn path(map: &ArcMap, sights: &[Sight]) -> Result<BTreeMap<i32, i32>> {
        let mut rows: BTreeMap<i32, (i64, i64)> = BTreeMap::new();
        for sight in sights {
            let cell = map.grid.cell(sight.robot)?;
            let (sum, count) = rows.entry(cell.column).or_default();
            *sum += i64::from(cell.row);
            *count += 1;
        }
        Ok(rows.into_iter().map(|(column, (sum, count))| (column, sum.div_euclid(count) as i32)).collect())
    }

    /// The path's row in the column nearest to `column`.
    fn nearest(path: &BTreeMap<i32, i32>, column: i32) -> Option<i32> {
        let (before, after) = (path.range(..=column).next_back(), path.range(column..).next());
        let nearest = before.into_iter().chain(after).min_by_key(|(at, _)| at.abs_diff(column));
        nearest.map(|(_, &row)| row)
    }
}

impl Method for DirectionalMaximum {
    fn take(&mut self, reading: &Reading<f64>) -> Result<()> {
        if self.sights.len() >= MOST_READINGS {
            return Err(Error::Map { message: format!("more than {MOST_READINGS} arcs to draw") });
        }
        self.sights.extend(Sight::new(reading));
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<Option<Findings>> {
        let axis = Axis::of(&self.sights);
        let sights: Vec<Sight> = self.sights.iter().map(|sight| axis.enter(sight)).collect();
        let mut map = ArcMap::new(self.cell)?;
        for sight in &sights {
            map.draw(sight)?;
        }
        let path = Self::path(&map, &sights)?;
        // By column and side: votes, and how far from the path.
        let mut best: BTreeMap<(i32, bool), (f64, u32, Cell)> = BTreeMap::new();
        for (cell, votes) in map.grid.cells().filter(|(_, votes)| !votes.is_nan()) {
            let Some(row) = Self::nearest(&path, cell.column) else {
                continue;
            };
            let candidate = (votes, cell.row.abs_diff(row), cell);
            let place = best.entry((cell.column, cell.row >= row)).or_insert(candidate);
            if votes > place.0 || (votes == place.0 && candidate.1 < place.1) {
                *place = candidate;
            }
        }
        let points = best.values().map(|&(_, _, cell)| Mark::anonymous(axis.leave(map.grid.center(cell))));
        Ok(Some(Findings::points(points.collect())))
    }
}

//! Triangulation-based fusion (Wijk and Christensen, *Triangulation-Based Fusion of Sonar Data with Application in Robot Pose
//! Tracking*, IEEE Transactions on Robotics and Automation 16(6), 2000).

use atm::error::Result;
use atm_core::{Point2, Reading};

use super::{Findings, Mark, Method, Sight, circles::common_points, history::History};

/// Each new reading is triangulated with those before it, the latest first. A point on both arcs, within both beams and within the
/// gate of the estimate so far is a hit: T ← (n T + point) / (n + 1), n ← n + 1. Three hits make a point.
#[derive(Debug, Default)]
pub struct TriangulationFusion {
    history: History,
    points: Vec<Mark>,
}

impl TriangulationFusion {
    /// How far a point may be from the estimate to count as a hit: 4 in, in metres.
    pub const GATE: f64 = 0.1016;
    /// Hits that make a point.
    pub const HITS: u32 = 3;

    /// The estimate for `sight` from the earlier readings, and how many hits it has.
    fn triangulate<'a>(sight: &Sight, earlier: impl Iterator<Item = &'a Sight>) -> Option<(Point2<f64>, u32)> {
        let mut estimate: Option<(Point2<f64>, u32)> = None;
        for other in earlier {
            // Of two intersections the one nearer to the estimate; without one, to the boresight.
            let off = |point: &Point2<f64>| (point - estimate.map_or_else(|| sight.middle(), |(mean, _)| mean)).norm();
            let Some(point) = common_points(sight, other).min_by(|a, b| off(a).total_cmp(&off(b))) else {
                continue;
            };
            estimate = match estimate {
                None => Some((point, 1)),
                Some((mean, hits)) if (point - mean).norm() <= Self::GATE => {
                    Some((mean + (point - mean) / f64::from(hits + 1), hits + 1))
                }
                unmoved => unmoved,
            };
        }
        estimate
    }
}

impl Method for TriangulationFusion {
    fn take(&mut self, reading: &Reading<f64>) -> Result<()> {
        if let Some(sight) = Sight::new(reading)
            && let Some((point, hits)) = Self::triangulate(&sight, self.history.newest_first())
            && hits >= Self::HITS
        {
            self.points.push(Mark::of(&sight, point));
        }
        self.history.enter(reading);
        Ok(())
    }

    fn clock_reset(&mut self) {
        self.history.clear();
    }

    fn finish(self: Box<Self>) -> Result<Option<Findings>> {
        Ok(Some(Findings::points(self.points)))
    }
}

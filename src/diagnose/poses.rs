//! What is known of the robot's path.

use super::heading::Headings;
use crate::track::Pose;

/// A step that is longer than this, in metres, is a jump: no part of the path.
const JUMP: f64 = 1e6;

/// The robot's path, as far as readings are taken on it.
#[derive(Debug, Clone, Default)]
pub struct PoseEvidence {
    /// Times the pose changed: 0 of a robot that stands.
    pub changes: u64,
    /// Times at which it did.
    pub instants: u64,
    /// Length of the path in metres.
    pub path: f64,
    /// By how much the robot turned in all, in radians, each change the shorter way.
    pub turned: f64,
    /// The lowest and highest x and y, in metres.
    pub bounds: Option<[(f64, f64); 2]>,
    /// Time in nanoseconds from the first pose to the last.
    pub duration: u64,
    pub(super) headings: Headings,
    last: Option<(Pose, i64)>,
    first_t: i64,
}

impl PoseEvidence {
    /// Width and depth of what the path covers, in metres.
    pub fn extent(&self) -> Option<[f64; 2]> {
        self.bounds.map(|bounds| bounds.map(|(low, high)| high - low))
    }

    /// Mean speed in metres a second; `None` where no time passes.
    pub fn speed(&self) -> Option<f64> {
        (self.duration > 0).then(|| self.path / (self.duration as f64 * 1e-9))
    }

    /// Takes in where the robot was at a time in nanoseconds.
    #[inline]
    pub(super) fn add(&mut self, pose: Pose, t: i64) {
        match self.last {
            Some((last, _)) if last == pose => self.last = Some((pose, t)),
            last => self.step(last, pose, t),
        }
        self.duration = self.duration.max(t.abs_diff(self.first_t));
    }

    fn step(&mut self, last: Option<(Pose, i64)>, pose: Pose, t: i64) {
        if let Some((last, then)) = last {
            let length = libm::hypot(pose.x - last.x, pose.y - last.y);
            if length < JUMP {
                self.path += length;
            }
            self.turned += libm::remainder(pose.yaw - last.yaw, std::f64::consts::TAU).abs();
            self.changes += 1;
            self.instants += u64::from(then != t);
        } else {
            self.first_t = t;
        }
        let [(x0, x1), (y0, y1)] = self.bounds.unwrap_or([(pose.x, pose.x), (pose.y, pose.y)]);
        self.bounds = Some([(x0.min(pose.x), x1.max(pose.x)), (y0.min(pose.y), y1.max(pose.y))]);
        self.headings.add(pose);
        self.last = Some((pose, t));
    }

    /// The clock was set back: what comes is another drive.
    pub(super) fn lift(&mut self) {
        self.headings.lift();
    }
}

//! The pose that a robot believes in: its true moves, each a little wrong, one after the other.
use atm::track::Pose;
use nalgebra::{Isometry2, Point2, UnitComplex, Vector2};

use super::{Effects, dice::Dice};
use crate::world::rounded;

/// Adds noise to each move; the sensing is not affected.
pub(super) struct Odometry {
    position: f64,
    heading: f64,
    dice: Dice,
    last: Option<(Pose, Pose)>,
}

impl Odometry {
    pub fn new(effects: &Effects, dice: Dice) -> Self {
        Self { position: effects.odometry, heading: effects.heading, dice, last: None }
    }

    /// What the robot believes when it really is at `pose`; at the first pose it is right.
    pub fn believe(&mut self, pose: Pose) -> Pose {
        let noise = [self.dice.normal(), self.dice.normal(), self.dice.normal()];
        let believed = match self.last {
            Some((before, believed)) if self.position > 0.0 || self.heading > 0.0 => {
                self.moved(before, believed, pose, noise)
            }
            _ => pose,
        };
        self.last = Some((pose, believed));
        believed
    }

    fn moved(&self, before: Pose, believed: Pose, now: Pose, [x, y, turn]: [f64; 3]) -> Pose {
        let step = isometry(before).inv_mul(&isometry(now));
        let turned = now.yaw - before.yaw;
        let root = (step.translation.vector.norm() + turned.abs()).sqrt();
        let wrong = step.translation.vector + Vector2::new(x, y) * (self.position * root);
        let at = isometry(believed) * Point2::from(wrong);
        rounded(Pose { x: at.x, y: at.y, yaw: believed.yaw + turned + turn * self.heading * root })
    }
}

/// A robot's pose as a transform.
pub(super) fn isometry(pose: Pose) -> Isometry2<f64> {
    let turn = UnitComplex::from_cos_sin_unchecked(libm::cos(pose.yaw), libm::sin(pose.yaw));
    Isometry2::from_parts(Vector2::new(pose.x, pose.y).into(), turn)
}

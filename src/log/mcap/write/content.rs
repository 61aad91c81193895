//! What is written, before it is a message of one or the other kind.

use std::ops::Range;

use atm_core::{Isometry2, Point2};

use super::points::PointLayout;
use crate::track::Pose;

/// A colour; each part from 0 to 255.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Color {
    pub(super) red: u8,
    pub(super) green: u8,
    pub(super) blue: u8,
    pub(super) alpha: u8,
}

impl Color {
    pub(super) const fn new(rgb: u32, alpha: u8) -> Self {
        let [_, red, green, blue] = rgb.to_be_bytes();
        Self { red, green, blue, alpha }
    }
}

/// One frame's pose in another at a time in nanoseconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Transform<'a> {
    pub(super) t: i64,
    pub(super) parent: &'a str,
    pub(super) child: &'a str,
    pub(super) pose: Pose,
}

/// Points of one layout; `t` is the time that theirs are counted from.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cloud<'a> {
    pub(super) t: i64,
    pub(super) frame: &'a str,
    pub(super) layout: &'a PointLayout,
    pub(super) points: &'a [u8],
}

/// A drawing's form; its points are a range of the scene's.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Form {
    /// A line from point to point.
    Line(Range<usize>),
    /// A mark at each point.
    Marks(Range<usize>),
}

/// One drawing, under a name that a later one can replace.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Drawing {
    pub(super) t: i64,
    /// Whose it is.
    pub(super) group: u16,
    /// Which of the group's.
    pub(super) slot: u32,
    /// `None` wipes it away.
    pub(super) form: Option<Form>,
}

/// Drawings of one moment, all in one colour.
#[derive(Debug, Clone)]
pub(super) struct Scene {
    pub(super) color: Color,
    /// Width of lines, size of marks, in metres.
    pub(super) width: f64,
    pub(super) drawings: Vec<Drawing>,
    pub(super) points: Vec<Point2<f64>>,
}

impl Scene {
    pub(super) const fn new(color: Color, width: f64) -> Self {
        Self { color, width, drawings: Vec::new(), points: Vec::new() }
    }

    pub(super) fn clear(&mut self) {
        self.drawings.clear();
        self.points.clear();
    }
}

/// A message's content.
#[derive(Clone, Copy)]
pub(super) enum Content<'a> {
    Transforms(&'a [Transform<'a>]),
    Pose {
        t: i64,
        frame: &'a str,
        pose: Pose,
    },
    Path {
        t: i64,
        frame: &'a str,
        poses: &'a [(i64, Pose)],
    },
    Cloud(Cloud<'a>),
    /// With the names of its groups.
    Scene {
        frame: &'a str,
        scene: &'a Scene,
        groups: &'a dyn Fn(u16) -> String,
    },
}

/// Sorts of content: each has one message type in either kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Sort {
    Transforms,
    Pose,
    Path,
    Cloud,
    Scene,
}

/// A heading as a quaternion (0, 0, z, w): rotation about the z axis by `yaw` radians.
pub(super) fn half_turn(yaw: f64) -> (f64, f64) {
    (libm::sin(yaw / 2.0), libm::cos(yaw / 2.0))
}

/// A pose as position and heading.
pub(super) fn pose_of(isometry: &Isometry2<f64>) -> Pose {
    let (position, heading) = (isometry.translation.vector, isometry.rotation);
    Pose { x: position.x, y: position.y, yaw: libm::atan2(heading.im, heading.re) }
}

/// Seconds, rounded down, and the nanoseconds beyond them.
pub(super) const fn seconds(ns: i64) -> (i64, u32) {
    const SECOND: i64 = 1_000_000_000;
    (ns.div_euclid(SECOND), ns.rem_euclid(SECOND) as u32)
}

//! Worlds: walls and poles, the openings between them, and a way through for the robot.
//!
//! What a beam hears of a world is [`crate::simulate`]'s concern.
mod builtin;
mod check;
mod corner;
mod doorway;
mod parameters;
mod path;
mod read;
pub(crate) mod sight;
mod surface;

use std::f64::consts::PI;

use nalgebra::Point2;
use parry2d_f64::partitioning::{Bvh, BvhNode};

pub(crate) use self::{
    corner::Corner,
    path::rounded,
    sight::side,
    surface::{left_of, parry},
};
pub use self::{
    corner::JOINT,
    doorway::{DOORWAY_DEPTH, Gap, JAMB_REACH},
    path::{Course, PAPER_RATE, PAPER_SPEED, Path},
    surface::{Material, Shape, Surface},
};
use atm::{
    error::{Error, Result},
    toml_document::Kind,
};

/// World files.
const KIND: Kind =
    Kind { name: "world", builtin: &World::BUILTIN, error: |file, message| Error::World { file, message } };
/// Incidence up to which a diffuse surface answers where nothing else is said; beyond it is a mirror. Decided here.
pub const CRITICAL_ANGLE: f64 = PI / 3.0;

/// A checked world; never changed.
#[derive(Debug, Clone)]
pub struct World {
    parts: Parts,
    corners: Vec<Corner>,
    bvh: Bvh,
}

/// What a world is made of.
#[derive(Debug, Clone, PartialEq)]
struct Parts {
    name: String,
    surfaces: Vec<Surface>,
    openings: Vec<Opening>,
    path: Path,
    critical_angle: f64,
}

/// A gap in a wall that a robot might drive through.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Opening {
    /// The ends of the wall on either side, in metres.
    pub jambs: [Point2<f64>; 2],
}

impl Opening {
    /// Distance of the jambs, in metres.
    pub fn width(&self) -> f64 {
        let [one, other] = self.jambs;
        (other - one).norm()
    }
}

impl World {
    /// Names of the built-in worlds.
    pub const BUILTIN: [&str; 9] = builtin::NAMES;

    /// The built-in world of this name, else the world in this file (`./doorway` is always a file); `set` are its
    /// parameters, such as `("opening", "36in")`.
    ///
    /// # Errors
    /// What the system says of the file; a world or a parameter that can't be used, with file, line and key.
    pub fn load(name_or_file: &str, set: &[(String, String)]) -> Result<Self> {
        match builtin::world(name_or_file, set) {
            Some(world) => world,
            None => Self::parse(&KIND.read(name_or_file)?, name_or_file, set),
        }
    }

    /// The world a TOML text describes; `file` is what errors call it, and its stem the name of a world that has none.
    ///
    /// # Errors
    /// As [`World::load`].
    pub fn parse(text: &str, file: &str, set: &[(String, String)]) -> Result<Self> {
        read::world(text, file, set)
    }

    /// Its name: the built-in one, else what the file says, else the file's stem.
    pub fn name(&self) -> &str {
        &self.parts.name
    }

    /// Walls and poles, at least one.
    pub fn surfaces(&self) -> &[Surface] {
        &self.parts.surfaces
    }

    /// The openings whose width matters; none in a world without a doorway.
    pub fn openings(&self) -> &[Opening] {
        &self.parts.openings
    }

    /// Distance from a point to the nearest surface, in metres; from within a pole, to its rim.
    pub fn distance(&self, point: Point2<f64>) -> f64 {
        let nearest = self.bvh.find_best(
            f64::MAX,
            |node: &BvhNode, _| distance_to_box(node, point),
            |index, _| self.surface(index).map(|surface| surface.shape.distance(point)),
        );
        nearest.map_or(f64::INFINITY, |(_, distance)| distance)
    }

    /// The way a robot takes where nothing else is said.
    pub fn path(&self) -> &Path {
        &self.parts.path
    }

    /// Incidence up to which a diffuse surface answers and from which on any surface but a pole is a mirror, in radians, within (0, π/2).
    pub fn critical_angle(&self) -> f64 {
        self.parts.critical_angle
    }

    /// The places where walls end or meet, and that can be heard.
    pub(crate) fn corners(&self) -> &[Corner] {
        &self.corners
    }

    /// The tree of the surfaces' boxes.
    pub(crate) fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    /// One surface by its index in [`World::surfaces`].
    pub(crate) fn surface(&self, index: u32) -> Option<&Surface> {
        self.parts.surfaces.get(usize::try_from(index).ok()?)
    }

    /// Whether nothing stands between two points, except perhaps surfaces that the target itself is `part_of`.
    pub(crate) fn sees(&self, from: Point2<f64>, target: Point2<f64>, part_of: &[u32]) -> bool {
        let mut touched = sight::Touched::default();
        let blocked = |index: u32| match self.surface(index) {
            Some(surface) if !part_of.contains(&index) => touched.block(surface.shape.hit(from, target)),
            _ => false,
        };
        !self.bvh.leaves(|node: &BvhNode| is_near_line(node, from, target)).any(blocked)
    }
}

/// Distance from a point to a box of the tree; 0 within.
pub(crate) fn distance_to_box(node: &BvhNode, point: Point2<f64>) -> f64 {
    let (mins, maxs) = (node.mins(), node.maxs());
    let x = (mins.x - point.x).max(point.x - maxs.x).max(0.0);
    let y = (mins.y - point.y).max(point.y - maxs.y).max(0.0);
    (x * x + y * y).sqrt()
}

/// Whether a box may touch the straight line between two points.
fn is_near_line(node: &BvhNode, from: Point2<f64>, to: Point2<f64>) -> bool {
    let (mins, maxs) = (node.mins(), node.maxs());
    let apart = |low: f64, high: f64, a: f64, b: f64| a.max(b) < low || a.min(b) > high;
    !apart(mins.x, maxs.x, from.x, to.x) && !apart(mins.y, maxs.y, from.y, to.y)
}

fn world_error(file: &str, message: String) -> Error {
    Error::World { file: file.into(), message }
}

#[cfg(test)]
mod tests;

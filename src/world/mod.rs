//! Worlds: walls and poles, the openings between them, and a way through for the robot.
//!
//! What a beam hears of a world is [`crate::simulate`]'s concern.
mod path;
pub mod rough;
mod surface;

use nalgebra::Point2;

pub use self::{
    path::{Course, PAPER_RATE, PAPER_SPEED, Path},
    surface::{Material, Shape, Surface},
};
use crate::{
    error::{Error, Result},
    units,
};

/// A checked world; never changed.
#[derive(Debug, Clone, PartialEq)]
pub struct World {
    name: String,
    surfaces: Vec<Surface>,
    openings: Vec<Opening>,
    path: Path,
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
        (self.jambs[1] - self.jambs[0]).norm()
    }
}

impl World {
    /// Names of the built-in worlds.
    pub const BUILTIN: [&str; 2] = ["doorway", "closed-wall"];

    /// The built-in world of this name, else the world in this file (`./doorway` is always a file); `set` are its
    /// parameters, such as `("opening", "36in")`.
    ///
    /// # Errors
    /// What the system says of the file; a world or a parameter that can't be used, with file, line and key.
    pub fn load(name_or_file: &str, set: &[(String, String)]) -> Result<Self> {
        let length = |key: &str, otherwise: f64| match set.iter().rev().find(|(name, _)| name == key) {
            Some((_, value)) => units::length(value)
                .map_err(|error| Error::World { file: name_or_file.into(), message: format!("{key}: {error}") }),
            None => Ok(otherwise),
        };
        let (distance, path) = (length("distance", 1.778)?, length("length", 6.096)?);
        let opening = if name_or_file == "doorway" { length("opening", 0.9144)? } else { 0.0 };
        let wall = |x: f64, to_x: f64, y: f64| Surface {
            shape: Shape::Segment { from: Point2::new(x, y), to: Point2::new(to_x, y) },
            material: Material::Rough,
        };
        let (start, end) = ((path - opening) / 2.0, (path + opening) / 2.0);
        let (before, after) = (-7.62, path + 7.62);
        let jambs = [Point2::new(start, distance), Point2::new(end, distance)];
        Ok(Self {
            name: name_or_file.to_owned(),
            surfaces: vec![
                wall(start, before, distance),
                wall(after, end, distance),
                wall(before, after, -1.016),
                wall(after, before, distance + 2.54),
            ],
            openings: if opening > 0.0 { vec![Opening { jambs }] } else { Vec::new() },
            path: Path {
                course: Course::Straight { from: Point2::origin(), to: Point2::new(path, 0.0) },
                speed: PAPER_SPEED,
                rate: PAPER_RATE,
            },
        })
    }

    /// Its name: the built-in one, else what the file says, else the file's stem.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Walls and poles, at least one.
    pub fn surfaces(&self) -> &[Surface] {
        &self.surfaces
    }

    /// The openings whose width matters; none in a world without a doorway.
    pub fn openings(&self) -> &[Opening] {
        &self.openings
    }

    /// Distance from a point to the nearest surface, in metres; from within a pole, to its rim.
    pub fn distance(&self, point: Point2<f64>) -> f64 {
        self.surfaces.iter().map(|surface| surface.shape.distance(point)).fold(f64::INFINITY, f64::min)
    }

    /// The way a robot takes where nothing else is said.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

//! What stands in a world: walls and poles, and what they are made of.
use std::{f64::consts::TAU, fmt};

use nalgebra::{Point2, Vector2};
use parry2d_f64::{
    bounding_volume::Aabb,
    math::Vector,
    query::PointQuery,
    shape::{Ball, Segment},
};

/// One surface of a world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    /// Where it is.
    pub shape: Shape,
    /// How it answers to sound.
    pub material: Material,
}

/// The form of a surface, in metres; a polyline is its segments.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// A straight thin wall, seen from both sides.
    Segment {
        /// One end.
        from: Point2<f64>,
        /// The other end, elsewhere.
        to: Point2<f64>,
    },
    /// A solid pole.
    Circle {
        /// Its middle.
        center: Point2<f64>,
        /// Its radius, above 0.
        radius: f64,
    },
}

/// How a surface answers to sound.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Material {
    /// A mirror: an echo only from where it faces the sensor.
    Specular,
    /// Small bumps that answer from any side, and a weak mirror between them (Sec. IV-D, Fig. 20).
    Rough,
    /// Every point answers up to a critical angle of incidence: the adversary of the method.
    Diffuse,
}

impl Material {
    /// All materials.
    pub const ALL: [Self; 3] = [Self::Specular, Self::Rough, Self::Diffuse];

    /// Its name in world files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Specular => "specular",
            Self::Rough => "rough",
            Self::Diffuse => "diffuse",
        }
    }

    /// The material of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|material| material.name() == name)
    }
}

impl fmt::Display for Material {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Shape {
    /// Distance from a point to the surface, in metres; from within a pole, to its rim.
    pub fn distance(&self, point: Point2<f64>) -> f64 {
        match *self {
            Self::Segment { from, to } => {
                Segment::new(parry(from), parry(to)).distance_to_local_point(parry(point), true)
            }
            Self::Circle { center, radius } => {
                let from_center = parry((point - center).into());
                Ball::new(radius).distance_to_local_point(from_center, false).abs()
            }
        }
    }

    /// Length of a wall, or of the way around a pole, in metres.
    pub fn length(&self) -> f64 {
        match *self {
            Self::Segment { from, to } => (to - from).norm(),
            Self::Circle { radius, .. } => TAU * radius,
        }
    }

    /// The box around it.
    pub(crate) fn aabb(&self) -> Aabb {
        match *self {
            Self::Segment { from, to } => Segment::new(parry(from), parry(to)).local_aabb(),
            Self::Circle { center, radius } => Aabb::from_half_extents(parry(center), Vector::splat(radius)),
        }
    }
}

/// A point in the types of parry.
pub(crate) fn parry(point: Point2<f64>) -> Vector {
    Vector::new(point.x, point.y)
}

/// The direction a quarter turn counter-clockwise of `direction`.
pub(crate) fn left_of(direction: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-direction.y, direction.x)
}

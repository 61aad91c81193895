//! A world as a scene.
use super::scene::{Scene, Wall};
use crate::world::{Material, Shape, World};

impl Scene {
    /// The walls of a world by their materials, and its openings.
    pub fn of_world(world: &World) -> Self {
        let mut scene = Self::new();
        for material in Material::ALL {
            let surfaces = world.surfaces().iter().filter(|surface| surface.material == material);
            let walls: Vec<Wall> = surfaces.map(|surface| Wall::from(surface.shape)).collect();
            if !walls.is_empty() {
                scene.walls(material.name(), walls);
            }
        }
        scene.openings(world.openings().iter().map(|opening| opening.jambs));
        scene
    }
}

impl From<Shape> for Wall {
    fn from(shape: Shape) -> Self {
        match shape {
            Shape::Segment { from, to } => Self::Straight([from, to]),
            Shape::Circle { center, radius } => Self::Round(center, radius),
        }
    }
}

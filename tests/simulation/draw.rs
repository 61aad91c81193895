//! Worlds and beams at random.

use std::{f64::consts::PI, fmt::Write};

use atm_lab::world::{Material, World};
use nalgebra::Point2;
use rand_chacha::{
    ChaCha8Rng,
    rand_core::{Rng, SeedableRng},
};

use super::brute_force::{Place, Second};

/// Half the side of the square in which everything is, in metres.
const HALF: f64 = 3.0;
/// Walls may not cross nearly at a right angle, in degrees: that would be a corner, and the second computation knows no crossings.
const NOT_SQUARE: f64 = 2.0;

pub struct Draw {
    random: ChaCha8Rng,
    material: Material,
}

impl Draw {
    pub fn new(seed: u64, material: Material) -> Self {
        Self { random: ChaCha8Rng::seed_from_u64(seed), material }
    }

    fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.random.next_u64() as f64 / 2.0_f64.powi(64))
    }

    fn below(&mut self, count: u64) -> u64 {
        self.random.next_u64() % count
    }

    /// Single walls, square niches, bent polylines and poles, of one material, crossing each other or not.
    pub fn world(&mut self) -> World {
        loop {
            let mut text = String::new();
            let critical = self.uniform(10.0, 85.0);
            writeln!(text, "material = \"{}\"\ncritical_angle = \"{critical}deg\"", self.material).unwrap();
            for _ in 0..=self.below(3) {
                let points = self.polyline();
                writeln!(text, "[[wall]]\npoints = {points:?}").unwrap();
            }
            for _ in 0..self.below(4) {
                let (x, y) = (self.uniform(-HALF, HALF), self.uniform(-HALF, HALF));
                writeln!(text, "[[pole]]\nx = {x}\ny = {y}\nradius = {}", self.uniform(0.01, 0.5)).unwrap();
            }
            // Out of the way of everything.
            text += "[path]\nkind = \"straight\"\nfrom = [50.0, 50.0]\nto = [60.0, 50.0]\n";
            let world = World::parse(&text, "random", &[]).unwrap_or_else(|error| panic!("{error}\n{text}"));
            if !Second::crosses_squarely(&world, NOT_SQUARE) {
                return world;
            }
        }
    }

    fn polyline(&mut self) -> Vec<[f64; 2]> {
        let at = [self.uniform(-HALF, HALF), self.uniform(-HALF, HALF)];
        let mut yaw = self.uniform(-PI, PI);
        let mut points = vec![at];
        let square = self.below(2) == 0;
        for _ in 0..=self.below(4) {
            let length = self.uniform(0.1, 3.0);
            let [x, y] = points[points.len() - 1];
            points.push([x + length * yaw.cos(), y + length * yaw.sin()]);
            let left = if self.below(2) == 0 { 1.0 } else { -1.0 };
            yaw += left * if square { PI / 2.0 } else { self.uniform(0.2, 2.5) };
        }
        points
    }

    /// A beam of any width, a centimetre or more from everything.
    pub fn place(&mut self, second: &Second) -> Place {
        loop {
            let origin = Point2::new(self.uniform(-HALF, HALF), self.uniform(-HALF, HALF));
            if second.distance(origin) > 0.01 {
                let widest = [PI / 8.0, PI / 4.0, PI][self.below(3) as usize];
                let field_of_view = self.uniform(0.02, widest);
                return Place { origin, yaw: self.uniform(-PI, PI), field_of_view };
            }
        }
    }
}

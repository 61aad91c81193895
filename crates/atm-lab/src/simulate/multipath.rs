//! Sound that comes back over mirrors: up to three bounces, by the images of the sensor.
//!
//! Reflected in a wall, the sensor sees through the wall as through a window. A path over a mirror, a target and the same
//! mirror again is the straight line from the image to the target; one that returns over two or three different mirrors is
//! the straight line from the last image to the sensor. Half a path's length is the range, so both make ghosts.
use nalgebra::Point2;
use parry2d_f64::partitioning::BvhNode;

use super::{
    beam::{Beam, Sector},
    scene::{Reflection, Scene},
};
use crate::{
    truth::Cause,
    world::{Material, Shape, Surface, World, distance_to_box},
};

/// What a detour has to be shorter than the direct way, in metres: over the two walls of a square corner it is as long.
const SHORTER: f64 = 1e-9;
/// Most mirrors of a path.
const MOST: usize = 3;

/// The nearest echo over mirrors, nearer than `limit` metres.
pub(super) fn nearest(scene: &Scene, beam: &Beam, limit: f64) -> Option<Reflection> {
    let mut search = Search { scene, beam, best: limit.min(f64::MAX) - SHORTER, found: None };
    let start = Image { at: beam.origin(), window: *beam.sector() };
    search.follow(&start, &mut Vec::with_capacity(MOST));
    search.found
}

/// The sensor as it is seen in a mirror, or in several one after another.
struct Image {
    at: Point2<f64>,
    /// What is seen from it through the last mirror.
    window: Sector,
}

struct Search<'a> {
    scene: &'a Scene,
    beam: &'a Beam,
    best: f64,
    found: Option<Reflection>,
}

/// Where the sound bounced last before the sensor, and where it turned back.
type Bounced = (Point2<f64>, Point2<f64>);

impl Search<'_> {
    /// Looks through one more mirror, in every mirror there is; `mirrors` are those so far, with the images before each.
    fn follow(&mut self, image: &Image, mirrors: &mut Vec<(u32, Point2<f64>)>) {
        let (scene, best) = (self.scene, self.best);
        let window = |node: &BvhNode| !image.window.misses(node) && distance_to_box(node, image.at) < 2.0 * best;
        let world = scene.world();
        for index in world.bvh().leaves(window) {
            if mirrors.iter().any(|&(mirror, _)| mirror == index) {
                continue;
            }
            let Some(Surface { shape, .. }) = world.surface(index) else { continue };
            let Some(at) = reflected(image.at, shape) else { continue };
            let Some(window) = Sector::through(at, shape) else { continue };
            mirrors.push((index, image.at));
            let next = Image { at, window };
            match mirrors.len() {
                1 => self.target(&next, index),
                _ => self.close(&next, mirrors),
            }
            if mirrors.len() < MOST {
                self.follow(&next, mirrors);
            }
            mirrors.pop();
        }
    }

    /// The nearest target that is seen in one mirror.
    fn target(&mut self, image: &Image, mirror: u32) {
        let scene = self.scene;
        let found = scene.bvh().find_best(
            self.best,
            |node: &BvhNode, _| match image.window.misses(node) {
                true => f64::MAX,
                false => distance_to_box(node, image.at),
            },
            |leaf, best| self.seen_in(image, mirror, leaf, best),
        );
        if let Some((_, (range, (bounce, point)))) = found {
            self.keep(range, point, bounce);
        }
    }

    /// Range, bounce and place of what a leaf stands for, as it is seen in a mirror.
    fn seen_in(&self, image: &Image, mirror: u32, leaf: u32, best: f64) -> Option<(f64, Bounced)> {
        let world = self.scene.world();
        if leaf == mirror {
            return None;
        }
        let target = self.scene.reflector(leaf, image.at)?.target(image.at)?;
        let range = (target.point - image.at).norm();
        if range >= best {
            return None;
        }
        let (sensor, shape) = (self.beam.origin(), &world.surface(mirror)?.shape);
        let bounce = crossing(shape, image.at, target.point)?;
        if target.weak {
            self.beam.mirror_range_to(bounce)?
        } else {
            self.beam.range_to(bounce)?
        };
        let own = [target.part_of.as_slice(), &[mirror]].concat();
        let open = reflects(world, mirror, sensor, bounce)
            && world.sees(sensor, bounce, &[mirror])
            && world.sees(bounce, target.point, &own);
        open.then_some((range, (bounce, target.point)))
    }

    /// The path back to the sensor over all these mirrors, if there is one.
    fn close(&mut self, image: &Image, mirrors: &[(u32, Point2<f64>)]) {
        let sensor = self.beam.origin();
        let range = (image.at - sensor).norm() / 2.0;
        if range >= self.best {
            return;
        }
        let Some(bounces) = self.bounces(image, mirrors) else { return };
        let (Some(first), Some(last)) = (bounces.first(), bounces.last()) else { return };
        if self.beam.range_to(*first).is_some() && self.beam.range_to(*last).is_some() {
            let halfway = bounces.get((bounces.len() - 1) / 2).unwrap_or(first);
            self.keep(range, *halfway, *first);
        }
    }

    /// Where the path bounces, from the first mirror to the last; `None` where something is in its way.
    fn bounces(&self, image: &Image, mirrors: &[(u32, Point2<f64>)]) -> Option<Vec<Point2<f64>>> {
        let world = self.scene.world();
        let sensor = self.beam.origin();
        let (mut bounces, mut image, mut target) = (Vec::with_capacity(mirrors.len()), image.at, sensor);
        for &(mirror, before) in mirrors.iter().rev() {
            target = crossing(&world.surface(mirror)?.shape, image, target)?;
            bounces.push(target);
            image = before;
        }
        bounces.reverse();
        let (mut from, mut last) = (sensor, None);
        for (&bounce, &(mirror, _)) in bounces.iter().zip(mirrors) {
            let own: Vec<u32> = last.into_iter().chain([mirror]).collect();
            if !(reflects(world, mirror, from, bounce) && world.sees(from, bounce, &own)) {
                return None;
            }
            (from, last) = (bounce, Some(mirror));
        }
        world.sees(from, sensor, last.as_slice()).then_some(bounces)
    }

    fn keep(&mut self, range: f64, point: Point2<f64>, first_bounce: Point2<f64>) {
        self.best = range;
        let azimuth = self.beam.azimuth(first_bounce);
        self.found = Some(Reflection { point, range, azimuth, cause: Cause::Multipath });
    }
}

/// A point's image in a straight wall that it is not in line with.
fn reflected(point: Point2<f64>, wall: &Shape) -> Option<Point2<f64>> {
    let Shape::Segment { from, to } = *wall else { return None };
    let way = to - from;
    let normal = crate::world::left_of(way);
    let off = normal.dot(&(point - from)) / way.norm_squared();
    (off != 0.0).then(|| point - normal * (2.0 * off))
}

/// Where the straight line from an image behind a wall to a target in front of it passes the wall, between its ends.
fn crossing(wall: &Shape, image: Point2<f64>, target: Point2<f64>) -> Option<Point2<f64>> {
    let Shape::Segment { from, to } = *wall else { return None };
    let way = to - from;
    let (behind, before) = (way.perp(&(image - from)), way.perp(&(target - from)));
    if !(behind * before < 0.0) {
        return None;
    }
    let point = image + (target - image) * (behind / (behind - before));
    let share = way.dot(&(point - from)) / way.norm_squared();
    (share > 0.0 && share < 1.0).then_some(point)
}

/// Whether a wall is a mirror to what comes from a point and bounces there: a specular one always, others beyond the critical angle.
fn reflects(world: &World, mirror: u32, from: Point2<f64>, bounce: Point2<f64>) -> bool {
    let Some(Surface { shape: Shape::Segment { from: start, to }, material }) = world.surface(mirror) else {
        return false;
    };
    let way = to - start;
    let off = (way.perp(&(from - start)) / way.norm()).abs();
    *material == Material::Specular || off <= (from - bounce).norm() * libm::cos(world.critical_angle())
}

#[cfg(test)]
mod tests;

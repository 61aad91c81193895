//! A world as one seed makes it, and what a beam hears of it.
//!
//! The echo is the nearest admissible point. It is found among the points themselves, and on diffuse surfaces over the
//! whole interval that is admissible, not along sampled rays, so it is exact (method: mirror, bump, corner, pole).
use nalgebra::{Point2, Vector2};
use parry2d_f64::{
    bounding_volume::Aabb,
    partitioning::{Bvh, BvhBuildStrategy, BvhNode},
};

use super::{
    beam::Beam,
    dice::{Dice, Purpose},
    diffuse,
};
use crate::{
    truth::Cause,
    world::{Corner, Material, Shape, Surface, World, distance_to_box, left_of, parry, side, sight::Hit},
};

/// Smallest distance between neighbouring bumps of a rough surface: 12 in.
pub const MIN_SPACING: f64 = 0.3048;
/// Largest distance between neighbouring bumps of a rough surface: 48 in.
pub const MAX_SPACING: f64 = 1.2192;
/// Bound on how far a bump stands out of its surface: 1 in, a sonar's range resolution (Sec. IV-D).
pub const MAX_DEPTH: f64 = 0.0254;

/// What a beam heard, before anything rounds it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reflection {
    /// Where the sound turned back, in the world's frame, in metres; of sound that took a detour, the surface half way.
    pub point: Point2<f64>,
    /// Half the length of the sound's path, in metres.
    pub range: f64,
    /// The direction in which it left, from the boresight, counter-clockwise, in radians.
    pub azimuth: f64,
    /// What stands there.
    pub cause: Cause,
}

/// A world with its bumps drawn.
#[derive(Debug, Clone)]
pub struct Scene {
    world: World,
    bumps: Vec<Bump>,
    /// Boxes of surfaces, then of corners, then of bumps.
    bvh: Bvh,
}

/// A bump on a rough surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bump {
    /// Where it is seen from the left of its wall, on the way from the first end to the second, and from its right; both the
    /// same on a pole.
    pub sides: [Point2<f64>; 2],
    /// Its surface's index in [`World::surfaces`].
    pub surface: u32,
}

/// Something that can answer.
#[derive(Debug, Clone, Copy)]
pub(super) enum Reflector<'a> {
    Surface(u32, &'a Surface),
    Corner(&'a Corner),
    Bump(Point2<f64>, u32),
}

impl Scene {
    /// Draws the bumps of a world's rough surfaces, in their order.
    ///
    /// Along each surface their spacing is uniform in [[`MIN_SPACING`], [`MAX_SPACING`]) and their depth in [0, [`MAX_DEPTH`]).
    /// Seen from the other side of a thin wall they stand out on that side.
    pub fn new(world: World, seed: u64) -> Self {
        let mut dice = Dice::new(seed, Purpose::Bumps);
        let mut bumps = Vec::new();
        for (surface, Surface { shape, material }) in (0..).zip(world.surfaces()) {
            if *material == Material::Rough {
                let places = places(shape.length(), &mut dice);
                bumps.extend(places.into_iter().map(|(at, depth)| Bump { sides: sides(shape, at, depth), surface }));
            }
        }
        Self::with_bumps(world, bumps)
    }

    fn with_bumps(world: World, bumps: Vec<Bump>) -> Self {
        let surfaces = world.surfaces().iter().map(|surface| surface.shape.aabb());
        let corners = world.corners().iter().map(|corner| Aabb::from_points([parry(corner.at)]));
        let marks = bumps.iter().map(|bump| Aabb::from_points(bump.sides.map(parry)));
        let boxes: Vec<Aabb> = surfaces.chain(corners).chain(marks).collect();
        let bvh = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
        Self { world, bumps, bvh }
    }

    /// The world.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The bumps on its rough surfaces.
    pub fn bumps(&self) -> &[Bump] {
        &self.bumps
    }

    /// The nearest point nearer than `limit` metres that `beam` hears without a detour; `None` where it hears nothing.
    pub fn direct(&self, beam: &Beam, limit: f64) -> Option<Reflection> {
        let origin = beam.origin();
        let found = self.bvh.find_best(
            limit.min(f64::MAX),
            |node: &BvhNode, _| match beam.sector().misses(node) {
                true => f64::MAX,
                false => distance_to_box(node, origin),
            },
            |leaf, best| self.echo(self.reflector(leaf, origin)?, beam, best),
        );
        found.map(|(_, (range, (point, cause)))| Reflection { point, range, azimuth: beam.azimuth(point), cause })
    }

    /// What a leaf of the tree stands for, as it is seen from a point.
    pub(super) fn reflector(&self, leaf: u32, from: Point2<f64>) -> Option<Reflector<'_>> {
        if let Some(surface) = self.world.surface(leaf) {
            return Some(Reflector::Surface(leaf, surface));
        }
        let rest = usize::try_from(leaf).ok()?.checked_sub(self.world.surfaces().len())?;
        if let Some(corner) = self.world.corners().get(rest) {
            return Some(Reflector::Corner(corner));
        }
        let bump = self.bumps.get(rest - self.world.corners().len())?;
        let point = seen_from(&self.world.surface(bump.surface)?.shape, bump.sides, from)?;
        Some(Reflector::Bump(point, bump.surface))
    }

    pub(super) fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    /// Range, place and cause of a reflector's echo, where it is nearer than `best`.
    fn echo(&self, reflector: Reflector<'_>, beam: &Beam, best: f64) -> Option<(f64, (Point2<f64>, Cause))> {
        if let Reflector::Surface(index, Surface { shape, material: Material::Diffuse }) = reflector {
            let point = diffuse::nearest(&self.world, beam, index, shape, best)?;
            let cause = if matches!(shape, Shape::Circle { .. }) { Cause::Pole } else { Cause::Wall };
            return Some(((point - beam.origin()).norm(), (point, cause)));
        }
        let target = reflector.target(beam.origin())?;
        let range = if target.weak { beam.mirror_range_to(target.point)? } else { beam.range_to(target.point)? };
        let heard = range < best && self.world.sees(beam.origin(), target.point, target.part_of.as_slice());
        heard.then_some((range, (target.point, target.cause)))
    }
}

/// A single point that answers, wherever in the beam it is.
pub(super) struct Target<'a> {
    pub point: Point2<f64>,
    pub cause: Cause,
    /// Whether it is a weak mirror.
    pub weak: bool,
    /// The surfaces that it is part of, which can't hide it.
    pub part_of: PartOf<'a>,
}

/// The surfaces that a target is part of.
pub(super) enum PartOf<'a> {
    One([u32; 1]),
    Several(&'a [u32]),
}

impl PartOf<'_> {
    pub fn as_slice(&self) -> &[u32] {
        match self {
            Self::One(one) => one,
            Self::Several(several) => several,
        }
    }
}

impl<'a> Reflector<'a> {
    /// The point that answers to a sensor at `from`; for surfaces the one at which they face it.
    pub fn target(self, from: Point2<f64>) -> Option<Target<'a>> {
        let one = |index| PartOf::One([index]);
        Some(match self {
            Self::Surface(index, Surface { shape: Shape::Segment { from: start, to }, material }) => Target {
                point: foot(*start, *to, from)?,
                cause: Cause::Wall,
                weak: *material == Material::Rough,
                part_of: one(index),
            },
            Self::Surface(index, Surface { shape: Shape::Circle { center, radius }, .. }) => {
                let outwards = from - center;
                let point = center + outwards * (radius / outwards.norm());
                Target { point, cause: Cause::Pole, weak: false, part_of: one(index) }
            }
            Self::Corner(corner) if corner.answers(from) => {
                Target { point: corner.at, cause: Cause::Corner, weak: false, part_of: PartOf::Several(&corner.walls) }
            }
            Self::Corner(_) => return None,
            Self::Bump(point, surface) => Target { point, cause: Cause::Scatterer, weak: false, part_of: one(surface) },
        })
    }
}

/// Foot of the perpendicular from a point that is not on the wall's line, where it lies between the wall's ends, ends included.
fn foot(from: Point2<f64>, to: Point2<f64>, point: Point2<f64>) -> Option<Point2<f64>> {
    let along = to - from;
    let share = along.dot(&(point - from)) / along.norm_squared();
    let facing = (0.0..=1.0).contains(&share) && side(from, to, point) != 0.0;
    facing.then(|| from + along * share)
}

/// Draws where along a surface of a length the bumps are, and how deep.
fn places(length: f64, dice: &mut Dice) -> Vec<(f64, f64)> {
    let mut places = Vec::new();
    let mut at = dice.uniform(0.0, MAX_SPACING);
    while at < length {
        places.push((at, dice.uniform(0.0, MAX_DEPTH)));
        at += dice.uniform(MIN_SPACING, MAX_SPACING);
    }
    places
}

/// Where the bump at a place along a surface is, seen from the surface's left and from its right.
fn sides(shape: &Shape, at: f64, depth: f64) -> [Point2<f64>; 2] {
    match *shape {
        Shape::Segment { from, to } => {
            let along = (to - from) / (to - from).norm();
            let outward = left_of(along);
            [from + along * at + outward * depth, from + along * at - outward * depth]
        }
        Shape::Circle { center, radius } => {
            let yaw = at / radius;
            [center + Vector2::new(libm::cos(yaw), libm::sin(yaw)) * (radius + depth); 2]
        }
    }
}

/// The side of a bump that faces a point, if one does.
fn seen_from(shape: &Shape, [left, right]: [Point2<f64>; 2], point: Point2<f64>) -> Option<Point2<f64>> {
    match *shape {
        Shape::Segment { from, to } => {
            let at = side(from, to, point);
            (at != 0.0).then_some(if at > 0.0 { left } else { right })
        }
        // It is part of its pole, which can hide it all the same.
        Shape::Circle { .. } => (shape.hit(point, left) == Hit::Free).then_some(left),
    }
}

#[cfg(test)]
mod tests;

//! Where walls end or meet, and from where such a place answers.
//!
//! Around the place the walls part the plane into sectors. A sensor in a sector wider than a straight angle sees a convex
//! corner, which answers at any bearing; one in a sector of a right angle sees a concave corner, which sends sound back the
//! way it came, over both walls, as if from its apex (Leonard and Durrant-Whyte 1992; Kleeman and Kuc 1995). From any other
//! sector the place is silent.
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::{Point2, Vector2};
use parry2d_f64::{bounding_volume::Aabb, math::Vector, partitioning::Bvh};

use super::surface::{Shape, Surface, parry};

/// Ends of walls nearer than this to another wall meet it, in metres: a wave of 49 kHz is 7 mm long.
pub const JOINT: f64 = 0.001;
/// How far a sector may be off a straight or a right angle to count as one: 1°.
const ANGLE_SLACK: f64 = PI / 180.0;

/// A place where walls end or meet, and that can be heard.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Corner {
    /// Where it is.
    pub at: Point2<f64>,
    /// The sectors from which it is heard.
    sectors: Vec<Sector>,
    /// The walls that end or meet there.
    pub walls: Vec<u32>,
}

/// Directions from one wall counter-clockwise to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Sector {
    from: Vector2<f64>,
    to: Vector2<f64>,
    /// Whether it is wider than a straight angle.
    wide: bool,
}

impl Corner {
    /// Whether a sensor at `point` hears the corner if nothing is in the way.
    pub fn answers(&self, point: Point2<f64>) -> bool {
        let direction = point - self.at;
        let between = |from: Vector2<f64>, to: Vector2<f64>| from.perp(&direction) > 0.0 && direction.perp(&to) > 0.0;
        // A wide sector is what its complement leaves.
        self.sectors.iter().any(|s| if s.wide { !between(s.to, s.from) } else { between(s.from, s.to) })
    }

    /// Whether it is convex from somewhere: the end of a wall, or an edge.
    pub fn is_convex(&self) -> bool {
        self.sectors.iter().any(|sector| sector.wide)
    }
}

/// Moves ends of walls onto the walls they meet, so that joints are tight; in order, each at most once.
pub(super) fn snap(surfaces: &mut [Surface]) {
    let bvh = boxes(surfaces);
    for index in 0..surfaces.len() {
        let Some(Shape::Segment { from, to }) = surfaces.get(index).map(|surface| surface.shape) else { continue };
        let others: &[Surface] = surfaces;
        let met = |end| near(&bvh, end).filter_map(|other| meeting(others, index, other, end)).next();
        let shape = Shape::Segment { from: met(from).unwrap_or(from), to: met(to).unwrap_or(to) };
        if let Some(surface) = surfaces.get_mut(index) {
            surface.shape = shape;
        }
    }
}

/// Where on the wall `other` the end of the wall `index` belongs, if it meets it.
fn meeting(surfaces: &[Surface], index: usize, other: u32, end: Point2<f64>) -> Option<Point2<f64>> {
    let other = usize::try_from(other).ok()?;
    let Shape::Segment { from, to } = surfaces.get(other).filter(|_| other != index)?.shape else { return None };
    match [from, to].into_iter().find(|corner| (corner - end).norm() <= JOINT) {
        // Only later ends move, so that two do not change places.
        Some(corner) => (other < index).then_some(corner),
        None => {
            let way = to - from;
            let share = way.dot(&(end - from)) / way.norm_squared();
            let foot = from + way * share;
            ((0.0..=1.0).contains(&share) && (foot - end).norm() <= JOINT).then_some(foot)
        }
    }
}

/// The places where walls end, meet or cross and that can be heard, in the order of their first walls.
pub(super) fn find(surfaces: &[Surface], bvh: &Bvh) -> Vec<Corner> {
    let mut places: Vec<Point2<f64>> = Vec::new();
    for (index, surface) in surfaces.iter().enumerate() {
        let Shape::Segment { from, to } = surface.shape else { continue };
        places.extend([from, to]);
        places.extend(crossings(surfaces, bvh, index, from, to));
    }
    let mut corners = Vec::new();
    let mut seen = std::collections::BTreeSet::new();
    for place in places {
        // Joints are tight: what meets has the same bits.
        if seen.insert((place.x.to_bits(), place.y.to_bits())) {
            corners.extend(corner(surfaces, bvh, place));
        }
    }
    corners
}

/// Where a wall crosses walls after it.
fn crossings(surfaces: &[Surface], bvh: &Bvh, index: usize, from: Point2<f64>, to: Point2<f64>) -> Vec<Point2<f64>> {
    let way = to - from;
    let cross = |other: u32| {
        let other = usize::try_from(other).ok().filter(|&other| other > index)?;
        let Shape::Segment { from: start, to: end } = surfaces.get(other)?.shape else { return None };
        let other_way = end - start;
        let across = way.perp(&other_way);
        let (share, other_share) = ((start - from).perp(&other_way) / across, (start - from).perp(&way) / across);
        let inside = |share: f64, length: f64| share * length > JOINT && (1.0 - share) * length > JOINT;
        (inside(share, way.norm()) && inside(other_share, other_way.norm())).then(|| from + way * share)
    };
    let hull = Aabb::from_points([parry(from), parry(to)]);
    bvh.intersect_aabb(&hull).filter_map(cross).collect()
}

/// The corner at a place, if it is heard from anywhere.
fn corner(surfaces: &[Surface], bvh: &Bvh, at: Point2<f64>) -> Option<Corner> {
    let (mut directions, mut walls) = (Vec::new(), Vec::new());
    for index in near(bvh, at) {
        let shape = usize::try_from(index).ok().and_then(|index| surfaces.get(index))?.shape;
        let Shape::Segment { from, to } = shape else { continue };
        if shape.distance(at) > JOINT {
            continue;
        }
        walls.push(index);
        let way = to - from;
        match ((from - at).norm() <= JOINT, (to - at).norm() <= JOINT) {
            (true, _) => directions.push(way),
            (_, true) => directions.push(-way),
            _ => directions.extend([way, -way]),
        }
    }
    walls.sort_unstable();
    let sectors = sectors(&directions);
    (!sectors.is_empty()).then_some(Corner { at, sectors, walls })
}

/// The sectors between these directions in which a sensor hears the corner.
fn sectors(directions: &[Vector2<f64>]) -> Vec<Sector> {
    let mut ordered: Vec<(f64, Vector2<f64>)> =
        directions.iter().map(|&direction| (libm::atan2(direction.y, direction.x), direction)).collect();
    ordered.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Walls that lie on one another are one.
    ordered.dedup_by(|next, kept| next.0 - kept.0 <= ANGLE_SLACK);
    if let [first, .., last] = &ordered[..]
        && first.0 + TAU - last.0 <= ANGLE_SLACK
    {
        ordered.pop();
    }
    let next = ordered.iter().cycle().skip(1);
    type Direction = (f64, Vector2<f64>);
    let sector = |(&(yaw, from), &(next_yaw, to)): (&Direction, &Direction)| {
        let width = if next_yaw > yaw { next_yaw - yaw } else { next_yaw - yaw + TAU };
        let wide = width > PI + ANGLE_SLACK;
        let right = (width - FRAC_PI_2).abs() <= ANGLE_SLACK;
        (wide || right).then_some(Sector { from, to, wide })
    };
    ordered.iter().zip(next).filter_map(sector).collect()
}

/// The tree of the surfaces' boxes.
pub(super) fn boxes(surfaces: &[Surface]) -> Bvh {
    let leaves: Vec<Aabb> = surfaces.iter().map(|surface| surface.shape.aabb()).collect();
    Bvh::from_leaves(parry2d_f64::partitioning::BvhBuildStrategy::Binned, &leaves)
}

/// Surfaces whose boxes come within a joint of a point, in order.
fn near(bvh: &Bvh, point: Point2<f64>) -> impl Iterator<Item = u32> {
    let hull = Aabb::from_half_extents(parry(point), Vector::splat(JOINT));
    let mut found: Vec<u32> = bvh.intersect_aabb(&hull).collect();
    found.sort_unstable();
    found.into_iter()
}

#[cfg(test)]
mod tests;

//! The nearest point of a diffuse surface, exactly: over the whole interval of directions that is admissible.
//!
//! Seen from the sensor, a direction is given by its slope s: one step towards the surface (along its perpendicular, or
//! towards the middle of a pole) and s steps to the left. The range grows with |s|, and so does the incidence; so what is
//! admissible is an interval about 0, cut by the beam and by the surface's ends, less what other surfaces cover. The nearest
//! point is the one of what is left with the smallest |s|.
use nalgebra::{Point2, Vector2};
use parry2d_f64::{bounding_volume::Aabb, partitioning::BvhNode};

use super::beam::Beam;
use crate::world::{Shape, World, left_of, parry};

/// The nearest point of the surface `index` that the beam hears, where it is nearer than `best` metres.
pub(super) fn nearest(world: &World, beam: &Beam, index: u32, shape: &Shape, best: f64) -> Option<Point2<f64>> {
    let view = View::of(shape, beam.origin())?;
    let critical = world.critical_angle();
    let (low, high) = view.beam_limits(beam, view.limits(critical));
    if !(low <= high) || view.range(0.0_f64.clamp(low, high)) >= best {
        return None;
    }
    let slope = match world.sees(beam.origin(), view.point(0.0_f64.clamp(low, high)), &[index]) {
        true => 0.0_f64.clamp(low, high),
        false => uncovered(view.covers(world, index, (low, high)), (low, high))?,
    };
    (view.range(slope) < best).then(|| view.point(slope))
}

/// A surface as a sensor sees it.
struct View {
    origin: Point2<f64>,
    /// Unit vectors: towards the surface, and to the left of that.
    ahead: Vector2<f64>,
    left: Vector2<f64>,
    target: Seen,
}

/// A shape in the frame of a [`View`], or the part of it ahead: x is the way ahead, y to the left.
#[derive(Debug, Clone, Copy)]
enum Seen {
    Segment { from: Vector2<f64>, to: Vector2<f64> },
    Circle { center: Vector2<f64>, radius: f64 },
}

impl View {
    /// The view of a shape from a point; `None` from on its line, or from within.
    fn of(shape: &Shape, origin: Point2<f64>) -> Option<Self> {
        let ahead = match *shape {
            Shape::Segment { from, to } => {
                let way = to - from;
                let normal = left_of(way) * if way.perp(&(origin - from)) > 0.0 { -1.0 } else { 1.0 };
                normal / normal.norm()
            }
            Shape::Circle { center, .. } => (center - origin).normalize(),
        };
        let mut view =
            Self { origin, ahead, left: left_of(ahead), target: Seen::Circle { center: ahead, radius: 0.0 } };
        view.target = view.seen(shape);
        let faces = match view.target {
            Seen::Segment { from, .. } => from.x > 0.0,
            Seen::Circle { center, radius } => center.x > radius,
        };
        faces.then_some(view)
    }

    fn seen(&self, shape: &Shape) -> Seen {
        let local = |point: Point2<f64>| {
            let ray = point - self.origin;
            Vector2::new(ray.dot(&self.ahead), ray.dot(&self.left))
        };
        match *shape {
            Shape::Segment { from, to } => Seen::Segment { from: local(from), to: local(to) },
            Shape::Circle { center, radius } => Seen::Circle { center: local(center), radius },
        }
    }

    /// The slopes at which the surface itself is hit up to an angle of incidence.
    fn limits(&self, critical: f64) -> (f64, f64) {
        match self.target {
            Seen::Segment { from, to } => {
                let (one, other) = (from.y / from.x, to.y / to.x);
                let most = libm::tan(critical);
                (one.min(other).max(-most), one.max(other).min(most))
            }
            Seen::Circle { center, radius } => {
                // The sine theorem in the triangle of sensor, middle and point.
                let sine = radius / center.x * libm::sin(critical);
                let most = sine / (1.0 - sine * sine).sqrt();
                (-most, most)
            }
        }
    }

    /// What of an interval of slopes is in the beam; empty where its start is beyond its end.
    fn beam_limits(&self, beam: &Beam, (mut low, mut high): (f64, f64)) -> (f64, f64) {
        let sector = beam.sector();
        // A direction (1, s) is to the right of the left border and to the left of the right one.
        for (border, sign) in [(sector.left, 1.0), (sector.right, -1.0)] {
            let (x, y) = (sign * border.dot(&self.ahead), sign * border.dot(&self.left));
            if x > 0.0 {
                high = high.min(y / x);
            } else if x < 0.0 {
                low = low.max(y / x);
            } else if y < 0.0 {
                return (f64::INFINITY, f64::NEG_INFINITY);
            }
        }
        (low, high)
    }

    /// The surface's point in a direction.
    fn point(&self, slope: f64) -> Point2<f64> {
        let ahead = self.target.entry(slope).unwrap_or(0.0);
        self.origin + self.ahead * ahead + self.left * (ahead * slope)
    }

    /// Its distance.
    fn range(&self, slope: f64) -> f64 {
        self.target.entry(slope).unwrap_or(f64::INFINITY) * (1.0 + slope * slope).sqrt()
    }

    /// The intervals of directions in which something else is nearer, in no order.
    fn covers(&self, world: &World, index: u32, (low, high): (f64, f64)) -> Vec<(f64, f64)> {
        let hull = Aabb::from_points([self.origin, self.point(low), self.point(high)].map(parry));
        let hull = match self.target {
            // It bulges towards the sensor, not beyond the triangle's sides by more than its radius.
            Seen::Circle { radius, .. } => Aabb::new(hull.mins - radius, hull.maxs + radius),
            Seen::Segment { .. } => hull,
        };
        let query = BvhNode::leaf(hull, 0);
        let others = world.bvh().leaves(|node: &BvhNode| node.intersects(&query)).filter(|&other| other != index);
        let others = others.filter_map(|other| world.surface(other));
        others.flat_map(|other| self.covered_by(&self.seen(&other.shape), low, high)).collect()
    }

    /// The intervals of directions in which `other` is nearer.
    fn covered_by(&self, other: &Seen, low: f64, high: f64) -> Vec<(f64, f64)> {
        let Some((from, to)) = other.extent() else { return Vec::new() };
        let (from, to) = (from.max(low), to.min(high));
        // Between its ends and where the two meet, one of them is nearer all along.
        let mut stops: Vec<f64> = meetings(other, &self.target).into_iter().flatten().collect();
        stops.retain(|stop| from < *stop && *stop < to);
        stops.extend([from, to]);
        stops.sort_by(f64::total_cmp);
        let pieces = stops.iter().zip(stops.iter().skip(1)).filter(|(from, to)| from < to);
        let nearer = |from: f64, to: f64| {
            let middle = f64::midpoint(from, to);
            match (other.entry(middle), self.target.entry(middle)) {
                (Some(other), Some(own)) => other < own,
                _ => false,
            }
        };
        pieces.filter(|(from, to)| nearer(**from, **to)).map(|(from, to)| (*from, *to)).collect()
    }
}

impl Seen {
    /// How far ahead a direction first meets the shape.
    fn entry(&self, slope: f64) -> Option<f64> {
        let direction = Vector2::new(1.0, slope);
        let ahead = match *self {
            Self::Segment { from, to } => from.perp(&(to - from)) / direction.perp(&(to - from)),
            Self::Circle { center, radius } => {
                let (along, length) = (direction.dot(&center), direction.norm_squared());
                let off = direction.perp(&center);
                let depth = radius * radius * length - off * off;
                // A ray that is a rim's tangent may miss it by rounding.
                (along - depth.max(0.0).sqrt()) / length
            }
        };
        (ahead > 0.0 && ahead.is_finite()).then_some(ahead)
    }

    /// The slopes between which the shape is ahead; infinite where it reaches beside the sensor; `None` where nothing of it is ahead.
    fn extent(&self) -> Option<(f64, f64)> {
        let slope = |ray: Vector2<f64>| ray.y / ray.x;
        match *self {
            Self::Segment { from, to } => {
                let (near, far) = if from.x < to.x { (from, to) } else { (to, from) };
                if far.x <= 0.0 {
                    return None;
                }
                if near.x > 0.0 {
                    return Some((slope(near).min(slope(far)), slope(near).max(slope(far))));
                }
                // Where it passes beside the sensor says to which side it goes on.
                let beside = near.y + (far.y - near.y) * (near.x / (near.x - far.x));
                Some(if beside > 0.0 { (slope(far), f64::INFINITY) } else { (f64::NEG_INFINITY, slope(far)) })
            }
            Self::Circle { center, radius } => {
                let distance = center.norm();
                let sine = (radius / distance).min(1.0);
                let cosine = (1.0 - sine * sine).sqrt();
                let (along, aside) = (center * cosine, left_of(center) * sine);
                let (right, left) = (along - aside, along + aside);
                match (right.x > 0.0, left.x > 0.0) {
                    (true, true) => Some((slope(right), slope(left))),
                    (true, false) => Some((slope(right), f64::INFINITY)),
                    (false, true) => Some((f64::NEG_INFINITY, slope(left))),
                    (false, false) => None,
                }
            }
        }
    }
}

/// The slopes at which two shapes meet, at most two.
fn meetings(one: &Seen, other: &Seen) -> [Option<f64>; 2] {
    let slope = |point: Vector2<f64>| (point.x > 0.0).then(|| point.y / point.x);
    match (*one, *other) {
        (Seen::Segment { from, to }, Seen::Segment { from: start, to: end }) => {
            let share = (start - from).perp(&(end - start)) / (to - from).perp(&(end - start));
            [slope(from + (to - from) * share), None]
        }
        (Seen::Segment { from, to }, Seen::Circle { center, radius })
        | (Seen::Circle { center, radius }, Seen::Segment { from, to }) => {
            let along = (to - from).normalize();
            let foot = from + along * along.dot(&(center - from));
            let reach = radius * radius - (center - foot).norm_squared();
            let reach = (reach >= 0.0).then(|| along * reach.sqrt());
            reach.map_or([None; 2], |reach| [slope(foot - reach), slope(foot + reach)])
        }
        (Seen::Circle { center, radius }, Seen::Circle { center: middle, radius: size }) => {
            let way = middle - center;
            let distance = way.norm();
            let along = (distance + (radius - size) * (radius + size) / distance) / 2.0;
            let aside = radius * radius - along * along;
            if !(aside >= 0.0) {
                return [None; 2];
            }
            let foot = center + way * (along / distance);
            let aside = left_of(way) * (aside.sqrt() / distance);
            [slope(foot - aside), slope(foot + aside)]
        }
    }
}

/// The slope nearest to 0 within an interval that no cover holds; covers that meet leave nothing between them.
fn uncovered(mut covers: Vec<(f64, f64)>, (low, high): (f64, f64)) -> Option<f64> {
    covers.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut best, mut from): (Option<f64>, f64) = (None, low);
    let mut leave = |from: f64, to: f64| {
        if from < to {
            let nearest = 0.0_f64.clamp(from, to);
            best = best.filter(|best| best.abs() <= nearest.abs()).or(Some(nearest));
        }
    };
    for (start, end) in covers {
        leave(from, start);
        from = from.max(end);
    }
    leave(from, high);
    best
}

#[cfg(test)]
mod tests;

//! What a beam hears, by sampling surfaces and by angles: slow, and written apart from what it checks.

use std::f64::consts::{FRAC_PI_2, PI};

use atm_lab::{
    simulate::{Beam, Scene},
    world::{Material, Shape, World},
};
use nalgebra::{Isometry2, Point2, Vector2};

/// Distance of the first samples, in metres; around the nearest one they are refined to [`FINEST`].
const COARSE: f64 = 0.004;
const FINEST: f64 = 1e-6;
/// Slack of a point that is to be admissible, in radians and metres.
const SLACK: f64 = 1e-7;
/// How far beside a point that lies on the border of a shadow a free line of sight has to pass, in metres.
const BESIDE: f64 = 1e-6;
/// How far off a right angle a concave corner still is one.
const SQUARE: f64 = PI / 180.0;

/// A sensor and its beam.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    pub origin: Point2<f64>,
    pub yaw: f64,
    pub field_of_view: f64,
}

impl Place {
    pub fn beam(&self) -> Beam {
        Beam::new(&Isometry2::new(self.origin.coords, self.yaw), self.field_of_view)
    }

    pub fn azimuth(&self, point: Point2<f64>) -> f64 {
        let ray = point - self.origin;
        wrapped(ray.y.atan2(ray.x) - self.yaw)
    }

    fn holds(&self, point: Point2<f64>, share: f64, slack: f64) -> bool {
        self.azimuth(point).abs() <= self.field_of_view / 2.0 * share + slack
    }
}

fn wrapped(angle: f64) -> f64 {
    (angle + PI).rem_euclid(2.0 * PI) - PI
}

/// A world, and the ends of its walls and its bumps beside it.
pub struct Second<'a> {
    scene: &'a Scene,
    /// Each end of a wall, with the walls that end there.
    ends: Vec<(Point2<f64>, Vec<usize>)>,
}

impl<'a> Second<'a> {
    pub fn new(scene: &'a Scene) -> Self {
        let mut ends: Vec<(Point2<f64>, Vec<usize>)> = Vec::new();
        for (index, surface) in scene.world().surfaces().iter().enumerate() {
            let Shape::Segment { from, to } = surface.shape else { continue };
            for end in [from, to] {
                match ends.iter_mut().find(|(at, _)| (at - end).norm() < 1e-9) {
                    Some((_, walls)) => walls.push(index),
                    None => ends.push((end, vec![index])),
                }
            }
        }
        Self { scene, ends }
    }

    fn shapes(&self) -> impl Iterator<Item = (usize, &Shape, Material)> {
        self.scene
            .world()
            .surfaces()
            .iter()
            .enumerate()
            .map(|(index, surface)| (index, &surface.shape, surface.material))
    }

    /// Whether two walls cross within some degrees of a right angle, or nearly where one ends.
    pub fn crosses_squarely(world: &World, degrees: f64) -> bool {
        let walls: Vec<_> = world
            .surfaces()
            .iter()
            .filter_map(|surface| match surface.shape {
                Shape::Segment { from, to } => Some((from, to)),
                Shape::Circle { .. } => None,
            })
            .collect();
        walls.iter().enumerate().any(|(index, one)| {
            walls.iter().take(index).any(|other| {
                let (a, b) = (one.1 - one.0, other.1 - other.0);
                let joined =
                    [one.0, one.1].iter().any(|end| (end - other.0).norm() < 1e-9 || (end - other.1).norm() < 1e-9);
                let near_end = !joined
                    && ([one.0, one.1].iter().any(|end| off_wall(other.0, other.1, *end) < 0.01)
                        || [other.0, other.1].iter().any(|end| off_wall(one.0, one.1, *end) < 0.01));
                let square = (a.angle(&b) - FRAC_PI_2).abs().to_degrees() < degrees;
                near_end || square && !joined && cut(one.0, one.1, other.0, other.1)
            })
        })
    }

    /// Distance to the nearest wall, or to a pole's rim from outside; below 0 inside of a pole.
    pub fn distance(&self, point: Point2<f64>) -> f64 {
        let distance = |shape: &Shape| match *shape {
            Shape::Segment { from, to } => off_wall(from, to, point),
            Shape::Circle { center, radius } => (point - center).norm() - radius,
        };
        self.shapes().map(|(_, shape, _)| distance(shape)).fold(f64::INFINITY, f64::min)
    }

    /// The smallest range of all samples that answer.
    pub fn nearest(&self, place: &Place) -> Option<f64> {
        let mut best = f64::INFINITY;
        for point in self.single_points(place) {
            best = best.min((point - place.origin).norm());
        }
        for (index, shape, material) in self.shapes() {
            if material == Material::Diffuse {
                best = self.sampled(place, index, shape, best);
            }
        }
        best.is_finite().then_some(best)
    }

    /// Whether a point is one that the beam may hear, give or take a hair.
    pub fn admits(&self, place: &Place, point: Point2<f64>) -> bool {
        let is_single = self.single_points(place).any(|single| (single - point).norm() < SLACK);
        is_single
            || self
                .shapes()
                .any(|(index, shape, material)| material == Material::Diffuse && self.on(place, index, shape, point))
    }

    /// Whether a point lies on a diffuse surface and a line of sight passes right beside it.
    fn on(&self, place: &Place, index: usize, shape: &Shape, point: Point2<f64>) -> bool {
        let (at, length, distance) = match *shape {
            Shape::Segment { from, to } => {
                let at = (point - from).dot(&(to - from).normalize());
                (at, (to - from).norm(), off_wall(from, to, point))
            }
            Shape::Circle { center, radius } => {
                let ray = point - center;
                (ray.y.atan2(ray.x) * radius, f64::INFINITY, ((point - center).norm() - radius).abs())
            }
        };
        let sample = |at: f64| {
            let at = at.clamp(if length.is_finite() { 0.0 } else { at }, length.max(at.min(length)));
            let point = along(shape, at);
            place.holds(point, 1.0, SLACK + BESIDE / 0.01)
                && self.incidence(place, shape, point) <= self.scene.world().critical_angle() + SLACK + BESIDE / 0.01
                && self.sees(place.origin, point, &[index])
        };
        distance < SLACK && [at, at - BESIDE, at + BESIDE].into_iter().any(sample)
    }

    /// Angle between a line of sight and a surface's normal.
    fn incidence(&self, place: &Place, shape: &Shape, point: Point2<f64>) -> f64 {
        let ray = place.origin - point;
        match *shape {
            Shape::Segment { from, to } => {
                let off = ray.angle(&(to - from));
                (FRAC_PI_2 - off).abs()
            }
            Shape::Circle { center, .. } => ray.angle(&(point - center)),
        }
    }

    /// The points that answer by themselves: feet of perpendiculars, corners and bumps.
    fn single_points(&self, place: &Place) -> impl Iterator<Item = Point2<f64>> {
        let feet = self.shapes().filter_map(move |(index, shape, material)| {
            let foot = foot(place.origin, shape)?;
            let share = if material == Material::Rough && matches!(shape, Shape::Segment { .. }) { 0.5 } else { 1.0 };
            let heard = material != Material::Diffuse
                && place.holds(foot, share, 0.0)
                && self.sees(place.origin, foot, &[index]);
            heard.then_some(foot)
        });
        let corners = self.ends.iter().filter(move |(at, walls)| {
            place.holds(*at, 1.0, 0.0)
                && self.corner_answers(place.origin, *at, walls)
                && self.sees(place.origin, *at, walls)
        });
        let bumps = self.scene.bumps().iter().filter_map(move |bump| {
            let index = bump.surface as usize;
            let (point, own) = match self.scene.world().surfaces()[index].shape {
                Shape::Segment { from, to } => {
                    let left = turn(from, to, place.origin) > 0.0;
                    (bump.sides[usize::from(!left)], vec![index])
                }
                Shape::Circle { .. } => (bump.sides[0], vec![]),
            };
            (place.holds(point, 1.0, 0.0) && self.sees(place.origin, point, &own)).then_some(point)
        });
        feet.chain(corners.map(|(at, _)| *at)).chain(bumps)
    }

    /// Whether the end of one wall, or the joint of two, is heard from a point.
    fn corner_answers(&self, from: Point2<f64>, at: Point2<f64>, walls: &[usize]) -> bool {
        let directions: Vec<f64> = walls.iter().map(|&wall| self.direction(wall, at)).collect();
        let [one, other] = directions[..] else { return true };
        let bearing = (from - at).y.atan2((from - at).x);
        let opening = wrapped(other - one);
        let inside = wrapped(bearing - one) * opening.signum();
        let concave = inside > 0.0 && inside < opening.abs();
        if concave { (opening.abs() - FRAC_PI_2).abs() <= SQUARE } else { PI - opening.abs() > SQUARE }
    }

    fn direction(&self, wall: usize, at: Point2<f64>) -> f64 {
        let Shape::Segment { from, to } = self.scene.world().surfaces()[wall].shape else { unreachable!() };
        let far = if (from - at).norm() < (to - at).norm() { to } else { from };
        (far - at).y.atan2((far - at).x)
    }

    /// The smallest range of the samples of a diffuse surface, if it is below `best`.
    fn sampled(&self, place: &Place, index: usize, shape: &Shape, mut best: f64) -> f64 {
        let length = shape.length();
        let critical = self.scene.world().critical_angle();
        let range = |at: f64, best: f64| {
            let point = along(shape, at);
            let range = (point - place.origin).norm();
            let heard = range < best
                && place.holds(point, 1.0, 0.0)
                && self.incidence(place, shape, point) <= critical
                && self.sees(place.origin, point, &[index]);
            heard.then_some(range)
        };
        let (mut step, mut found) = (COARSE, None);
        let count = (length / step).ceil() as u32;
        for sample in 0..=count {
            let at = (f64::from(sample) * step).min(length);
            if let Some(range) = range(at, best) {
                (best, found) = (range, Some(at));
            }
        }
        while let Some(middle) = found.filter(|_| step > FINEST) {
            let fine = step / 10.0;
            for sample in -10..=10 {
                let at = (middle + f64::from(sample) * fine).clamp(0.0, length);
                if let Some(range) = range(at, best) {
                    (best, found) = (range, Some(at));
                }
            }
            step = fine;
        }
        best
    }

    /// Whether no surface but some crosses the line of sight.
    fn sees(&self, from: Point2<f64>, to: Point2<f64>, own: &[usize]) -> bool {
        !self.shapes().filter(|(index, ..)| !own.contains(index)).any(|(_, shape, _)| match *shape {
            Shape::Segment { from: start, to: end } => cut(from, to, start, end),
            Shape::Circle { center, radius } => off_wall(from, to, center) < radius,
        }) && !own.iter().any(|&index| match self.scene.world().surfaces()[index].shape {
            // Points on a pole's far side.
            Shape::Circle { center, .. } => (from - to).dot(&(to - center)) < 0.0,
            Shape::Segment { .. } => false,
        })
    }
}

/// A surface's point at a length along it.
fn along(shape: &Shape, at: f64) -> Point2<f64> {
    match *shape {
        Shape::Segment { from, to } => from + (to - from).normalize() * at,
        Shape::Circle { center, radius } => center + Vector2::new((at / radius).cos(), (at / radius).sin()) * radius,
    }
}

/// Where the distance to a surface is stationary and smallest, by halving: not at the ends of a wall.
fn foot(from: Point2<f64>, shape: &Shape) -> Option<Point2<f64>> {
    let length = shape.length();
    let distance = |at: f64| (along(shape, at) - from).norm();
    let start = (0..=64)
        .map(|sample| length * f64::from(sample) / 64.0)
        .min_by(|a, b| distance(*a).total_cmp(&distance(*b)))?;
    // The slope of the distance changes its sign between these.
    let slope = |at: f64| (along(shape, at) - from).dot(&(along(shape, at + 1e-6) - along(shape, at - 1e-6)));
    let (mut low, mut high) = (start - length / 64.0, start + length / 64.0);
    for _ in 0..80 {
        let middle = (low + high) / 2.0;
        if slope(middle) < 0.0 { low = middle } else { high = middle }
    }
    let inside = matches!(shape, Shape::Circle { .. }) || (low > 0.0 && low < length);
    inside.then(|| along(shape, low))
}

fn turn(from: Point2<f64>, to: Point2<f64>, point: Point2<f64>) -> f64 {
    (to.x - from.x) * (point.y - from.y) - (to.y - from.y) * (point.x - from.x)
}

/// Whether two segments cross, ends not counted.
fn cut(a: Point2<f64>, b: Point2<f64>, c: Point2<f64>, d: Point2<f64>) -> bool {
    turn(a, b, c) * turn(a, b, d) < 0.0 && turn(c, d, a) * turn(c, d, b) < 0.0
}

/// Distance of a point from a segment.
fn off_wall(from: Point2<f64>, to: Point2<f64>, point: Point2<f64>) -> f64 {
    let share = (point - from).dot(&(to - from)) / (to - from).norm_squared();
    (point - (from + (to - from) * share.clamp(0.0, 1.0))).norm()
}

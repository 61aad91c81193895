//! Rough walls, and the sample log of a drive past an opening in one.
//!
//! To a sonar a rough wall is a row of small bumps, each of which answers from any side (Sec. IV-D, Fig. 20), and a weak
//! mirror that answers only along its perpendicular. The echo is the nearest point that the beam holds and that no wall
//! hides. It is searched among the points themselves, not along sampled rays, so it is exact.
//!
//! Lengths are metres, angles radians. The same seed gives the same bits on every machine: bumps come from ChaCha8,
//! integers become fractions by a power of two, and trigonometry goes through `libm`.
use std::{f64::consts::PI, fmt::Write};

use nalgebra::{Point2, Vector2};
use rand_chacha::{
    ChaCha8Rng,
    rand_core::{Rng, SeedableRng},
};

/// Metres in `n` inches; for a whole `n` the double nearest to the decimal, so that it prints as few digits.
pub const fn inches(n: f64) -> f64 {
    n * 254.0 / 10_000.0
}

/// Smallest distance between neighbouring bumps of a rough wall.
pub const MIN_SPACING: f64 = inches(12.0);
/// Largest distance between neighbouring bumps of a rough wall.
pub const MAX_SPACING: f64 = inches(48.0);
/// Bound on how far a bump stands out of its wall: below the sonar's range resolution (Sec. IV-D).
pub const MAX_DEPTH: f64 = inches(1.0);
/// Share of the half beam, around the boresight, in which the weak mirror return is still heard.
pub const MIRROR_SHARE: f64 = 0.5;

/// What a beam heard.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Cause {
    /// A bump on a rough wall.
    Scatterer,
    /// A convex corner, such as the jamb of an opening.
    Edge,
    /// The foot of the perpendicular from the sensor to a wall.
    Mirror,
}

/// The point a beam hears, before the reading is rounded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reflection {
    /// Where the sound turned back, in the world's frame.
    pub point: Point2<f64>,
    /// Its distance from the sensor.
    pub range: f64,
    /// What stands there.
    pub cause: Cause,
}

/// What one sensor can hear at one moment: a sector about its boresight, borders included.
#[derive(Debug, Clone, Copy)]
pub struct Beam {
    origin: Point2<f64>,
    boresight: Vector2<f64>,
    cos_half: f64,
    cos_mirror: f64,
}

impl Beam {
    /// The beam of a sensor at `origin` that looks along `yaw`; `field_of_view` is the full angle, in (0, π].
    pub fn new(origin: Point2<f64>, yaw: f64, field_of_view: f64) -> Self {
        let half = field_of_view / 2.0;
        Self {
            origin,
            boresight: Vector2::new(libm::cos(yaw), libm::sin(yaw)),
            cos_half: libm::cos(half),
            cos_mirror: libm::cos(half * MIRROR_SHARE),
        }
    }

    /// Distance to `point` where the beam holds it.
    fn range_to(&self, point: Point2<f64>, cause: Cause) -> Option<f64> {
        let cos_limit = match cause {
            Cause::Mirror => self.cos_mirror,
            Cause::Scatterer | Cause::Edge => self.cos_half,
        };
        let ray = point - self.origin;
        let range = ray.norm();
        (ray.dot(&self.boresight) >= range * cos_limit).then_some(range)
    }
}

/// A straight wall, rough on the side to the left of the way from its first end to its second.
#[derive(Debug, Clone)]
pub struct RoughWall {
    from: Point2<f64>,
    to: Point2<f64>,
    scatterers: Vec<Point2<f64>>,
}

impl RoughWall {
    /// A wall with the given bumps; they should lie on or in front of its rough side.
    pub const fn new(from: Point2<f64>, to: Point2<f64>, scatterers: Vec<Point2<f64>>) -> Self {
        Self { from, to, scatterers }
    }

    /// A wall with bumps drawn at random: spacing uniform in [`MIN_SPACING`, `MAX_SPACING`), depth in [0, `MAX_DEPTH`).
    ///
    /// A wall without length gets none.
    pub fn draw(from: Point2<f64>, to: Point2<f64>, random: &mut ChaCha8Rng) -> Self {
        let length = (to - from).norm();
        let along = (to - from) / length;
        let outward = left_of(along);
        let mut scatterers = Vec::new();
        let mut at = uniform(random, 0.0, MAX_SPACING);
        while at < length {
            let depth = uniform(random, 0.0, MAX_DEPTH);
            scatterers.push(from + along * at + outward * depth);
            at += uniform(random, MIN_SPACING, MAX_SPACING);
        }
        Self::new(from, to, scatterers)
    }

    /// The bumps, from the wall's first end to its second.
    pub fn scatterers(&self) -> &[Point2<f64>] {
        &self.scatterers
    }

    /// Whether `point` lies strictly in front of the rough side.
    fn faces(&self, point: Point2<f64>) -> bool {
        (self.to - self.from).perp(&(point - self.from)) > 0.0
    }

    /// Foot of the perpendicular from `point`, where it lies between the wall's ends, ends included.
    fn foot(&self, point: Point2<f64>) -> Option<Point2<f64>> {
        let along = self.to - self.from;
        let share = along.dot(&(point - self.from)) / along.norm_squared();
        (0.0..=1.0).contains(&share).then(|| self.from + along * share)
    }

    /// Whether the wall crosses the open line of sight between `a` and `b`.
    ///
    /// A line that only touches the wall, at an end of either, passes: a jamb is seen past its own wall.
    fn hides(&self, a: Point2<f64>, b: Point2<f64>) -> bool {
        let side = |p: Point2<f64>, q: Point2<f64>, r: Point2<f64>| (q - p).perp(&(r - p));
        side(a, b, self.from) * side(a, b, self.to) < 0.0
            && side(self.from, self.to, a) * side(self.from, self.to, b) < 0.0
    }
}

/// Rough walls, and the convex corners where they end.
#[derive(Debug, Clone, Default)]
pub struct RoughWorld {
    /// The walls, parallel or not.
    pub walls: Vec<RoughWall>,
    /// Convex corners: they answer at any bearing.
    pub edges: Vec<Point2<f64>>,
}

impl RoughWorld {
    /// The nearest point that `beam` holds and no wall hides, or `None` where it hears nothing at any distance.
    pub fn reflection(&self, beam: &Beam) -> Option<Reflection> {
        let mut nearest = None;
        for (index, wall) in self.walls.iter().enumerate() {
            if !wall.faces(beam.origin) {
                continue;
            }
            for &bump in &wall.scatterers {
                self.keep_nearer(&mut nearest, beam, bump, Cause::Scatterer, Some(index));
            }
            if let Some(foot) = wall.foot(beam.origin) {
                self.keep_nearer(&mut nearest, beam, foot, Cause::Mirror, Some(index));
            }
        }
        for &edge in &self.edges {
            self.keep_nearer(&mut nearest, beam, edge, Cause::Edge, None);
        }
        nearest
    }

    /// Takes `point` as the nearest if it is; `own` is the wall it belongs to, which can't hide its own front.
    fn keep_nearer(
        &self,
        nearest: &mut Option<Reflection>,
        beam: &Beam,
        point: Point2<f64>,
        cause: Cause,
        own: Option<usize>,
    ) {
        let Some(range) = beam.range_to(point, cause) else {
            return;
        };
        if nearest.is_some_and(|found| found.range <= range) {
            return;
        }
        let hidden =
            self.walls.iter().enumerate().any(|(index, wall)| Some(index) != own && wall.hides(beam.origin, point));
        if !hidden {
            *nearest = Some(Reflection { point, range, cause });
        }
    }
}

/// The direction a quarter turn counter-clockwise of `direction`.
fn left_of(direction: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-direction.y, direction.x)
}

/// A draw from [low, high): 53 random bits over 2⁵³.
fn uniform(random: &mut ChaCha8Rng, low: f64, high: f64) -> f64 {
    let share = (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
    low + (high - low) * share
}

/// Sensors of the Nomad 200's ring; sensor `i` looks along `i` · 22.5°.
pub const SENSORS: u32 = 16;
/// Radius of the ring.
pub const RING_RADIUS: f64 = inches(9.0);
/// Full beam of one sensor: 22.5°, as wide as the step from one sensor to the next.
pub const FIELD_OF_VIEW: f64 = PI / 8.0;
/// Smallest reading, in inches, which are also the range resolution.
const MIN_READING: f64 = 6.0;
/// Reading, in inches, from which on there is no echo.
const MAX_READING: f64 = 255.0;

/// Seed of `examples/doorway.csv`.
pub const DOORWAY_SEED: u64 = 1;
/// Sweeps of the ring, one a second.
pub const SWEEPS: u32 = 49;
/// Way from one sweep to the next, in inches: 5 in/s at 1 Hz (Sec. IV-D).
const STEP_INCHES: f64 = 5.0;
/// Way from one sweep to the next.
pub const STEP: f64 = inches(STEP_INCHES);
/// Distance of the path, which is y = 0, from the wall with the opening, on the robot's left.
pub const WALL_DISTANCE: f64 = inches(70.0);
/// Width of the opening, whose middle is abreast of the middle of the path.
pub const OPENING: f64 = inches(36.0);
/// Where along x the opening begins.
pub const OPENING_START: f64 = inches(102.0);
/// Where along x the opening ends.
pub const OPENING_END: f64 = inches(138.0);
/// Distance of the path from the corridor's other wall, which is closed.
pub const OTHER_WALL_DISTANCE: f64 = inches(40.0);
/// Depth of the room behind the opening, up to its back wall.
pub const ROOM_DEPTH: f64 = inches(100.0);
/// How far the walls go on before and after the path: out of the sensors' reach.
const OVERHANG: f64 = inches(300.0);

/// A corridor along x with an opening on its left, into a wide room; all four walls are rough and thin.
///
/// Nothing in the room but its back wall is in range. Seeds are independent of each other: the seed is the cipher's key.
pub fn doorway_world(seed: u64) -> RoughWorld {
    let mut key = [0; 32];
    for (byte, part) in key.iter_mut().zip(seed.to_le_bytes()) {
        *byte = part;
    }
    let mut random = ChaCha8Rng::from_seed(key);
    let before = -OVERHANG;
    let after = STEP * f64::from(SWEEPS - 1) + OVERHANG;
    let back = WALL_DISTANCE + ROOM_DEPTH;
    // Rough to the left of the way: what lies on the robot's left runs against x.
    let mut wall =
        |x_from: f64, x_to: f64, y: f64| RoughWall::draw(Point2::new(x_from, y), Point2::new(x_to, y), &mut random);
    RoughWorld {
        walls: vec![
            wall(OPENING_START, before, WALL_DISTANCE),
            wall(after, OPENING_END, WALL_DISTANCE),
            wall(before, after, -OTHER_WALL_DISTANCE),
            wall(after, before, back),
        ],
        edges: vec![Point2::new(OPENING_START, WALL_DISTANCE), Point2::new(OPENING_END, WALL_DISTANCE)],
    }
}

/// The log of a Nomad 200 that drives straight past the opening of [`doorway_world`], as CSV `t,sensor,range,x,y,yaw`.
///
/// All sensors of a sweep fire at one time and pose, poses are exact, yaw is 0. A range is a whole number of inches, in
/// metres; `inf` says that nothing is in range, `-inf` that something is too close.
///
/// One sweep falls exactly abreast of the opening's middle, the hard case: with H = 10 and θmin = 30°, medians and singles
/// leave about 35 in of the 36 in, but with one seed in five a stray single stands in the mouth. Passed between two
/// sweeps, the opening stayed clear with every seed tried.
pub fn doorway_log(seed: u64) -> String {
    let world = doorway_world(seed);
    let mut log = String::from("t,sensor,range,x,y,yaw\n");
    for sweep in 0..SWEEPS {
        // Multiplied before it turns to metres, so that poses are round decimals.
        let x = inches(STEP_INCHES * f64::from(sweep));
        for sensor in 0..SENSORS {
            let yaw = FIELD_OF_VIEW * f64::from(sensor);
            let mount = Vector2::new(libm::cos(yaw), libm::sin(yaw)) * RING_RADIUS;
            let beam = Beam::new(Point2::new(x, 0.0) + mount, yaw, FIELD_OF_VIEW);
            let range = nomad_reading(world.reflection(&beam).map(|heard| heard.range));
            // Writing to a string can't fail.
            let _ = writeln!(log, "{sweep},{sensor},{range},{x},0,0");
        }
    }
    log
}

/// What a Nomad 200 sensor reports for an echo at `range` metres: whole inches, +∞ beyond its reach, −∞ below it.
fn nomad_reading(range: Option<f64>) -> f64 {
    let Some(range) = range else {
        return f64::INFINITY;
    };
    let reading = (range * 10_000.0 / 254.0).round();
    if reading >= MAX_READING {
        f64::INFINITY
    } else if reading < MIN_READING {
        f64::NEG_INFINITY
    } else {
        inches(reading)
    }
}

#[cfg(test)]
mod tests;

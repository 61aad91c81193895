//! What makes parts a world: sizes, ends that meet, and a way that leads through.
use std::f64::consts::FRAC_PI_2;

use nalgebra::Point2;
use parry2d_f64::bounding_volume::Aabb;

use super::{
    Course, JOINT, Material, Parts, Path, World,
    corner::{self, boxes},
    surface::{Shape, parry},
};

/// Farthest coordinate, in metres: a micrometre still counts there.
const EXTENT: f64 = 1e6;
/// Longest way along all rough surfaces, in metres: each has a bump every foot or so.
const MAX_ROUGH: f64 = 1e5;
/// Most sweeps of one drive.
const MAX_SWEEPS: u64 = 100_000_000;
/// Largest heading and turn, in radians: nanoradians still count there.
const MAX_ANGLE: f64 = 1e6;
/// Most waves of a weaving path.
const MAX_WAVES: f64 = 1000.0;

/// A part of a world.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    /// All of it.
    Whole,
    /// The critical angle.
    CriticalAngle,
    /// A surface, by its index.
    Surface(usize),
    /// An opening, by its index.
    Opening(usize),
    /// The path.
    Path,
}

/// Why parts are no world.
#[derive(Debug)]
pub(super) struct Flaw {
    /// What is wrong.
    pub part: Part,
    /// In which way.
    pub message: String,
    /// The surface that is in its way.
    pub surface: Option<usize>,
}

impl Flaw {
    fn new(part: Part, message: impl Into<String>) -> Self {
        Self { part, message: message.into(), surface: None }
    }
}

impl World {
    /// A world of these parts, the ends of its walls moved onto what they meet.
    pub(super) fn new(mut parts: Parts) -> Result<Self, Flaw> {
        if parts.surfaces.is_empty() {
            return Err(Flaw::new(Part::Whole, "an empty world: expected at least one wall or pole"));
        }
        if !(parts.critical_angle > 0.0 && parts.critical_angle < FRAC_PI_2) {
            return Err(Flaw::new(Part::CriticalAngle, "must be above 0deg and below 90deg"));
        }
        for (index, surface) in parts.surfaces.iter().enumerate() {
            check_shape(&surface.shape).map_err(|message| Flaw::new(Part::Surface(index), message))?;
        }
        let rough = parts.surfaces.iter().filter(|surface| surface.material == Material::Rough);
        if !(rough.map(|surface| surface.shape.length()).sum::<f64>() <= MAX_ROUGH) {
            return Err(Flaw::new(Part::Whole, "more than 100 km of rough surfaces"));
        }
        corner::snap(&mut parts.surfaces);
        let bvh = boxes(&parts.surfaces);
        let corners = corner::find(&parts.surfaces, &bvh);
        let world = Self { parts, corners, bvh };
        world.check_openings()?;
        check_path(world.path()).map_err(|message| Flaw::new(Part::Path, message))?;
        world.check_way()?;
        Ok(world)
    }

    /// Each opening is a gap between two ends of walls.
    fn check_openings(&self) -> Result<(), Flaw> {
        for (index, opening) in self.openings().iter().enumerate() {
            let flaw = |message: &str| Err(Flaw::new(Part::Opening(index), message));
            let [one, other] = opening.jambs;
            if opening.jambs.into_iter().any(|jamb| !within(jamb)) {
                return flaw("must be finite and at most 1000 km away");
            }
            if (other - one).norm() <= JOINT {
                return flaw("has no width");
            }
            let is_jamb = |at: Point2<f64>| {
                self.corners.iter().any(|corner| corner.is_convex() && (corner.at - at).norm() <= JOINT)
            };
            if !(is_jamb(one) && is_jamb(other)) {
                return flaw("must begin and end at convex corners or at ends of walls");
            }
        }
        Ok(())
    }

    /// The path leads through nothing.
    fn check_way(&self) -> Result<(), Flaw> {
        let line = self.path().line();
        let next = line.iter().skip(1).chain(line.last());
        for (leg, (&from, &to)) in line.iter().zip(next).enumerate() {
            let hull = Aabb::from_points([parry(from), parry(to)]);
            let hull = Aabb::new(hull.mins - JOINT, hull.maxs + JOINT);
            for index in self.bvh.intersect_aabb(&hull) {
                let Some(surface) = self.surface(index).filter(|s| s.shape.clearance(from, to) <= JOINT) else {
                    continue;
                };
                let message = match (leg, surface.shape) {
                    (0, Shape::Circle { center, radius }) if (center - from).norm() <= radius => {
                        "the robot would start inside"
                    }
                    (0, _) if surface.shape.distance(from) <= JOINT => "the robot would start inside",
                    _ => "leads through",
                };
                let surface = usize::try_from(index).ok();
                return Err(Flaw { part: Part::Path, message: message.to_owned(), surface });
            }
        }
        Ok(())
    }
}

fn within(point: Point2<f64>) -> bool {
    point.x.abs() <= EXTENT && point.y.abs() <= EXTENT
}

fn check_shape(shape: &Shape) -> Result<(), &'static str> {
    match *shape {
        Shape::Segment { from, to } if !(within(from) && within(to)) => Err("must be finite and at most 1000 km away"),
        // Both ends may move by a joint.
        Shape::Segment { from, to } if (to - from).norm() <= 3.0 * JOINT => {
            Err("a wall of no length: its ends must be more than 3 mm apart")
        }
        Shape::Circle { center, .. } if !within(center) => Err("must be finite and at most 1000 km away"),
        Shape::Circle { radius, .. } if !(radius > 0.0 && radius <= EXTENT) => {
            Err("must be above zero and at most 1000 km")
        }
        _ => Ok(()),
    }
}

fn check_path(path: &Path) -> Result<(), String> {
    let positive = |value: f64, name: &str| match value > 0.0 && value.is_finite() {
        true => Ok(()),
        false => Err(format!("{name} must be finite and above zero")),
    };
    positive(path.speed, "speed")?;
    positive(path.rate, "rate")?;
    match &path.course {
        Course::Straight { from, to } if from == to => return Err("a path of no length".to_owned()),
        Course::Weaving { from, to, amplitude, wavelength } => {
            positive(*amplitude, "amplitude")?;
            positive(*wavelength, "wavelength")?;
            if from == to {
                return Err("a path of no length".to_owned());
            }
            if !((to - from).norm() / wavelength <= MAX_WAVES) {
                return Err(format!("wavelength must leave at most {MAX_WAVES} waves"));
            }
        }
        Course::Turning { yaw, turn, step, .. } => {
            positive(*step, "turn_step")?;
            if !(turn.abs() > 0.0 && turn.is_finite()) {
                return Err("turn must be finite and not zero".to_owned());
            }
            if !(yaw.abs() <= MAX_ANGLE && turn.abs() <= MAX_ANGLE) {
                return Err(format!("yaw and turn must be at most {MAX_ANGLE} rad"));
            }
        }
        Course::Waypoints(points) => {
            if points.len() < 2 {
                return Err("expected at least two points".to_owned());
            }
            if let Some(index) = points.iter().zip(points.iter().skip(1)).position(|(a, b)| a == b) {
                return Err(format!("points {} and {} are the same", index + 1, index + 2));
            }
        }
        Course::Straight { .. } => {}
    }
    if !path.line().into_iter().all(within) {
        return Err("must be finite and at most 1000 km away".to_owned());
    }
    match path.sweep_count() {
        count if count > MAX_SWEEPS => Err(format!("{count} sweeps: at most {MAX_SWEEPS}")),
        _ => Ok(()),
    }
}

//! The built-in worlds. Lengths are the paper's inches where it gives them.
use atm::error::Result;
use nalgebra::Point2;

use super::{
    CRITICAL_ANGLE, Course, Material, Opening, PAPER_RATE, PAPER_SPEED, Parts, Path, Shape, Surface, World,
    check::{Flaw, Part},
    parameters::Parameters,
    world_error,
};

/// Names of the built-in worlds.
pub(super) const NAMES: [&str; 9] =
    ["doorway", "closed-wall", "tee", "pole", "specular-wall", "rough-wall", "diffuse-wall", "corners", ROOM];
/// The one that is a file itself, as an example of one.
const ROOM: &str = "room";
const ROOM_FILE: &str = include_str!("../../world/room.toml");

/// How far walls go on before and after the path: out of the sensors' reach.
const OVERHANG: f64 = inches(300.0);

/// Metres in `n` inches; for a whole `n` the double nearest to the decimal.
const fn inches(n: f64) -> f64 {
    n * 254.0 / 10_000.0
}

/// The built-in world of this name; `None` where there is none.
pub(super) fn world(name: &str, set: &[(String, String)]) -> Option<Result<World>> {
    if name == ROOM {
        return Some(World::parse(ROOM_FILE, ROOM, set));
    }
    let parameters = Parameters::new(name, set);
    let scene = match name {
        "doorway" => doorway(&parameters, true),
        "closed-wall" => doorway(&parameters, false),
        "tee" => tee(&parameters),
        "pole" => pole(&parameters),
        "specular-wall" => wall(&parameters, Material::Specular),
        "rough-wall" => wall(&parameters, Material::Rough),
        "diffuse-wall" => wall(&parameters, Material::Diffuse),
        "corners" => corners(&parameters),
        _ => return None,
    };
    Some(scene.and_then(|scene| finish(name, &parameters, scene)))
}

/// What a built-in world consists of.
struct Scene {
    surfaces: Vec<Surface>,
    openings: Vec<Opening>,
    course: Course,
}

/// Checks the parts and the parameters that nobody asked for.
fn finish(name: &str, parameters: &Parameters<'_>, scene: Scene) -> Result<World> {
    let Scene { surfaces, openings, course } = scene;
    let path =
        Path { course, speed: parameters.speed("speed", PAPER_SPEED)?, rate: parameters.rate("rate", PAPER_RATE)? };
    let critical_angle = parameters.angle("critical_angle", CRITICAL_ANGLE)?;
    parameters.finish()?;
    let shapes: Vec<Shape> = surfaces.iter().map(|surface| surface.shape).collect();
    World::new(Parts { name: name.to_owned(), surfaces, openings, path, critical_angle })
        .map_err(|flaw| world_error(name, explain(flaw, &shapes)))
}

/// A flaw that parameters have made, in words.
fn explain(flaw: Flaw, shapes: &[Shape]) -> String {
    let shape = |index: usize| match shapes.get(index) {
        Some(Shape::Segment { from, to }) => {
            format!("the wall from ({:.3}, {:.3}) to ({:.3}, {:.3})", from.x, from.y, to.x, to.y)
        }
        Some(Shape::Circle { center, .. }) => format!("the pole at ({:.3}, {:.3})", center.x, center.y),
        None => String::new(),
    };
    let message = flaw.message;
    let obstacle = flaw.surface.map(|index| format!(" {}", shape(index))).unwrap_or_default();
    match flaw.part {
        Part::Whole => message,
        Part::CriticalAngle => format!("critical_angle {message}"),
        Part::Surface(index) => format!("{}: {message}", shape(index)),
        Part::Opening(_) => format!("the opening: {message}"),
        Part::Path => format!("the path: {message}{obstacle}"),
    }
}

/// A wall between two points.
fn segment(from: (f64, f64), to: (f64, f64), material: Material) -> Surface {
    let point = |(x, y)| Point2::new(x, y);
    Surface { shape: Shape::Segment { from: point(from), to: point(to) }, material }
}

/// Walls from each point to the next.
fn polyline(points: &[(f64, f64)], material: Material) -> Vec<Surface> {
    points.iter().zip(points.iter().skip(1)).map(|(&from, &to)| segment(from, to, material)).collect()
}

/// The way along x from the origin, `length` long unless set: straight, weaving about it, or turning in its middle.
fn course(parameters: &Parameters<'_>, length: f64) -> Result<Course> {
    let (from, to) = (Point2::origin(), Point2::new(length, 0.0));
    let amplitude = parameters.length("amplitude", inches(12.0))?;
    let wavelength = parameters.length("wavelength", inches(80.0))?;
    let step = parameters.angle("turn_step", 2.5_f64.to_radians())?;
    Ok(match parameters.choice("path", "straight", &["straight", "weaving", "turning"])? {
        "weaving" => Course::Weaving { from, to, amplitude, wavelength },
        "turning" => {
            Course::Turning { at: Point2::new(length / 2.0, 0.0), yaw: 0.0, turn: std::f64::consts::TAU, step }
        }
        _ => Course::Straight { from, to },
    })
}

/// A corridor along x with an opening on its left, abreast of the middle of the path, into a wide room (Fig. 6). Nothing in
/// the room but its back wall is in range. In its control the opening is shut, and all else the same.
fn doorway(parameters: &Parameters<'_>, open: bool) -> Result<Scene> {
    let opening = parameters.length("opening", inches(36.0))?;
    let distance = parameters.length("distance", inches(70.0))?;
    let length = parameters.length("length", inches(240.0))?;
    let other = parameters.length("other_distance", inches(40.0))?;
    let depth = parameters.length("depth", inches(100.0))?;
    let material = parameters.material("material", Material::Rough)?;
    let (start, end) = ((length - opening) / 2.0, (length + opening) / 2.0);
    let (before, after) = (start.min(0.0) - OVERHANG, end.max(length) + OVERHANG);
    // Bumps are drawn in this order: it is what the sample log was made with.
    let mut surfaces = vec![
        segment((start, distance), (before, distance), material),
        segment((after, distance), (end, distance), material),
        segment((before, -other), (after, -other), material),
        segment((after, distance + depth), (before, distance + depth), material),
    ];
    let mut openings = Vec::new();
    if open {
        openings.push(Opening { jambs: [Point2::new(start, distance), Point2::new(end, distance)] });
    } else {
        surfaces.push(segment((end, distance), (start, distance), material));
    }
    Ok(Scene { surfaces, openings, course: course(parameters, length)? })
}

/// Two wide corridors that form a T, and a narrow one that goes on from its base (Figs. 21 and 22). The robot comes from the
/// left, turns into the stem, and drives through its base half way into the narrow one.
fn tee(parameters: &Parameters<'_>) -> Result<Scene> {
    let opening = parameters.length("opening", inches(36.0))?;
    let width = parameters.length("width", inches(96.0))?;
    let stem = parameters.length("stem", inches(160.0))?;
    let depth = parameters.length("depth", inches(120.0))?;
    let material = parameters.material("material", Material::Rough)?;
    let (half, narrow, bar) = (width / 2.0, opening / 2.0, width / 2.0 + inches(120.0));
    if !(narrow < half) {
        let message = "the narrow corridor must be narrower than the wide ones: opening is not less than width";
        return Err(world_error("tee", message.to_owned()));
    }
    let (base, end) = (-half - stem, -half - stem - depth);
    let outline = [
        (-bar, half),
        (bar, half),
        (bar, -half),
        (half, -half),
        (half, base),
        (narrow, base),
        (narrow, end),
        (-narrow, end),
        (-narrow, base),
        (-half, base),
        (-half, -half),
        (-bar, -half),
        (-bar, half),
    ];
    let stop = base - depth / 2.0;
    Ok(Scene {
        surfaces: polyline(&outline, material),
        openings: vec![Opening { jambs: [Point2::new(-narrow, base), Point2::new(narrow, base)] }],
        course: Course::Waypoints(vec![Point2::new(-bar + half, 0.0), Point2::origin(), Point2::new(0.0, stop)]),
    })
}

/// One pole and nothing else, abreast of the middle of the path.
fn pole(parameters: &Parameters<'_>) -> Result<Scene> {
    let distance = parameters.length("distance", inches(100.0))?;
    let length = parameters.length("length", inches(240.0))?;
    let radius = parameters.length("radius", inches(1.0))?;
    let material = parameters.material("material", Material::Specular)?;
    let center = Point2::new(length / 2.0, distance);
    let surfaces = vec![Surface { shape: Shape::Circle { center, radius }, material }];
    Ok(Scene { surfaces, openings: Vec::new(), course: course(parameters, length)? })
}

/// One long wall on the left.
fn wall(parameters: &Parameters<'_>, material: Material) -> Result<Scene> {
    let distance = parameters.length("distance", inches(70.0))?;
    let length = parameters.length("length", inches(240.0))?;
    let surfaces = vec![segment((length + OVERHANG, distance), (-OVERHANG, distance), material)];
    Ok(Scene { surfaces, openings: Vec::new(), course: course(parameters, length)? })
}

/// A wall on the left with a niche: two convex and two concave corners.
fn corners(parameters: &Parameters<'_>) -> Result<Scene> {
    let distance = parameters.length("distance", inches(70.0))?;
    let length = parameters.length("length", inches(240.0))?;
    let width = parameters.length("width", inches(60.0))?;
    let depth = parameters.length("depth", inches(40.0))?;
    let material = parameters.material("material", Material::Specular)?;
    let (start, end, back) = ((length - width) / 2.0, (length + width) / 2.0, distance + depth);
    let outline = [
        (end.max(length) + OVERHANG, distance),
        (end, distance),
        (end, back),
        (start, back),
        (start, distance),
        (start.min(0.0) - OVERHANG, distance),
    ];
    Ok(Scene { surfaces: polyline(&outline, material), openings: Vec::new(), course: course(parameters, length)? })
}

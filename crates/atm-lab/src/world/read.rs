//! Worlds from TOML: one function a section.
use std::path::Path as FilePath;

use atm::{
    error::{Error, Result},
    toml_document::{Document, Entry, Section},
    units,
};
use nalgebra::Point2;

use super::{
    CRITICAL_ANGLE, Course, KIND, Material, Opening, PAPER_RATE, PAPER_SPEED, Parts, Path, Shape, Surface, World,
    check::{Flaw, Part},
    parameters::Parameters,
};

const TOP: [&str; 7] = ["name", "material", "critical_angle", "wall", "pole", "opening", "path"];
const WALL: [&str; 3] = ["points", "closed", "material"];
const POLE: [&str; 4] = ["x", "y", "radius", "material"];
const OPENING: [&str; 2] = ["from", "to"];
/// The keys that every path has, and those of each kind of it.
const PATH: [&str; 3] = ["kind", "speed", "rate"];
const KINDS: [(&str, &[&str]); 4] = [
    ("straight", &["from", "to"]),
    ("weaving", &["from", "to", "amplitude", "wavelength"]),
    ("turning", &["at", "yaw", "turn", "turn_step"]),
    ("waypoints", &["points"]),
];
/// What a robot turns from one sweep to the next where nothing else is said (Fig. 11).
const TURN_STEP: f64 = std::f64::consts::PI / 72.0;

/// Reads a whole world. `set` may replace what holds for all of it: material, critical angle, speed, rate.
pub(super) fn world(text: &str, file: &str, set: &[(String, String)]) -> Result<World> {
    let document = Document { file, text, kind: &KIND };
    let root = document.parse()?;
    let top = Section::root(document, &root);
    top.only(&[&TOP])?;
    let name = match top.get("name") {
        Some(name) => name.text()?.to_owned(),
        None => FilePath::new(file).file_stem().map_or(file.into(), |stem| stem.to_string_lossy()).into_owned(),
    };
    let parameters = Parameters::new(file, set);
    let given = top.get("material").map_or(Ok(Material::Rough), |entry| material(&entry))?;
    let default = parameters.material("material", given)?;
    let given = top.get("critical_angle").map_or(Ok(CRITICAL_ANGLE), |entry| entry.angle())?;
    let critical_angle = parameters.angle("critical_angle", given)?;
    let mut places = Places::default();
    let surfaces = surfaces(&top, default, &mut places)?;
    let openings = openings(&top, &mut places)?;
    let entry = top.require("path")?;
    let path = path(&entry.section()?)?;
    let speed = parameters.speed("speed", path.speed)?;
    let rate = parameters.rate("rate", path.rate)?;
    parameters.finish()?;
    let path = Path { speed, rate, ..path };
    World::new(Parts { name, surfaces, openings, path, critical_angle })
        .map_err(|flaw| places.explain(flaw, &top, &entry))
}

/// Where the parts of a world stand in its file.
#[derive(Default)]
struct Places<'a> {
    surfaces: Vec<Entry<'a>>,
    openings: Vec<Entry<'a>>,
}

impl Places<'_> {
    /// A flaw, at the place that caused it.
    fn explain(&self, flaw: Flaw, top: &Section<'_>, path: &Entry<'_>) -> Error {
        let Flaw { part, message, surface } = flaw;
        let entry = match part {
            Part::Whole => None,
            Part::CriticalAngle => top.get("critical_angle"),
            Part::Surface(index) => self.surfaces.get(index).cloned(),
            Part::Opening(index) => self.openings.get(index).cloned(),
            Part::Path => Some(path.clone()),
        };
        let obstacle = surface.and_then(|index| self.surfaces.get(index));
        let obstacle = obstacle.map(|entry| format!(" what line {} describes", entry.line())).unwrap_or_default();
        match entry {
            Some(entry) => entry.error(&format!("{message}{obstacle}")),
            None => top.error(message),
        }
    }
}

/// Reads every `[[wall]]`, then every `[[pole]]`.
fn surfaces<'a>(top: &Section<'a>, default: Material, places: &mut Places<'a>) -> Result<Vec<Surface>> {
    let mut surfaces = Vec::new();
    for section in sections(top, "wall")? {
        section.only(&[&WALL])?;
        let material = section.get("material").map_or(Ok(default), |entry| material(&entry))?;
        let entry = section.require("points")?;
        let mut points = points(&entry)?;
        if section.get("closed").map_or(Ok(false), |entry| entry.flag())? {
            points.extend(points.first().cloned());
        }
        if points.len() < 2 {
            return Err(entry.error("a wall of no length: expected at least two points"));
        }
        for ((_, from), (place, to)) in points.iter().zip(points.iter().skip(1)) {
            surfaces.push(Surface { shape: Shape::Segment { from: *from, to: *to }, material });
            places.surfaces.push(place.clone());
        }
    }
    for section in sections(top, "pole")? {
        section.only(&[&POLE])?;
        let material = section.get("material").map_or(Ok(default), |entry| material(&entry))?;
        let center = Point2::new(section.require("x")?.length()?, section.require("y")?.length()?);
        let entry = section.require("radius")?;
        surfaces.push(Surface { shape: Shape::Circle { center, radius: entry.length()? }, material });
        places.surfaces.push(entry);
    }
    Ok(surfaces)
}

/// Reads every `[[opening]]`.
fn openings<'a>(top: &Section<'a>, places: &mut Places<'a>) -> Result<Vec<Opening>> {
    let mut openings = Vec::new();
    for section in sections(top, "opening")? {
        section.only(&[&OPENING])?;
        let (from, to) = (section.require("from")?, section.require("to")?);
        openings.push(Opening { jambs: [point(&from)?, point(&to)?] });
        places.openings.push(from);
    }
    Ok(openings)
}

/// Reads `[path]`.
fn path(section: &Section<'_>) -> Result<Path> {
    let kind = section.require("kind")?;
    let word = kind.text()?;
    let Some((_, keys)) = KINDS.iter().find(|(name, _)| *name == word) else {
        let names = KINDS.map(|(name, _)| name).join(", ");
        return Err(kind.error(&format!("expected one of {names}")));
    };
    section.only(&[&PATH, keys])?;
    let at = |key| point(&section.require(key)?);
    let course = match word {
        "weaving" => Course::Weaving {
            from: at("from")?,
            to: at("to")?,
            amplitude: section.require("amplitude")?.length()?,
            wavelength: section.require("wavelength")?.length()?,
        },
        "turning" => Course::Turning {
            at: at("at")?,
            yaw: section.get("yaw").map_or(Ok(0.0), |entry| entry.angle())?,
            turn: section.get("turn").map_or(Ok(std::f64::consts::TAU), |entry| entry.angle())?,
            step: section.get("turn_step").map_or(Ok(TURN_STEP), |entry| entry.angle())?,
        },
        "waypoints" => {
            let points = points(&section.require("points")?)?;
            Course::Waypoints(points.into_iter().map(|(_, point)| point).collect())
        }
        _ => Course::Straight { from: at("from")?, to: at("to")? },
    };
    let positive = |entry: Entry<'_>, value: f64| match value > 0.0 {
        true => Ok(value),
        false => Err(entry.error("must be above zero")),
    };
    let speed = section.get("speed").map(|entry| entry.quantity(units::speed).and_then(|value| positive(entry, value)));
    let rate = section.get("rate").map(|entry| entry.quantity(units::rate).and_then(|value| positive(entry, value)));
    Ok(Path { course, speed: speed.unwrap_or(Ok(PAPER_SPEED))?, rate: rate.unwrap_or(Ok(PAPER_RATE))? })
}

/// The tables of an array of tables; none where the key is missing.
fn sections<'a>(top: &Section<'a>, key: &str) -> Result<Vec<Section<'a>>> {
    top.get(key).map_or(Ok(Vec::new()), |entry| entry.sections())
}

/// Reads `[[x, y], …]`, and where each point stands.
fn points<'a>(entry: &Entry<'a>) -> Result<Vec<(Entry<'a>, Point2<f64>)>> {
    entry.items()?.into_iter().map(|item| point(&item).map(|point| (item, point))).collect()
}

/// Reads `[x, y]`.
fn point(entry: &Entry<'_>) -> Result<Point2<f64>> {
    match &entry.items()?[..] {
        [x, y] => Ok(Point2::new(x.length()?, y.length()?)),
        _ => Err(entry.error("expected a point: [x, y]")),
    }
}

/// Reads the name of a material.
fn material(entry: &Entry<'_>) -> Result<Material> {
    let name = entry.text()?;
    let names = Material::ALL.map(Material::name).join(", ");
    Material::from_name(name).ok_or_else(|| entry.error(&format!("no such material; expected one of {names}")))
}

//! What there is to be drawn, layer by layer, in metres.
use atm_core::{Isometry2, Point2, Reading};
use nalgebra::Vector2;

use crate::thinned::Thinned;

/// All that one reading says about where its echo came from, with the sensor it came from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cone {
    /// The sensor in the fixed frame, boresight along +x.
    pub sensor: Isometry2<f64>,
    /// The reading, in metres.
    pub range: f64,
    /// Half the beam, in radians.
    pub half_beam: f64,
}

impl Cone {
    /// The cone of a reading; `None` where it is no echo.
    pub fn of(reading: &Reading<f64>) -> Option<Self> {
        let half_beam = reading.beam.field_of_view() / 2.0;
        Some(Self { sensor: reading.pose, range: reading.range.echo()?, half_beam })
    }

    /// The point of the arc at an azimuth from the boresight, in radians.
    pub fn at(&self, azimuth: f64) -> Point2<f64> {
        self.sensor * Point2::new(self.range * libm::cos(azimuth), self.range * libm::sin(azimuth))
    }
}

/// A robot, seen from above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Robot {
    /// Its middle and heading.
    pub pose: Isometry2<f64>,
    /// Its radius in metres.
    pub radius: f64,
}

/// A straight wall or a round post.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Wall {
    /// From one end to the other.
    Straight([Point2<f64>; 2]),
    /// Middle and radius.
    Round(Point2<f64>, f64),
}

/// Square cells with values from 0 (not drawn) to 1 (black); what lies outside counts as the nearer of the two.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// The corner of the first cell with the smallest x and y.
    pub corner: Point2<f64>,
    /// Side of a cell, in metres, above 0.
    pub cell: f64,
    /// Cells in a row, along x.
    pub columns: usize,
    /// Row by row, y growing; the last row may be short.
    pub values: Vec<f64>,
}

/// What a layer is made of.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Content {
    Grid(Grid),
    Arcs(Thinned<Cone>),
    Walls(Vec<Wall>),
    Path(Thinned<Option<Point2<f64>>>),
    Beams(Vec<Cone>),
    Robot(Robot),
    Segments(Thinned<[Point2<f64>; 2]>),
    Marks(Thinned<Point2<f64>>),
    Rings(Vec<Point2<f64>>),
    Openings(Vec<[Point2<f64>; 2]>),
}

/// Its name and what it is made of.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Layer {
    pub(super) name: String,
    pub(super) content: Content,
}

/// Everything that one panel may show.
///
/// Layers have names: `walls`, `path`, `arcs`, `beam`, `beams`, `partners`, `robot`, `opening` and `grid`, the marks whatever
/// they are called: the kinds of echoes, `crossings`, `truth`, `centerline`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Scene {
    pub(super) layers: Vec<Layer>,
}

impl Scene {
    /// A scene without anything.
    pub const fn new() -> Self {
        Self { layers: Vec::new() }
    }

    fn add(&mut self, name: &str, content: Content) {
        self.layers.push(Layer { name: name.to_owned(), content });
    }

    /// Walls of one material.
    pub fn walls(&mut self, material: &str, walls: impl IntoIterator<Item = Wall>) {
        self.add(&format!("{WALLS} {material}"), Content::Walls(walls.into_iter().collect()));
    }

    /// Openings by their two jambs each: they are measured, with what the marks leave free of them.
    pub fn openings(&mut self, openings: impl IntoIterator<Item = [Point2<f64>; 2]>) {
        self.add("opening", Content::Openings(openings.into_iter().collect()));
    }

    /// Where the robot went; `None` is a gap.
    pub fn path(&mut self, path: impl IntoIterator<Item = Option<Point2<f64>>>) {
        self.add("path", Content::Path(path.into_iter().collect()));
    }

    /// Arcs, without the beams that lead to them.
    pub fn arcs(&mut self, name: &str, arcs: impl IntoIterator<Item = Cone>) {
        self.add(name, Content::Arcs(arcs.into_iter().collect()));
    }

    /// Whole beams, filled up to their arcs.
    pub fn beams(&mut self, name: &str, beams: impl IntoIterator<Item = Cone>) {
        self.add(name, Content::Beams(beams.into_iter().collect()));
    }

    /// The robot.
    pub fn robot(&mut self, robot: Robot) {
        self.add("robot", Content::Robot(robot));
    }

    /// Straight pieces that some methods give instead of points.
    pub fn segments(&mut self, name: &str, segments: impl IntoIterator<Item = [Point2<f64>; 2]>) {
        self.add(name, Content::Segments(segments.into_iter().collect()));
    }

    /// Points of one kind.
    pub fn marks(&mut self, name: &str, points: impl IntoIterator<Item = Point2<f64>>) {
        self.add(name, Content::Marks(points.into_iter().collect()));
    }

    /// Rings around marks that matter; they come and go with the marks of that name.
    pub fn rings(&mut self, name: &str, points: impl IntoIterator<Item = Point2<f64>>) {
        self.add(name, Content::Rings(points.into_iter().collect()));
    }

    /// A map of cells.
    pub fn grid(&mut self, grid: Grid) {
        self.add("grid", Content::Grid(grid));
    }

    /// The names of the layers, each once, in the order in which they were added.
    pub fn names(&self) -> Vec<&str> {
        let mut names = Vec::new();
        for layer in &self.layers {
            if !names.contains(&layer.base()) {
                names.push(layer.base());
            }
        }
        names
    }

    /// Whether there is nothing to be seen.
    pub fn is_empty(&self) -> bool {
        self.layers.iter().all(|layer| layer.content.is_empty())
    }

    /// Adds the layers of another scene.
    pub fn extend(&mut self, other: &Self) {
        self.layers.extend(other.layers.iter().cloned());
    }

    /// The scene with only the layers that `keep` says yes to, by their names.
    pub fn only(&self, keep: impl Fn(&str) -> bool) -> Self {
        Self { layers: self.layers.iter().filter(|layer| keep(layer.base())).cloned().collect() }
    }

    /// The marks that say that something stands somewhere: all but the truth.
    pub(super) fn claims(&self) -> Vec<Point2<f64>> {
        let marks = self.layers.iter().filter(|layer| layer.name != TRUTH);
        marks.flat_map(|layer| layer.content.marks()).collect()
    }

    /// A point on the robot's side of the walls: the middle of its path, or of what is claimed where there is none.
    pub(super) fn inside(&self) -> Point2<f64> {
        let path = self.layers.iter().filter(|layer| matches!(layer.content, Content::Path(_)));
        let mut places: Vec<Point2<f64>> = path.flat_map(|layer| layer.content.places()).collect();
        if places.is_empty() {
            places = self.claims();
        }
        let sum = places.iter().fold(Vector2::zeros(), |sum, place| sum + place.coords);
        Point2::from(sum / places.len().max(1) as f64)
    }

    /// The points that a frame has to show: those of marks, segments, grids, paths and openings; where there are only the latter
    /// two, those of arcs, and without those, of walls.
    pub fn extent(&self) -> Vec<Point2<f64>> {
        let all = |points: fn(&Content) -> Vec<Point2<f64>>| -> Vec<Point2<f64>> {
            self.layers.iter().flat_map(|layer| points(&layer.content)).collect()
        };
        let has = |kind: fn(&Content) -> bool| self.layers.iter().any(|layer| kind(&layer.content));
        let mut found = all(Content::places);
        if has(|content| matches!(content, Content::Marks(_) | Content::Segments(_) | Content::Grid(_))) {
            return found;
        }
        found.extend(all(if has(|content| matches!(content, Content::Arcs(_))) {
            Content::rims
        } else {
            Content::structure
        }));
        found
    }
}

/// Room on either side of an opening, in metres.
const OPENING_ROOM: f64 = 1.0;
/// What the names of walls begin with; their material follows.
const WALLS: &str = "walls";
/// The name of marks that are no claims.
pub(super) const TRUTH: &str = "truth";

impl Layer {
    /// The name by which it is chosen: of walls, without the material.
    pub(super) fn base(&self) -> &str {
        match self.content {
            Content::Walls(_) => WALLS,
            _ => &self.name,
        }
    }

    /// The material of walls; empty where it is not said.
    pub(super) fn material(&self) -> &str {
        self.name.split_once(' ').map_or("", |(_, material)| material)
    }
}

impl Content {
    pub(super) fn is_empty(&self) -> bool {
        match self {
            Self::Grid(grid) => grid.values.is_empty(),
            Self::Arcs(cones) => cones.is_empty(),
            Self::Walls(walls) => walls.is_empty(),
            Self::Path(path) => path.is_empty(),
            Self::Beams(cones) => cones.is_empty(),
            Self::Robot(_) => false,
            Self::Segments(segments) => segments.is_empty(),
            Self::Marks(points) => points.is_empty(),
            Self::Rings(points) => points.is_empty(),
            Self::Openings(openings) => openings.is_empty(),
        }
    }

    fn marks(&self) -> Vec<Point2<f64>> {
        match self {
            Self::Marks(points) => points.iter().copied().collect(),
            _ => Vec::new(),
        }
    }

    /// Points that matter in themselves.
    fn places(&self) -> Vec<Point2<f64>> {
        match self {
            Self::Marks(points) => points.iter().copied().collect(),
            Self::Path(path) => path.iter().copied().flatten().collect(),
            Self::Segments(segments) => segments.iter().flatten().copied().collect(),
            Self::Grid(grid) => grid.corners().to_vec(),
            Self::Openings(openings) => openings.iter().flat_map(|jambs| around(*jambs)).collect(),
            _ => Vec::new(),
        }
    }

    /// The middles of arcs.
    fn rims(&self) -> Vec<Point2<f64>> {
        match self {
            Self::Arcs(cones) => cones.iter().map(|cone| cone.at(0.0)).collect(),
            _ => Vec::new(),
        }
    }

    /// Ends of what stands there.
    fn structure(&self) -> Vec<Point2<f64>> {
        match self {
            Self::Walls(walls) => walls.iter().flat_map(|wall| wall.corners()).collect(),
            _ => Vec::new(),
        }
    }
}

/// What has to be seen of an opening: the jambs, and on either side room for what is written there.
fn around([from, to]: [Point2<f64>; 2]) -> [Point2<f64>; 6] {
    let along = (to - from) / (to - from).norm();
    let side = Vector2::new(-along.y, along.x) * OPENING_ROOM;
    [from, to, from + side, from - side, to + side, to - side]
}

impl Wall {
    fn corners(&self) -> [Point2<f64>; 2] {
        match *self {
            Self::Straight(ends) => ends,
            Self::Round(center, radius) => {
                let corner = Vector2::new(radius, radius);
                [center - corner, center + corner]
            }
        }
    }
}

impl Grid {
    /// The lower left and the upper right corner.
    pub fn corners(&self) -> [Point2<f64>; 2] {
        let rows = self.values.len().div_ceil(self.columns.max(1));
        [self.corner, self.corner + Vector2::new(self.columns as f64, rows as f64) * self.cell]
    }
}

//! One view of a scene: layers as paths, in pixels.
use std::collections::BTreeMap;

use atm::units::inches;
use atm_core::{Point2, Vector2};

use super::{
    frame::Frame,
    ink::{Anchor, Font, Ink},
    scene::{Cone, Content, Grid, Layer, Robot, Scene, Wall},
    style::{self, Names, SHADES},
    svg::PathData,
};
use crate::world::{DOORWAY_DEPTH, Gap};

/// Circles of a larger radius, in pixels, are not drawn: what renders them has single precision.
const LARGEST: f64 = 1e6;
/// Marks that are one path. To fill one takes time by the square of its marks, to have many takes room.
const AT_ONCE: u64 = 1000;
/// Steps of the path shorter than this many pixels are joined.
const SHORTEST_STEP: f64 = 0.5;
/// Height of a letter, and of the words over a dimension line, and half the length of its ticks, in pixels.
const LETTER: f64 = 11.0;
const WORDS_UP: f64 = 7.0;
const TICK: f64 = 4.5;
/// How far off the band in which points count the free stretch and the whole opening are measured, in pixels.
const FREE_OFF: f64 = 8.0;
const OPENING_OFF: f64 = 46.0;

/// Where on the page what part of the plane is seen.
#[derive(Debug, Clone, Copy)]
pub(super) struct View {
    pub(super) frame: Frame,
    pub(super) left: f64,
    pub(super) top: f64,
    /// Pixels in a metre.
    pub(super) scale: f64,
}

impl View {
    fn x(&self, x: f64) -> f64 {
        self.left + (x - self.frame.min().x) * self.scale
    }

    fn y(&self, y: f64) -> f64 {
        self.top + (self.frame.max().y - y) * self.scale
    }

    pub(super) fn width(&self) -> f64 {
        self.frame.width() * self.scale
    }

    pub(super) fn height(&self) -> f64 {
        self.frame.height() * self.scale
    }

    fn line(&self, path: &mut PathData, [from, to]: [Point2<f64>; 2]) {
        if let Some((from, to)) = self.frame.clip(from, to) {
            path.add('M', &[self.x(from.x), self.y(from.y)]).add('L', &[self.x(to.x), self.y(to.y)]);
        }
    }

    /// The arc of a reading from its right end to its left, `command` (`M` or `L`) leading to it.
    fn rim(&self, path: &mut PathData, command: char, cone: &Cone) {
        let (right, left) = (cone.at(-cone.half_beam), cone.at(cone.half_beam));
        path.add(command, &[self.x(right.x), self.y(right.y)]);
        path.arc_to(cone.range * self.scale, self.x(left.x), self.y(left.y));
    }

    /// Whether something of the beam may be seen: its circle around the sensor reaches into the frame, and can be drawn.
    fn sees(&self, cone: &Cone) -> bool {
        let (sensor, frame) = (cone.sensor.translation.vector, &self.frame);
        let beside = |value: f64, low: f64, high: f64| (low - value).max(value - high).max(0.0);
        let x = beside(sensor.x, frame.min().x, frame.max().x);
        let y = beside(sensor.y, frame.min().y, frame.max().y);
        libm::hypot(x, y) <= cone.range && cone.range * self.scale <= LARGEST
    }
}

/// Draws the scene in the view; what of it is not seen is counted.
pub(super) fn draw(scene: &Scene, view: &View, names: &Names<'_>, ink: &mut Ink) -> u64 {
    let mut layers: Vec<&Layer> = scene.layers.iter().collect();
    layers.sort_by_key(|layer| rank(layer, names));
    let (claims, inside) = (scene.claims(), scene.inside());
    let mut outside = 0;
    for layer in layers {
        match &layer.content {
            Content::Grid(grid) => cells(grid, view, ink),
            Content::Arcs(cones) => {
                let class = style::of_arcs(&layer.name, cones.iter().len());
                arcs(cones.iter(), view, class, ink);
            }
            Content::Walls(all) => walls(layer, all, view, ink),
            Content::Path(path) => trail(path.iter().copied(), view, ink),
            Content::Beams(cones) => beams(cones, view, style::of_beams(&layer.name), ink),
            Content::Robot(robot) if robot.radius * view.scale <= LARGEST => body(robot, view, ink),
            Content::Robot(_) => {}
            Content::Segments(all) => {
                let mut path = PathData::default();
                all.iter().for_each(|segment| view.line(&mut path, *segment));
                path.write(&names.segments(&layer.name), &mut ink.svg);
            }
            Content::Marks(points) => outside += marks(&layer.name, points.iter(), view, names, ink),
            Content::Rings(points) => {
                let mut path = PathData::default();
                for point in points.iter().filter(|point| view.frame.holds(**point)) {
                    path.circle(view.x(point.x), view.y(point.y), 7.5);
                }
                path.write("ring", &mut ink.svg);
            }
            Content::Openings(openings) => {
                for jambs in openings {
                    opening(*jambs, &claims, inside, view, ink);
                }
            }
        }
    }
    outside
}

/// What is drawn first, and what on top of it.
fn rank(layer: &Layer, names: &Names<'_>) -> u8 {
    match &layer.content {
        Content::Grid(_) => 0,
        Content::Arcs(_) => 1,
        Content::Walls(_) => 2,
        Content::Path(_) => 3,
        Content::Openings(_) => 4,
        Content::Beams(_) if layer.name == "beams" => 5,
        Content::Beams(_) => 6,
        Content::Robot(_) => 7,
        Content::Segments(_) => 8,
        Content::Marks(_) => 9 + names.marks(&layer.name).rank,
        Content::Rings(_) => u8::MAX,
    }
}

fn arcs<'a>(cones: impl Iterator<Item = &'a Cone>, view: &View, class: &str, ink: &mut Ink) {
    let mut path = PathData::default();
    cones.filter(|cone| view.sees(cone)).for_each(|cone| view.rim(&mut path, 'M', cone));
    path.write(class, &mut ink.svg);
}

fn beams(cones: &[Cone], view: &View, class: &str, ink: &mut Ink) {
    // One element each: where two overlap, that is seen.
    for cone in cones.iter().filter(|cone| view.sees(cone)) {
        let (mut path, tip) = (PathData::default(), cone.sensor.translation.vector);
        path.add('M', &[view.x(tip.x), view.y(tip.y)]);
        view.rim(&mut path, 'L', cone);
        path.add('Z', &[]);
        path.write(class, &mut ink.svg);
    }
}

fn walls(layer: &Layer, walls: &[Wall], view: &View, ink: &mut Ink) {
    let (mut path, mut posts) = (PathData::default(), PathData::default());
    for wall in walls {
        match *wall {
            Wall::Straight(ends) => view.line(&mut path, ends),
            Wall::Round(center, radius) if view.frame.holds(center) && radius * view.scale <= LARGEST => {
                posts.circle(view.x(center.x), view.y(center.y), (radius * view.scale).max(1.0));
            }
            Wall::Round(..) => {}
        }
    }
    let class = style::of_wall(layer.material());
    path.write(class, &mut ink.svg);
    posts.write(&format!("{class} post"), &mut ink.svg);
}

fn trail(places: impl Iterator<Item = Option<Point2<f64>>>, view: &View, ink: &mut Ink) {
    let (mut path, mut pen, mut last) = (PathData::default(), None, None::<Point2<f64>>);
    for place in places {
        let (Some(from), Some(to)) = (last, place) else {
            last = place;
            continue;
        };
        if (to - from).norm() * view.scale < SHORTEST_STEP {
            continue;
        }
        last = place;
        if let Some((from, to)) = view.frame.clip(from, to) {
            if pen != Some(from) {
                path.add('M', &[view.x(from.x), view.y(from.y)]);
            }
            path.add('L', &[view.x(to.x), view.y(to.y)]);
            pen = Some(to);
        }
    }
    path.write("path", &mut ink.svg);
}

fn marks<'a>(
    name: &str,
    points: impl Iterator<Item = &'a Point2<f64>>,
    view: &View,
    names: &Names<'_>,
    ink: &mut Ink,
) -> u64 {
    let (style, mut path) = (names.marks(name), PathData::default());
    let (mut inside, mut outside) = (0, 0);
    for point in points {
        if !view.frame.holds(*point) {
            outside += 1;
            continue;
        }
        style.mark.draw(&mut path, view.x(point.x), view.y(point.y));
        inside += 1;
        if inside % AT_ONCE == 0 {
            path.write(&style.class, &mut ink.svg);
            path = PathData::default();
        }
    }
    path.write(&style.class, &mut ink.svg);
    outside
}

fn body(robot: &Robot, view: &View, ink: &mut Ink) {
    let at = robot.pose.translation.vector;
    let (x, y, radius) = (view.x(at.x), view.y(at.y), robot.radius * view.scale);
    let mut path = PathData::default();
    path.circle(x, y, radius);
    path.write("robot", &mut ink.svg);
    // The arrow points along the heading; on the page y grows downwards.
    let (along, up) = (robot.pose.rotation.re, -robot.pose.rotation.im);
    let place = |forward: f64, left: f64| [x + forward * along + left * up, y + forward * up - left * along];
    let size = radius * 0.55;
    let mut arrow = PathData::default();
    arrow.add('M', &place(-size, 0.0)).add('L', &place(size, 0.0));
    arrow
        .add('M', &place(0.4 * size, 0.55 * size))
        .add('L', &place(size, 0.0))
        .add('L', &place(0.4 * size, -0.55 * size));
    arrow.write("arrow", &mut ink.svg);
}

/// Cells of one shade are one path, and equal neighbours in a row one rectangle.
fn cells(grid: &Grid, view: &View, ink: &mut Ink) {
    let mut shades: BTreeMap<usize, PathData> = BTreeMap::new();
    let side = grid.cell * view.scale;
    for (row, values) in grid.values.chunks(grid.columns.max(1)).enumerate() {
        let y = view.y(grid.corner.y + (row as f64 + 1.0) * grid.cell);
        let mut column = 0;
        for run in values.chunk_by(|a, b| shade(*a) == shade(*b)) {
            let (x, width) = (view.x(grid.corner.x + column as f64 * grid.cell), run.len() as f64 * side);
            column += run.len();
            let shade = run.first().map_or(0, |value| shade(*value));
            let seen = x + width > view.left
                && x < view.left + view.width()
                && y + side > view.top
                && y < view.top + view.height();
            if shade > 0 && seen {
                let path = shades.entry(shade).or_default();
                path.add('M', &[x, y]).add('h', &[width]).add('v', &[side]).add('h', &[-width]).add('z', &[]);
            }
        }
    }
    for (shade, path) in shades {
        path.write(&format!("g{shade}"), &mut ink.svg);
    }
}

/// 0 for an empty cell, and one number more for each share of the way to a full one.
fn shade(value: f64) -> usize {
    (value.clamp(0.0, 1.0) * (SHADES as f64 + 0.5)) as usize
}

/// What a text says of a length: `36 in (0.91 m)`.
fn length(metres: f64) -> String {
    format!("{:.0} in ({metres:.2} m)", metres / inches(1.0))
}

/// An opening seen along its wall: places are metres from the first jamb, and pixels off the wall on the side that faces
/// away from the path.
struct Doorway<'a> {
    view: &'a View,
    jamb: Point2<f64>,
    along: Vector2<f64>,
    away: Vector2<f64>,
}

impl Doorway<'_> {
    fn at(&self, place: f64, off: f64) -> [f64; 2] {
        let point = self.jamb + self.along * place;
        [self.view.x(point.x) + self.away.x * off, self.view.y(point.y) - self.away.y * off]
    }

    /// A dimension line off the wall, and the words for it beyond.
    fn dimension(&self, (from, to): (f64, f64), off: f64, font: Font, colour: &str, words: &str, ink: &mut Ink) {
        let mut path = PathData::default();
        path.add('M', &self.at(from, off)).add('L', &self.at(to, off));
        for end in [from, to] {
            path.add('M', &self.at(end, off - TICK)).add('L', &self.at(end, off + TICK));
        }
        path.write("thin", &mut ink.svg);
        // Words run along the wall, from left to right or upwards, and stand on the side of the line that faces away.
        let mut turn = libm::atan2(-self.along.y, self.along.x).to_degrees();
        if !(-90.0..90.0).contains(&turn) {
            turn -= 180.0_f64.copysign(turn);
        }
        let up = Vector2::new(libm::sin(turn.to_radians()), libm::cos(turn.to_radians()));
        let beyond = off + WORDS_UP + if up.dot(&self.away) > 0.0 { 0.0 } else { LETTER };
        let [x, y] = self.at(f64::midpoint(from, to), beyond);
        ink.turned_text((x, y), turn, Anchor::Middle, font, colour, words);
    }
}

/// The opening's width, and what the marks leave free of it: orange where that is less than half.
fn opening(jambs: [Point2<f64>; 2], claims: &[Point2<f64>], inside: Point2<f64>, view: &View, ink: &mut Ink) {
    let (span, width) = (jambs[1] - jambs[0], (jambs[1] - jambs[0]).norm());
    if !(view.frame.holds(jambs[0]) && view.frame.holds(jambs[1]) && width > 0.0) {
        return;
    }
    let along = span / width;
    let left = Vector2::new(-along.y, along.x);
    let away = if left.dot(&(inside - jambs[0])) > 0.0 { -left } else { left };
    let doorway = Doorway { view, jamb: jambs[0], along, away };
    let depth = DOORWAY_DEPTH * view.scale;
    if !claims.is_empty() {
        let gap = Gap::between(jambs, claims);
        let (free, off) = (gap.free, depth + FREE_OFF);
        if gap.width() > 0.0 {
            let number = if 2.0 * gap.width() < width { "1" } else { "2" };
            let mut band = PathData::default();
            band.add('M', &doorway.at(free.0, depth)).add('L', &doorway.at(free.1, depth));
            band.add('L', &doorway.at(free.1, -depth)).add('L', &doorway.at(free.0, -depth)).add('Z', &[]);
            band.write(&format!("free{number}"), &mut ink.svg);
            let (colour, words) = (format!("d{number}"), format!("free: {}", length(gap.width())));
            doorway.dimension(free, off, Font::Dimension, &colour, &words, ink);
        } else {
            doorway.dimension((0.0, width), off, Font::Dimension, "d1", "no points on its jambs", ink);
        }
    }
    let words = format!("opening: {}", length(width));
    doorway.dimension((0.0, width), depth + OPENING_OFF, Font::Plain, "", &words, ink);
}

//! Below the panels: what the marks mean, and a scale.
use super::{
    ink::{Anchor, Font, Ink},
    scene::{Content, Layer},
    style::{self, Mark, Names},
    svg::PathData,
};

/// Room for a symbol, and between entries, in pixels.
const SYMBOL: f64 = 22.0;
const GAP: f64 = 18.0;
const LINE: f64 = 20.0;
/// Most room for the words of one entry.
const WORDS: f64 = 260.0;
/// Room for the scale at the right end.
const SCALE: f64 = 150.0;
/// The longest a scale may be, in pixels.
const LONGEST: f64 = 120.0;

/// What stands in front of the words.
#[derive(Debug, Clone, PartialEq)]
enum Symbol {
    /// A piece of line of this class.
    Line(String),
    /// A piece of an arc.
    Arc(String),
    /// A beam.
    Beam(String),
    Mark(Mark, String),
    Ring,
    /// A cell of a grid.
    Cell,
}

/// One symbol with its meaning.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Entry {
    symbol: Symbol,
    words: String,
}

impl Entry {
    fn width(&self) -> f64 {
        SYMBOL + Font::Plain.width(&self.words) + GAP
    }
}

/// Where it goes, in pixels.
pub(super) struct Room {
    /// Its left and right end.
    pub(super) sides: (f64, f64),
    /// Middle of its first line.
    pub(super) first: f64,
    /// Pixels in a metre.
    pub(super) scale: f64,
}

/// What needs explaining of the layers of all panels, each thing once.
pub(super) fn entries<'a>(layers: impl Iterator<Item = &'a Layer>, names: &Names<'_>) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    let mut layers: Vec<&Layer> = layers.filter(|layer| !layer.content.is_empty()).collect();
    layers.sort_by_key(|layer| order(layer, names));
    for entry in layers.into_iter().filter_map(|layer| entry(layer, names)) {
        if !entries.iter().any(|known| known.words == entry.words) {
            entries.push(entry);
        }
    }
    entries
}

/// What stands there first, then where the robot was, then what was made of its readings, the best of it first.
fn order(layer: &Layer, names: &Names<'_>) -> u8 {
    match layer.content {
        Content::Walls(_) => 0,
        Content::Grid(_) => 1,
        Content::Path(_) => 2,
        Content::Arcs(_) if layer.name != "partners" => 3,
        Content::Beams(_) => 4,
        Content::Arcs(_) => 5,
        Content::Segments(_) => 6,
        Content::Marks(_) => u8::MAX - names.marks(&layer.name).rank,
        Content::Rings(_) | Content::Robot(_) | Content::Openings(_) => 7,
    }
}

fn entry(layer: &Layer, names: &Names<'_>) -> Option<Entry> {
    let name = layer.name.as_str();
    let line = |class: &str| Symbol::Line(class.to_owned());
    let (symbol, words) = match &layer.content {
        Content::Grid(_) => (Symbol::Cell, "occupied".to_owned()),
        Content::Arcs(_) if name == "partners" => (Symbol::Arc(name.to_owned()), "arcs that cross it".to_owned()),
        Content::Arcs(_) => (Symbol::Arc("arcs".to_owned()), "arcs of the readings".to_owned()),
        Content::Walls(_) => (line(style::of_wall(layer.material())), format!("{} wall", layer.material())),
        Content::Path(_) => (line("path"), "path".to_owned()),
        Content::Beams(_) if name == "beam" => (Symbol::Beam(name.to_owned()), "beam of one reading".to_owned()),
        Content::Segments(_) => (line(&names.segments(name)), name.to_owned()),
        Content::Marks(_) => {
            let style = names.marks(name);
            (Symbol::Mark(style.mark, style.class), style.words)
        }
        Content::Rings(_) => (Symbol::Ring, "its echo".to_owned()),
        Content::Beams(_) | Content::Robot(_) | Content::Openings(_) => return None,
    };
    let (weight, size, _) = Font::Plain.parts();
    Some(Entry { symbol, words: weight.fitted(words.trim(), size, WORDS) })
}

/// Lines that the legend takes in a room so wide.
pub(super) fn lines(entries: &[Entry], room: f64) -> usize {
    placed(entries, 0.0, room).last().map_or(1, |(line, _, _)| line + 1)
}

/// Each entry with its line and where in it it begins; the first line leaves room for the scale.
fn placed(entries: &[Entry], left: f64, right: f64) -> Vec<(usize, f64, &Entry)> {
    let (mut line, mut x) = (0, left);
    let mut all = Vec::new();
    for entry in entries {
        let end = if line == 0 { right - SCALE } else { right };
        if x > left && x + entry.width() > end {
            (line, x) = (line + 1, left);
        }
        all.push((line, x, entry));
        x += entry.width();
    }
    all
}

/// Draws the legend and the scale.
pub(super) fn draw(entries: &[Entry], room: &Room, ink: &mut Ink) {
    let (left, right) = room.sides;
    for (line, x, entry) in placed(entries, left, right) {
        let y = room.first + line as f64 * LINE;
        symbol(&entry.symbol, x, y, ink);
        ink.text((x + SYMBOL, y + 4.5), Anchor::Start, Font::Plain, "", &entry.words);
    }
    let (metres, words) = scale(room.scale);
    let length = metres * room.scale;
    let y = room.first + 2.0;
    let mut path = PathData::default();
    path.add('M', &[right - length, y - 4.0]).add('v', &[8.0]).add('m', &[0.0, -4.0]).add('h', &[length]);
    path.add('m', &[0.0, -4.0]).add('v', &[8.0]);
    path.write("thin", &mut ink.svg);
    ink.text((right - length - 6.0, y + 4.5), Anchor::End, Font::Plain, "", &words);
}

fn symbol(symbol: &Symbol, x: f64, y: f64, ink: &mut Ink) {
    let (mut path, middle) = (PathData::default(), x + 8.0);
    let class = match symbol {
        Symbol::Line(class) => {
            path.add('M', &[x, y]).add('h', &[16.0]);
            class
        }
        Symbol::Arc(class) => {
            path.add('M', &[x + 16.0, y + 2.0]).arc_to(16.0, x, y + 2.0);
            class
        }
        Symbol::Beam(class) => {
            path.add('M', &[middle, y + 7.0])
                .add('L', &[x + 14.0, y - 5.0])
                .arc_to(13.0, x + 2.0, y - 5.0)
                .add('Z', &[]);
            class
        }
        Symbol::Mark(mark, class) => {
            mark.draw(&mut path, middle, y);
            class
        }
        Symbol::Ring => {
            path.circle(middle, y, 7.0);
            "ring"
        }
        Symbol::Cell => {
            path.add('M', &[middle - 5.0, y - 5.0])
                .add('h', &[10.0])
                .add('v', &[10.0])
                .add('h', &[-10.0])
                .add('z', &[]);
            "g5"
        }
    };
    path.write(class, &mut ink.svg);
}

/// The longest round length that fits: 1, 2 or 5 of a power of ten, and how it is said.
fn scale(pixels_per_metre: f64) -> (f64, String) {
    let most = LONGEST / pixels_per_metre;
    let power = libm::pow(10.0, libm::floor(libm::log10(most)));
    let metres = [5.0, 2.0].into_iter().map(|step| step * power).find(|length| *length <= most).unwrap_or(power);
    let (value, unit) = match metres {
        _ if metres >= 1000.0 => (metres / 1000.0, "km"),
        _ if metres >= 1.0 => (metres, "m"),
        _ if metres >= 0.01 => (metres * 100.0, "cm"),
        _ => (metres * 1000.0, "mm"),
    };
    (metres, format!("{} {unit}", (value * 1e6).round() / 1e6))
}

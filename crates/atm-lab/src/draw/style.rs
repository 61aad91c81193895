//! How each layer looks: colours that the colour-blind can tell apart, and shapes that tell them apart in grey as well.
use std::fmt::Write;

use atm::style::{LINES, MARKS, Shape, Style};

use super::{
    scene::{Content, Layer},
    svg::PathData,
};

/// What the style sheet says of all but the things that the table of styles knows.
const SHEET: &str = "\
text,.t{font:13px Helvetica,Arial,'DejaVu Sans',sans-serif;fill:#444}\
.t1,.t2{font-weight:bold;font-size:19px;fill:#111}.t2{font-size:16px}.d{font-weight:bold;font-size:15px}\
.d0{fill:#111}.m{text-anchor:middle}.e{text-anchor:end}path{fill:none}\
.paper{fill:#fff}.border{fill:none;stroke:#ddd}.thin{stroke:#555}\
.partners{stroke:#555}\
.beam{fill:#777;fill-opacity:.2;stroke:#666}.beams{fill:#777;fill-opacity:.07;stroke:#777;stroke-opacity:.3}\
.arrow{stroke:#333;stroke-width:2}.ring{stroke:#111;stroke-width:1.6}\
.o0{fill:#e69f00;stroke:#fff;stroke-width:1.2;paint-order:stroke}.o1{stroke:#009e73;stroke-width:1.4}\
.o2{fill:#cc79a7;stroke:#fff;stroke-width:1.2;paint-order:stroke}.o3{stroke:#0072b2;stroke-width:1.4}\
.s0{stroke:#0072b2;stroke-width:2}.s1{stroke:#d55e00;stroke-width:2}.g1{fill:#e3e3e3}.g2{fill:#c2c2c2}\
.g3{fill:#9a9a9a}.g4{fill:#6b6b6b}.g5{fill:#2b2b2b}";

/// The style sheet of every picture, with the table's colours.
pub(super) fn sheet() -> String {
    let mut sheet = SHEET.to_owned();
    for style in MARKS.iter().chain(&LINES) {
        add_rule(style, &mut sheet);
    }
    sheet
}

/// How a mark, a line or an area of the table is drawn. A `String` takes whatever is written.
fn add_rule(style: &Style, sheet: &mut String) {
    let (name, color) = (style.name, format!("#{:06x}", style.on_light));
    let edge = |width: f64| format!("fill:{color};stroke:#fff;stroke-width:{width};paint-order:stroke");
    let rule = match (style.shape, name) {
        (Shape::Line, "rough" | "diffuse" | "solid") => {
            let _ = write!(sheet, ".{name}.post{{stroke:none;fill:{color}}}");
            format!("stroke:{color};stroke-width:7")
        }
        (Shape::Line, "specular") => {
            let _ = write!(sheet, ".{name}.post{{stroke:none;fill:{color}}}");
            format!("stroke:{color};stroke-width:3")
        }
        (Shape::Line, "path") => format!("stroke:{color};stroke-width:1.5;stroke-dasharray:1.5 3"),
        (Shape::Line, "arcs") => {
            let _ = write!(sheet, ".faint{{stroke:{color};stroke-opacity:.12}}");
            format!("stroke:{color};stroke-opacity:.35")
        }
        (Shape::Line, "robot") => format!("fill:#e8e8e8;stroke:{color}"),
        // The free width of an opening: a band, and the words for it.
        (Shape::Line, "shut") => {
            let _ = write!(sheet, ".d1{{fill:{color}}}.free1{{fill:{color};fill-opacity:.2}}");
            return;
        }
        (Shape::Line, "open") => {
            let _ = write!(sheet, ".d2{{fill:{color}}}.free2{{fill:{color};fill-opacity:.17}}");
            return;
        }
        (Shape::Line, _) => format!("stroke:{color}"),
        (Shape::Speck, _) => format!("fill:{color};fill-opacity:.75"),
        (Shape::Plus, _) => format!("stroke:{color};stroke-width:1.5"),
        (Shape::Cross, _) => format!("stroke:{color};stroke-width:1.2"),
        (Shape::Dot, _) => edge(1.0),
        (Shape::Disc, _) => edge(1.6),
        _ => edge(1.2),
    };
    let _ = write!(sheet, ".{name}{{{rule}}}");
}

/// Styles for marks that have no name of their own.
const OTHERS: usize = 4;
/// Colours of segments.
const SEGMENTS: usize = 2;
/// More arcs than this are drawn fainter.
const MANY_ARCS: usize = 400;
/// Shades of a grid's cells, the empty one aside.
pub(super) const SHADES: usize = 5;

/// The shape of a mark.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mark {
    Disc,
    SmallDisc,
    Speck,
    Circle,
    Plus,
    Tick,
    Square,
    Triangle,
    Nabla,
    Diamond,
}

impl Mark {
    /// The mark of a style's shape.
    const fn of(shape: Shape) -> Self {
        match shape {
            Shape::Dot => Self::SmallDisc,
            Shape::Speck => Self::Speck,
            Shape::Plus => Self::Plus,
            Shape::Cross => Self::Tick,
            Shape::Square => Self::Square,
            Shape::Triangle => Self::Triangle,
            Shape::Nabla => Self::Nabla,
            Shape::Diamond => Self::Diamond,
            Shape::Disc | Shape::Line => Self::Disc,
        }
    }

    /// Draws one mark, in pixels.
    pub(super) fn draw(self, path: &mut PathData, x: f64, y: f64) {
        match self {
            Self::Disc => path.circle(x, y, 3.5),
            Self::SmallDisc => path.circle(x, y, 2.8),
            Self::Speck => path.circle(x, y, 1.7),
            Self::Circle => path.circle(x, y, 3.2),
            Self::Plus => path.add('M', &[x - 5.5, y]).add('h', &[11.0]).add('m', &[-5.5, -5.5]).add('v', &[11.0]),
            Self::Tick => {
                path.add('M', &[x - 2.5, y - 2.5]).add('l', &[5.0, 5.0]).add('m', &[0.0, -5.0]).add('l', &[-5.0, 5.0])
            }
            Self::Square => {
                path.add('M', &[x - 2.8, y - 2.8]).add('h', &[5.6]).add('v', &[5.6]).add('h', &[-5.6]).add('z', &[])
            }
            Self::Triangle => path.add('M', &[x, y - 4.0]).add('l', &[3.8, 6.6]).add('h', &[-7.6]).add('z', &[]),
            Self::Nabla => path.add('M', &[x, y + 4.0]).add('l', &[3.8, -6.6]).add('h', &[-7.6]).add('z', &[]),
            Self::Diamond => path
                .add('M', &[x, y - 4.0])
                .add('l', &[4.0, 4.0])
                .add('l', &[-4.0, 4.0])
                .add('l', &[-4.0, -4.0])
                .add('z', &[]),
        };
    }
}

/// How marks of one name look, how late they are drawn, and what the legend calls them.
pub(super) struct MarkStyle {
    pub(super) class: String,
    pub(super) mark: Mark,
    pub(super) rank: u8,
    pub(super) words: String,
}

/// The rank of all other marks.
const RANK: u8 = 2;
const SHAPES: [Mark; OTHERS] = [Mark::Diamond, Mark::Circle, Mark::Square, Mark::Circle];

/// The names in a picture that have no look of their own, each once, in order: their place among them gives them one.
#[derive(Default)]
pub(super) struct Names<'a> {
    marks: Vec<&'a str>,
    segments: Vec<&'a str>,
}

impl<'a> Names<'a> {
    /// Those of these layers.
    pub(super) fn of(layers: impl Iterator<Item = &'a Layer>) -> Self {
        let mut names = Self::default();
        for layer in layers {
            let name = layer.name.as_str();
            let (list, known) = match layer.content {
                Content::Marks(_) => (&mut names.marks, MARKS.iter().any(|style| style.name == name)),
                Content::Segments(_) => (&mut names.segments, false),
                _ => continue,
            };
            if !known && !list.contains(&name) {
                list.push(name);
            }
        }
        names
    }

    /// How marks of this name look.
    pub(super) fn marks(&self, name: &str) -> MarkStyle {
        if let Some((rank, style)) = (0..).zip(&MARKS).find(|(_, style)| style.name == name) {
            // What lies between the first two of them are marks without a style of their own.
            let rank = if rank < RANK { rank } else { rank + 1 };
            let (class, words) = (style.name.to_owned(), style.words.to_owned());
            return MarkStyle { class, mark: Mark::of(style.shape), rank, words };
        }
        let index = self.marks.iter().position(|other| *other == name).unwrap_or_default() % OTHERS;
        let mark = SHAPES.get(index).copied().unwrap_or(Mark::Disc);
        MarkStyle { class: format!("o{index}"), mark, rank: RANK, words: name.to_owned() }
    }

    /// The class of segments of this name.
    pub(super) fn segments(&self, name: &str) -> String {
        let index = self.segments.iter().position(|other| *other == name).unwrap_or_default();
        format!("s{}", index % SEGMENTS)
    }
}

/// The class of arcs, of which there are so many.
pub(super) fn of_arcs(name: &str, count: usize) -> &'static str {
    match name {
        "partners" => "partners",
        _ if count > MANY_ARCS => "faint",
        _ => "arcs",
    }
}

/// The class of beams.
pub(super) fn of_beams(name: &str) -> &'static str {
    if name == "beams" { "beams" } else { "beam" }
}

/// The class of a wall.
pub(super) fn of_wall(material: &str) -> &'static str {
    ["rough", "diffuse", "specular"].into_iter().find(|known| *known == material).unwrap_or("solid")
}

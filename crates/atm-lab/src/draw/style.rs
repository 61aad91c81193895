//! How each layer looks: colours that the colour-blind can tell apart, and shapes that tell them apart in grey as well.
use super::{
    scene::{Content, Layer},
    svg::PathData,
};

/// The style sheet of every picture; colours by Okabe and Ito (Color Universal Design, 2008).
pub(super) const SHEET: &str = "\
text,.t{font:13px Helvetica,Arial,'DejaVu Sans',sans-serif;fill:#444}\
.t1,.t2{font-weight:bold;font-size:19px;fill:#111}.t2{font-size:16px}.d{font-weight:bold;font-size:15px}\
.d0{fill:#111}.d1{fill:#d55e00}.d2{fill:#0072b2}.m{text-anchor:middle}.e{text-anchor:end}path{fill:none}\
.paper{fill:#fff}.border{fill:none;stroke:#ddd}.thin{stroke:#555}.rough{stroke:#bdbdbd;stroke-width:7}\
.diffuse{stroke:#cdbfae;stroke-width:7}.specular{stroke:#7b93a8;stroke-width:3}\
.solid{stroke:#bdbdbd;stroke-width:7}.post{stroke:none;fill:#bdbdbd}.diffuse.post{fill:#cdbfae}\
.specular.post{fill:#7b93a8}.path{stroke:#888;stroke-width:1.5;stroke-dasharray:1.5 3}\
.arcs{stroke:#555;stroke-opacity:.35}.faint{stroke:#555;stroke-opacity:.12}.partners{stroke:#555}\
.beam{fill:#777;fill-opacity:.2;stroke:#666}.beams{fill:#777;fill-opacity:.07;stroke:#777;stroke-opacity:.3}\
.robot{fill:#e8e8e8;stroke:#555}.arrow{stroke:#333;stroke-width:2}.ring{stroke:#111;stroke-width:1.6}\
.free1{fill:#d55e00;fill-opacity:.2}.free2{fill:#0072b2;fill-opacity:.17}.truth{stroke:#111;stroke-width:1.2}\
.crossings{fill:#56b4e9;fill-opacity:.75}.center{fill:#d55e00;stroke:#fff;stroke-width:1;paint-order:stroke}\
.point{fill:#0072b2;stroke:#fff;stroke-width:1.2;paint-order:stroke}\
.wall{fill:#009e73;stroke:#fff;stroke-width:1.2;paint-order:stroke}\
.near{fill:#009e73;stroke:#fff;stroke-width:1.2;paint-order:stroke}\
.pair{fill:#cc79a7;stroke:#fff;stroke-width:1.2;paint-order:stroke}.single{stroke:#111;stroke-width:1.5}\
.median{fill:#0072b2;stroke:#fff;stroke-width:1.6;paint-order:stroke}\
.o0{fill:#e69f00;stroke:#fff;stroke-width:1.2;paint-order:stroke}.o1{stroke:#009e73;stroke-width:1.4}\
.o2{fill:#cc79a7;stroke:#fff;stroke-width:1.2;paint-order:stroke}.o3{stroke:#0072b2;stroke-width:1.4}\
.s0{stroke:#0072b2;stroke-width:2}.s1{stroke:#d55e00;stroke-width:2}.g1{fill:#e3e3e3}.g2{fill:#c2c2c2}\
.g3{fill:#9a9a9a}.g4{fill:#6b6b6b}.g5{fill:#2b2b2b}";

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
    Diamond,
}

impl Mark {
    /// Draws one mark, in pixels.
    pub(super) fn draw(self, path: &mut PathData, x: f64, y: f64) {
        match self {
            Self::Disc => path.circle(x, y, 3.5),
            Self::SmallDisc => path.circle(x, y, 2.8),
            Self::Speck => path.circle(x, y, 1.3),
            Self::Circle => path.circle(x, y, 3.2),
            Self::Plus => path.add('M', &[x - 4.5, y]).add('h', &[9.0]).add('m', &[-4.5, -4.5]).add('v', &[9.0]),
            Self::Tick => {
                path.add('M', &[x - 2.5, y - 2.5]).add('l', &[5.0, 5.0]).add('m', &[0.0, -5.0]).add('l', &[-5.0, 5.0])
            }
            Self::Square => {
                path.add('M', &[x - 2.8, y - 2.8]).add('h', &[5.6]).add('v', &[5.6]).add('h', &[-5.6]).add('z', &[])
            }
            Self::Triangle => path.add('M', &[x, y - 4.0]).add('l', &[3.8, 6.6]).add('h', &[-7.6]).add('z', &[]),
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

/// Names of marks that come with a look of their own: name, class, shape, rank, words.
const NAMED: [(&str, &str, Mark, u8, &str); 10] = [
    ("truth", "truth", Mark::Tick, 0, "true echo points"),
    ("crossings", "crossings", Mark::Speck, 1, "crossings"),
    ("centerline", "center", Mark::SmallDisc, 3, "centre of the cone"),
    ("center", "center", Mark::SmallDisc, 4, "center (no crossing)"),
    ("near", "near", Mark::Square, 5, "near"),
    ("pair", "pair", Mark::Triangle, 6, "pair"),
    ("single", "single", Mark::Plus, 7, "single"),
    ("median", "median", Mark::Disc, 8, "median"),
    ("wall", "wall", Mark::Diamond, 9, "wall"),
    ("point", "point", Mark::Disc, 10, "point"),
];
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
                Content::Marks(_) => (&mut names.marks, NAMED.iter().any(|named| named.0 == name)),
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
        if let Some(&(_, class, mark, rank, words)) = NAMED.iter().find(|named| named.0 == name) {
            return MarkStyle { class: class.to_owned(), mark, rank, words: words.to_owned() };
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

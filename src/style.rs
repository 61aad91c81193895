//! One table of colours and shapes: pictures, recordings, the view in a browser and Python's plots all take theirs from here.
//!
//! Hues are those of Okabe and Ito ("Color Universal Design", 2008), which people with any colour vision tell apart; each has a tone for
//! light and one for dark grounds, of at least 3 : 1 against either. No two marks share a shape.

/// How one thing is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Style {
    /// What it is called on the command line, and in files.
    pub name: &'static str,
    /// What a legend says.
    pub words: &'static str,
    /// Its shape.
    pub shape: Shape,
    /// Its colour on a light ground, 0xRRGGBB.
    pub on_light: u32,
    /// Its colour on a dark ground, 0xRRGGBB: what recordings take, whose viewers are dark.
    pub on_dark: u32,
}

/// The shape of a mark.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// A filled circle.
    Disc,
    /// A smaller one.
    Dot,
    /// The smallest that is still seen.
    Speck,
    /// An upright cross.
    Plus,
    /// A cross that lies on its side.
    Cross,
    /// A filled square.
    Square,
    /// A filled triangle that points up.
    Triangle,
    /// One that points down.
    Nabla,
    /// A filled square on its corner.
    Diamond,
    /// No mark but a line, or an area.
    Line,
}

impl Shape {
    /// Its word, as the view's file has it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Disc => "disc",
            Self::Dot => "dot",
            Self::Speck => "speck",
            Self::Plus => "plus",
            Self::Cross => "cross",
            Self::Square => "square",
            Self::Triangle => "triangle",
            Self::Nabla => "nabla",
            Self::Diamond => "diamond",
            Self::Line => "line",
        }
    }

    /// matplotlib's marker for it.
    pub const fn matplotlib(self) -> &'static str {
        match self {
            Self::Disc | Self::Dot => "o",
            Self::Speck => ".",
            Self::Plus => "+",
            Self::Cross => "x",
            Self::Square => "s",
            Self::Triangle => "^",
            Self::Nabla => "v",
            Self::Diamond => "D",
            Self::Line => "",
        }
    }
}

const fn style(name: &'static str, words: &'static str, shape: Shape, on_light: u32, on_dark: u32) -> Style {
    Style { name, words, shape, on_light, on_dark }
}

/// Where two arcs cross.
pub const CROSSINGS: Style = style("crossings", "crossings", Shape::Speck, 0x2b_87_b8, 0x56_b4_e9);
/// Where the robot went.
pub const PATH: Style = style("path", "path", Shape::Line, 0x88_88_88, 0x8f_97_a1);
/// The arcs of readings.
pub const ARCS: Style = style("arcs", "arcs of the readings", Shape::Line, 0x55_55_55, 0xa6_ad_b5);

/// Marks, from the back of a picture to its front: what is good enough to drive by lies on top.
pub const MARKS: [Style; 10] = [
    style("truth", "true echo points", Shape::Cross, 0x11_11_11, 0xf2_f2_f2),
    CROSSINGS,
    style("centerline", "centre of the cone", Shape::Dot, 0xd5_5e_00, 0xf0_7f_2e),
    style("center", "center (no crossing)", Shape::Dot, 0xd5_5e_00, 0xf0_7f_2e),
    style("near", "near", Shape::Square, 0xb5_5d_8d, 0xcc_79_a7),
    style("pair", "pair", Shape::Triangle, 0xb0_7a_00, 0xe6_9f_00),
    // Its arms reach out from under a disc.
    style("single", "single", Shape::Plus, 0x11_11_11, 0xf2_f2_f2),
    style("median", "median", Shape::Disc, 0x00_72_b2, 0x45_a2_e0),
    style("wall", "wall", Shape::Nabla, 0x00_8a_65, 0x1f_c0_92),
    style("point", "point", Shape::Diamond, 0x00_72_b2, 0x45_a2_e0),
];

/// Lines and areas.
pub const LINES: [Style; 9] = [
    style("rough", "rough wall", Shape::Line, 0xbd_bd_bd, 0x5d_63_6b),
    style("diffuse", "diffuse wall", Shape::Line, 0xcd_bf_ae, 0x6b_60_52),
    style("specular", "specular wall", Shape::Line, 0x7b_93_a8, 0x7b_93_a8),
    style("solid", "wall", Shape::Line, 0xbd_bd_bd, 0x5d_63_6b),
    PATH,
    ARCS,
    style("robot", "robot", Shape::Line, 0x55_55_55, 0xc6_cc_d3),
    style("shut", "free width, less than half", Shape::Line, 0xd5_5e_00, 0xf0_7f_2e),
    style("open", "free width", Shape::Line, 0x00_72_b2, 0x45_a2_e0),
];

/// The style of marks, lines or areas of this name.
pub fn named(name: &str) -> Option<&'static Style> {
    MARKS.iter().chain(&LINES).find(|style| style.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::echo::AnyEstimator;

    /// Relative luminance (WCAG 2.2).
    fn luminance(color: u32) -> f64 {
        let part = |shift: u32| {
            let value = f64::from((color >> shift) & 0xff) / 255.0;
            if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * part(16) + 0.7152 * part(8) + 0.0722 * part(0)
    }

    fn contrast(one: u32, other: u32) -> f64 {
        let (one, other) = (luminance(one) + 0.05, luminance(other) + 0.05);
        one.max(other) / one.min(other)
    }

    #[test]
    fn every_mark_stands_out_on_either_ground() {
        for style in MARKS {
            assert!(contrast(style.on_light, 0xff_ff_ff) >= 3.0, "{} on white", style.name);
            assert!(contrast(style.on_dark, 0x14_18_1d) >= 3.0, "{} on dark", style.name);
        }
    }

    #[test]
    fn no_two_kinds_share_a_shape() {
        let kinds: Vec<&Style> = [AnyEstimator::PAPER.kinds(), &["point", "wall"]]
            .concat()
            .iter()
            .map(|kind| named(kind).expect("every kind has a style"))
            .collect();
        for (index, one) in kinds.iter().enumerate() {
            assert!(kinds[..index].iter().all(|other| other.shape != one.shape), "{}", one.name);
        }
    }

    /// Python's plots have these colours and markers, line by line.
    #[test]
    fn pythons_plots_agree() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/crates/atm-py/python/atm/plot.py");
        let Ok(text) = std::fs::read_to_string(path) else {
            panic!("{path}: not there");
        };
        for kind in ["center", "near", "pair", "median", "single", "wall", "point"] {
            let style = named(kind).expect("every kind has a style");
            let line = text.lines().find(|line| line.trim_start().starts_with(&format!("\"{kind}\": {{")));
            let line = line.unwrap_or_else(|| panic!("{kind}: no style in plot.py"));
            assert!(line.contains(&format!("\"marker\": \"{}\"", style.shape.matplotlib())), "{line}");
            assert!(line.contains(&format!("\"color\": \"#{:06x}\"", style.on_light)), "{line}");
        }
        let crossings = named("crossings").expect("crossings have a style").on_light;
        assert!(text.contains(&format!("_CROSSINGS = \"#{crossings:06x}\"")), "crossings");
    }
}

//! The page: titles, panels side by side, what the marks mean, and how long a metre is.
use std::fmt::Write;

use atm_core::Point2;

use super::{
    frame::Frame,
    ink::{Anchor, Font, Ink},
    legend::{self, Entry, Room},
    panel::{self, View},
    scene::Scene,
    style::{self, Names},
    svg::{escaped, text_of},
};

/// Width of a picture in pixels where none is asked for: that of a page of a README.
pub const WIDTH: f64 = 900.0;
/// Smallest and largest side of a picture, in pixels.
pub const SIDES: (f64, f64) = (64.0, 16_384.0);
/// Heights that a panel may have of itself, in parts of its width.
const ASPECTS: (f64, f64) = (0.25, 1.25);
const MARGIN: f64 = 16.0;
/// Room between two panels.
const GAP: f64 = 20.0;
const LINE: f64 = 20.0;

/// A scene with its heading.
#[derive(Debug, Clone, Default)]
pub struct Panel {
    /// A line in bold letters; none where it is empty.
    pub title: String,
    /// A line below it; none where it is empty.
    pub subtitle: String,
    /// What is to be seen.
    pub scene: Scene,
}

/// A picture: one panel or several, which all show the same part of the plane.
#[derive(Debug, Clone, Default)]
pub struct Picture {
    /// Over all panels; none where it is empty.
    pub title: String,
    /// From left to right, row by row; at least one is drawn.
    pub panels: Vec<Panel>,
    /// How many panels stand in a row; all in one where it is not given.
    pub columns: Option<usize>,
    /// What part of the plane they show; where it is not given, what holds their points but for a few stray ones.
    pub frame: Option<Frame>,
    /// Width in pixels, brought within [`SIDES`]; [`WIDTH`] where it is not given.
    pub width: Option<f64>,
    /// Height in pixels, brought within [`SIDES`]; what the frame needs where it is not given.
    pub height: Option<f64>,
}

impl Picture {
    /// The picture as SVG: the same bytes for the same picture, text as text.
    pub fn svg(&self) -> String {
        self.draw(false).0
    }

    /// The picture as SVG whose letters are outlines, and its width and height.
    pub(super) fn outlined(&self) -> (String, f64, f64) {
        self.draw(true)
    }

    fn draw(&self, outlines: bool) -> (String, f64, f64) {
        let layers = || self.panels.iter().flat_map(|panel| &panel.scene.layers);
        let names = Names::of(layers());
        let entries = legend::entries(layers(), &names);
        let layout = Layout::of(self, &entries);
        let mut ink = Ink::new(outlines);
        let (width, height) = (text_of(layout.width), text_of(layout.height));
        let size = format!("width=\"{width}\" height=\"{height}\"");
        let _ = writeln!(ink.svg, "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" {size}>");
        let title = if self.title.is_empty() { "atm" } else { &self.title };
        let _ = writeln!(ink.svg, "<title>{}</title>\n<style>{}</style>", escaped(title), style::sheet());
        let _ = writeln!(ink.svg, "<rect class=\"paper\" {size}/>");
        self.head(&layout, &mut ink);
        let empty = [Panel::default()];
        let panels = if self.panels.is_empty() { &empty[..] } else { &self.panels };
        for (index, panel) in panels.iter().enumerate() {
            layout.panel(index, panel, &names, &mut ink);
        }
        legend::draw(&entries, &layout.legend, &mut ink);
        ink.svg.push_str("</svg>\n");
        (ink.svg, layout.width, layout.height)
    }

    fn head(&self, layout: &Layout, ink: &mut Ink) {
        let line = |room: f64, font: Font, words: &str| {
            let (weight, size, _) = font.parts();
            weight.fitted(words, size, room)
        };
        if !self.title.is_empty() {
            let words = line(layout.width - 2.0 * MARGIN, Font::Title, &self.title);
            ink.text((MARGIN, MARGIN + 14.0), Anchor::Start, Font::Title, "", &words);
        }
        for (index, panel) in self.panels.iter().enumerate() {
            let (left, top) = layout.corner(index);
            let mut y = top - layout.headings + 12.0;
            for (words, font) in [(&panel.title, Font::Heading), (&panel.subtitle, Font::Plain)] {
                if !words.is_empty() {
                    let words = line(layout.panel_width, font, words);
                    ink.text((left, y), Anchor::Start, font, "", &words);
                }
                y += LINE;
            }
        }
    }

    fn frame(&self) -> Frame {
        let found = || {
            let points: Vec<Point2<f64>> = self.panels.iter().flat_map(|panel| panel.scene.extent()).collect();
            Frame::around(&points)
        };
        self.frame.or_else(found).unwrap_or(Frame::EMPTY)
    }
}

/// Where everything goes, in pixels.
struct Layout {
    width: f64,
    height: f64,
    /// Height of the headings over each row of panels.
    headings: f64,
    panel_width: f64,
    /// Panels in a row.
    columns: usize,
    /// Of the first panel.
    view: View,
    /// Whether somebody chose what part of the plane to show.
    chosen: bool,
    legend: Room,
}

impl Layout {
    fn of(picture: &Picture, entries: &[Entry]) -> Self {
        let side = |side: f64| if side.is_finite() { side.round().clamp(SIDES.0, SIDES.1) } else { WIDTH };
        let width = side(picture.width.unwrap_or(WIDTH));
        let count = picture.panels.len().max(1);
        let columns = picture.columns.unwrap_or(count).clamp(1, count);
        let (across, down) = (columns as f64, count.div_ceil(columns) as f64);
        let panel_width = ((width - 2.0 * MARGIN - (across - 1.0) * GAP) / across).max(1.0);
        let has = |line: fn(&Panel) -> bool| if picture.panels.iter().any(line) { LINE } else { 0.0 };
        let headings = has(|panel| !panel.title.is_empty()) + has(|panel| !panel.subtitle.is_empty());
        let top = MARGIN + if picture.title.is_empty() { 0.0 } else { LINE + 8.0 };
        let foot = 10.0 + LINE * legend::lines(entries, width - 2.0 * MARGIN) as f64 + 8.0;
        let frame = picture.frame();
        let aspect = frame.height() / frame.width();
        let own = (panel_width * aspect.clamp(ASPECTS.0, ASPECTS.1)).round();
        // All but the panels themselves.
        let around = top + down * headings + (down - 1.0) * GAP + foot;
        let height = picture.height.map_or_else(|| side(around + down * own), side);
        let panel_height = ((height - around) / down).max(1.0);
        let frame = frame.with_aspect(panel_width / panel_height);
        let view = View { frame, left: MARGIN, top: top + headings, scale: panel_width / frame.width() };
        let chosen = picture.frame.is_some();
        let first = top + down * (headings + panel_height) + (down - 1.0) * GAP + 10.0 + LINE / 2.0;
        let legend = Room { sides: (MARGIN, width - MARGIN), first, scale: view.scale };
        Self { width, height, headings, panel_width, columns, view, chosen, legend }
    }

    /// Upper left corner of a panel, below its headings.
    fn corner(&self, index: usize) -> (f64, f64) {
        let (row, column) = (index / self.columns, index % self.columns);
        let across = self.panel_width + GAP;
        let down = self.headings + self.view.height() + GAP;
        (self.view.left + column as f64 * across, self.view.top + row as f64 * down)
    }

    /// Draws one panel.
    fn panel(&self, index: usize, panel: &Panel, names: &Names<'_>, ink: &mut Ink) {
        let (left, top) = self.corner(index);
        let view = View { left, top, ..self.view };
        let (left, top) = (text_of(left), text_of(top));
        let (width, height) = (text_of(view.width()), text_of(view.height()));
        let rectangle = format!("x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\"");
        let _ = writeln!(ink.svg, "<clipPath id=\"p{index}\"><rect {rectangle}/></clipPath>");
        let _ = writeln!(ink.svg, "<g clip-path=\"url(#p{index})\">");
        let outside = panel::draw(&panel.scene, &view, names, ink);
        let _ = writeln!(ink.svg, "</g>\n<rect class=\"border\" {rectangle}/>");
        if panel.scene.is_empty() {
            let middle = (view.left + view.width() / 2.0, view.top + view.height() / 2.0);
            ink.text(middle, Anchor::Middle, Font::Plain, "", "nothing to draw");
        }
        // What part to show was chosen: that some is not shown is no news then.
        if outside > 0 && !self.chosen {
            let corner = (view.left + view.width() - 6.0, view.top + view.height() - 8.0);
            ink.text(
                corner,
                Anchor::End,
                Font::Plain,
                "",
                &format!("{outside} {} outside", if outside == 1 { "mark lies" } else { "marks lie" }),
            );
        }
    }
}

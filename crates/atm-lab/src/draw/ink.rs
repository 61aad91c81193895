//! The picture as it grows, and the words in it.
use std::fmt::Write;

use super::{
    letters::Weight,
    svg::{escaped, text_of},
};

/// The picture as it grows.
pub(super) struct Ink {
    pub(super) svg: String,
    /// Letters become outlines: what is to be made pixels of needs no fonts then.
    outlines: bool,
}

/// Where a text stands at its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

impl Ink {
    pub(super) const fn new(outlines: bool) -> Self {
        Self { svg: String::new(), outlines }
    }

    /// Writes a line of text; `colour` is a class of the style sheet, or empty.
    pub(super) fn text(&mut self, at: (f64, f64), anchor: Anchor, font: Font, colour: &str, words: &str) {
        self.turned_text(at, 0.0, anchor, font, colour, words);
    }

    /// The same, turned clockwise about its point by an angle in degrees.
    pub(super) fn turned_text(
        &mut self,
        (x, y): (f64, f64),
        turn: f64,
        anchor: Anchor,
        font: Font,
        colour: &str,
        words: &str,
    ) {
        let (weight, size, class) = font.parts();
        let (share, anchor) = match anchor {
            Anchor::Start => (0.0, ""),
            Anchor::Middle => (0.5, "m"),
            Anchor::End => (1.0, "e"),
        };
        let outline = self.outlines.then(|| weight.outline(words, x - share * weight.width(words, size), y, size));
        let letters = if self.outlines { "t" } else { anchor };
        let classes: Vec<_> = [letters, class, colour].into_iter().filter(|class| !class.is_empty()).collect();
        let mut attributes = String::new();
        if !classes.is_empty() {
            let _ = write!(attributes, " class=\"{}\"", classes.join(" "));
        }
        let (x, y) = (text_of(x), text_of(y));
        if turn != 0.0 {
            let _ = write!(attributes, " transform=\"rotate({} {x} {y})\"", text_of(turn));
        }
        let _ = match outline {
            Some(d) => writeln!(self.svg, "<path{attributes} d=\"{d}\"/>"),
            None => writeln!(self.svg, "<text{attributes} x=\"{x}\" y=\"{y}\">{}</text>", escaped(words)),
        };
    }
}

/// The letters of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Font {
    Plain,
    /// Of the whole picture.
    Title,
    /// Of one panel.
    Heading,
    Dimension,
}

impl Font {
    /// Weight, size in pixels, and class in the style sheet.
    pub(super) fn parts(self) -> (Weight, f64, &'static str) {
        match self {
            Self::Plain => (Weight::Regular, 13.0, ""),
            Self::Title => (Weight::Bold, 19.0, "t1"),
            Self::Heading => (Weight::Bold, 16.0, "t2"),
            Self::Dimension => (Weight::Bold, 15.0, "d"),
        }
    }

    pub(super) fn width(self, words: &str) -> f64 {
        let (weight, size, _) = self.parts();
        weight.width(words, size)
    }
}

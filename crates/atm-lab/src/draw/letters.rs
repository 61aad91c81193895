//! Letters that need no fonts on the machine: their widths, and their outlines for pictures made of pixels.
//!
//! The font is DejaVu Sans 2.37 (Bitstream Vera licence; the changes to it are in the public domain).
use ttf_parser::{Face, OutlineBuilder};

use super::svg::number;

/// How heavy the letters are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Weight {
    Regular,
    Bold,
}

/// Width of a letter that the font lacks, in parts of the size.
const MISSING_WIDTH: f64 = 0.6;

impl Weight {
    fn face(self) -> Option<Face<'static>> {
        let font = match self {
            Self::Regular => dejavu::sans::regular(),
            Self::Bold => dejavu::sans::bold(),
        };
        Face::parse(font, 0).ok()
    }

    /// Width of a line of text in letters of `size` pixels.
    pub(super) fn width(self, text: &str, size: f64) -> f64 {
        let face = self.face();
        text.chars().map(|letter| advance(face.as_ref(), letter) * size).sum()
    }

    /// The text, cut short with an ellipsis where it is wider than `room` pixels.
    pub(super) fn fitted(self, text: &str, size: f64, room: f64) -> String {
        if self.width(text, size) <= room {
            return text.to_owned();
        }
        let face = self.face();
        let (mut kept, mut width) = (String::new(), advance(face.as_ref(), '…') * size);
        for letter in text.chars() {
            width += advance(face.as_ref(), letter) * size;
            if width > room {
                break;
            }
            kept.push(letter);
        }
        kept.push('…');
        kept
    }

    /// The outlines of a line of text that begins at (`x`, `y`), as the `d` of an SVG path.
    pub(super) fn outline(self, text: &str, x: f64, y: f64, size: f64) -> String {
        let Some(face) = self.face() else {
            return String::new();
        };
        let mut pen = Pen { d: String::new(), x, y, scale: size / f64::from(face.units_per_em()) };
        for letter in text.chars() {
            if let Some(glyph) = face.glyph_index(letter) {
                face.outline_glyph(glyph, &mut pen);
            }
            pen.x += advance(Some(&face), letter) * size;
        }
        pen.d
    }
}

/// How far a letter moves the next one, in parts of the size.
fn advance(face: Option<&Face<'_>>, letter: char) -> f64 {
    let known = face.and_then(|face| {
        let advance = face.glyph_hor_advance(face.glyph_index(letter)?)?;
        Some(f64::from(advance) / f64::from(face.units_per_em()))
    });
    known.unwrap_or(MISSING_WIDTH)
}

/// Writes the outlines of letters one after another; the font's y grows upwards.
struct Pen {
    d: String,
    x: f64,
    y: f64,
    scale: f64,
}

impl Pen {
    fn add(&mut self, command: char, points: &[(f32, f32)]) {
        self.d.push(command);
        for (index, &(x, y)) in points.iter().enumerate() {
            if index > 0 {
                self.d.push(' ');
            }
            number(&mut self.d, self.x + f64::from(x) * self.scale);
            self.d.push(' ');
            number(&mut self.d, self.y - f64::from(y) * self.scale);
        }
    }
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.add('M', &[(x, y)]);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.add('L', &[(x, y)]);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.add('Q', &[(x1, y1), (x, y)]);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.add('C', &[(x1, y1), (x2, y2), (x, y)]);
    }

    fn close(&mut self) {
        self.d.push('Z');
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_are_those_of_the_font() {
        // DejaVu Sans: advance of 'm' is 1995 of 2048 units, of 'i' 569.
        assert!((Weight::Regular.width("mi", 20.48) - (19.95 + 5.69)).abs() < 1e-9);
        assert!(Weight::Bold.width("mi", 20.48) > Weight::Regular.width("mi", 20.48));
        assert_eq!(Weight::Regular.width("", 12.0), 0.0);
    }

    #[test]
    fn letters_the_font_lacks_take_room_and_are_left_out() {
        assert!((Weight::Regular.width("\u{10ffff}", 10.0) - 6.0).abs() < 1e-9);
        assert_eq!(Weight::Regular.outline("\u{10ffff}", 0.0, 0.0, 10.0), "");
    }

    #[test]
    fn text_is_cut_to_its_room() {
        let cut = Weight::Regular.fitted("a title that is far too long", 13.0, 90.0);
        assert!(cut.ends_with('…') && Weight::Regular.width(&cut, 13.0) <= 90.0, "{cut}");
        assert_eq!(Weight::Regular.fitted("short", 13.0, 90.0), "short");
    }

    #[test]
    fn outlines_lie_where_the_text_stands() {
        // A hyphen is one rectangle between the baseline and the height of small letters.
        let d = Weight::Regular.outline("-", 100.0, 50.0, 20.0);
        let numbers: Vec<f64> = d.split(['M', 'L', 'Z', ' ']).filter_map(|part| part.parse().ok()).collect();
        assert!(numbers.len() >= 8, "{d}");
        for corner in numbers.chunks(2) {
            assert!((100.0..108.0).contains(&corner[0]) && (38.0..50.0).contains(&corner[1]), "{d}");
        }
    }
}

//! SVG text: numbers, words, and paths that hold all marks of one kind.
use std::fmt::Write;

/// Appends a number with at most three decimals and no more characters than it needs; what is not finite becomes 0.
pub(super) fn number(out: &mut String, value: f64) {
    let start = out.len();
    let value = if value.is_finite() { value } else { 0.0 };
    // A `String` takes whatever is written.
    let _ = write!(out, "{value:.3}");
    while out.ends_with('0') {
        out.pop();
    }
    if out.ends_with('.') {
        out.pop();
    }
    if out.get(start..) == Some("-0") {
        out.truncate(start);
        out.push('0');
    }
}

/// The number as [`number`] appends it.
pub(super) fn text_of(value: f64) -> String {
    let mut text = String::new();
    number(&mut text, value);
    text
}

/// A text as it may stand in an element or an attribute; what XML can't hold becomes U+FFFD.
pub(super) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\t' | '\n' | '\r' => out.push(' '),
            '\u{0}'..='\u{1f}' | '\u{7f}'..='\u{9f}' | '\u{fffe}' | '\u{ffff}' => out.push('\u{fffd}'),
            _ => out.push(letter),
        }
    }
    out
}

/// A path that grows: many shapes in one element.
#[derive(Debug, Default)]
pub(super) struct PathData(String);

impl PathData {
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// One command and its numbers.
    pub(super) fn add(&mut self, command: char, numbers: &[f64]) -> &mut Self {
        self.0.push(command);
        for (index, &value) in numbers.iter().enumerate() {
            let start = self.0.len();
            number(&mut self.0, value);
            // A minus parts numbers as well as a blank.
            if index > 0 && self.0.as_bytes().get(start) != Some(&b'-') {
                self.0.insert(start, ' ');
            }
        }
        self
    }

    /// An arc of a circle to (`x`, `y`), less than half of it; on the screen it goes counter-clockwise.
    pub(super) fn arc_to(&mut self, radius: f64, x: f64, y: f64) -> &mut Self {
        self.add('A', &[radius, radius, 0.0, 0.0, 0.0, x, y])
    }

    /// A whole circle.
    pub(super) fn circle(&mut self, x: f64, y: f64, radius: f64) -> &mut Self {
        self.add('M', &[x - radius, y]);
        self.add('a', &[radius, radius, 0.0, 1.0, 0.0, 2.0 * radius, 0.0]);
        self.add('a', &[radius, radius, 0.0, 1.0, 0.0, -2.0 * radius, 0.0])
    }

    /// The element with this class; nothing where nothing was drawn.
    pub(super) fn write(&self, class: &str, out: &mut String) {
        if !self.is_empty() {
            let _ = writeln!(out, "<path class=\"{}\" d=\"{}\"/>", escaped(class), self.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_take_no_more_room_than_they_need() {
        let cases = [(1.0, "1"), (-0.0001, "0"), (0.0, "0"), (100.0, "100"), (0.25, "0.25"), (-1.23456, "-1.235")];
        for (value, text) in cases {
            assert_eq!(text_of(value), text);
        }
        assert_eq!((text_of(f64::NAN), text_of(f64::INFINITY)), ("0".to_owned(), "0".to_owned()));
    }

    #[test]
    fn words_can_not_break_out_of_the_xml() {
        assert_eq!(escaped("<a & \"b\">"), "&lt;a &amp; &quot;b&quot;&gt;");
        assert_eq!(escaped("\u{0}\u{b}\n\u{7f}"), "\u{fffd}\u{fffd} \u{fffd}");
    }

    #[test]
    fn numbers_of_a_path_stay_apart() {
        let mut path = PathData::default();
        path.add('M', &[1.0, -2.0]).add('L', &[3.0, 4.5]);
        let mut out = String::new();
        path.write("wall", &mut out);
        assert_eq!(out, "<path class=\"wall\" d=\"M1-2L3 4.5\"/>\n");
    }
}

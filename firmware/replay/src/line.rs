//! How an outcome is written down: hexadecimal words, so that no digit is lost and nothing formats a float.

use atm_core::{Arrival, ConsensusEcho, Echo, Rejected};

use crate::outcome::Outcome;

/// A line of text in an array.
#[derive(Debug, Clone, Copy)]
pub struct Line {
    bytes: [u8; Self::LENGTH],
    length: usize,
}

impl Line {
    /// Longer than any line that is written.
    const LENGTH: usize = 144;

    /// A line that begins with `word`.
    pub fn new(word: &str) -> Self {
        let mut line = Self { bytes: [0; Self::LENGTH], length: 0 };
        word.bytes().for_each(|byte| line.push(byte));
        line
    }

    /// What became of reading number `index` of `run`, a letter.
    pub fn of<E: Written>(run: &str, index: u32, outcome: &Outcome<E>) -> Self {
        let mut line = Self::new(run);
        line.word(index);
        match (&outcome.arrival, &outcome.echo, outcome.ignored) {
            (Err(rejected), ..) => line.text(reason(*rejected)),
            (Ok(_), Some(echo), _) => echo.write(&mut line),
            (Ok(_), None, Some(crossings)) => {
                line.text("ignored");
                line.word(crossings);
            }
            (Ok(Arrival::Entered), None, None) => line.text("silent"),
            (Ok(_), None, None) => line.text("skipped"),
        }
        line
    }

    /// Adds a word of text.
    pub fn text(&mut self, text: &str) {
        self.push(b' ');
        text.bytes().for_each(|byte| self.push(byte));
    }

    /// Adds a number as eight hexadecimal digits.
    pub fn word(&mut self, value: u32) {
        self.push(b' ');
        for place in (0..8).rev() {
            let digit = (value >> (4 * place) & 15) as u8;
            self.push(if digit < 10 { b'0' + digit } else { b'a' - 10 + digit });
        }
    }

    /// The line, with its end.
    pub fn finished(&mut self) -> &[u8] {
        self.push(b'\n');
        self.bytes.get(..self.length).unwrap_or_default()
    }

    fn floats<const N: usize>(&mut self, floats: [f32; N]) {
        for float in floats {
            self.word(float.to_bits());
        }
    }

    fn push(&mut self, byte: u8) {
        if let Some(place) = self.bytes.get_mut(self.length) {
            *place = byte;
            self.length += 1;
        }
    }
}

/// An echo whose every bit can be written down.
pub trait Written {
    /// Adds it to a line.
    fn write(&self, line: &mut Line);
}

impl Written for Echo<f32> {
    fn write(&self, line: &mut Line) {
        line.text(self.kind.name());
        line.floats([self.position.x, self.position.y, self.bearing.sin(), self.bearing.cos()]);
        line.floats([self.resolution, self.arc_length]);
        line.word(self.crossings);
        line.word(self.within);
    }
}

impl Written for ConsensusEcho<f32> {
    fn write(&self, line: &mut Line) {
        line.text(self.kind.name());
        line.floats([self.position.x, self.position.y, self.bearing.sin(), self.bearing.cos()]);
        line.floats([self.confidence, self.sigma_azimuth, self.sigma_range]);
        if let Some(normal) = self.normal {
            line.floats([normal.x, normal.y]);
        }
        line.word(self.support);
        line.word(self.against);
    }
}

const fn reason(rejected: Rejected) -> &'static str {
    match rejected {
        Rejected::UnknownSensor => "unknown-sensor",
        Rejected::Pose => "pose",
        Rejected::TimeBackwards => "time-backwards",
        _ => "rejected",
    }
}

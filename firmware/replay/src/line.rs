//! How an outcome is written down: hexadecimal words, so that no digit is lost and nothing formats a float.

use atm_core::{Arrival, Echo, Rejected};

use crate::outcome::Outcome;

/// A line of text in an array.
#[derive(Debug, Clone, Copy)]
pub struct Line {
    bytes: [u8; Self::LENGTH],
    length: usize,
}

impl Line {
    /// Longer than any line that is written.
    const LENGTH: usize = 128;

    /// A line that begins with `word`.
    pub fn new(word: &str) -> Self {
        let mut line = Self { bytes: [0; Self::LENGTH], length: 0 };
        word.bytes().for_each(|byte| line.push(byte));
        line
    }

    /// What became of reading number `index` of `run`, a letter.
    pub fn of(run: &str, index: u32, outcome: &Outcome<f32>) -> Self {
        let mut line = Self::new(run);
        line.word(index);
        match (&outcome.arrival, &outcome.echo, outcome.ignored) {
            (Err(rejected), ..) => line.text(reason(*rejected)),
            (Ok(_), Some(echo), _) => line.echo(echo),
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

    fn echo(&mut self, echo: &Echo<f32>) {
        self.text(echo.kind.name());
        let bearing = [echo.bearing.sin(), echo.bearing.cos()];
        for float in echo.position.coords.iter().chain(&bearing).chain(&[echo.resolution, echo.arc_length]) {
            self.word(float.to_bits());
        }
        self.word(echo.crossings);
        self.word(echo.within);
    }

    fn push(&mut self, byte: u8) {
        if let Some(place) = self.bytes.get_mut(self.length) {
            *place = byte;
            self.length += 1;
        }
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

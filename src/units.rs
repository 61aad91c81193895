//! Quantities as people write them (`30deg`, `1in`, `0.5 s`) turned into SI.
//!
//! A quantity is a decimal number and a unit, blanks between them allowed; units are case-sensitive. Every result is
//! finite. Whether it has to be positive is the caller's concern.
use std::f64::consts::PI;

use thiserror::Error;

use crate::stamp;

/// Metres in an inch (exact by definition, 1959).
const INCH: Scale = Scale::ratio(127.0, 5000.0);
/// Metres in a foot (exact by definition, 1959).
const FOOT: Scale = Scale::ratio(381.0, 1250.0);
/// Radians in a degree: the same bits as `np.deg2rad(1)`, so that rigs written in either way are equal.
const DEGREE: f64 = PI / 180.0;
/// Seconds in a minute.
const MINUTE: u64 = 60;
/// Characters of the user's text that a message repeats.
const SHOWN: usize = 40;

/// Metres in `n` inches; for a whole `n` the double nearest to the decimal, so that it prints as few digits.
pub const fn inches(n: f64) -> f64 {
    n * 254.0 / 10_000.0
}

/// Why a text is no quantity of the kind asked for.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum UnitError {
    /// It does not begin with a decimal number.
    #[error("`{text}` is not {quantity}: expected a number and a unit, like `{example}`")]
    NotANumber {
        /// The text, shortened.
        text: String,
        /// What was expected, with its article.
        quantity: &'static str,
        /// A text that would do.
        example: &'static str,
    },
    /// The number is followed by something that is no unit of this quantity.
    #[error("`{text}`: no unit `{unit}` for {quantity}; expected one of {units}")]
    UnknownUnit {
        /// The text, shortened.
        text: String,
        /// What stands where the unit should be, shortened.
        unit: String,
        /// What was expected, with its article.
        quantity: &'static str,
        /// The units there are.
        units: &'static str,
    },
    /// A bare number where the unit can't be guessed.
    #[error("`{text}` has no unit: {quantity} needs one of {units}, like `{example}`")]
    NoUnit {
        /// The text, shortened.
        text: String,
        /// What was expected, with its article.
        quantity: &'static str,
        /// The units there are.
        units: &'static str,
        /// A text that would do.
        example: &'static str,
    },
    /// A number too large to be held, or a unit of size zero.
    #[error("`{text}` is out of range for {quantity}")]
    OutOfRange {
        /// The text, shortened.
        text: String,
        /// What was expected, with its article.
        quantity: &'static str,
    },
}

/// Reads a length (m, cm, mm, in, ft; a bare number is metres) and returns it in metres.
pub fn length(text: &str) -> Result<f64, UnitError> {
    LENGTH.read(text)
}

/// Reads an angle (deg, rad) and returns it in radians; a bare number is refused.
pub fn angle(text: &str) -> Result<f64, UnitError> {
    ANGLE.read(text)
}

/// Reads a speed (m/s, cm/s, mm/s, in/s, ft/s; a bare number is m/s) and returns it in metres per second.
pub fn speed(text: &str) -> Result<f64, UnitError> {
    SPEED.read(text)
}

/// Reads a rate (Hz, kHz; a bare number is Hz) and returns it in hertz.
pub fn rate(text: &str) -> Result<f64, UnitError> {
    RATE.read(text)
}

/// Reads a duration (s, ms, us, ns, min; a bare number is seconds) and returns it in nanoseconds, rounded half-even.
///
/// No float takes part, so `0.1s` is 100,000,000 ns. Minutes may have up to 17 significant digits.
pub fn duration(text: &str) -> Result<i64, UnitError> {
    let (number, unit) = DURATION.split(text)?;
    let nanoseconds = match (unit, stamp::decimal_shift(unit)) {
        ("", _) => stamp::parse(number.as_bytes(), stamp::SECOND_SHIFT),
        ("min", _) => stamp::parse_times(number.as_bytes(), stamp::SECOND_SHIFT, MINUTE),
        (_, Some(shift)) => stamp::parse(number.as_bytes(), shift),
        _ => return Err(DURATION.unknown_unit(text, unit)),
    };
    nanoseconds.ok_or_else(|| DURATION.out_of_range(text))
}

/// The step in which a table writes a quantity: the factor from its raw numbers to SI.
///
/// Held in parts, so that 2320 mm is 2320/1000 = 2.32 m, the nearest number there is, and not 2320 × 0.001.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    mul: f64,
    div: f64,
    /// The part that is no ratio of whole numbers: radians in a degree; else 1.
    unit: f64,
}

impl Scale {
    /// Raw numbers that are SI already.
    pub const SI: Self = Self::ratio(1.0, 1.0);

    /// A step of length: an optional number, then m, cm, mm, in or ft (`mm`, `0.25 mm`, `1in`; a bare number is metres).
    ///
    /// Errors: what [`length`] refuses, and a step of zero.
    pub fn length(text: &str) -> Result<Self, UnitError> {
        LENGTH.step(text)
    }

    /// A step of angle: an optional number, then deg or rad (`rad`, `0.1deg`). Negative for clockwise angles.
    ///
    /// Errors: what [`angle`] refuses, and a step of zero.
    pub fn angle(text: &str) -> Result<Self, UnitError> {
        ANGLE.step(text)
    }

    /// The raw number in SI; not finite where the raw number is not.
    pub fn apply(self, raw: f64) -> f64 {
        raw * self.mul / self.div * self.unit
    }

    /// Whether the step counts forwards.
    pub(crate) fn is_positive(self) -> bool {
        self.mul > 0.0
    }

    const fn ratio(mul: f64, div: f64) -> Self {
        Self { mul, div, unit: 1.0 }
    }

    const fn unit(unit: f64) -> Self {
        Self { mul: 1.0, div: 1.0, unit }
    }

    /// This step, `number` times as long.
    fn times(self, number: &str) -> Option<Self> {
        let (mul, div) = fraction(number)?;
        Some(Self { mul: self.mul * mul, div: self.div * div, unit: self.unit })
    }
}

impl Default for Scale {
    fn default() -> Self {
        Self::SI
    }
}

/// One kind of quantity: its units, and how messages speak of it.
struct Quantity {
    /// With its article.
    name: &'static str,
    units: &'static [(&'static str, Scale)],
    /// The units as a message lists them.
    listed: &'static str,
    example: &'static str,
    /// Whether a number without a unit is taken as SI.
    bare: bool,
}

const LENGTH: Quantity = Quantity {
    name: "a length",
    units: &[
        ("m", Scale::SI),
        ("cm", Scale::ratio(1.0, 100.0)),
        ("mm", Scale::ratio(1.0, 1000.0)),
        ("in", INCH),
        ("ft", FOOT),
    ],
    listed: "m, cm, mm, in, ft",
    example: "0.25m",
    bare: true,
};
const ANGLE: Quantity = Quantity {
    name: "an angle",
    units: &[("deg", Scale::unit(DEGREE)), ("rad", Scale::SI)],
    listed: "deg, rad",
    example: "30deg",
    bare: false,
};
const SPEED: Quantity = Quantity {
    name: "a speed",
    units: &[
        ("m/s", Scale::SI),
        ("cm/s", Scale::ratio(1.0, 100.0)),
        ("mm/s", Scale::ratio(1.0, 1000.0)),
        ("in/s", INCH),
        ("ft/s", FOOT),
    ],
    listed: "m/s, cm/s, mm/s, in/s, ft/s",
    example: "0.5m/s",
    bare: true,
};
const RATE: Quantity = Quantity {
    name: "a rate",
    units: &[("Hz", Scale::SI), ("kHz", Scale::ratio(1000.0, 1.0))],
    listed: "Hz, kHz",
    example: "10Hz",
    bare: true,
};
/// Its units live in [`duration`], which never leaves whole numbers.
const DURATION: Quantity =
    Quantity { name: "a duration", units: &[], listed: "s, ms, us, ns, min", example: "0.5s", bare: true };

impl Quantity {
    /// Reads a number and its unit, in SI.
    fn read(&self, text: &str) -> Result<f64, UnitError> {
        let value = self.scale(text, self.split(text)?)?.apply(1.0);
        if !value.is_finite() {
            return Err(self.out_of_range(text));
        }
        Ok(value)
    }

    /// Reads an optional number and a unit as a step to count in.
    fn step(&self, text: &str) -> Result<Scale, UnitError> {
        let unit = text.trim();
        if let Some(&(_, scale)) = self.units.iter().find(|(name, _)| *name == unit) {
            return Ok(scale);
        }
        let scale = self.scale(text, self.split(text)?)?;
        let size = scale.apply(1.0);
        if !size.is_finite() || size == 0.0 {
            return Err(self.out_of_range(text));
        }
        Ok(scale)
    }

    fn scale(&self, text: &str, (number, unit): (&str, &str)) -> Result<Scale, UnitError> {
        let known = self.units.iter().find(|(name, _)| *name == unit);
        let scale = match known {
            Some(&(_, scale)) => scale,
            None if !unit.is_empty() => return Err(self.unknown_unit(text, unit)),
            None if self.bare => Scale::SI,
            None => {
                return Err(UnitError::NoUnit {
                    text: shorten(text),
                    quantity: self.name,
                    units: self.listed,
                    example: self.example,
                });
            }
        };
        scale.times(number).ok_or_else(|| self.out_of_range(text))
    }

    /// Number and unit of a text, without the blanks around them.
    fn split<'a>(&self, text: &'a str) -> Result<(&'a str, &'a str), UnitError> {
        let trimmed = text.trim();
        let (number, unit) = trimmed.split_at_checked(number_end(trimmed)).unwrap_or(("", trimmed));
        if number.is_empty() {
            return Err(UnitError::NotANumber { text: shorten(text), quantity: self.name, example: self.example });
        }
        Ok((number, unit.trim_start()))
    }

    fn unknown_unit(&self, text: &str, unit: &str) -> UnitError {
        UnitError::UnknownUnit { text: shorten(text), unit: shorten(unit), quantity: self.name, units: self.listed }
    }

    fn out_of_range(&self, text: &str) -> UnitError {
        UnitError::OutOfRange { text: shorten(text), quantity: self.name }
    }
}

/// Where the decimal number at the start of a text ends: 0 where there is none.
///
/// The grammar is that of [`stamp::parse`]: a sign, digits with a point before, between or after them, an exponent.
fn number_end(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |from: usize| {
        let rest = bytes.get(from..).unwrap_or_default();
        from + rest.iter().take_while(|byte| byte.is_ascii_digit()).count()
    };
    let signed = |at: usize| at + usize::from(matches!(bytes.get(at), Some(b'+' | b'-')));
    let start = signed(0);
    let mut end = digits(start);
    if bytes.get(end) == Some(&b'.') && digits(end + 1) > start + 1 {
        end = digits(end + 1);
    }
    if end == start {
        return 0;
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let start = signed(end + 1);
        if digits(start) > start {
            end = digits(start);
        }
    }
    end
}

/// A decimal number as numerator and denominator, both exact where it has no exponent and up to 15 digits; `None` beyond f64.
fn fraction(number: &str) -> Option<(f64, f64)> {
    const EXACT: usize = 15;
    let (whole, decimals) = number.split_once('.').unwrap_or((number, ""));
    if whole.len() + decimals.len() > EXACT || number.contains(['e', 'E']) {
        let value: f64 = number.parse().ok()?;
        return value.is_finite().then_some((value, 1.0));
    }
    let mul = format!("{whole}{decimals}").parse().ok()?;
    let div = decimals.bytes().fold(1.0, |div, _| div * 10.0);
    Some((mul, div))
}

/// A text as a message repeats it: without control characters, and not endless.
pub fn shorten(text: &str) -> String {
    let mut shown: String = text.chars().take(SHOWN).flat_map(escape).collect();
    if text.chars().nth(SHOWN).is_some() {
        shown.push('…');
    }
    shown
}

/// Control characters by their escapes (they would garble a terminal), others as they are.
fn escape(character: char) -> impl Iterator<Item = char> {
    let escaped = character.is_control().then(|| character.escape_default());
    let plain = escaped.is_none().then_some(character);
    escaped.into_iter().flatten().chain(plain)
}

#[cfg(test)]
mod tests;

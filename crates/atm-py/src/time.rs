//! Seconds as Python has them, and whole nanoseconds as the library has them.

use atm::stamp;
use pyo3::PyResult;

use crate::argument::choice;

/// Decimal shift from seconds to nanoseconds.
const DECIMAL_SHIFT: i32 = 9;
/// Nanoseconds in a second.
const SECOND: i64 = 1_000_000_000;
/// Up to here every whole number is an `f64`.
const EXACT: u64 = 1 << 53;
/// Bits of an `f64`'s fraction, and the bias of its exponent with them: the value is fraction · 2^(exponent − BIAS).
const FRACTION_BITS: u32 = 52;
const BIAS: i64 = 1075;

/// How the user writes times, and so how they are returned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clock {
    /// Seconds as `float64`.
    Seconds,
    /// Nanoseconds as `int64`.
    Nanoseconds,
}

impl Clock {
    /// What it is in words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Seconds => "float seconds",
            Self::Nanoseconds => "int nanoseconds",
        }
    }

    /// The eight bytes of a time in nanoseconds, as an array of this clock holds them.
    pub fn bytes(self, ns: i64) -> [u8; 8] {
        match self {
            Self::Seconds => seconds(ns).to_ne_bytes(),
            Self::Nanoseconds => ns.to_ne_bytes(),
        }
    }
}

/// The unit of whole numbers in nanoseconds, by its name.
pub fn time_unit(name: Option<&str>) -> PyResult<Option<i64>> {
    let units = [("s", SECOND), ("ms", 1_000_000), ("us", 1_000), ("ns", 1)];
    name.map(|name| choice("t_unit", name, &units)).transpose()
}

/// Seconds as whole nanoseconds, rounded half-even; `None` for NaN and beyond an `i64`.
///
/// A float stands for its shortest decimal, as tables have it: 1700000000.1 s is what the command reads there, and not the
/// 24 ns less that the float is.
pub fn nanoseconds(seconds: f64) -> Option<i64> {
    if let Some(nanoseconds) = far_from_ties(seconds) {
        return Some(nanoseconds);
    }
    if !seconds.is_finite() {
        return None;
    }
    stamp::parse(zmij::Buffer::new().format_finite(seconds).as_bytes(), DECIMAL_SHIFT)
}

/// The float's own value in nanoseconds, where every number that reads as this float rounds to the same.
#[inline]
fn far_from_ties(seconds: f64) -> Option<i64> {
    let bits = seconds.to_bits();
    let exponent = ((bits >> FRACTION_BITS) & 0x7ff) as i64;
    // Up to 2^30 s; what is larger, next to nothing, or no number, is left to the decimal.
    let places = u32::try_from(BIAS - exponent).ok().filter(|places| (23..=100).contains(places))?;
    let mantissa = (bits & ((1 << FRACTION_BITS) - 1)) | (1 << FRACTION_BITS);
    let product = u128::from(mantissa) * SECOND as u128; // below 2^83
    let quotient = product >> places;
    let (rest, half) = (product - (quotient << places), 1u128 << (places - 1));
    // Numbers that read as this float are within half a unit of its last place: half of a second's worth here.
    if rest.abs_diff(half) <= SECOND as u128 / 2 {
        return None;
    }
    let magnitude = i64::try_from(quotient + u128::from(rest > half)).ok()?;
    Some(if seconds < 0.0 { -magnitude } else { magnitude })
}

/// The `f64` nearest to a time in seconds.
pub fn seconds(ns: i64) -> f64 {
    if ns.unsigned_abs() <= EXACT {
        return ns as f64 / SECOND as f64;
    }
    // Both parts are exact but for the quotient's last place, and no sum of whole nanoseconds is that near to the middle
    // between two neighbours: the nearest is 2^9 / (10^9 · 2^30) off.
    (ns / SECOND) as f64 + (ns % SECOND) as f64 / SECOND as f64
}

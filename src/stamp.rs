//! Time as whole nanoseconds: read from decimal text and written back without ever being a float.
//!
//! A float would do for neither end: 1700000000.123456789 s needs 61 bits.

/// Powers of ten that fit 64 bits.
const TENS: [u64; 20] = {
    let mut tens = [1; 20];
    let mut i = 1;
    while i < 20 {
        tens[i] = tens[i - 1] * 10;
        i += 1;
    }
    tens
};
/// Significant digits that are kept: any 19 digits fit 64 bits, and an `i64` has no more than 19.
const KEPT: u32 = 19;
/// Nanoseconds in a second.
const SECOND: u64 = 1_000_000_000;
/// The decimal shift from seconds to nanoseconds.
pub const SECOND_SHIFT: i32 = 9;

/// Decimal shift from a unit of time to nanoseconds: 9 for `s`, 6 for `ms`, 3 for `us`, 0 for `ns`, else `None`.
pub fn decimal_shift(unit: &str) -> Option<i32> {
    match unit {
        "s" => Some(SECOND_SHIFT),
        "ms" => Some(6),
        "us" => Some(3),
        "ns" => Some(0),
        _ => None,
    }
}

/// Reads a decimal number and returns it times 10^`decimal_shift`, in nanoseconds, rounded half-even.
///
/// The number is an optional sign, digits, and optionally a point with digits and an exponent (`12`, `-0.5`, `+1.7e9`);
/// ASCII blanks around it are ignored, and digits are needed on one side of the point only (`.5`, `5.`). `None` for anything
/// else (`nan`, `inf`, nothing at all) and for what does not fit an `i64`. Takes time linear in the text, whatever the exponent.
pub fn parse(bytes: &[u8], decimal_shift: i32) -> Option<i64> {
    Decimal::read_short(bytes).or_else(|| Decimal::read(bytes))?.nanoseconds(decimal_shift)
}

/// [`parse`], times a whole factor before rounding; `None` also where the number's digits times the factor exceed 64 bits.
pub(crate) fn parse_times(bytes: &[u8], decimal_shift: i32, factor: u64) -> Option<i64> {
    let mut decimal = Decimal::read(bytes)?;
    if decimal.tail != Tail::Zero {
        return None;
    }
    decimal.mantissa = decimal.mantissa.checked_mul(factor)?;
    decimal.nanoseconds(decimal_shift)
}

/// Appends a time as the shortest decimal number of seconds: `12.345`, `5`, `-0.5`.
pub fn write(ns: i64, out: &mut Vec<u8>) {
    // Sign, 10 digits of seconds, point, 9 digits: filled from the back.
    let mut text = [0; 21];
    let mut start = text.len();
    let mut put = |digit| {
        start -= 1;
        text[start] = digit;
    };
    let magnitude = ns.unsigned_abs();
    let (mut seconds, mut fraction) = (magnitude / SECOND, magnitude % SECOND);
    if fraction != 0 {
        let mut places = SECOND_SHIFT;
        while fraction.is_multiple_of(10) {
            fraction /= 10;
            places -= 1;
        }
        for _ in 0..places {
            put(digit(fraction));
            fraction /= 10;
        }
        put(b'.');
    }
    loop {
        put(digit(seconds));
        seconds /= 10;
        if seconds == 0 {
            break;
        }
    }
    if ns < 0 {
        put(b'-');
    }
    out.extend_from_slice(&text[start..]);
}

/// Appends a time as [`write()`] does, and always with a point: `12.345`, `5.0`. Whoever guesses the kind of a column from its
/// first rows takes it for decimal seconds, not for whole numbers of anything.
pub fn write_decimal(ns: i64, out: &mut Vec<u8>) {
    write(ns, out);
    if ns.unsigned_abs().is_multiple_of(SECOND) {
        out.extend_from_slice(b".0");
    }
}

/// The last decimal digit, as ASCII.
fn digit(value: u64) -> u8 {
    b'0' + (value % 10) as u8
}

/// What the digits beyond the kept ones amount to, in units of the last kept digit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Tail {
    Zero,
    BelowHalf,
    Half,
    AboveHalf,
}

impl Tail {
    /// The tail with one more digit at its end; `first` says that there was none before.
    fn with(self, digit: u8, first: bool) -> Self {
        match (self, digit) {
            (_, 0) if first => Self::Zero,
            (_, 1..=4) if first => Self::BelowHalf,
            (_, 5) if first => Self::Half,
            _ if first => Self::AboveHalf,
            (tail, 0) => tail,
            (Self::Zero, _) => Self::BelowHalf,
            (Self::Half, _) => Self::AboveHalf,
            (tail, _) => tail,
        }
    }
}

/// A decimal number: ±(mantissa + tail) × 10^exponent.
struct Decimal {
    negative: bool,
    mantissa: u64,
    /// Significant digits in the mantissa, at most [`KEPT`].
    kept: u32,
    tail: Tail,
    exponent: i64,
}

impl Decimal {
    /// The ordinary case in one pass: up to [`KEPT`] digits with at most one point between them, and nothing else.
    ///
    /// `None` leaves the text to [`Decimal::read`], which takes two to three times as long.
    #[inline]
    fn read_short(bytes: &[u8]) -> Option<Self> {
        let most = KEPT as usize + 1;
        if bytes.len() > most {
            return None;
        }
        let (mut mantissa, mut point) = (0u64, None);
        for (at, byte) in bytes.iter().enumerate() {
            match byte {
                // Wraps only where there is a digit too many, which is found out below.
                b'0'..=b'9' => mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(byte - b'0')),
                b'.' if point.is_none() => point = Some(at),
                _ => return None,
            }
        }
        let decimals = match point {
            None if bytes.is_empty() || bytes.len() == most => return None,
            None => 0,
            Some(_) if bytes.len() == 1 => return None,
            Some(at) => bytes.len() - at - 1,
        };
        Some(Self { negative: false, mantissa, kept: 0, tail: Tail::Zero, exponent: -(decimals as i64) })
    }

    /// Reads the whole text, blanks around it aside.
    fn read(bytes: &[u8]) -> Option<Self> {
        let mut rest = bytes.trim_ascii();
        let mut decimal = Self { negative: false, mantissa: 0, kept: 0, tail: Tail::Zero, exponent: 0 };
        if let [sign @ (b'+' | b'-'), after @ ..] = rest {
            decimal.negative = *sign == b'-';
            rest = after;
        }
        let mut beyond = 0;
        let number = rest;
        rest = decimal.read_digits(rest, &mut beyond);
        let mut digits = number.len() - rest.len();
        // Each digit that was not kept still counts in the size of the number.
        let whole_beyond = beyond;
        if let [b'.', after @ ..] = rest {
            rest = decimal.read_digits(after, &mut beyond);
            digits += after.len() - rest.len();
            decimal.exponent = (beyond - whole_beyond) - (after.len() - rest.len()) as i64;
        }
        decimal.exponent += whole_beyond;
        match rest {
            _ if digits == 0 => return None,
            [] => {}
            [b'e' | b'E', after @ ..] => decimal.exponent += read_exponent(after)?,
            _ => return None,
        }
        Some(decimal)
    }

    /// Takes a run of digits and returns what follows; counts in `beyond` the digits that were not kept.
    fn read_digits<'a>(&mut self, text: &'a [u8], beyond: &mut i64) -> &'a [u8] {
        let mut rest = text;
        while let [byte @ b'0'..=b'9', after @ ..] = rest {
            let digit = byte - b'0';
            if self.kept < KEPT {
                self.mantissa = self.mantissa * 10 + u64::from(digit);
                self.kept += u32::from(self.mantissa != 0);
            } else {
                self.tail = self.tail.with(digit, *beyond == 0);
                *beyond += 1;
            }
            rest = after;
        }
        rest
    }

    /// The number times 10^`shift`, rounded half-even to a whole number.
    fn nanoseconds(&self, shift: i32) -> Option<i64> {
        let exponent = self.exponent + i64::from(shift);
        let magnitude = if self.mantissa == 0 {
            0
        } else if exponent > 0 {
            // A tail means 19 kept digits: ten times that never fits, and the product below finds it out.
            let factor = TENS.get(usize::try_from(exponent).ok()?)?;
            self.mantissa.checked_mul(*factor)?
        } else {
            round_half_even(self.mantissa, self.tail, exponent.unsigned_abs())
        };
        if self.negative { 0i64.checked_sub_unsigned(magnitude) } else { i64::try_from(magnitude).ok() }
    }
}

/// (mantissa + tail) / 10^places, rounded half-even.
fn round_half_even(mantissa: u64, tail: Tail, places: u64) -> u64 {
    let Some(&divisor) = usize::try_from(places).ok().and_then(|places| TENS.get(places)) else {
        return 0; // less than 2^64 / 10^20, which is below one half
    };
    let (quotient, remainder) = (mantissa / divisor, mantissa % divisor);
    let fraction = if divisor == 1 {
        tail
    } else {
        // Compared with the complement, as twice the remainder may not fit.
        match (remainder.cmp(&(divisor - remainder)), tail) {
            _ if remainder == 0 && tail == Tail::Zero => Tail::Zero,
            (std::cmp::Ordering::Less, _) => Tail::BelowHalf,
            (std::cmp::Ordering::Equal, Tail::Zero) => Tail::Half,
            _ => Tail::AboveHalf,
        }
    };
    let up = match fraction {
        Tail::Zero | Tail::BelowHalf => false,
        Tail::Half => quotient % 2 == 1,
        Tail::AboveHalf => true,
    };
    quotient + u64::from(up)
}

/// Reads an exponent to the end of the text; beyond ±10^15 it saturates, which no number of digits can make up for.
fn read_exponent(text: &[u8]) -> Option<i64> {
    const LIMIT: i64 = 1_000_000_000_000_000;
    let (negative, digits) = match text {
        [sign @ (b'+' | b'-'), after @ ..] => (*sign == b'-', after),
        _ => (false, text),
    };
    if digits.is_empty() {
        return None;
    }
    let mut exponent = 0;
    for byte in digits {
        if !byte.is_ascii_digit() {
            return None;
        }
        exponent = (exponent * 10 + i64::from(byte - b'0')).min(LIMIT);
    }
    Some(if negative { -exponent } else { exponent })
}

/// The shortest decimal seconds of a time, as [`write()`] writes them.
pub fn text(ns: i64) -> String {
    let mut bytes = Vec::new();
    write(ns, &mut bytes);
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests;

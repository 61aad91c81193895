//! Numbers in words.

/// A count with what it counts, in the plural where it is not one.
pub(crate) fn count(number: u64, what: &str) -> String {
    let ending = match number {
        1 => "",
        _ if what.ends_with('o') => "es",
        _ => "s",
    };
    format!("{number} {what}{ending}")
}

/// A share in per cent, without decimals where it is large.
pub(crate) fn percent(part: u64, whole: u64) -> String {
    let share = 100.0 * part as f64 / whole.max(1) as f64;
    if share >= 10.0 || share == 0.0 { format!("{share:.0} %") } else { format!("{share:.1} %") }
}

/// A length in metres with three digits that count.
pub(crate) fn length(metres: f64) -> String {
    format!("{} m", digits(metres))
}

/// A number with three digits that count.
pub(crate) fn digits(number: f64) -> String {
    let magnitude = number.abs();
    let decimals: i64 = match magnitude {
        _ if magnitude == 0.0 || magnitude >= 100.0 => 0,
        _ if magnitude >= 10.0 => 1,
        _ if magnitude >= 1.0 => 2,
        _ if magnitude >= 1e-6 => 2 - libm::floor(libm::log10(magnitude)) as i64,
        _ => return format!("{number:.1e}"),
    };
    format!("{number:.*}", usize::try_from(decimals).unwrap_or(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_is_singular_and_three_digits_count() {
        assert_eq!([count(1, "echo"), count(0, "reading"), count(2, "echo")], ["1 echo", "0 readings", "2 echoes"]);
        let shown = [0.0, 0.0412, 1.3155, 12.345, 1234.5].map(length);
        assert_eq!(shown, ["0 m", "0.0412 m", "1.32 m", "12.3 m", "1234 m"]);
        assert_eq!((percent(3, 1000), percent(1, 3)), ("0.3 %".into(), "33 %".into()));
    }
}

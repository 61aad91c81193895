use proptest::prelude::*;

use super::*;

fn seconds(text: &str) -> Option<i64> {
    parse(text.as_bytes(), 9)
}

fn written(ns: i64) -> String {
    let mut out = Vec::new();
    write(ns, &mut out);
    String::from_utf8(out).unwrap()
}

#[test]
fn seconds_are_read_to_the_nanosecond() {
    assert_eq!(seconds("12.345"), Some(12_345_000_000));
    assert_eq!(seconds("1700000000.123456789"), Some(1_700_000_000_123_456_789));
    assert_eq!(seconds("-0.5"), Some(-500_000_000));
    assert_eq!(seconds("+7"), Some(7_000_000_000));
    assert_eq!(seconds("-0"), Some(0));
    assert_eq!(seconds("007.10"), Some(7_100_000_000));
}

#[test]
fn exponents_of_either_sign_and_case_are_read() {
    assert_eq!(seconds("1e3"), Some(1_000_000_000_000));
    assert_eq!(seconds("1.5E+2"), Some(150_000_000_000));
    assert_eq!(seconds("25e-9"), Some(25));
    assert_eq!(seconds("1e0000000000000000000000000002"), Some(100_000_000_000));
}

#[test]
fn units_shift_the_decimal_point() {
    assert_eq!(parse(b"1686487", decimal_shift("ms").unwrap()), Some(1_686_487_000_000));
    assert_eq!(parse(b"2.5", decimal_shift("us").unwrap()), Some(2_500));
    assert_eq!(parse(b"9223372036854775807", decimal_shift("ns").unwrap()), Some(i64::MAX));
    assert_eq!(decimal_shift("s"), Some(9));
    assert_eq!(decimal_shift("min"), None);
    assert_eq!(decimal_shift("MS"), None);
}

#[test]
fn ties_go_to_the_even_nanosecond() {
    assert_eq!(parse(b"0.5", 0), Some(0));
    assert_eq!(parse(b"1.5", 0), Some(2));
    assert_eq!(parse(b"2.5", 0), Some(2));
    assert_eq!(parse(b"-1.5", 0), Some(-2));
    assert_eq!(parse(b"-2.5", 0), Some(-2));
    assert_eq!(seconds("0.0000000025"), Some(2));
    assert_eq!(seconds("0.0000000035"), Some(4));
}

#[test]
fn a_digit_far_beyond_a_tie_breaks_it() {
    let zeros = "0".repeat(500);
    assert_eq!(parse(format!("2.5{zeros}1").as_bytes(), 0), Some(3));
    assert_eq!(parse(format!("2.5{zeros}").as_bytes(), 0), Some(2));
    assert_eq!(parse(format!("2.4{}", "9".repeat(500)).as_bytes(), 0), Some(2));
}

#[test]
fn digits_beyond_the_nineteenth_still_round() {
    assert_eq!(parse(b"1234567890123456788.5", 0), Some(1_234_567_890_123_456_788));
    assert_eq!(parse(b"1234567890123456789.5", 0), Some(1_234_567_890_123_456_790));
    assert_eq!(parse(b"1234567890123456788.50000001", 0), Some(1_234_567_890_123_456_789));
    assert_eq!(parse(b"1234567890123456788.49999999", 0), Some(1_234_567_890_123_456_788));
    assert_eq!(parse(b"1234567890123456788.9", 0), Some(1_234_567_890_123_456_789));
    assert_eq!(parse(b"12345678901234567885e-1", 0), Some(1_234_567_890_123_456_788));
    // A first digit of zero beyond the nineteenth is below one half, whatever follows.
    assert_eq!(parse(b"1234567890123456788.09", 0), Some(1_234_567_890_123_456_788));
}

#[test]
fn nineteen_digits_and_twenty_are_told_apart() {
    assert_eq!(parse(b"9223372036854775807", 0), Some(i64::MAX));
    assert_eq!(parse(b"09223372036854775807", 0), Some(i64::MAX));
    assert_eq!(parse(b"922337203685477580.7", 1), Some(i64::MAX));
    // 2^64 + 7, which 64 bits would take for 7.
    assert_eq!(parse(b"18446744073709551623", 0), None);
    assert_eq!(parse(b"18446744073709551623", -1), Some(1_844_674_407_370_955_162));
}

#[test]
fn both_ends_of_the_range_are_read_and_the_next_are_not() {
    assert_eq!(seconds("9223372036.854775807"), Some(i64::MAX));
    assert_eq!(seconds("9223372036.8547758074"), Some(i64::MAX));
    assert_eq!(seconds("9223372036.8547758075"), None);
    assert_eq!(seconds("-9223372036.854775808"), Some(i64::MIN));
    assert_eq!(seconds("-9223372036.8547758085"), Some(i64::MIN));
    assert_eq!(seconds("-9223372036.8547758086"), None);
    assert_eq!(seconds("9223372036.854775808"), None);
    assert_eq!(seconds("1e10"), None);
    assert_eq!(parse(b"18446744073709551616", 0), None);
    assert_eq!(parse(b"99999999999999999999", 0), None);
}

#[test]
fn what_is_no_number_is_refused() {
    let texts = [
        "", " ", "+", "-", ".", "-.", ".e5", "e5", "1e", "1e+", "1 2", "1,5", "0x10", "1_000", "--1", "+-1", "1.2.3",
        "1e2.5", "1e5e5", "nan", "inf", "-inf", "Infinity", "5s", "٣",
    ];
    for text in texts {
        assert_eq!(seconds(text), None, "{text:?}");
    }
    assert_eq!(parse(b"1\xff", 9), None);
    assert_eq!(parse(b"1\0", 9), None);
}

#[test]
fn digits_on_one_side_of_the_point_are_enough() {
    assert_eq!(seconds(".5"), Some(500_000_000));
    assert_eq!(seconds("-.5"), Some(-500_000_000));
    assert_eq!(seconds("5."), Some(5_000_000_000));
    assert_eq!(seconds("1.e1"), Some(10_000_000_000));
}

#[test]
fn blanks_around_the_number_are_ignored() {
    assert_eq!(seconds("  5\t"), Some(5_000_000_000));
    assert_eq!(seconds("\r\n5\r\n"), Some(5_000_000_000));
}

#[test]
fn absurd_exponents_are_bounded() {
    assert_eq!(seconds("1e999999999"), None);
    assert_eq!(seconds("-1e99999999999999999999999999"), None);
    assert_eq!(seconds("1e-999999999"), Some(0));
    assert_eq!(seconds("1e-99999999999999999999999999"), Some(0));
    assert_eq!(seconds("0e999999999"), Some(0));
    assert_eq!(seconds("0.000e99999999999999999999"), Some(0));
    assert_eq!(parse(b"1", i32::MAX), None);
    assert_eq!(parse(b"1", i32::MIN), Some(0));
}

#[test]
fn ten_thousand_digits_and_their_exponent_cancel() {
    let zeros = "0".repeat(10_000);
    assert_eq!(seconds(&format!("0.{zeros}12e10000")), Some(120_000_000));
    assert_eq!(seconds(&format!("12{zeros}e-10000")), Some(12_000_000_000));
    assert_eq!(seconds(&format!("{zeros}12")), Some(12_000_000_000));
    assert_eq!(seconds(&format!("1.{zeros}")), Some(1_000_000_000));
    assert_eq!(seconds(&"9".repeat(10_000)), None);
    assert_eq!(seconds(&format!("1e{zeros}1")), Some(10_000_000_000));
}

#[test]
fn a_factor_is_applied_before_rounding() {
    // 0.0000000001 min = 6 ns
    assert_eq!(parse_times(b"0.0000000001", 9, 60), Some(6));
    assert_eq!(parse_times(b"0.00000000001", 9, 60), Some(1));
    assert_eq!(parse_times(b"-1.5", 9, 60), Some(-90_000_000_000));
    assert_eq!(parse_times(b"1.00000000000000000001", 9, 60), None);
    assert_eq!(parse_times(b"9999999999999999999", 0, 60), None);
}

#[test]
fn times_are_written_without_needless_digits() {
    assert_eq!(written(12_345_000_000), "12.345");
    assert_eq!(written(5_000_000_000), "5");
    assert_eq!(written(-500_000_000), "-0.5");
    assert_eq!(written(0), "0");
    assert_eq!(written(1), "0.000000001");
    assert_eq!(written(-10), "-0.00000001");
    assert_eq!(written(100_000_000_000), "100");
    assert_eq!(written(i64::MAX), "9223372036.854775807");
    assert_eq!(written(i64::MIN), "-9223372036.854775808");
}

#[test]
fn writing_appends() {
    let mut out = b"t=".to_vec();
    write(1_500_000_000, &mut out);
    assert_eq!(out, b"t=1.5");
    assert_eq!(text(-1_500_000_000), "-1.5");
}

/// The value of `digits` × 10^`exponent`, rounded half-even with wide integers: written apart from the code under test.
fn rounded(digits: i128, exponent: i32) -> Option<i64> {
    let exact = if exponent >= 0 {
        digits.checked_mul(10i128.checked_pow(exponent.unsigned_abs())?)?
    } else {
        let divisor = 10i128.pow(exponent.unsigned_abs());
        let (floor, above) = (digits.div_euclid(divisor), digits.rem_euclid(divisor));
        floor + i128::from(2 * above > divisor || (2 * above == divisor && floor % 2 != 0))
    };
    i64::try_from(exact).ok()
}

proptest! {
    #[test]
    fn what_is_written_is_read_back(ns: i64) {
        prop_assert_eq!(seconds(&written(ns)), Some(ns));
    }

    #[test]
    fn what_is_written_is_shortest(ns: i64) {
        let text = written(ns);
        prop_assert!(!text.contains('.') || !text.ends_with(['0', '.']));
        prop_assert!(!text.trim_start_matches('-').starts_with("00"));
    }

    #[test]
    fn decimals_agree_with_wide_integers(
        digits in -10i128.pow(26)..10i128.pow(26),
        point in 0usize..26,
        exponent in -30i32..12,
    ) {
        let magnitude = format!("{:027}", digits.unsigned_abs());
        let (whole, fraction) = magnitude.split_at(magnitude.len() - point);
        let sign = if digits < 0 { "-" } else { "" };
        let dot = if point > 0 { "." } else { "" };
        let text = format!("{sign}{whole}{dot}{fraction}e{exponent}");
        // Kept above 10^-37, so that the reference's divisor fits.
        let power = exponent - point as i32 + 9;
        prop_assume!(power >= -37);
        prop_assert_eq!(seconds(&text), rounded(digits, power), "{}", text);
    }

    #[test]
    fn near_ties_agree_with_wide_integers(whole in 0i128..i128::from(i64::MAX), tail in 0i128..1000, sign in prop_oneof![Just(1i128), Just(-1)]) {
        let digits = whole * 1000 + tail;
        let text = format!("{}{whole}.{tail:03}", if sign < 0 { "-" } else { "" });
        prop_assert_eq!(parse(text.as_bytes(), 0), rounded(sign * digits, -3), "{}", text);
    }

    #[test]
    fn short_decimals_agree_with_wide_integers(digits in 0u128..10u128.pow(21), point in 0usize..12, shift in -12i32..10) {
        let magnitude = digits.to_string();
        prop_assume!(point < magnitude.len());
        let (whole, fraction) = magnitude.split_at(magnitude.len() - point);
        let text = if point > 0 { format!("{whole}.{fraction}") } else { whole.to_owned() };
        prop_assert_eq!(parse(text.as_bytes(), shift), rounded(digits as i128, shift - point as i32), "{}", text);
    }

    #[test]
    fn no_bytes_make_it_panic(bytes: Vec<u8>, shift: i32) {
        let _ = parse(&bytes, shift);
    }

    #[test]
    fn no_number_like_text_makes_it_panic(text in "[-+]?[0-9]{0,25}\\.?[0-9]{0,25}([eE][-+]?[0-9]{0,22})?", shift in -40i32..40) {
        let _ = parse(text.as_bytes(), shift);
    }
}

use proptest::prelude::*;

use super::*;

#[test]
fn numbers_are_read_in_every_spelling() {
    for (cell, value) in [("1.5", 1.5), ("-0.25", -0.25), ("+2", 2.0), ("1e3", 1000.0), ("5.", 5.0), (".5", 0.5)] {
        assert_eq!(number(cell.as_bytes()), Some(value), "{cell}");
    }
}

#[test]
fn non_finite_values_are_numbers_where_they_are_spelled() {
    for cell in ["nan", "NaN", "-nan", "+NAN"] {
        assert_eq!(number(cell.as_bytes()).unwrap().to_bits(), f64::NAN.to_bits(), "{cell}");
    }
    for cell in ["inf", "+Inf", "INFINITY", "+infinity"] {
        assert_eq!(number(cell.as_bytes()), Some(f64::INFINITY), "{cell}");
    }
    for cell in ["-inf", "-INF", "-Infinity"] {
        assert_eq!(number(cell.as_bytes()), Some(f64::NEG_INFINITY), "{cell}");
    }
}

#[test]
fn what_is_no_number_or_overflows_is_refused() {
    for cell in
        ["", "-", "abc", "1,5", "1.5m", "0x10", "1 2", "--1", "nano", "inf1", "infinit", "1e999", "-1e999", "1_0"]
    {
        assert_eq!(number(cell.as_bytes()), None, "{cell}");
    }
    assert_eq!(number(&[b'9'; 400]), None);
}

#[test]
fn a_number_that_overflows_by_its_unit_is_refused() {
    let feet = Scale::length("1000ft").unwrap();
    assert_eq!(scaled(1e307, feet), None);
    assert_eq!(scaled(f64::INFINITY, feet), Some(f64::INFINITY));
    assert!(scaled(f64::NAN, feet).unwrap().is_nan());
}

#[test]
fn a_shown_cell_is_cut_and_escaped() {
    assert_eq!(shorten(b"1.5x"), "\"1.5x\"");
    assert_eq!(shorten(b"a\x1b[31m\n\"b"), r#""a\u{1b}[31m\n\"b""#);
    assert_eq!(shorten(b"\xff"), "\"\u{fffd}\"");
    assert_eq!(shorten(&[b'x'; 40]), format!("\"{}\"", "x".repeat(40)));
    assert_eq!(shorten(&[b'x'; 41]), format!("\"{}…\"", "x".repeat(40)));
    assert_eq!(shorten("€".repeat(1000).as_bytes()), format!("\"{}…\"", "€".repeat(40)));
}

proptest! {
    #[test]
    fn decimal_numbers_are_rounded_as_the_standard_library_rounds_them(cell in "[+-]?[0-9]{0,17}(\\.[0-9]{0,17})?(e-?[0-9]{1,2})?") {
        let expected = cell.parse::<f64>().ok().filter(|value| value.is_finite());
        prop_assert_eq!(number(cell.as_bytes()).map(f64::to_bits), expected.map(f64::to_bits));
    }

    #[test]
    fn numbers_of_few_digits_are_what_the_standard_library_reads(digits in 0u64..1_000_000_000_000_000, decimals in 0usize..=16, negative: bool) {
        let text = format!("{}{digits:0>width$}", if negative { "-" } else { "" }, width = decimals + 1);
        let point = text.len() - decimals;
        let cell = if decimals == 0 { text } else { format!("{}.{}", &text[..point], &text[point..]) };
        prop_assert_eq!(number(cell.as_bytes()).unwrap().to_bits(), cell.parse::<f64>().unwrap().to_bits());
    }
}

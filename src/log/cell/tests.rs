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

use proptest::prelude::*;

use super::*;

fn message<T: std::fmt::Debug>(result: Result<T, UnitError>) -> String {
    result.unwrap_err().to_string()
}

#[test]
fn lengths_take_every_unit() {
    assert_eq!(length("2.5m"), Ok(2.5));
    assert_eq!(length(".5m"), Ok(0.5));
    assert_eq!(length("-.5 m"), Ok(-0.5));
    assert_eq!(length("5.m"), Ok(5.0));
    assert_eq!(length("25cm"), Ok(0.25));
    assert_eq!(length("10mm"), Ok(0.01));
    assert_eq!(length("1in"), Ok(0.0254));
    assert_eq!(length("255in"), Ok(6.477));
    assert_eq!(length("1ft"), Ok(0.3048));
    assert_eq!(length("-3ft"), Ok(-0.9144));
}

#[test]
fn a_bare_length_is_metres() {
    assert_eq!(length("0.2286"), Ok(0.2286));
    assert_eq!(length("1e-3"), Ok(0.001));
    assert_eq!(length("0"), Ok(0.0));
}

#[test]
fn a_length_is_the_nearest_number_to_what_is_written() {
    assert_eq!(length("2320mm"), Ok(2.32));
    assert_eq!(length("2.32mm"), Ok(0.00232));
    assert_eq!(length("0.7cm"), Ok(0.007));
    assert_eq!(length("0.1mm"), Ok(0.0001));
    assert_eq!(length("0.170m"), Ok(0.17));
}

#[test]
fn angles_take_degrees_and_radians() {
    assert_eq!(angle("180deg"), Ok(PI));
    assert_eq!(angle("90deg"), Ok(PI / 2.0));
    assert_eq!(angle("-22.5deg"), Ok(-22.5 * (PI / 180.0)));
    assert_eq!(angle("0.5rad"), Ok(0.5));
    assert_eq!(angle("0deg"), Ok(0.0));
}

#[test]
fn a_bare_angle_is_refused_with_an_example() {
    let said = message(angle("30"));
    assert_eq!(said, "`30` has no unit: an angle needs one of deg, rad, like `30deg`");
}

#[test]
fn durations_are_exact() {
    assert_eq!(duration("0.5s"), Ok(500_000_000));
    assert_eq!(duration("0.1"), Ok(100_000_000));
    assert_eq!(duration("250ms"), Ok(250_000_000));
    assert_eq!(duration("1.5us"), Ok(1_500));
    assert_eq!(duration("7ns"), Ok(7));
    assert_eq!(duration("2.5ns"), Ok(2));
    assert_eq!(duration("1.5min"), Ok(90_000_000_000));
    assert_eq!(duration("0.0000000001min"), Ok(6));
    assert_eq!(duration("-1s"), Ok(-1_000_000_000));
    assert_eq!(duration("9223372036.854775807s"), Ok(i64::MAX));
}

#[test]
fn durations_beyond_292_years_are_out_of_range() {
    assert_eq!(message(duration("1e10s")), "`1e10s` is out of range for a duration");
    assert!(duration("1e999999999ns").is_err());
}

#[test]
fn speeds_and_rates_take_their_units() {
    assert_eq!(speed("5in/s"), Ok(0.127));
    assert_eq!(speed("0.5m/s"), Ok(0.5));
    assert_eq!(speed("12cm/s"), Ok(0.12));
    assert_eq!(speed("120 mm/s"), Ok(0.12));
    assert_eq!(speed("2ft/s"), Ok(0.6096));
    assert_eq!(speed("0.3"), Ok(0.3));
    assert_eq!(rate("4Hz"), Ok(4.0));
    assert_eq!(rate("1.5kHz"), Ok(1500.0));
    assert_eq!(rate("4"), Ok(4.0));
}

#[test]
fn blanks_may_surround_number_and_unit() {
    assert_eq!(length(" 10  mm "), Ok(0.01));
    assert_eq!(angle("30 deg"), Ok(30.0 * (PI / 180.0)));
    assert_eq!(duration("1 s"), Ok(1_000_000_000));
}

#[test]
fn the_letter_e_is_an_exponent_only_before_digits() {
    assert_eq!(length("1e2mm"), Ok(0.1));
    assert_eq!(length("1E+2mm"), Ok(0.1));
    let said = message(length("1em"));
    assert_eq!(said, "`1em`: no unit `em` for a length; expected one of m, cm, mm, in, ft");
}

#[test]
fn units_of_another_case_or_kind_are_unknown() {
    for text in ["1M", "1MM", "1inch", "1 m m", "1s", "1km", "1m/s", "1.m.", "1,5m", "1µm"] {
        let error = length(text).unwrap_err();
        assert!(matches!(error, UnitError::UnknownUnit { .. }), "{error}");
    }
    assert!(rate("1hz").is_err());
    assert!(duration("1S").is_err());
    assert!(duration("1h").is_err());
    assert!(angle("1°").is_err());
}

#[test]
fn what_does_not_begin_with_a_number_is_refused() {
    for text in [
        "",
        " ",
        "m",
        "in",
        "inf",
        "nan",
        "NaNm",
        "-",
        "+m",
        ".m",
        "-.",
        "--1m",
        "−1m",
        "a1m",
        "1٣".trim_start_matches('1'),
    ] {
        let error = length(text).unwrap_err();
        assert!(matches!(error, UnitError::NotANumber { .. }), "{text:?}: {error}");
    }
    let said = message(duration("soon"));
    assert_eq!(said, "`soon` is not a duration: expected a number and a unit, like `0.5s`");
}

#[test]
fn numbers_too_large_are_out_of_range() {
    assert_eq!(message(length("1e309m")), "`1e309m` is out of range for a length");
    assert_eq!(message(rate("1e308kHz")), "`1e308kHz` is out of range for a rate");
    assert!(length(&"9".repeat(400)).is_err());
}

#[test]
fn messages_shorten_what_is_long_and_escape_what_is_unprintable() {
    let said = message(length(&format!("\u{1b}[31m{}", "x".repeat(10_000))));
    assert!(said.starts_with("`\\u{1b}[31mxxx"), "{said}");
    assert!(said.chars().count() < 200, "{said}");
}

#[test]
fn a_scale_divides_where_that_is_exact() {
    let mm = Scale::length("mm").unwrap();
    assert_eq!(mm.apply(2320.0), 2.32);
    assert_eq!(mm.apply(5110.0), 5.11);
    assert_eq!(Scale::length("0.25 mm").unwrap().apply(4.0), 0.001);
    assert_eq!(Scale::length("cm").unwrap().apply(7.0), 0.07);
    assert_eq!(Scale::length("m").unwrap(), Scale::SI);
    assert_eq!(Scale::length("0.001").unwrap().apply(2320.0), 2.32);
    assert_eq!(Scale::length("1in").unwrap().apply(255.0), 6.477);
}

#[test]
fn tenths_of_a_degree_agree_with_decimal_degrees() {
    let tenths = Scale::angle("0.1deg").unwrap();
    for raw in [0, 1, 225, 900, 1800, 3599] {
        let written = format!("{}.{}deg", raw / 10, raw % 10);
        assert_eq!(Ok(tenths.apply(f64::from(raw))), angle(&written), "{written}");
    }
    assert_eq!(tenths.apply(900.0), PI / 2.0);
    assert_eq!(Scale::angle("rad").unwrap(), Scale::default());
    assert_eq!(Scale::angle("-1deg").unwrap().apply(180.0), -PI);
}

#[test]
fn a_scale_passes_on_what_is_not_finite() {
    let mm = Scale::length("mm").unwrap();
    assert!(mm.apply(f64::NAN).is_nan());
    assert_eq!(mm.apply(f64::NEG_INFINITY), f64::NEG_INFINITY);
}

#[test]
fn a_scale_of_zero_of_no_unit_or_of_another_kind_is_refused() {
    assert_eq!(message(Scale::length("0mm")), "`0mm` is out of range for a length");
    assert!(Scale::length("deg").is_err());
    assert!(Scale::length("").is_err());
    assert!(Scale::angle("0.1").is_err());
    assert!(Scale::angle("mm").is_err());
    assert!(Scale::length("1e400mm").is_err());
    assert!(Scale::length("1e-323mm").is_err());
}

proptest! {
    #[test]
    fn millimetres_are_the_decimal_point_three_places_on(raw in -1_000_000_000i64..1_000_000_000) {
        let written: f64 = format!("{raw}e-3").parse().unwrap();
        prop_assert_eq!(length(&format!("{raw}mm")), Ok(written));
        prop_assert_eq!(Scale::length("mm").unwrap().apply(raw as f64), written);
    }

    #[test]
    fn decimals_of_a_millimetre_are_nearest_too(whole in 0u32..100_000, decimals in 0u32..1000) {
        let number = format!("{whole}.{decimals:03}");
        let written: f64 = format!("{number}e-3").parse().unwrap();
        prop_assert_eq!(length(&format!("{number}mm")), Ok(written));
    }

    #[test]
    fn no_text_makes_it_panic(text: String) {
        let _ = (length(&text), angle(&text), duration(&text), speed(&text), rate(&text));
        let _ = (Scale::length(&text), Scale::angle(&text));
    }

    #[test]
    fn what_is_read_is_finite(text in "[-+]?[0-9]{1,30}(\\.[0-9]{1,30})?([eE][-+]?[0-9]{1,5})? ?(m|cm|mm|in|ft)?") {
        if let Ok(metres) = length(&text) {
            prop_assert!(metres.is_finite());
        }
    }
}

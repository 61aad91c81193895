//! `atm plan`: the paper's numbers (Sec. IV-B and IV-D).

mod support;

use support::*;

const MOVING: [&str; 4] = ["--speed", "5in/s", "--rate", "1Hz"];

fn plan(more: &[&str]) -> Ran {
    atm(["plan", "--distance", "100in"].iter().chain(more))
}

#[test]
fn thirty_degrees_at_100_in_give_the_numbers_of_the_paper() {
    let numbers = plan(&[&["--min-angle", "30deg", "--json"], &MOVING[..]].concat()).exits(0).json();
    let value = |key: &str| numbers[key].as_f64().unwrap_or_else(|| panic!("no {key} in {numbers}"));
    assert_near(value("interval_m") / INCH, 3.732, 0.0005);
    assert_near(value("improvement"), 10.52, 0.005);
    assert_near(value("min_angle_rad").to_degrees(), 30.0, 1e-12);
    assert_near(value("close_range_m") / INCH, 9.50, 0.005);
    assert_near(value("travel_m") / INCH, 51.76, 0.005);
    assert_eq!(numbers["readings"].as_u64(), Some(12));
}

#[test]
fn an_improvement_of_ten_at_100_in_takes_28_57_degrees() {
    let numbers = plan(&["--improvement", "10", "--json"]).exits(0).json();
    assert_near(numbers["min_angle_rad"].as_f64().expect("an angle").to_degrees(), 28.57, 0.005);
    assert_near(numbers["improvement"].as_f64().expect("a number"), 10.0, 1e-12);
}

#[test]
fn readings_are_null_without_speed_and_rate() {
    let numbers = plan(&["--min-angle", "30deg", "--json"]).exits(0).json();
    assert_eq!(numbers.get("readings"), Some(&serde_json::Value::Null));
}

#[test]
fn beam_and_range_resolution_enter_the_improvement() {
    // 2 m, 30 degrees, 1 cm: L is 3.732 cm, the arc 1.0472 m.
    let args =
        ["plan", "--distance", "2", "--fov", "30deg", "--range-resolution", "1cm", "--min-angle", "30deg", "--json"];
    let numbers = atm(args).exits(0).json();
    assert_near(numbers["interval_m"].as_f64().expect("a length"), 0.037_320_508, 1e-9);
    assert_near(numbers["improvement"].as_f64().expect("a number"), 28.0595, 1e-4);
}

#[test]
fn text_says_how_far_a_history_of_ten_reaches() {
    // Nine steps of 5 in are 45 in of travel: 45 / (2 sin 15) = 86.93 in.
    let text = plan(&[&["--min-angle", "30deg"], &MOVING[..]].concat()).exits(0);
    let text = text.text();
    for word in ["3.73", "10.52", "30.00", "9.50", "51.76", "12", "86.9", "10 readings"] {
        assert!(text.contains(word), "no {word} in: {text}");
    }
}

#[test]
fn text_goes_to_standard_output_and_nothing_else_is_said() {
    let ran = plan(&["--min-angle", "30deg"]).exits(0);
    assert_eq!(ran.stderr, "");
    assert!(ran.text().contains("3.73"));
}

#[test]
fn exactly_one_of_angle_and_improvement_is_taken() {
    plan(&[]).exits(2).says(&["--min-angle", "--improvement"]).writes_nothing();
    plan(&["--min-angle", "30deg", "--improvement", "10"]).exits(2).writes_nothing();
}

#[test]
fn arguments_out_of_their_domain_are_refused() {
    let angle = ["--min-angle", "30deg"];
    let refused = |args: &[&str]| {
        atm(["plan"].iter().chain(args)).exits(2).writes_nothing();
    };
    refused(&angle);
    refused(&["--distance", "0", "--min-angle", "30deg"]);
    refused(&["--distance=-1m", "--min-angle", "30deg"]);
    refused(&["--distance", "1parsec", "--min-angle", "30deg"]);
    for more in [
        &["--min-angle", "0.5deg"][..],
        &["--min-angle", "91deg"],
        &["--improvement", "0"],
        // The arc of 39.3 in holds 39 steps of the range.
        &["--improvement", "39.3"],
        &["--min-angle", "30deg", "--fov", "181deg"],
        &["--min-angle", "30deg", "--range-resolution", "0"],
        &["--min-angle", "30deg", "--speed", "5in/s"],
        &["--min-angle", "30deg", "--rate", "1Hz"],
        &["--min-angle", "30deg", "--speed", "0", "--rate", "1Hz"],
        &["--min-angle", "30deg", "--speed", "5in/s", "--rate", "1s"],
    ] {
        let ran = plan(more);
        assert_eq!(ran.status, 2, "{more:?}");
        ran.writes_nothing();
    }
    plan(&["--improvement", "39.2"]).exits(0);
}

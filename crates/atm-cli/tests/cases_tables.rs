//! Tables as robots and spreadsheets write them: read, or refused with the cause and what cures it.

mod support;

use serde_json::Value;
use support::{cases::case, *};

/// `atm fuse` of a case by count, as the paper has it, and its summary. The rig is the Nomad's, or a file.
fn fuse(path: &str, rig: &str, more: &[&str]) -> (Ran, Value) {
    let args: Vec<&str> =
        ["fuse", path, "--rig", rig, "--history", "10"].into_iter().chain(more.iter().copied()).collect();
    with_summary(&args, "")
}

/// Medians and singles.
fn resolved(summary: &Value) -> (u64, u64) {
    (tally(summary, "/echoes/median"), tally(summary, "/echoes/single"))
}

/// What `advice` says, cause, evidence and cure in a row.
fn advice(summary: &Value) -> String {
    summary["advice"].to_string()
}

/// The echoes without the column of the time, which a case may write from another day on.
fn places(ran: &Ran) -> Vec<String> {
    let place = |line: &str| line.split_once(',').expect("a time").1.to_owned();
    let mut places: Vec<String> = ran.text().lines().skip(1).map(place).collect();
    places.sort();
    places
}

/// The same echoes as the base's, exit 0, no word.
#[track_caller]
fn is_as_base(name: &str) {
    let (Some(base), Some(path)) = (case("tables/base.csv"), case(&format!("tables/{name}"))) else { return };
    let (expected, found) = (fuse(&base, "nomad200", &[]).0.exits(0), fuse(&path, "nomad200", &[]).0.exits(0));
    assert!(places(&found) == places(&expected), "{name}: other echoes");
    assert_eq!(found.stderr, expected.stderr, "{name}");
}

/// Exit 0 or 3 as said, and advice with all of these words.
#[track_caller]
fn is_told(name: &str, words: &[&str]) {
    let Some(path) = case(&format!("tables/{name}")) else { return };
    let (ran, summary) = fuse(&path, "nomad200", &[]);
    let ran = ran.exits(0).says(&["warning: "]);
    let info = atm(["info", &path, "--rig", "nomad200", "--json"]).exits(0).json();
    for word in words {
        assert!(advice(&summary).contains(word), "no `{word}` in {summary}");
        assert!(ran.stderr.contains(word), "no `{word}` in {}", ran.stderr);
        assert!(info["advice"].to_string().contains(word), "no `{word}` in {info}");
    }
}

#[test]
fn the_base_is_in_order() {
    let Some(path) = case("tables/base.csv") else { return };
    let (ran, summary) = fuse(&path, "nomad200", &[]);
    ran.exits(0);
    assert_eq!((resolved(&summary), advice(&summary)), ((122, 57), "[]".into()));
}

#[test]
fn decimal_commas_are_read_where_commas_do_not_separate_cells() {
    is_as_base("decimal_comma.csv");
}

#[test]
fn dates_and_times_of_day_are_read() {
    is_as_base("iso_times.csv");
    is_as_base("time_of_day.csv");
}

#[test]
fn a_header_in_a_comment_is_read() {
    is_as_base("header_in_comment.csv");
}

#[test]
fn rows_sorted_by_sensor_are_put_in_order() {
    is_as_base("sorted_by_sensor.csv");
    let (Some(path), Some(rig)) = (case("tables/melt_small.csv"), case("tables/one_two.toml")) else { return };
    let scratch = Scratch::new();
    let rig = scratch.file("rig.toml", format!("{}\n[[sensor]]\nid = \"b\"\n", read(&rig)));
    let (ran, summary) = fuse(&path, &rig, &[]);
    ran.exits(0);
    assert_eq!(tally(&summary, "/readings"), 4);
}

#[test]
fn a_table_that_was_joined_with_one_of_poses_is_read_with_the_poses_around_its_rows() {
    let (Some(base), Some(path)) = (case("tables/base.csv"), case("tables/outer_join.csv")) else { return };
    let (expected, found) = (fuse(&base, "nomad200", &[]).0.exits(0).echoes(), fuse(&path, "nomad200", &[]));
    assert_eq!(tally(&found.1, "/readings"), 784);
    let found = found.0.exits(0).echoes();
    assert_eq!(found.len(), expected.len());
    // Its poses are 10 ms early: 1.3 mm.
    for (found, expected) in found.iter().zip(&expected) {
        assert_eq!((&found.sensor, &found.kind), (&expected.sensor, &expected.kind));
        assert_near(found.x, expected.x, 0.01);
    }
}

#[test]
fn units_in_cells_are_read_and_the_maximum_that_stands_for_nothing_is_told() {
    is_told("units_in_cells.csv", &["4.00 m stands for nothing", "98 of 784", "max_range = \\\"4m\\\""]);
}

#[test]
fn ranges_that_are_clipped_are_told() {
    is_told("clipped.csv", &["2.49 m stands for nothing"]);
}

#[test]
fn headings_and_positions_that_are_none_are_told() {
    is_told("yaw_in_degrees.csv", &["in degrees", "yaw_unit"]);
    is_told("yaw_clockwise.csv", &["clockwise", "yaw_unit"]);
    is_told("latitude_longitude.csv", &["latitude and longitude", "--poses"]);
    let Some(right) = case("tables/yaw_right.csv") else { return };
    let (ran, summary) = fuse(&right, "nomad200", &[]);
    ran.exits(0);
    assert_eq!(advice(&summary), "[]");
}

#[test]
fn the_advice_on_headings_is_right() {
    let Some(right) = case("tables/yaw_right.csv") else { return };
    let expected = fuse(&right, "nomad200", &[]).0.exits(0);
    let scratch = Scratch::new();
    let nomad = read(root().join("rig/nomad200.toml").to_str().expect("a path in UTF-8"));
    for (name, unit) in [("yaw_in_degrees.csv", "1deg"), ("yaw_clockwise.csv", "-1rad")] {
        let Some(path) = case(&format!("tables/{name}")) else { return };
        let rig = scratch.file("rig.toml", format!("{nomad}\n[log]\nyaw_unit = \"{unit}\"\n"));
        let found = fuse(&path, &rig, &[]).0.exits(0);
        for (found, expected) in found.echoes().iter().zip(expected.echoes()) {
            assert_eq!(found.kind, expected.kind);
            assert_near(found.x, expected.x, 1e-9);
        }
    }
}

#[test]
fn times_that_have_lost_their_digits_are_told() {
    is_told("epoch_lost_digits.csv", &["lost their digits", "1 time", "1661450000 s"]);
}

#[test]
fn a_panning_sensor_is_read_by_the_column_of_its_angle() {
    let (Some(path), Some(rig)) = (case("tables/servo.csv"), case("tables/servo.toml")) else { return };
    let said = fuse(&path, &rig, &[]).0;
    said.exits(1).says(&["servo, dist", "columns = [\"t\", \"sensor\", \"range\""]);
    let scratch = Scratch::new();
    let columns = |third: &str| {
        format!("[log]\ncolumns = [\"t\", \"x\", \"y\", \"yaw\", \"{third}\", \"range\"]\nheader = true\n")
    };
    // A sensor an angle, or one that turns.
    let many = scratch.file("many.toml", format!("{}\n{}", read(&rig), columns("sensor")));
    let one = "field_of_view = \"15deg\"\nmin_range = \"2cm\"\nmax_range = \"4m\"\nrange_resolution = \"1cm\"\n[[sensor]]\n\
               id = \"servo\"\nx = \"10cm\"\n";
    let one = scratch.file("one.toml", format!("{one}{}angle = \"servo\"\nangle_unit = \"1deg\"\n", columns("servo")));
    let centers = |rig: &str| {
        let (ran, summary) = fuse(&path, rig, &["--keep", "center", "--min-angle", "90deg", "--history", "1"]);
        assert_eq!(tally(&summary, "/readings"), 2121);
        ran.exits(0).echoes()
    };
    let (many, one) = (centers(&many), centers(&one));
    assert!(many.len() > 1000);
    let by_time = |echoes: &[Echo]| {
        let mut places: Vec<(String, f64, f64)> = echoes.iter().map(|echo| (echo.t.clone(), echo.x, echo.y)).collect();
        places.sort_by(|a, b| number(&a.0).total_cmp(&number(&b.0)));
        places
    };
    for (one, many) in by_time(&one).iter().zip(by_time(&many)) {
        assert_eq!(one.0, many.0);
        assert_near(one.1, many.1, 1e-9);
        assert_near(one.2, many.2, 1e-9);
    }
}

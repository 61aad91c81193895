//! `atm compare`: every method on one log.
#![cfg(feature = "lab")]

mod support;

use serde_json::{Value, json};
use support::*;

const COMPARE: [&str; 5] = ["compare", SAMPLE, "--rig", "nomad200", "--quiet"];
const DOORWAY: [&str; 2] = ["--world", "doorway"];

fn compare(more: &[&[&str]]) -> Ran {
    atm(COMPARE.iter().chain(more.iter().flat_map(|some| some.iter())))
}

/// Keys of `eval --json`.
const EVAL: [&str; 7] =
    ["points", "azimuth_error_m", "surface_error_m", "coverage", "ghosts", "doorway_width_m", "by_kind"];

#[test]
fn every_method_has_the_keys_of_eval_and_its_time() {
    let all = compare(&[&DOORWAY, &["--json"]]).exits(0).json();
    let methods: Vec<&String> = all.as_object().unwrap().keys().collect();
    assert_eq!(methods.len(), 22, "{methods:?}");
    for (name, method) in all.as_object().unwrap() {
        for key in EVAL.iter().chain(["seconds_per_reading", "best", "same_readings"].iter()) {
            assert!(method.get(key).is_some(), "{name}: no {key}");
        }
        assert!(method["seconds_per_reading"].as_f64().unwrap() >= 0.0);
        assert!(method["surface_error_m"].get("p95").is_some());
    }
}

#[test]
fn what_does_not_apply_is_null_and_not_zero() {
    let all = compare(&[&DOORWAY, &["--json", "--methods", "rcd,himm,centerline"]]).exits(0).json();
    let rcd = &all["rcd"];
    for key in ["points", "coverage", "ghosts", "doorway_width_m", "best", "same_readings", "agreement"] {
        assert_eq!(rcd[key], Value::Null, "{key}");
    }
    assert_eq!(rcd["surface_error_m"]["p50"], Value::Null);
    assert_eq!(all["himm"]["azimuth_error_m"]["p50"], Value::Null);
    assert!(all["himm"]["best"]["threshold"].is_number() && all["centerline"]["best"].is_null());
    let closed = atm(COMPARE.iter().chain(&["--world", "closed-wall", "--json", "--methods", "centerline"]));
    assert_eq!(closed.exits(0).json()["centerline"]["doorway_width_m"], Value::Null);
}

#[test]
fn atm_is_what_fuse_and_eval_say() {
    for (method, options) in [
        ("atm", vec![]),
        ("atm-median-single", vec!["--keep", "median,single"]),
        ("atm-none-drop", vec!["--on-none", "drop"]),
        ("atm-two-center", vec!["--on-two", "center"]),
        ("atm-two-mean", vec!["--on-two", "mean"]),
        ("atm-latest", vec!["--emit", "latest"]),
        ("consensus", vec!["--estimator", "consensus"]),
        ("consensus-point-wall", vec!["--estimator", "consensus", "--keep", "point,wall"]),
    ] {
        let fused = fuse_sample(&options).exits(0);
        let expected = atm_fed(["eval", "-", "--world", "doorway", "--json"], fused.text()).exits(0).json();
        let found = compare(&[&DOORWAY, &["--json", "--methods", method]]).exits(0).json();
        for key in EVAL {
            assert_eq!(found[method][key], expected[key], "{method} {key}");
        }
    }
    let latest = fuse_sample(&["--history", "5", "--min-angle", "40deg"]).exits(0).echoes().len();
    let more = ["--json", "--methods", "atm", "--history", "5", "--min-angle", "40deg"];
    assert_eq!(compare(&[&DOORWAY, &more]).exits(0).json()["atm"]["points"], json!(latest));
}

#[test]
fn a_truth_gives_azimuth_errors_and_a_comparison_on_the_same_readings() {
    let scratch = Scratch::new();
    let (log, truth) = (scratch.name("log.csv"), scratch.name("truth.csv"));
    atm(["simulate", "doorway", "-o", &log, "--truth", &truth]).exits(0);
    let more = ["--world", "doorway", "--truth", &truth, "--json"];
    let all = atm(["compare", &log, "--rig", "nomad200"].iter().chain(&more)).exits(0).json();
    let sharp = &all["atm-median-single"];
    let (own, centres) =
        (&sharp["azimuth_error_m"]["p50"], &sharp["same_readings"]["centerline_azimuth_error_m"]["p50"]);
    assert_eq!(own, &sharp["same_readings"]["azimuth_error_m"]["p50"]);
    assert!(own.as_f64().unwrap() < 0.5 * centres.as_f64().unwrap(), "{own} {centres}");
    assert_eq!(all["centerline"]["same_readings"]["answered"], 1.0);
}

#[test]
fn without_a_world_methods_are_compared_with_one_another() {
    let all = compare(&[&["--json", "--methods", "atm,centerline,himm"]]).exits(0).json();
    for (name, method) in all.as_object().unwrap() {
        assert!(method["points"].as_u64().unwrap() > 0, "{name}");
        assert_eq!(method["ghosts"], Value::Null);
        assert!(
            method["map_entropy_bits"]["5cm"].as_f64().unwrap()
                > method["map_entropy_bits"]["10cm"].as_f64().unwrap() - 1e-9
        );
        assert_eq!(method["agreement"].as_object().unwrap().len(), 2);
    }
    let text = compare(&[&["--methods", "atm,centerline"]]).exits(0);
    assert!(text.text().contains("entropy 5cm") && text.text().lines().any(|line| line.starts_with("centerline ")));
}

#[test]
fn the_table_has_one_row_a_method_in_the_order_asked_for() {
    let table = compare(&[&DOORWAY, &["--methods", "tbf,atm,rcd,tbf"]]).exits(0);
    let rows: Vec<&str> = table.text().lines().skip(2).take(3).map(|row| row.split(' ').next().unwrap()).collect();
    assert_eq!(rows, ["tbf", "atm", "rcd"]);
    let rcd = table.text().lines().nth(4).unwrap();
    assert!(rcd.split_whitespace().skip(1).all(|cell| cell == "-"), "{rcd}");
    let widest = table.text().lines().map(|line| line.chars().count()).max().unwrap();
    assert!(widest <= 160, "{widest}");
}

#[test]
fn pictures_and_maps_go_where_they_are_asked_for() {
    let scratch = Scratch::new();
    let (draw, map) = (scratch.name("pictures"), scratch.name("maps/here"));
    let more = ["--methods", "atm,mckerrow,himm,rcd", "--draw", &draw, "--map", &map];
    compare(&[&DOORWAY, &more]).exits(0);
    for name in ["atm", "mckerrow", "himm", "side-by-side"] {
        let picture = std::fs::read_to_string(format!("{draw}/{name}.svg")).expect(name);
        assert!(picture.starts_with("<svg") || picture.starts_with("<?xml"), "{name}");
    }
    assert!(std::fs::read(format!("{draw}/side-by-side.png")).unwrap().starts_with(b"\x89PNG"));
    assert!(!std::path::Path::new(&format!("{draw}/rcd.svg")).exists(), "nothing to draw");
    let yaml = std::fs::read_to_string(format!("{map}/himm/map.yaml")).unwrap();
    assert!(yaml.starts_with("image: map.pgm\nresolution: 0.1\norigin: ["), "{yaml}");
    let pgm = std::fs::read(format!("{map}/himm/map.pgm")).unwrap();
    assert!(pgm.starts_with(b"P5\n"));
    // As many black cells as points.
    let points = compare(&[&DOORWAY, &["--json", "--methods", "himm"]]).exits(0).json()["himm"]["points"].as_u64();
    let header = pgm.iter().enumerate().filter(|(_, byte)| **byte == b'\n').nth(2).unwrap().0;
    assert_eq!(points, Some(pgm[header + 1..].iter().filter(|shade| **shade == 0).count() as u64));
    assert!(std::fs::read(format!("{map}/himm/map.png")).unwrap().starts_with(b"\x89PNG"));
    assert!(!std::path::Path::new(&format!("{map}/atm")).exists(), "no grid, no map");
}

#[test]
fn wrong_arguments_are_named() {
    compare(&[&["--methods", "gvg"]]).exits(2).says(&["gvg is none of atm, "]);
    compare(&[&["--set", "opening=30in"]]).exits(2).says(&["--world"]);
    compare(&[&["--world", "nowhere"]]).exits(1).says(&["nowhere"]);
    compare(&[&DOORWAY, &["--methods", "elfes", "--cell", "0.01mm"]]).exits(1).says(&["take wider cells"]);
    atm(["compare", SAMPLE]).exits(2).says(&["--rig"]);
    let scratch = Scratch::new();
    let file = scratch.file("file", "");
    compare(&[&["--methods", "atm", "--draw", &file]]).exits(1).says(&[&file]);
}

#[test]
fn what_could_not_be_used_is_counted_and_the_rest_compared() {
    let bad = format!("{}49,0,soon,0,0,0\n", sample());
    let args = ["compare", "-", "--rig", "nomad200", "--world", "doorway", "--json", "--methods", "atm"];
    let found = atm_fed(args, bad).exits(3).says(&["1 bad_number"]);
    let expected = compare(&[&DOORWAY, &["--json", "--methods", "atm"]]).exits(0).json();
    assert_eq!(found.json()["atm"]["points"], expected["atm"]["points"]);
}

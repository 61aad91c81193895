//! `atm info`: what is in a log.

mod support;

use serde_json::{Value, json};
use support::*;

const KEYS: [&str; 6] = ["format", "sensors", "start_ns", "end_ns", "pose_source", "problems"];
const SENSOR_KEYS: [&str; 7] =
    ["topic", "readings", "no_echo", "rate_hz", "field_of_view_rad", "min_range_m", "max_range_m"];

/// `atm info --json` of a log in memory.
fn info(log: &str, more: &[&str]) -> Ran {
    atm_fed(["info", "-", "--json"].iter().chain(more), log)
}

fn problems(found: &Value) -> String {
    found["problems"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|problem| problem.as_str().expect("a text").to_owned() + "\n")
        .collect()
}

#[test]
fn json_has_all_keys_with_and_without_a_rig() {
    for more in [&[][..], &["--rig", "nomad200"]] {
        let found = info(&sample(), more).exits(0).json();
        for key in KEYS {
            assert!(found.get(key).is_some(), "no {key} in {found}");
        }
        let sensors = found["sensors"].as_object().expect("an object");
        assert_eq!(sensors.len(), 16);
        for sensor in sensors.values() {
            for key in SENSOR_KEYS {
                assert!(sensor.get(key).is_some(), "no {key} in {sensor}");
            }
        }
    }
}

#[test]
fn counts_rates_and_times_are_those_of_the_log() {
    let found = info(&sample(), &["--rig", "nomad200"]).exits(0).json();
    assert_eq!((&found["start_ns"], &found["end_ns"]), (&json!(0), &json!(48_000_000_000_i64)));
    for (id, sensor) in found["sensors"].as_object().expect("an object") {
        let silent = sample_rows().iter().filter(|row| row.sensor == *id && row.echo().is_none()).count();
        assert_eq!((&sensor["readings"], &sensor["no_echo"]), (&json!(49), &json!(silent)), "{id}");
        assert_near(sensor["rate_hz"].as_f64().expect("a rate"), 1.0, 1e-12);
        assert_near(sensor["field_of_view_rad"].as_f64().expect("an angle"), BEAM, 1e-12);
        assert_near(sensor["min_range_m"].as_f64().expect("a length"), 6.0 * INCH, 1e-12);
        assert_near(sensor["max_range_m"].as_f64().expect("a length"), 255.0 * INCH, 1e-12);
    }
    assert_eq!(found["problems"], json!([]));
}

#[test]
fn what_only_a_rig_knows_is_null_without_one() {
    let found = info("t,sensor,range,x,y,yaw\n0,left,1,0,0,0\n", &[]).exits(0).json();
    let left = &found["sensors"]["left"];
    for key in ["topic", "rate_hz", "field_of_view_rad", "min_range_m", "max_range_m"] {
        assert_eq!(left[key], Value::Null, "{key}");
    }
    assert_eq!(left["readings"], 1);
}

#[test]
fn topics_come_from_the_rig() {
    let scratch = Scratch::new();
    let rig = scratch.file("rig.toml", "[[sensor]]\nid = \"left\"\ntopic = \"/range/left\"\n");
    let found = info("t,sensor,range,x,y,yaw\n0,left,1,0,0,0\n", &["--rig", &rig]).exits(0).json();
    assert_eq!(found["sensors"]["left"]["topic"], "/range/left");
    assert_eq!(found["sensors"]["left"]["max_range_m"], Value::Null, "no bound");
}

#[test]
fn wide_tables_are_told_from_long_ones() {
    let long = info("t,sensor,range,x,y,yaw\n0,a,1,0,0,0\n0,b,2,0,0,0\n", &[]).exits(0).json();
    let wide = info("t,x,y,yaw,a,b\n0,0,0,0,1,2\n", &[]).exits(0).json();
    assert_ne!(long["format"], wide["format"]);
    assert_eq!(long["sensors"], wide["sensors"]);
}

#[test]
fn source_of_the_poses_is_named_and_its_absence_is_a_problem() {
    let scratch = Scratch::new();
    let bare = "t,sensor,range\n0.1,a,1\n0.2,a,1.5\n";
    let found = info(bare, &[]).exits(0).json();
    assert_eq!(found["pose_source"], Value::Null);
    assert!(problems(&found).contains("--poses"), "{found}");
    let csv = scratch.file("path.csv", "t,x,y,yaw\n0,0,0,0\n0.3,1,0,0\n");
    let tum = scratch.file("path.tum", "0 0 0 0 0 0 0 1\n0.3 1 0 0 0 0 0 1\n");
    for poses in [csv, tum] {
        let found = info(bare, &["--poses", &poses]).exits(0).json();
        assert!(found["pose_source"].as_str().expect("a text").contains(&poses), "{found}");
        assert_eq!(found["problems"], json!([]));
    }
    let own = info(&sample(), &[]).exits(0).json();
    assert!(own["pose_source"].is_string(), "{own}");
}

#[test]
fn unusable_records_are_named_and_end_in_3() {
    let log = "t,sensor,range,x,y,yaw\n0,a,1,0,0,0\n1,a,bad,0,0,0\n2,a,1.5,nan,0,0\n1.5,a,2,0,0,0\n0.5,a,2,0,0,0\n";
    let ran = info(log, &[]).exits(3).says(&["standard input:3 ", "\"bad\"", "standard input:4 ", "standard input:6 "]);
    let found = problems(&ran.json());
    for word in ["bad_number", "bad_pose", "time_backwards", "standard input:3", "\"bad\"", "t 0.5 after 1.5"] {
        assert!(found.contains(word), "no {word} in {found}");
    }
    assert_eq!(ran.json()["sensors"]["a"]["readings"], 2);
}

#[test]
fn sensors_that_the_rig_lacks_or_that_are_silent_are_named() {
    let log = "t,sensor,range,x,y,yaw\n0,0,1,0,0,0\n0,99,1,0,0,0\n";
    let ran = info(log, &["--rig", "nomad200"]).exits(3).says(&["unknown_sensor", "\"99\""]);
    assert!(problems(&ran.json()).contains("no readings from 1, 2, 3"), "{}", ran.text());
}

#[test]
fn held_values_are_a_problem_that_says_what_to_do() {
    let rows: String = (0..20).map(|t| format!("{t},a,1.{},{t},0,0\n", t / 4)).collect();
    let found = info(&format!("t,sensor,range,x,y,yaw\n{rows}"), &[]).exits(0).json();
    assert!(problems(&found).contains("--drop-held"), "{found}");
}

#[test]
fn text_shows_the_same_on_standard_output() {
    let ran = atm(["info", SAMPLE]).exits(0);
    for word in ["16 sensors", "48", "1.00 Hz", "49"] {
        assert!(ran.text().contains(word), "no {word} in {}", ran.text());
    }
    assert_eq!(ran.stderr, "");
    let problem = atm_fed(["info", "-"], "t,sensor,range\n0,a,1\n").exits(0);
    assert!(problem.text().contains("problem") && problem.text().contains("--poses"), "{}", problem.text());
}

#[test]
fn files_that_are_no_logs_are_refused() {
    info("", &[]).exits(1).says(&["standard input", "empty"]).writes_nothing();
    info("a poem\nabout the sea\n", &[]).exits(1).says(&["standard input:1"]).writes_nothing();
    atm(["info", "/no/such/file"]).exits(1).says(&["/no/such/file"]).writes_nothing();
    atm(["info"]).exits(2).writes_nothing();
}

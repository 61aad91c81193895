//! `atm eval`: the scores of echo files, and what is said where there are none.
#![cfg(feature = "lab")]

mod support;

use support::*;

/// The wall with the opening stands 70 in (1.778 m) from the path; the opening of 36 in lies in the middle of 240 in.
const ON_THE_WALL: &str = "x,y\n1,1.778\n";

fn eval(echoes: &str, more: &[&str]) -> Ran {
    atm_fed(["eval", "-", "--world", "doorway"].iter().chain(more), echoes)
}

#[test]
fn the_sample_is_open_in_medians_and_singles_and_shut_in_all_kinds() {
    let scores = |keep: &[&str]| {
        let fused = fuse_sample(keep).exits(0);
        eval(fused.text(), &["--json"]).exits(0).json()
    };
    let width = |scores: &serde_json::Value| scores["doorway_width_m"].as_f64().expect("a width") / INCH;
    let (sharp, all) = (scores(&["--keep", "median,single"]), scores(&["--emit", "latest"]));
    assert!(width(&sharp) >= 28.0 && width(&sharp) <= 36.0, "{}", width(&sharp));
    assert!(width(&all) < 20.0, "{}", width(&all));
    let rows = fuse_sample(&["--emit", "latest"]).echoes();
    assert_eq!(all["points"].as_u64(), Some(rows.len() as u64));
    for kind in ["median", "single", "center"] {
        assert_eq!(all["by_kind"][kind]["points"].as_u64(), Some(count(&rows, kind) as u64), "{kind}");
    }
}

#[test]
fn a_truth_file_gives_azimuth_errors() {
    let scratch = Scratch::new();
    let truth = scratch.file("truth.csv", "t,sensor,x,y,azimuth,cause\n5,a,0,1.778,0.1,corner\n6,a,0,1.778,0,corner\n");
    let echoes = "t,sensor,x,y,kind,range,azimuth\n5.000000000,a,0,1.778,median,2,0.2\n6,b,0,1.778,median,2,0.2\n";
    let scores = eval(echoes, &["--truth", &truth, "--json"]).exits(0).json();
    assert_near(scores["azimuth_error_m"]["p50"].as_f64().expect("an error"), 0.2, 1e-12);
    assert_eq!(scores["azimuth_error_m"]["count"], 1);
    assert_eq!(eval(echoes, &["--json"]).exits(0).json()["azimuth_error_m"]["p50"], serde_json::Value::Null);
}

#[test]
fn coverage_is_about_what_the_log_could_see() {
    // The sample's own log looks from where the world's path goes; its first sweep alone sees less, of which the point is a
    // larger share.
    let coverage = |more: &[&str]| {
        let json = eval(ON_THE_WALL, &[&["--json"], more].concat()).exits(0).json();
        json["coverage"].as_f64().expect("a share")
    };
    let scratch = Scratch::new();
    let first: String = sample().lines().take(17).map(|line| format!("{line}\n")).collect();
    let (by_path, by_log) = (coverage(&[]), coverage(&["--log", SAMPLE, "--rig", "nomad200"]));
    assert_near(by_log, by_path, 1e-12);
    assert!(coverage(&["--log", &scratch.file("first.csv", first), "--rig", "nomad200"]) > 1.5 * by_path);
    eval(ON_THE_WALL, &["--log", SAMPLE]).exits(2).says(&["--rig"]);
}

#[test]
fn parameters_of_the_world_count() {
    // The wall is moved to where the point is.
    let error = |more: &[&str]| eval("x,y\n1,2\n", more).exits(0).json()["surface_error_m"]["mean"].as_f64();
    assert_near(error(&["--json"]).expect("an error"), 0.222, 1e-9);
    assert_near(error(&["--json", "--set", "distance=2m"]).expect("an error"), 0.0, 1e-9);
}

#[test]
fn the_table_shows_inches_and_metres_by_kind() {
    let echoes = "x,y,kind\n1,1.778,median\n1,1.8288,pole\n";
    let ran = eval(echoes, &[]).exits(0);
    let row =
        |name: &str| ran.text().lines().find(|line| line.starts_with(name)).unwrap_or_else(|| panic!("no {name}"));
    assert_eq!(row("points").split_whitespace().collect::<Vec<_>>(), ["points", "2", "1", "1"]);
    // 2 in off the wall, half of it on average.
    assert!(row("surface error").contains("1.00 (0.025)") && row("surface error").contains("2.00 (0.051)"));
    assert!(row("azimuth error").contains('-'));
    assert!(row("doorway").contains("0.00 (0.000)"));
    assert!(ran.text().contains("pole") && ran.text().contains("inches (metres)"));
}

#[test]
fn an_empty_table_is_scored_as_nothing() {
    let scores = eval(&format!("{HEADER}\n"), &["--json"]).exits(0).json();
    assert_eq!((&scores["points"], &scores["coverage"]), (&0.into(), &0.0.into()));
    eval(&format!("{HEADER}\n"), &[]).exits(0);
}

#[test]
fn rows_that_cannot_be_used_are_named_and_the_rest_is_scored() {
    let ran = eval("x,y\n1,1.778\nnan,2\n", &["--json"]).exits(3).says(&["standard input:3", "x \"nan\""]);
    assert_eq!(ran.json()["points"], 1);
}

#[test]
fn wrong_files_and_arguments_are_refused() {
    atm_fed(["eval", "-"], ON_THE_WALL).exits(2).says(&["--world"]).writes_nothing();
    eval(ON_THE_WALL, &["--set", "opening"]).exits(2).says(&["KEY=VALUE"]).writes_nothing();
    eval(ON_THE_WALL, &["--truth", "/no/such.csv"]).exits(1).says(&["/no/such.csv"]).writes_nothing();
    eval("t,range\n", &[]).exits(1).says(&["standard input:1", "no column x, y"]).writes_nothing();
    eval("", &[]).exits(1).says(&["is empty"]).writes_nothing();
    atm(["eval", "/no/such.csv", "--world", "doorway"]).exits(1).says(&["/no/such.csv"]).writes_nothing();
}

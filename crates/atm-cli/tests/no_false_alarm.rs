//! Logs that are in order get no advice.

mod support;

use std::{env, path::PathBuf, process::Command};

use serde_json::{Value, json};
use support::{cases::case, recording::*, *};

const WORLDS: [&str; 9] =
    ["doorway", "closed-wall", "tee", "pole", "specular-wall", "rough-wall", "diffuse-wall", "corners", "room"];

/// No advice of `fuse` or `info`, and no word of `fuse` that is a warning.
#[track_caller]
fn is_silent(path: &str, more: &[&str]) {
    let scratch = Scratch::new();
    let counts = scratch.name("counts.json");
    let log: Vec<&str> = [path].iter().chain(more).copied().collect();
    let fuse: Vec<&str> = ["fuse"].iter().chain(&log).copied().chain(["--summary", &counts]).collect();
    let ran = atm(&fuse).exits(0);
    assert_eq!(read_json(&counts)["advice"], json!([]), "{path}");
    assert!(!ran.stderr.contains("warning"), "{}", ran.stderr);
    // What says how the log is read, and not how it is fused.
    let fused = ["--drop-held", "--estimator", "--emit"];
    let read = more.iter().position(|word| fused.contains(word)).unwrap_or(more.len());
    let info: Vec<&str> = ["info", "--json", path].iter().chain(&more[..read]).copied().collect();
    assert_eq!(of_info(&atm(&info).exits(0).json(), more.contains(&"--drop-held")), Vec::<Value>::new(), "{path}");
}

/// What `info` advises; `holds`: but for the flag that the log is fused with.
fn of_info(found: &Value, holds: bool) -> Vec<Value> {
    let advice = found["advice"].as_array().expect("a list").iter().cloned();
    advice.filter(|advice| !(holds && advice["flag"] == "--drop-held")).collect()
}

/// A file of the recordings with their licences; `None`, with a notice, where there is none.
fn data(name: &str) -> Option<String> {
    let place = env::var_os("ATM_TEST_DATA").map_or_else(|| root().join("../shared/data"), PathBuf::from);
    let path = place.join(name);
    if path.exists() {
        return Some(path.to_str().expect("a path in UTF-8").to_owned());
    }
    let notice = format!("no recording {}; set ATM_TEST_DATA", path.display());
    assert!(env::var_os("CI").is_none(), "{notice}");
    eprintln!("SKIPPED: {notice}");
    None
}

#[test]
fn the_sample() {
    is_silent(SAMPLE, &["--rig", "nomad200"]);
    is_silent(SAMPLE, &["--rig", "nomad200", "--estimator", "consensus"]);
    is_silent(SAMPLE, &["--rig", "nomad200", "--emit", "latest"]);
}

#[test]
fn eight_sonars_in_a_corridor() {
    let (Some(log), Some(poses)) = (data("udacity-sonar8/measurement.txt"), data("udacity-sonar8/poses.txt")) else {
        return;
    };
    is_silent(&log, &["--poses", &poses, "--rig", "robond8", "--drop-held"]);
}

#[test]
fn nano_drones() {
    let Some(script) = data("nano-flights/flights.py") else { return };
    let scratch = Scratch::new();
    for flight in ["two-drones", "four-drones"] {
        for pose in ["vicon", "drone"] {
            let ran = Command::new("python3").args([&script, "log", flight, "--pose", pose, "--rig"]).output();
            let Ok(ran) = ran else { return eprintln!("SKIPPED: no python3") };
            assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
            let (log, rig) = (scratch.file("log.csv", &ran.stdout), scratch.file("rig.toml", &ran.stderr));
            is_silent(&log, &["--rig", &rig]);
        }
    }
}

#[test]
fn every_world_of_the_simulator() {
    let scratch = Scratch::new();
    for world in WORLDS {
        for seed in ["1", "2"] {
            let log = scratch.name("log.csv");
            atm(["simulate", world, "-o", &log, "--seed", seed]).exits(0);
            is_silent(&log, &["--rig", "nomad200"]);
        }
    }
}

#[test]
fn recordings() {
    let scratch = Scratch::new();
    is_silent(&scratch.file("drive.mcap", drive().bytes()), &[]);
    if let Some(base) = case("recordings/base.mcap") {
        is_silent(&base, &[]);
    }
}

//! `atm view`: the page, its name, and what is said of it. What the page does is tested in a browser: `scripts/test-web`.

use std::{fs, path::Path};

use assert_cmd::Command;

const DOORWAY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/doorway.csv");

fn view(directory: &Path, args: &[&str]) -> assert_cmd::assert::Assert {
    Command::cargo_bin("atm").unwrap().current_dir(directory).arg("view").args(args).assert()
}

#[test]
fn the_page_takes_the_logs_name_and_says_the_command() {
    let directory = tempfile::tempdir().unwrap();
    let told = view(directory.path(), &[DOORWAY, "--rig", "nomad200", "--world", "doorway"]).success();
    assert!(String::from_utf8_lossy(&told.get_output().stderr).contains("784 readings in doorway.html"));
    let page = fs::read_to_string(directory.path().join("doorway.html")).unwrap();
    assert!(page.starts_with("<!doctype html>"));
    assert!(page.contains("doorway.csv --rig nomad200 --world doorway\""));
}

#[test]
fn the_page_goes_to_standard_output_where_that_is_asked_for() {
    let directory = tempfile::tempdir().unwrap();
    let told = view(directory.path(), &[DOORWAY, "--rig", "nomad200", "-o", "-", "--quiet"]).success().stderr("");
    assert!(told.get_output().stdout.ends_with(b"</html>\n"));
    assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 0);
}

#[test]
fn a_pipe_is_read_once_and_shows_the_median() {
    let directory = tempfile::tempdir().unwrap();
    let mut command = Command::cargo_bin("atm").unwrap();
    command.current_dir(directory.path()).args(["view", "-", "--rig", "nomad200"]);
    command.write_stdin(fs::read(DOORWAY).unwrap()).assert().success();
    let page = fs::read_to_string(directory.path().join("atm-view.html")).unwrap();
    assert!(page.contains("\"name\":\"atm\"") && !page.contains("\"name\":\"consensus\""));
    let mut command = Command::cargo_bin("atm").unwrap();
    command.current_dir(directory.path()).args(["view", "-", "--rig", "nomad200", "--methods", "atm,consensus"]);
    let told = command.write_stdin("").assert().code(2);
    assert!(String::from_utf8_lossy(&told.get_output().stderr).contains("--methods"));
}

#[test]
fn no_input_is_overwritten() {
    let directory = tempfile::tempdir().unwrap();
    fs::copy(DOORWAY, directory.path().join("drive.html")).unwrap();
    view(directory.path(), &["drive.html", "--rig", "nomad200"]).code(2);
    assert_eq!(fs::read(directory.path().join("drive.html")).unwrap(), fs::read(DOORWAY).unwrap());
}

#[test]
fn records_that_can_not_be_used_are_said_and_the_rest_is_shown() {
    let directory = tempfile::tempdir().unwrap();
    let log = "t,sensor,range,x,y,yaw\n0,0,2.5,0,0,0\nx,0,2.5,0,0,0\n0.1,0,2.4,0.1,0,0\n";
    fs::write(directory.path().join("drive.csv"), log).unwrap();
    let told = view(directory.path(), &["drive.csv", "--rig", "nomad200"]).code(3);
    assert!(String::from_utf8_lossy(&told.get_output().stderr).contains("unusable  1 records"));
    assert!(directory.path().join("drive.html").exists());
}

//! Many logs at once: each on its own, whatever becomes of the others.

mod support;

use std::fs;

use support::*;

/// Three logs of different formats and contents, and where they are.
fn logs(scratch: &Scratch) -> [String; 3] {
    let half: String = sample().lines().take(400).map(|line| format!("{line}\n")).collect();
    [
        scratch.file("whole.csv", sample()),
        scratch.file("half.csv", half),
        scratch.file("ros.mcap", recording::drive().bytes()),
    ]
}

fn fleet(logs: &[String], directory: &str, more: &[&str]) -> Ran {
    let line = ["fuse", "--rig", "nomad200", "--out-dir", directory].map(str::to_owned);
    atm(line.iter().chain(logs).map(String::as_str).chain(more.iter().copied()))
}

#[test]
fn each_log_gives_what_it_gives_alone_whatever_runs_beside_it() {
    let scratch = Scratch::new();
    let [whole, half, _] = logs(&scratch);
    let alone = [&whole, &half].map(|log| atm(["fuse", log, "--rig", "nomad200"]).exits(0).stdout);
    for jobs in ["1", "2", "16"] {
        let directory = scratch.name(&format!("out{jobs}"));
        fleet(&[whole.clone(), half.clone()], &directory, &["-j", jobs]).exits(0).writes_nothing();
        for (name, expected) in ["whole.csv", "half.csv"].iter().zip(&alone) {
            assert_eq!(&fs::read(format!("{directory}/{name}")).expect("its echoes"), expected, "-j {jobs} {name}");
        }
        assert_eq!(fs::read_dir(&directory).expect("the directory").count(), 2, "nothing is left beside them");
    }
}

#[test]
fn recordings_become_recordings_and_tables_tables_unless_said() {
    let scratch = Scratch::new();
    let log = scratch.file("ros.mcap", recording::drive().bytes());
    for (more, name) in [(&[][..], "ros.mcap"), (&["--to", "csv"], "ros.csv")] {
        let directory = scratch.name(&format!("out{}", more.len()));
        let line = ["fuse", &log, "--out-dir", &directory];
        atm(line.iter().chain(more)).exits(0);
        let alone = scratch.name(&format!("alone-{name}"));
        atm(["fuse", &log, "-o", &alone].iter().chain(more)).exits(0);
        assert!(fs::read(format!("{directory}/{name}")).expect("its echoes") == fs::read(alone).expect("its echoes"));
    }
}

#[test]
fn a_bad_log_fails_alone() {
    let scratch = Scratch::new();
    let [whole, half, _] = logs(&scratch);
    let (headless, missing) = (scratch.file("headless.csv", "t,sensor\n1,2\n"), scratch.name("missing.csv"));
    let directory = scratch.name("out");
    let ran = fleet(&[headless.clone(), whole, missing.clone(), half], &directory, &["-j", "2"]).exits(1);
    ran.says(&[&headless, "range", &missing, "2 of 4 logs"]);
    for name in ["whole.csv", "half.csv"] {
        assert!(read(&format!("{directory}/{name}")).lines().count() > 100, "{name}");
    }
}

#[test]
fn what_is_told_stands_in_the_order_of_the_command_line() {
    let scratch = Scratch::new();
    let [whole, half, _] = logs(&scratch);
    let ran = fleet(&[whole.clone(), half.clone()], &scratch.name("out"), &["-j", "2"]).exits(0);
    let places = [&whole, &half].map(|log| ran.stderr.find(&format!("{log} -> ")).expect("it is named"));
    assert!(places[0] < places[1], "{}", ran.stderr);
    assert_eq!(ran.stderr.matches("readings  ").count(), 2, "{}", ran.stderr);
}

#[test]
fn a_log_with_unusable_records_is_partly_done() {
    let scratch = Scratch::new();
    let [whole, ..] = logs(&scratch);
    let flawed = scratch.file("flawed.csv", sample() + "50,0,word,0,0,0\n");
    fleet(&[whole, flawed.clone()], &scratch.name("out"), &["--quiet"]).exits(3).says(&[&flawed, "\"word\""]);
}

#[test]
fn outputs_that_would_meet_are_refused_before_anything_is_done() {
    let scratch = Scratch::new();
    let [whole, half, _] = logs(&scratch);
    fs::create_dir(scratch.name("other")).expect("a directory");
    let same = scratch.file("other/whole.csv", sample());
    let directory = scratch.name("out");
    fleet(&[whole.clone(), same.clone()], &directory, &[]).exits(2).says(&[&whole, &same, "out/whole.csv"]);
    assert!(!fs::exists(&directory).expect("its parent"));
    let here = scratch.name(".");
    fleet(&[half, whole.clone()], &here, &[]).exits(2).says(&["overwrite the input"]);
    assert_eq!(read(&whole), sample());
}

#[test]
fn arguments_that_do_not_go_together_are_refused() {
    let scratch = Scratch::new();
    let [whole, half, _] = logs(&scratch);
    let directory = scratch.name("out");
    fleet(&["-".into()], &directory, &[]).exits(2).says(&["needs logs with names"]);
    atm(["fuse", &whole, &half, "--rig", "nomad200"]).exits(2).says(&["--out-dir"]);
    atm(["fuse", &whole, "--rig", "nomad200", "-j", "2"]).exits(2);
    fleet(std::slice::from_ref(&whole), &directory, &["-j", "0"]).exits(2);
    for more in [["-o", "x.csv"], ["--crossings", "x.csv"], ["--summary", "x.json"], ["--poses", "x.csv"]] {
        fleet(std::slice::from_ref(&whole), &directory, &more).exits(2);
    }
}

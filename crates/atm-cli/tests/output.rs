//! Where the echoes go: files, pipes, devices, and what is left of a run that fails.

mod support;

use std::{
    fs,
    io::{BufRead, BufReader, Read, Write},
    process::{Command, Stdio},
    sync::mpsc,
    thread,
    time::{Duration, Instant},
};

use support::*;

/// Far longer than it takes to fuse a few rows, and a bound on how long a test waits for them.
const WAIT: Duration = Duration::from_secs(20);

/// The sample with a bad record as line 600 of 786.
fn broken_sample() -> String {
    let log = sample();
    let mut lines: Vec<&str> = log.lines().collect();
    lines.insert(599, "37,3,bad,0,0,0");
    lines.join("\n") + "\n"
}

/// Fails with `--strict` on the broken sample: what is under the output's name, and what is left beside it.
fn fail_strictly(emit: &str) -> (Scratch, String, String) {
    let scratch = Scratch::new();
    let log = scratch.file("drive.csv", broken_sample());
    let out = scratch.name("echoes.csv");
    let ran = atm(["fuse", &log, "--rig", "nomad200", "--strict", "--emit", emit, "-o", &out]).exits(1);
    ran.says(&[&format!("{log}:600"), "\"bad\"", &format!("{out}.partial")]).writes_nothing();
    let partial = read(&format!("{out}.partial"));
    (scratch, out, partial)
}

#[test]
fn strict_ends_at_the_first_bad_record_and_leaves_no_file_under_the_name() {
    for emit in ["settled", "latest"] {
        let (scratch, _, _) = fail_strictly(emit);
        assert_eq!(scratch.list(), ["drive.csv", "echoes.csv.partial"]);
    }
}

#[test]
fn what_a_strict_run_leaves_is_how_the_lenient_output_begins() {
    for (emit, echoes) in [("settled", 300), ("latest", 400)] {
        let (_scratch, _, partial) = fail_strictly(emit);
        let lenient = fuse_text(broken_sample(), &["--emit", emit]).exits(3);
        // Every echo that was computed before the failure is there.
        assert!(partial.lines().count() > echoes, "{emit}: {}", partial.lines().count());
        assert!(lenient.text().starts_with(&partial), "{emit}");
    }
}

#[test]
fn a_strict_run_over_a_good_log_is_done() {
    fuse_sample(&["--strict"]).exits(0).writes(fuse_sample(&[]).stdout);
}

#[test]
fn a_failed_run_leaves_an_older_output_as_it_was() {
    let scratch = Scratch::new();
    let out = scratch.file("echoes.csv", "older\n");
    fuse_text(broken_sample(), &["--strict", "-o", &out]).exits(1);
    assert_eq!(read(&out), "older\n");
    // A later run that is done takes its place, and clears what was left.
    fuse_sample(&["-o", &out]).exits(0);
    assert_same(read(&out).as_bytes(), &fuse_sample(&[]).stdout);
    assert_eq!(scratch.list(), ["echoes.csv"]);
}

#[test]
fn a_failed_run_leaves_its_crossings_beside_their_name_too() {
    let scratch = Scratch::new();
    let (out, crossings) = (scratch.name("echoes.csv"), scratch.name("crossings.csv"));
    let ran = fuse_text(broken_sample(), &["--strict", "-o", &out, "--crossings", &crossings]).exits(1);
    ran.says(&[&format!("{out}.partial"), &format!("{crossings}.partial")]);
    assert_eq!(scratch.list(), ["crossings.csv.partial", "echoes.csv.partial"]);
    assert!(read(&format!("{crossings}.partial")).starts_with(CROSSINGS_HEADER));
}

#[test]
fn a_killed_run_leaves_what_it_had_written_beside_the_name() {
    let scratch = Scratch::new();
    let (out, partial) = (scratch.name("echoes.csv"), scratch.name("echoes.csv.partial"));
    let mut child = Command::new(env!("CARGO_BIN_EXE_atm"))
        .args(FUSE_STDIN.iter().chain(&["--emit", "latest", "-o", &out]))
        .stdin(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("atm starts");
    let begun: String = sample().split_inclusive('\n').take(400).collect();
    let expected = fuse_text(&begun, &["--emit", "latest"]).exits(0).stdout;
    child.stdin.as_mut().expect("its input").write_all(begun.as_bytes()).expect("the command reads on");
    let end = Instant::now() + WAIT;
    while fs::read(&partial).unwrap_or_default() != expected && Instant::now() < end {
        thread::sleep(Duration::from_millis(10));
    }
    child.kill().expect("its end");
    child.wait().expect("its end");
    assert_eq!(scratch.list(), ["echoes.csv.partial"]);
    assert_same(read(&partial).as_bytes(), &expected);
}

#[test]
fn a_run_that_used_only_part_of_its_input_is_done_all_the_same() {
    let scratch = Scratch::new();
    let out = scratch.name("echoes.csv");
    fuse_text(broken_sample(), &["-o", &out]).exits(3);
    assert_eq!(scratch.list(), ["echoes.csv"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_a_failure() {
    fuse_sample(&["-o", "/dev/full"]).exits(1).says(&["/dev/full", "No space left"]);
    let full = fs::OpenOptions::new().write(true).open("/dev/full").expect("/dev/full");
    let mut command = Command::new(env!("CARGO_BIN_EXE_atm"));
    let output = command.args(FUSE).current_dir(root()).stdout(full).output().expect("atm runs");
    assert_eq!(output.status.code(), Some(1));
    let words = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(words.contains("standard output") && words.contains("No space left"), "{words}");
}

#[test]
fn outputs_that_would_destroy_an_input_or_each_other_are_refused() {
    let scratch = Scratch::new();
    let log = scratch.file("drive.csv", sample());
    let rig = ["fuse", &log, "--rig", "nomad200"];
    let refused = |more: &[&str], word: &str| {
        atm(rig.iter().chain(more)).exits(2).says(&[word]).writes_nothing();
    };
    refused(&["-o", &log], &log);
    refused(&["--crossings", &log], &log);
    refused(&["--summary", &log], &log);
    let out = scratch.name("echoes.csv");
    refused(&["-o", &out, "--crossings", &out], &out);
    refused(&["-o", &out, "--summary", &out], &out);
    refused(&["--summary", "-"], "two outputs");
    assert_same(read(&log).as_bytes(), sample().as_bytes());
    assert_eq!(scratch.list(), ["drive.csv"]);
}

#[test]
fn counts_may_go_to_standard_output_where_the_echoes_do_not() {
    let scratch = Scratch::new();
    let out = scratch.name("echoes.csv");
    let counts = fuse_sample(&["-o", &out, "--summary", "-"]).exits(0).json();
    assert_eq!(tally(&counts, "/written") as usize, echoes(&read(&out)).len());
}

#[cfg(unix)]
#[test]
fn a_link_to_the_input_is_the_input() {
    let scratch = Scratch::new();
    let (log, link) = (scratch.file("drive.csv", sample()), scratch.name("link.csv"));
    std::os::unix::fs::symlink(&log, &link).expect("a link");
    atm(["fuse", &log, "--rig", "nomad200", "-o", &link]).exits(2).says(&[&link]);
    assert_same(read(&log).as_bytes(), sample().as_bytes());
}

#[test]
fn outputs_that_can_not_be_written_are_named() {
    let scratch = Scratch::new();
    let lost = scratch.name("nowhere/file");
    fuse_sample(&["-o", &lost]).exits(1).says(&[&lost, "does not exist"]).writes_nothing();
    fuse_sample(&["--crossings", &lost]).exits(1).says(&[&lost, "does not exist"]);
    fuse_sample(&["--summary", &lost]).exits(1).says(&[&lost, "does not exist"]);
    let directory = scratch.name("");
    fuse_sample(&["-o", &directory]).exits(1).says(&["directory"]).writes_nothing();
    assert_eq!(scratch.list(), [""; 0]);
}

#[test]
fn a_reader_that_closes_early_is_no_error() {
    let scratch = Scratch::new();
    // Far more than a pipe holds, so that the writer surely meets the closed end.
    let repeated: String =
        sample_rows().iter().map(|row| format!("0,{},{},{},0,0\n", row.sensor, row.range, row.x)).collect();
    let log = scratch.file("long.csv", format!("t,sensor,range,x,y,yaw\n{}", repeated.repeat(20)));
    for more in [&["--emit", "latest"][..], &["--emit", "settled"], &["--emit", "latest", "--quiet"]] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_atm"))
            .args(["fuse", &log, "--rig", "nomad200"].iter().chain(more))
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("atm starts");
        let mut first = String::new();
        let mut reader = BufReader::new(child.stdout.take().expect("its output"));
        reader.read_line(&mut first).expect("a line");
        drop(reader);
        let mut words = String::new();
        child.stderr.take().expect("its messages").read_to_string(&mut words).expect("UTF-8");
        assert_eq!(child.wait().expect("its end").code(), Some(0), "{more:?}: {words}");
        assert_eq!((first.trim_end(), words.as_str()), (HEADER, ""), "{more:?}");
    }
}

/// Collects what comes until there are `bytes`, or [`WAIT`] is over.
fn receive(chunks: &mpsc::Receiver<Vec<u8>>, received: &mut Vec<u8>, bytes: usize) {
    let end = Instant::now() + WAIT;
    while received.len() < bytes {
        match chunks.recv_timeout(end.saturating_duration_since(Instant::now())) {
            Ok(chunk) => received.extend(chunk),
            Err(_) => return,
        }
    }
}

#[test]
fn latest_delivers_the_echoes_of_all_rows_before_it_waits_for_more() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_atm"))
        .args(FUSE_STDIN.iter().chain(&["--emit", "latest", "-o", "-"]))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("atm starts");
    let (mut input, mut output) = (child.stdin.take().expect("its input"), child.stdout.take().expect("its output"));
    let (sender, chunks) = mpsc::channel();
    let reader = thread::spawn(move || {
        let mut buffer = [0; 4096];
        while let Ok(count @ 1..) = output.read(&mut buffer) {
            if sender.send(buffer[..count].to_vec()).is_err() {
                return;
            }
        }
    });
    let log = sample();
    let lines: Vec<&str> = log.split_inclusive('\n').collect();
    let (mut sent, mut received) = (0, Vec::new());
    // The header alone; a row; sweeps; and half a row behind whole ones, which must not hold these up.
    for rows in [1, 2, 17, 60, 400, lines.len()] {
        let so_far: String = lines[..rows].concat();
        let half = lines.get(rows).map_or("", |line| &line[..line.len() / 2]);
        let offered = so_far.clone() + half;
        input.write_all(&offered.as_bytes()[sent..]).expect("the command reads on");
        input.flush().expect("the command reads on");
        sent = offered.len();
        let expected = fuse_text(so_far, &["--emit", "latest"]).stdout;
        receive(&chunks, &mut received, expected.len());
        assert_same(&received, &expected);
    }
    drop(input);
    assert!(child.wait().expect("its end").success());
    reader.join().expect("the reader's end");
}

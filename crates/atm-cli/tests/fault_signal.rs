//! Signals: Ctrl-C and SIGTERM end a run that then says what it kept; SIGKILL leaves a beginning of the output.
#![cfg(unix)]

mod support;

use std::{
    fs::{self, File},
    io::{Read, Write},
    os::unix::process::ExitStatusExt,
    process::{Command, Stdio},
    thread,
    time::Duration,
};

use support::{fault::*, *};

const SIGINT: i32 = 2;
const SIGKILL: i32 = 9;
const SIGTERM: i32 = 15;

/// A run that has fused the first rows of the sample from a pipe and waits for more: the outputs are what they come to.
fn waiting(scratch: &Scratch, emit: &str, rows: usize) -> (Running, String) {
    let begun: String = sample().split_inclusive('\n').take(rows).collect();
    let (out, counts) = (scratch.name("echoes.csv"), scratch.name("counts.json"));
    let args = ["fuse", "-", "--rig", "nomad200", "--emit", emit, "-o", &out, "--summary", &counts];
    let mut running = Running::start(&args, Stdio::piped(), Stdio::null());
    let expected = match emit {
        "latest" => undisturbed(&begun, &["--emit", emit]),
        // What is in the local map is not reported: one more reading could still change it.
        _ => settled_so_far(&begun),
    };
    running.0.stdin.as_mut().expect("its input").write_all(begun.as_bytes()).expect("the command reads on");
    let partial = format!("{out}.partial");
    running.until(|| fs::read_to_string(&partial).unwrap_or_default() == expected);
    (running, expected)
}

/// The echoes that have left the local map behind the last of these rows: those that a run writes which a bad record ends.
fn settled_so_far(begun: &str) -> String {
    let ran = fuse_text(format!("{begun}bad\n"), &["--strict"]).exits(1);
    ran.text().to_owned()
}

#[test]
fn ctrl_c_and_sigterm_end_a_run_that_waits_and_it_says_what_it_kept() {
    for (name, number, emit) in [("INT", SIGINT, "latest"), ("TERM", SIGTERM, "settled")] {
        let scratch = Scratch::new();
        let (running, expected) = waiting(&scratch, emit, 500);
        running.signal(name);
        let partial = format!("{}.partial", scratch.name("echoes.csv"));
        let ended = running.ends().says(&[&format!("ended by SIG{name}"), &partial, "readings  499 in the local map"]);
        assert_eq!(ended.status.signal(), Some(number), "{}", ended.stderr);
        assert_same(read(&partial).as_bytes(), expected.as_bytes());
        assert_eq!(scratch.list(), ["counts.json", "echoes.csv.partial"]);
        let written = expected.lines().count() as u64 - 1;
        assert_eq!(tally(&read_json(&scratch.name("counts.json")), "/written"), written);
    }
}

/// Ends runs over a file at some moments, the same ones on every run of the test but for the machine's mood.
fn at_some_moments(signal: &str, number: i32, emit: &str, moments_ms: &[u64]) {
    let scratch = Scratch::new();
    let text = drive(100_000);
    let log = scratch.file("drive.csv", &text);
    let expected = undisturbed(&text, &["--emit", emit]);
    let (out, counts) = (scratch.name("echoes.csv"), scratch.name("counts.json"));
    let partial = format!("{out}.partial");
    let args = ["fuse", &log, "--rig", "nomad200", "--emit", emit, "-o", &out, "--summary", &counts];
    let mut ended_early = 0;
    for &moment in moments_ms {
        let running = Running::start(&args, Stdio::null(), Stdio::null());
        // Before that, nothing is promised.
        running.until(|| fs::metadata(&partial).is_ok() || fs::metadata(&out).is_ok());
        thread::sleep(Duration::from_millis(moment));
        running.signal(signal);
        let ended = running.ends();
        if ended.status.success() {
            assert_same(read(&out).as_bytes(), expected.as_bytes());
        } else {
            ended_early += 1;
            assert_eq!(ended.status.signal(), Some(number), "{}", ended.stderr);
            // Complete already, and only the counts were not.
            let complete = fs::exists(&out).expect("the directory");
            let bytes = begins(if complete { &out } else { &partial }, &expected);
            assert!(!complete || bytes == expected.len(), "a file under the name that is not whole");
            if number != SIGKILL && ended.stderr.contains("ended by") {
                // Every echo that was computed is there, to its end.
                let written = tally(&read_json(&counts), "/written") as usize;
                assert_eq!(expected[..bytes].lines().count(), written + 1);
                assert!(expected[..bytes].ends_with('\n'));
            }
        }
        for file in [&out, &partial, &counts, &format!("{counts}.partial")] {
            let _ = fs::remove_file(file);
        }
    }
    assert!(ended_early > 0, "no run was ended early: longer logs are needed");
}

#[test]
fn at_whatever_moment_ctrl_c_comes_every_echo_so_far_is_kept() {
    at_some_moments("INT", SIGINT, "settled", &[3, 1, 17, 41, 8, 90, 29, 60]);
}

#[test]
fn at_whatever_moment_sigterm_comes_every_echo_so_far_is_kept() {
    at_some_moments("TERM", SIGTERM, "latest", &[2, 13, 5, 70, 33, 21, 50, 110]);
}

#[test]
fn at_whatever_moment_sigkill_comes_a_beginning_of_the_output_is_kept() {
    at_some_moments("KILL", SIGKILL, "settled", &[1, 11, 47, 23, 80, 5, 35, 64]);
}

#[test]
fn what_sigkill_leaves_of_a_run_that_waits_is_every_echo() {
    for emit in ["settled", "latest"] {
        let scratch = Scratch::new();
        let (running, expected) = waiting(&scratch, emit, 700);
        running.signal("KILL");
        assert_eq!(running.ends().status.signal(), Some(SIGKILL));
        assert_same(read(&scratch.name("echoes.csv.partial")).as_bytes(), expected.as_bytes());
    }
}

#[test]
fn a_second_ctrl_c_ends_a_run_that_can_not_get_rid_of_its_output() {
    let scratch = Scratch::new();
    // Far more than a pipe holds, and nobody reads it.
    let log = scratch.file("drive.csv", drive(30_000));
    let mut running = Running::start(&["fuse", &log, "--rig", "nomad200"], Stdio::null(), Stdio::piped());
    let mut first = [0; 1];
    running.0.stdout.as_mut().expect("its output").read_exact(&mut first).expect("a byte");
    thread::sleep(Duration::from_millis(50));
    running.signal("INT");
    thread::sleep(Duration::from_millis(50));
    running.signal("INT");
    assert_eq!(running.ends().status.signal(), Some(SIGINT));
}

#[test]
fn a_run_that_was_told_to_ignore_ctrl_c_ignores_it() {
    let scratch = Scratch::new();
    let (out, partial) = (scratch.name("echoes.csv"), scratch.name("echoes.csv.partial"));
    let mut command = Command::new("sh");
    command.args(["-c", "trap '' INT; exec \"$0\" \"$@\"", env!("CARGO_BIN_EXE_atm")]);
    command.args(FUSE_STDIN).args(["--emit", "latest", "-o", &out]);
    let mut running = Running::start_as(&mut command, Stdio::piped(), Stdio::null());
    let log = sample();
    let (begun, rest) = log.split_at(log.len() / 2);
    let mut input = running.0.stdin.take().expect("its input");
    input.write_all(begun.as_bytes()).expect("the command reads on");
    running.until(|| fs::metadata(&partial).is_ok_and(|partial| partial.len() > 1000));
    running.signal("INT");
    input.write_all(rest.as_bytes()).expect("the command reads on");
    drop(input);
    running.ends().exits(0);
    assert_same(read(&out).as_bytes(), undisturbed(&log, &["--emit", "latest"]).as_bytes());
}

/// A pipe with a name.
fn named_pipe(scratch: &Scratch, name: &str) -> String {
    let pipe = scratch.name(name);
    assert!(Command::new("mkfifo").arg(&pipe).status().expect("mkfifo").success());
    pipe
}

#[test]
fn ctrl_c_ends_the_wait_for_a_named_pipe_too() {
    let scratch = Scratch::new();
    let (pipe, out) = (named_pipe(&scratch, "log"), scratch.name("echoes.csv"));
    let running = Running::start(&["fuse", &pipe, "--rig", "nomad200", "-o", &out], Stdio::null(), Stdio::null());
    let mut input = File::options().write(true).open(&pipe).expect("the command opens it, too");
    let begun: String = sample().split_inclusive('\n').take(300).collect();
    input.write_all(begun.as_bytes()).expect("the command reads on");
    let (partial, expected) = (format!("{out}.partial"), settled_so_far(&begun));
    running.until(|| fs::read_to_string(&partial).unwrap_or_default() == expected);
    running.signal("INT");
    let ended = running.ends().says(&["ended by SIGINT", &partial]);
    assert_eq!(ended.status.signal(), Some(SIGINT));
    assert_same(read(&partial).as_bytes(), expected.as_bytes());
}

#[test]
fn of_many_logs_ctrl_c_keeps_those_that_are_fused_and_begins_no_more() {
    let scratch = Scratch::new();
    let (whole, next) = (scratch.file("whole.csv", sample()), scratch.file("next.csv", sample()));
    let (pipe, directory) = (named_pipe(&scratch, "pipe.csv"), scratch.name("out"));
    let args = ["fuse", &whole, &pipe, &next, "--rig", "nomad200", "--out-dir", &directory, "-j", "1"];
    let running = Running::start(&args, Stdio::null(), Stdio::null());
    let mut input = File::options().write(true).open(&pipe).expect("the command opens it, too");
    let begun: String = sample().split_inclusive('\n').take(300).collect();
    input.write_all(begun.as_bytes()).expect("the command reads on");
    let (partial, expected) = (format!("{directory}/pipe.csv.partial"), settled_so_far(&begun));
    running.until(|| fs::read_to_string(&partial).unwrap_or_default() == expected);
    running.signal("INT");
    let ended = running.ends().says(&["ended by SIGINT: 1 of 3 logs are fused", &partial]);
    assert_eq!(ended.status.signal(), Some(SIGINT));
    assert_same(read(&partial).as_bytes(), expected.as_bytes());
    assert_same(read(&format!("{directory}/whole.csv")).as_bytes(), undisturbed(&sample(), &[]).as_bytes());
    assert_eq!(fs::read_dir(&directory).expect("the directory").count(), 2, "no more was begun");
}

#[test]
fn one_ctrl_c_ends_all_of_many_logs_that_were_begun_at_once() {
    let scratch = Scratch::new();
    let pipes: Vec<String> = (0..8).map(|index| named_pipe(&scratch, &format!("{index}.csv"))).collect();
    let directory = scratch.name("out");
    let options = ["--rig", "nomad200", "--out-dir", &directory, "-j", "8"];
    let args: Vec<&str> = ["fuse"].into_iter().chain(pipes.iter().map(String::as_str)).chain(options).collect();
    let running = Running::start(&args, Stdio::null(), Stdio::null());
    let open = |pipe| File::options().write(true).open(pipe).expect("the command opens it, too");
    let mut inputs: Vec<File> = pipes.iter().map(open).collect();
    let begun: String = sample().split_inclusive('\n').take(300).collect();
    for input in &mut inputs {
        input.write_all(begun.as_bytes()).expect("the command reads on");
    }
    let partials: Vec<String> = (0..8).map(|index| format!("{directory}/{index}.csv.partial")).collect();
    let expected = settled_so_far(&begun);
    running.until(|| partials.iter().all(|partial| fs::read_to_string(partial).unwrap_or_default() == expected));
    running.signal("TERM");
    let said: Vec<&str> = partials.iter().map(String::as_str).chain(["0 of 8 logs are fused"]).collect();
    assert_eq!(running.ends().says(&said).status.signal(), Some(SIGTERM));
}

//! Recordings that the command writes: by name, by format, down a pipe, and what a killed run leaves.

mod support;

use std::{
    fs,
    io::Write,
    process::{Command, Stdio},
    thread,
    time::{Duration, Instant},
};

use support::{FUSE_STDIN, SAMPLE, Scratch, assert_same, atm, fuse_sample, fuse_text, read, sample};

const MAGIC: &[u8] = b"\x89MCAP0\r\n";
/// Longer than anything here takes.
const WAIT: Duration = Duration::from_secs(60);

fn is_whole(file: &[u8]) -> bool {
    file.starts_with(MAGIC) && file.ends_with(MAGIC) && file.len() > 2 * MAGIC.len()
}

#[test]
fn an_output_called_mcap_is_a_recording_and_the_format_asked_for_wins() {
    let scratch = Scratch::new();
    let (recording, table) = (scratch.name("echoes.mcap"), scratch.name("table.MCAP"));
    fuse_sample(&["-o", &recording]).exits(0).says(&["253 median"]).writes_nothing();
    let file = fs::read(&recording).unwrap();
    assert!(is_whole(&file));
    fuse_sample(&["-o", &table, "--to", "csv"]).exits(0);
    assert_same(read(&table).as_bytes(), &fuse_sample(&[]).stdout);
    // Down a pipe they are the same bytes.
    assert!(fuse_sample(&["--to", "mcap"]).exits(0).stdout == file);
    assert!(fuse_text(sample(), &["--to", "mcap"]).exits(0).stdout == file);
    assert!(fuse_sample(&["--to", "mcap", "--schema", "ros2"]).exits(0).stdout != file);
    fuse_sample(&["--schema", "ros3"]).exits(2).says(&["foxglove", "ros2"]);
}

#[test]
fn crossings_go_to_a_recording_or_a_table_whatever_the_echoes_go_to() {
    let scratch = Scratch::new();
    let names = ["echoes.mcap", "crossings.csv", "echoes.csv", "crossings.mcap"].map(|name| scratch.name(name));
    let [echoes_mcap, crossings_csv, echoes_csv, crossings_mcap] = &names;
    fuse_sample(&["-o", echoes_mcap, "--crossings", crossings_csv]).exits(0);
    fuse_sample(&["-o", echoes_csv, "--crossings", crossings_mcap]).exits(0);
    assert!(is_whole(&fs::read(echoes_mcap).unwrap()) && is_whole(&fs::read(crossings_mcap).unwrap()));
    let crossings = scratch.name("expected.csv");
    let echoes = fuse_sample(&["--crossings", &crossings]).exits(0).stdout;
    assert_same(read(echoes_csv).as_bytes(), &echoes);
    assert_same(read(crossings_csv).as_bytes(), read(&crossings).as_bytes());
}

#[test]
fn a_run_that_fails_names_what_it_had() {
    let scratch = Scratch::new();
    let (log, out) = (scratch.file("drive.csv", sample() + "bad\n"), scratch.name("echoes.mcap"));
    atm(["fuse", &log, "--rig", "nomad200", "--strict", "-o", &out]).exits(1).says(&[&format!("{out}.partial")]);
    assert_eq!(scratch.list(), ["drive.csv", "echoes.mcap.partial"]);
    let left = fs::read(format!("{out}.partial")).unwrap();
    assert!(left.starts_with(MAGIC) && !left.ends_with(MAGIC), "it must not look whole");
    assert!(left.len() > 10_000, "most of it had been fused");
}

#[test]
fn a_killed_run_leaves_no_file_under_the_name() {
    let scratch = Scratch::new();
    let (out, partial) = (scratch.name("echoes.mcap"), scratch.name("echoes.mcap.partial"));
    let mut child = Command::new(env!("CARGO_BIN_EXE_atm"))
        .args(FUSE_STDIN.iter().chain(&["-o", &out]))
        .stdin(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("atm starts");
    child.stdin.as_mut().expect("its input").write_all(sample().as_bytes()).expect("the command reads on");
    let end = Instant::now() + WAIT;
    while !fs::exists(&partial).unwrap() && Instant::now() < end {
        thread::sleep(Duration::from_millis(10));
    }
    child.kill().expect("its end");
    child.wait().expect("its end");
    assert_eq!(scratch.list(), ["echoes.mcap.partial"]);
}

#[test]
fn a_reader_that_closes_early_is_no_error() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_atm"))
        .args(["fuse", SAMPLE, "--rig", "nomad200", "--to", "mcap"])
        .current_dir(support::root())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("atm starts");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("its end");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

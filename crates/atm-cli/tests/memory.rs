//! Memory does not grow with the log. The peak is read from the running command, once it has used all that was sent.
#![cfg(target_os = "linux")]

mod support;

use std::{
    fs,
    io::{BufWriter, Write},
    process::{Child, ChildStdin, Command, Stdio},
};

use support::*;

/// Most memory any run here may take, in KiB.
const MOST: u64 = 64 * 1024;
/// How far apart two peaks may lie and still be equal, in KiB.
const EQUAL: u64 = 1024;
/// More than pipe and reader hold: when so many blank lines were taken, everything before them was used.
const PADDING: usize = 2 << 20;

/// Runs the command on what `feed` writes. Returns its peak memory in KiB, and its exit status.
fn peak(args: &[&str], feed: impl FnOnce(&mut BufWriter<ChildStdin>)) -> (u64, Option<i32>) {
    let mut child = Command::new(env!("CARGO_BIN_EXE_atm"))
        .args(args)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("atm starts");
    let mut input = BufWriter::new(child.stdin.take().expect("its input"));
    feed(&mut input);
    input.write_all(&vec![b'\n'; PADDING]).and_then(|()| input.flush()).expect("the command reads on");
    let peak = high_water_mark(&child);
    drop(input);
    (peak, child.wait().expect("its end").code())
}

fn high_water_mark(child: &Child) -> u64 {
    let status = fs::read_to_string(format!("/proc/{}/status", child.id())).expect("the running command");
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).expect("its peak");
    line.trim().trim_end_matches(" kB").parse().expect("a number")
}

/// Writes the sample's drive again and again, time going on, until there are `count` rows.
fn drive(input: &mut impl Write, count: usize) {
    let rows: Vec<(u64, String)> = sample_rows()
        .into_iter()
        .map(|Row { t, sensor, range, x, y, yaw }| (number(&t) as u64, format!("{sensor},{range},{x},{y},{yaw}")))
        .collect();
    input.write_all(b"t,sensor,range,x,y,yaw\n").expect("the command reads on");
    for (index, (t, row)) in rows.iter().cycle().take(count).enumerate() {
        let t = t + 49 * (index / rows.len()) as u64;
        writeln!(input, "{t},{row}").expect("the command reads on");
    }
}

#[track_caller]
fn peaks_are_equal(args: &[&str]) {
    let [small, large] = [100_000, 1_000_000].map(|count| {
        let (peak, status) = peak(args, |input| drive(input, count));
        assert_eq!(status, Some(0));
        peak
    });
    println!("{args:?}: {small} KiB at 100,000 rows, {large} KiB at 1,000,000");
    assert!(small.abs_diff(large) <= EQUAL, "{small} KiB at 100,000 rows, {large} KiB at 1,000,000");
    assert!(small.max(large) < MOST, "{large} KiB");
}

#[test]
fn settled_takes_the_same_memory_for_ten_times_the_rows() {
    peaks_are_equal(&["fuse", "-", "--rig", "nomad200", "--emit", "settled"]);
}

#[test]
fn latest_takes_the_same_memory_for_ten_times_the_rows() {
    peaks_are_equal(&["fuse", "-", "--rig", "nomad200", "--emit", "latest", "--crossings", "/dev/null"]);
}

#[test]
fn info_takes_the_same_memory_for_ten_times_the_rows() {
    peaks_are_equal(&["info", "-"]);
}

#[test]
fn a_line_of_100_mb_is_passed_over_and_the_rows_behind_it_are_used() {
    let scratch = Scratch::new();
    let (out, counts) = (scratch.name("echoes.csv"), scratch.name("counts.json"));
    let args = ["fuse", "-", "--rig", "nomad200", "-o", &out, "--summary", &counts];
    let log = sample();
    let (header, rows) = log.split_once('\n').expect("a header");
    let (peak, status) = peak(&args, |input| {
        writeln!(input, "{header}").expect("the command reads on");
        let block = vec![b'7'; 1 << 20];
        for _ in 0..100 {
            input.write_all(&block).expect("the command reads on");
        }
        write!(input, "\n{rows}").expect("the command reads on");
    });
    assert_eq!(status, Some(3));
    assert_eq!(read_json(&counts)["dropped"], serde_json::json!({ "too_long": 1 }));
    assert_same(read(&out).as_bytes(), &fuse_sample(&[]).stdout);
    println!("a line of 100 MB: {peak} KiB");
    assert!(peak < MOST, "{peak} KiB");
}

#[test]
fn a_file_of_100_mb_without_a_line_end_is_refused_in_bounded_memory() {
    let mut block = vec![b','; 1 << 20];
    block[0] = b't';
    let mut child = Command::new(env!("CARGO_BIN_EXE_atm"))
        .args(FUSE_STDIN)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("atm starts");
    let mut input = child.stdin.take().expect("its input");
    let mut most = 0;
    for _ in 0..100 {
        most = most.max(high_water_mark(&child));
        // It may give up before it was sent everything.
        if input.write_all(&block).is_err() {
            break;
        }
    }
    drop(input);
    let output = child.wait_with_output().expect("its end");
    let words = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{words}");
    assert!(words.contains("standard input:1") && !words.contains("panicked"), "{words}");
    assert!(most < MOST, "{most} KiB");
}

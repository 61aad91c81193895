//! Memory does not grow with a recording, of which most is what nobody asked for. The peak is read from the running command,
//! once it has used all readings.
#![cfg(target_os = "linux")]

mod support;

use std::{
    fs,
    io::Write,
    process::{Child, Command, Stdio},
};

use mcap::Compression;
use support::{recording::*, *};

/// Most memory any run here may take, in KiB.
const MOST: u64 = 96 * 1024;
/// How far apart two peaks may lie and still be equal, in KiB.
const EQUAL: u64 = 2048;
/// What a handful of chunks take, in KiB.
const AHEAD: u64 = 16 * 1024;
/// What nobody asked for, in one message.
const IMAGE_BYTES: usize = 1 << 20;

/// The drive with an image for each instant, again and again, time going on; at the end more than pipe and command hold.
fn long(times: usize, layout: Layout) -> Vec<u8> {
    let mut recording = Recording::default();
    for round in 0..times {
        let later = 60_000_000_000 * round as u64;
        for message in drive().messages {
            if round > 0 && message.topic == "/tf_static" {
                continue;
            }
            let mut data = message.data;
            // The stamp: of the header itself, or of the one transform.
            let at = if message.topic.starts_with("/tf") { 8 } else { 4 };
            if let Some(seconds) = data.get_mut(at..at + 4) {
                let t = u32::from_le_bytes(seconds.try_into().expect("four bytes")) + 60 * round as u32;
                seconds.copy_from_slice(&t.to_le_bytes());
            }
            if message.topic == "/sonar/0" && recording.messages.len() % 5 == 0 {
                recording.push("/camera", IMAGE, (message.log_time + later) as i64, image(0, IMAGE_BYTES));
            }
            recording.messages.push(Message { log_time: message.log_time + later, data, ..message });
        }
    }
    let end = recording.messages.last().expect("a message").log_time as i64;
    for _ in 0..4 {
        recording.push("/camera", IMAGE, end + 1, image(0, IMAGE_BYTES));
    }
    recording.laid_out(layout)
}

/// The same with an echo beside each image.
#[cfg(feature = "lab")]
fn with_echoes(times: usize, layout: Layout) -> Vec<u8> {
    let mut recording = Recording::default();
    recording.metadata.push(("atm.sensors".to_owned(), [("0".to_owned(), "0".to_owned())].into()));
    for t in 0..30 * times as i64 {
        let numbers = ["x", "y", "range", "azimuth"].map(|name| (name, 8, &[0.5][..]));
        let whole = [("t", 6), ("sensor", 4), ("kind", 2)].map(|(name, datatype)| (name, datatype, &[0.0][..]));
        recording.push("/atm/echoes", CLOUD, stamp(t as f64), cloud(stamp(t as f64), &[&numbers[..], &whole].concat()));
        recording.push("/camera", IMAGE, stamp(t as f64), image(0, IMAGE_BYTES));
    }
    recording.laid_out(layout)
}

fn high_water_mark(child: &Child) -> u64 {
    mark(child.id()).expect("the peak of the running command")
}

/// The most memory that a process has taken so far, in KiB.
fn mark(process: u32) -> Option<u64> {
    let status = fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().trim_end_matches(" kB").parse().ok()
}

/// Runs the command on what comes down a pipe. Returns its peak memory in KiB.
fn peak(args: &[&str], bytes: &[u8]) -> u64 {
    let mut child = Command::new(env!("CARGO_BIN_EXE_atm"))
        .args(args)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("atm starts");
    let mut input = child.stdin.take().expect("its input");
    let (most, rest) = bytes.split_at(bytes.len() - (2 << 20));
    input.write_all(most).expect("the command reads on");
    let peak = high_water_mark(&child);
    input.write_all(rest).expect("the command reads on");
    drop(input);
    assert_eq!(child.wait().expect("its end").code(), Some(0));
    peak
}

#[track_caller]
fn peaks_are_equal(args: &[&str], layout: Layout) {
    peaks_of(args, |times| long(times, layout));
}

#[track_caller]
fn peaks_of(args: &[&str], recording: impl Fn(usize) -> Vec<u8>) {
    let [small, large] = [1, 8].map(|times| {
        let bytes = recording(times);
        (peak(args, &bytes), bytes.len())
    });
    println!("{args:?}: {} KiB of {} bytes, {} KiB of {}", small.0, small.1, large.0, large.1);
    assert!(large.1 > 6 * small.1 && large.1 > 200_000_000);
    assert!(small.0.abs_diff(large.0) <= EQUAL, "{small:?} {large:?}");
    assert!(small.0.max(large.0) < MOST, "{large:?}");
}

#[test]
fn fusing_takes_the_same_memory_for_seven_times_the_recording() {
    peaks_are_equal(&["fuse", "-"], Layout::Chunks(None));
    peaks_are_equal(&["fuse", "-"], Layout::Bare);
}

#[test]
fn info_takes_the_same_memory_for_seven_times_the_recording() {
    peaks_are_equal(&["info", "-"], Layout::Chunks(None));
}

#[test]
fn copying_takes_the_same_memory_for_seven_times_the_recording() {
    peaks_are_equal(&["fuse", "-", "--to", "mcap", "--passthrough"], Layout::Chunks(None));
}

#[cfg(feature = "lab")]
#[test]
fn drawing_takes_the_same_memory_for_seven_times_the_recording() {
    peaks_of(&["draw", "-", "-o", "-"], |times| with_echoes(times, Layout::Chunks(None)));
}

/// Runs the command on a file. Returns its peak memory in KiB, as it was shortly before its end.
fn peak_of_file(path: &str) -> u64 {
    let mut child = Command::new(env!("CARGO_BIN_EXE_atm"))
        .args(["fuse", path])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("atm starts");
    let mut peak = 0;
    let status = loop {
        if let Some(status) = child.try_wait().expect("its status") {
            break status;
        }
        // One that has just ended has no memory.
        peak = peak.max(mark(child.id()).unwrap_or(0));
    };
    assert_eq!(status.code(), Some(0));
    peak
}

#[test]
fn chunks_that_are_unpacked_ahead_of_a_file_are_as_few_for_six_times_the_recording() {
    let scratch = Scratch::new();
    for compression in [None, Some(Compression::Zstd)] {
        let [small, large] = [1, 7].map(|times| {
            let bytes = long(times, Layout::Chunks(compression));
            peak_of_file(&scratch.file("drive.mcap", &bytes))
        });
        println!("{compression:?}: {small} KiB, {large} KiB");
        // How many of them there are at the same time is chance, up to a bound.
        assert!(large < small + AHEAD && large < MOST, "{small} {large}");
    }
}

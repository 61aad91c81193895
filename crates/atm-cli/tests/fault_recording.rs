//! Recordings that break off, are damaged, come in drips, or have more topics than anybody would.

mod support;

use std::{
    io::{Read, Write},
    process::Stdio,
};

use mcap::Compression;
use support::{
    fault::*,
    recording::{Layout, RANGE, Reading, Recording, TRANSFORMS, Transform, stamp, transforms},
    *,
};

/// A recording of a few messages.
fn small() -> Recording {
    let mut recording = recording::drive();
    recording.messages.truncate(40);
    recording
}

fn fuse(bytes: &[u8], more: &[&str]) -> Ran {
    atm_fed(["fuse", "-"].iter().chain(more), bytes)
}

/// The same through a pipe that gives a few bytes at a time.
fn dripping(bytes: &[u8]) -> (i32, Vec<u8>) {
    let mut running = Running::start(&["fuse", "-", "--quiet"], Stdio::piped(), Stdio::piped());
    let (mut input, mut output) =
        (running.0.stdin.take().expect("an input"), running.0.stdout.take().expect("an output"));
    let bytes = bytes.to_vec();
    let feeder = std::thread::spawn(move || bytes.chunks(5).try_for_each(|piece| input.write_all(piece)));
    let mut written = Vec::new();
    output.read_to_end(&mut written).expect("the command writes on");
    let status = running.ends().status.code().expect("an end");
    // It may give up before it was sent everything.
    let _ = feeder.join().expect("the feeder's end");
    (status, written)
}

#[test]
fn a_recording_may_break_off_at_every_byte() {
    for layout in [Layout::Bare, Layout::Chunks(Some(Compression::Zstd)), Layout::Chunks(Some(Compression::Lz4))] {
        let bytes = small().laid_out(layout);
        let scratch = Scratch::new();
        let whole = fuse(&bytes, &["--emit", "latest"]).exits(0).text().to_owned();
        let step = if matches!(layout, Layout::Bare) { 17 } else { 11 };
        for at in (0..bytes.len()).step_by(step) {
            let file = scratch.file("drive.mcap", &bytes[..at]);
            let ran = atm(["fuse", &file, "--emit", "latest"]);
            let status = ran.status;
            // Nothing to read at all, or no reading or pose yet: refused. Else what is there is used, and said to be part.
            assert!(
                status == 1 || status == 3 || (status == 0 && ran.text() == whole),
                "{at}: {status} {}",
                ran.stderr
            );
            assert!(status == 0 || !ran.stderr.is_empty());
            if status == 3 {
                assert!(ran.stderr.contains("truncated"), "{at}: {}", ran.stderr);
                assert!(whole.starts_with(ran.text()), "{at}: no beginning of what all of it gives");
            }
        }
    }
}

#[test]
fn any_byte_of_a_recording_may_be_wrong() {
    let bytes = small().laid_out(Layout::Chunks(Some(Compression::Lz4)));
    // The first eight say that it is a recording.
    for at in (8..bytes.len()).step_by(23) {
        let mut damaged = bytes.clone();
        damaged[at] ^= 1 << (at % 8);
        let ran = fuse(&damaged, &[]);
        assert!(matches!(ran.status, 0 | 1 | 3), "{at}: {}", ran.stderr);
        // The same bytes give the same, however they come.
        if at % 5 == 0 {
            let (status, written) = dripping(&damaged);
            assert_eq!((status, written), (ran.status, ran.stdout), "{at}");
        }
    }
}

/// A recording of a robot that drives on, with so many sensors of a topic and a frame each.
fn crowd(count: usize) -> Recording {
    let mut recording = Recording::default();
    let names: Vec<String> = (0..count).map(|index| format!("sonar_{index}")).collect();
    let mount = |(child, index): (&'_ String, u32)| (child.clone(), [0.0, 0.0, f64::from(index) * 0.01]);
    let mounts: Vec<(String, [f64; 3])> = names.iter().zip(0..).map(mount).collect();
    for (second, x) in [(0.0, 0.0), (0.1, 0.1)] {
        let t = stamp(second);
        let tf = Transform { t, parent: "odom", child: "base_link", at: [x, 0.0, 0.0] };
        recording.push("/tf", TRANSFORMS, t, transforms(&[tf]));
    }
    for some in mounts.chunks(1000) {
        let t = stamp(0.0);
        let some: Vec<Transform<'_>> =
            some.iter().map(|(child, at)| Transform { t, parent: "base_link", child, at: *at }).collect();
        recording.push("/tf_static", TRANSFORMS, t, transforms(&some));
    }
    for name in &names {
        let t = stamp(0.05);
        let reading = Reading { t, frame: name, beam: 0.4, limits: [0.1, 4.0], range: 1.5 };
        recording.push(&format!("/{name}/range"), RANGE, t, reading.message());
    }
    recording
}

#[test]
fn thousands_of_topics_are_read_and_what_is_beyond_the_number_of_frames_is_counted() {
    let scratch = Scratch::new();
    for (count, status) in [(4000, 0), (10_000, 3)] {
        let file = scratch.file("drive.mcap", crowd(count).laid_out(Layout::Chunks(Some(Compression::Zstd))));
        let (ran, counts) = with_summary(&["fuse", &file, "--history", "1"], "");
        let ran = ran.exits(status);
        // odom, base_link, and 4094 others.
        assert_eq!(tally(&counts, "/readings"), count.min(4094) as u64, "{}", ran.stderr);
        if status == 3 {
            ran.says(&["sonar_4094", "more than there may be"]);
            assert_eq!(tally(&counts, "/dropped/no_transform"), 10_000 - 4094);
        }
        atm(["info", &file]).exits(status);
    }
}

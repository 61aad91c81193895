//! Input that breaks off, comes in drips, changes on the way, or can't be read on.

mod support;

use std::{
    fs::{self, File},
    io::{Read, Seek, SeekFrom, Write},
    process::Stdio,
};

use support::{fault::*, *};

/// A log of a few rows that cross one another.
fn small() -> String {
    drive(24)
}

/// The same places on every run.
fn places(count: usize, below: usize) -> Vec<usize> {
    let mut state = 7_u64;
    let mut draw = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    (0..count).map(|_| draw()).collect()
}

/// A log that breaks off at this byte: the exit status says so where it can, and what comes out is what the whole records give.
#[track_caller]
fn breaks_off(log: &str, at: usize, emit: &str) {
    let cut = &log[..at];
    let (ran, whole) = (fuse_text(cut, &["--emit", emit]), cut.rfind('\n').map_or("", |end| &cut[..=end]));
    if !cut.contains('\n') {
        // Not even the header is whole. All of it without its end still is a header.
        assert_eq!(ran.status, i32::from(cut != log.split('\n').next().unwrap_or_default()), "{cut:?}: {}", ran.stderr);
        assert_eq!(ran.text().lines().count(), usize::from(ran.status == 0));
        return;
    }
    // A row that is cut off is unusable, or still a row: a text can't tell a number from the beginning of one.
    assert!(ran.status == 0 || ran.status == 3, "{at}: {}", ran.stderr);
    if ran.status == 3 {
        let line = format!("standard input:{} ", cut.lines().count());
        assert!(ran.stderr.contains(&line), "no `{line}` in: {}", ran.stderr);
        // It is dropped, and all others are used.
        let expected = undisturbed(whole, &["--emit", emit]);
        assert_same(&ran.stdout, expected.as_bytes());
    }
    if emit == "latest" {
        assert!(ran.text().starts_with(&undisturbed(whole, &["--emit", emit])), "{at}");
    }
}

#[test]
fn a_small_log_may_break_off_at_every_byte() {
    let log = small();
    for at in 0..=log.len() {
        breaks_off(&log, at, if at % 2 == 0 { "latest" } else { "settled" });
    }
}

#[test]
fn a_large_log_may_break_off_at_any_byte() {
    let log = drive(3000);
    for at in places(100, log.len()) {
        breaks_off(&log, at, "latest");
    }
}

#[test]
fn any_bit_of_a_header_may_be_wrong() {
    let log = small();
    let header = log.split('\n').next().expect("a header");
    for (at, bit) in (0..header.len()).flat_map(|at| (0..8).map(move |bit| (at, bit))) {
        let mut bytes = log.clone().into_bytes();
        bytes[at] ^= 1 << bit;
        let name = String::from_utf8_lossy(&bytes[..header.len()]).into_owned();
        let ran = fuse_text(&bytes, &[]);
        // Another name, another number of columns, a comment: whatever it is, it is no log of this rig.
        let ran = ran.exits(1).writes_nothing();
        assert!(ran.stderr.contains("standard input:"), "{name:?}: {}", ran.stderr);
    }
}

#[test]
fn a_pipe_may_drip() {
    let (log, expected) = (drive(400), undisturbed(&drive(400), &[]));
    let mut running = Running::start(&FUSE_STDIN, Stdio::piped(), Stdio::piped());
    let (mut input, mut output) =
        (running.0.stdin.take().expect("an input"), running.0.stdout.take().expect("an output"));
    let mut rest = log.as_bytes();
    for length in (1..=7).cycle() {
        let (piece, after) = rest.split_at(length.min(rest.len()));
        input.write_all(piece).expect("the command reads on");
        rest = after;
        if rest.is_empty() {
            break;
        }
    }
    drop(input);
    let mut written = Vec::new();
    output.read_to_end(&mut written).expect("the command writes on");
    running.ends().exits(0);
    assert_same(&written, expected.as_bytes());
}

/// A run over a file that is held up behind its first reads, by a reader of its output who waits while `change` is done to the file.
fn changed_on_the_way(log: &str, change: impl FnOnce(&mut File)) -> (Ended, String) {
    let scratch = Scratch::new();
    let path = scratch.file("drive.csv", log);
    let args = ["fuse", &path, "--rig", "nomad200", "--emit", "latest"];
    let mut running = Running::start(&args, Stdio::null(), Stdio::piped());
    let mut output = running.0.stdout.take().expect("its output");
    let mut written = vec![0; 1];
    output.read_exact(&mut written).expect("a byte");
    change(&mut File::options().write(true).open(&path).expect("the log"));
    output.read_to_end(&mut written).expect("the command writes on");
    (running.ends(), String::from_utf8(written).expect("output is UTF-8"))
}

#[test]
fn a_log_may_grow_while_it_is_read() {
    let log = drive(30_000);
    let (half, rest) = log.split_at(log[..log.len() / 2].rfind('\n').expect("a row") + 1);
    let (ended, written) = changed_on_the_way(half, |file| {
        file.seek(SeekFrom::End(0)).and_then(|_| file.write_all(rest.as_bytes())).expect("room");
    });
    ended.exits(0);
    assert_same(written.as_bytes(), undisturbed(&log, &["--emit", "latest"]).as_bytes());
}

#[test]
fn a_log_may_shrink_while_it_is_read() {
    let log = drive(30_000);
    let (ended, written) = changed_on_the_way(&log, |file| file.set_len(100).expect("room"));
    let expected = undisturbed(&log, &["--emit", "latest"]);
    // It breaks off where the last read did, which may be within a row.
    let status = ended.status.code();
    assert!(status == Some(0) || status == Some(3), "{}", ended.stderr);
    let whole = written.trim_end().rfind('\n').map_or(0, |end| end + 1);
    assert!(whole > 100_000, "{whole} bytes");
    assert!(expected.starts_with(&written[..whole]));
}

#[cfg(target_os = "linux")]
#[test]
fn a_file_whose_first_read_fails_is_named() {
    // The system lists it, opens it, and has nothing to read at its beginning.
    let ran = atm(["fuse", "/proc/self/mem", "--rig", "nomad200"]).exits(1).writes_nothing();
    ran.says(&["/proc/self/mem", "Input/output error"]);
}

/// The two sides of a terminal; reading from the first fails, and does not end, when the second hangs up.
#[cfg(target_os = "linux")]
fn terminal() -> (File, File) {
    use rustix::{
        pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt},
        termios::{OptionalActions, tcgetattr, tcsetattr},
    };
    let here = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC).expect("a terminal");
    grantpt(&here).and_then(|()| unlockpt(&here)).expect("a terminal");
    let name = ptsname(&here, Vec::new()).expect("its name");
    let name = name.into_string().expect("its name");
    let there = File::options().read(true).write(true).open(name).expect("its other side");
    let mut settings = tcgetattr(&there).expect("its settings");
    settings.make_raw();
    tcsetattr(&there, OptionalActions::Now, &settings).expect("its settings");
    (File::from(here), there)
}

#[cfg(target_os = "linux")]
#[test]
fn a_read_that_fails_midway_keeps_every_echo_so_far() {
    for emit in ["latest", "settled"] {
        let scratch = Scratch::new();
        let out = scratch.name("echoes.csv");
        let (here, mut there) = terminal();
        let args = ["fuse", "-", "--rig", "nomad200", "--emit", emit, "-o", &out];
        let running = Running::start(&args, here, Stdio::null());
        let begun: String = sample().split_inclusive('\n').take(400).collect();
        there.write_all(begun.as_bytes()).expect("the command reads on");
        let expected = match emit {
            "latest" => undisturbed(&begun, &["--emit", emit]),
            _ => fuse_text(format!("{begun}bad\n"), &["--strict"]).exits(1).text().to_owned(),
        };
        let partial = format!("{out}.partial");
        running.until(|| fs::read_to_string(&partial).unwrap_or_default() == expected);
        drop(there);
        running.ends().exits(1).says(&["standard input", "Input/output error", &partial]);
        assert_same(read(&partial).as_bytes(), expected.as_bytes());
        assert_eq!(scratch.list(), ["echoes.csv.partial"]);
    }
}

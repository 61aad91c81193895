//! Outputs that can't be written on: full disks, lost directories and permissions, other runs, readers that go away or dawdle.
#![cfg(target_os = "linux")]

mod support;

use std::{
    fs::{self, File},
    io::{Read, Write},
    os::unix::fs::{MetadataExt, PermissionsExt},
    process::{Command, Stdio},
    thread,
    time::Duration,
};

use support::{fault::*, *};

/// Starts a run from a pipe, gives it the first half of the sample, and waits until its echoes are out.
fn halfway(args: &[&str], partial: &str) -> (Running, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_atm"));
    halfway_as(command.args(FUSE_STDIN).args(args).args(["--emit", "latest"]), partial)
}

fn halfway_as(command: &mut Command, partial: &str) -> (Running, String) {
    let mut running = Running::start_as(command, Stdio::piped(), Stdio::null());
    let log = sample();
    let (begun, rest) = log.split_at(log[..log.len() / 2].rfind('\n').expect("a row") + 1);
    running.0.stdin.as_mut().expect("its input").write_all(begun.as_bytes()).expect("the command reads on");
    let expected = undisturbed(begun, &["--emit", "latest"]);
    running.until(|| fs::read_to_string(partial).unwrap_or_default() == expected);
    (running, rest.to_owned())
}

/// Gives it the other half, and waits for its end.
fn the_rest((mut running, rest): (Running, String)) -> Ended {
    let mut input = running.0.stdin.take().expect("its input");
    // It may be over already.
    let _ = input.write_all(rest.as_bytes());
    drop(input);
    running.ends()
}

#[test]
fn a_full_disk_is_named_for_every_output() {
    let scratch = Scratch::new();
    let out = scratch.name("echoes.csv");
    for flag in ["--crossings", "--summary"] {
        fuse_sample(&["-o", &out, flag, "/dev/full"]).exits(1).says(&["/dev/full", "No space left"]);
    }
}

/// Runs over a long log with room for so many KiB, in a shell that limits the size of files.
fn with_room_for(kib: u32, emit: &str) -> (Scratch, String, Ended) {
    let scratch = Scratch::new();
    let (log, out) = (scratch.file("drive.csv", drive(20_000)), scratch.name("echoes.csv"));
    let mut command = Command::new("sh");
    // Dash counts in blocks of 512 bytes. Without the trap, the signal would end the run.
    let script = format!("trap '' XFSZ; ulimit -f {}; exec \"$0\" \"$@\"", 2 * kib);
    command.args(["-c", &script, env!("CARGO_BIN_EXE_atm")]);
    command.args(["fuse", &log, "--rig", "nomad200", "--emit", emit, "-o", &out]);
    let ended = Running::start_as(&mut command, Stdio::null(), Stdio::null()).ends();
    (scratch, out, ended)
}

#[test]
fn a_disk_that_fills_up_midway_keeps_what_fits() {
    for (kib, emit) in [(64, "settled"), (300, "latest"), (100, "settled")] {
        let (_scratch, out, ended) = with_room_for(kib, emit);
        let partial = format!("{out}.partial");
        ended.exits(1).says(&[&out, "File too large", &partial]);
        let kept = begins(&partial, &undisturbed(&drive(20_000), &["--emit", emit]));
        assert!(kept >= kib as usize * 1024, "{kept} of {kib} KiB");
        assert!(!fs::exists(&out).expect("the directory"), "a file under the name");
    }
}

#[test]
fn a_small_file_system_that_fills_up_keeps_what_fits() {
    let scratch = Scratch::new();
    let (log, disk) = (scratch.file("drive.csv", drive(20_000)), scratch.name("disk"));
    let saved = scratch.name("saved");
    fs::create_dir(&disk).expect("a directory");
    let script = "mount -t tmpfs -o size=128k none \"$1\" || exit 77
        \"$0\" fuse \"$2\" --rig nomad200 -o \"$1/echoes.csv\"; status=$?
        cp \"$1/echoes.csv.partial\" \"$3\"; exit $status";
    let mut command = Command::new("unshare");
    command.args([
        "--user",
        "--map-root-user",
        "--mount",
        "sh",
        "-c",
        script,
        env!("CARGO_BIN_EXE_atm"),
        &disk,
        &log,
        &saved,
    ]);
    let ended = Running::start_as(&mut command, Stdio::null(), Stdio::null()).ends();
    if !matches!(ended.status.code(), Some(0 | 1 | 3)) {
        return skipped(&format!("no file system may be mounted here: {}", ended.stderr.trim()));
    }
    ended.exits(1).says(&["echoes.csv", "No space left", "echoes.csv.partial"]);
    let kept = begins(&saved, &undisturbed(&drive(20_000), &[]));
    assert_eq!(kept, 128 * 1024, "all that fits");
}

#[test]
fn a_directory_that_goes_away_takes_the_name_and_not_the_echoes() {
    let scratch = Scratch::new();
    let (place, moved) = (scratch.name("place"), scratch.name("moved"));
    fs::create_dir(&place).expect("a directory");
    let out = format!("{place}/echoes.csv");
    let run = halfway(&["-o", &out], &format!("{out}.partial"));
    fs::rename(&place, &moved).expect("another name");
    the_rest(run).exits(1).says(&[&out, "No such file", &format!("{out}.partial")]);
    let expected = undisturbed(&sample(), &["--emit", "latest"]);
    assert_same(read(&format!("{moved}/echoes.csv.partial")).as_bytes(), expected.as_bytes());
}

#[test]
fn a_partial_file_that_is_removed_is_an_error_and_not_an_empty_output() {
    let scratch = Scratch::new();
    let out = scratch.name("echoes.csv");
    let partial = format!("{out}.partial");
    let run = halfway(&["-o", &out], &partial);
    fs::remove_file(&partial).expect("the partial file");
    the_rest(run).exits(1).says(&[&out, "No such file"]);
    assert_eq!(scratch.list(), [""; 0]);
}

/// A command run as somebody to whom permissions mean something; `None` where that can't be.
fn unprivileged() -> Option<Command> {
    let own = fs::metadata("/proc/self").expect("this process").uid();
    if own != 0 {
        return Some(Command::new(env!("CARGO_BIN_EXE_atm")));
    }
    let mut command = Command::new("setpriv");
    command.args(["--reuid", "65534", "--regid", "65534", "--clear-groups", env!("CARGO_BIN_EXE_atm")]);
    let works = Command::new("setpriv")
        .args(["--reuid", "65534", "--clear-groups", env!("CARGO_BIN_EXE_atm"), "--version"])
        .current_dir(root())
        .output()
        .is_ok_and(|output| output.status.success());
    works.then_some(command)
}

#[test]
fn a_permission_that_is_lost_midway_keeps_every_echo() {
    let Some(mut command) = unprivileged() else {
        return skipped("no setpriv, or the command can't be reached: root may write everywhere");
    };
    let scratch = Scratch::new();
    let place = scratch.name("place");
    fs::create_dir(&place).expect("a directory");
    let mode = |path: &str, mode| fs::set_permissions(path, fs::Permissions::from_mode(mode)).expect("permissions");
    mode(&place, 0o777);
    mode(&scratch.name(""), 0o755);
    let out = format!("{place}/echoes.csv");
    let partial = format!("{out}.partial");
    let run = halfway_as(command.args(FUSE_STDIN).args(["--emit", "latest", "-o", &out]), &partial);
    mode(&place, 0o555);
    the_rest(run).exits(1).says(&[&out, "denied", &partial]);
    assert_same(read(&partial).as_bytes(), undisturbed(&sample(), &["--emit", "latest"]).as_bytes());
    mode(&place, 0o755);
}

#[test]
fn of_two_runs_on_one_output_the_second_is_refused_and_the_first_goes_on() {
    let scratch = Scratch::new();
    let out = scratch.name("echoes.csv");
    let partial = format!("{out}.partial");
    let first = halfway(&["-o", &out], &partial);
    fuse_sample(&["-o", &out]).exits(1).says(&[&partial, "another run is writing this output"]).writes_nothing();
    the_rest(first).exits(0);
    assert_same(read(&out).as_bytes(), undisturbed(&sample(), &["--emit", "latest"]).as_bytes());
    // And one after the other, the later one's is there.
    fuse_sample(&["-o", &out]).exits(0);
    assert_same(read(&out).as_bytes(), &fuse_sample(&[]).stdout);
    assert_eq!(scratch.list(), ["echoes.csv"]);
}

#[test]
fn many_runs_on_one_output_at_once_leave_one_whole_file() {
    let scratch = Scratch::new();
    let out = scratch.name("echoes.csv");
    let args = ["fuse", SAMPLE, "--rig", "nomad200", "-o", &out];
    let runs: Vec<Running> = (0..8).map(|_| Running::start(&args, Stdio::null(), Stdio::null())).collect();
    let ended: Vec<Ended> = runs.into_iter().map(Running::ends).collect();
    assert!(ended.iter().any(|run| run.status.success()), "none was done");
    for run in ended.iter().filter(|run| !run.status.success()) {
        assert_eq!(run.status.code(), Some(1));
        assert!(run.stderr.contains("writing this output"), "{}", run.stderr);
    }
    assert_same(read(&out).as_bytes(), &fuse_sample(&[]).stdout);
    assert_eq!(scratch.list(), ["echoes.csv"]);
}

#[test]
fn a_named_pipe_whose_reader_leaves_is_no_error() {
    let scratch = Scratch::new();
    let (log, pipe) = (scratch.file("drive.csv", drive(20_000)), scratch.name("echoes"));
    assert!(Command::new("mkfifo").arg(&pipe).status().expect("mkfifo").success());
    let running = Running::start(&["fuse", &log, "--rig", "nomad200", "-o", &pipe], Stdio::null(), Stdio::null());
    let mut first = [0; 1000];
    File::open(&pipe).and_then(|mut reader| reader.read_exact(&mut first)).expect("the command writes");
    running.ends().exits(0);
    assert!(undisturbed(&drive(20_000), &[]).as_bytes().starts_with(&first));
}

#[test]
fn a_reader_that_dawdles_gets_everything() {
    let scratch = Scratch::new();
    let log = scratch.file("drive.csv", drive(3000));
    let mut running = Running::start(&["fuse", &log, "--rig", "nomad200"], Stdio::null(), Stdio::piped());
    let mut output = running.0.stdout.take().expect("its output");
    let (mut written, mut piece) = (Vec::new(), [0; 4096]);
    loop {
        // Now a little, now much, and a rest between.
        let most = [1, 4096, 17, 300][written.len() % 4];
        match output.read(&mut piece[..most]).expect("the command writes on") {
            0 => break,
            count => written.extend_from_slice(&piece[..count]),
        }
        if written.len() % 8 == 0 {
            thread::sleep(Duration::from_micros(200));
        }
    }
    running.ends().exits(0);
    assert_same(&written, undisturbed(&drive(3000), &[]).as_bytes());
}

//! Bad input: the exit status, and messages that name file, line and value.

mod support;

use support::*;

const BOM: &[u8] = b"\xef\xbb\xbf";
/// The line at which the rows below put something bad.
const LINE: usize = 200;

/// The sample with `row` put in as line [`LINE`].
fn sample_with(row: &str) -> String {
    let log = sample();
    let mut lines: Vec<&str> = log.lines().collect();
    lines.insert(LINE - 1, row);
    lines.join("\n") + "\n"
}

/// One bad record in a good log: exit 3, named and counted under `reason`, and everything else as if it were not there.
#[track_caller]
fn one_bad_row(row: &str, reason: &str, value: &str) {
    let scratch = Scratch::new();
    let log = scratch.file("drive.csv", sample_with(row));
    let (ran, summary) = with_summary(&["fuse", &log, "--rig", "nomad200"], "");
    let place = format!("{log}:{LINE} ");
    let before: usize = sample().lines().take(LINE - 1).map(|line| line.len() + 1).sum();
    let byte = format!("(byte {before})");
    let ran = ran.exits(3).says(&[reason, &place, &byte, value]);
    ran.writes(fuse_sample(&[]).stdout);
    assert_eq!(summary["dropped"], serde_json::json!({ reason: 1 }));
    assert_eq!(tally(&summary, "/readings"), 784);
    atm(["fuse", &log, "--rig", "nomad200", "--quiet"]).exits(3).says(&[reason, &place, value]);
}

#[test]
fn unknown_sensor_is_counted() {
    one_bad_row("12,front,2.5,1.524,0,0", "unknown_sensor", "\"front\"");
    one_bad_row("12,16,2.5,1.524,0,0", "unknown_sensor", "\"16\"");
}

#[test]
fn unparsable_number_is_counted() {
    one_bad_row("12,3,1.2.3,1.524,0,0", "bad_number", "\"1.2.3\"");
    one_bad_row("12,3,two,1.524,0,0", "bad_number", "range \"two\"");
    one_bad_row("noon,3,2,1.524,0,0", "bad_number", "t \"noon\"");
    one_bad_row("inf,3,2,1.524,0,0", "bad_number", "t \"inf\"");
    one_bad_row("12,3,2,1.524,0x1,0", "bad_number", "y \"0x1\"");
    one_bad_row("12,3,1e999,1.524,0,0", "bad_number", "1e999");
}

#[test]
fn pose_that_is_not_finite_is_counted() {
    one_bad_row("12,3,2,nan,0,0", "bad_pose", "x \"nan\"");
    one_bad_row("12,3,2,0,inf,0", "bad_pose", "y \"inf\"");
    one_bad_row("12,3,2,0,0,-Inf", "bad_pose", "yaw \"-Inf\"");
}

#[test]
fn record_that_ends_early_is_counted() {
    one_bad_row("12,3,2.54", "missing_field", "3 fields, 6 needed");
}

#[test]
fn time_going_backwards_is_counted() {
    one_bad_row("11.999999999,3,2,1.524,0,0", "time_backwards", "t 11.999999999 after 12");
}

#[test]
fn a_bad_cell_of_a_wide_table_costs_that_reading_alone() {
    let ids: Vec<String> = (0..16).map(|id: i32| id.to_string()).collect();
    let log = format!("t,x,y,yaw,{}\n0,0,0,0,1,far{}\n", ids.join(","), ",2".repeat(14));
    let (ran, summary) = with_summary(&FUSE_STDIN, log);
    ran.exits(3).says(&["standard input:2 ", "1 \"far\""]);
    assert_eq!((tally(&summary, "/readings"), tally(&summary, "/dropped/bad_number")), (15, 1));
}

#[test]
fn a_wide_record_without_one_usable_reading_does_not_set_the_clock() {
    let scratch = Scratch::new();
    let rig = scratch.file("one.toml", "[[sensor]]\nid = \"a\"\n");
    let log = "t,x,y,yaw,a\n0,0,0,0,1\n100,0,0,0,bad\n1,0,0,0,2\n2,0,0,0,3\n";
    let (ran, summary) = with_summary(&["fuse", "-", "--rig", &rig], log);
    assert_eq!(summary["dropped"], serde_json::json!({ "bad_number": 1 }));
    assert_eq!(ran.exits(3).echoes().len(), 3);
}

/// Rows of one sensor that moves on, at these times.
fn rows(times: impl IntoIterator<Item = u32>) -> String {
    let row = |t| format!("{t},4,1.5,{},0,0\n", 0.1 * f64::from(t));
    times.into_iter().map(row).collect()
}

#[test]
fn sixteen_earlier_records_in_order_are_a_clock_reset() {
    let header = "t,sensor,range,x,y,yaw\n";
    let log = format!("{header}{}{}", rows(100..120), rows(0..30));
    let (ran, summary) = with_summary(&FUSE_STDIN, log);
    assert_eq!((tally(&summary, "/clock_resets"), tally(&summary, "/dropped/time_backwards")), (1, 16));
    let ran = ran.exits(3).says(&["time_backwards", "standard input:22 ", "clock"]);
    // The local map is emptied, and time goes on behind the sixteenth.
    let before = fuse_text(format!("{header}{}", rows(100..120)), &[]).exits(0);
    let after = fuse_text(format!("{header}{}", rows(16..30)), &[]).exits(0);
    let after =
        after.text().strip_prefix(HEADER).and_then(|text| text.strip_prefix('\n')).expect("a header").to_owned();
    ran.writes(before.text().to_owned() + &after);
}

#[test]
fn fifteen_earlier_records_or_disordered_ones_are_none() {
    let header = "t,sensor,range,x,y,yaw\n";
    let fifteen = format!("{header}{}{}{}", rows(100..120), rows(0..15), rows(120..140));
    let disordered = format!("{header}{}{}{}", rows(100..120), rows((0..30).rev()), rows(120..140));
    for (log, dropped) in [(fifteen, 15), (disordered, 30)] {
        let (ran, summary) = with_summary(&FUSE_STDIN, log);
        assert_eq!((tally(&summary, "/clock_resets"), tally(&summary, "/dropped/time_backwards")), (0, dropped));
        ran.exits(3).writes(fuse_text(format!("{header}{}", rows(100..140)), &[]).stdout);
    }
}

#[test]
fn readings_without_a_pose_near_enough_on_both_sides_are_counted() {
    let scratch = Scratch::new();
    // Poses from 1 to 2 s and from 4 to 5 s, every half second.
    let times = [1.0, 1.5, 2.0, 4.0, 4.5, 5.0];
    let poses: String = times.iter().map(|t| format!("{t},{t},0,0\n")).collect();
    let poses = scratch.file("poses.csv", format!("t,x,y,yaw\n{poses}"));
    let log = "t,sensor,range\n0.9,4,1\n1,4,1\n1.75,4,1\n2.5,4,1\n3,4,1\n3.5,4,1\n4,4,1\n5,4,1\n5.1,4,1\n";
    let args: Vec<&str> = FUSE_STDIN.into_iter().chain(["--poses", &poses]).collect();
    let (ran, summary) = with_summary(&args, log);
    let times: Vec<String> =
        ran.exits(3).says(&["no_pose", "standard input:2 ", "t 0.9"]).echoes().into_iter().map(|echo| echo.t).collect();
    assert_eq!(times, ["1.0", "1.75", "4.0", "5.0"]);
    assert_eq!(summary["dropped"], serde_json::json!({ "no_pose": 5 }));
    let wider: Vec<&str> = args.into_iter().chain(["--max-gap", "1.5s"]).collect();
    assert_eq!(with_summary(&wider, log).1["dropped"], serde_json::json!({ "no_pose": 2 }));
}

#[test]
fn bad_poses_of_a_second_file_are_named_there() {
    let scratch = Scratch::new();
    let poses = scratch.file("poses.csv", "t,x,y,yaw\n0,0,0,0\n0.2,zero,0,0\n0.4,0,0,0\n");
    let ran = fuse_text("t,sensor,range\n0.3,4,1\n", &["--poses", &poses]).exits(3);
    assert_eq!(ran.says(&["bad_number", &format!("{poses}:3 "), "x \"zero\""]).echoes().len(), 1);
}

#[test]
fn an_empty_file_is_refused_and_a_header_alone_is_not() {
    let scratch = Scratch::new();
    let empty = scratch.file("empty.csv", "");
    atm(["fuse", &empty, "--rig", "nomad200"]).exits(1).says(&[&empty, "empty"]).writes_nothing();
    fuse_text("", &[]).exits(1).says(&["standard input", "empty"]);
    let (ran, summary) = with_summary(&FUSE_STDIN, "t,sensor,range,x,y,yaw\n");
    assert_eq!(ran.exits(0).text(), format!("{HEADER}\n"));
    assert_eq!(tally(&summary, "/readings"), 0);
}

#[test]
fn a_log_of_nothing_but_bad_records_ends_in_3() {
    let ran = fuse_text("t,sensor,range,x,y,yaw\na,0,1,0,0,0\nb,0,1,0,0,0\n", &[]);
    assert_eq!(ran.exits(3).says(&["2 bad_number"]).text(), format!("{HEADER}\n"));
}

#[test]
fn directories_and_missing_files_are_named() {
    let scratch = Scratch::new();
    let directory = scratch.name("");
    atm(["fuse", &directory, "--rig", "nomad200"]).exits(1).says(&[&directory, "directory"]);
    let missing = scratch.name("none.csv");
    atm(["fuse", &missing, "--rig", "nomad200"]).exits(1).says(&[&missing, "No such file"]);
    fuse_sample(&["--poses", &missing]).exits(1).says(&[&missing, "No such file"]);
}

#[cfg(unix)]
#[test]
fn a_file_that_may_not_be_read_is_named() {
    use std::{
        fs,
        io::{self, Write},
        os::unix::fs::PermissionsExt,
    };
    let scratch = Scratch::new();
    let log = scratch.file("secret.csv", sample());
    fs::set_permissions(&log, fs::Permissions::from_mode(0o000)).expect("permissions");
    let ran = atm(["fuse", &log, "--rig", "nomad200"]);
    if fs::File::open(&log).is_ok() {
        // Straight to standard error: what a passing test prints is not shown.
        let _ = writeln!(io::stderr(), "*** SKIPPED: this user (root?) may read every file, so nothing is refused ***");
        ran.exits(0);
    } else {
        ran.exits(1).says(&[&log, "denied"]);
    }
}

#[test]
fn missing_columns_are_named() {
    for (header, missing) in [
        ("t,sensor,x,y,yaw", "range"),
        ("t,range,x,y,yaw", "sensor"),
        ("sensor,range,x,y,yaw", "`t`"),
        ("t,sensor,range,x,y", "yaw"),
        ("t,sensor,range", "x, y, yaw"),
    ] {
        let scratch = Scratch::new();
        let log = scratch.file("log.csv", format!("{header}\n0,0,0,0,0\n"));
        let ran = atm(["fuse", &log, "--rig", "nomad200"]).exits(1).writes_nothing();
        ran.says(&[&format!("{log}:1"), missing, header.split(',').next().expect("a column")]);
    }
}

#[test]
fn a_log_of_another_rig_is_refused() {
    // Eight sensors where the rig has sixteen.
    let log = "t,x,y,yaw,0,1,2,3,4,5,6,7\n0,0,0,0,1,1,1,1,1,1,1,1\n";
    fuse_text(log, &[]).exits(1).says(&["standard input:1", "8, 9, 10", "rig"]).writes_nothing();
}

#[test]
fn line_ends_and_a_byte_order_mark_change_nothing() {
    let expected = fuse_sample(&[]).stdout;
    let windows = sample().replace('\n', "\r\n");
    let marked: Vec<u8> = BOM.iter().copied().chain(windows.bytes()).collect();
    let unended = sample().trim_end().to_owned();
    for log in [windows.into_bytes(), marked, sample().replace('\n', "\r").into_bytes(), unended.into_bytes()] {
        fuse_text(log, &[]).exits(0).writes(&expected);
    }
    let ran = fuse_text(sample_with("12,front,2.5,0,0,0").replace('\n', "\r\n"), &[]);
    ran.exits(3).says(&[&format!("standard input:{LINE} ")]);
}

#[test]
fn utf_16_is_refused_with_a_word_on_what_to_do() {
    let little: Vec<u8> = [0xfeff].into_iter().chain(sample().encode_utf16()).flat_map(u16::to_le_bytes).collect();
    let big: Vec<u8> = [0xfeff].into_iter().chain(sample().encode_utf16()).flat_map(u16::to_be_bytes).collect();
    for log in [little, big] {
        fuse_text(log, &[]).exits(1).says(&["standard input", "UTF-16", "UTF-8"]).writes_nothing();
    }
}

#[test]
fn bytes_that_are_no_text_never_panic() {
    let mut state = 1_u32;
    let mut noise = Vec::new();
    for _ in 0..100_000 {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        noise.push((state >> 24) as u8);
    }
    fuse_text(&noise, &[]).exits(1);
    let behind_a_header: Vec<u8> = b"t,sensor,range,x,y,yaw\n".iter().copied().chain(noise).collect();
    fuse_text(behind_a_header, &[]).exits(3);
}

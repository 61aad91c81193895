//! Tables as robots and spreadsheets write them: read, or refused with the cause and what cures it.

mod support;

use serde_json::Value;
use support::{cases::case, *};

/// `atm fuse` of a case by count, as the paper has it, and its summary. The rig is the Nomad's, or a file.
fn fuse(path: &str, rig: &str, more: &[&str]) -> (Ran, Value) {
    let args: Vec<&str> =
        ["fuse", path, "--rig", rig, "--history", "10"].into_iter().chain(more.iter().copied()).collect();
    with_summary(&args, "")
}

/// Medians and singles.
fn resolved(summary: &Value) -> (u64, u64) {
    (tally(summary, "/echoes/median"), tally(summary, "/echoes/single"))
}

/// What `advice` says, cause, evidence and cure in a row.
fn advice(summary: &Value) -> String {
    summary["advice"].to_string()
}

/// The echoes without the column of the time, which a case may write from another day on.
fn places(ran: &Ran) -> Vec<String> {
    let place = |line: &str| line.split_once(',').expect("a time").1.to_owned();
    let mut places: Vec<String> = ran.text().lines().skip(1).map(place).collect();
    places.sort();
    places
}

/// The same echoes as the base's, exit 0, no word.
#[track_caller]
fn is_as_base(name: &str) {
    let (Some(base), Some(path)) = (case("tables/base.csv"), case(&format!("tables/{name}"))) else { return };
    let (expected, found) = (fuse(&base, "nomad200", &[]).0.exits(0), fuse(&path, "nomad200", &[]).0.exits(0));
    assert!(places(&found) == places(&expected), "{name}: other echoes");
    assert_eq!(found.stderr, expected.stderr, "{name}");
}

/// Exit 0 or 3 as said, and advice with all of these words.
#[track_caller]
fn is_told(name: &str, words: &[&str]) {
    let Some(path) = case(&format!("tables/{name}")) else { return };
    let (ran, summary) = fuse(&path, "nomad200", &[]);
    let ran = ran.exits(0).says(&["warning: "]);
    let info = atm(["info", &path, "--rig", "nomad200", "--json"]).exits(0).json();
    for word in words {
        assert!(advice(&summary).contains(word), "no `{word}` in {summary}");
        assert!(ran.stderr.contains(word), "no `{word}` in {}", ran.stderr);
        assert!(info["advice"].to_string().contains(word), "no `{word}` in {info}");
    }
}

#[test]
fn the_base_is_in_order() {
    let Some(path) = case("tables/base.csv") else { return };
    let (ran, summary) = fuse(&path, "nomad200", &[]);
    ran.exits(0);
    assert_eq!((resolved(&summary), advice(&summary)), ((122, 57), "[]".into()));
}

#[test]
fn decimal_commas_are_read_where_commas_do_not_separate_cells() {
    is_as_base("decimal_comma.csv");
}

#[test]
fn dates_and_times_of_day_are_read() {
    is_as_base("iso_times.csv");
    is_as_base("time_of_day.csv");
}

#[test]
fn a_header_in_a_comment_is_read() {
    is_as_base("header_in_comment.csv");
}

#[test]
fn rows_sorted_by_sensor_are_put_in_order() {
    is_as_base("sorted_by_sensor.csv");
    let (Some(path), Some(rig)) = (case("tables/melt_small.csv"), case("tables/one_two.toml")) else { return };
    let scratch = Scratch::new();
    let rig = scratch.file("rig.toml", format!("{}\n[[sensor]]\nid = \"b\"\n", read(&rig)));
    let (ran, summary) = fuse(&path, &rig, &[]);
    ran.exits(0);
    assert_eq!(tally(&summary, "/readings"), 4);
}

#[test]
fn a_table_that_was_joined_with_one_of_poses_is_read_with_the_poses_around_its_rows() {
    let (Some(base), Some(path)) = (case("tables/base.csv"), case("tables/outer_join.csv")) else { return };
    let (expected, found) = (fuse(&base, "nomad200", &[]).0.exits(0).echoes(), fuse(&path, "nomad200", &[]));
    assert_eq!(tally(&found.1, "/readings"), 784);
    let found = found.0.exits(0).echoes();
    assert_eq!(found.len(), expected.len());
    // Its poses are 10 ms early: 1.3 mm.
    for (found, expected) in found.iter().zip(&expected) {
        assert_eq!((&found.sensor, &found.kind), (&expected.sensor, &expected.kind));
        assert_near(found.x, expected.x, 0.01);
    }
}

#[test]
fn units_in_cells_are_read() {
    let Some(path) = case("tables/units_in_cells.csv") else { return };
    let (ran, summary) = fuse(&path, "nomad200", &[]);
    assert_eq!((tally(&summary, "/readings"), tally(&summary, "/no_echo")), (784, 0));
    let ranges: Vec<f64> = ran.exits(0).echoes().iter().map(|echo| echo.range).collect();
    assert!(ranges.contains(&5.51) && ranges.iter().all(|range| *range < 6.477), "{ranges:?}");
}

#[test]
fn ranges_that_are_clipped_are_told() {
    is_told("clipped.csv", &["2.49 m stands for nothing"]);
}

#[test]
fn headings_and_positions_that_are_none_are_told() {
    is_told("yaw_in_degrees.csv", &["in degrees", "yaw_unit"]);
    is_told("yaw_clockwise.csv", &["clockwise", "yaw_unit"]);
    is_told("latitude_longitude.csv", &["latitude and longitude", "--poses"]);
    let Some(right) = case("tables/yaw_right.csv") else { return };
    let (ran, summary) = fuse(&right, "nomad200", &[]);
    ran.exits(0);
    assert_eq!(advice(&summary), "[]");
}

#[test]
fn the_advice_on_headings_is_right() {
    let Some(right) = case("tables/yaw_right.csv") else { return };
    let expected = fuse(&right, "nomad200", &[]).0.exits(0);
    let scratch = Scratch::new();
    let nomad = read(root().join("rig/nomad200.toml").to_str().expect("a path in UTF-8"));
    for (name, unit) in [("yaw_in_degrees.csv", "1deg"), ("yaw_clockwise.csv", "-1rad")] {
        let Some(path) = case(&format!("tables/{name}")) else { return };
        let rig = scratch.file("rig.toml", format!("{nomad}\n[log]\nyaw_unit = \"{unit}\"\n"));
        let found = fuse(&path, &rig, &[]).0.exits(0);
        for (found, expected) in found.echoes().iter().zip(expected.echoes()) {
            assert_eq!(found.kind, expected.kind);
            assert_near(found.x, expected.x, 1e-9);
        }
    }
}

#[test]
fn times_that_have_lost_their_digits_are_told() {
    is_told("epoch_lost_digits.csv", &["lost their digits", "1 time", "1661450000 s"]);
}

#[test]
fn a_panning_sensor_is_read_by_the_column_of_its_angle() {
    let (Some(path), Some(rig)) = (case("tables/servo.csv"), case("tables/servo.toml")) else { return };
    let said = atm(["fuse", &path, "--rig", &rig]).exits(1);
    said.says(&["servo, dist", "columns = [\"t\", \"sensor\", \"range\""]);
    let scratch = Scratch::new();
    let columns = |third: &str| {
        format!("[log]\ncolumns = [\"t\", \"x\", \"y\", \"yaw\", \"{third}\", \"range\"]\nheader = true\n")
    };
    // A sensor an angle, or one that turns.
    let many = scratch.file("many.toml", format!("{}\n{}", read(&rig), columns("sensor")));
    let one = "field_of_view = \"15deg\"\nmin_range = \"2cm\"\nmax_range = \"4m\"\nrange_resolution = \"1cm\"\n[[sensor]]\n\
               id = \"servo\"\nx = \"10cm\"\n";
    let one = scratch.file("one.toml", format!("{one}{}angle = \"servo\"\nangle_unit = \"1deg\"\n", columns("servo")));
    let centers = |rig: &str| {
        let args = [
            "fuse",
            &path,
            "--rig",
            rig,
            "--keep",
            "center",
            "--min-angle",
            "90deg",
            "--history",
            "1",
            "--max-speed",
            "1e9m/s",
        ];
        let (ran, summary) = with_summary(&args, "");
        assert_eq!(tally(&summary, "/readings"), 2121);
        ran.exits(0).echoes()
    };
    let (many, one) = (centers(&many), centers(&one));
    assert!(many.len() > 1000);
    let by_time = |echoes: &[Echo]| {
        let mut places: Vec<(String, f64, f64)> = echoes.iter().map(|echo| (echo.t.clone(), echo.x, echo.y)).collect();
        places.sort_by(|a, b| number(&a.0).total_cmp(&number(&b.0)));
        places
    };
    for (one, many) in by_time(&one).iter().zip(by_time(&many)) {
        assert_eq!(one.0, many.0);
        assert_near(one.1, many.1, 1e-9);
        assert_near(one.2, many.2, 1e-9);
    }
}

/// A headerless log of one sensor, a line cut at the connection and glued to the next in front of it: x is 1 m.
const GLUED: &str = "0.1 0.30 1.01 0 0\n0.2 0.31 0.12 0 0\n0.3 0.32 0.13 0 0\n0.4 0.33 0.14 0 0\n";

#[test]
fn the_first_line_of_a_live_source_without_a_header_is_not_trusted() {
    let scratch = Scratch::new();
    let rig = scratch.file(
        "rig.toml",
        "[log]\ncolumns = ['t', 'a', 'x', 'y', 'yaw']\ndelimiter = ' '\n[[sensor]]\nid = 'a'\nmax_range = '2m'\n",
    );
    let (ran, summary) = with_summary(&["fuse", "-", "--rig", &rig], GLUED);
    let ran = ran.exits(0).says(&["the first line of a source that runs already", "0.1 0.30 1.01 0 0"]);
    assert_eq!(tally(&summary, "/readings"), 3);
    assert!(ran.echoes().iter().all(|echo| echo.x < 1.0));
    // A file is no such source, nor is one behind a header.
    let log = scratch.file("log.txt", GLUED);
    let (ran, summary) = with_summary(&["fuse", &log, "--rig", &rig], "");
    assert_eq!((tally(&summary, "/readings"), ran.exits(0).echoes().len()), (4, 4));
    let headed = "t,sensor,range,x,y,yaw\n0,0,1,0,0,0\n";
    assert_eq!(tally(&with_summary(&FUSE_STDIN, headed).1, "/readings"), 1);
}

#[test]
fn a_file_on_standard_input_is_a_file() {
    let scratch = Scratch::new();
    let rig = scratch
        .file("rig.toml", "[log]\ncolumns = ['t', 'a', 'x', 'y', 'yaw']\ndelimiter = ' '\n[[sensor]]\nid = 'a'\n");
    let log = std::fs::File::open(scratch.file("log.txt", GLUED)).expect("the log");
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_atm"));
    let ran = command.args(["fuse", "-", "--rig", &rig]).stdin(log).output().expect("atm runs");
    assert_eq!(String::from_utf8_lossy(&ran.stdout).lines().count(), 5);
}

#[test]
fn a_table_of_which_nothing_can_be_used_leaves_no_file() {
    let scratch = Scratch::new();
    let log = scratch.file("log.csv", "t,sensor,range,x,y,yaw\n0,0,none,0,0,0\n1,zero,1,0,0,0\n");
    let (echoes, crossings, counts) = (scratch.name("e.csv"), scratch.name("c.csv"), scratch.name("counts.json"));
    let args = ["fuse", &log, "--rig", "nomad200", "-o", &echoes, "--crossings", &crossings, "--summary", &counts];
    atm(args).exits(3).says(&["no reading could be used", &echoes]);
    assert_eq!(scratch.list(), ["counts.json", "log.csv"]);
    // What was there stays.
    std::fs::write(&echoes, "earlier").expect("a file");
    atm(args).exits(3);
    assert_eq!(read(&echoes), "earlier");
    // A log that says that nothing was there is used; so is one without a record.
    for rows in ["0,0,inf,0,0,0\n", ""] {
        let log = scratch.file("log.csv", format!("t,sensor,range,x,y,yaw\n{rows}"));
        atm(["fuse", &log, "--rig", "nomad200", "-o", &echoes]).exits(0);
        assert_eq!(read(&echoes), format!("{HEADER}\n"));
    }
}

#[test]
fn times_and_ranges_are_written_with_a_point() {
    let scratch = Scratch::new();
    let (log, truth, crossings) = (scratch.name("log.csv"), scratch.name("truth.csv"), scratch.name("crossings.csv"));
    atm(["simulate", "doorway", "-o", &log, "--truth", &truth]).exits(0);
    let echoes = atm(["fuse", &log, "--rig", "nomad200", "--crossings", &crossings]).exits(0).text().to_owned();
    let tables = [
        (read(&log), &[0, 2, 3, 4, 5][..]),
        (read(&truth), &[0, 2, 3, 4]),
        (read(&crossings), &[0, 2, 4, 5]),
        (echoes, &[0, 2, 5]),
    ];
    for (table, columns) in tables {
        assert!(table.lines().count() > 100);
        for line in table.lines().skip(1) {
            let cells: Vec<&str> = line.split(',').collect();
            for column in columns {
                assert!(cells[*column].contains(['.', 'n']), "{line}");
            }
        }
    }
}

#[test]
fn little_that_is_resolved_is_told_with_numbers_and_a_flag_and_the_status_stays() {
    // Two readings of a sensor span 25 cm of travel.
    let (ran, summary) =
        with_summary(&["fuse", SAMPLE, "--rig", "nomad200", "--history", "2", "--min-angle", "60deg"], "");
    let advice = advice(&summary);
    for word in
        ["hardly anything is resolved", "spans 0.249 m of travel", "60deg at 2.54 m take 2.54 m", "--history auto"]
    {
        assert!(advice.contains(word), "no `{word}` in {advice}");
        assert!(ran.stderr.contains(word), "no `{word}` in {}", ran.stderr);
    }
    ran.exits(0);
}

#[test]
fn the_path_the_travel_and_the_command_are_shown_of_any_log() {
    let ran = atm(["info", SAMPLE, "--rig", "nomad200", "--json"]).exits(0).json();
    for (key, expected) in [("path_m", 6.096), ("speed_m_s", 0.127), ("reach_m", 2.54), ("needed_travel_m", 1.3147)] {
        assert_near(ran[key].as_f64().expect(key), expected, 1e-3);
    }
    assert!(ran["map_travel_m"].as_f64().is_some_and(|spans| spans > 1.2 && spans < 2.0), "{ran}");
    assert_eq!(ran["command"], "atm fuse examples/doorway.csv --rig nomad200 -o echoes.csv");
    let sensor = &ran["sensors"]["4"];
    assert_near(
        sensor["no_echo_share"].as_f64().expect("a share"),
        sensor["no_echo"].as_f64().expect("a count") / 49.0,
        1e-12,
    );
    let mut ranges: Vec<f64> = sample_rows().iter().filter(|row| row.sensor == "4").filter_map(Row::echo).collect();
    ranges.sort_by(f64::total_cmp);
    let median = ranges[ranges.len().div_ceil(2) - 1];
    assert_near(sensor["range_m"]["p50"].as_f64().expect("a length"), median, 0.016 * median);
    let text = atm(["info", SAMPLE]).exits(0);
    for word in [
        "path      6.096 m long",
        "travel",
        "crossings of 30deg at 2.54 m take 1.315 m",
        "try: atm fuse examples/doorway.csv --rig RIG.toml",
    ] {
        assert!(text.text().contains(word), "no `{word}` in {}", text.text());
    }
    let one = atm_fed(["info", "-"], "t,sensor,range,x,y,yaw\n0,a,1,0,0,0\n").exits(0);
    assert!(one.text().contains("1 sensor\n"), "{}", one.text());
}

#[test]
fn readings_that_are_there_twice_count_once() {
    let (Some(base), Some(twice)) = (case("tables/base.csv"), case("tables/rows_twice.csv")) else { return };
    let (expected, (found, summary)) = (fuse(&base, "nomad200", &[]).0.exits(0), fuse(&twice, "nomad200", &[]));
    assert!(places(&found.exits(0)) == places(&expected));
    assert_eq!((tally(&summary, "/duplicates"), resolved(&summary)), (784, (122, 57)));
    is_told("rows_twice.csv", &["readings are there twice", "784 of 1568"]);
    let (Some(one), Some(two), Some(rig)) =
        (case("tables/one.csv"), case("tables/two.csv"), case("tables/one_two.toml"))
    else {
        return;
    };
    let (expected, (found, summary)) = (fuse(&one, &rig, &[]).0.exits(0), fuse(&two, &rig, &[]));
    assert_eq!((tally(&summary, "/duplicates"), tally(&summary, "/echoes/single")), (2, 2));
    assert!(places(&found.exits(0)) == places(&expected));
}

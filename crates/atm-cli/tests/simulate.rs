//! `atm simulate`: worlds in, logs and truth out.
#![cfg(feature = "lab")]

mod support;

use support::*;

const TRUTH_HEADER: &str = "t,sensor,x,y,azimuth,cause";

fn simulate(args: &[&str]) -> Ran {
    atm(["simulate"].iter().chain(args))
}

#[test]
fn sample_log_is_what_the_command_writes() {
    simulate(&["doorway", "--seed", "1"]).exits(0).writes(sample());
}

#[test]
fn same_arguments_write_the_same_bytes_and_another_seed_does_not() {
    let noise = ["room", "--noise", "range=1cm,dropout=5%,crosstalk=1%,multipath,odometry=1cm,heading=0.5deg"];
    let first = simulate(&noise).exits(0);
    simulate(&noise).exits(0).writes(&first.stdout);
    assert_ne!(simulate(&[noise[0], noise[1], noise[2], "--seed", "2"]).stdout, first.stdout);
}

#[test]
fn truth_has_a_row_for_each_echo_of_the_log() {
    let scratch = Scratch::new();
    let (log, truth) = (scratch.name("log.csv"), scratch.name("truth.csv"));
    simulate(&["doorway", "-o", &log, "--truth", &truth]).exits(0).writes_nothing();
    assert_eq!(scratch.list(), ["log.csv", "truth.csv"]);
    assert_same(read(&log).as_bytes(), sample().as_bytes());
    let truth = read(&truth);
    let mut rows = truth.lines();
    assert_eq!(rows.next(), Some(TRUTH_HEADER));
    let echoes: Vec<Row> = sample_rows().into_iter().filter(|row| row.echo().is_some()).collect();
    assert_eq!(rows.clone().count(), echoes.len());
    for (row, echo) in rows.zip(&echoes) {
        let cells: Vec<&str> = row.split(',').collect();
        let [t, sensor, x, y, azimuth, cause] = cells[..] else { panic!("not six cells: {row}") };
        assert_eq!((t, sensor), (&*echo.t, &*echo.sensor));
        assert!(["wall", "corner", "scatterer"].contains(&cause), "{row}");
        // Where the row says, seen from the sensor: the reading rounded it to an inch.
        let (from_x, from_y, direction) = echo.sensor_pose();
        let (x, y) = (number(x) - from_x, number(y) - from_y);
        assert_near(x.hypot(y), number(&echo.range), INCH / 2.0 + 1e-9);
        let bearing = y.atan2(x) - direction;
        assert_near((bearing - number(azimuth)).sin(), 0.0, 1e-9);
        assert!(number(azimuth).abs() <= BEAM / 2.0 + 1e-9);
    }
}

#[test]
fn world_file_rig_speed_and_rate_are_taken() {
    let scratch = Scratch::new();
    let world = scratch.file(
        "w.toml",
        "[[wall]]\npoints = [[-5, 1], [5, 1]]\nmaterial = \"specular\"\n[path]\nkind = \"straight\"\nfrom = [0, 0]\nto = [1, 0]\n",
    );
    let rig = scratch.file("r.toml", "[[sensor]]\nid = \"left, low\"\nyaw = \"90deg\"\n");
    let log = simulate(&[&world, "--rig", &rig, "--speed", "0.5m/s", "--rate", "2Hz"]).exits(0);
    let rows: Vec<String> = (0..5)
        .map(|i| format!("{:?},\"left, low\",1.0,{:?},0.0,0.0", f64::from(i) / 2.0, f64::from(i) * 0.25))
        .collect();
    log.writes(format!("t,sensor,range,x,y,yaw\n{}\n", rows.join("\n")));
}

#[test]
fn log_goes_through_fuse() {
    let log = simulate(&["room", "--truth", "/dev/null"]).exits(0);
    let fused = fuse_text(&log.stdout, &["--keep", "median"]).exits(0).echoes();
    assert!(fused.len() > 50, "{}", fused.len());
}

#[test]
fn recording_fuses_to_the_echoes_of_the_table() {
    let scratch = Scratch::new();
    let recording = scratch.name("log.mcap");
    simulate(&["doorway", "-o", &recording]).exits(0).writes_nothing();
    // Nothing names the sensors but the recording: ids are its frames. Ranges there are in single precision, and time is 1 s on.
    let found = atm(["fuse", &recording, "--range-resolution", "1in"]).exits(0).echoes();
    let expected = fuse_sample(&[]).exits(0).echoes();
    assert_eq!(found.len(), expected.len());
    let same = found.iter().zip(&expected).filter(|(found, expected)| {
        assert_eq!((number(&found.t), &found.sensor), (number(&expected.t) + 1.0, &expected.sensor));
        found.kind == expected.kind && (found.x - expected.x).hypot(found.y - expected.y) < 1e-5
    });
    // A rounded range may carry a crossing over the border of a beam, or across the least angle.
    assert!(same.count() >= expected.len() - 6, "of {}", expected.len());
}

#[test]
fn wrong_arguments_are_named() {
    simulate(&["doorway", "--set", "opening=-36in"]).exits(2).says(&["doorway: opening = -36in: must be above zero"]);
    simulate(&["doorway", "--set", "door=36in"])
        .exits(2)
        .says(&["door = 36in: no such parameter; expected one of opening"]);
    simulate(&["doorway", "--set", "opening"]).exits(2).says(&["opening is not KEY=VALUE"]);
    simulate(&["doorway", "--speed", "0"]).exits(2).says(&["speed = 0: must be above zero"]);
    simulate(&["doorway", "--rate", "1deg"]).exits(2).says(&["rate = 1deg"]);
    simulate(&["doorway", "--noise", "wind=1"]).exits(2).says(&["wind=1: no such effect"]);
    simulate(&["doorway", "-o", "x", "--truth", "x"]).exits(2).says(&["x is named for two outputs"]);
}

#[test]
fn unusable_worlds_are_named_with_file_line_and_key() {
    simulate(&["dooorway"]).exits(1).says(&["dooorway: no such world file, and no built-in world"]);
    let scratch = Scratch::new();
    let path = "[path]\nkind = \"straight\"\nfrom = [0, 0]\nto = [1, 0]\n";
    let cases = [
        (String::from(path), "w.toml: an empty world"),
        (
            format!("[[wall]]\npoints = [[0, 1], [0, 1]]\n{path}"),
            "w.toml:2: `wall.points` = [0, 1]: a wall of no length",
        ),
        (
            format!("[[wall]]\npoints = [[0.5, -1], [0.5, 1]]\n{path}"),
            "w.toml:3: `path`: leads through what line 2 describes",
        ),
        (
            format!("[[pole]]\nx = 0\ny = 0\nradius = 1\n{path}"),
            "w.toml:5: `path`: the robot would start inside what line 4",
        ),
        (
            format!("material = \"wool\"\n[[wall]]\npoints = [[0, 1], [1, 1]]\n{path}"),
            "w.toml:1: `material` = \"wool\": no such material",
        ),
        (format!("[[pole]]\nx = 0\ny = 2\nradius = -1\n{path}"), "w.toml:4: `pole.radius` = -1: must be above zero"),
        (format!("[[wall]]\nwidth = 3\n{path}"), "w.toml:2: unknown key `width` in [[wall]]"),
    ];
    for (text, words) in cases {
        let file = scratch.file("w.toml", text);
        simulate(&[&file]).exits(1).says(&[words]).writes_nothing();
    }
}

#[test]
fn world_file_is_not_overwritten() {
    let scratch = Scratch::new();
    let world = scratch.file("w.toml", "");
    simulate(&[&world, "-o", &world]).exits(2).says(&["would overwrite the input"]);
}

#[test]
fn drive_that_fails_on_its_way_leaves_no_log_under_its_name() {
    let scratch = Scratch::new();
    let log = scratch.name("log.csv");
    simulate(&["rough-wall", "--set", "distance=20cm", "-o", &log])
        .exits(1)
        .says(&["at t = 0 s sensor 3 would be inside or behind a surface", "log.csv.partial"]);
    assert_eq!(scratch.list(), ["log.csv.partial"]);
}

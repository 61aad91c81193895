//! Recordings that hold more than one robot, clock or rig: what is fused is right, or it is said whose it is.

mod support;

use serde_json::json;
use support::{recording::*, *};

#[track_caller]
fn fuse(recording: &Recording, more: &[&str]) -> (Ran, serde_json::Value) {
    let scratch = Scratch::new();
    let log = scratch.file("drive.mcap", recording.bytes());
    let counts = scratch.name("counts.json");
    let ran = atm(["fuse", &log, "--summary", &counts].iter().chain(more));
    let counts = if std::path::Path::new(&counts).exists() { read_json(&counts) } else { json!(null) };
    (ran, counts)
}

/// The drive with all of its topics in a namespace, and its poses a way off.
fn in_namespace(namespace: &str, away: f64) -> Recording {
    let mut recording = drive();
    let mut rows = sample_rows().into_iter();
    for message in &mut recording.messages {
        if message.topic == "/tf" {
            let t = message.log_time as i64 - 1;
            let row = rows.find(|row| stamp(row.time()) == t).expect("a row at that time");
            let at = [number(&row.x) + away, number(&row.y), number(&row.yaw)];
            message.data = transforms(&[Transform { t, parent: "odom", child: "base_link", at }]);
        }
        message.topic = format!("{namespace}{}", message.topic);
    }
    recording
}

/// Both recordings in one, in the order of their times.
fn together(one: Recording, other: Recording) -> Recording {
    let mut both = one;
    both.messages.extend(other.messages);
    both.messages.sort_by_key(|message| message.log_time);
    both
}

fn two_robots() -> Recording {
    together(in_namespace("/robot1", 0.0), in_namespace("/robot2", 100.0))
}

#[test]
fn each_of_two_robots_is_fused_as_if_it_was_alone() {
    let alone = |away| fuse(&in_namespace("", away), &[]).0.exits(0).stdout;
    let (ran, counts) = fuse(&two_robots(), &[]);
    ran.exits(3).says(&["784 other_robot", "/robot2"]).writes(alone(0.0));
    assert_eq!(counts["dropped"], json!({ "other_robot": 784 }));
    for flag in ["--tf-topics=/robot2/tf", "--pose-topic=/robot2/tf"] {
        let (ran, _) = fuse(&two_robots(), &[flag]);
        ran.exits(3).says(&["784 other_robot", "/robot1"]).writes(alone(100.0));
    }
}

#[test]
fn readings_outside_of_two_namespaces_are_refused_with_the_flag() {
    let mut both = two_robots();
    both.messages.retain(|message| !message.topic.starts_with("/robot2/sonar"));
    for message in &mut both.messages {
        message.topic = message.topic.replace("/robot1/sonar", "/sonar");
    }
    let (ran, _) = fuse(&both, &[]);
    ran.exits(1).says(&["/robot1 and /robot2", "--tf-topics /robot1/tf,/robot1/tf_static"]).writes_nothing();
    let expected = fuse(&drive(), &[]).0.exits(0).stdout;
    fuse(&both, &["--tf-topics", "/robot1/tf"]).0.exits(0).writes(expected);
}

#[test]
fn transforms_of_a_robot_are_not_those_of_its_twin() {
    let mut recording = in_namespace("/robot1", 0.0);
    for message in recording.messages.iter_mut().filter(|message| message.topic.contains("sonar")) {
        message.topic = message.topic.replace("/robot1", "/robot3");
    }
    fuse(&recording, &[]).0.exits(1).says(&["784", "no_transform"]).writes_nothing();
    // Of another part of the same robot they are, and that is said.
    for message in recording.messages.iter_mut().filter(|message| message.topic.contains("sonar")) {
        message.topic = message.topic.replace("/robot3", "/sensors");
    }
    fuse(&recording, &[]).0.exits(0).says(&["warning: transforms under /robot1", "--tf-topics"]);
}

#[test]
fn odometry_of_twins_is_refused_where_nothing_says_whose_the_readings_are() {
    let with_odometry = |names: [&str; 2]| {
        let mut recording = drive();
        recording.messages.retain(|message| message.topic != "/tf");
        for row in sample_rows() {
            let t = stamp(row.time());
            for name in names {
                let at = [number(&row.x), number(&row.y), number(&row.yaw)];
                recording.push(&format!("{name}/odom"), ODOMETRY, t, odometry(t, ["odom", "base_link"], at));
            }
        }
        recording.messages.sort_by_key(|message| message.log_time);
        recording
    };
    let twins = with_odometry(["/robot1", "/robot2"]);
    fuse(&twins, &[]).0.exits(1).says(&["/robot1/odom and /robot2/odom", "--pose-topic"]);
    fuse(&twins, &["--pose-topic", "/robot1/odom"]).0.exits(0);
    // Two sources of one robot are no twins.
    fuse(&with_odometry(["/wheels", "/visual"]), &[]).0.exits(0).says(&["not used: "]);
}

/// The drive with its readings' stamps shifted, in nanoseconds.
fn with_offset(offset: i64) -> Recording {
    let mut recording = drive();
    for message in recording.messages.iter_mut().filter(|message| message.topic.starts_with("/sonar")) {
        let t = message.log_time as i64 - 2 + offset;
        message.data[4..8].copy_from_slice(&((t / 1_000_000_000) as u32).to_le_bytes());
        message.data[8..12].copy_from_slice(&((t % 1_000_000_000) as u32).to_le_bytes());
    }
    recording
}

#[test]
fn another_clock_is_said_from_a_quarter_of_the_gap_on() {
    for (offset, words) in [(200, "0.200 s ahead of"), (-200, "0.200 s behind"), (2000, "2.000 s ahead of")] {
        let (ran, _) = fuse(&with_offset(offset * 1_000_000), &[]);
        ran.says(&["warning: the stamps of", words, "--clock log"]);
    }
    for offset in [-100, 0, 100] {
        let (ran, _) = fuse(&with_offset(offset * 1_000_000), &[]);
        assert!(!ran.stderr.contains("warning"), "{}", ran.stderr);
    }
}

#[test]
fn a_correction_of_the_map_costs_only_readings_that_lie_within_it() {
    let mut recording = drive();
    let times: Vec<i64> = recording
        .messages
        .iter()
        .filter(|message| message.topic == "/tf")
        .map(|message| message.log_time as i64 - 1)
        .collect();
    let middle = times[times.len() / 2];
    for &t in &times {
        let at = [if t >= middle { 3.0 } else { 0.0 }, 0.0, 0.0];
        // Just before each reading, so that none lies between the two.
        recording.push(
            "/tf",
            TRANSFORMS,
            t,
            transforms(&[Transform { t: t - 1000, parent: "map", child: "odom", at }]),
        );
        recording.push(
            "/tf",
            TRANSFORMS,
            t,
            transforms(&[Transform { t: t + 1000, parent: "map", child: "odom", at }]),
        );
    }
    recording.messages.sort_by_key(|message| message.log_time);
    for frame in [&[][..], &["--fixed-frame", "map"]] {
        let (ran, counts) = fuse(&recording, frame);
        assert_eq!(counts["readings"], 784, "{}", ran.stderr);
        ran.exits(0);
    }
    // One of them now lies within the jump.
    let moved = recording
        .messages
        .iter_mut()
        .find(|message| message.topic == "/sonar/3" && message.log_time as i64 - 2 == middle);
    let t = middle - 500_000_000;
    let message = moved.expect("a reading at that time");
    message.data[4..8].copy_from_slice(&((t / 1_000_000_000) as u32).to_le_bytes());
    message.data[8..12].copy_from_slice(&((t % 1_000_000_000) as u32).to_le_bytes());
    let (ran, counts) = fuse(&recording, &["--fixed-frame", "map", "--max-gap", "1s", "--max-speed", "2m/s"]);
    ran.exits(3).says(&["impossible_motion", "`odom` in `map`", "3.00 m", "--max-speed"]);
    assert_eq!(counts["dropped"], json!({ "impossible_motion": 1 }));
    fuse(&recording, &[]).0.exits(0);
}

#[test]
fn a_rig_says_one_limit_and_the_message_the_other() {
    let scratch = Scratch::new();
    let without_echo = |rig: &str| {
        let rig = scratch.file("rig.toml", rig);
        let (ran, counts) = fuse(&drive(), &["--rig", &rig]);
        ran.exits(0);
        tally(&counts, "/no_echo")
    };
    let sensors: String = (0..16).map(|sensor| format!("[[sensor]]\nid = '{sensor}'\n")).collect();
    let all = fuse(&drive(), &[]).1;
    assert_eq!(without_echo(&sensors), tally(&all, "/no_echo"), "a rig that says nothing changes nothing");
    let (near, far) =
        (without_echo(&format!("min_range = '1m'\n{sensors}")), without_echo(&format!("max_range = '3m'\n{sensors}")));
    let both = without_echo(&format!("min_range = '1m'\nmax_range = '3m'\n{sensors}"));
    let none = tally(&all, "/no_echo");
    assert!(near > none && far > none);
    assert_eq!(both - none, (near - none) + (far - none));
}

#[test]
fn a_key_of_the_rig_that_has_no_effect_on_a_recording_is_an_error() {
    let scratch = Scratch::new();
    for (key, value) in [("columns", "['t', '0']"), ("time_unit", "'ms'"), ("yaw_unit", "'deg'"), ("delimiter", "';'")]
    {
        let rig = scratch.file("rig.toml", format!("{}[log]\n{key} = {value}\n", drive_rig()));
        fuse(&drive(), &["--rig", &rig]).0.says(&[&format!("`{key}`"), "no effect on a recording"]).writes_nothing();
    }
}

#[test]
fn a_rig_of_another_robot_is_refused_and_an_idle_sensor_is_named() {
    let scratch = Scratch::new();
    let other = scratch.file("rig.toml", "[[sensor]]\nid = 'left'\n[[sensor]]\nid = 'right'\n");
    let out = scratch.name("echoes.csv");
    let (ran, _) = fuse(&drive(), &["--rig", &other, "-o", &out]);
    ran.exits(1).says(&["no sensor of the rig has a reading", "/sonar/0 (frame 0)"]);
    assert!(!std::path::Path::new(&out).exists() && !std::path::Path::new(&format!("{out}.partial")).exists());
    let half = scratch.file("rig.toml", "[[sensor]]\nid = '3'\n[[sensor]]\nid = 'right'\n");
    fuse(&drive(), &["--rig", &half]).0.exits(0).says(&["warning: no reading is of the rig's right"]);
}

#[test]
fn only_recordings_are_parts_of_one() {
    let scratch = Scratch::new();
    let log = scratch.file("drive.mcap", drive().bytes());
    atm(["fuse", &log, SAMPLE]).says(&[SAMPLE, "only recordings", "--out-dir"]).writes_nothing();
    atm(["fuse", SAMPLE, &log, "--rig", "nomad200"]).says(&["only recordings"]).writes_nothing();
    atm(["fuse", &log, &log, "--passthrough", "-o", &scratch.name("out.mcap")]).exits(2).says(&["--passthrough"]);
    let cut = scratch.file("cut.mcap", &drive().bytes()[..5000]);
    // What is lost of one part is told of it, and the next one is read.
    let (whole, parts) = (atm(["fuse", &log]).exits(0), atm(["fuse", &cut, &log]));
    parts.exits(3).says(&["truncated", "cut.mcap"]);
    assert!(!whole.echoes().is_empty());
}

#[test]
fn a_table_whose_pose_jumps_is_counted_and_goes_on() {
    let (scratch, table) = (Scratch::new(), std::fs::read_to_string(root().join(SAMPLE)).expect("the sample"));
    let expected = atm(FUSE).exits(0);
    let mut lines: Vec<String> = table.lines().map(str::to_owned).collect();
    // A record of its own time, 41 m away: two lines glued together.
    let middle = lines.len() / 2;
    let mut cells: Vec<String> = lines[middle].split(',').map(str::to_owned).collect();
    let columns: Vec<&str> = lines[0].split(',').collect();
    let at = |name: &str| columns.iter().position(|column| *column == name).expect("a column");
    let t: f64 = cells[at("t")].parse().expect("a time");
    cells[at("t")] = format!("{}", t + 0.01);
    cells[at("x")] = "41".to_owned();
    let after = lines.iter().position(|line| {
        line.split(',').nth(at("t")).and_then(|t| t.parse::<f64>().ok()).is_some_and(|later| later > t)
    });
    lines.insert(after.expect("a later line"), cells.join(","));
    let log = scratch.file("log.csv", lines.join("\n") + "\n");
    let ran = atm(["fuse", &log, "--rig", "nomad200"]).exits(3).says(&["1 impossible_motion", "--max-speed"]);
    assert_eq!(ran.stdout, expected.stdout);
    atm(["fuse", &log, "--rig", "nomad200", "--max-speed", "1e9m/s"]).exits(0);
}

#[test]
fn poses_of_a_second_file_that_jump_are_none_for_what_lies_between() {
    let scratch = Scratch::new();
    let rig = "[[sensor]]\nid = 'a'\n";
    let rig = scratch.file("rig.toml", rig);
    let log = scratch.file("log.csv", "t,sensor,range\n0.05,a,1\n0.15,a,1\n0.25,a,1\n");
    let poses = scratch.file("poses.csv", "t,x,y,yaw\n0,0,0,0\n0.1,0.1,0,0\n0.2,5,0,0\n0.3,5.1,0,0\n");
    let ran = atm(["fuse", &log, "--rig", &rig, "--poses", &poses]).exits(3);
    assert_eq!(ran.says(&["1 impossible_motion", "4.90 m"]).echoes().len(), 2);
}

/// Random numbers, the same on every run.
struct Random(u64);

impl Random {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((self.0 >> 11) as f64 / (1u64 << 53) as f64)
    }

    fn one_of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.between(0.0, choices.len() as f64) as usize % choices.len()]
    }
}

const NS: f64 = 1e9;
const START: i64 = 1_700_000_000_000_000_000;
const SENSORS: [&str; 2] = ["front", "left"];

/// A robot that was made up: where it is at a time, and what its sensors measure.
struct Robot {
    namespace: &'static str,
    at: [f64; 3],
    speed: [f64; 3],
    mounts: [[f64; 3]; 2],
    period: f64,
    phase: f64,
    /// Times in nanoseconds, sensors and ranges.
    readings: Vec<(i64, usize, f32)>,
}

impl Robot {
    fn new(random: &mut Random, namespace: &'static str) -> Self {
        let (period, phase) = (random.between(0.02, 0.3), random.between(0.0, 0.01));
        let mut three = |size: f64| [0; 3].map(|_| random.between(-size, size));
        let (at, speed, mounts) = (three(50.0), three(0.8), [three(0.3), three(0.3)]);
        let readings = (0..40)
            .map(|k| {
                let t = START + (f64::from(k) * 0.1 * NS) as i64 + random.between(0.0, 0.05 * NS) as i64;
                (t, k as usize % 2, random.between(0.3, 3.0) as f32)
            })
            .collect();
        Self { namespace, at, speed, mounts, period, phase, readings }
    }

    fn pose(&self, t: i64) -> [f64; 3] {
        let seconds = (t - START) as f64 / NS;
        [0, 1, 2].map(|part| self.at[part] + self.speed[part] * seconds)
    }

    /// The times of its poses: before all readings, and beyond them.
    fn pose_times(&self) -> impl Iterator<Item = i64> {
        let (period, phase) = ((self.period * NS) as i64, (self.phase * NS) as i64);
        (0..).map(move |k| START - period + phase + k * period).take_while(|t| *t < START + 5_000_000_000)
    }

    /// Its messages; `offset`: how far the stamps of its readings are off, in nanoseconds.
    fn record(&self, recording: &mut Recording, offset: i64, with_mounts: bool) {
        let namespace = self.namespace;
        let mounts: Vec<Transform<'_>> = SENSORS
            .iter()
            .zip(self.mounts)
            .map(|(child, at)| Transform { t: START, parent: "base_link", child, at })
            .collect();
        let known = if with_mounts { &mounts[..] } else { &mounts[..1] };
        recording.push(&format!("{namespace}/tf_static"), TRANSFORMS, START - 1_000_000_000, transforms(known));
        for t in self.pose_times() {
            let tf = Transform { t, parent: "odom", child: "base_link", at: self.pose(t) };
            recording.push(&format!("{namespace}/tf"), TRANSFORMS, t, transforms(&[tf]));
        }
        for &(t, sensor, range) in &self.readings {
            let reading = Reading { t: t + offset, frame: SENSORS[sensor], beam: 0.4, limits: [0.02, 4.0], range };
            recording.push(&format!("{namespace}/{}", SENSORS[sensor]), RANGE, t, reading.message());
        }
    }

    /// The middle of each reading's arc, by plain trigonometry: the pose between its neighbours, the mount, and the range.
    fn middles(&self) -> Vec<[f64; 2]> {
        let times: Vec<i64> = self.pose_times().collect();
        let middle = |&(t, sensor, range): &(i64, usize, f32)| {
            let after = times.iter().position(|pose| *pose >= t).expect("a pose after it");
            let (one, other) = (times[after - 1], times[after]);
            let share = (t - one) as f64 / (other - one) as f64;
            let (from, to) = (self.pose(one), self.pose(other));
            let [x, y, yaw] = [0, 1, 2].map(|part| from[part] + share * (to[part] - from[part]));
            let [mx, my, turn] = self.mounts[sensor];
            let (sin, cos) = yaw.sin_cos();
            let (sx, sy) = (x + cos * mx - sin * my, y + sin * mx + cos * my);
            [sx + f64::from(range) * (yaw + turn).cos(), sy + f64::from(range) * (yaw + turn).sin()]
        };
        self.readings.iter().map(middle).collect()
    }
}

#[test]
fn random_mixtures_of_two_robots_clocks_and_rigs_give_what_trigonometry_gives() {
    for seed in 1..=24 {
        let mut random = Random(seed);
        let (own, other) = random.one_of(&[("/robot1", "/robot2"), ("", "/robot2"), ("/a/r1", "/a/r2")]);
        let (mine, theirs) = (Robot::new(&mut random, own), Robot::new(&mut random, other));
        let offset = random.one_of(&[0, 0, 5, -5, 300]) * 1_000_000_000;
        let by_rig = random.between(0.0, 1.0) < 0.5;
        let mut recording = Recording::default();
        mine.record(&mut recording, offset, !by_rig);
        theirs.record(&mut recording, 0, true);
        recording.messages.sort_by_key(|message| message.log_time);
        let scratch = Scratch::new();
        let [x, y, yaw] = mine.mounts[1];
        let rig = scratch.file("rig.toml", format!("[[sensor]]\nid = 'left'\nx = {x}\ny = {y}\nyaw = '{yaw}rad'\n"));
        let topics = SENSORS.map(|sensor| format!("{own}/{sensor}")).join(",");
        // No reading meets another: each is reported at the middle of its arc.
        let mut flags = vec!["--max-age", "1ns", "--range-topics", &topics];
        if offset != 0 {
            flags.extend(["--clock", "log"]);
        }
        if by_rig {
            flags.extend(["--rig", &rig]);
        }
        let (ran, _) = fuse(&recording, &flags);
        let ran = ran.exits(0);
        let (echoes, expected) = (ran.echoes(), mine.middles());
        assert_eq!(echoes.len(), expected.len(), "seed {seed}: {}", ran.stderr);
        for (echo, [x, y]) in echoes.iter().zip(expected) {
            let error = (echo.x - x).hypot(echo.y - y);
            assert!(error < 1e-6, "seed {seed}: {error} m at {}: {}", echo.t, ran.stderr);
        }
        // Without the flag a clock that is off is never passed over in silence.
        if offset != 0 {
            let (ran, _) = fuse(&recording, &["--range-topics", &topics]);
            assert!(ran.stderr.contains("--clock log"), "seed {seed}: {}", ran.stderr);
        }
    }
}

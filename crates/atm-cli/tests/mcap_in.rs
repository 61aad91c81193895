//! Recordings as input: whatever their layout, the echoes are those of the same readings as a table.

mod support;

use mcap::Compression;
use support::{recording::*, *};

/// The echoes of the same readings as a table.
fn expected(more: &[&str]) -> Vec<Echo> {
    let scratch = Scratch::new();
    let rig = scratch.file("rig.toml", drive_rig());
    atm_fed(["fuse", "-", "--rig", &rig].iter().chain(more), drive_table()).exits(0).echoes()
}

/// Compares echoes: what is counted exactly, what is measured to a billionth.
#[track_caller]
fn assert_echoes(found: &[Echo], expected: &[Echo]) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        let what = |echo: &Echo| (echo.key(), echo.kind.clone(), echo.crossings);
        assert_eq!(what(found), what(expected));
        for (value, wanted) in [
            (found.x, expected.x),
            (found.y, expected.y),
            (found.range, expected.range),
            (found.azimuth, expected.azimuth),
            (found.resolution, expected.resolution),
        ] {
            assert_near(value, wanted, 1e-9);
        }
    }
}

#[track_caller]
fn fuse(recording: &Recording, more: &[&str]) -> Ran {
    let scratch = Scratch::new();
    let log = scratch.file("drive.mcap", recording.bytes());
    atm(["fuse", &log].iter().chain(more))
}

#[test]
fn every_layout_gives_the_echoes_of_the_table_and_so_does_a_pipe() {
    let (recording, expected, scratch) = (drive(), expected(&[]), Scratch::new());
    assert!(count(&expected, "median") > 100 && count(&expected, "single") > 20);
    let chunks = [None, Some(Compression::Lz4), Some(Compression::Zstd)].map(Layout::Chunks);
    for layout in chunks.into_iter().chain([Layout::Bare]) {
        let bytes = recording.laid_out(layout);
        // By its content, whatever it is called.
        let log = scratch.file("drive.csv", &bytes);
        let ran = atm(["fuse", &log]).exits(0).says(&["transforms up to the frame odom"]);
        assert_echoes(&ran.echoes(), &expected);
        atm_fed(["fuse", "-"], &bytes).exits(0).writes(&ran.stdout);
    }
}

#[test]
fn a_rig_says_where_sensors_sit_whose_frames_are_in_no_transform() {
    let mut recording = drive();
    recording.messages.retain(|message| message.topic != "/tf_static");
    let scratch = Scratch::new();
    let rig = scratch.file("rig.toml", drive_rig());
    assert_echoes(&fuse(&recording, &["--rig", &rig]).exits(0).echoes(), &expected(&[]));
    let ran = fuse(&recording, &[]).exits(1).says(&["784 no_transform", "the frame `0` is in no transform", "--rig"]);
    ran.writes_nothing();
}

#[test]
fn a_rig_finds_its_sensors_by_topic_or_frame_and_leaves_the_beam_to_the_messages() {
    let scratch = Scratch::new();
    let sensors: String = (0..16)
        .map(|sensor| {
            let [x, y, yaw] = mount(f64::from(sensor));
            let place = if sensor % 2 == 0 { format!("/sonar/{sensor}") } else { sensor.to_string() };
            format!("[[sensor]]\nid = 's{sensor}'\nx = {x}\ny = {y}\nyaw = '{yaw}rad'\ntopic = '{place}'\n")
        })
        .collect();
    let rig = scratch.file("rig.toml", sensors);
    let mut found = fuse(&drive(), &["--rig", &rig]).exits(0).echoes();
    for echo in &mut found {
        echo.sensor = echo.sensor.trim_start_matches('s').to_owned();
    }
    assert_echoes(&found, &expected(&[]));
}

/// The drive with the robot's poses in other messages than transforms.
fn with_poses(topic: &str, schema: &str, message: impl Fn(i64, [f64; 3]) -> Vec<u8>) -> Recording {
    let mut recording = drive();
    let mut rows = sample_rows().into_iter();
    for said in &mut recording.messages {
        if said.topic == "/tf" {
            let t = said.log_time as i64 - 1;
            let row = rows.find(|row| stamp(row.time()) == t).expect("a row at that time");
            let data = message(t, [number(&row.x), number(&row.y), number(&row.yaw)]);
            *said = Message { topic: topic.to_owned(), schema: schema.to_owned(), data, ..said.clone() };
        }
    }
    recording
}

#[test]
fn odometry_and_poses_do_as_well() {
    let odometry = with_poses("/odom", ODOMETRY, |t, at| odometry(t, ["odom", "base_link"], at));
    let poses = with_poses("/pose", POSE, |t, at| pose(t, "world", at));
    for (recording, source) in [(&odometry, "/odom in the frame odom"), (&poses, "/pose in the frame world")] {
        assert_echoes(&fuse(recording, &[]).exits(0).says(&[source]).echoes(), &expected(&[]));
    }
}

#[test]
fn transforms_come_before_odometry_and_both_can_be_forced() {
    let mut recording = drive();
    let shifted = with_poses("/odom", ODOMETRY, |t, [x, y, yaw]| odometry(t, ["odom", "base_link"], [x + 1.0, y, yaw]));
    recording.messages.extend(shifted.messages.into_iter().filter(|message| message.topic == "/odom"));
    recording.messages.sort_by_key(|message| message.log_time);
    let ran = fuse(&recording, &[]).exits(0).says(&["transforms", "not used: /odom", "--pose-topic"]);
    assert_echoes(&ran.echoes(), &expected(&[]));
    assert_echoes(&fuse(&recording, &["--pose-topic", "/tf"]).exits(0).echoes(), &expected(&[]));
    let mut moved = expected(&[]);
    for echo in &mut moved {
        echo.x += 1.0;
    }
    let ran = fuse(&recording, &["--pose-topic", "/odom"]).exits(0).says(&["/odom in the frame odom"]);
    assert_echoes(&ran.echoes(), &moved);
}

#[test]
fn the_fixed_frame_is_odom_though_it_moves_in_map_and_can_be_chosen() {
    let mut recording = drive();
    let said = recording.messages.iter().filter(|message| message.topic == "/tf");
    let times: Vec<i64> = said.map(|message| message.log_time as i64 - 1).collect();
    for t in times {
        let tf = Transform { t, parent: "map", child: "odom", at: [3.0, 4.0, 0.0] };
        recording.push("/tf", TRANSFORMS, t, transforms(&[tf]));
    }
    recording.messages.sort_by_key(|message| message.log_time);
    assert_echoes(&fuse(&recording, &[]).exits(0).echoes(), &expected(&[]));
    let mut moved = expected(&[]);
    for echo in &mut moved {
        (echo.x, echo.y) = (echo.x + 3.0, echo.y + 4.0);
    }
    let ran = fuse(&recording, &["--fixed-frame", "map"]).exits(0).says(&["the frame map"]);
    assert_echoes(&ran.echoes(), &moved);
    fuse(&recording, &["--fixed-frame", "earth"]).exits(1).says(&["784 no_transform", "there is no frame `earth`"]);
}

#[test]
fn poses_of_a_second_file_count_instead() {
    let scratch = Scratch::new();
    let mut poses = "t,x,y,yaw\n".to_owned();
    for row in sample_rows() {
        let t = stamp(row.time());
        poses += &format!("{}.{:09},{},{},{}\n", t / 1_000_000_000, t % 1_000_000_000, row.x, row.y, row.yaw);
    }
    let poses = scratch.file("poses.csv", poses);
    let mut recording = drive();
    recording.messages.retain(|message| message.topic != "/tf");
    assert_echoes(&fuse(&recording, &["--poses", &poses]).exits(0).echoes(), &expected(&[]));
}

#[test]
fn only_the_topics_that_are_asked_for_are_read() {
    let ran = fuse(&drive(), &["--range-topics", "/sonar/0,/sonar/4"]).exits(0);
    let mut sensors: Vec<String> = ran.echoes().into_iter().map(|echo| echo.sensor).collect();
    sensors.sort();
    sensors.dedup();
    assert_eq!(sensors, ["0", "4"]);
    fuse(&drive(), &["--range-topics", "/sonar/99"]).exits(1).says(&["there is no topic /sonar/99", "/sonar/15"]);
    fuse(&drive(), &["--range-topics", "/tf"]).exits(1).says(&["the topic /tf has no readings"]);
    fuse(&drive(), &["--pose-topic", "/sonar/0"]).exits(1).says(&["the topic /sonar/0 has no poses"]);
}

#[test]
fn flags_of_recordings_are_refused_for_a_table() {
    for flag in [["--clock", "log"], ["--reorder", "1s"], ["--pose-topic", "/odom"], ["--max-message", "1M"]] {
        fuse_sample(&flag).exits(2).says(&[flag[0], SAMPLE]);
    }
}

#[test]
fn a_recording_becomes_a_recording_with_all_that_it_held_and_the_same_bytes_each_time() {
    let scratch = Scratch::new();
    let log = scratch.file("drive.mcap", drive().bytes());
    let out = ["one.mcap", "two.mcap"].map(|name| scratch.name(name));
    for out in &out {
        atm(["fuse", &log, "-o", out, "--passthrough"]).exits(0).writes_nothing();
    }
    let [one, two] = out.map(|out| std::fs::read(out).expect("the output"));
    assert!(one == two, "the same input gives the same bytes");
    let mut copied = 0;
    for message in mcap::MessageStream::new(&one).expect("a recording") {
        let message = message.expect("a message");
        copied += usize::from(message.channel.schema.as_ref().is_some_and(|schema| schema.encoding == "ros2msg"));
    }
    assert_eq!(copied, drive().messages.len());
    // What was copied can be fused again, and gives the same echoes.
    let again = atm_fed(["fuse", "-"], &one).exits(0).echoes();
    assert_echoes(&again, &expected(&[]));
    atm(["fuse", &log, "--passthrough"]).exits(2).says(&["--passthrough", "no recording"]);
    fuse_sample(&["--passthrough", "--to", "mcap"]).exits(2).says(&["--passthrough", SAMPLE]);
}

//! Recordings that are wrong in some way: a clear error or a counted skip with topic and time, and the rest is used.

mod support;

use mcap::Compression;
use serde_json::{Value, json};
use support::{recording::*, *};

/// Runs `atm fuse` on bytes as a file. Returns how it ended, and what it counted.
fn fuse_bytes(bytes: &[u8], more: &[&str]) -> (Ran, Value) {
    let scratch = Scratch::new();
    let log = scratch.file("drive.mcap", bytes);
    let counts = scratch.name("counts.json");
    let ran = atm(["fuse", &log, "--summary", &counts].iter().chain(more));
    let counts = if std::path::Path::new(&counts).exists() { read_json(&counts) } else { Value::Null };
    (ran, counts)
}

#[track_caller]
fn fuse(recording: &Recording, more: &[&str]) -> (Ran, Value) {
    fuse_bytes(&recording.bytes(), more)
}

const READINGS: u64 = 784;

/// The drive with one of its messages changed: the `number`th of the topic.
fn with(topic: &str, number: usize, change: impl FnOnce(&mut Message)) -> Recording {
    let mut recording = drive();
    change(recording.messages.iter_mut().filter(|message| message.topic == topic).nth(number).expect("a message"));
    recording
}

/// What one changed message of /sonar/3 is counted as.
#[track_caller]
fn one_is(reason: &str, words: &[&str], change: impl FnOnce(&mut Message)) {
    let (ran, counts) = fuse(&with("/sonar/3", 5, change), &[]);
    let ran = ran.exits(3).says(&["/sonar/3 at 400", "drive.mcap, byte "]);
    ran.says(words);
    assert_eq!(counts["dropped"], json!({ reason: 1 }));
    assert_eq!(counts["readings"], READINGS - 1);
}

fn reading(message: &Message) -> Reading<'static> {
    Reading { t: message.log_time as i64 - 2, frame: "3", beam: BEAM_F32, limits: LIMITS_F32, range: 1.0 }
}

#[test]
fn a_message_that_ends_early_is_counted() {
    one_is("bad_message", &["it ends after 31 bytes"], |message| message.data.truncate(35));
    one_is("bad_message", &["it does not begin as CDR does"], |message| message.data.clear());
    one_is("bad_message", &["representation 3"], |message| message.data[1] = 3);
}

#[test]
fn a_message_may_have_more_or_less_behind_what_is_read() {
    for change in [-4_i64, 4, 1000] {
        let recording = with("/sonar/3", 5, |message| {
            let length = message.data.len() as i64 + change;
            message.data.resize(length as usize, 0);
        });
        assert_eq!(fuse(&recording, &[]).0.exits(0).stdout, fuse(&drive(), &[]).0.stdout);
    }
}

#[test]
fn a_text_of_4_gb_takes_no_memory() {
    one_is("bad_message", &["4294967295 more are to come"], |message| message.data[12..16].fill(0xff));
}

#[test]
fn a_list_of_4_billion_takes_no_memory() {
    let recording = with("/tf", 7, |message| message.data[4..8].fill(0xff));
    let (ran, counts) = fuse(&recording, &["--max-gap", "2s"]);
    ran.exits(3).says(&["1 bad_message", "/tf at 4007", "4294967295 elements"]);
    assert_eq!(counts["readings"], READINGS, "the poses around the missing one are near enough");
}

#[test]
fn a_stamp_of_zero_is_named_with_the_way_out() {
    one_is("no_stamp", &["--clock log"], |message| message.data = Reading { t: 0, ..reading(message) }.message());
}

#[test]
fn limits_and_beams_that_are_none_are_counted() {
    let limits = |limits| move |message: &mut Message| message.data = Reading { limits, ..reading(message) }.message();
    one_is("fixed_distance", &["min_range and max_range are both 0.5"], limits([0.5, 0.5]));
    one_is("bad_limits", &["min_range 2 is above max_range 1", "in a rig"], limits([2.0, 1.0]));
    one_is("bad_limits", &["min_range NaN"], limits([f32::NAN, 1.0]));
    one_is("bad_limits", &["field_of_view of 15"], |message| {
        message.data = Reading { beam: 15.0, ..reading(message) }.message();
    });
}

#[test]
fn a_beam_and_limits_that_nobody_has_filled_in_are_assumed_and_that_is_said() {
    let mut recording = drive();
    for message in recording.messages.iter_mut().filter(|message| message.topic == "/sonar/3") {
        let open = Reading { beam: 0.0, limits: [0.0, 0.0], ..reading(message) };
        message.data = open.message();
    }
    let (ran, counts) = fuse(&recording, &[]);
    ran.exits(0).says(&["22.5deg is assumed of 3"]);
    assert_eq!(counts["readings"], READINGS);
    fuse(&recording, &["--fov", "30deg"]).0.exits(0).says(&["30.0deg is assumed of 3"]);
}

#[test]
fn what_rep_117_says_of_infinities_and_of_what_is_out_of_bounds() {
    let without_echo = |range| {
        let recording = with("/sonar/3", 5, |message| message.data = Reading { range, ..reading(message) }.message());
        let (ran, counts) = fuse(&recording, &[]);
        ran.exits(0);
        assert_eq!(counts["readings"], READINGS);
        tally(&counts, "/no_echo")
    };
    let some = without_echo(1.0);
    for range in [f32::INFINITY, f32::NEG_INFINITY, f32::NAN, 0.0, 0.1, -1.0, LIMITS_F32[1], 7.0] {
        assert_eq!(without_echo(range), some + 1, "{range}");
    }
    assert_eq!(without_echo(LIMITS_F32[0]), some);
}

#[test]
fn a_frame_without_a_name_or_with_one_too_long_is_no_sensor() {
    one_is("unknown_sensor", &["frame_id of 0 bytes"], |message| {
        message.data = Reading { frame: "", ..reading(message) }.message();
    });
    let long: &'static str = Box::leak("x".repeat(300).into_boxed_str());
    one_is("unknown_sensor", &["frame_id of 300 bytes"], |message| {
        message.data = Reading { frame: long, ..reading(message) }.message();
    });
}

#[test]
fn two_topics_with_readings_of_one_frame_are_not_mixed() {
    let mut recording = drive();
    let copies: Vec<Message> =
        recording.messages.iter().filter(|message| message.topic == "/sonar/3").cloned().collect();
    let number = copies.len() as u64;
    recording.messages.extend(copies.into_iter().map(|message| Message { topic: "/raw".into(), ..message }));
    let (ran, counts) = fuse(&recording, &[]);
    let expected = fuse(&drive(), &[]).0.stdout;
    ran.exits(3).says(&["/raw at 4000", "has its readings under /sonar/3", "--range-topics"]).writes(expected);
    assert_eq!(counts["dropped"], json!({ "shared_frame": number }));
}

/// The drive with more transforms at its beginning.
fn with_transforms(more: &[Transform<'_>]) -> Recording {
    let mut recording = drive();
    let t = stamp(0.0);
    let said = Message { topic: "/tf".into(), schema: TRANSFORMS.into(), log_time: t as u64, data: transforms(more) };
    recording.messages.insert(1, said);
    recording
}

#[test]
fn a_loop_of_frames_and_a_second_parent_are_refused_and_the_tree_stays() {
    let t = stamp(0.0);
    let tf = |parent, child| Transform { t, parent, child, at: [1.0, 0.0, 0.0] };
    let expected = fuse(&drive(), &[]).0.stdout;
    for (more, words) in [
        (vec![tf("a", "b"), tf("b", "c"), tf("c", "a")], "`a` in `c` in `b` in `a` closes a loop"),
        (vec![tf("a", "a")], "`a` in `a` closes a loop"),
        (vec![tf("elsewhere", "3")], "`3` is in `base_link` already, and can't be in `elsewhere` as well"),
    ] {
        let (ran, counts) = fuse(&with_transforms(&more), &[]);
        ran.exits(3).says(&["1 bad_transform", "/tf at 4000", words]).writes(&expected);
        assert_eq!(counts["dropped"], json!({ "bad_transform": 1 }));
    }
}

#[test]
fn a_quaternion_without_a_direction_is_counted() {
    let recording = with("/tf", 3, |message| {
        let end = message.data.len();
        message.data[end - 32..].fill(0);
    });
    let (ran, counts) = fuse(&recording, &["--max-gap", "2s"]);
    ran.exits(3).says(&["1 bad_transform", "/tf at 4003", "the quaternion [0.0, 0.0, 0.0, 0.0] has no direction"]);
    assert_eq!(counts["readings"], READINGS);
}

#[test]
fn a_tree_in_two_pieces_is_named_with_the_missing_link() {
    let mut recording = drive();
    for message in recording.messages.iter_mut().filter(|message| message.topic == "/tf") {
        let t = message.log_time as i64 - 1;
        message.data = transforms(&[Transform { t, parent: "odom", child: "base_footprint", at: [0.0; 3] }]);
    }
    let (ran, counts) = fuse(&recording, &[]);
    ran.exits(1).says(&["784 no_transform", "`0` (under `base_link`)", "no transform between `odom` and `base_link`"]);
    assert_eq!((&counts["readings"], &counts["dropped"]), (&json!(0), &json!({ "no_transform": 784 })));
}

#[test]
fn poses_that_are_too_far_away_in_time_are_counted() {
    let mut recording = drive();
    recording.messages.retain(|message| message.topic != "/tf" || message.log_time % 2_000_000_000 == 1);
    let (ran, counts) = fuse(&recording, &[]);
    ran.exits(3).says(&["no_pose", "2.000 s apart, and the robot moved 0.25 m", "--max-gap 2s"]);
    assert_eq!(tally(&counts, "/readings") + tally(&counts, "/dropped/no_pose"), READINGS);
    // Two poses are too few to know that they always come so seldom; what somebody names is meant.
    assert_eq!(tally(&counts, "/readings"), READINGS - 16);
    let (ran, counts) = fuse(&recording, &["--max-gap", "0.5s"]);
    assert!(tally(&counts, "/dropped/no_pose") > 300);
    ran.exits(3);
    let (_, counts) = fuse(&recording, &["--max-gap", "1s"]);
    assert_eq!(tally(&counts, "/readings"), READINGS);
}

#[test]
fn a_recording_without_readings_or_without_poses_is_refused_with_what_it_has() {
    for layout in [Layout::Chunks(None), Layout::Bare] {
        let without = |part: &str| {
            let mut recording = drive();
            recording.messages.retain(|message| !message.topic.starts_with(part));
            fuse_bytes(&recording.laid_out(layout), &[]).0.exits(1)
        };
        without("/sonar").says(&["no topic has readings", "/tf (tf2_msgs/msg/TFMessage)"]);
        without("/tf").says(&["no topic has poses", "--poses", "/sonar/0 (sensor_msgs/msg/Range)"]);
        let empty = Recording::default().laid_out(layout);
        fuse_bytes(&empty, &[]).0.exits(1).says(&["no topic has readings", "there are no topics at all"]);
    }
}

#[test]
fn a_schema_that_names_range_and_is_none_is_refused_with_the_reason() {
    let topic_of = |definition: &str| {
        let mut recording = drive();
        recording.definitions.insert(RANGE.into(), definition.into());
        fuse(&recording, &[])
    };
    for (definition, words) in [
        ("std_msgs/Header header\nfloat32 distance\n", "it does not say what std_msgs/Header is"),
        (&definition(RANGE).replace("float32 field_of_view", "float32 fov"), "it has no field `field_of_view`"),
        (&definition(RANGE).replace("float32 range ", "string range "), "it has no field `range` of the kind"),
        (&definition(RANGE).replace("float32 range ", "float32[] range "), "it has no field `range`"),
        ("Range range\n", "types that hold types"),
        ("float32[ range\n", "is no field"),
    ] {
        let (ran, counts) = topic_of(definition);
        ran.exits(1).says(&["784 bad_schema", "/sonar/0 at 4000", words]).writes_nothing();
        assert_eq!(counts["dropped"], json!({ "bad_schema": 784 }));
    }
}

#[test]
fn a_schema_that_was_left_out_is_that_of_the_standard() {
    let mut recording = drive();
    for name in [RANGE, TRANSFORMS] {
        recording.definitions.insert(name.into(), String::new());
    }
    assert_eq!(fuse(&recording, &[]).0.exits(0).stdout, fuse(&drive(), &[]).0.stdout);
}

#[test]
fn a_boresight_out_of_the_plane_is_counted_from_ten_degrees_on() {
    let tilted = |degrees: f64| {
        let (sin, cos) = (degrees.to_radians() / 2.0).sin_cos();
        with("/tf_static", 0, |message| {
            // The last mount is that of sensor 15: its quaternion becomes a turn about y.
            let end = message.data.len();
            let parts = [0.0, sin, 0.0, cos].map(f64::to_le_bytes).concat();
            message.data[end - 32..].copy_from_slice(&parts);
        })
    };
    let (ran, counts) = fuse(&tilted(10.5), &[]);
    ran.exits(3).says(&["/sonar/15 at 4000", "points -10.5deg out of the plane"]);
    assert_eq!(counts["dropped"], json!({ "tilted": 49 }));
    let (ran, _) = fuse(&tilted(9.9), &[]);
    let scale = 9.9_f64.to_radians().cos();
    let flat = fuse(&tilted(0.0), &[]).0.exits(0).echoes();
    let ranges = |echoes: &[Echo]| -> Vec<f64> {
        echoes.iter().filter(|echo| echo.sensor == "15").map(|echo| echo.range).collect()
    };
    let (tilted, flat) = (ranges(&ran.exits(0).echoes()), ranges(&flat));
    assert!(flat.len() > 10 && tilted.len() == flat.len());
    for (tilted, flat) in tilted.iter().zip(&flat) {
        assert_near(*tilted, flat * scale, 1e-9);
    }
}

#[test]
fn a_chunk_whose_checksum_is_wrong_is_left_out_and_the_rest_is_used() {
    let bytes = drive().laid_out(Layout::Chunks(None));
    let whole = fuse_bytes(&bytes, &[]).0.exits(0).echoes();
    let mut damaged = bytes.clone();
    // In the middle of the third chunk: a bit of a message.
    let third = bytes.windows(9).enumerate().filter(|(_, window)| is_chunk(window)).nth(2).expect("three chunks").0;
    damaged[third + 5000] ^= 4;
    let (ran, counts) = fuse_bytes(&damaged, &[]);
    let ran = ran.exits(3).says(&["1 bad_chunk", &format!("byte {third}"), "its checksum is"]);
    assert_eq!(counts["input_damaged"], true);
    let echoes = ran.echoes();
    assert!(echoes.len() > whole.len() / 2 && echoes.len() < whole.len(), "{} of {}", echoes.len(), whole.len());
}

/// Whether a chunk of the size that is used here begins with these bytes.
fn is_chunk(head: &[u8]) -> bool {
    let length = u64::from_le_bytes(head[1..9].try_into().expect("eight bytes"));
    head[0] == 6 && (CHUNK / 2..2 * CHUNK).contains(&length)
}

#[test]
fn where_the_only_chunk_is_wrong_that_is_told_and_not_that_the_recording_is_empty() {
    let mut bytes = drive().laid_out(Layout::Chunks(None));
    let first = bytes.windows(9).position(is_chunk).expect("a chunk");
    // That chunk alone, and an end without a summary: nothing else says which topics there were.
    let length = u64::from_le_bytes(bytes[first + 1..first + 9].try_into().expect("eight bytes"));
    bytes.truncate(first + 9 + length as usize);
    bytes[first + 5000] ^= 4;
    bytes.extend_from_slice(&[&[15, 4][..], &[0; 11], &[2, 20], &[0; 27], b"\x89MCAP0\r\n"].concat());
    let (ran, counts) = fuse_bytes(&bytes, &[]);
    ran.exits(3).says(&["1 bad_chunk", &format!("byte {first}")]);
    assert_eq!((&counts["input_damaged"], &counts["readings"]), (&true.into(), &0.into()));
}

#[test]
fn a_chunk_that_can_not_be_unpacked_is_left_out() {
    for compression in [Compression::Zstd, Compression::Lz4] {
        let mut bytes = drive().laid_out(Layout::Chunks(Some(compression)));
        // The first chunk begins behind the magic and the header; its content some 60 bytes later.
        bytes[150..170].fill(0xee);
        let (ran, counts) = fuse_bytes(&bytes, &[]);
        ran.exits(3).says(&["bad_chunk"]);
        assert_eq!(counts["input_damaged"], true);
    }
}

#[test]
fn an_absurd_length_of_a_record_ends_the_file_there_and_takes_no_memory() {
    let mut bytes = drive().laid_out(Layout::Bare);
    let lost = bytes.len() - 5000;
    // Somewhere a record begins after these bytes: take the next message of the first range topic.
    let message = bytes[5000..].windows(11).position(|head| head[0] == 5 && head[3..9] == [0; 6]).expect("a message");
    bytes[5000 + message + 1..5000 + message + 9].fill(0xff);
    let (ran, counts) = fuse_bytes(&bytes, &[]);
    let ran = ran.exits(3).says(&["1 truncated", &format!("the last {} bytes", lost - message), "a message"]);
    assert!(!ran.echoes().is_empty());
    assert_eq!(counts["input_damaged"], true);
    let (ran, _) = with_summary(&["fuse", "-"], &bytes);
    ran.exits(3).says(&["1 truncated", &format!("the last {} bytes", lost - message)]);
}

#[test]
fn what_is_longer_than_allowed_is_counted_and_what_nobody_wants_may_be_as_long_as_it_likes() {
    let mut recording = drive();
    recording.push("/camera", IMAGE, stamp(0.0), image(stamp(0.0), 100_000));
    let expected = fuse(&drive(), &[]).0.stdout;
    fuse(&recording, &["--max-message", "10k"]).0.exits(0).writes(&expected);
    let (ran, counts) = fuse(&recording, &["--max-message", "60"]);
    ran.exits(1).says(&["too_long", "longer than --max-message"]);
    assert!(tally(&counts, "/dropped/too_long") > 700);
    for wrong in ["0", "-1", "1.5", "1T", "many"] {
        fuse(&recording, &[&format!("--max-message={wrong}")]).0.exits(2).says(&[wrong]);
    }
}

#[test]
fn strict_ends_with_the_first() {
    let scratch = Scratch::new();
    let recording = with("/sonar/3", 5, |message| message.data.truncate(35));
    let log = scratch.file("drive.mcap", recording.bytes());
    atm(["fuse", &log, "--strict"]).exits(1).says(&["drive.mcap, byte ", "bad_message: /sonar/3 at 400"]);
}

#[test]
fn what_is_no_recording_is_refused() {
    let scratch = Scratch::new();
    fuse_sample(&["--from", "mcap"]).exits(1).says(&[SAMPLE, "no MCAP recording"]);
    for (bytes, status) in [(&b"\x89MCAP0\r\n\x01rest"[..], 3), (b"\x89MCAP0\r\n", 3), (b"\x89MC", 3), (b"", 3)] {
        let log = scratch.file("drive.mcap", bytes);
        atm(["fuse", &log]).exits(status).says(&["truncated", "drive.mcap"]);
        atm(["info", &log]).exits(status).says(&["truncated", "drive.mcap"]);
    }
    // The same magic at the end of a file of another kind of noise.
    let mut noise = MAGIC.to_vec();
    noise.extend((0..50_000u32).map(|k| (k.wrapping_mul(2_654_435_761) >> 24) as u8));
    atm_fed(["fuse", "-"], &noise).exits(3).says(&["truncated"]);
}

const MAGIC: &[u8] = b"\x89MCAP0\r\n";

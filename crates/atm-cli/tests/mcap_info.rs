//! `atm info` of a recording.

mod support;

use serde_json::json;
use support::{recording::*, *};

fn info(recording: &Recording, more: &[&str]) -> Ran {
    let scratch = Scratch::new();
    let log = scratch.file("drive.mcap", recording.bytes());
    atm(["info", &log].iter().chain(more))
}

#[test]
fn sensors_topics_rates_limits_and_poses() {
    let ran = info(&drive(), &["--json"]).exits(0);
    let found = ran.json();
    assert_eq!(found["format"], "mcap");
    assert_eq!(found["pose_source"], "transforms up to the frame odom");
    assert_eq!((&found["start_ns"], &found["end_ns"]), (&json!(stamp(0.0)), &json!(stamp(48.0))));
    assert_eq!(found["sensors"].as_object().map(serde_json::Map::len), Some(16));
    let sensor = &found["sensors"]["3"];
    let no_echo = sample_rows().iter().filter(|row| row.sensor == "3" && row.echo().is_none()).count();
    assert_eq!((&sensor["topic"], &sensor["readings"]), (&json!("/sonar/3"), &json!(49)));
    assert_eq!(sensor["no_echo"], no_echo);
    assert_near(sensor["rate_hz"].as_f64().unwrap(), 1.0, 1e-12);
    assert_near(sensor["field_of_view_rad"].as_f64().unwrap(), BEAM, 1e-7);
    assert_near(sensor["min_range_m"].as_f64().unwrap(), 6.0 * INCH, 1e-7);
    assert_near(sensor["max_range_m"].as_f64().unwrap(), 255.0 * INCH, 1e-6);
    assert_eq!(found["problems"], json!([]));
}

#[test]
fn as_text_for_a_person() {
    let ran = info(&drive(), &[]).exits(0);
    let text = ran.text();
    for part in [
        "mcap, 16 sensors",
        "4000 to 4048 s",
        "poses     transforms up to the frame odom",
        "/sonar/15",
        "22.5deg",
        "6.48 m",
    ] {
        assert!(text.contains(part), "no `{part}` in {text}");
    }
}

#[test]
fn frames_that_do_not_hang_together_are_named_and_the_readings_are_there_all_the_same() {
    let mut recording = drive();
    for message in recording.messages.iter_mut().filter(|message| message.topic == "/tf") {
        let t = message.log_time as i64 - 1;
        message.data = transforms(&[Transform { t, parent: "odom", child: "base_footprint", at: [0.0; 3] }]);
    }
    let ran = info(&recording, &["--json"]).exits(3).says(&["784 no_transform"]);
    let found = ran.json();
    assert_eq!(found["sensors"]["3"]["readings"], 49);
    assert_eq!(found["pose_source"], json!(null));
    let problems = found["problems"].to_string();
    assert!(problems.contains("no transform between `odom` and `base_link`"), "{problems}");
    assert!(problems.contains("--poses"), "{problems}");
}

#[test]
fn a_gap_and_readings_without_a_pose_are_told() {
    let mut recording = drive();
    let from = stamp(20.0) as u64;
    recording
        .messages
        .retain(|message| !(from..from + 10_000_000_000).contains(&message.log_time) || message.topic == "/tf_static");
    let found = info(&recording, &["--json"]).exits(0).json();
    assert_near(found["longest_gap_s"].as_f64().unwrap(), 11.0, 1e-9);
    let mut recording = drive();
    recording.messages.retain(|message| message.topic != "/tf" || message.log_time < from);
    let ran = info(&recording, &["--json"]).exits(3);
    assert!(ran.json()["problems"].to_string().contains("no_pose"));
}

#[test]
fn a_recording_that_was_cut_off_says_so() {
    let bytes = drive().laid_out(Layout::Bare);
    let ran = atm_fed(["info", "-", "--json"], &bytes[..bytes.len() / 2]).exits(3).says(&["1 truncated"]);
    assert!(ran.json()["problems"].to_string().contains("cut off: the last"));
}

#[test]
fn without_poses_the_rest_is_told() {
    let mut recording = drive();
    recording.messages.retain(|message| message.schema == RANGE);
    let found = info(&recording, &["--json"]).json();
    assert_eq!(found["pose_source"], json!(null));
    assert_eq!(found["sensors"]["3"]["readings"], 49);
}

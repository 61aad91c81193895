//! Recordings whose messages are not in the order of their times, and clocks that are not the same.

mod support;

use serde_json::Value;
use support::{recording::*, *};

const SECOND: u64 = 1_000_000_000;

fn fuse(recording: &Recording, more: &[&str]) -> (Ran, Value) {
    let scratch = Scratch::new();
    let log = scratch.file("drive.mcap", recording.bytes());
    let counts = scratch.name("counts.json");
    let ran = atm(["fuse", &log, "--summary", &counts].iter().chain(more));
    (ran, read_json(&counts))
}

fn expected() -> Vec<u8> {
    fuse(&drive(), &[]).0.exits(0).stdout
}

/// The drive as if it was recorded later than it was measured: by so much, as the message says.
fn delayed(delay: impl Fn(&Message) -> u64) -> Recording {
    let mut recording = drive();
    for message in &mut recording.messages {
        message.log_time += delay(message);
    }
    recording.messages.sort_by_key(|message| message.log_time);
    recording
}

#[test]
fn messages_out_of_order_within_the_window_are_put_in_order() {
    // Up to 1.5 s late, each instant by its own time: instants, a second apart, change places.
    let recording = delayed(|message| message.log_time / SECOND * 7919 % 1500 * 1_000_000);
    let tops = |topic: &str| -> Vec<u64> {
        let of_topic = recording.messages.iter().filter(|message| message.topic == topic);
        of_topic.map(|message| u64::from(u32::from_le_bytes(message.data[4..8].try_into().expect("seconds")))).collect()
    };
    assert!(!tops("/sonar/3").is_sorted());
    fuse(&recording, &[]).0.exits(0).writes(expected());
    let (ran, _) = fuse(&recording, &["--reorder", "0.05s"]);
    ran.exits(3).says(&["time_backwards"]);
}

#[test]
fn messages_that_stand_anywhere_within_the_window_need_no_order_in_the_file() {
    let mut recording = drive();
    // As chunks of several writers are: blocks of a second and a half, each from back to front, log times untouched.
    let first = recording.messages[0].log_time;
    let block = |message: &Message| (message.log_time - first) / (2 * SECOND);
    let count = recording.messages.len() as u64;
    let keyed = recording.messages.into_iter().zip(0u64..);
    let mut keyed: Vec<(u64, u64, Message)> =
        keyed.map(|(message, number)| (block(&message), count - number, message)).collect();
    keyed.sort_by_key(|(block, number, _)| (*block, *number));
    recording.messages = keyed.into_iter().map(|(.., message)| message).collect();
    let (ran, counts) = fuse(&recording, &["--reorder", "5s"]);
    ran.exits(0);
    assert_eq!(counts["readings"], 784);
    // Without a window the same file is out of order, and nothing of that is silent.
    let (ran, counts) = fuse(&recording, &["--reorder", "0s"]);
    ran.exits(1);
    assert_eq!(
        counts["readings"].as_u64().unwrap()
            + counts["dropped"].as_object().unwrap().values().map(|n| n.as_u64().unwrap()).sum::<u64>(),
        784
    );
}

#[test]
fn a_transform_that_is_recorded_after_its_readings_is_waited_for() {
    let late = |by: u64| delayed(move |message| if message.topic == "/tf" { by } else { 0 });
    fuse(&late(1900 * 1_000_000), &[]).0.exits(0).writes(expected());
    let (ran, counts) = fuse(&late(3 * SECOND), &[]);
    ran.exits(3).says(&["no_pose", "no transform of `base_link` in `odom` at that time", "none comes after it"]);
    assert!(tally(&counts, "/dropped/no_pose") > 600);
    fuse(&late(3 * SECOND), &["--reorder", "4s"]).0.exits(0).writes(expected());
}

#[test]
fn a_reading_that_comes_later_than_the_window_is_counted() {
    let recording = delayed(|message| {
        let is_one = message.topic == "/sonar/3" && message.log_time == stamp(20.0) as u64 + 2;
        if is_one { 5 * SECOND } else { 0 }
    });
    let (ran, counts) = fuse(&recording, &[]);
    ran.exits(3).says(&["1 time_backwards", "t 4020 after 402"]);
    assert_eq!(counts["readings"], 783);
    let (ran, counts) = fuse(&recording, &["--reorder", "6s"]);
    ran.exits(0);
    assert_eq!(counts["readings"], 784);
}

/// The drive twice, the stamps of the second one back at the beginning: a simulation that was started again.
fn started_again() -> Recording {
    let mut recording = drive();
    let again = recording.messages.clone();
    let length = 60 * SECOND;
    recording
        .messages
        .extend(again.into_iter().map(|message| Message { log_time: message.log_time + length, ..message }));
    recording
}

#[test]
fn a_clock_that_was_set_back_is_counted_as_in_a_table_and_time_goes_on() {
    let scratch = Scratch::new();
    let rig = scratch.file("rig.toml", drive_rig());
    let table = drive_table();
    let rows = table.split_once('\n').expect("a header").1;
    let (expected, expected_counts) = with_summary(&["fuse", "-", "--rig", &rig], format!("{table}{rows}"));
    assert_eq!(expected_counts["clock_resets"], 1);
    let (ran, counts) = fuse(&started_again(), &[]);
    assert_eq!(counts, expected_counts);
    let (found, expected) = (ran.exits(3).echoes(), expected.exits(3).echoes());
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(&expected) {
        assert_eq!((found.key(), &found.kind), (expected.key(), &expected.kind));
        assert_near(found.x, expected.x, 1e-9);
    }
}

#[test]
fn which_clock_counts_can_be_chosen() {
    let mut recording = drive();
    // Stamps that nobody has filled in, of readings and of transforms.
    for message in &mut recording.messages {
        match message.topic.as_str() {
            "/tf_static" => {}
            "/tf" => message.data[8..16].fill(0),
            _ => message.data[4..12].fill(0),
        }
    }
    let (ran, counts) = fuse(&recording, &[]);
    ran.exits(1).says(&["833 no_stamp", "the stamp in its header is 0; --clock log"]);
    assert_eq!(counts["readings"], 0);
    for clock in ["log", "publish"] {
        // Transforms are recorded a nanosecond before their readings: those of the last instant have none behind them.
        let (ran, counts) = fuse(&recording, &["--clock", clock, "--max-gap", "2s"]);
        ran.exits(3).says(&["16 no_pose"]);
        assert_eq!(counts["readings"], 784 - 16);
    }
    fuse(&drive(), &["--clock", "header"]).0.exits(0).writes(expected());
}

#[test]
fn simulated_time_is_noticed_and_named() {
    let day = 86_400 * SECOND;
    let recording = delayed(|_| day);
    let (ran, _) = fuse(&recording, &[]);
    ran.exits(0).says(&["the stamps are -86400 s from the times of recording"]).writes(expected());
    let mut with_clock = recording;
    with_clock.definitions.insert("rosgraph_msgs/msg/Clock".into(), "builtin_interfaces/Time clock\n".into());
    with_clock.messages.insert(
        0,
        Message {
            topic: "/clock".into(),
            schema: "rosgraph_msgs/msg/Clock".into(),
            log_time: day,
            data: Cdr::default().u32(0).u32(0).message(),
        },
    );
    fuse(&with_clock, &[]).0.exits(0).says(&["which are of a simulated time"]);
}

#[test]
fn a_topic_on_another_clock_is_named() {
    let mut recording = drive();
    for message in recording.messages.iter_mut().filter(|message| message.topic == "/sonar/3") {
        message.data[4..8].copy_from_slice(&2_000_000_000_u32.to_le_bytes());
    }
    let (ran, _) = fuse(&recording, &[]);
    ran.exits(3).says(&["no_pose", "the stamps of /sonar/3 are", "those of /sonar/0 are not", "--clock log"]);
}

#[test]
fn live_from_a_pipe_without_a_window_gives_each_echo_at_once() {
    let log = drive().laid_out(Layout::Bare);
    let settled = atm_fed(["fuse", "-", "--reorder", "0s", "--max-gap", "2s"], &log).exits(0);
    assert_eq!(settled.echoes().len(), 631);
    let latest = atm_fed(["fuse", "-", "--emit", "latest", "--reorder", "0s", "--max-gap", "2s"], &log).exits(0);
    assert!(latest.echoes().len() > 600);
}

//! Another recording beside what is fused.

use std::{collections::BTreeMap, sync::Arc};

use atm::{
    log::{
        Row,
        mcap::{
            Attachment, Channel, Message, Metadata, Schema, Tap,
            write::{McapSink, Options, PassThrough, SENSORS, SchemaKind},
        },
    },
    pipeline::{EchoSink, Emit},
};

use crate::sample::{KINDS, Logged, Recorded, doorway, fuse, messages, of_topic, options, sink, summary};

const SECOND: u64 = 1_000_000_000;

fn passing(kind: SchemaKind) -> Options {
    Options { pass_window: Some(2 * SECOND), ..options(kind) }
}

fn channel(id: u16, topic: &str) -> Arc<Channel> {
    let schema =
        Schema { id: 7, name: "pkg/msg/Big".into(), encoding: "ros2msg".into(), data: b"uint8[] data\n".to_vec() };
    let offered = BTreeMap::from([
        ("offered_qos_profiles".to_owned(), "- history: keep_last\n  reliability: best_effort\n".to_owned()),
        ("publisher".to_owned(), id.to_string()),
    ]);
    Arc::new(Channel {
        id,
        schema: Some(Arc::new(schema)),
        topic: topic.into(),
        encoding: "cdr".into(),
        metadata: offered,
    })
}

fn message(channel: u16, log_time: u64, data: &[u8]) -> Message<'_> {
    Message { channel, sequence: 40 + channel as u32, log_time, publish_time: log_time.saturating_sub(5), data }
}

/// Fuses the sample while `feed` is told, before each record, the passing and the time in nanoseconds.
fn fuse_beside(
    options: Options,
    feed: &mut dyn FnMut(&mut PassThrough<Vec<u8>>, u64),
) -> (McapSink<Vec<u8>>, PassThrough<Vec<u8>>) {
    let mut sink = sink(options);
    let mut passing = sink.pass_through();
    let mut last = None;
    let mut before = |_: &mut McapSink<_>, row: &Row| {
        if last != Some(row.log_time) {
            last = Some(row.log_time);
            feed(&mut passing, row.log_time as u64);
        }
    };
    fuse(&doorway(), Emit::Settled, &mut Recorded { sink: &mut sink, after_record: &mut before }).unwrap();
    (sink, passing)
}

#[test]
fn the_other_recording_is_copied_unchanged_and_in_order() {
    for kind in KINDS {
        // A second ahead of the readings, its channels out of step with each other.
        let mut sent = Vec::new();
        let mut begun = false;
        let mut feed = |passing: &mut PassThrough<_>, now: u64| {
            if !std::mem::replace(&mut begun, true) {
                passing.channel(&channel(3, "/camera")).unwrap();
                passing.channel(&channel(1, "/imu")).unwrap();
            }
            for (channel, late) in [(3, 0), (1, SECOND / 2), (3, SECOND / 4)] {
                let message = message(channel, now + SECOND - late, b"image");
                passing.message(message).unwrap();
                sent.push((message.log_time, message.publish_time, message.sequence));
            }
        };
        let (sink, _passing) = fuse_beside(passing(kind), &mut feed);
        assert_eq!(sink.late(), 0);
        let file = sink.finish().unwrap();
        let all = messages(&file);
        assert!(all.is_sorted_by_key(|message| message.log_time));
        let copied: Vec<&Logged> =
            all.iter().filter(|message| ["/camera", "/imu"].contains(&&*message.topic)).collect();
        sent.sort_unstable();
        let mut found: Vec<_> = copied.iter().map(|one| (one.log_time, one.publish_time, one.sequence)).collect();
        found.sort_unstable();
        assert_eq!(found, sent);
        for one in copied {
            assert_eq!((one.schema.as_str(), one.encoding.as_str(), &*one.data), ("pkg/msg/Big", "cdr", &b"image"[..]));
            assert!(one.metadata["offered_qos_profiles"].contains("best_effort"));
        }
        // What is fused is all there, beside it.
        let alone = crate::sample::recorded(&doorway(), options(kind));
        for topic in ["/atm/echoes", "/atm/arcs", "/atm/crossings/points"] {
            let data =
                |file: &[u8]| of_topic(file, topic).into_iter().map(|one| (one.log_time, one.data)).collect::<Vec<_>>();
            assert!(data(&file) == data(&alone), "{topic}");
        }
        // Numbers of channels are the other recording's own.
        let summary = summary(&file);
        assert_eq!(summary.channels[&3].topic, "/camera");
        assert_eq!(summary.channels[&1].topic, "/imu");
    }
}

#[test]
fn offers_are_written_in_the_words_of_the_other_recording() {
    let offers = |channels: &[Arc<Channel>]| {
        let mut begun = false;
        let mut feed = |passing: &mut PassThrough<_>, _| {
            if !std::mem::replace(&mut begun, true) {
                channels.iter().for_each(|channel| passing.channel(channel).unwrap());
            }
        };
        let (sink, _passing) = fuse_beside(passing(SchemaKind::Ros2), &mut feed);
        let mounts = of_topic(&sink.finish().unwrap(), "/tf_static");
        mounts[0].metadata["offered_qos_profiles"].clone()
    };
    assert!(offers(&[channel(1, "/imu")]).contains("durability: transient_local"));
    assert!(offers(&[]).contains("durability: 1\n"));
}

#[test]
fn messages_later_than_the_window_are_copied_and_counted() {
    let mut begun = false;
    let mut feed = |passing: &mut PassThrough<_>, now: u64| {
        if !std::mem::replace(&mut begun, true) {
            passing.channel(&channel(1, "/imu")).unwrap();
        }
        passing.message(message(1, now + 100, b"in time")).unwrap();
        if now >= 10 * SECOND {
            passing.message(message(1, now - 5 * SECOND, b"late")).unwrap();
        }
    };
    let (sink, _passing) = fuse_beside(passing(SchemaKind::Foxglove), &mut feed);
    assert_eq!(sink.late(), 39);
    let copied = of_topic(&sink.finish().unwrap(), "/imu");
    assert_eq!(copied.iter().filter(|message| message.data == b"late").count(), 39);
    assert_eq!(copied.iter().filter(|message| message.data == b"in time").count(), 49);
}

#[test]
fn topics_and_metadata_of_the_same_names_are_told_apart() {
    let mut begun = false;
    let mut feed = |passing: &mut PassThrough<_>, now: u64| {
        if !std::mem::replace(&mut begun, true) {
            passing.channel(&channel(1, "/atm/echoes")).unwrap();
            passing.channel(&channel(2, "/tf")).unwrap();
            for name in [SENSORS, "survey"] {
                let entries = BTreeMap::from([("0".to_owned(), "theirs".to_owned())]);
                passing.metadata(&Metadata { name: name.into(), entries }).unwrap();
            }
            let (name, media_type, data) = ("map.yaml", "text/yaml", &b"resolution: 0.05"[..]);
            passing.attachment(Attachment { log_time: 3, create_time: 2, name, media_type, data }).unwrap();
        }
        passing.message(message(1, now, b"theirs")).unwrap();
        // A message of a channel that nobody declared has nowhere to go.
        passing.message(message(9, now, b"lost")).unwrap();
    };
    let (sink, _passing) = fuse_beside(passing(SchemaKind::Foxglove), &mut feed);
    let file = sink.finish().unwrap();
    assert!(of_topic(&file, "/input/atm/echoes").iter().all(|message| message.data == b"theirs"));
    assert_eq!(of_topic(&file, "/input/atm/echoes").len(), 49);
    assert!(of_topic(&file, "/atm/echoes").iter().all(|message| message.schema == "foxglove.PointCloud"));
    // Two kinds of transforms under one topic would be unreadable.
    assert!(!of_topic(&file, "/atm/tf").is_empty() && of_topic(&file, "/tf").is_empty());
    let summary = summary(&file);
    let mut names: Vec<&str> = summary.metadata_indexes.iter().map(|index| index.name.as_str()).collect();
    names.sort_unstable();
    assert_eq!(names, [SENSORS, "input.atm.sensors", "survey"]);
    assert_eq!(crate::sample::sensor_names(&file)[&0], "0");
    let [index] = &summary.attachment_indexes[..] else { panic!("one attachment") };
    let attachment = mcap::read::attachment(&file, index).unwrap();
    assert_eq!((attachment.name.as_str(), &*attachment.data), ("map.yaml", &b"resolution: 0.05"[..]));
    assert_eq!((attachment.log_time, attachment.create_time, attachment.media_type.as_str()), (3, 2, "text/yaml"));
}

#[test]
fn messages_that_wait_are_bounded_in_bytes() {
    // A hundred megabytes at one moment: all but the bound has to be written before its turn.
    let big = vec![7u8; 4 << 20];
    let mut begun = false;
    let mut feed = |passing: &mut PassThrough<_>, now: u64| {
        if !std::mem::replace(&mut begun, true) {
            passing.channel(&channel(1, "/camera")).unwrap();
            for index in 0..25 {
                passing.message(message(1, now + SECOND + index, &big)).unwrap();
            }
        }
    };
    let mut sink = sink(passing(SchemaKind::Foxglove));
    let mut pass = sink.pass_through();
    feed(&mut pass, 0);
    sink.flush().unwrap();
    fuse(&doorway(), Emit::Settled, &mut sink).unwrap();
    let all = messages(&sink.finish().unwrap());
    assert!(all.is_sorted_by_key(|message| message.log_time));
    let first_own = all.iter().position(|message| message.topic != "/camera").unwrap();
    assert_eq!(first_own, 13, "100 MiB less the 48 that may wait");
    assert_eq!(all.iter().filter(|message| message.topic == "/camera").count(), 25);
}

#[test]
fn the_profile_promises_no_more_than_every_channel_holds() {
    let profile = |kind, profile: &str| {
        let sink = sink(passing(kind));
        sink.pass_through().header(profile, "somebody").unwrap();
        let file = sink.finish().unwrap();
        let header = mcap::read::LinearReader::new(&file).unwrap().next().unwrap().unwrap();
        let mcap::records::Record::Header(header) = header else { panic!("a header comes first") };
        header.profile
    };
    assert_eq!(profile(SchemaKind::Ros2, "ros2"), "ros2");
    assert_eq!(profile(SchemaKind::Ros2, "ros1"), "");
    assert_eq!(profile(SchemaKind::Foxglove, "ros2"), "");
}

#[test]
fn a_tap_that_outlives_its_file_is_told_so() {
    let sink = sink(passing(SchemaKind::Foxglove));
    let mut passing = sink.pass_through();
    sink.finish().unwrap();
    let error = passing.channel(&channel(1, "/imu")).unwrap_err();
    assert!(error.to_string().contains("finished"), "{error}");
}

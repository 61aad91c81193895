//! A simulated robot's recording.

use std::f64::consts::PI;

use atm::{
    log::mcap::write::RecordingWriter,
    rig::{Ranging, Rig, Sensor},
    track::Pose,
};
use nalgebra::{Isometry2, Vector2};

use crate::{
    cdr::Cdr,
    sample::{messages, of_topic, summary},
};

fn rig() -> Rig {
    let sensor = |id: &str, yaw: f64, field_of_view| {
        let ranging = Ranging { field_of_view, min_range: 0.2, max_range: 4.0, range_resolution: None };
        Sensor::new(id, Isometry2::new(Vector2::new(0.3, 0.1), yaw), ranging).unwrap()
    };
    Rig::new("bumper", vec![sensor("left", 0.5, Some(1.0)), sensor("1", -PI / 2.0, None)]).unwrap()
}

fn recording() -> Vec<u8> {
    let start = 1_700_000_000_000_000_005;
    let mut recording = RecordingWriter::create(Vec::new(), "drive.mcap".into(), &rig(), start).unwrap();
    for step in 0..10 {
        let t = start + step * 100_000_000;
        recording.pose(t, Pose { x: step as f64, y: -0.25, yaw: 4.0 }).unwrap();
        recording.range(t, 0, 1.5).unwrap();
        recording.range(t, 1, f64::INFINITY).unwrap();
        recording.range(t, 2, 1.0).unwrap();
    }
    recording.finish().unwrap()
}

#[test]
fn ranges_carry_what_the_rig_says() {
    let file = recording();
    for (topic, frame, field_of_view, range) in
        [("/range/left", "left", 1.0, 1.5), ("/range/sensor_1", "1", (PI / 8.0) as f32, f32::INFINITY)]
    {
        let ranges = of_topic(&file, topic);
        assert_eq!(ranges.len(), 10);
        for (step, message) in (0..).zip(&ranges) {
            assert_eq!((message.schema.as_str(), message.encoding.as_str()), ("sensor_msgs/msg/Range", "cdr"));
            let mut fields = Cdr::new(&message.data);
            assert_eq!(fields.header(), (1_700_000_000_000_000_005 + step * 100_000_000, frame));
            assert_eq!(message.log_time, (1_700_000_000_000_000_005 + step * 100_000_000) as u64);
            assert_eq!(fields.u8(), 0);
            assert_eq!([fields.f32(), fields.f32(), fields.f32()], [field_of_view, 0.2, 4.0]);
            assert_eq!([fields.f32(), fields.f32()], [range, 0.0]);
            fields.end();
        }
    }
}

#[test]
fn transforms_lead_from_the_fixed_frame_to_each_sensor() {
    let file = recording();
    let first = &messages(&file)[0];
    assert_eq!(first.topic, "/tf_static");
    assert!(first.metadata["offered_qos_profiles"].contains("durability: 1\n"), "transient local");
    let mut mounts = Cdr::new(&first.data);
    assert_eq!(mounts.u32(), 2);
    for (child, yaw) in [("left", 0.5), ("1", -PI / 2.0)] {
        assert_eq!(mounts.header().1, "base_link");
        assert_eq!(mounts.string(), child);
        let pose = mounts.pose();
        assert!((pose[2] - yaw).abs() < 1e-15);
        assert_eq!(pose[..2], [0.3, 0.1]);
    }
    mounts.end();
    let robot = of_topic(&file, "/tf");
    assert_eq!(robot.len(), 10);
    let mut last = Cdr::new(&robot[9].data);
    assert_eq!((last.u32(), last.header().1, last.string()), (1, "odom", "base_link"));
    let [x, y, yaw] = last.pose();
    assert_eq!([x, y], [9.0, -0.25]);
    assert!((yaw - 4.0).rem_euclid(2.0 * PI).min((4.0 - yaw).rem_euclid(2.0 * PI)) < 1e-12);
}

#[test]
fn it_is_a_recording_of_ros_2() {
    let file = recording();
    assert!(file == recording(), "the same bytes");
    let header = mcap::read::LinearReader::new(&file).unwrap().next().unwrap().unwrap();
    assert!(matches!(header, mcap::records::Record::Header(header) if header.profile == "ros2"));
    let summary = summary(&file);
    assert!(summary.schemas.values().all(|schema| schema.encoding == "ros2msg"));
    // The player reads policies by number where there is this record, and by name where there is not.
    assert!(summary.metadata_indexes.iter().any(|index| index.name == "rosbag2"));
}

//! Whether a recording has the topics it has to have.

use std::sync::Arc;

use super::{decode::Kind, options::Options, raw::Channel};
use crate::log::csv::PoseUse;

/// What of a channel is read, with the topics of readings and of scans that were asked for.
pub(super) fn kind_of(channel: &Channel, topics: &[String], scans: &[String]) -> Option<Kind> {
    let asked = |kind: &Kind| match kind {
        Kind::Scan => scans.contains(&channel.topic),
        Kind::Range | Kind::Ranges => topics.is_empty() || topics.contains(&channel.topic),
        _ => true,
    };
    Kind::of(channel).filter(asked)
}

/// Whether a channel is the time of a simulation.
pub(super) fn is_clock(channel: &Channel) -> bool {
    channel.topic == "/clock"
        || channel.schema.as_ref().is_some_and(|schema| schema.name.ends_with("rosgraph_msgs/msg/Clock"))
}

/// Refuses a recording without readings, without poses where it needs its own, or without a topic that was asked for, all of
/// its channels known; in words.
pub(super) fn check<'a>(
    channels: impl Iterator<Item = &'a Arc<Channel>>,
    options: &Options,
    has_track: bool,
) -> Result<(), String> {
    let kinds: Vec<(&Channel, Option<Kind>)> = channels.map(|channel| (&**channel, Kind::of(channel))).collect();
    let refuse = |message: String| Err(format!("{message}; {}", all(kinds.iter().map(|(channel, _)| *channel))));
    let is_range = |kind: Kind| matches!(kind, Kind::Range | Kind::Ranges);
    for wanted in &options.scan_topics {
        if !kinds.iter().any(|(channel, kind)| channel.topic == *wanted && *kind == Some(Kind::Scan)) {
            return refuse(format!("there is no topic {wanted} of sensor_msgs/LaserScan, in CDR or as ROS 1 has it"));
        }
    }
    let readings = options.range_topics.iter().map(|topic| (topic, true, "readings"));
    let poses = options.pose_topic.iter().map(|topic| (topic, false, "poses"));
    let poses = poses.chain(options.tf_topics.iter().map(|topic| (topic, false, "transforms")));
    for (wanted, fits, what) in readings.chain(poses) {
        let mut named = kinds.iter().filter(|(channel, _)| channel.topic == *wanted).peekable();
        if named.peek().is_none() {
            return refuse(format!("there is no topic {wanted}"));
        }
        if !named.any(|(_, kind)| kind.is_some_and(|kind| is_range(kind) == fits)) {
            return refuse(format!("the topic {wanted} has no {what}"));
        }
    }
    if options.scan_topics.is_empty() && !kinds.iter().any(|(_, kind)| kind.is_some_and(is_range)) {
        return refuse(format!("no topic has readings (sensor_msgs/Range){}", other_readings(&kinds)));
    }
    let has_poses = has_track || kinds.iter().any(|(_, kind)| kind.is_some_and(|kind| !kind.is_reading()));
    if !has_poses && options.poses == PoseUse::Needed {
        let kinds = "transforms, nav_msgs/Odometry, geometry_msgs/PoseStamped";
        return refuse(format!("no topic has poses ({kinds}); give them with --poses"));
    }
    Ok(())
}

/// How readings that are no cones by their type can be had all the same.
fn other_readings(kinds: &[(&Channel, Option<Kind>)]) -> String {
    let scan = kinds.iter().find(|(_, kind)| *kind == Some(Kind::Scan));
    let is_cloud = |channel: &Channel| {
        channel.schema.as_ref().is_some_and(|schema| schema.name.rsplit('/').next() == Some("PointCloud"))
    };
    let cloud = kinds.iter().find(|(channel, _)| is_cloud(channel));
    let scan = scan.map(|(channel, _)| {
        format!(": if the beams of {} are a sonar's cones, --scan-topics {} reads them", channel.topic, channel.topic)
    });
    let cloud = cloud.map(|(channel, _)| {
        format!(
            ": {} has points, which do not say where their sensors sit: write their distances from the sensors as \
             sensor_msgs/Range, or as a table with a rig",
            channel.topic
        )
    });
    scan.or(cloud).unwrap_or_default()
}

/// The topics there are, in words.
pub(super) fn all<'a>(channels: impl Iterator<Item = &'a Channel>) -> String {
    let shown = |channel: &Channel| match &channel.schema {
        Some(schema) => format!("{} ({})", channel.topic, schema.name),
        None => format!("{} (of no type)", channel.topic),
    };
    let shown: Vec<String> = channels.map(shown).collect();
    if shown.is_empty() { "there are no topics at all".to_owned() } else { format!("there are {}", shown.join(", ")) }
}

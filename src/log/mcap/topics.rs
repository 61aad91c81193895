//! Whether a recording has the topics it has to have.

use std::sync::Arc;

use super::{decode::Kind, options::Options, raw::Channel};
use crate::log::csv::PoseUse;

/// What of a channel is read, with the topics of readings that were asked for.
pub(super) fn kind_of(channel: &Channel, topics: &[String]) -> Option<Kind> {
    let asked = |kind: &Kind| *kind != Kind::Range || topics.is_empty() || topics.contains(&channel.topic);
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
    let is_range = |kind: Kind| kind == Kind::Range;
    let readings = options.range_topics.iter().map(|topic| (topic, true, "readings"));
    for (wanted, fits, what) in readings.chain(options.pose_topic.iter().map(|topic| (topic, false, "poses"))) {
        let mut named = kinds.iter().filter(|(channel, _)| channel.topic == *wanted).peekable();
        if named.peek().is_none() {
            return refuse(format!("there is no topic {wanted}"));
        }
        if !named.any(|(_, kind)| kind.is_some_and(|kind| is_range(kind) == fits)) {
            return refuse(format!("the topic {wanted} has no {what}"));
        }
    }
    if !kinds.iter().any(|(_, kind)| kind.is_some_and(is_range)) {
        return refuse("no topic has readings (sensor_msgs/Range)".to_owned());
    }
    let has_poses = has_track || kinds.iter().any(|(_, kind)| kind.is_some_and(|kind| !is_range(kind)));
    if !has_poses && options.poses == PoseUse::Needed {
        let kinds = "transforms, nav_msgs/Odometry, geometry_msgs/PoseStamped";
        return refuse(format!("no topic has poses ({kinds}); give them with --poses"));
    }
    Ok(())
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

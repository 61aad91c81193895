//! A recording as a robot under ROS 2 makes it: ranges by topic, and where the robot was.

use std::{
    collections::{BTreeMap, BTreeSet},
    io::Write,
    sync::Arc,
};

use super::{
    super::raw::Metadata,
    cdr::CdrWriter,
    content::{Transform, pose_of},
    file::{Layout, McapFile},
    ros2::{
        self,
        definitions::{Definition, RANGE, TF_MESSAGE},
        qos::{self, Durability, Words},
    },
};
use crate::{error::Result, intake::Defaults, rig::Rig, track::Pose};

/// The frame in which the robot moves.
pub const FIXED_FRAME: &str = "odom";
/// The robot's own frame.
pub const ROBOT_FRAME: &str = "base_link";

/// What one sensor's messages say of it every time.
#[derive(Debug)]
struct Recorded {
    channel: u16,
    frame: Arc<str>,
    field_of_view: f32,
    min_range: f32,
    max_range: f32,
}

/// Writes a ROS 2 recording: `sensor_msgs/Range` of each sensor on `/range/<id>` with its id as the frame, `/tf` from
/// [`FIXED_FRAME`] to [`ROBOT_FRAME`], and on `/tf_static`, once, from there to each sensor.
///
/// An id that can't be part of a topic's name in ROS 2 (one that begins with a digit, say) gives `/range/sensor_<id>` with `_`
/// for every character that may not be there.
///
/// Dropped without [`RecordingWriter::finish`], it leaves a file without a summary, as one that was cut off.
pub struct RecordingWriter<W: Write> {
    file: McapFile<W>,
    transforms: u16,
    sensors: Vec<Recorded>,
    message: CdrWriter,
    log_time: u64,
}

impl<W: Write> RecordingWriter<W> {
    /// Begins a recording of the rig's sensors, with `/tf_static` at time `start` in nanoseconds; `name` is what errors call
    /// the output. A sensor whose beam the rig does not say has [`Defaults::FIELD_OF_VIEW`].
    ///
    /// # Errors
    /// What the output says.
    pub fn create(out: W, name: Arc<str>, rig: &Rig, start: i64) -> Result<Self> {
        let mut file = McapFile::new(out, name, ros2::PROFILE, Layout::Chunked);
        file.metadata(&origin())?;
        let mut channel = |topic: &str, definition: &Definition, durability| {
            let metadata = qos::metadata(durability, Words::Numbers);
            file.channel(topic, &ros2::schema(definition), ros2::ENCODING, &metadata)
        };
        let mounts = channel("/tf_static", &TF_MESSAGE, Durability::TransientLocal)?;
        let transforms = channel("/tf", &TF_MESSAGE, Durability::Volatile)?;
        let mut sensors = Vec::with_capacity(rig.sensors().len());
        let topics = topics(rig.ids());
        for ((sensor, id), topic) in rig.sensors().iter().zip(rig.ids()).zip(topics) {
            sensors.push(Recorded {
                channel: channel(&topic, &RANGE, Durability::Volatile)?,
                frame: Arc::clone(id),
                field_of_view: sensor.field_of_view().unwrap_or(Defaults::FIELD_OF_VIEW) as f32,
                min_range: sensor.min_range() as f32,
                max_range: sensor.max_range() as f32,
            });
        }
        let mut recording = Self { file, transforms, sensors, message: CdrWriter::new(), log_time: 0 };
        recording.write_mounts(mounts, rig, start)?;
        Ok(recording)
    }

    fn write_mounts(&mut self, channel: u16, rig: &Rig, t: i64) -> Result<()> {
        let transforms: Vec<Transform<'_>> = rig
            .sensors()
            .iter()
            .map(|sensor| Transform { t, parent: ROBOT_FRAME, child: sensor.id(), pose: pose_of(&sensor.mount()) })
            .collect();
        self.write_transforms(channel, t, &transforms)
    }

    fn write_transforms(&mut self, channel: u16, t: i64, transforms: &[Transform<'_>]) -> Result<()> {
        self.message.clear();
        ros2::write_transforms(transforms, &mut self.message);
        self.send(channel, t)
    }

    /// Writes where the robot was at time `t` in nanoseconds.
    ///
    /// # Errors
    /// What the output says.
    pub fn pose(&mut self, t: i64, pose: Pose) -> Result<()> {
        let transform = Transform { t, parent: FIXED_FRAME, child: ROBOT_FRAME, pose };
        self.write_transforms(self.transforms, t, &[transform])
    }

    /// Writes a reading of the sensor with this index in the rig at time `t` in nanoseconds; `range` in metres, +∞ for no echo, −∞
    /// for one too close (REP 117), written in single precision. An index beyond the rig's writes nothing.
    ///
    /// # Errors
    /// What the output says.
    pub fn range(&mut self, t: i64, sensor: u16, range: f64) -> Result<()> {
        let Some(recorded) = self.sensors.get(usize::from(sensor)) else { return Ok(()) };
        let message = &mut self.message;
        message.clear();
        ros2::header(t, &recorded.frame, message);
        message.u8(0); // ULTRASOUND
        for value in [recorded.field_of_view, recorded.min_range, recorded.max_range, range as f32] {
            message.f32(value);
        }
        message.f32(0.0); // variance: not known
        self.send(recorded.channel, t)
    }

    /// Writes the message; log times never go back.
    fn send(&mut self, channel: u16, t: i64) -> Result<()> {
        self.log_time = self.log_time.max(u64::try_from(t).unwrap_or(0));
        self.file.write(channel, self.log_time, self.message.bytes())
    }

    /// Writes the summary, and returns what the recording was written to.
    ///
    /// # Errors
    /// What the output says.
    pub fn finish(self) -> Result<W> {
        self.file.finish()
    }
}

/// The name of the metadata in which the recorder of ROS 2 says of a file which release it belongs to.
pub(super) const ORIGIN: &str = "rosbag2";

/// What the recorder of Humble says of a file. Without it, later players take the numbers in the channels' offers for names.
pub(super) fn origin() -> Metadata {
    let entries = BTreeMap::from([("ROS_DISTRO".to_owned(), "humble".to_owned())]);
    Metadata { name: ORIGIN.to_owned(), entries }
}

/// A topic for each id, no two alike.
fn topics(ids: &[Arc<str>]) -> Vec<String> {
    let mut taken = BTreeSet::new();
    let mut topics = Vec::with_capacity(ids.len());
    for (index, id) in ids.iter().enumerate() {
        let mut topic = format!("/range/{}", token(id));
        if taken.contains(&topic) {
            topic = format!("{topic}_{index}");
        }
        taken.insert(topic.clone());
        topics.push(topic);
    }
    topics
}

/// The id as a part of a topic's name: letters, digits and single underscores, no digit first (ROS 2 design, "Topic and
/// Service name mapping to DDS").
fn token(id: &str) -> String {
    let is_letter = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'_';
    let begins_well = id.bytes().next().is_some_and(|byte| byte.is_ascii_alphabetic());
    if begins_well && id.bytes().all(is_letter) && !id.contains("__") {
        return id.to_owned();
    }
    let mut token = String::from("sensor_");
    for character in id.chars() {
        let character = if character.is_ascii_alphanumeric() { character } else { '_' };
        if !(character == '_' && token.ends_with('_')) {
            token.push(character);
        }
    }
    token
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn topics_are_names_that_ros_takes_and_differ() {
        let ids: Vec<Arc<str>> = ["left", "0", "0 ", "front left", "a__b", "sensor_0"].map(Arc::from).to_vec();
        let expected = [
            "/range/left",
            "/range/sensor_0",
            "/range/sensor_0_",
            "/range/sensor_front_left",
            "/range/sensor_a_b",
            "/range/sensor_0_5",
        ];
        assert_eq!(topics(&ids), expected);
    }
}

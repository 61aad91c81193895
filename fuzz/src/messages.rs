//! Messages of every encoding and type that is read, their schemas, and the tree of frames that transforms build: any bytes, or
//! values that make sense.

use arbitrary::{Result, Unstructured};

use crate::mcap::Recording;

const RANGE: &str = "std_msgs/Header header\nuint8 radiation_type\nfloat32 field_of_view\nfloat32 min_range\nfloat32 max_range\nfloat32 range\n\
    ===\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n===\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
const RANGE_ROS1: &str = "Header header\nuint8 radiation_type\nfloat32 field_of_view\nfloat32 min_range\nfloat32 max_range\nfloat32 range\n\
    ===\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n";
const RANGE_JSON: &str = r#"{"type":"object","properties":{"range":{"type":"number"},"frame_id":{"type":"string"},
    "field_of_view":{"type":"number"},"min_range":{"type":"number"},"max_range":{"type":"number"},"timestamp":{"type":"object"}}}"#;
/// From the schemas of recordings that atm writes: serialized `FileDescriptorSet`s.
const TRANSFORMS_PROTOBUF: &[u8] = include_bytes!("schemas/FrameTransforms.binpb");
const POSE_PROTOBUF: &[u8] = include_bytes!("schemas/PoseInFrame.binpb");

/// Topic, encoding, type, language of the schema, schema. An empty one is that of the standard.
const CHANNELS: [(&str, &str, &str, &str, &[u8]); 14] = [
    ("/r0", "cdr", "sensor_msgs/msg/Range", "ros2msg", RANGE.as_bytes()),
    ("/r1", "cdr", "sensor_msgs/msg/Range", "ros2msg", b""),
    ("/tf", "cdr", "tf2_msgs/msg/TFMessage", "ros2msg", b""),
    ("/tf_static", "cdr", "tf2_msgs/msg/TFMessage", "ros2msg", b""),
    ("/odom", "cdr", "nav_msgs/msg/Odometry", "ros2msg", b""),
    ("/pose", "cdr", "geometry_msgs/msg/PoseStamped", "ros2msg", b""),
    ("/r2", "ros1", "sensor_msgs/Range", "ros1msg", RANGE_ROS1.as_bytes()),
    ("/tf1", "ros1", "tf2_msgs/TFMessage", "ros1msg", b""),
    ("/odom1", "ros1", "nav_msgs/Odometry", "ros1msg", b""),
    ("/r3", "json", "example.Range", "jsonschema", RANGE_JSON.as_bytes()),
    ("/tfj", "json", "foxglove.FrameTransform", "jsonschema", b"{}"),
    ("/posej", "json", "foxglove.PoseInFrame", "jsonschema", b"{}"),
    ("/tfp", "protobuf", "foxglove.FrameTransforms", "protobuf", TRANSFORMS_PROTOBUF),
    ("/posep", "protobuf", "foxglove.PoseInFrame", "protobuf", POSE_PROTOBUF),
];
const FRAMES: [&str; 7] = ["odom", "base_link", "a", "b", "map", "", "c"];

/// A recording from bytes.
pub fn check(bytes: &[u8]) {
    let mut input = Unstructured::new(bytes);
    let Ok((options, pattern)) = input.arbitrary::<(u8, u8)>() else { return };
    if let Ok(file) = recording(&mut input) {
        crate::mcap::check(&[&[options & !32, pattern], &file[..]].concat());
    }
}

/// Every channel there is, one perhaps with another schema, and messages of any of them.
pub fn recording(input: &mut Unstructured<'_>) -> Result<Vec<u8>> {
    let mut recording = Recording::default();
    let other = input.arbitrary::<u8>()?;
    for (id, &(topic, encoding, name, language, schema)) in (0..).zip(&CHANNELS) {
        if other < 128 || usize::from(other) % CHANNELS.len() != usize::from(id) {
            recording.channel(id, topic, encoding, (name, language, schema));
            continue;
        }
        let length = usize::from(input.arbitrary::<u16>()? % 512).min(input.len());
        let schema = input.bytes(length)?;
        let language = if other & 64 == 0 { language } else { "ros2idl" };
        recording.channel(id, topic, encoding, (name, language, schema));
    }
    let mut t = 1_000_000_000_i64;
    while !input.is_empty() {
        let Ok((channel, step)) = input.arbitrary::<(u8, u8)>() else { break };
        t = if step == 255 { input.arbitrary()? } else { t.saturating_add(i64::from(step) * 1_000_000) };
        let channel = u16::from(channel % 16);
        let content = if step & 1 == 0 { sensible(channel, t, input) } else { any(input) };
        let Ok(content) = content else { break };
        recording.message(channel, t as u64, &content);
    }
    Ok(recording.end())
}

/// A recording of a drive along one heading: odometry, then what each sensor that fired then read. Sensor `0` has the frame `0`.
pub fn drive<'a>(instants: impl Iterator<Item = (i64, [f64; 2], &'a [Option<f64>; 3])>) -> Vec<u8> {
    let mut recording = Recording::default();
    for (id, &(topic, encoding, name, language, schema)) in [(0, &CHANNELS[0]), (4, &CHANNELS[4])] {
        recording.channel(id, topic, encoding, (name, language, schema));
    }
    let head: &[u8] = &[0, 1, 0, 0];
    for (t, [x, y], ranges) in instants {
        let mut odometry = Message { bytes: Vec::new(), aligns: true };
        odometry.header(t, "odom");
        odometry.text("base_link");
        for part in [x, y, 0.0, 0.0, 0.0, 0.0, 1.0] {
            odometry.put(&f64::to_le_bytes(part));
        }
        odometry.bytes.extend([0; 8 * (36 + 6 + 36)]);
        recording.message(4, t as u64, &[head, &odometry.bytes].concat());
        for (frame, range) in ["0", "1", "2"].into_iter().zip(ranges) {
            let Some(range) = range else { continue };
            let mut reading = Message { bytes: Vec::new(), aligns: true };
            reading.header(t, frame);
            reading.put(&[0]);
            for number in [0.0, 0.0, 0.0, *range as f32] {
                reading.put(&f32::to_le_bytes(number));
            }
            recording.message(0, t as u64, &[head, &reading.bytes].concat());
        }
    }
    recording.end()
}

fn any(input: &mut Unstructured<'_>) -> Result<Vec<u8>> {
    let length = usize::from(input.arbitrary::<u8>()?).min(input.len());
    Ok(input.bytes(length)?.to_vec())
}

/// A message that is put together, little-endian; CDR aligns, ROS 1 does not.
struct Message {
    bytes: Vec<u8>,
    aligns: bool,
}

impl Message {
    fn put(&mut self, bytes: &[u8]) {
        while self.aligns && !self.bytes.len().is_multiple_of(bytes.len()) {
            self.bytes.push(0);
        }
        self.bytes.extend(bytes);
    }

    fn text(&mut self, text: &str) {
        let end = usize::from(self.aligns);
        self.put(&((text.len() + end) as u32).to_le_bytes());
        self.bytes.extend(text.as_bytes());
        self.bytes.extend(&[0][..end]);
    }

    fn header(&mut self, t: i64, frame: &str) {
        if !self.aligns {
            self.put(&[0; 4]);
        }
        self.put(&(t.div_euclid(1_000_000_000) as i32).to_le_bytes());
        self.put(&(t.rem_euclid(1_000_000_000) as u32).to_le_bytes());
        self.text(frame);
    }

    /// Position and quaternion: mostly of the plane.
    fn pose(&mut self, input: &mut Unstructured<'_>) -> Result<()> {
        let tag = input.arbitrary::<u8>()?;
        for _ in 0..3 {
            self.put(&(f64::from(input.arbitrary::<i8>()?) / 16.0).to_le_bytes());
        }
        let half = f64::from(input.arbitrary::<i8>()?) / 40.0;
        let quaternion = match tag {
            0..=199 => [0.0, 0.0, libm::sin(half), libm::cos(half)],
            200..=219 => [0.0, libm::sin(half), 0.0, libm::cos(half)],
            220..=229 => [0.0; 4],
            230..=239 => [f64::NAN, 0.0, f64::MAX, 1e-300],
            _ => [input.arbitrary()?, input.arbitrary()?, half, 1.0],
        };
        for part in quaternion {
            self.put(&part.to_le_bytes());
        }
        Ok(())
    }
}

/// What a robot might say on this channel.
fn sensible(channel: u16, t: i64, input: &mut Unstructured<'_>) -> Result<Vec<u8>> {
    let aligns = channel < 6;
    let mut message = Message { bytes: Vec::new(), aligns };
    let frame = *input.choose(&FRAMES)?;
    match channel {
        0 | 1 | 6 => {
            message.header(t, frame);
            message.put(&[0]);
            let tag = input.arbitrary::<u8>()?;
            let limits: [f32; 3] = match tag {
                0..=229 => [0.6, 0.1, 4.0],
                230..=239 => [0.0; 3],
                _ => [input.arbitrary()?, input.arbitrary()?, input.arbitrary()?],
            };
            for number in limits {
                message.put(&number.to_le_bytes());
            }
            let range =
                if tag & 7 == 7 { input.arbitrary::<f32>()? } else { f32::from(input.arbitrary::<u8>()?) / 64.0 };
            message.put(&range.to_le_bytes());
        }
        2 | 3 | 7 => {
            let count = input.arbitrary::<u8>()? % 4;
            message.put(&u32::from(count).to_le_bytes());
            for _ in 0..count {
                message.header(t, input.choose(&FRAMES)?);
                message.text(input.choose(&FRAMES)?);
                message.pose(input)?;
            }
        }
        4 | 8 => {
            message.header(t, frame);
            message.text(input.choose(&FRAMES)?);
            message.pose(input)?;
            message.bytes.extend([0; 8 * (36 + 6 + 36)]);
        }
        5 => {
            message.header(t, frame);
            message.pose(input)?;
        }
        9 => {
            let range = f32::from(input.arbitrary::<u8>()?) / 64.0;
            let (sec, nsec) = (t.div_euclid(1_000_000_000), t.rem_euclid(1_000_000_000));
            let text = format!(
                r#"{{"timestamp":{{"sec":{sec},"nsec":{nsec}}},"frame_id":"{frame}","field_of_view":0.6,"min_range":0.1,"max_range":4,"range":{range}}}"#
            );
            return Ok(text.into_bytes());
        }
        _ => return any(input),
    }
    let head: &[u8] = if aligns { &[0, 1, 0, 0] } else { &[] };
    Ok([head, &message.bytes].concat())
}

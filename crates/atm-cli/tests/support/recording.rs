//! Recordings as ROS 2 makes them, message by message, each byte of a message put there by hand.

use std::{collections::BTreeMap, io::Cursor};

use mcap::{
    Compression, WriteOptions,
    records::{MessageHeader, Metadata},
};

use super::{BEAM, INCH, number, sample_rows};

pub const RANGE: &str = "sensor_msgs/msg/Range";
pub const TRANSFORMS: &str = "tf2_msgs/msg/TFMessage";
pub const ODOMETRY: &str = "nav_msgs/msg/Odometry";
pub const POSE: &str = "geometry_msgs/msg/PoseStamped";
pub const IMAGE: &str = "sensor_msgs/msg/Image";
pub const CLOUD: &str = "sensor_msgs/msg/PointCloud2";

const HEADER: &str = "\
===\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n\
===\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
const GEOMETRY: &str = "\
===\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n\
===\nMSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n\
===\nMSG: geometry_msgs/Quaternion\nfloat64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n\
===\nMSG: geometry_msgs/Pose\nPoint position\nQuaternion orientation\n\
===\nMSG: geometry_msgs/PoseWithCovariance\nPose pose\nfloat64[36] covariance\n\
===\nMSG: geometry_msgs/Twist\nVector3 linear\nVector3 angular\n\
===\nMSG: geometry_msgs/TwistWithCovariance\nTwist twist\nfloat64[36] covariance\n\
===\nMSG: geometry_msgs/Transform\nVector3 translation\nQuaternion rotation\n\
===\nMSG: geometry_msgs/TransformStamped\nstd_msgs/Header header\nstring child_frame_id\nTransform transform\n";

/// The definition of a type.
pub fn definition(name: &str) -> String {
    let own = match name {
        RANGE => {
            "# A comment.\nstd_msgs/Header header\nuint8 ULTRASOUND=0\nuint8 radiation_type\nfloat32 field_of_view\n\
             float32 min_range\nfloat32 max_range\nfloat32 range  # metres\nfloat32 variance\n"
        }
        TRANSFORMS => "geometry_msgs/TransformStamped[] transforms\n",
        ODOMETRY => {
            "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n\
             geometry_msgs/TwistWithCovariance twist\n"
        }
        POSE => "std_msgs/Header header\nPose pose\n",
        IMAGE => "std_msgs/Header header\nuint32 height\nuint8[] data\n",
        CLOUD => {
            "std_msgs/Header header\nuint32 height\nuint32 width\nPointField[] fields\nbool is_bigendian\n\
             uint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n\
             ===\nMSG: sensor_msgs/PointField\nstring name\nuint32 offset\nuint8 datatype\nuint32 count\n"
        }
        other => panic!("{other}"),
    };
    format!("{own}{HEADER}{GEOMETRY}")
}

/// A message in little-endian CDR that is being put together.
#[derive(Default)]
pub struct Cdr(Vec<u8>);

impl Cdr {
    fn put(mut self, bytes: &[u8]) -> Self {
        while !self.0.len().is_multiple_of(bytes.len()) {
            self.0.push(0);
        }
        self.0.extend_from_slice(bytes);
        self
    }

    pub fn u8(self, value: u8) -> Self {
        self.put(&[value])
    }

    pub fn u32(self, value: u32) -> Self {
        self.put(&value.to_le_bytes())
    }

    pub fn f32(self, value: f32) -> Self {
        self.put(&value.to_le_bytes())
    }

    pub fn f64s(self, values: &[f64]) -> Self {
        values.iter().fold(self, |cdr, value| cdr.put(&value.to_le_bytes()))
    }

    pub fn text(self, text: &str) -> Self {
        let mut cdr = self.u32(text.len() as u32 + 1);
        cdr.0.extend_from_slice(text.as_bytes());
        cdr.0.push(0);
        cdr
    }

    pub fn header(self, t: i64, frame: &str) -> Self {
        self.u32((t / 1_000_000_000) as u32).u32((t % 1_000_000_000) as u32).text(frame)
    }

    pub fn message(self) -> Vec<u8> {
        [&[0, 1, 0, 0], &self.0[..]].concat()
    }
}

/// What a message of `sensor_msgs/Range` says.
#[derive(Debug, Clone, Copy)]
pub struct Reading<'a> {
    pub t: i64,
    pub frame: &'a str,
    pub beam: f32,
    pub limits: [f32; 2],
    pub range: f32,
}

impl Reading<'_> {
    pub fn message(&self) -> Vec<u8> {
        let [min, max] = self.limits;
        let cdr = Cdr::default().header(self.t, self.frame).u8(0).f32(self.beam).f32(min).f32(max);
        cdr.f32(self.range).f32(0.0).message()
    }
}

/// A transform: position and heading of `child` in `parent`.
#[derive(Debug, Clone, Copy)]
pub struct Transform<'a> {
    pub t: i64,
    pub parent: &'a str,
    pub child: &'a str,
    pub at: [f64; 3],
}

pub fn quaternion(yaw: f64) -> [f64; 4] {
    [0.0, 0.0, (yaw / 2.0).sin(), (yaw / 2.0).cos()]
}

pub fn transforms(all: &[Transform<'_>]) -> Vec<u8> {
    let put = |cdr: Cdr, tf: &Transform<'_>| {
        let [x, y, yaw] = tf.at;
        cdr.header(tf.t, tf.parent).text(tf.child).f64s(&[x, y, 0.0]).f64s(&quaternion(yaw))
    };
    all.iter().fold(Cdr::default().u32(all.len() as u32), put).message()
}

pub fn odometry(t: i64, [parent, child]: [&str; 2], [x, y, yaw]: [f64; 3]) -> Vec<u8> {
    let cdr = Cdr::default().header(t, parent).text(child).f64s(&[x, y, 0.0]).f64s(&quaternion(yaw));
    cdr.f64s(&[0.0; 36 + 6 + 36]).message()
}

pub fn pose(t: i64, frame: &str, [x, y, yaw]: [f64; 3]) -> Vec<u8> {
    Cdr::default().header(t, frame).f64s(&[x, y, 0.0]).f64s(&quaternion(yaw)).message()
}

pub fn image(t: i64, size: usize) -> Vec<u8> {
    let cdr = Cdr::default().header(t, "camera").u32(1).u32(size as u32);
    let mut message = cdr.message();
    message.resize(message.len() + size, 7);
    message
}

/// A field of a cloud's points: its name, its type's number in sensor_msgs/PointField, and each point's value.
pub type CloudField<'a> = (&'a str, u8, &'a [f64]);

/// A cloud of points with these fields one behind the other.
pub fn cloud(t: i64, fields: &[CloudField<'_>]) -> Vec<u8> {
    let count = fields.first().map_or(0, |(_, _, values)| values.len());
    let (mut cdr, mut stride) = (Cdr::default().header(t, "odom").u32(1).u32(count as u32), 0);
    cdr = cdr.u32(fields.len() as u32);
    for (name, datatype, _) in fields {
        cdr = cdr.text(name).u32(stride).u8(*datatype).u32(1);
        stride += u32::try_from(packed(*datatype, 0.0).len()).expect("a few bytes");
    }
    let points = (0..count)
        .flat_map(|point| fields.iter().flat_map(move |(_, datatype, values)| packed(*datatype, values[point])));
    let points: Vec<u8> = points.collect();
    let size = points.len() as u32;
    points.into_iter().fold(cdr.u8(0).u32(stride).u32(size).u32(size), Cdr::u8).u8(1).message()
}

fn packed(datatype: u8, value: f64) -> Vec<u8> {
    match datatype {
        2 => vec![value as u8],
        4 => (value as u16).to_le_bytes().into(),
        6 => (value as u32).to_le_bytes().into(),
        7 => (value as f32).to_le_bytes().into(),
        8 => value.to_le_bytes().into(),
        other => panic!("type {other}"),
    }
}

/// One message of a recording.
#[derive(Debug, Clone)]
pub struct Message {
    pub topic: String,
    pub schema: String,
    pub log_time: u64,
    pub data: Vec<u8>,
}

/// A recording before it is written: change what has to be wrong.
#[derive(Debug, Clone, Default)]
pub struct Recording {
    pub messages: Vec<Message>,
    /// Definitions that are not the usual ones.
    pub definitions: BTreeMap<String, String>,
    /// Named texts, before the first message.
    pub metadata: Vec<(String, BTreeMap<String, String>)>,
}

/// How a recording is laid out.
#[derive(Debug, Clone, Copy)]
pub enum Layout {
    Chunks(Option<Compression>),
    /// As `fastwrite` does it: no chunks, no summary.
    Bare,
}

pub const CHUNK: u64 = 16 * 1024;

impl Recording {
    pub fn push(&mut self, topic: &str, schema: &str, log_time: i64, data: Vec<u8>) {
        let (topic, schema, log_time) = (topic.to_owned(), schema.to_owned(), log_time as u64);
        self.messages.push(Message { topic, schema, log_time, data });
    }

    pub fn bytes(&self) -> Vec<u8> {
        self.laid_out(Layout::Chunks(Some(Compression::Zstd)))
    }

    pub fn laid_out(&self, layout: Layout) -> Vec<u8> {
        let options = match layout {
            Layout::Chunks(compression) => WriteOptions::new().compression(compression).chunk_size(Some(CHUNK)),
            Layout::Bare => {
                WriteOptions::new().use_chunks(false).emit_summary_records(false).emit_summary_offsets(false)
            }
        };
        let mut file = Cursor::new(Vec::new());
        let mut writer = options.profile("ros2").create(&mut file).expect("a recording");
        for (name, metadata) in self.metadata.clone() {
            writer.write_metadata(&Metadata { name, metadata }).expect("metadata");
        }
        let mut channels = BTreeMap::new();
        for (sequence, message) in (0..).zip(&self.messages) {
            let channel_id = *channels.entry(&message.topic).or_insert_with(|| {
                let known = self.definitions.get(&message.schema).cloned();
                let text = known.unwrap_or_else(|| definition(&message.schema));
                let schema = writer.add_schema(&message.schema, "ros2msg", text.as_bytes()).expect("a schema");
                writer.add_channel(schema, &message.topic, "cdr", &BTreeMap::new()).expect("a channel")
            });
            let header =
                MessageHeader { channel_id, sequence, log_time: message.log_time, publish_time: message.log_time };
            writer.write_to_known_channel(&header, &message.data).expect("a message");
        }
        writer.finish().expect("an end");
        drop(writer);
        file.into_inner()
    }
}

/// Where the sensor of this number sits on the Nomad.
pub fn mount(sensor: f64) -> [f64; 3] {
    let yaw = sensor * BEAM;
    [9.0 * INCH * yaw.cos(), 9.0 * INCH * yaw.sin(), yaw]
}

pub const BEAM_F32: f32 = BEAM as f32;
pub const LIMITS_F32: [f32; 2] = [(6.0 * INCH) as f32, (255.0 * INCH) as f32];

/// Nanoseconds of a sample's time, an hour and more after the epoch: a stamp of 0 is none.
pub fn stamp(t: f64) -> i64 {
    4_000_000_000_000 + (t * 1000.0).round() as i64 * 1_000_000
}

/// The sample's drive as a recording: mounts, then for each instant a transform and the readings.
pub fn drive() -> Recording {
    let mut recording = Recording::default();
    let frames: Vec<String> = (0..16).map(|sensor| sensor.to_string()).collect();
    let t = stamp(0.0);
    let mounts: Vec<Transform<'_>> = frames
        .iter()
        .zip(0..)
        .map(|(child, index)| Transform { t, parent: "base_link", child, at: mount(f64::from(index)) })
        .collect();
    recording.push("/tf_static", TRANSFORMS, t, transforms(&mounts));
    let mut last = None;
    for row in sample_rows() {
        let t = stamp(row.time());
        if last.replace(t) != Some(t) {
            let at = [number(&row.x), number(&row.y), number(&row.yaw)];
            let tf = Transform { t, parent: "odom", child: "base_link", at };
            recording.push("/tf", TRANSFORMS, t + 1, transforms(&[tf]));
        }
        let range = if row.range == "inf" { f32::INFINITY } else { number(&row.range) as f32 };
        let reading = Reading { t, frame: &row.sensor, beam: BEAM_F32, limits: LIMITS_F32, range };
        recording.push(&format!("/sonar/{}", row.sensor), RANGE, t + 2, reading.message());
    }
    recording
}

/// The same readings as a table.
pub fn drive_table() -> String {
    let mut table = "t,sensor,range,x,y,yaw\n".to_owned();
    for row in sample_rows() {
        let range = if row.range == "inf" { f64::INFINITY } else { f64::from(number(&row.range) as f32) };
        let t = stamp(row.time());
        let (seconds, rest) = (t / 1_000_000_000, t % 1_000_000_000);
        table += &format!("{seconds}.{rest:09},{},{range},{},{},{}\n", row.sensor, row.x, row.y, row.yaw);
    }
    table
}

/// The rig that the recording's messages describe.
pub fn drive_rig() -> String {
    let [min, max] = LIMITS_F32.map(f64::from);
    format!(
        "name = 'described'\nfield_of_view = '{}rad'\nmin_range = {min}\nmax_range = {max}\n[ring]\ncount = 16\n\
         radius = '9in'\nfirst_yaw = '0deg'\n",
        f64::from(BEAM_F32)
    )
}

use std::{collections::BTreeMap, sync::Arc};

use super::*;
use crate::log::mcap::raw::Schema;

fn channel(encoding: &str, name: &str, language: &str, data: &[u8]) -> Channel {
    let schema = Schema { id: 1, name: name.into(), encoding: language.into(), data: data.to_vec() };
    let (topic, metadata) = ("/topic".into(), BTreeMap::new());
    Channel { id: 1, schema: Some(Arc::new(schema)), topic, encoding: encoding.into(), metadata }
}

/// What a message says, in words; once for each element.
fn said(channel: &Channel, data: &[u8]) -> Result<Vec<String>, String> {
    let kind = Kind::of(channel).ok_or("not read")?;
    let (mut said, mut all) = (Said::default(), Vec::new());
    Decoder::for_channel(kind, channel)?.read(data, &mut said, &mut |said| {
        let numbers = match kind {
            Kind::Range => {
                let Measured { field_of_view, min, max, range } = said.measured();
                vec![field_of_view, min, max, range]
            }
            _ => {
                let (at, q) = said.placement();
                at.into_iter().chain(q).collect()
            }
        };
        all.push(format!("{:?} {} {} {numbers:?}", said.stamp(), said.frame, said.child));
    })?;
    Ok(all)
}

/// Values in little or big endian, each aligned to its size or to nothing.
struct Bytes {
    bytes: Vec<u8>,
    big: bool,
    aligned: bool,
}

impl Bytes {
    fn put(mut self, little: &[u8]) -> Self {
        while self.aligned && !self.bytes.len().is_multiple_of(little.len()) {
            self.bytes.push(0);
        }
        let big = little.iter().rev();
        match self.big {
            true => self.bytes.extend(big),
            false => self.bytes.extend(little),
        }
        self
    }

    fn u32(self, value: u32) -> Self {
        self.put(&value.to_le_bytes())
    }

    fn f32s(self, values: [f32; 4]) -> Self {
        values.iter().fold(self, |bytes, value| bytes.put(&value.to_le_bytes()))
    }

    fn f64s(self, values: [f64; 7]) -> Self {
        values.iter().fold(self, |bytes, value| bytes.put(&value.to_le_bytes()))
    }

    fn text(self, text: &str) -> Self {
        let zero = self.aligned;
        let mut bytes = self.u32(text.len() as u32 + u32::from(zero));
        bytes.bytes.extend_from_slice(text.as_bytes());
        bytes.bytes.extend(zero.then_some(0));
        bytes
    }
}

const RANGE: &str = "[1.0, 0.25, 4.0, 2.5]";

fn cdr(big: bool) -> Vec<u8> {
    let bytes = Bytes { bytes: Vec::new(), big, aligned: true }.u32(7).u32(8).text("front");
    let body = bytes.put(&[0]).f32s([1.0, 0.25, 4.0, 2.5]).bytes;
    [vec![0, u8::from(!big), 0, 0], body].concat()
}

const ROS2: &str = "\
# A reading.\nuint8 ULTRASOUND=0\nstd_msgs/Header header # stamp\nuint8 radiation_type\nfloat32 field_of_view\nfloat32 min_range\n\
float32 max_range\nfloat32 range\n\
================================================================================\nMSG: std_msgs/Header\n\
builtin_interfaces/Time stamp\nstring frame_id\n\
================================================================================\nMSG: builtin_interfaces/Time\nint32 sec\n\
uint32 nanosec\n";

#[test]
fn cdr_in_both_byte_orders_and_with_or_without_what_later_releases_add() {
    let expected = Ok(vec![format!("Some(7000000008) front  {RANGE}")]);
    for definition in
        [ROS2.to_owned(), ROS2.replace("float32 range\n", "float32 range\nfloat32 variance\n"), String::new()]
    {
        let channel = channel("cdr", "sensor_msgs/msg/Range", "ros2msg", definition.as_bytes());
        assert_eq!(said(&channel, &cdr(false)), expected);
        assert_eq!(said(&channel, &cdr(true)), expected);
        assert_eq!(said(&channel, &[cdr(false), vec![0; 4]].concat()), expected);
    }
}

#[test]
fn cdr_of_the_second_version_aligns_eight_bytes_to_four() {
    let channel = channel("cdr", "geometry_msgs/msg/PoseStamped", "ros2msg", b"");
    let bytes = Bytes { bytes: Vec::new(), big: false, aligned: true }.u32(1).u32(2).text("odo");
    // 16 bytes so far: the first version is aligned as it is, and so is the second.
    assert_eq!(bytes.bytes.len(), 16);
    let long = Bytes { bytes: Vec::new(), big: false, aligned: true }.u32(1).u32(2).text("odom_14");
    assert_eq!(long.bytes.len(), 20);
    let numbers = [1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0_f64].map(f64::to_le_bytes).concat();
    let first = [vec![0, 1, 0, 0], long.bytes.clone(), vec![0; 4], numbers.clone()].concat();
    let second = [vec![0, 7, 0, 0], long.bytes, numbers].concat();
    let expected = Ok(vec!["Some(1000000002) odom_14  [1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0]".to_owned()]);
    assert_eq!(said(&channel, &first), expected);
    assert_eq!(said(&channel, &second), expected);
}

#[test]
fn ros1_has_a_count_before_its_stamp_and_no_alignment() {
    let definition = "Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n\
        ===\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n\
        ===\nMSG: geometry_msgs/PoseWithCovariance\nPose pose\nfloat64[36] covariance\n\
        ===\nMSG: geometry_msgs/Pose\nPoint position\nQuaternion orientation\n\
        ===\nMSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n\
        ===\nMSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n";
    let channel = channel("ros1", "nav_msgs/Odometry", "ros1msg", definition.as_bytes());
    let bytes = Bytes { bytes: Vec::new(), big: false, aligned: false }.u32(99).u32(7).u32(8).text("odom").text("base");
    let bytes = bytes.f64s([1.0, 2.0, 3.0, 0.0, 0.0, 0.6, 0.8]).bytes;
    assert_eq!(said(&channel, &bytes).unwrap(), ["Some(7000000008) odom base [1.0, 2.0, 3.0, 0.0, 0.0, 0.6, 0.8]"]);
    assert!(said(&channel, &bytes[..bytes.len() - 1]).is_err());
}

#[test]
fn idl_with_comments_annotations_constants_and_typedefs() {
    let idl = r#"
================================================================================
IDL: sensor_msgs/msg/Range
#include "std_msgs/msg/Header.idl"
// It's } a comment
module sensor_msgs { module msg {
  module Range_Constants { const uint8 ULTRASOUND = 0; const string NAME = "a } b"; };
  typedef float float__2[2];
  @verbatim (language="comment", text="(" ")" "see // there \" }")
  struct Range { std_msgs::msg::Header header; @default (value=1) unsigned short kind; sequence<uint8, 4> tags; float__2 pair;
    string<8> unit; float field_of_view; float min_range; float max_range; /* } */ float range; long long later; };
}; };
================================================================================
IDL: std_msgs/msg/Header
module std_msgs { module msg { struct Header { builtin_interfaces::msg::Time stamp; string frame_id; }; }; };
================================================================================
IDL: builtin_interfaces/msg/Time
module builtin_interfaces { module msg { struct Time { int32 sec; uint32 nanosec; }; }; };
"#;
    let channel = channel("cdr", "sensor_msgs/msg/Range", "ros2idl", idl.as_bytes());
    let bytes = Bytes { bytes: Vec::new(), big: false, aligned: true }.u32(7).u32(8).text("front").put(&[1, 0]);
    let mut bytes = bytes.u32(3);
    bytes.bytes.extend([1, 2, 3]);
    let bytes = bytes.put(&[0; 4]).put(&[0; 4]).text("m").f32s([1.0, 0.25, 4.0, 2.5]).bytes;
    let message = [vec![0, 1, 0, 0], bytes].concat();
    assert_eq!(said(&channel, &message).unwrap(), [format!("Some(7000000008) front  {RANGE}")]);
    for broken in
        ["struct X {", "sequence<sequence<sequence<float>>> x;", "module m { module n {", "struct S { float x[y]; };"]
    {
        assert!(idl::parse(broken).is_err(), "{broken}");
    }
    // Nothing that a text can say exhausts the stack.
    assert!(idl::parse(&"module m { ".repeat(100_000)).is_err());
    assert!(idl::parse(&"sequence<".repeat(100_000)).is_err());
}

#[test]
fn json_by_the_names_of_its_fields_and_infinities_in_words() {
    let schema = br#"{"properties": {"range": {}, "min_range": {}, "max_range": {}, "field_of_view": {}}}"#;
    let channel = channel("json", "my.Sonar", "jsonschema", schema);
    let message = |range: &str| {
        format!(
            r#"{{"timestamp": {{"sec": 7, "nsec": 8}}, "frame_id": "front", "field_of_view": 1, "min_range": 0.25,
                "max_range": 4, "range": {range}, "more": [1, {{"range": 9}}]}}"#
        )
    };
    assert_eq!(said(&channel, message("2.5").as_bytes()).unwrap(), [format!("Some(7000000008) front  {RANGE}")]);
    for (range, read) in [("\"-Infinity\"", "-inf"), ("\"inf\"", "inf"), ("null", "NaN")] {
        let expected = format!("Some(7000000008) front  [1.0, 0.25, 4.0, {read}]");
        assert_eq!(said(&channel, message(range).as_bytes()).unwrap(), [expected]);
    }
    assert!(said(&channel, message("\"far\"").as_bytes()).unwrap_err().contains("`range`"));
    assert!(said(&channel, b"{").unwrap_err().contains("no JSON"));
    assert!(said(&channel, "[".repeat(1 << 20).as_bytes()).unwrap_err().contains("no JSON"));
}

/// A field of a protobuf message: of kind 2, bytes behind their length.
fn field(number: u8, bytes: &[u8]) -> Vec<u8> {
    assert!(bytes.len() < 128);
    [&[number << 3 | 2, bytes.len() as u8], bytes].concat()
}

/// A field's descriptor.
fn described(name: &str, number: u8, kind: u8, type_name: &str) -> Vec<u8> {
    let body =
        [field(1, name.as_bytes()), vec![3 << 3, number, 4 << 3, 1, 5 << 3, kind], field(6, type_name.as_bytes())];
    field(2, &body.concat())
}

fn long(number: u8, bytes: &[u8]) -> Vec<u8> {
    let length = [(bytes.len() & 0x7f) as u8 | 0x80, (bytes.len() >> 7) as u8];
    [&[number << 3 | 2][..], &length, bytes].concat()
}

#[test]
fn protobuf_by_the_descriptor_in_its_schema() {
    let fields = [
        field(1, b"Sonar"),
        described("timestamp", 1, 11, ".google.protobuf.Timestamp"),
        described("frame_id", 2, 9, ""),
        described("field_of_view", 3, 2, ""),
        described("min_range", 4, 2, ""),
        described("max_range", 5, 2, ""),
        described("range", 6, 1, ""),
    ];
    let time = [field(1, b"Timestamp"), described("seconds", 1, 3, ""), described("nanos", 2, 5, "")];
    let files = [
        long(1, &[field(2, b"my"), long(4, &fields.concat())].concat()),
        long(1, &[field(2, b"google.protobuf"), long(4, &time.concat())].concat()),
    ];
    let channel = channel("protobuf", "my.Sonar", "protobuf", &files.concat());
    let float = |number: u8, value: f32| [&[number << 3 | 5][..], &value.to_le_bytes()].concat();
    let range = [&[6 << 3 | 1][..], &2.5_f64.to_le_bytes()].concat();
    let parts = [
        field(1, &[1 << 3, 7, 2 << 3, 8]),
        field(2, b"front"),
        float(3, 1.0),
        float(4, 0.25),
        // What nobody has described is passed over.
        field(15, b"more"),
        float(5, 4.0),
        range,
    ];
    let message = parts.concat();
    assert_eq!(said(&channel, &message).unwrap(), [format!("Some(7000000008) front  {RANGE}")]);
    assert!(said(&channel, &message[..message.len() - 1]).is_err());
    // A field that is not there is 0.
    assert_eq!(
        said(&channel, &message[..message.len() - 9]).unwrap(),
        ["Some(7000000008) front  [1.0, 0.25, 4.0, 0.0]"]
    );
    assert!(protobuf::Plan::new(Kind::Range, "my.Sonar", &files[0]).unwrap_err().contains("`stamp`"));
}

#[test]
fn which_channels_are_read() {
    let kind = |encoding: &str, name: &str| Kind::of(&channel(encoding, name, "ros2msg", b""));
    assert_eq!(kind("cdr", "sensor_msgs/msg/Range"), Some(Kind::Range));
    assert_eq!(kind("cdr", "sensor_msgs::msg::dds_::Range_"), Some(Kind::Range));
    assert_eq!(kind("ros1", "tf/tfMessage"), Some(Kind::Transforms));
    assert_eq!(kind("protobuf", "foxglove.FrameTransform"), Some(Kind::Transform));
    assert_eq!(kind("json", "foxglove.PoseInFrame"), Some(Kind::Pose));
    // Read where somebody asks for it, and in these encodings alone.
    assert_eq!(kind("cdr", "sensor_msgs/msg/LaserScan"), Some(Kind::Scan));
    assert_eq!(kind("json", "sensor_msgs/msg/LaserScan"), None);
    assert_eq!(kind("cbor", "sensor_msgs/msg/Range"), None);
    assert_eq!(kind("cdr", "my_msgs/msg/Range"), None);
}

#[test]
fn types_that_double_at_every_level_are_refused() {
    let mut text = "a/T0 x\n".to_owned();
    for level in 0..20 {
        text += &format!("===\nMSG: a/T{level}\na/T{} one\na/T{} two\n", level + 1, level + 1);
    }
    text += "===\nMSG: a/T20\nuint8 x\n";
    let channel = channel("cdr", "sensor_msgs/msg/Range", "ros2msg", text.as_bytes());
    assert!(said(&channel, &[]).unwrap_err().contains("fields"));
}

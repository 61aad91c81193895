//! What messages say: from a channel's schema to the values that are read of each of its messages.
mod cloud;
mod definition;
mod idl;
mod json;
mod known;
mod plan;
mod protobuf;
mod rosmsg;
mod said;
mod wire;

use std::io::Read as _;

pub(super) use self::{
    cloud::{Cloud, CloudType, Sort, Spot},
    said::{Kind, Measured, Said},
};
use self::{
    definition::{Definitions, short},
    plan::Plan,
    rosmsg::Version,
    wire::Wire,
};
use super::{body::WINDOW_LOG_MAX, raw::Channel};

/// Largest schema that is read, in bytes.
const LARGEST_SCHEMA: usize = 1 << 20;
/// What a compressed message begins with.
const ZSTD_MAGIC: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];
/// Longest message that is unpacked, in bytes.
const LARGEST_UNPACKED: u64 = 64 << 20;

/// How messages are encoded, as far as it is known here.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Encoding {
    Cdr,
    Ros1,
    Protobuf,
    Json,
}

impl Encoding {
    fn of(channel: &Channel) -> Option<Self> {
        match channel.encoding.as_str() {
            "cdr" => Some(Self::Cdr),
            "ros1" => Some(Self::Ros1),
            "protobuf" => Some(Self::Protobuf),
            "json" => Some(Self::Json),
            _ => None,
        }
    }
}

impl Kind {
    /// What a channel's messages are by the name of their type, and by its fields where the encoding allows any name; `None`
    /// where they are not read.
    pub(super) fn of(channel: &Channel) -> Option<Self> {
        let encoding = Encoding::of(channel)?;
        let schema = channel.schema.as_deref()?;
        let name = short(&schema.name.replace('.', "/"));
        Some(match name.as_str() {
            "sensor_msgs/Range" => Self::Range,
            "tf2_msgs/TFMessage" | "tf/tfMessage" | "foxglove/FrameTransforms" => Self::Transforms,
            "geometry_msgs/TransformStamped" | "foxglove/FrameTransform" => Self::Transform,
            "nav_msgs/Odometry" => Self::Odometry,
            "geometry_msgs/PoseStamped" | "foxglove/PoseInFrame" => Self::Pose,
            "sensor_msgs/LaserScan" if matches!(encoding, Encoding::Cdr | Encoding::Ros1) => Self::Scan,
            _ if schema.data.len() > LARGEST_SCHEMA => return None,
            _ if encoding == Encoding::Json && json::is_range(&schema.data) => Self::Range,
            _ if matches!(encoding, Encoding::Cdr | Encoding::Ros1) && lists_ranges(&schema.data) => Self::Ranges,
            _ if encoding == Encoding::Protobuf && protobuf::is_range(&schema.name, &schema.data) => Self::Range,
            _ => return None,
        })
    }
}

#[derive(Debug)]
enum Way {
    Cdr(Plan),
    Ros1(Plan),
    Protobuf(protobuf::Plan),
    Json,
}

/// Reads the messages of one channel.
#[derive(Debug)]
pub(super) struct Decoder {
    kind: Kind,
    way: Way,
}

impl Decoder {
    /// The decoder of a channel of the kind; the words are why its messages can't be read.
    pub(super) fn for_channel(kind: Kind, channel: &Channel) -> Result<Self, String> {
        let (Some(schema), Some(encoding)) = (&channel.schema, Encoding::of(channel)) else {
            return Err("nothing describes its messages".to_owned());
        };
        if schema.data.len() > LARGEST_SCHEMA {
            return Err(format!("{} bytes of schema are more than anybody needs", schema.data.len()));
        }
        let way = match encoding {
            Encoding::Protobuf if schema.encoding == "protobuf" => {
                Way::Protobuf(protobuf::Plan::new(kind, &schema.name, &schema.data)?)
            }
            Encoding::Json => Way::Json,
            Encoding::Cdr | Encoding::Ros1 => {
                let definitions = definitions(encoding, &schema.name, &schema.encoding, &schema.data)?;
                let plan = Plan::new(kind, &schema.name, &definitions)?;
                if encoding == Encoding::Cdr { Way::Cdr(plan) } else { Way::Ros1(plan) }
            }
            Encoding::Protobuf => return Err(format!("a schema in {} describes no protobuf", schema.encoding)),
        };
        Ok(Self { kind, way })
    }

    /// Reads a message: calls `each` with what it says, once for each element of a list. The words are why it can't be read on;
    /// what came before that was said.
    pub(super) fn read(&self, data: &[u8], said: &mut Said, each: &mut dyn FnMut(&mut Said)) -> Result<(), String> {
        let unpacked;
        // CDR and JSON never begin like that: the recorder has compressed message by message.
        let data = if data.starts_with(&ZSTD_MAGIC) && matches!(self.way, Way::Cdr(_) | Way::Json) {
            unpacked = unpack(data)?;
            &unpacked
        } else {
            data
        };
        match &self.way {
            Way::Cdr(plan) => plan.read(&mut Wire::cdr(data)?, said, each),
            Way::Ros1(plan) => plan.read(&mut Wire::ros1(data), said, each),
            Way::Protobuf(plan) => plan.read(data, said, each),
            Way::Json => json::read(self.kind, data, said, each),
        }
    }
}

/// What a message in zstd holds; the words are why it can't be unpacked.
fn unpack(data: &[u8]) -> Result<Vec<u8>, String> {
    let failed = |error: std::io::Error| format!("it is compressed by zstd, and can't be unpacked: {error}");
    let mut decoder = zstd::Decoder::with_buffer(data).map_err(failed)?;
    decoder.window_log_max(WINDOW_LOG_MAX).map_err(failed)?;
    let mut unpacked = Vec::new();
    decoder.take(LARGEST_UNPACKED + 1).read_to_end(&mut unpacked).map_err(failed)?;
    match unpacked.len() as u64 > LARGEST_UNPACKED {
        true => Err(format!("it is compressed by zstd, and unpacked longer than {} MiB", LARGEST_UNPACKED >> 20)),
        false => Ok(unpacked),
    }
}

/// Whether a ROS schema has a list of readings.
fn lists_ranges(schema: &[u8]) -> bool {
    const LISTS: [&str; 4] = [
        "sensor_msgs/Range[",
        "sensor_msgs/msg/Range[",
        "sequence<sensor_msgs::msg::Range",
        "sequence<sensor_msgs/msg/Range",
    ];
    LISTS.iter().any(|list| memchr::memmem::find(schema, list.as_bytes()).is_some())
}

/// The types of a ROS schema.
fn definitions(encoding: Encoding, name: &str, language: &str, data: &[u8]) -> Result<Definitions, String> {
    let text = std::str::from_utf8(data).map_err(|_| "its schema is no UTF-8 text")?;
    let version = if encoding == Encoding::Cdr { Version::Two } else { Version::One };
    match (language, encoding) {
        // Early recorders left the description out: what is read stands at the same place in all releases.
        _ if text.trim().is_empty() => rosmsg::parse(name, &known::definition(name, version)?, version),
        ("ros2idl" | "omgidl", Encoding::Cdr) => idl::parse(text),
        ("ros2msg", Encoding::Cdr) | ("ros1msg", Encoding::Ros1) => rosmsg::parse(name, text, version),
        _ => Err(format!("a schema in {language} describes no {encoding:?}")),
    }
}

#[cfg(test)]
mod tests;

//! Clouds of points, which say themselves where each field of a point stands.
//!
//! The two types are the same in every release (sensor_msgs/PointCloud2; docs.foxglove.dev, "PointCloud"): messages are read as
//! they are published there, whatever schema the file has for them.

use super::{
    super::{raw::Channel, write::points::Number},
    definition::{Scalar, short},
    protobuf::{Fields, Value},
    wire::{self, Wire},
};

/// Fields of a point, at most.
const MOST_FIELDS: usize = 256;
/// Characters of a field's name that a message shows.
const SHOWN: usize = 40;

/// The types of clouds that are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in super::super) enum CloudType {
    /// sensor_msgs/PointCloud2 of ROS 2.
    Ros2,
    /// foxglove.PointCloud in protobuf.
    Foxglove,
}

impl CloudType {
    /// What a channel's messages are; `None` where they are no clouds that are read.
    pub(in super::super) fn of(channel: &Channel) -> Option<Self> {
        let name = short(&channel.schema.as_deref()?.name.replace('.', "/"));
        match (channel.encoding.as_str(), name.as_str()) {
            ("cdr", "sensor_msgs/PointCloud2") => Some(Self::Ros2),
            ("protobuf", "foxglove/PointCloud") => Some(Self::Foxglove),
            _ => None,
        }
    }

    /// Reads a message; the words are why it can't be read.
    pub(in super::super) fn read(self, message: &[u8]) -> Result<Cloud<'_>, String> {
        let cloud = match self {
            Self::Ros2 => ros2(message)?,
            Self::Foxglove => foxglove(message)?,
        };
        match cloud.points.len().checked_rem(cloud.stride) {
            Some(0) => Ok(cloud),
            None if cloud.points.is_empty() => Ok(cloud),
            _ => Err(format!("{} bytes are no number of points of {} each", cloud.points.len(), cloud.stride)),
        }
    }
}

/// A cloud: a whole number of points.
#[derive(Debug, Default)]
pub(in super::super) struct Cloud<'a> {
    /// Its stamp, in nanoseconds.
    pub(in super::super) t: i64,
    /// Bytes from one point to the next; 0 only where there are no points.
    pub(in super::super) stride: usize,
    /// The points' bytes.
    pub(in super::super) points: &'a [u8],
    fields: Vec<Field<'a>>,
}

/// A field of the points.
#[derive(Debug, Clone, Copy)]
struct Field<'a> {
    name: &'a [u8],
    offset: usize,
    /// `None` for types that are not read.
    number: Option<Number>,
}

/// What a number has to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in super::super) enum Sort {
    /// A float.
    Real,
    /// A whole number from 0 on.
    Whole,
}

/// Where a number stands within each point's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in super::super) struct Spot {
    offset: usize,
    number: Number,
}

impl Cloud<'_> {
    /// Where the number of the first of these names stands that the points have; the words are why it can't be read.
    pub(in super::super) fn find(&self, names: &[&str], sort: Sort) -> Result<Spot, String> {
        let named = |name: &&str| self.fields.iter().find(|field| field.name == name.as_bytes());
        let Some(field) = names.iter().find_map(named) else {
            let name = names.last().copied().unwrap_or_default();
            return Err(format!("its points have no field `{name}`; they have {}", self.names()));
        };
        let name = shown(field.name);
        let number = field.number.filter(|number| number.is_whole() == (sort == Sort::Whole));
        let Some(number) = number else {
            let (is, wanted) = (field.number.map_or("of a type that is not read", Number::name), sort.words());
            return Err(format!("the field `{name}` of its points is {is}, and has to be {wanted}"));
        };
        let fits = field.offset.checked_add(number.size()).is_some_and(|end| end <= self.stride);
        if !fits && self.stride > 0 {
            let (offset, stride) = (field.offset, self.stride);
            return Err(format!("the field `{name}` at byte {offset} reaches beyond its points of {stride} bytes"));
        }
        Ok(Spot { offset: field.offset, number })
    }

    /// The names of the fields.
    fn names(&self) -> String {
        match self.fields.len() {
            0 => "none at all".to_owned(),
            _ => self.fields.iter().map(|field| shown(field.name)).collect::<Vec<_>>().join(", "),
        }
    }
}

impl Spot {
    /// The number in the bytes of one point; every type's numbers fit. NaN where they end before it.
    pub(in super::super) fn read(self, point: &[u8]) -> f64 {
        point.get(self.offset..).and_then(|bytes| self.number.read(bytes)).unwrap_or(f64::NAN)
    }
}

impl Sort {
    const fn words(self) -> &'static str {
        match self {
            Self::Real => "float32 or float64",
            Self::Whole => "uint8, uint16 or uint32",
        }
    }
}

fn shown(name: &[u8]) -> String {
    String::from_utf8_lossy(name).chars().take(SHOWN).flat_map(char::escape_debug).collect()
}

/// Reads sensor_msgs/PointCloud2.
fn ros2(message: &[u8]) -> Result<Cloud<'_>, String> {
    let mut wire = Wire::cdr(message)?;
    let t = stamp(whole(&mut wire, Scalar::I32)?, whole(&mut wire, Scalar::U32)?)?;
    wire.text()?; // frame_id
    let (height, width) = (size(&mut wire)?, size(&mut wire)?);
    let count = wire.count()?;
    check_fields(count)?;
    let mut fields = Vec::with_capacity(count);
    for _ in 0..count {
        let (name, offset) = (wire.text()?, size(&mut wire)?);
        let code = whole(&mut wire, Scalar::U8)?;
        size(&mut wire)?; // How many: the first one counts.
        fields.push(Field { name, offset, number: Number::find(|number| code == i64::from(number.in_point_field())) });
    }
    if whole(&mut wire, Scalar::U8)? != 0 {
        return Err("its points are big endian, which is not read".to_owned());
    }
    let (stride, row) = (size(&mut wire)?, size(&mut wire)?);
    let points = wire.octets()?;
    let is_dense = width.checked_mul(stride) == Some(row) && height.checked_mul(row) == Some(points.len());
    if !is_dense {
        let bytes = points.len();
        return Err(format!(
            "{height} x {width} points of {stride} bytes, {row} a row, are not the {bytes} bytes that it has"
        ));
    }
    Ok(Cloud { t, stride, points, fields })
}

fn whole(wire: &mut Wire<'_>, scalar: Scalar) -> Result<i64, String> {
    match wire.number(scalar)? {
        wire::Number::Whole(value) => Ok(value),
        _ => Err("no whole number".to_owned()),
    }
}

fn size(wire: &mut Wire<'_>) -> Result<usize, String> {
    let value = whole(wire, Scalar::U32)?;
    usize::try_from(value).map_err(|_| format!("{value} is no size"))
}

/// Reads foxglove.PointCloud. Its `pose` is not looked at: points of `atm` are in the cloud's frame.
fn foxglove(message: &[u8]) -> Result<Cloud<'_>, String> {
    let (mut cloud, mut parts) = (Cloud::default(), Fields::new(message));
    for (number, value) in &mut parts {
        match (number, value) {
            (1, Value::Bytes(timestamp)) => {
                let (mut seconds, mut nanoseconds) = (0, 0);
                let mut parts = Fields::new(timestamp);
                for part in &mut parts {
                    match part {
                        (1, Value::Varint(bits)) => seconds = bits as i64,
                        (2, Value::Varint(bits)) => nanoseconds = bits as i64,
                        _ => {}
                    }
                }
                parts.end()?;
                cloud.t = stamp(seconds, nanoseconds)?;
            }
            (4, Value::Four(stride)) => cloud.stride = fixed(stride)?,
            (5, Value::Bytes(field)) => {
                check_fields(cloud.fields.len() + 1)?;
                cloud.fields.push(packed_element(field)?);
            }
            (6, Value::Bytes(points)) => cloud.points = points,
            _ => {}
        }
    }
    parts.end()?;
    Ok(cloud)
}

/// Reads foxglove.PackedElementField.
fn packed_element(message: &[u8]) -> Result<Field<'_>, String> {
    let (mut field, mut parts) = (Field { name: b"", offset: 0, number: None }, Fields::new(message));
    for part in &mut parts {
        match part {
            (1, Value::Bytes(name)) => field.name = name,
            (2, Value::Four(offset)) => field.offset = fixed(offset)?,
            (3, Value::Varint(code)) => {
                field.number = Number::find(|number| i64::try_from(code) == Ok(number.in_packed_element()));
            }
            _ => {}
        }
    }
    parts.end()?;
    Ok(field)
}

fn fixed(bytes: [u8; 4]) -> Result<usize, String> {
    let value = u32::from_le_bytes(bytes);
    usize::try_from(value).map_err(|_| format!("{value} is no size"))
}

fn stamp(seconds: i64, nanoseconds: i64) -> Result<i64, String> {
    let t = seconds.checked_mul(1_000_000_000).and_then(|t| t.checked_add(nanoseconds));
    t.ok_or_else(|| format!("its stamp, {seconds} s, is out of reach"))
}

fn check_fields(count: usize) -> Result<(), String> {
    if count <= MOST_FIELDS { Ok(()) } else { Err(format!("its points have more than {MOST_FIELDS} fields")) }
}

#[cfg(test)]
mod tests;

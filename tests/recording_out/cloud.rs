//! Clouds of points, of either kind, by the names of their fields.

use std::collections::BTreeMap;

use crate::{cdr::Cdr, proto::Proto, sample::Logged};

/// A cloud.
pub struct Cloud {
    pub t: i64,
    pub frame: String,
    /// Name, offset and size of each field.
    pub fields: Vec<(String, usize, usize)>,
    /// Each point's fields. All types fit `f64`, and no value here is beyond its whole numbers.
    pub points: Vec<BTreeMap<String, f64>>,
}

/// Numbers of types in sensor_msgs/PointField.
fn number(bytes: &[u8], datatype: u64) -> f64 {
    match datatype {
        2 => f64::from(bytes[0]),
        4 => f64::from(u16::from_le_bytes(bytes[..2].try_into().unwrap())),
        6 => f64::from(u32::from_le_bytes(bytes[..4].try_into().unwrap())),
        7 => f64::from(f32::from_le_bytes(bytes[..4].try_into().unwrap())),
        8 => f64::from_le_bytes(bytes[..8].try_into().unwrap()),
        other => panic!("type {other}"),
    }
}

/// Names, offsets, and sizes by the types of sensor_msgs/PointField.
fn sized(fields: &[(String, usize, u64)]) -> Vec<(String, usize, usize)> {
    let size = |datatype| [0, 1, 1, 2, 2, 4, 4, 4, 8][datatype as usize];
    fields.iter().map(|(name, offset, datatype)| (name.clone(), *offset, size(*datatype))).collect()
}

/// From foxglove.PackedElementField's numbers of types to sensor_msgs/PointField's.
fn as_point_field(numeric_type: i64) -> u64 {
    match numeric_type {
        1 => 2,
        3 => 4,
        5 => 6,
        7 => 7,
        8 => 8,
        other => panic!("type {other}"),
    }
}

fn points(data: &[u8], stride: usize, fields: &[(String, usize, u64)]) -> Vec<BTreeMap<String, f64>> {
    assert_eq!(data.len() % stride, 0);
    let point = |bytes: &[u8]| {
        fields.iter().map(|(name, offset, datatype)| (name.clone(), number(&bytes[*offset..], *datatype))).collect()
    };
    data.chunks(stride).map(point).collect()
}

impl Cloud {
    pub fn of(message: &Logged) -> Self {
        match message.schema.as_str() {
            "foxglove.PointCloud" => Self::foxglove(&message.data),
            "sensor_msgs/msg/PointCloud2" => Self::ros(&message.data),
            other => panic!("{other} is no cloud"),
        }
    }

    fn foxglove(data: &[u8]) -> Self {
        let cloud = Proto::new(data);
        assert_eq!(cloud.message(3).place(1, 2), [0.0; 3]);
        let field =
            |field: Proto<'_>| (field.text(1).to_owned(), field.integer(2) as usize, as_point_field(field.integer(3)));
        let fields: Vec<_> = cloud.messages(5).map(field).collect();
        let points = points(cloud.bytes(6), cloud.integer(4) as usize, &fields);
        Self { t: cloud.stamp(1), frame: cloud.text(2).to_owned(), fields: sized(&fields), points }
    }

    fn ros(data: &[u8]) -> Self {
        let mut cloud = Cdr::new(data);
        let (t, frame) = cloud.header();
        let (height, width) = (cloud.u32(), cloud.u32());
        let count = cloud.u32();
        let fields: Vec<_> = (0..count)
            .map(|_| {
                let (name, offset, datatype) = (cloud.string().to_owned(), cloud.u32() as usize, cloud.u8());
                assert_eq!(cloud.u32(), 1);
                (name, offset, u64::from(datatype))
            })
            .collect();
        assert_eq!(cloud.u8(), 0, "little endian");
        let (stride, row) = (cloud.u32(), cloud.u32());
        assert_eq!(height, 1);
        assert_eq!(row, width * stride);
        let points = points(cloud.bytes(), stride as usize, &fields);
        assert_eq!(points.len(), width as usize);
        assert_eq!(cloud.u8(), 1, "every point is one");
        cloud.end();
        Self { t, frame: frame.to_owned(), fields: sized(&fields), points }
    }
}

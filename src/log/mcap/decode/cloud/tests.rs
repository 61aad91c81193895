use std::{collections::BTreeMap, sync::Arc};

use super::*;
use crate::log::mcap::raw::Schema;

fn channel(encoding: &str, name: &str) -> Channel {
    let schema = Schema { id: 1, name: name.into(), encoding: String::new(), data: Vec::new() };
    let (topic, metadata) = ("/cloud".into(), BTreeMap::new());
    Channel { id: 1, schema: Some(Arc::new(schema)), topic, encoding: encoding.into(), metadata }
}

/// What a message of either type says, before it is one.
#[derive(Clone)]
struct Said {
    seconds: i64,
    size: [u32; 2],
    /// Name, byte, type's number.
    fields: Vec<(&'static str, u32, u8)>,
    stride: u32,
    row: u32,
    points: Vec<u8>,
}

/// Two points with a float64 and a byte each.
fn said() -> Said {
    let mut points = Vec::new();
    for (x, kind) in [(1.5f64, 3), (-2.25, 4)] {
        points.extend_from_slice(&x.to_le_bytes());
        points.extend_from_slice(&[kind, 0]);
    }
    Said { seconds: 7, size: [1, 2], fields: vec![("x", 0, 8), ("kind", 8, 2)], stride: 10, row: 20, points }
}

impl Said {
    /// In CDR, with the highest byte first where it is `big`.
    fn ros2(&self, big: bool) -> Vec<u8> {
        let mut out: Vec<u8> = Vec::new();
        let word = |out: &mut Vec<u8>, value: u32| {
            out.resize(out.len().next_multiple_of(4), 0);
            out.extend(if big { value.to_be_bytes() } else { value.to_le_bytes() });
        };
        let text = |out: &mut Vec<u8>, text: &str| {
            word(out, text.len() as u32 + 1);
            out.extend(text.bytes().chain([0]));
        };
        word(&mut out, self.seconds as u32);
        word(&mut out, 9);
        text(&mut out, "odom");
        self.size.iter().for_each(|size| word(&mut out, *size));
        word(&mut out, self.fields.len() as u32);
        for (name, offset, datatype) in &self.fields {
            text(&mut out, name);
            word(&mut out, *offset);
            out.push(*datatype);
            word(&mut out, 1);
        }
        out.push(0);
        [self.stride, self.row, self.points.len() as u32].iter().for_each(|value| word(&mut out, *value));
        out.extend(&self.points);
        out.push(1);
        [&[0, u8::from(!big), 0, 0], &out[..]].concat()
    }

    /// In protobuf; all lengths here are below 128.
    fn foxglove(&self) -> Vec<u8> {
        let bytes = |field: u8, bytes: &[u8]| [&[field << 3 | 2, bytes.len() as u8], bytes].concat();
        let four = |field: u8, value: u32| [&[field << 3 | 5][..], &value.to_le_bytes()].concat();
        // From sensor_msgs/PointField's numbers to foxglove.PackedElementField's.
        let code = |datatype: u8| match datatype {
            2 => 1,
            4 => 3,
            6 => 5,
            other => other,
        };
        let mut out = bytes(1, &[8, self.seconds as u8, 16, 9]);
        out.extend(bytes(2, b"odom"));
        out.extend(four(4, self.stride));
        for (name, offset, datatype) in &self.fields {
            let parts = [bytes(1, name.as_bytes()), four(2, *offset), vec![3 << 3, code(*datatype)]];
            out.extend(bytes(5, &parts.concat()));
        }
        out.extend(bytes(6, &self.points));
        out
    }

    fn all(&self) -> [(CloudType, Vec<u8>); 3] {
        let ros2 = [false, true].map(|big| (CloudType::Ros2, self.ros2(big)));
        let [little, big] = ros2;
        [little, big, (CloudType::Foxglove, self.foxglove())]
    }
}

/// What is said of a message that can't be used, looked at for `x` and `kind`.
#[track_caller]
fn refused(said: &Said) -> Vec<String> {
    let find = |kind: CloudType, message: &[u8]| {
        let cloud = kind.read(message)?;
        cloud.find(&["x"], Sort::Real)?;
        cloud.find(&["kind"], Sort::Whole)
    };
    said.all().iter().map(|(kind, message)| find(*kind, message).expect_err("it was accepted")).collect()
}

#[test]
fn types_are_known_by_name_and_encoding() {
    assert_eq!(CloudType::of(&channel("cdr", "sensor_msgs/msg/PointCloud2")), Some(CloudType::Ros2));
    assert_eq!(CloudType::of(&channel("protobuf", "foxglove.PointCloud")), Some(CloudType::Foxglove));
    for (encoding, name) in
        [("ros1", "sensor_msgs/PointCloud2"), ("json", "foxglove.PointCloud"), ("cdr", "std_msgs/msg/String")]
    {
        assert_eq!(CloudType::of(&channel(encoding, name)), None, "{encoding} {name}");
    }
    assert_eq!(CloudType::of(&Channel { schema: None, ..channel("cdr", "") }), None);
}

#[test]
fn numbers_are_read_by_the_names_of_their_fields() {
    for (kind, message) in said().all() {
        let cloud = kind.read(&message).unwrap();
        assert_eq!((cloud.t, cloud.stride), (7_000_000_009, 10));
        let (x, kind) = (cloud.find(&["exact_x", "x"], Sort::Real).unwrap(), cloud.find(&["kind"], Sort::Whole));
        let kind = kind.unwrap();
        let read: Vec<_> = cloud.points.chunks(10).map(|point| (x.read(point), kind.read(point))).collect();
        assert_eq!(read, [(1.5, 3.0), (-2.25, 4.0)]);
    }
}

#[test]
fn every_type_of_number_is_read_to_its_last_bit() {
    let bytes = [0xff, 0xfe, 0xfd, 0x7e, 0x01, 0x02, 0x03, 0x40];
    let values = [
        (2, f64::from(0xff_u8)),
        (4, f64::from(0xfeff_u16)),
        (6, f64::from(0x7efd_feff_u32)),
        (7, f64::from(f32::from_bits(0x7efd_feff))),
        (8, f64::from_bits(0x4003_0201_7efd_feff)),
    ];
    for (datatype, value) in values {
        let said =
            Said { size: [1, 1], fields: vec![("n", 0, datatype)], stride: 8, row: 8, points: bytes.into(), ..said() };
        let sort = if datatype < 7 { Sort::Whole } else { Sort::Real };
        for (kind, message) in said.all() {
            let cloud = kind.read(&message).unwrap();
            assert_eq!(cloud.find(&["n"], sort).unwrap().read(cloud.points).to_bits(), value.to_bits());
        }
    }
}

#[test]
fn fields_that_are_missing_of_another_type_or_out_of_reach_are_named() {
    let with = |fields: &[(&'static str, u32, u8)]| refused(&Said { fields: fields.to_vec(), ..said() });
    assert_eq!(with(&[("x", 0, 8)]), ["its points have no field `kind`; they have x"; 3]);
    assert_eq!(with(&[]), ["its points have no field `x`; they have none at all"; 3]);
    let words = "the field `x` of its points is uint8, and has to be float32 or float64";
    assert_eq!(with(&[("x", 0, 2), ("kind", 8, 2)]), [words; 3]);
    let words = "the field `kind` of its points is of a type that is not read, and has to be uint8, uint16 or uint32";
    assert_eq!(with(&[("x", 0, 8), ("kind", 8, 0)]), [words; 3]);
    let words = "the field `kind` at byte 10 reaches beyond its points of 10 bytes";
    assert_eq!(with(&[("x", 0, 8), ("kind", 10, 2)]), [words; 3]);
    let words = "the field `x` at byte 4294967295 reaches beyond its points of 10 bytes";
    assert_eq!(with(&[("x", u32::MAX, 8), ("kind", 8, 2)]), [words; 3]);
}

#[test]
fn sizes_that_do_not_go_with_the_bytes_are_refused() {
    for (size, stride, row) in [([1, 3], 10, 30), ([2, 2], 10, 20), ([1, 2], 0, 0), ([1, 2], 10, 21), ([0, 0], 10, 0)] {
        let ros2 = Said { size, stride, row, ..said() }.ros2(false);
        let words = CloudType::Ros2.read(&ros2).unwrap_err();
        assert!(words.contains("points") && words.contains("20"), "{words}");
    }
    for stride in [0, 3, u32::MAX] {
        let words = CloudType::Foxglove.read(&Said { stride, ..said() }.foxglove()).unwrap_err();
        assert_eq!(words, format!("20 bytes are no number of points of {stride} each"));
    }
    // All at their largest: nothing is multiplied unseen.
    let most = Said { size: [u32::MAX; 2], stride: u32::MAX, row: u32::MAX, ..said() };
    assert!(CloudType::Ros2.read(&most.ros2(false)).is_err());
}

#[test]
fn a_cloud_without_points_is_one() {
    let none = Said { size: [1, 0], row: 0, points: Vec::new(), ..said() };
    for (kind, message) in none.all().into_iter().chain(Said { stride: 0, ..none }.all()) {
        let cloud = kind.read(&message).unwrap();
        assert!(cloud.points.is_empty() && cloud.find(&["x"], Sort::Real).is_ok());
    }
}

#[test]
fn so_many_fields_are_read_and_no_more() {
    let fields = |count: usize| Said { fields: vec![("x", 0, 8); count], ..said() };
    for (kind, message) in fields(MOST_FIELDS).all() {
        assert!(kind.read(&message).is_ok());
    }
    for (kind, message) in fields(MOST_FIELDS + 1).all() {
        assert_eq!(kind.read(&message).unwrap_err(), "its points have more than 256 fields");
    }
    // A count that the message can't hold takes no room.
    let mut message = Said { fields: Vec::new(), ..said() }.ros2(false);
    message[32..36].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(CloudType::Ros2.read(&message).unwrap_err().contains("4294967295 elements"));
}

#[test]
fn a_stamp_out_of_reach_and_points_in_the_other_order_are_refused() {
    let timestamp = [&[8][..], &[0xff; 8], &[0x7f]].concat();
    let message = [&[1 << 3 | 2, timestamp.len() as u8][..], &timestamp].concat();
    let words = CloudType::Foxglove.read(&message).unwrap_err();
    assert_eq!(words, "its stamp, 9223372036854775807 s, is out of reach");
    let mut message = said().ros2(false);
    let at = message.len() - 1 - 20 - 12 - 4;
    message[at] = 1;
    assert_eq!(CloudType::Ros2.read(&message).unwrap_err(), "its points are big endian, which is not read");
}

#[test]
fn whatever_is_cut_off_or_changed_gives_words_or_points_within_the_message() {
    for (kind, message) in said().all() {
        // What of ROS 2's is behind the points is not read.
        let end = message.len() - usize::from(kind == CloudType::Ros2);
        for cut in 0..message.len() {
            let cloud = kind.read(&message[..cut]);
            let points = cloud.map_or(0, |cloud| cloud.points.len());
            assert!(points == 0 || cut >= end, "cut at {cut}");
        }
        for at in 0..message.len() {
            for bit in 0..8 {
                let mut message = message.clone();
                message[at] ^= 1 << bit;
                if let Ok(cloud) = kind.read(&message)
                    && let Ok(spot) = cloud.find(&["x"], Sort::Real)
                {
                    assert!(cloud.points.len() <= message.len());
                    let read = cloud.points.chunks(cloud.stride.max(1)).filter(|point| spot.read(point).is_finite());
                    assert!(read.count() <= cloud.points.len());
                }
            }
        }
    }
}

//! How points are laid out in a cloud's bytes, with the names under which readers find them again.
//!
//! Every point begins with its place and its colour, in 32 bytes, as the viewers of the schema read them:
//!
//! | schema | place | colour |
//! |---|---|---|
//! | Foxglove | `x`, `y`, `z` in `f64` | `red`, `green`, `blue`, `alpha` |
//! | ROS 2 | `x`, `y`, `z` in `f32`, which is what RViz and PCL take; `exact_x`, `exact_y` in `f64` | `rgb`, 0x00RRGGBB |
//!
//! What follows is the same in both.

use super::{content::Color, schema::SchemaKind};

/// Names of fields: metres, radians, nanoseconds.
pub mod names {
    /// Place in the fixed frame.
    pub const X: &str = "x";
    /// Place in the fixed frame.
    pub const Y: &str = "y";
    /// 0: the plane of the echoes.
    pub const Z: &str = "z";
    /// `x` in full, where that is an `f32`.
    pub const EXACT_X: &str = "exact_x";
    /// `y` in full, where that is an `f32`.
    pub const EXACT_Y: &str = "exact_y";
    /// The reading.
    pub const RANGE: &str = "range";
    /// Where on the arc: angle from the boresight, counter-clockwise.
    pub const AZIMUTH: &str = "azimuth";
    /// Length along the arc in which the echo lies.
    pub const RESOLUTION: &str = "resolution";
    /// Equation (1).
    pub const SIGNIFICANCE: &str = "significance";
    /// Nanoseconds from the message's stamp to the reading.
    pub const T: &str = "t";
    /// Nanoseconds from the message's stamp to the other arc's reading: whole, exact up to 104 days.
    pub const T_OTHER: &str = "t_other";
    /// Transversal crossings on the arc.
    pub const CROSSINGS: &str = "crossings";
    /// Index of the sensor.
    pub const SENSOR: &str = "sensor";
    /// Index of the other arc's sensor.
    pub const SENSOR_OTHER: &str = "sensor_other";
    /// How the echo was found: see [`super::KINDS`].
    pub const KIND: &str = "kind";
    /// The crossing angle.
    pub const ANGLE: &str = "angle";
    /// Of the consensus: readings that agree.
    pub const SUPPORT: &str = "support";
    /// Of the consensus: readings that look there and report clearly farther, or nothing.
    pub const AGAINST: &str = "against";
    /// Of the consensus: standard deviation of the azimuth.
    pub const SIGMA_AZIMUTH: &str = "sigma_azimuth";
    /// Of the consensus: standard deviation of the distance from the sensor.
    pub const SIGMA_RANGE: &str = "sigma_range";
    /// Of the consensus: a wall's normal, NaN but for walls.
    pub const NORMAL_X: &str = "normal_x";
    /// Of the consensus: a wall's normal, NaN but for walls.
    pub const NORMAL_Y: &str = "normal_y";
}

/// The kinds of echoes, of either estimator, in order of their numbers: a point's `kind` is an index into them.
pub const KINDS: [&str; 7] = ["median", "single", "center", "near", "pair", "point", "wall"];

/// The number of a kind.
pub(super) fn kind_number(kind: &str) -> u8 {
    KINDS.iter().zip(0..).find(|(known, _)| **known == kind).map_or(u8::MAX, |(_, number)| number)
}

/// The type of a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in super::super) enum Number {
    U8,
    U16,
    U32,
    F32,
    F64,
}

impl Number {
    const ALL: [Self; 5] = [Self::U8, Self::U16, Self::U32, Self::F32, Self::F64];

    /// The first that is the one looked for.
    pub(in super::super) fn find(is_it: impl Fn(Self) -> bool) -> Option<Self> {
        Self::ALL.into_iter().find(|number| is_it(*number))
    }

    /// Its name in ROS.
    pub(in super::super) const fn name(self) -> &'static str {
        match self {
            Self::U8 => "uint8",
            Self::U16 => "uint16",
            Self::U32 => "uint32",
            Self::F32 => "float32",
            Self::F64 => "float64",
        }
    }

    /// Whether it is a whole number.
    pub(in super::super) const fn is_whole(self) -> bool {
        matches!(self, Self::U8 | Self::U16 | Self::U32)
    }

    /// The number that the bytes begin with, exactly; `None` where they are too few.
    pub(in super::super) fn read(self, bytes: &[u8]) -> Option<f64> {
        Some(match self {
            Self::U8 => (*bytes.first()?).into(),
            Self::U16 => u16::from_le_bytes(*bytes.first_chunk()?).into(),
            Self::U32 => u32::from_le_bytes(*bytes.first_chunk()?).into(),
            Self::F32 => f32::from_le_bytes(*bytes.first_chunk()?).into(),
            Self::F64 => f64::from_le_bytes(*bytes.first_chunk()?),
        })
    }

    pub(in super::super) const fn size(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// Its number in sensor_msgs/PointField.
    pub(in super::super) const fn in_point_field(self) -> u8 {
        match self {
            Self::U8 => 2,
            Self::U16 => 4,
            Self::U32 => 6,
            Self::F32 => 7,
            Self::F64 => 8,
        }
    }

    /// Its number in foxglove.PackedElementField.
    pub(in super::super) const fn in_packed_element(self) -> i64 {
        match self {
            Self::U8 => 1,
            Self::U16 => 3,
            Self::U32 => 5,
            Self::F32 => 7,
            Self::F64 => 8,
        }
    }
}

type Fields = &'static [(&'static str, Number)];

/// A cloud of echoes.
const ECHO: Fields = &[
    (names::RANGE, Number::F64),
    (names::AZIMUTH, Number::F64),
    (names::RESOLUTION, Number::F64),
    (names::SIGNIFICANCE, Number::F64),
    (names::T, Number::U32),
    (names::CROSSINGS, Number::U32),
    (names::SENSOR, Number::U16),
    (names::KIND, Number::U8),
];

/// What the consensus says of an echo besides.
const CONSENSUS: Fields = &[
    (names::SIGMA_AZIMUTH, Number::F64),
    (names::SIGMA_RANGE, Number::F64),
    (names::NORMAL_X, Number::F64),
    (names::NORMAL_Y, Number::F64),
    (names::SUPPORT, Number::U32),
    (names::AGAINST, Number::U32),
];

/// A cloud of crossings.
const CROSSING: Fields = &[
    (names::AZIMUTH, Number::F64),
    (names::ANGLE, Number::F64),
    (names::T_OTHER, Number::F64),
    (names::T, Number::U32),
    (names::SENSOR, Number::U16),
    (names::SENSOR_OTHER, Number::U16),
];

/// What every point of a Foxglove cloud begins with.
const FOXGLOVE_PLACE: Fields = &[
    (names::X, Number::F64),
    (names::Y, Number::F64),
    (names::Z, Number::F64),
    ("red", Number::U8),
    ("green", Number::U8),
    ("blue", Number::U8),
    ("alpha", Number::U8),
];

/// What every point of a ROS 2 cloud begins with.
const ROS_PLACE: Fields = &[
    (names::X, Number::F32),
    (names::Y, Number::F32),
    (names::Z, Number::F32),
    ("rgb", Number::U32),
    (names::EXACT_X, Number::F64),
    (names::EXACT_Y, Number::F64),
];

/// Place and colour alone, for what is only looked at.
const FOXGLOVE_DOT: Fields = &[
    (names::X, Number::F32),
    (names::Y, Number::F32),
    (names::Z, Number::F32),
    ("red", Number::U8),
    ("green", Number::U8),
    ("blue", Number::U8),
    ("alpha", Number::U8),
];
const ROS_DOT: Fields =
    &[(names::X, Number::F32), (names::Y, Number::F32), (names::Z, Number::F32), ("rgb", Number::U32)];

/// Strides are multiples of this, and each list of fields begins at one, so that every field is aligned.
pub(super) const ALIGNMENT: usize = 8;

/// What a cloud's points are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Points {
    Echoes,
    /// Echoes of the consensus.
    Consensus,
    Crossings,
    /// Place and colour alone.
    Dots,
}

/// Where each field of a point is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct PointLayout {
    kind: SchemaKind,
    points: Points,
    fields: Vec<(&'static str, usize, Number)>,
    stride: usize,
}

impl PointLayout {
    fn new(kind: SchemaKind, points: Points) -> Self {
        let place = match (points, kind) {
            (Points::Dots, SchemaKind::Foxglove) => FOXGLOVE_DOT,
            (Points::Dots, SchemaKind::Ros2) => ROS_DOT,
            (_, SchemaKind::Foxglove) => FOXGLOVE_PLACE,
            (_, SchemaKind::Ros2) => ROS_PLACE,
        };
        let rest: &[Fields] = match points {
            Points::Dots => &[],
            Points::Echoes => &[ECHO],
            Points::Consensus => &[ECHO, CONSENSUS],
            Points::Crossings => &[CROSSING],
        };
        let (mut fields, mut end) = (Vec::new(), 0_usize);
        for list in std::iter::once(place).chain(rest.iter().copied()) {
            end = end.next_multiple_of(ALIGNMENT);
            for &(name, number) in list {
                fields.push((name, end, number));
                end += number.size();
            }
        }
        Self { kind, points, fields, stride: end.next_multiple_of(ALIGNMENT) }
    }

    /// Bytes from one point to the next.
    pub(super) const fn stride(&self) -> usize {
        self.stride
    }

    /// Name, offset and type of each field.
    pub(super) fn fields(&self) -> &[(&'static str, usize, Number)] {
        &self.fields
    }

    /// Appends a point at `x`, `y`; `rest` appends the fields after place and colour, in their order.
    pub(super) fn push(&self, bytes: &mut Vec<u8>, x: f64, y: f64, color: Color, rest: impl FnOnce(&mut Vec<u8>)) {
        let start = bytes.len();
        let rgba = [color.red, color.green, color.blue, color.alpha];
        let rgb = u32::from_be_bytes([0, color.red, color.green, color.blue]).to_le_bytes();
        match (self.points, self.kind) {
            (Points::Dots, kind) => {
                put_single(bytes, x, y);
                bytes.extend_from_slice(if kind == SchemaKind::Ros2 { &rgb } else { &rgba });
            }
            (_, SchemaKind::Foxglove) => {
                for part in [x, y, 0.0] {
                    bytes.extend_from_slice(&part.to_le_bytes());
                }
                bytes.extend_from_slice(&rgba);
                bytes.extend_from_slice(&[0; 4]);
            }
            (_, SchemaKind::Ros2) => {
                put_single(bytes, x, y);
                bytes.extend_from_slice(&rgb);
                for part in [x, y] {
                    bytes.extend_from_slice(&part.to_le_bytes());
                }
            }
        }
        rest(bytes);
        bytes.resize(start + self.stride, 0);
    }
}

/// The layouts of one kind of messages.
#[derive(Debug)]
pub(super) struct Layouts {
    echoes: PointLayout,
    consensus: PointLayout,
    crossings: PointLayout,
    dots: PointLayout,
}

impl Layouts {
    pub(super) fn new(kind: SchemaKind) -> Self {
        let layout = |points| PointLayout::new(kind, points);
        Self {
            echoes: layout(Points::Echoes),
            consensus: layout(Points::Consensus),
            crossings: layout(Points::Crossings),
            dots: layout(Points::Dots),
        }
    }

    pub(super) const fn of(&self, points: Points) -> &PointLayout {
        match points {
            Points::Echoes => &self.echoes,
            Points::Consensus => &self.consensus,
            Points::Crossings => &self.crossings,
            Points::Dots => &self.dots,
        }
    }
}

/// The place in single precision.
fn put_single(bytes: &mut Vec<u8>, x: f64, y: f64) {
    for part in [x as f32, y as f32, 0.0] {
        bytes.extend_from_slice(&part.to_le_bytes());
    }
}

//! What is read of a message, whatever it is encoded in.

/// The messages that are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in super::super) enum Kind {
    /// A reading: `sensor_msgs/Range`, and whatever has its fields.
    Range,
    /// Readings: any type with a list of `sensor_msgs/Range`.
    Ranges,
    /// Readings of beams that fan out from one place: `sensor_msgs/LaserScan`, where somebody says that they are cones.
    Scan,
    /// Transforms between frames: `tf2_msgs/TFMessage`, `foxglove.FrameTransforms`.
    Transforms,
    /// One of them: `geometry_msgs/TransformStamped`, `foxglove.FrameTransform`.
    Transform,
    /// Where the robot is: `nav_msgs/Odometry`.
    Odometry,
    /// Where something is: `geometry_msgs/PoseStamped`, `foxglove.PoseInFrame`.
    Pose,
}

/// Where a field's value goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Slot {
    Seconds,
    Nanoseconds,
    /// Both of them, as ROS 1 has it in one.
    Stamp,
    Frame,
    Child,
    Number(u8),
    /// The values of a list.
    Values,
}

/// Values of a list, at most: a scan of more is a lidar's, whose beams are no cones.
pub(super) const MOST_VALUES: usize = 64;

/// What a message says, reused from message to message.
#[derive(Debug, Clone, Default, PartialEq)]
pub(in super::super) struct Said {
    seconds: i64,
    nanoseconds: i64,
    /// The frame it is about or in; that of the parent in a transform.
    pub(in super::super) frame: String,
    /// The child's frame.
    pub(in super::super) child: String,
    numbers: [f64; 7],
    values: Vec<f64>,
    /// A bit for each slot that was filled.
    seen: u16,
}

/// A reading's numbers, as they stand there: radians and metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in super::super) struct Measured {
    pub(in super::super) field_of_view: f64,
    pub(in super::super) min: f64,
    pub(in super::super) max: f64,
    pub(in super::super) range: f64,
}

/// A scan's beams, as they stand there: radians and metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in super::super) struct Scan<'a> {
    /// The direction of the first beam, and from one to the next.
    first: f64,
    step: f64,
    min: f64,
    max: f64,
    ranges: &'a [f64],
}

/// Several equal ranges within this angle are one cone's, which a driver has spread over rays: 60°, in radians.
const WIDEST_CONE: f64 = std::f64::consts::FRAC_PI_3;

impl<'a> Scan<'a> {
    /// Each beam: its number where there are several, its direction in radians, and what it measured. Equal ranges of rays that are
    /// close together are one beam.
    pub(in super::super) fn beams(self) -> impl Iterator<Item = (Option<usize>, f64, Measured)> + 'a {
        let Self { first, step, min, max, ranges } = self;
        let one = move |range: f64, width: f64| Measured { field_of_view: width.abs(), min, max, range };
        let width = ranges.len().saturating_sub(1) as f64 * step;
        let same = ranges.windows(2).all(|pair| matches!(pair, [a, b] if a.total_cmp(b).is_eq()));
        let cone = ranges.first().filter(|_| same && width.abs() <= WIDEST_CONE);
        let cone = cone.map(|range| (None, first + width / 2.0, one(*range, if width == 0.0 { step } else { width })));
        let rays = if cone.is_some() { &[] } else { ranges };
        let ray = move |(index, range): (usize, &f64)| (Some(index), first + index as f64 * step, one(*range, step));
        cone.into_iter().chain(rays.iter().enumerate().map(ray))
    }
}

impl Slot {
    const fn bits(self) -> u16 {
        match self {
            Self::Seconds => 1,
            Self::Nanoseconds => 2,
            Self::Stamp => 1 | 2,
            Self::Frame => 4,
            Self::Child => 8,
            Self::Number(index) => 16 << index,
            Self::Values => 1 << 15,
        }
    }
}

impl Said {
    /// Forgets everything but the room it takes.
    pub(super) fn clear(&mut self) {
        self.frame.clear();
        self.child.clear();
        (self.seconds, self.nanoseconds, self.seen) = (0, 0, 0);
        self.numbers = [0.0; 7];
        self.values.clear();
    }

    /// The values of a list; only the first so many are kept.
    pub(super) fn set_values(&mut self, values: impl Iterator<Item = f64>) {
        self.values.clear();
        self.values.extend(values.take(MOST_VALUES));
        self.seen |= Slot::Values.bits();
    }

    pub(super) fn set_number(&mut self, slot: Slot, value: f64) {
        if let Slot::Number(index) = slot
            && let Some(number) = self.numbers.get_mut(usize::from(index))
        {
            *number = value;
            self.seen |= slot.bits();
        }
    }

    pub(super) fn set_whole(&mut self, slot: Slot, value: i64) {
        match slot {
            Slot::Seconds => self.seconds = value,
            Slot::Nanoseconds => self.nanoseconds = value,
            Slot::Number(_) => return self.set_number(slot, value as f64),
            _ => return,
        }
        self.seen |= slot.bits();
    }

    pub(super) fn set_text(&mut self, slot: Slot, value: &str) {
        let text = match slot {
            Slot::Frame => &mut self.frame,
            Slot::Child => &mut self.child,
            _ => return,
        };
        text.clear();
        text.push_str(value);
        self.seen |= slot.bits();
    }

    /// The first field of the kind that was not filled.
    pub(super) fn missing(&self, kind: Kind) -> Option<&'static str> {
        kind.missing(self.seen)
    }

    /// The stamp in nanoseconds; `None` where it is out of reach.
    pub(in super::super) fn stamp(&self) -> Option<i64> {
        self.seconds.checked_mul(1_000_000_000)?.checked_add(self.nanoseconds)
    }

    pub(in super::super) fn measured(&self) -> Measured {
        let [field_of_view, min, max, range, ..] = self.numbers;
        Measured { field_of_view, min, max, range }
    }

    /// A scan's beams.
    pub(in super::super) fn scan(&self) -> Scan<'_> {
        let [first, step, min, max, ..] = self.numbers;
        Scan { first, step, min, max, ranges: &self.values }
    }

    /// Position in metres, and quaternion x, y, z, w.
    pub(in super::super) fn placement(&self) -> ([f64; 3], [f64; 4]) {
        let [x, y, z, qx, qy, qz, qw] = self.numbers;
        ([x, y, z], [qx, qy, qz, qw])
    }
}

/// The names of the fields whose values are read, by what their path ends in.
const PLACEMENT: [&str; 7] =
    ["position.x", "position.y", "position.z", "orientation.x", "orientation.y", "orientation.z", "orientation.w"];
const TRANSFORM: [&str; 7] =
    ["translation.x", "translation.y", "translation.z", "rotation.x", "rotation.y", "rotation.z", "rotation.w"];
const RANGE: [&str; 4] = ["field_of_view", "min_range", "max_range", "range"];
const SCAN: [&str; 4] = ["angle_min", "angle_increment", "range_min", "range_max"];

impl Kind {
    /// Whether it is of readings, and not of where things are.
    pub(in super::super) const fn is_reading(self) -> bool {
        matches!(self, Self::Range | Self::Ranges | Self::Scan)
    }

    /// The list whose elements are read one by one, and what they are, where there is one.
    pub(super) const fn list(self) -> Option<(&'static str, Self)> {
        match self {
            Self::Transforms => Some(("transforms", Self::Transform)),
            Self::Ranges => Some(("ranges", Self::Range)),
            _ => None,
        }
    }

    const fn numbers(self) -> &'static [&'static str] {
        match self {
            Self::Range | Self::Ranges => &RANGE,
            Self::Scan => &SCAN,
            Self::Transforms | Self::Transform => &TRANSFORM,
            Self::Odometry | Self::Pose => &PLACEMENT,
        }
    }

    /// What the numbers' paths begin with, in one encoding or the other.
    const fn prefixes(self) -> &'static [&'static str] {
        match self {
            Self::Range | Self::Ranges | Self::Scan => &[""],
            Self::Transforms | Self::Transform => &["transform.", ""],
            Self::Odometry => &["pose.pose."],
            Self::Pose => &["pose."],
        }
    }

    /// Where the value of the field at `path` goes, with dots between the names. None where there is a list: its elements have
    /// them.
    pub(super) fn slot(self, path: &str) -> Option<Slot> {
        match path {
            _ if self.list().is_some() => return None,
            "header.frame_id" | "frame_id" | "parent_frame_id" => return Some(Slot::Frame),
            "child_frame_id" => return (!self.is_reading() && self != Self::Pose).then_some(Slot::Child),
            "ranges" if self == Self::Scan => return Some(Slot::Values),
            "header.stamp" | "timestamp" | "stamp" => return Some(Slot::Stamp),
            _ => {}
        }
        if let Some(part) = ["header.stamp.", "timestamp.", "stamp."].iter().find_map(|stamp| path.strip_prefix(stamp))
        {
            return match part {
                "sec" | "secs" | "seconds" => Some(Slot::Seconds),
                "nanosec" | "nsec" | "nsecs" | "nanos" => Some(Slot::Nanoseconds),
                _ => None,
            };
        }
        self.prefixes().iter().find_map(|prefix| {
            let index = self.numbers().iter().position(|name| Some(*name) == path.strip_prefix(prefix))?;
            u8::try_from(index).ok().map(Slot::Number)
        })
    }

    /// The first field that is not among those `seen`.
    pub(super) fn missing(self, seen: u16) -> Option<&'static str> {
        let child = matches!(self, Self::Transforms | Self::Transform | Self::Odometry);
        let texts = [(Slot::Seconds, "stamp"), (Slot::Nanoseconds, "stamp"), (Slot::Frame, "frame_id")];
        let texts = texts.into_iter().chain(child.then_some((Slot::Child, "child_frame_id")));
        let numbers = (0u8..).zip(self.numbers()).map(|(index, name)| (Slot::Number(index), *name));
        let values = (self == Self::Scan).then_some((Slot::Values, "ranges"));
        texts.chain(numbers).chain(values).find(|(slot, _)| slot.bits() & !seen != 0).map(|(_, name)| name)
    }
}

/// Which fields a schema has.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Found(u16);

impl Found {
    pub(super) fn add(&mut self, slot: Slot) {
        self.0 |= slot.bits();
    }

    /// Insists that all fields of the kind were found.
    pub(super) fn check(self, kind: Kind) -> Result<(), String> {
        match kind.missing(self.0) {
            Some(name) => Err(format!("it has no field `{name}` of the kind that is needed")),
            None => Ok(()),
        }
    }
}

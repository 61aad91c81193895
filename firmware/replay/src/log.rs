//! The recorded log: sweeps of the ring, little-endian, of a fixed size each.

use crate::{SENSORS, event::Event};

/// What a log begins with.
pub const HEADER: [u8; 8] = *b"ATMRING1";

/// Bytes of one sweep: t, x, y, cos, sin, and a range for each sensor, four bytes each.
pub const RECORD: usize = 4 * (5 + SENSORS);

/// All sensors of the ring, fired at one time and pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sweep {
    /// When, in milliseconds.
    pub milliseconds: u32,
    /// The robot's position, in metres.
    pub position: [f32; 2],
    /// The robot's heading, a unit vector.
    pub heading: [f32; 2],
    /// What each sensor said, in metres.
    pub ranges: [f32; SENSORS],
}

impl Sweep {
    /// As it stands in the log.
    pub fn to_bytes(&self) -> [u8; RECORD] {
        let floats = self.position.iter().chain(&self.heading).chain(&self.ranges).map(|float| float.to_bits());
        let mut bytes = [0; RECORD];
        let (words, _) = bytes.as_chunks_mut::<4>();
        for (word, value) in words.iter_mut().zip(core::iter::once(self.milliseconds).chain(floats)) {
            *word = value.to_le_bytes();
        }
        bytes
    }
}

/// A recorded log.
#[derive(Debug, Clone, Copy)]
pub struct Log<'a> {
    records: &'a [[u8; RECORD]],
}

impl<'a> Log<'a> {
    /// The log in `bytes`; `None` where the header or the length is wrong.
    pub fn new(bytes: &'a [u8]) -> Option<Self> {
        let (records, rest) = bytes.strip_prefix(&HEADER)?.as_chunks::<RECORD>();
        rest.is_empty().then_some(Self { records })
    }

    /// How many sweeps it has.
    pub const fn sweeps(&self) -> usize {
        self.records.len()
    }

    /// Reading number `index`, counted sweep by sweep, sensor by sensor; `None` past the end.
    pub fn event(&self, index: u32) -> Option<Event<f32>> {
        let (sweep, sensor) = (index as usize / SENSORS, index as usize % SENSORS);
        let (words, _) = self.records.get(sweep)?.as_chunks::<4>();
        let word = |place: usize| words.get(place).copied().map_or(0, u32::from_le_bytes);
        let float = |place: usize| f32::from_bits(word(place));
        Some(Event {
            t: i64::from(word(0)) * 1_000_000,
            sensor: sensor as u16,
            range: float(5 + sensor),
            position: [float(1), float(2)],
            heading: [float(3), float(4)],
        })
    }
}

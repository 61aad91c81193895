//! The recorded log as a broken robot would hand it over.

use crate::{SENSORS, dice::Dice, event::Event, log::Log};

/// What is wrong with a reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// Nothing.
    None,
    /// The sensor says the same whatever there is.
    Stuck,
    /// A range that is no number.
    NanRange,
    /// A range of +∞.
    InfiniteRange,
    /// A range of −∞.
    MinusInfiniteRange,
    /// A range below 0.
    NegativeRange,
    /// A range whose square overflows.
    HugeRange,
    /// A range whose square is 0.
    TinyRange,
    /// A reading older than the one before it.
    OutOfOrder,
    /// A position that is no number.
    NanPosition,
    /// A position that is finite and whose square overflows.
    FarPosition,
    /// A heading that is not of unit length.
    LongHeading,
    /// A sensor that the ring has not.
    UnknownSensor,
}

impl Fault {
    /// Every fault, in order of its number.
    pub const ALL: [Self; 13] = [
        Self::None,
        Self::Stuck,
        Self::NanRange,
        Self::InfiniteRange,
        Self::MinusInfiniteRange,
        Self::NegativeRange,
        Self::HugeRange,
        Self::TinyRange,
        Self::OutOfOrder,
        Self::NanPosition,
        Self::FarPosition,
        Self::LongHeading,
        Self::UnknownSensor,
    ];

    fn inflict(self, event: &mut Event<f32>) {
        match self {
            Self::None => {}
            Self::Stuck => event.range = 1.0,
            Self::NanRange => event.range = f32::NAN,
            Self::InfiniteRange => event.range = f32::INFINITY,
            Self::MinusInfiniteRange => event.range = f32::NEG_INFINITY,
            Self::NegativeRange => event.range = -event.range,
            Self::HugeRange => event.range = f32::MAX,
            Self::TinyRange => event.range = 1e-30,
            Self::OutOfOrder => event.t -= 10_000_000_000,
            Self::NanPosition => event.position[0] = f32::NAN,
            Self::FarPosition => event.position[1] = f32::MAX / 2.0,
            Self::LongHeading => event.heading = event.heading.map(|part| part * 2.0),
            Self::UnknownSensor => event.sensor += SENSORS as u16,
        }
    }
}

/// The sensor that is stuck.
const STUCK: u16 = 3;

/// Inflicts faults on readings: one sensor is stuck all the time, and half of what the others say is wrong.
#[derive(Debug, Clone, Copy)]
pub struct Faults {
    dice: Dice,
}

impl Faults {
    /// The faults of the test.
    pub const fn new() -> Self {
        Self { dice: Dice(2) }
    }

    /// Reading number `index` of the log, which must count up from 0, spoilt or not; `None` past the end.
    pub fn event(&mut self, log: &Log<'_>, index: u32) -> Option<Event<f32>> {
        let mut event = log.event(index)?;
        self.draw(event.sensor).inflict(&mut event);
        Some(event)
    }

    /// What is wrong with the next reading, which is of `sensor`.
    pub fn draw(&mut self, sensor: u16) -> Fault {
        let drawn = Fault::ALL.get(usize::from(self.dice.bits() >> 8) % 24).copied().unwrap_or(Fault::None);
        if sensor == STUCK { Fault::Stuck } else { drawn }
    }
}

impl Default for Faults {
    fn default() -> Self {
        Self::new()
    }
}

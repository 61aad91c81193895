//! What the consensus says of one reading.

use nalgebra::{Point2, Vector2};

use crate::{arc::Bearing, scalar::Scalar};

/// What stands where an echo came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Reflector {
    /// A point that answers from every side: a jamb, a corner, a bump, a pole.
    Point,
    /// A wall that answers along its perpendicular.
    Wall,
    /// Not resolved: the arc's centre.
    Center,
}

impl Reflector {
    /// Every kind, in the order in which they are listed.
    pub const ALL: [Self; 3] = [Self::Point, Self::Wall, Self::Center];

    /// The word for it in tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Point => "point",
            Self::Wall => "wall",
            Self::Center => "center",
        }
    }
}

/// One point, where the readings of the local map agree that a reading's echo came from, with its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct ConsensusEcho<T: Scalar> {
    /// The reading's own time, in nanoseconds.
    pub t: i64,
    /// The sensor's index.
    pub sensor: u16,
    /// What stands there.
    pub kind: Reflector,
    /// The echo in the fixed frame, in metres. Its distance from the sensor is fitted, too, and differs from the reading
    /// by a part of the range resolution.
    pub position: Point2<T>,
    /// The reading, in metres.
    pub range: T,
    /// Where on the arc: direction from the boresight.
    pub bearing: Bearing<T>,
    /// Readings that agree with it, its own not counted; of the best hypothesis where none is resolved.
    pub support: u32,
    /// Readings that look there and report clearly farther, or nothing.
    pub against: u32,
    /// The share of all that the readings allow that lies at this azimuth, in \[0, 1\].
    pub confidence: T,
    /// Standard deviation of the azimuth, in radians; φ/√12 where it is not resolved.
    pub sigma_azimuth: T,
    /// Standard deviation of the distance from the sensor, in metres; δ/√12 where it is not resolved.
    pub sigma_range: T,
    /// The wall's normal, a unit vector towards the sensor's side; `None` but for walls.
    pub normal: Option<Vector2<T>>,
    /// Length along the arc in which the echo lies with 95 %: 2 · 1.96 σ r, or the whole arc where it is not resolved. In
    /// metres.
    pub resolution: T,
}

impl<T: Scalar> ConsensusEcho<T> {
    /// Azimuth of the echo from the boresight, in radians, within ± half the beam.
    pub fn azimuth(&self) -> T {
        self.bearing.azimuth()
    }

    /// What is missing of full confidence, in the place that the median's [`significance`](crate::Echo::significance) has
    /// in tables: how likely it is that the readings agree there by accident. 1 where nothing is resolved.
    pub fn significance(&self) -> T {
        if self.kind == Reflector::Center { T::ONE } else { T::ONE - self.confidence }
    }
}

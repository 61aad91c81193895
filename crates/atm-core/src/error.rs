//! What the core refuses.

use core::fmt;

/// A parameter outside its domain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum DomainError {
    /// The minimum crossing angle must lie in \[1°, 90°\].
    MinAngle,
    /// The field of view must lie in (0°, 180°].
    FieldOfView,
    /// The range resolution must be positive and finite.
    RangeResolution,
    /// The range limits must be 0 ≤ min < max; max may be infinite.
    Limits,
    /// A distance must be positive and finite.
    Distance,
    /// The improvement must lie in (0, dφ/δ].
    Improvement,
    /// The travel bound must lie in (0, 1000 m].
    MaxTravel,
    /// The smallest step must be positive and finite.
    MinStep,
    /// A speed must be positive and finite.
    Speed,
    /// A rate must be positive and finite.
    Rate,
    /// A least confidence must lie in \[0, 1).
    Confidence,
    /// A range's error must be finite and not negative.
    RangeError,
}

impl fmt::Display for DomainError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::MinAngle => "the minimum crossing angle must lie in [1 deg, 90 deg]",
            Self::FieldOfView => "the field of view must lie in (0 deg, 180 deg]",
            Self::RangeResolution => "the range resolution must be positive and finite",
            Self::Limits => "the range limits must be 0 <= min < max",
            Self::Distance => "the distance must be positive and finite",
            Self::Improvement => {
                "the improvement must be positive, and at most field of view x distance / range resolution"
            }
            Self::MaxTravel => "the largest travel must lie in (0 m, 1000 m]",
            Self::MinStep => "the smallest step must be positive and finite",
            Self::Speed => "the speed must be positive and finite",
            Self::Rate => "the rate must be positive and finite",
            Self::Confidence => "the least confidence must lie in [0, 1)",
            Self::RangeError => "the error of a range must be finite and not negative",
        })
    }
}

impl core::error::Error for DomainError {}

/// Why a reading did not arrive: it took no slot and changed nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Rejected {
    /// The sensor's index is not below the storage's number of sensors.
    UnknownSensor,
    /// The sensor's pose or the robot's position is not finite, or the heading is no unit vector.
    Pose,
    /// Earlier than the latest reading that arrived.
    TimeBackwards,
}

impl fmt::Display for Rejected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::UnknownSensor => "the sensor's index is out of range",
            Self::Pose => "the pose is not finite, or its heading is no unit vector",
            Self::TimeBackwards => "the reading is earlier than the one before it",
        })
    }
}

impl core::error::Error for Rejected {}

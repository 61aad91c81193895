//! What a sensor is, and what its reading can mean.

use crate::{error::DomainError, scalar::Scalar};

/// A beam by its field of view: the FULL angle φ of the cone, as in ROS `sensor_msgs/Range`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beam<T> {
    field_of_view: T,
    /// tan(φ/4): half the half beam. All that the pair test needs, without a sine.
    quarter_tangent: T,
}

impl<T: Scalar> Beam<T> {
    /// A beam of full angle `field_of_view`, in radians, in (0, π].
    pub fn new(field_of_view: T) -> Result<Self, DomainError> {
        if !(field_of_view > T::ZERO && field_of_view <= T::PI) {
            return Err(DomainError::FieldOfView);
        }
        Ok(Self { field_of_view, quarter_tangent: (field_of_view / T::FOUR).tangent() })
    }

    /// The full beam φ, in radians.
    pub const fn field_of_view(&self) -> T {
        self.field_of_view
    }

    pub(crate) const fn quarter_tangent(&self) -> T {
        self.quarter_tangent
    }
}

/// The quantisation step δ of a sensor's ranges, in metres. May grow with range: it is given with each reading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RangeResolution<T>(T);

impl<T: Scalar> RangeResolution<T> {
    /// One metre: a value to fill memory with.
    pub(crate) const STEP: Self = Self(T::ONE);

    /// A step in metres, positive and finite.
    pub fn new(metres: T) -> Result<Self, DomainError> {
        if !(metres > T::ZERO && metres.finite()) {
            return Err(DomainError::RangeResolution);
        }
        Ok(Self(metres))
    }

    /// The step, in metres.
    pub const fn metres(&self) -> T {
        self.0
    }
}

/// The distances between which a reading is an echo: min ≤ r < max.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits<T> {
    min: T,
    max: T,
}

impl<T: Scalar> Limits<T> {
    /// 0 to +∞: where neither rig nor log says more.
    pub const NONE: Self = Self { min: T::ZERO, max: T::INFINITY };

    /// Limits in metres, 0 ≤ min < max, max possibly +∞.
    pub fn new(min: T, max: T) -> Result<Self, DomainError> {
        if !(min >= T::ZERO && min < max) {
            return Err(DomainError::Limits);
        }
        Ok(Self { min, max })
    }

    /// From which distance on a reading is an echo, in metres.
    pub const fn min(&self) -> T {
        self.min
    }

    /// Below which distance a reading is an echo, in metres; possibly +∞.
    pub const fn max(&self) -> T {
        self.max
    }

    /// What a raw reading in metres means. ±∞ as in REP 117; a reading at its maximum is none.
    pub fn classify(&self, range: T) -> Range<T> {
        if range >= self.max {
            Range::beyond(self.max)
        } else if range > T::ZERO && range >= self.min {
            Range { meaning: Meaning::Echo, metres: range }
        } else if range == -T::INFINITY || (range >= T::ZERO && range <= self.min) {
            Range::TOO_CLOSE
        } else {
            Range::INVALID
        }
    }
}

/// What a reading can be. All four take a slot in the local map; only echoes make arcs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Meaning {
    /// Something at this distance.
    Echo,
    /// At or beyond the maximum: nothing there.
    Beyond,
    /// Below the minimum: something, nearer than the sensor can measure.
    TooClose,
    /// Not a number, or negative.
    Invalid,
}

/// A reading with its meaning; made by [`Limits::classify`], so that an echo's distance is positive and finite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range<T> {
    meaning: Meaning,
    metres: T,
}

impl<T: Scalar> Range<T> {
    /// Nothing, however far.
    pub const BEYOND: Self = Self::beyond(T::INFINITY);
    /// Something nearer than the sensor can measure.
    pub const TOO_CLOSE: Self = Self { meaning: Meaning::TooClose, metres: T::NAN };
    /// No reading.
    pub const INVALID: Self = Self { meaning: Meaning::Invalid, metres: T::NAN };

    /// Nothing up to `limit`, the sensor's own maximum range in metres, possibly +∞: what lies beyond is not denied.
    pub const fn beyond(limit: T) -> Self {
        Self { meaning: Meaning::Beyond, metres: limit }
    }

    /// What it is.
    pub const fn meaning(&self) -> Meaning {
        self.meaning
    }

    /// The distance in metres where it is an echo.
    pub fn echo(&self) -> Option<T> {
        match self.meaning {
            Meaning::Echo => Some(self.metres),
            _ => None,
        }
    }

    /// Up to where nothing is, in metres, where it is [`Meaning::Beyond`]; possibly +∞.
    pub fn limit(&self) -> Option<T> {
        match self.meaning {
            Meaning::Beyond => Some(self.metres),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn meaning(range: f64) -> Meaning {
        Limits::new(0.2, 5.0).unwrap().classify(range).meaning()
    }

    #[test]
    fn minimum_is_an_echo_and_maximum_is_none() {
        assert_eq!(meaning(0.2), Meaning::Echo);
        assert_eq!(meaning(4.999), Meaning::Echo);
        assert_eq!(meaning(5.0), Meaning::Beyond);
        assert_eq!(meaning(f64::INFINITY), Meaning::Beyond);
    }

    #[test]
    fn below_the_minimum_is_too_close_and_never_free_space() {
        assert_eq!(meaning(0.199), Meaning::TooClose);
        assert_eq!(meaning(0.0), Meaning::TooClose);
        assert_eq!(meaning(f64::NEG_INFINITY), Meaning::TooClose);
    }

    #[test]
    fn nan_and_negative_are_invalid() {
        assert_eq!(meaning(f64::NAN), Meaning::Invalid);
        assert_eq!(meaning(-0.3), Meaning::Invalid);
    }

    #[test]
    fn without_limits_zero_is_no_echo_and_infinity_is_beyond() {
        assert_eq!(Limits::<f64>::NONE.classify(0.0).meaning(), Meaning::TooClose);
        assert_eq!(Limits::<f64>::NONE.classify(f64::INFINITY).meaning(), Meaning::Beyond);
        assert_eq!(Limits::<f64>::NONE.classify(1e-300).echo(), Some(1e-300));
    }

    #[test]
    fn field_of_view_is_above_zero_and_at_most_half_a_turn() {
        assert!(Beam::new(0.0).is_err());
        assert!(Beam::new(f64::NAN).is_err());
        assert!(Beam::new(core::f64::consts::PI).is_ok());
        assert!(Beam::new(core::f64::consts::PI * (1.0 + 1e-9)).is_err());
    }
}

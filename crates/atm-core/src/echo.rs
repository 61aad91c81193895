//! The echo: what the fusion says of one reading.

use nalgebra::Point2;

use crate::{arc::Bearing, scalar::Scalar, significance};

/// How an echo was found (Sec. III-B).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Kind {
    /// The median of three or more transversal crossings.
    Median,
    /// The only transversal crossing.
    Single,
    /// No crossing: the arc's centre.
    Center,
    /// The arc is no longer than the interval that crossings resolve: its centre (Sec. IV-B).
    Near,
    /// Exactly two crossings, where the options ask for an echo from them.
    Pair,
}

impl Kind {
    /// Every kind, in the order in which they are listed.
    pub const ALL: [Self; 5] = [Self::Median, Self::Single, Self::Center, Self::Near, Self::Pair];

    /// The word for it in tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Median => "median",
            Self::Single => "single",
            Self::Center => "center",
            Self::Near => "near",
            Self::Pair => "pair",
        }
    }
}

/// One point on one arc, with how it was found.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Echo<T: Scalar> {
    /// The reading's own time, in nanoseconds.
    pub t: i64,
    /// The sensor's index.
    pub sensor: u16,
    /// How it was found.
    pub kind: Kind,
    /// The echo in the fixed frame, in metres.
    pub position: Point2<T>,
    /// The reading, in metres.
    pub range: T,
    /// Where on the arc: direction from the boresight.
    pub bearing: Bearing<T>,
    /// Transversal crossings on this arc, whatever the kind.
    pub crossings: u32,
    /// Those within ± half the interval of the echo along the arc, inclusive: n of equation (1).
    pub within: u32,
    /// Length along the arc in which the echo lies, in metres: L for median and single, the whole arc for center, near
    /// and a pair by its centre, L and their spacing for a pair by its mean.
    pub resolution: T,
    /// L, the interval that crossings at θmin resolve, in metres (Sec. IV-B).
    pub interval: T,
    /// φ r, the length of the whole arc, in metres.
    pub arc_length: T,
}

impl<T: Scalar> Echo<T> {
    /// Azimuth of the echo from the boresight, in radians, within ± half the beam (Sec. III-B).
    pub fn azimuth(&self) -> T {
        self.bearing.azimuth()
    }

    /// Equation (1): the chance that the crossings around the echo fell there by accident; 1 for center and near.
    ///
    /// It ignores that the place was chosen after looking: see [`Echo::scan_significance`].
    pub fn significance(&self) -> T {
        self.log_significance().exponential()
    }

    /// Natural logarithm of [`Echo::significance`], which does not underflow.
    pub fn log_significance(&self) -> T {
        match self.kind {
            Kind::Center | Kind::Near => T::ZERO,
            _ => significance::log_chance(self.within, self.interval, self.arc_length),
        }
    }

    /// The chance that some place on the arc gathers that many crossings by accident, the place chosen after looking
    /// (Wallenstein and Neff, see [`significance::scan_chance`]); 1 for center and near.
    pub fn scan_significance(&self) -> T {
        match self.kind {
            Kind::Center | Kind::Near => T::ONE,
            _ => significance::scan_chance(self.within, self.crossings, self.interval, self.arc_length),
        }
    }
}

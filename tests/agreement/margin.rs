//! How near a threshold is too near to compare, and how closely the rest has to agree.

/// What is left out of the comparison, and the bounds on the rest. The reference's own rounding is far below the first set.
#[derive(Debug, Clone, Copy)]
pub struct Margins {
    /// An arc is left out if one of its crossings lies this close (radians) to θmin or to the edge of a beam; its
    /// significance, if one lies this close to the end of the interval around the echo.
    pub angle: f64,
    /// An arc is left out if one of its crossings lies this close (radians) to 90° off its boresight, where the sine is
    /// flat: a last place of it is the square root of one in angle. Of two shallow arcs it is off by some more.
    pub flat: f64,
    /// An arc is left out if its length is this close to the interval, as a share of it.
    pub length: f64,
    /// A log is left out if a path comes this close (metres) to `max_travel`: it is counted in whole micrometres.
    pub path: f64,
    /// A log is left out if a step comes this close (metres) to `min_step`.
    pub step: f64,
    /// Echoes and crossings agree to this, in metres; azimuths to this, in metres along the arc.
    pub position: f64,
    /// Crossing angles agree to this, in radians.
    pub crossing_angle: f64,
    /// Lengths and logarithms of chances agree to this, as a share.
    pub share: f64,
}

impl Margins {
    pub const DOUBLE: Self = Self {
        angle: 1e-9,
        flat: 1e-4,
        length: 1e-9,
        path: 3e-6,
        step: 1e-9,
        position: 1e-9,
        crossing_angle: 1e-9,
        share: 1e-9,
    };

    /// For θmin from 5° and coordinates up to 8 m, where neighbouring numbers are half a micrometre apart.
    pub const SINGLE: Self = Self {
        angle: 1e-4,
        flat: 2e-2,
        length: 1e-5,
        path: 3e-6,
        step: 1e-6,
        position: 1e-3,
        crossing_angle: 1e-3,
        share: 1e-4,
    };
}

//! The ring of sensors: where each sits and looks, and what all of them share.

use atm_core::{Beam, DomainError, Isometry2, Limits, Point2, RangeResolution, Reading, Scalar, UnitComplex, Vector2};

use crate::{SENSORS, event::Event};

/// Sixteen equal sensors on a circle, each looking outwards, counter-clockwise from straight ahead.
#[derive(Debug, Clone, Copy)]
pub struct Ring<T: Scalar> {
    directions: &'static [[T; 2]; SENSORS],
    radius: T,
    beam: Beam<T>,
    limits: Limits<T>,
    range_resolution: RangeResolution<T>,
}

/// cos 22.5° = √(2 + √2) / 2.
const COS_22_5: f64 = 0.923_879_532_511_286_7;
/// sin 22.5° = √(2 − √2) / 2.
const SIN_22_5: f64 = 0.382_683_432_365_089_8;
/// cos 45°.
const COS_45: f64 = core::f64::consts::FRAC_1_SQRT_2;

/// (cos, sin) of k · 22.5°.
const DIRECTIONS: [[f64; 2]; SENSORS] = [
    [1.0, 0.0],
    [COS_22_5, SIN_22_5],
    [COS_45, COS_45],
    [SIN_22_5, COS_22_5],
    [0.0, 1.0],
    [-SIN_22_5, COS_22_5],
    [-COS_45, COS_45],
    [-COS_22_5, SIN_22_5],
    [-1.0, 0.0],
    [-COS_22_5, -SIN_22_5],
    [-COS_45, -COS_45],
    [-SIN_22_5, -COS_22_5],
    [0.0, -1.0],
    [SIN_22_5, -COS_22_5],
    [COS_45, -COS_45],
    [COS_22_5, -SIN_22_5],
];

/// The same, rounded by the compiler.
const DIRECTIONS_F32: [[f32; 2]; SENSORS] = {
    let mut rounded = [[0.0; 2]; SENSORS];
    let mut k = 0;
    while k < SENSORS {
        rounded[k] = [DIRECTIONS[k][0] as f32, DIRECTIONS[k][1] as f32];
        k += 1;
    }
    rounded
};

/// An inch, in metres.
const INCH: f64 = 0.0254;

impl Ring<f32> {
    /// The Nomad 200's sonars: 9 in from the centre, 22.5° beams, whole inches from 6 to 255.
    pub fn nomad200() -> Result<Self, DomainError> {
        const FIELD_OF_VIEW: f32 = core::f32::consts::PI / 8.0;
        Ok(Self {
            directions: &DIRECTIONS_F32,
            radius: 9.0 * INCH as f32,
            beam: Beam::new(FIELD_OF_VIEW)?,
            limits: Limits::new(6.0 * INCH as f32, 255.0 * INCH as f32)?,
            range_resolution: RangeResolution::new(INCH as f32)?,
        })
    }

    /// The same ring with beams of half a turn and any reading taken at its word: nothing is turned away early.
    pub fn boundless() -> Result<Self, DomainError> {
        Ok(Self { beam: Beam::new(core::f32::consts::PI)?, limits: Limits::NONE, ..Self::nomad200()? })
    }
}

impl Ring<f32> {
    /// An event whose `sensor` is `at` a place and looks along the unit vector `look`, wherever the mount has it.
    pub fn aimed(&self, t: i64, sensor: u16, at: [f32; 2], look: [f32; 2], range: f32) -> Event<f32> {
        let [ahead, aside] = self.direction(sensor);
        let heading = [look[0] * ahead + look[1] * aside, look[1] * ahead - look[0] * aside];
        let position = [at[0] - look[0] * self.radius, at[1] - look[1] * self.radius];
        Event { t, sensor, range, position, heading }
    }
}

impl Ring<f64> {
    /// The Nomad 200's sonars in double precision.
    pub fn nomad200() -> Result<Self, DomainError> {
        Ok(Self {
            directions: &DIRECTIONS,
            radius: 9.0 * INCH,
            beam: Beam::new(core::f64::consts::PI / 8.0)?,
            limits: Limits::new(6.0 * INCH, 255.0 * INCH)?,
            range_resolution: RangeResolution::new(INCH)?,
        })
    }
}

impl<T: Scalar> Ring<T> {
    /// An event with its sensor's pose: the robot's pose times the mount. No trigonometry.
    #[inline]
    pub fn reading(&self, event: &Event<T>) -> Reading<T> {
        let [cos, sin] = event.heading;
        let [x, y] = event.position;
        let [ahead, aside] = self.direction(event.sensor);
        let look = [cos * ahead - sin * aside, sin * ahead + cos * aside];
        let sensor = Vector2::new(x + look[0] * self.radius, y + look[1] * self.radius);
        Reading {
            t: event.t,
            sensor: event.sensor,
            range: self.limits.classify(event.range),
            pose: Isometry2::from_parts(sensor.into(), UnitComplex::from_cos_sin_unchecked(look[0], look[1])),
            robot: Point2::new(x, y),
            beam: self.beam,
            range_resolution: self.range_resolution,
        }
    }

    /// Which way a sensor looks from the robot. An index that no mount has is the fuser's to refuse.
    fn direction(&self, sensor: u16) -> [T; 2] {
        self.directions.get(usize::from(sensor)).copied().unwrap_or([T::ONE, T::ZERO])
    }
}

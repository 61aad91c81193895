//! One reading with an echo, as the geometry of the methods needs it.

use atm_core::{Point2, Reading, Vector2};

use crate::map::Footprint;

/// Where a sensor was, where it looked, how wide, and how far away its echo was.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight {
    /// Time of the reading, in nanoseconds.
    pub t: i64,
    /// The sensor's index.
    pub sensor: u16,
    /// The sensor's position, in metres.
    pub position: Point2<f64>,
    /// Unit vector of the boresight.
    pub boresight: Vector2<f64>,
    /// The robot's position, in metres.
    pub robot: Point2<f64>,
    /// Half the beam, in radians.
    pub half_beam: f64,
    /// Its cosine.
    pub(super) cos_half: f64,
    /// The reading, in metres.
    pub range: f64,
    /// The range resolution δ, in metres.
    pub resolution: f64,
}

impl Sight {
    /// The reading, where it has an echo.
    pub fn new(reading: &Reading<f64>) -> Option<Self> {
        Some(Self {
            t: reading.t,
            sensor: reading.sensor,
            position: Point2::from(reading.pose.translation.vector),
            boresight: Vector2::new(reading.pose.rotation.re, reading.pose.rotation.im),
            robot: reading.robot,
            half_beam: reading.beam.field_of_view() / 2.0,
            cos_half: libm::cos(reading.beam.field_of_view() / 2.0),
            range: reading.range.echo()?,
            resolution: reading.range_resolution.metres(),
        })
    }

    /// The middle of its arc.
    pub fn middle(&self) -> Point2<f64> {
        self.position + self.boresight * self.range
    }

    /// The angle of a point's direction, counter-clockwise from the boresight, in radians.
    pub fn azimuth(&self, point: Point2<f64>) -> f64 {
        let offset = point - self.position;
        libm::atan2(self.boresight.perp(&offset), self.boresight.dot(&offset))
    }

    /// Whether a point lies within the beam, its edges included.
    pub fn sees(&self, point: Point2<f64>) -> bool {
        let offset = point - self.position;
        self.boresight.dot(&offset) >= self.cos_half * offset.norm()
    }

    /// The direction of the boresight in the fixed frame, in radians.
    pub fn heading(&self) -> f64 {
        libm::atan2(self.boresight.y, self.boresight.x)
    }

    /// The sector that its beam covers.
    pub const fn footprint(&self) -> Footprint {
        Footprint { sensor: self.position, boresight: self.boresight, half_beam: self.half_beam }
    }
}

/// The sector of a reading, whatever it says.
pub fn freed(reading: &Reading<f64>) -> Footprint {
    Footprint {
        sensor: Point2::from(reading.pose.translation.vector),
        boresight: Vector2::new(reading.pose.rotation.re, reading.pose.rotation.im),
        half_beam: reading.beam.field_of_view() / 2.0,
    }
}

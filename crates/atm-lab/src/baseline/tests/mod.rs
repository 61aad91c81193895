//! Each method against numbers worked out by hand from its published rule.

mod arc_maps;
mod depth;
mod grids;
mod points;
mod tangents;

use atm_core::{Beam, Isometry2, Limits, Point2, RangeResolution, Reading, Vector2};

use super::{Findings, Method};

/// Metres in an inch.
const INCH: f64 = 0.0254;

/// A sensor of which the robot is nothing more than the carrier.
#[derive(Clone, Copy)]
struct Sensor {
    index: u16,
    field_of_view_deg: f64,
    resolution: f64,
}

const NARROW: Sensor = Sensor { index: 0, field_of_view_deg: 22.5, resolution: INCH };

impl Sensor {
    const fn with_beam(field_of_view_deg: f64) -> Self {
        Self { field_of_view_deg, ..NARROW }
    }

    /// A reading from (x, y), boresight at `yaw_deg`; an infinite range is beyond the sensor's reach.
    fn reads(&self, t: i64, (x, y): (f64, f64), yaw_deg: f64, range: f64) -> Reading<f64> {
        Reading {
            t,
            sensor: self.index,
            range: Limits::NONE.classify(range),
            pose: Isometry2::new(Vector2::new(x, y), yaw_deg.to_radians()),
            robot: Point2::new(x, y),
            beam: Beam::new(self.field_of_view_deg.to_radians()).unwrap(),
            range_resolution: RangeResolution::new(self.resolution).unwrap(),
        }
    }
}

/// What a method finds in readings, where it applies.
fn run(method: impl Method + 'static, readings: &[Reading<f64>]) -> Option<Findings> {
    let mut method: Box<dyn Method> = Box::new(method);
    for reading in readings {
        method.take(reading).unwrap();
    }
    method.finish().unwrap()
}

fn assert_near(actual: f64, expected: f64, tolerance: f64) {
    assert!((actual - expected).abs() <= tolerance, "{actual} is not {expected}");
}

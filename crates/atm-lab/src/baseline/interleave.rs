//! Rotate and interleave: the centerline with the ring turned by half a beam at every stop, in the hope of twice the resolution
//! (Sec. II-A, Fig. 5, where the paper says that it does not help).

use std::collections::BTreeMap;

use atm::{error::Result, track::Pose};
use atm_core::{Point2, Reading};

use super::{Centerline, Findings, Method, Sight};

/// The poses at which a ring stops in order to interleave: each of `path`, and once more turned by half of `field_of_view`
/// (radians, the full beam) where it stands.
pub fn interleaved(path: &[Pose], field_of_view: f64) -> Vec<Pose> {
    let turned = |pose: &Pose| Pose { yaw: pose.yaw + field_of_view / 2.0, ..*pose };
    path.iter().flat_map(|pose| [*pose, turned(pose)]).collect()
}

/// The centerline on a drive of which the robot turned by half a beam where it stood; it does not apply to any other.
#[derive(Debug, Default)]
pub struct Interleave {
    centerline: Centerline,
    last: BTreeMap<u16, Sight>,
    /// Readings of a sensor that had turned by half a beam where it stood, and echoes in all.
    turned: u64,
    echoes: u64,
}

impl Interleave {
    /// How far a robot that stands may have moved, in metres: what odometry makes of turning in place.
    const STANDING: f64 = 0.02;
    /// How far off half a beam a turn may be, as a share of it.
    const SLACK: f64 = 0.1;

    /// Whether the sensor of `now` had turned by half a beam, either way, where it stood.
    fn has_turned(last: &Sight, now: &Sight) -> bool {
        let stood = Point2::from(now.robot - last.robot).coords.norm() <= Self::STANDING;
        let turn = libm::atan2(last.boresight.perp(&now.boresight), last.boresight.dot(&now.boresight)).abs();
        stood && (turn - now.half_beam).abs() <= Self::SLACK * now.half_beam
    }
}

impl Method for Interleave {
    fn take(&mut self, reading: &Reading<f64>) -> Result<()> {
        if let Some(sight) = Sight::new(reading) {
            self.echoes += 1;
            let last = self.last.insert(sight.sensor, sight);
            self.turned += u64::from(last.is_some_and(|last| Self::has_turned(&last, &sight)));
        }
        self.centerline.take(reading)
    }

    fn clock_reset(&mut self) {
        self.last.clear();
    }

    fn finish(self: Box<Self>) -> Result<Option<Findings>> {
        // Every other reading is of a turned ring; a third leaves room for readings without an echo.
        if self.turned * 3 < self.echoes.max(1) {
            return Ok(None);
        }
        Box::new(self.centerline).finish()
    }
}

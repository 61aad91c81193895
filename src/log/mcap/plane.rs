//! What of a reading is in the plane of the fixed frame.

use atm_core::{Isometry2, Limits, UnitComplex, Vector2};

use super::{reader::Reading, rigid::Rigid, sensors::Sight, whereabouts::Lost};
use crate::{error::Reason, log::View};

/// Sine of 10°: a boresight that points farther out of the plane is no sensor of the plane.
const STEEPEST: f64 = 0.173_648_177_666_930_33;

/// What of a reading is in the plane of the fixed frame: distances are shorter by the cosine of the boresight's elevation.
pub(super) fn on_plane(reading: &Reading, sensor: &Rigid) -> Result<(f64, View), Lost> {
    let [forward, left, up] = sensor.forward();
    // NaN is out of the plane, too.
    if up.is_nan() || up.abs() > STEEPEST {
        let degrees = libm::asin(up.clamp(-1.0, 1.0)).to_degrees();
        let words = format!(
            "its boresight, the x axis of its frame, points {degrees:.1}deg out of the plane, and may 10deg; if it looks along another \
             axis, --boresight z or -z; else its mount in a rig cures it (--rig)"
        );
        return Err(Lost::new(Reason::Tilted, words));
    }
    let cosine = (forward * forward + left * left).sqrt();
    let (x, y) = sensor.position();
    let heading = UnitComplex::from_cos_sin_unchecked(forward / cosine, left / cosine);
    let pose = Isometry2::from_parts(Vector2::new(x, y).into(), heading);
    let mut view = view(reading.sight, pose);
    if up == 0.0 {
        return Ok((reading.range, view));
    }
    let (min, max) = (reading.sight.limits.min() * cosine, reading.sight.limits.max() * cosine);
    let limits = Limits::new(min, max);
    view.limits = limits.map_err(|error| Lost::new(Reason::BadLimits, error.to_string()))?;
    Ok((reading.range * cosine, view))
}

/// What a reading's sensor saw from where it was.
pub(super) const fn view(sight: Sight, pose: Isometry2<f64>) -> View {
    View { pose, limits: sight.limits, beam: sight.beam, range_resolution: sight.range_resolution }
}

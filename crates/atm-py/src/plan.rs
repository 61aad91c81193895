//! `atm.plan`: equation (2) both ways.

use atm::{
    core::{Beam, DomainError, MinAngle, RangeResolution, resolution},
    pipeline::Defaults,
};
use pyo3::{exceptions::PyTypeError, prelude::*, types::PyDict};

use crate::{argument::named, raise};

/// H of the paper, for which the plan says how far it reaches.
const PAPER_HISTORY: u32 = 10;

/// What resolution to expect at a distance, and what it takes: equation (2) both ways (Sec. IV-B, IV-D).
///
/// Parameters
/// ----------
/// distance : float
///     Of what is to be seen, in metres.
/// min_angle : float, optional
///     The smallest crossing angle, in radians: what does it give? Either this or `improvement`.
/// improvement : float, optional
///     The wanted gain over the whole arc: what angle does it take?
/// field_of_view : float, optional
///     Full beam, in radians. None: 22.5 degrees.
/// range_resolution : float
///     Quantisation step of the ranges, in metres.
/// speed, rate : float, optional
///     Of the robot, in m/s, and of one sensor's readings, in Hz: both or neither.
///
/// Returns
/// -------
/// dict
///     ``interval_m``, ``improvement``, ``min_angle_rad``, ``close_range_m``, ``travel_m``, and ``readings`` and ``history_reach_m``,
///     which are None without `speed` and `rate`: the keys of ``atm plan --json``.
///
/// Raises
/// ------
/// ValueError
///     A value out of its domain.
/// TypeError
///     Neither or both of `min_angle` and `improvement`, or one of `speed` and `rate` alone.
///
/// Examples
/// --------
/// The paper's sensor at 100 inches, with 30 degrees:
///
/// >>> import atm, math
/// >>> plan = atm.plan(distance=2.54, min_angle=math.radians(30))
/// >>> round(plan["improvement"], 1), plan["readings"]
/// (10.5, None)
#[pyfunction]
#[pyo3(signature = (distance, *, min_angle=None, improvement=None, field_of_view=None, range_resolution=0.0254, speed=None,
                    rate=None))]
#[expect(clippy::too_many_arguments, reason = "the signature is Python's")]
pub fn plan<'py>(
    py: Python<'py>,
    #[pyo3(from_py_with = named::distance)] distance: f64,
    #[pyo3(from_py_with = named::min_angle)] min_angle: Option<f64>,
    #[pyo3(from_py_with = named::improvement)] improvement: Option<f64>,
    #[pyo3(from_py_with = named::field_of_view)] field_of_view: Option<f64>,
    #[pyo3(from_py_with = named::range_step)] range_resolution: f64,
    #[pyo3(from_py_with = named::speed)] speed: Option<f64>,
    #[pyo3(from_py_with = named::rate)] rate: Option<f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let named = |argument: &'static str| move |error: DomainError| raise::value(argument, error);
    let beam = Beam::new(field_of_view.unwrap_or(Defaults::FIELD_OF_VIEW)).map_err(named("field_of_view"))?;
    let delta = RangeResolution::new(range_resolution).map_err(named("range_resolution"))?;
    let angle = match (min_angle, improvement) {
        (Some(radians), None) => MinAngle::new(radians).map_err(named("min_angle"))?,
        (None, Some(wanted)) => {
            resolution::min_angle_for(wanted, distance, &beam, delta).map_err(|error| match error {
                DomainError::Distance => raise::value("distance", error),
                _ => raise::value("improvement", error),
            })?
        }
        _ => return Err(PyTypeError::new_err("one of min_angle and improvement is needed, not both")),
    };
    let improvement = resolution::improvement(distance, &beam, delta, &angle).map_err(named("distance"))?;
    let travel = resolution::travel(distance, &angle).map_err(named("distance"))?;
    let motion = match (speed, rate) {
        (Some(speed), Some(rate)) => {
            let named = |error| match error {
                DomainError::Speed => raise::value("speed", error),
                _ => raise::value("rate", error),
            };
            let readings = resolution::readings_needed(travel, speed, rate).map_err(named)?;
            Some((readings, resolution::reach(PAPER_HISTORY, speed, rate, &angle).map_err(named)?))
        }
        (None, None) => None,
        _ => return Err(PyTypeError::new_err("speed and rate go together")),
    };
    let plan = PyDict::new(py);
    plan.set_item("interval_m", resolution::interval(delta, &angle))?;
    plan.set_item("improvement", improvement)?;
    plan.set_item("min_angle_rad", angle.radians())?;
    plan.set_item("close_range_m", resolution::close_range(&beam, delta, &angle))?;
    plan.set_item("travel_m", travel)?;
    plan.set_item("readings", motion.map(|(readings, _)| readings))?;
    plan.set_item("history_reach_m", motion.map(|(_, reach)| reach))?;
    Ok(plan)
}

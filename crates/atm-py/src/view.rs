//! `atm.view`: the page that replays a drive. What Python says of it stands in `_view.py`.

use atm::{
    core::{Bounds, Consensus, RangeResolution, TransversalMedian},
    echo::AnyEstimator,
    error::Error,
    job::{LogJob, McapWishes},
    log::Input,
    pipeline::{Defaults, Emit, Settings},
    track::MotionLimit,
};
use atm_lab::view::{MOST_READINGS, Method, Replay, Units, ViewJob};
use pyo3::{prelude::*, types::PyDict};

use crate::{
    argument::{self, named},
    file::quantity,
    fuse::warn,
    interrupt::Watch,
    options, raise,
    rig::rig as rig_of,
    simulate::world as world_of,
};

/// The page as a text.
#[pyfunction]
#[pyo3(signature = (input, command, *, rig=None, poses=None, world=None, set=None, truth=None, methods=None, history=None, reach=None,
                    preset=None, min_angle=None,
                    range_resolution=None, range_error=None, units=None))]
#[expect(clippy::too_many_arguments, reason = "the signature is Python's")]
pub fn _view(
    py: Python<'_>,
    input: &Bound<'_, PyAny>,
    command: String,
    rig: Option<&Bound<'_, PyAny>>,
    poses: Option<&Bound<'_, PyAny>>,
    world: Option<&Bound<'_, PyAny>>,
    set: Option<&Bound<'_, PyDict>>,
    truth: Option<&Bound<'_, PyAny>>,
    methods: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = options::history)] history: Option<usize>,
    reach: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = named::preset)] preset: Option<&str>,
    min_angle: Option<&Bound<'_, PyAny>>,
    range_resolution: Option<&Bound<'_, PyAny>>,
    range_error: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = named::units)] units: Option<&str>,
) -> PyResult<String> {
    let path = |name, value: Option<&Bound<'_, PyAny>>| value.map(|value| argument::path(name, value)).transpose();
    let step = quantity("range_resolution", range_resolution, atm::units::length)?.map(RangeResolution::new);
    let step = step.transpose().map_err(|error| raise::value("range_resolution", error))?;
    let methods = chosen(methods)?;
    let reach = quantity("reach", reach, atm::units::length)?;
    let min_angle = options::min_angle(quantity("min_angle", min_angle, atm::units::angle)?)?;
    let range_error = quantity("range_error", range_error, atm::units::length)?.unwrap_or(0.0);
    let median = AnyEstimator::Median(TransversalMedian { min_angle, ..TransversalMedian::PAPER });
    let consensus = Consensus::new(min_angle).with_range_error(range_error);
    let consensus = AnyEstimator::Consensus(consensus.map_err(|error| raise::value("range_error", error))?);
    let fused = [(Method::Atm, median), (Method::Consensus, consensus)].into_iter();
    let all = [("metric", Units::Metric), ("inches", Units::Inches)];
    let job = ViewJob {
        log: LogJob {
            input: argument::path("input", input)?,
            parts: Vec::new(),
            opens: Input::open,
            from: None,
            rig: rig.map(rig_of).transpose()?,
            poses: path("poses", poses)?,
            max_gap: None,
            max_speed: MotionLimit::default(),
            empty: None,
            defaults: Defaults { field_of_view: None, range_resolution: step },
            mcap: McapWishes::default(),
        },
        settings: Settings {
            emit: Emit::Settled,
            history: options::LocalMap { history, reach, preset }.history()?,
            bounds: Bounds::NONE,
            estimator: median,
            strict: false,
        },
        estimators: fused.filter(|(method, _)| methods.contains(method)).map(|(_, estimator)| estimator).collect(),
        methods,
        command,
        world: world.map(|world| world_of(world, set)).transpose()?,
        truth: path("truth", truth)?,
        units: units.map(|word| argument::choice("units", word, &all)).transpose()?,
        most: MOST_READINGS,
    };
    let mut watch = Watch::new();
    let made = py.detach(|| job.run(&mut |_, _| !watch.is_over(|_| Ok(()))));
    watch.into_result()?;
    let replay = made.map_err(|error: Error| raise::library(&error))?;
    told(py, &replay)?;
    Ok(replay.html)
}

fn chosen(methods: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<Method>> {
    let Some(words) = methods else { return Ok(Method::ALL.to_vec()) };
    let all = Method::ALL.map(|method| (method.word(), method));
    let words = argument::words("methods", words)?;
    let wanted: Vec<Method> =
        words.iter().map(|word| argument::choice("methods", word, &all)).collect::<PyResult<_>>()?;
    Ok(Method::ALL.into_iter().filter(|method| wanted.contains(method)).collect())
}

/// Warns of what deserves a word.
fn told(py: Python<'_>, replay: &Replay) -> PyResult<()> {
    let (readings, stride) = replay.thinned;
    if stride > 1 {
        warn(py, &format!("thinned: one in {stride} readings of each sensor is shown, of {readings}"))?;
    }
    match replay.summaries.first() {
        Some((_, summary)) if !summary.is_clean() => {
            warn(py, &format!("{} records could not be used", summary.dropped.total()))
        }
        _ => Ok(()),
    }
}

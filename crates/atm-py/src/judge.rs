//! `atm.evaluate` and `atm.compare`: how good echoes are, and how good each method.

use std::sync::Arc;

use atm::{core::Point2, error::Error, pipeline::Defaults};
use atm_lab::{
    compare::{Assessment, Name, Options as Chosen, Recording, as_json, assess, run},
    eval::{Estimate, evaluate as scores},
    truth::{Cause, Truth, TruthPoint},
};
use pyo3::{exceptions::PyValueError, prelude::*, types::PyDict};
use serde_json::Value;

use crate::{
    argument::{self, named},
    column::{Held, HeldTimes, Shape, numbers, times},
    fuse::ArraySource,
    interrupt::Watch,
    options::{self, LocalMap},
    raise,
    readings::{Arguments, Given},
    rig::rig as rig_of,
    simulate::world as world_of,
};

/// The fields of a table: a structured array, a frame, or a dict of arrays.
struct Fields<'a, 'py> {
    /// The argument.
    name: &'static str,
    table: &'a Bound<'py, PyAny>,
}

impl<'py> Fields<'_, 'py> {
    fn find(&self, field: &str) -> Option<Bound<'py, PyAny>> {
        self.table.get_item(field).ok()
    }

    fn get(&self, field: &str) -> PyResult<Bound<'py, PyAny>> {
        self.find(field).ok_or_else(|| raise::value(self.name, format_args!("no field {field:?}")))
    }

    fn said(&self, field: &str) -> String {
        format!("{}[{field:?}]", self.name)
    }

    fn numbers(&self, field: &str) -> PyResult<Held<'py, f64>> {
        numbers(&self.said(field), &self.get(field)?, Shape::Array)
    }

    fn some_numbers(&self, field: &str) -> PyResult<Option<Held<'py, f64>>> {
        self.find(field).map(|array| numbers(&self.said(field), &array, Shape::Array)).transpose()
    }

    fn times(&self) -> PyResult<HeldTimes<'py>> {
        times(&self.get("t")?, Shape::Array, Some(1))
    }

    fn words(&self, field: &str) -> PyResult<Vec<Arc<str>>> {
        let items = self.get(field)?.try_iter()?;
        items.map(|item| Ok(Arc::from(item?.str()?.to_string_lossy()))).collect()
    }

    fn some_words(&self, field: &str) -> PyResult<Option<Vec<Arc<str>>>> {
        if self.find(field).is_some() { self.words(field).map(Some) } else { Ok(None) }
    }

    /// A finite number of an array that has as many as the others.
    fn finite(&self, field: &str, held: &Held<'py, f64>, index: usize) -> PyResult<f64> {
        let value = held.column().get(index, f64::NAN);
        if value.is_finite() {
            return Ok(value);
        }
        Err(raise::value(
            &format!("{}[{index}]", self.said(field)),
            format_args!("{} is not finite", argument::float(value)),
        ))
    }

    fn check_length(&self, field: &str, found: usize, expected: usize) -> PyResult<()> {
        if found == expected {
            return Ok(());
        }
        Err(raise::value(&self.said(field), format_args!("{found} items, but x has {expected}")))
    }
}

fn truth_of(table: &Bound<'_, PyAny>) -> PyResult<Truth> {
    let fields = Fields { name: "truth", table };
    let (times, sensors, causes) = (fields.times()?, fields.words("sensor")?, fields.words("cause")?);
    let columns = ["x", "y", "azimuth"].map(|name| fields.numbers(name).map(|held| (name, held)));
    let [x, y, azimuth] = columns;
    let (x, y, azimuth) = (x?, y?, azimuth?);
    let length = x.1.len().unwrap_or(0);
    let lengths = [("t", times.len()), ("sensor", Some(sensors.len())), ("cause", Some(causes.len()))];
    for (name, found) in lengths.into_iter().chain([(y.0, y.1.len()), (azimuth.0, azimuth.1.len())]) {
        fields.check_length(name, found.unwrap_or(0), length)?;
    }
    let mut truth = Truth::default();
    for (index, (sensor, cause)) in sensors.iter().zip(&causes).enumerate() {
        let known = Cause::ALL.into_iter().find(|known| known.name() == &**cause);
        let cause = known.ok_or_else(|| {
            let causes = Cause::ALL.map(Cause::name).join(", ");
            raise::value(&format!("truth[\"cause\"][{index}]"), format_args!("{cause:?} is none of {causes}"))
        })?;
        let at = |(name, held): &(&str, Held<'_, f64>)| fields.finite(name, held, index);
        let point = TruthPoint { position: Point2::new(at(&x)?, at(&y)?), azimuth: at(&azimuth)?, cause };
        truth.insert(times.column().get(index, 0), sensor, point);
    }
    Ok(truth)
}

fn estimates_of(table: &Bound<'_, PyAny>) -> PyResult<Vec<Estimate>> {
    let fields = Fields { name: "echoes", table };
    let (x, y) = (fields.numbers("x")?, fields.numbers("y")?);
    let length = x.len().unwrap_or(0);
    let (azimuth, range) = (fields.some_numbers("azimuth")?, fields.some_numbers("range")?);
    let (sensors, kinds) = (fields.some_words("sensor")?, fields.some_words("kind")?);
    let times = if sensors.is_some() { Some(fields.times()?) } else { None };
    let lengths = [
        ("y", y.len()),
        ("azimuth", azimuth.as_ref().and_then(Held::len)),
        ("range", range.as_ref().and_then(Held::len)),
        ("sensor", sensors.as_ref().map(Vec::len)),
        ("kind", kinds.as_ref().map(Vec::len)),
        ("t", times.as_ref().and_then(HeldTimes::len)),
    ];
    for (name, found) in lengths {
        if let Some(found) = found {
            fields.check_length(name, found, length)?;
        }
    }
    let some = |name, held: &Option<Held<'_, f64>>, index| {
        held.as_ref().map(|held| fields.finite(name, held, index)).transpose()
    };
    let estimate = |index: usize| {
        let key = times.as_ref().zip(sensors.as_ref());
        let key = key.and_then(|(times, ids)| Some((times.column().get(index, 0), Arc::clone(ids.get(index)?))));
        Ok(Estimate {
            position: Point2::new(fields.finite("x", &x, index)?, fields.finite("y", &y, index)?),
            key,
            azimuth: some("azimuth", &azimuth, index)?,
            range: some("range", &range, index)?,
            kind: kinds.as_ref().and_then(|kinds| kinds.get(index).map(Arc::clone)),
        })
    };
    (0..length).map(estimate).collect()
}

/// As Python has JSON: null is None.
fn loads(py: Python<'_>, text: serde_json::Result<String>) -> PyResult<Bound<'_, PyAny>> {
    let text = text.map_err(|error| PyValueError::new_err(error.to_string()))?;
    py.import("json")?.call_method1("loads", (text,))
}

/// Says how good echoes are where the world is known: what ``atm eval --json`` says.
///
/// Parameters
/// ----------
/// echoes : numpy.ndarray or mapping of arrays
///     What :func:`fuse` returns, or any table of points with the fields ``x`` and ``y`` (metres); ``t`` with ``sensor``, ``azimuth``, ``range`` and
///     ``kind`` are taken where they are there.
/// world : str or os.PathLike
///     Where the points should lie: a built-in world or a TOML file.
/// truth : numpy.ndarray or mapping of arrays, optional
///     Where each echo really came from, as :func:`simulate` returns it: for azimuth errors.
/// set : dict, optional
///     Parameters of the world, as in :func:`simulate`.
///
/// Returns
/// -------
/// dict
///     ``points``, ``azimuth_error_m`` and ``surface_error_m`` (``p50``, ``p90``, ``p95``, ``mean``, ``count``), ``coverage`` (share), ``ghosts``, ``doorway_width_m``
///     and ``by_kind``, the same for each kind; None where it does not apply. In metres.
///
/// Raises
/// ------
/// ValueError, TypeError
///     A field that is missing, not finite or of another length; the message names it and the index. No such parameter of the world.
/// OSError
///     No such world, or its file can't be read.
///
/// Examples
/// --------
/// >>> import atm
/// >>> log, truth = atm.simulate("doorway")
/// >>> echoes = atm.fuse(*(log[name] for name in log.dtype.names), rig="nomad200", keep=["median", "single"])
/// >>> scores = atm.evaluate(echoes, "doorway", truth=truth)
/// >>> scores["points"] == len(echoes), scores["azimuth_error_m"]["p50"] < 0.02
/// (True, True)
#[pyfunction]
#[pyo3(signature = (echoes, world, *, truth=None, set=None))]
pub fn evaluate<'py>(
    py: Python<'py>,
    echoes: &Bound<'py, PyAny>,
    world: &Bound<'py, PyAny>,
    truth: Option<&Bound<'py, PyAny>>,
    set: Option<&Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyAny>> {
    let (world, estimates, truth) = (world_of(world, set)?, estimates_of(echoes)?, truth.map(truth_of).transpose()?);
    let text = py.detach(|| serde_json::to_string(&scores(&estimates, &world, truth.as_ref())));
    loads(py, text)
}

/// Runs methods on one log and says how good each is: what ``atm compare --json`` says.
///
/// Parameters
/// ----------
/// t, sensor, range_, x, y, yaw, rig, history, min_angle, range_resolution, field_of_view, drop_held, range_error, sensor_index, reach, preset
///     As in :func:`fuse`.
/// world : str or os.PathLike, optional
///     Where the points should lie: a built-in world or a TOML file. None: the methods are compared with one another.
/// truth : numpy.ndarray or mapping of arrays, optional
///     Where each echo really came from, as :func:`simulate` returns it.
/// set : dict, optional
///     Parameters of the world, as in :func:`simulate`.
/// methods : iterable of str or str, optional
///     Only these, by their words in ``atm compare --help``, in this order. None: all.
/// cell : float, optional
///     Width of the cells of every grid, in metres. None: 0.05, of himm 0.1.
///
/// Returns
/// -------
/// dict
///     For each method the keys of :func:`evaluate`, ``seconds_per_reading``, ``best``, ``same_readings``, ``map_entropy_bits`` and ``agreement``; None
///     where they do not apply.
///
/// Raises
/// ------
/// ValueError, TypeError, OSError
///     As :func:`fuse` and :func:`evaluate`; an unknown method; more than four million readings.
///
/// Notes
/// -----
/// Ctrl-C ends the call after the method that is running.
///
/// Examples
/// --------
/// >>> import atm
/// >>> log, truth = atm.simulate("doorway")
/// >>> readings = [log[name] for name in log.dtype.names]
/// >>> said = atm.compare(*readings, rig="nomad200", world="doorway", truth=truth, methods=["atm-median-single", "centerline"])
/// >>> said["atm-median-single"]["azimuth_error_m"]["p50"] < said["centerline"]["azimuth_error_m"]["p50"] / 5
/// True
#[pyfunction]
#[pyo3(signature = (t, sensor, range_, x, y, yaw, *, rig, world=None, truth=None, set=None, methods=None, history=None,
                    min_angle=None, range_resolution=None, field_of_view=None, drop_held=false, range_error=None,
                    cell=None, sensor_index=None, reach=None, preset=None))]
#[expect(clippy::too_many_arguments, reason = "the signature is Python's")]
pub fn compare<'py>(
    py: Python<'py>,
    t: &Bound<'py, PyAny>,
    sensor: &Bound<'py, PyAny>,
    range_: &Bound<'py, PyAny>,
    x: &Bound<'py, PyAny>,
    y: &Bound<'py, PyAny>,
    yaw: &Bound<'py, PyAny>,
    rig: &Bound<'py, PyAny>,
    world: Option<&Bound<'py, PyAny>>,
    truth: Option<&Bound<'py, PyAny>>,
    set: Option<&Bound<'py, PyDict>>,
    methods: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = options::history)] history: Option<usize>,
    #[pyo3(from_py_with = named::min_angle)] min_angle: Option<f64>,
    #[pyo3(from_py_with = named::range_resolution)] range_resolution: Option<f64>,
    #[pyo3(from_py_with = named::field_of_view)] field_of_view: Option<f64>,
    #[pyo3(from_py_with = named::drop_held)] drop_held: bool,
    #[pyo3(from_py_with = named::range_error)] range_error: Option<f64>,
    #[pyo3(from_py_with = named::cell)] cell: Option<f64>,
    sensor_index: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = named::reach)] reach: Option<f64>,
    #[pyo3(from_py_with = named::preset)] preset: Option<&str>,
) -> PyResult<Bound<'py, PyAny>> {
    let names = methods_of(methods)?;
    let world = world.map(|world| world_of(world, set)).transpose()?;
    let truth = truth.map(truth_of).transpose()?;
    let rig = rig_of(rig)?;
    let defaults: Defaults = options::defaults(field_of_view, range_resolution)?;
    let sensors = options::models(&rig, &defaults)?;
    let positive = |name, value: Option<f64>, least: f64| match value {
        Some(metres) if !(metres >= least && metres.is_finite()) => {
            Err(raise::value(name, format_args!("{} is out of its domain", argument::float(metres))))
        }
        value => Ok(value),
    };
    let chosen = Chosen {
        history: LocalMap { history, reach, preset }.history()?,
        min_angle: options::min_angle(min_angle)?,
        range_error: positive("range_error", range_error, 0.0)?.unwrap_or(0.0),
        cell: positive("cell", cell, f64::MIN_POSITIVE)?,
    };
    let arguments =
        Arguments::new(&Given { t, sensor, range: range_, x, y, yaw, sensor_index, t_unit: None }, &rig, Shape::Array)?;
    let readings = arguments.readings();
    let mut watch = Watch::new();
    let text = py.detach(|| {
        readings.check(None)?;
        let mut source = ArraySource::new(readings, rig.ids(), &mut watch);
        let recording = match Recording::read(&mut source, None, &sensors, drop_held, &mut |_| {}) {
            Err(Error::Interrupted) => return Ok(None),
            recording => recording.map_err(|error| raise::library(&error))?,
        };
        let mut said = Vec::new();
        for name in &names {
            if watch.is_over(|_| Ok(())) {
                return Ok(None);
            }
            said.push(run(*name, &recording, &chosen).map_err(|error| raise::library(&error))?);
        }
        let assessed = assess(&said, &recording, world.as_ref(), truth.as_ref());
        let assessed = assessed.map_err(|error| raise::library(&error))?;
        let rows: Vec<(Name, &Assessment)> = names.iter().copied().zip(&assessed).collect();
        Ok::<_, PyErr>(Some(as_json(&rows).and_then(|value: Value| serde_json::to_string(&value))))
    })?;
    watch.into_result()?;
    match text {
        Some(text) => loads(py, text),
        None => Ok(py.None().into_bound(py)),
    }
}

/// Each once, in the order in which they were asked for.
fn methods_of(methods: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<Name>> {
    let Some(methods) = methods else { return Ok(Name::ALL.to_vec()) };
    let known = Name::ALL.map(|name| (name.word(), name));
    let mut names = Vec::new();
    for word in argument::words("methods", methods)? {
        let name = argument::choice("methods", &word, &known)?;
        if !names.contains(&name) {
            names.push(name);
        }
    }
    Ok(names)
}

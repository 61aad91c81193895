//! `atm.fuse` and `atm.crossings`: the library's pipeline, from arrays to arrays.

use std::sync::Arc;

use atm::{
    core::Kind,
    diagnose::{Diagnosis, guessed_resolution},
    error::{Error, Problem, Result},
    log::{Next, Row, Source},
    pipeline::{self, EchoSink, SensorModel, Settings},
    summary::Summary,
};
use pyo3::{exceptions::PyUserWarning, prelude::*};

use crate::{
    argument::named,
    column::Shape,
    interrupt::Watch,
    options::{self, Choice, LocalMap, Options},
    raise,
    readings::{Arguments, Given, Readings},
    rig::rig as rig_of,
    table::{Crossings, Echoes},
};

/// Readings that are handed over at once, at most.
const MOST_IN_A_ROW: usize = 1024;

/// Readings in arrays, as a log: those of one time and pose are one record.
pub struct ArraySource<'r, 'w> {
    readings: Readings<'r>,
    /// The sensors' ids, where somebody asks for them.
    ids: &'r [Arc<str>],
    next: usize,
    /// Since the watch was last asked.
    unwatched: usize,
    watch: &'w mut Watch,
}

impl<'r, 'w> ArraySource<'r, 'w> {
    /// All readings, of sensors with these ids.
    pub fn new(readings: Readings<'r>, ids: &'r [Arc<str>], watch: &'w mut Watch) -> Self {
        Self { readings, ids, next: 0, unwatched: 0, watch }
    }

    /// Whether two readings belong to one record. By bits: -0.0 and 0.0 turn differently.
    fn are_one(&self, one: usize, other: usize) -> bool {
        let bits = |index| {
            let pose = self.readings.pose(index);
            (self.readings.time(index), [pose.x, pose.y, pose.yaw].map(f64::to_bits))
        };
        bits(one) == bits(other)
    }
}

impl Source for ArraySource<'_, '_> {
    fn next_row(&mut self, row: &mut Row, _problems: &mut dyn FnMut(Problem)) -> Result<Next> {
        row.readings.clear();
        let first = self.next;
        if first >= self.readings.len() {
            return Ok(Next::End);
        }
        if self.unwatched >= MOST_IN_A_ROW {
            self.unwatched = 0;
            if self.watch.is_over(|_| Ok(())) {
                return Err(Error::Interrupted);
            }
        }
        row.t = self.readings.time(first);
        row.log_time = row.t;
        row.pose = Some(self.readings.pose(first));
        row.place.byte = first as u64;
        while self.next < self.readings.len()
            && self.next - first < MOST_IN_A_ROW
            && (self.next == first || self.are_one(first, self.next))
        {
            row.readings.push(self.readings.measured(self.next));
            self.next += 1;
        }
        self.unwatched += self.next - first;
        Ok(Next::Record)
    }

    fn drained(&self) -> bool {
        false
    }

    fn position(&self) -> u64 {
        self.next as u64
    }

    fn has_poses(&self) -> bool {
        true
    }

    fn ids(&self) -> &[Arc<str>] {
        self.ids
    }
}

/// Runs the pipeline with the interpreter let go.
fn run(
    py: Python<'_>,
    readings: Readings<'_>,
    sensors: &[SensorModel],
    settings: &Settings,
    sink: &mut (impl EchoSink + Send),
) -> PyResult<Summary> {
    let mut watch = Watch::new();
    let (summary, result) = py.detach(|| {
        readings.check(None)?;
        // The rig's sensors are known beforehand.
        let mut source = ArraySource::new(readings, &[], &mut watch);
        Ok::<_, PyErr>(pipeline::fuse(&mut source, None, sensors, settings, sink, &mut |_| {}))
    })?;
    watch.into_result()?;
    match result {
        Ok(()) => Ok(summary),
        // All else was checked: a pose that is finite, and overflows where the sensor sits.
        Err(Error::Strict { problem }) => {
            let index = usize::try_from(problem.place.byte).unwrap_or(usize::MAX);
            Err(readings.fault("x", index, problem.value).into())
        }
        // More slots than there may be: only H can be less.
        Err(error @ Error::Settings { .. }) => Err(raise::value("history", error)),
        Err(error) => Err(raise::library(&error)),
    }
}

/// Says what is likely wrong with the log, but for records that can't be used, which are told of with their places.
pub fn warn_of(py: Python<'_>, advice: &[Diagnosis]) -> PyResult<()> {
    let told = advice.iter().filter(|found| !matches!(found, Diagnosis::Unusable { .. } | Diagnosis::Recording(_)));
    told.into_iter().try_for_each(|found| warn(py, &found.to_string()))
}

/// Says something that is no error.
pub fn warn(py: Python<'_>, message: &str) -> PyResult<()> {
    let message = std::ffi::CString::new(message.replace('\0', " ")).unwrap_or_default();
    PyErr::warn(py, &py.get_type::<PyUserWarning>(), &message, 1)
}

/// Turns range readings into echo points: the arc-transversal median, reading by reading.
///
/// Parameters
/// ----------
/// t : array_like of float64 or int64, shape (n,)
///     When each reading was taken, in order: float seconds (taken to the nearest nanosecond, half-even), int nanoseconds or other
///     whole numbers with their `t_unit`, or datetime64.
/// sensor : array_like of str or int, shape (n,)
///     The sensors' ids. Whole numbers only where the rig's ids are exactly "0", "1", ...; else see `sensor_index`.
/// range_ : array_like, shape (n,)
///     What was measured, in metres. nan, inf and what lies outside the sensor's limits is a reading without an echo.
/// x, y, yaw : array_like, shape (n,)
///     The ROBOT's pose at each reading in a fixed frame: metres, metres, radians counter-clockwise.
/// rig : Rig or str or os.PathLike
///     The sensors: a :class:`Rig`, a built-in rig's name, or a TOML file.
/// history : int, optional
///     The most readings of each sensor in the local map, 1 to 10000, spaced evenly over the travel that `reach` takes. Alone,
///     without `reach`: the last so many readings of every sensor, wherever they were taken. None: 50, spaced.
/// min_angle : float, optional
///     Crossings count from this angle on, in radians, in [1, 90] degrees. None: 30 degrees (Sec. IV-B).
/// range_resolution : float, optional
///     Quantisation step of the ranges, in metres; beats the rig's. None: the rig's, else 1 inch.
/// field_of_view : float, optional
///     Full beam, in radians, of sensors of which the rig does not say it. None: 22.5 degrees.
/// emit : {"settled", "latest"}
///     Each echo when its reading leaves the local map, from every arc it met; or at its arrival, from the arcs before it.
/// on_none : {"center", "drop"}
///     What a reading without crossings gives: the arc's centre, or nothing.
/// on_two : {"drop", "center", "mean"}
///     What a reading with exactly two crossings gives.
/// max_age, max_travel : float, optional
///     A reading leaves the local map after this time (seconds) or this much path (metres, at most 1000).
/// min_step : float, optional
///     Skip a reading whose sensor moved less than this since its last one in the local map, in metres.
/// drop_held : bool
///     Skip a reading equal to its sensor's previous one: ``held="drop"``.
/// keep : sequence of str, optional
///     Only echoes of these kinds. None: all.
/// sensor_index : array_like of int, shape (n,), optional
///     Places of the sensors in the rig, from 0, instead of ids; with ``sensor=None``.
/// held : {"keep", "drop", "edges"}, optional
///     What becomes of a reading equal to its sensor's previous one; "edges" keeps the first of a run of them and the last before
///     a change. None: "keep".
/// estimator : {"atm", "consensus"}
///     Who says where on its arc an echo came from: the median of the crossings, or the points and walls that the readings agree on.
/// confidence : float, optional
///     Least confidence of a point or wall of the consensus, in [0, 1). None: 0.9.
/// range_error : float, optional
///     By how much ranges are wrong beyond their rounding, as a standard deviation in metres, for the consensus. None: 0.
/// reach : float, optional
///     The local map spans the travel that crossings of `min_angle` take at this distance, in metres: 2 reach sin(min_angle / 2).
///     None: the sensors' largest range, at most 2.54 m.
/// preset : {"paper"}, optional
///     The last 10 readings of every sensor, for a robot at 5 in/s that reads once a second.
/// t_unit : {"s", "ms", "us", "ns"}, optional
///     The unit of whole numbers in `t`. None: ns, if that makes sense; whole numbers with less than a microsecond from one to the next
///     are refused.
///
/// Returns
/// -------
/// numpy.ndarray
///     One row an echo, in the order in which they are reported, with the fields ``t`` (the reading's own, int64 where `t`
///     was given as nanoseconds, else float64 seconds), ``sensor``, ``x``, ``y`` (metres, the fixed frame), ``kind`` ("median", "single", "center", "near",
///     "pair"), ``range`` (metres), ``azimuth`` (radians from the boresight), ``crossings``, ``resolution`` (metres along the arc)
///     and ``significance`` (equation (1)). By the consensus the kinds are "point", "wall" and "center", `crossings` counts the
///     readings that agree, and there follow ``support``, ``against`` (counts), ``sigma_azimuth`` (radians), ``sigma_range`` (metres),
///     ``normal_x`` and ``normal_y`` (nan but for walls). ``pandas.DataFrame(...)`` and ``polars.from_numpy(...)`` take it as it is.
///
/// Raises
/// ------
/// ValueError, TypeError
///     An argument that can't be used: shape, dtype, length, an unknown sensor, a time earlier than the one before it, a pose
///     that is not finite, an option out of its domain. The message names the argument and its first offending index.
/// OSError
///     The rig's file can't be read.
///
/// Warns
/// -----
/// UserWarning
///     What is likely wrong with the readings: hardly anything is resolved, headings in degrees, millimetres taken for metres, more than
///     20 % of the echoes near by a guessed range resolution, and the like.
///
/// Notes
/// -----
/// The same readings give the same bits as ``atm fuse``. Contiguous and strided float64 is read in place, anything else is
/// converted once; the arrays must not be written to meanwhile, as other threads run. Ctrl-C ends the call.
///
/// References
/// ----------
/// H. Choset, K. Nagatani, N. A. Lazar, "The Arc-Transversal Median Algorithm: A Geometric Approach to Increasing Ultrasonic
/// Sensor Azimuth Accuracy", IEEE Transactions on Robotics and Automation 19(3), 2003.
///
/// Examples
/// --------
/// A pole at (0, 2), passed by a sensor that looks to the left:
///
/// >>> import atm, numpy as np
/// >>> rig = atm.Rig.ring(count=1, radius=0.0, first_yaw=np.pi / 2, field_of_view=np.pi / 3, range_resolution=0.01)
/// >>> x = np.linspace(-1.0, 1.0, 9)
/// >>> echoes = atm.fuse(np.arange(9) * 0.1, np.zeros(9, int), np.hypot(x, 2.0), x, np.zeros(9), np.zeros(9), rig=rig)
/// >>> print(echoes["kind"][4], echoes["x"][4].round(6) + 0.0, echoes["y"][4].round(6))
/// single 0.0 2.0
#[pyfunction]
#[pyo3(signature = (t, sensor, range_, x, y, yaw, *, rig, history=None, min_angle=None, range_resolution=None,
                    field_of_view=None, emit="settled", on_none="center", on_two="drop", max_age=None, max_travel=None,
                    min_step=None, drop_held=false, keep=None, sensor_index=None, held=None, estimator="atm",
                    confidence=None, range_error=None, reach=None, preset=None, t_unit=None))]
#[expect(clippy::too_many_arguments, reason = "the signature is Python's")]
pub fn fuse<'py>(
    py: Python<'py>,
    t: &Bound<'py, PyAny>,
    sensor: &Bound<'py, PyAny>,
    range_: &Bound<'py, PyAny>,
    x: &Bound<'py, PyAny>,
    y: &Bound<'py, PyAny>,
    yaw: &Bound<'py, PyAny>,
    rig: &Bound<'py, PyAny>,
    #[pyo3(from_py_with = options::history)] history: Option<usize>,
    #[pyo3(from_py_with = named::min_angle)] min_angle: Option<f64>,
    #[pyo3(from_py_with = named::range_resolution)] range_resolution: Option<f64>,
    #[pyo3(from_py_with = named::field_of_view)] field_of_view: Option<f64>,
    #[pyo3(from_py_with = named::emit)] emit: &str,
    #[pyo3(from_py_with = named::on_none)] on_none: &str,
    #[pyo3(from_py_with = named::on_two)] on_two: &str,
    #[pyo3(from_py_with = named::max_age)] max_age: Option<f64>,
    #[pyo3(from_py_with = named::max_travel)] max_travel: Option<f64>,
    #[pyo3(from_py_with = named::min_step)] min_step: Option<f64>,
    #[pyo3(from_py_with = named::drop_held)] drop_held: bool,
    keep: Option<&Bound<'py, PyAny>>,
    sensor_index: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = named::held)] held: Option<&str>,
    #[pyo3(from_py_with = named::estimator)] estimator: &str,
    #[pyo3(from_py_with = named::confidence)] confidence: Option<f64>,
    #[pyo3(from_py_with = named::range_error)] range_error: Option<f64>,
    #[pyo3(from_py_with = named::reach)] reach: Option<f64>,
    #[pyo3(from_py_with = named::preset)] preset: Option<&str>,
    #[pyo3(from_py_with = named::t_unit)] t_unit: Option<&str>,
) -> PyResult<Bound<'py, PyAny>> {
    let call = Given { t, sensor, range: range_, x, y, yaw, sensor_index, t_unit };
    let options = Options {
        map: LocalMap { history, reach, preset },
        min_angle,
        range_resolution,
        field_of_view,
        emit,
        on_none,
        on_two,
        max_age,
        max_travel,
        min_step,
        drop_held,
        held,
        choice: Choice { estimator, confidence, range_error },
    };
    let (rig, defaults, settings) = (rig_of(rig)?, options.defaults()?, options.settings()?);
    let keep = options::keep(keep, &settings.estimator)?;
    let arguments = Arguments::new(&call, &rig, Shape::Array)?;
    let mut echoes = Echoes::new(&rig, arguments.clock(), &settings.estimator, keep, arguments.readings().len());
    let summary = run(py, arguments.readings(), &options::models(&rig, &defaults)?, &settings, &mut echoes)?;
    warn_of(py, &summary.advice)?;
    if defaults.guesses_resolution(&rig) {
        let (near, total) = (summary.echoes.get(Kind::Near.name()), summary.echoes.total());
        warn_of(py, guessed_resolution(near, total).as_slice())?;
    }
    echoes.into_array(py)
}

/// Every transversal crossing of the readings, one row per arc and crossing, when that arc is reported.
///
/// Parameters
/// ----------
/// t, sensor, range_, x, y, yaw, rig, history, min_angle, range_resolution, field_of_view, emit, on_none, on_two, max_age, \
/// max_travel, min_step, drop_held, sensor_index, reach, preset, t_unit
///     As in :func:`fuse`.
///
/// Returns
/// -------
/// numpy.ndarray
///     Fields ``t``, ``sensor`` (of the reported arc), ``t_other``, ``sensor_other`` (of the arc it is crossed by), ``x``, ``y``
///     (metres, the fixed frame), ``azimuth`` (on the reported arc, radians) and ``angle`` (of the crossing, radians, in
///     [0, pi/2]): what ``atm fuse --crossings`` writes, arcs that gave no echo included.
///
/// Raises
/// ------
/// ValueError, TypeError, OSError
///     As :func:`fuse`.
///
/// Examples
/// --------
/// >>> import atm, numpy as np
/// >>> rig = atm.Rig.ring(count=1, radius=0.0, first_yaw=np.pi / 2, field_of_view=np.pi / 3, range_resolution=0.01)
/// >>> x = np.array([-0.6, 0.6])
/// >>> found = atm.crossings(np.arange(2.0), np.zeros(2, int), np.hypot(x, 2.0), x, x * 0, x * 0, rig=rig)
/// >>> len(found), float(found["y"][0].round(6))
/// (2, 2.0)
#[pyfunction]
#[pyo3(signature = (t, sensor, range_, x, y, yaw, *, rig, history=None, min_angle=None, range_resolution=None,
                    field_of_view=None, emit="settled", on_none="center", on_two="drop", max_age=None, max_travel=None,
                    min_step=None, drop_held=false, sensor_index=None, reach=None, preset=None, t_unit=None))]
#[expect(clippy::too_many_arguments, reason = "the signature is Python's")]
pub fn crossings<'py>(
    py: Python<'py>,
    t: &Bound<'py, PyAny>,
    sensor: &Bound<'py, PyAny>,
    range_: &Bound<'py, PyAny>,
    x: &Bound<'py, PyAny>,
    y: &Bound<'py, PyAny>,
    yaw: &Bound<'py, PyAny>,
    rig: &Bound<'py, PyAny>,
    #[pyo3(from_py_with = options::history)] history: Option<usize>,
    #[pyo3(from_py_with = named::min_angle)] min_angle: Option<f64>,
    #[pyo3(from_py_with = named::range_resolution)] range_resolution: Option<f64>,
    #[pyo3(from_py_with = named::field_of_view)] field_of_view: Option<f64>,
    #[pyo3(from_py_with = named::emit)] emit: &str,
    #[pyo3(from_py_with = named::on_none)] on_none: &str,
    #[pyo3(from_py_with = named::on_two)] on_two: &str,
    #[pyo3(from_py_with = named::max_age)] max_age: Option<f64>,
    #[pyo3(from_py_with = named::max_travel)] max_travel: Option<f64>,
    #[pyo3(from_py_with = named::min_step)] min_step: Option<f64>,
    #[pyo3(from_py_with = named::drop_held)] drop_held: bool,
    sensor_index: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = named::reach)] reach: Option<f64>,
    #[pyo3(from_py_with = named::preset)] preset: Option<&str>,
    #[pyo3(from_py_with = named::t_unit)] t_unit: Option<&str>,
) -> PyResult<Bound<'py, PyAny>> {
    let call = Given { t, sensor, range: range_, x, y, yaw, sensor_index, t_unit };
    let options = Options {
        map: LocalMap { history, reach, preset },
        min_angle,
        range_resolution,
        field_of_view,
        emit,
        on_none,
        on_two,
        max_age,
        max_travel,
        min_step,
        drop_held,
        held: None,
        choice: Choice::ATM,
    };
    let (rig, defaults, settings) = (rig_of(rig)?, options.defaults()?, options.settings()?);
    let arguments = Arguments::new(&call, &rig, Shape::Array)?;
    let mut crossings = Crossings::new(&rig, arguments.clock());
    run(py, arguments.readings(), &options::models(&rig, &defaults)?, &settings, &mut crossings)?;
    crossings.into_array(py)
}

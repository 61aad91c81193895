//! `atm.Fuser`: reading by reading.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use atm::{
    core::{Consensus, Fuser, Rejected, Sink},
    echo::{AnyEcho, AnyEstimator},
    log::Row,
    pipeline::{self, Emit, SensorModel, latest_fuser, settled_fuser},
    rig::Rig,
    storage::{LatestSlots, SettledSlots},
};
use pyo3::{prelude::*, types::PyList};

use crate::{
    argument::named,
    column::Shape,
    echo::PyEcho,
    interrupt::Watch,
    options::{self, Choice, LocalMap, Options},
    raise,
    readings::{Arguments, Given, Readings},
    rig::rig as rig_of,
    time::Clock,
};

/// Readings between two looks at Python's signals.
const BATCH: usize = 1024;

/// Echoes as they come.
struct Found<'a>(&'a mut Vec<AnyEcho>);

impl<E: Copy + Into<AnyEcho>> Sink<f64, E> for Found<'_> {
    fn echo(&mut self, echo: &E) {
        self.0.push((*echo).into());
    }
}

/// The library's fuser, of either estimator in either mode.
enum Engine {
    Latest(Fuser<f64, LatestSlots<f64>>),
    Settled(Fuser<f64, SettledSlots<f64>>),
    LatestConsensus(Fuser<f64, LatestSlots<f64>, Consensus<f64>>),
    SettledConsensus(Fuser<f64, SettledSlots<f64>, Consensus<f64>>),
}

/// The same call of any of them.
macro_rules! of_any {
    ($engine:expr, $fuser:ident => $call:expr) => {
        match $engine {
            Engine::Latest($fuser) => $call,
            Engine::Settled($fuser) => $call,
            Engine::LatestConsensus($fuser) => $call,
            Engine::SettledConsensus($fuser) => $call,
        }
    };
}

impl Engine {
    fn push(&mut self, reading: &atm::core::Reading<f64>, mut found: Found<'_>) -> Result<(), Rejected> {
        of_any!(self, fuser => fuser.push(reading, &mut found)).map(|_| ())
    }

    fn finish(&mut self, mut found: Found<'_>) {
        of_any!(self, fuser => fuser.finish(&mut found));
    }

    fn snapshot(&mut self, mut found: Found<'_>) {
        of_any!(self, fuser => fuser.snapshot(&mut found));
    }
}

/// What changes from push to push.
struct State {
    engine: Engine,
    /// Time of the latest reading.
    latest: Option<i64>,
    /// How times are given: as the first one was.
    clock: Option<Clock>,
    row: Row,
}

impl State {
    /// Takes `from..to` of the readings in.
    fn take(
        &mut self,
        readings: &Readings<'_>,
        span: std::ops::Range<usize>,
        sensors: &[SensorModel],
        echoes: &mut Vec<AnyEcho>,
    ) -> PyResult<()> {
        for index in span {
            self.row.t = readings.time(index);
            self.row.readings.clear();
            self.row.readings.push(readings.measured(index));
            for reading in pipeline::readings(&self.row, readings.pose(index), sensors) {
                let pushed = self.engine.push(&reading, Found(echoes));
                pushed.map_err(|rejected| match rejected {
                    Rejected::TimeBackwards => readings.fault("t", index, rejected.to_string()),
                    // Everything else was checked: a finite pose that overflows where the sensor sits.
                    _ => readings.fault("x", index, rejected.to_string()),
                })?;
            }
            self.latest = Some(self.row.t);
        }
        Ok(())
    }
}

/// Turns readings into echoes as they come: for live sensors, and for logs larger than memory.
///
/// Parameters
/// ----------
/// rig : Rig or str or os.PathLike
///     The sensors: a :class:`Rig`, a built-in rig's name, or a TOML file.
/// history, min_angle, range_resolution, field_of_view, emit, on_none, on_two, max_age, max_travel, min_step, drop_held, \
/// held, estimator, confidence, range_error, reach, preset
///     As in :func:`fuse`.
///
/// Raises
/// ------
/// ValueError, TypeError, OSError
///     As :func:`fuse`.
///
/// Notes
/// -----
/// Several threads may use one fuser: their calls wait for one another, and each still has to be in order of time. The cost of a
/// reading does not grow with their number.
///
/// Examples
/// --------
/// >>> import atm
/// >>> fuser = atm.Fuser(atm.Rig.builtin("nomad200"), history=None)
/// >>> fuser.push(0.0, "3", 1.5, 0.0, 0.0, 0.0)
/// []
/// >>> [echo.kind for echo in fuser.finish()]
/// ['center']
#[pyclass(frozen, module = "atm", name = "Fuser")]
pub struct PyFuser {
    rig: Arc<Rig>,
    sensors: Vec<SensorModel>,
    state: Mutex<State>,
}

impl PyFuser {
    /// The state, waited for with the interpreter let go. A panic in between would have left it whole: nothing is half done.
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn list<'py>(&self, py: Python<'py>, echoes: Vec<AnyEcho>, clock: Clock) -> PyResult<Bound<'py, PyList>> {
        let echoes = echoes.into_iter().map(|echo| PyEcho::new(echo, clock, Arc::clone(&self.rig)));
        PyList::new(py, echoes.map(|echo| Py::new(py, echo)).collect::<PyResult<Vec<_>>>()?)
    }

    /// Takes all readings in, batch by batch, so that Ctrl-C comes through.
    fn take(&self, readings: &Readings<'_>, clock: Clock) -> PyResult<Vec<AnyEcho>> {
        let mut echoes = Vec::new();
        let mut watch = Watch::new();
        {
            let mut state = self.lock();
            match state.clock {
                Some(known) if known != clock => {
                    let message = format!("{}, but {} before", clock.words(), known.words());
                    return Err(raise::kind("t", message));
                }
                _ => {}
            }
            readings.check(state.latest)?;
            state.clock = Some(clock);
        }
        let mut first = 0;
        while first < readings.len() && !watch.is_over(|_| Ok(())) {
            let end = readings.len().min(first + BATCH);
            self.lock().take(readings, first..end, &self.sensors, &mut echoes)?;
            first = end;
        }
        watch.into_result()?;
        Ok(echoes)
    }
}

#[pymethods]
impl PyFuser {
    #[new]
    #[pyo3(signature = (rig, history=None, *, min_angle=None, range_resolution=None, field_of_view=None, emit="settled",
                        on_none="center", on_two="drop", max_age=None, max_travel=None, min_step=None, drop_held=false,
                        held=None, estimator="atm", confidence=None, range_error=None, reach=None, preset=None))]
    #[expect(clippy::too_many_arguments, reason = "the signature is Python's")]
    fn new(
        rig: &Bound<'_, PyAny>,
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
        #[pyo3(from_py_with = named::held)] held: Option<&str>,
        #[pyo3(from_py_with = named::estimator)] estimator: &str,
        #[pyo3(from_py_with = named::confidence)] confidence: Option<f64>,
        #[pyo3(from_py_with = named::range_error)] range_error: Option<f64>,
        #[pyo3(from_py_with = named::reach)] reach: Option<f64>,
        #[pyo3(from_py_with = named::preset)] preset: Option<&str>,
    ) -> PyResult<Self> {
        let rig = rig_of(rig)?;
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
        let (settings, sensors) = (options.settings()?, options::models(&rig, &options.defaults()?)?);
        let too_large = |error: atm::error::Error| raise::value("history", error);
        let engine = match (settings.emit, settings.estimator) {
            (Emit::Latest, AnyEstimator::Median(median)) => {
                Engine::Latest(latest_fuser(median, &settings, &sensors).map_err(too_large)?)
            }
            (Emit::Settled, AnyEstimator::Median(median)) => {
                Engine::Settled(settled_fuser(median, &settings, &sensors).map_err(too_large)?)
            }
            (Emit::Latest, AnyEstimator::Consensus(consensus)) => {
                Engine::LatestConsensus(latest_fuser(consensus, &settings, &sensors).map_err(too_large)?)
            }
            (Emit::Settled, AnyEstimator::Consensus(consensus)) => {
                Engine::SettledConsensus(settled_fuser(consensus, &settings, &sensors).map_err(too_large)?)
            }
        };
        let state = State { engine, latest: None, clock: None, row: Row::default() };
        Ok(Self { rig, sensors, state: Mutex::new(state) })
    }

    /// Takes readings in, and returns the echoes that this settles.
    ///
    /// Parameters
    /// ----------
    /// t, sensor, range_, x, y, yaw, sensor_index, t_unit
    ///     As in :func:`fuse`; each an array of shape (n,), or a single value that holds for all n.
    ///
    /// Returns
    /// -------
    /// list of Echo
    ///
    /// Raises
    /// ------
    /// ValueError, TypeError
    ///     As :func:`fuse`, and where a time is earlier than what was pushed before, or times were nanoseconds and are seconds now.
    ///     Nothing was taken in then.
    ///
    /// Examples
    /// --------
    /// >>> import atm
    /// >>> fuser = atm.Fuser("nomad200", emit="latest")
    /// >>> len(fuser.push(0.0, ["0", "4"], [1.0, 2.0], 0.0, 0.0, 0.0))
    /// 2
    #[pyo3(signature = (t, sensor, range_, x, y, yaw, *, sensor_index=None, t_unit=None))]
    #[expect(clippy::too_many_arguments, reason = "the signature is Python's")]
    fn push<'py>(
        &self,
        py: Python<'py>,
        t: &Bound<'py, PyAny>,
        sensor: &Bound<'py, PyAny>,
        range_: &Bound<'py, PyAny>,
        x: &Bound<'py, PyAny>,
        y: &Bound<'py, PyAny>,
        yaw: &Bound<'py, PyAny>,
        sensor_index: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = named::t_unit)] t_unit: Option<&str>,
    ) -> PyResult<Bound<'py, PyList>> {
        let given = Given { t, sensor, range: range_, x, y, yaw, sensor_index, t_unit };
        let arguments = Arguments::new(&given, &self.rig, Shape::Any)?;
        let (readings, clock) = (arguments.readings(), arguments.clock());
        let echoes = py.detach(|| self.take(&readings, clock))?;
        self.list(py, echoes, clock)
    }

    /// Ends the log: empties the local map and returns the echoes that are due then. What is pushed next begins anew, at any time
    /// and place.
    ///
    /// Returns
    /// -------
    /// list of Echo
    fn finish<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let (echoes, clock) = py.detach(|| {
            let (mut state, mut echoes) = (self.lock(), Vec::new());
            state.engine.finish(Found(&mut echoes));
            state.latest = None;
            (echoes, state.clock.take())
        });
        self.list(py, echoes, clock.unwrap_or(Clock::Seconds))
    }

    /// What the local map says now: an echo of every arc in it, from the others in it. Changes nothing; in either mode.
    ///
    /// Returns
    /// -------
    /// list of Echo
    fn snapshot<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let (echoes, clock) = py.detach(|| {
            let (mut state, mut echoes) = (self.lock(), Vec::new());
            state.engine.snapshot(Found(&mut echoes));
            (echoes, state.clock)
        });
        self.list(py, echoes, clock.unwrap_or(Clock::Seconds))
    }

    fn __repr__(&self) -> String {
        format!("Fuser(rig='{}', {} sensors)", self.rig.name(), self.sensors.len())
    }
}

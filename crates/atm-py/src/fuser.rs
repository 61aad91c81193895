//! `atm.Fuser` and `atm.Echo`: reading by reading.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use atm::{
    core::{Echo, Fuser, Rejected, Sink},
    log::Row,
    pipeline::{self, Emit, SensorModel},
    rig::Rig,
    storage::{LatestSlots, SettledSlots},
};
use pyo3::{prelude::*, types::PyList};

use crate::{
    argument::{self, named},
    column::Shape,
    interrupt::Watch,
    options::{self, Options},
    raise,
    readings::{Arguments, Given, Readings},
    rig::rig as rig_of,
    time::{Clock, seconds},
};

/// Readings between two looks at Python's signals.
const BATCH: usize = 1024;

/// A time as Python has it.
#[derive(Debug, Clone, Copy, PartialEq, IntoPyObject)]
pub enum Time {
    /// Seconds.
    Seconds(f64),
    /// Nanoseconds.
    Nanoseconds(i64),
}

/// One echo: a point on one arc, with how it was found.
///
/// Attributes as the fields of :func:`fuse`. Never changed; two echoes are equal where all of their fields are.
///
/// Examples
/// --------
/// >>> import atm
/// >>> fuser = atm.Fuser(atm.Rig.ring(count=1, radius=0.0, range_resolution=0.01), emit="latest")
/// >>> fuser.push(0.0, "0", 2.0, 0.0, 0.0, 0.0)
/// [Echo(t=0.0, sensor='0', x=2.0, y=0.0, kind='center', range=2.0, azimuth=0.0, crossings=0, resolution=0.7853981633974483, significance=1.0)]
#[pyclass(frozen, module = "atm", name = "Echo")]
#[derive(Debug)]
pub struct PyEcho {
    echo: Echo<f64>,
    clock: Clock,
    rig: Arc<Rig>,
}

#[pymethods]
impl PyEcho {
    /// The reading's own time: float seconds or int nanoseconds, as it was given.
    #[getter]
    fn t(&self) -> Time {
        match self.clock {
            Clock::Seconds => Time::Seconds(seconds(self.echo.t)),
            Clock::Nanoseconds => Time::Nanoseconds(self.echo.t),
        }
    }

    /// The sensor's id.
    #[getter]
    fn sensor(&self) -> &str {
        self.rig.sensors().get(usize::from(self.echo.sensor)).map_or("", |sensor| sensor.id())
    }

    /// Where it is in the fixed frame, in metres.
    #[getter]
    fn x(&self) -> f64 {
        self.echo.position.x
    }

    /// Where it is in the fixed frame, in metres.
    #[getter]
    fn y(&self) -> f64 {
        self.echo.position.y
    }

    /// How it was found: "median", "single", "center", "near" or "pair".
    #[getter]
    fn kind(&self) -> &'static str {
        self.echo.kind.name()
    }

    /// The reading, in metres.
    #[getter]
    fn range(&self) -> f64 {
        self.echo.range
    }

    /// Its direction from the boresight, in radians, within half the beam (Sec. III-B).
    #[getter]
    fn azimuth(&self) -> f64 {
        self.echo.azimuth()
    }

    /// Transversal crossings on its arc.
    #[getter]
    fn crossings(&self) -> u32 {
        self.echo.crossings
    }

    /// Length along the arc in which it lies, in metres (Sec. IV-B).
    #[getter]
    fn resolution(&self) -> f64 {
        self.echo.resolution
    }

    /// Equation (1): the chance that its crossings fell there by accident; 1 for center and near.
    #[getter]
    fn significance(&self) -> f64 {
        self.echo.significance()
    }

    fn __repr__(&self) -> String {
        let t = match self.t() {
            Time::Seconds(t) => format!("{t:?}"),
            Time::Nanoseconds(t) => t.to_string(),
        };
        format!(
            "Echo(t={t}, sensor='{}', x={:?}, y={:?}, kind='{}', range={:?}, azimuth={:?}, crossings={}, resolution={:?}, \
             significance={:?})",
            self.sensor(),
            self.x(),
            self.y(),
            self.kind(),
            self.range(),
            self.azimuth(),
            self.crossings(),
            self.resolution(),
            self.significance(),
        )
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.echo == other.echo && self.clock == other.clock && self.sensor() == other.sensor()
    }

    fn __hash__(&self) -> u64 {
        argument::hash(&self.__repr__())
    }
}

/// The library's fuser in either mode.
enum Engine {
    Latest(Fuser<f64, LatestSlots<f64>>),
    Settled(Fuser<f64, SettledSlots<f64>>),
}

impl Engine {
    fn push(
        &mut self,
        reading: &atm::core::Reading<f64>,
        sink: &mut impl Sink<f64, Echo<f64>>,
    ) -> Result<(), Rejected> {
        match self {
            Self::Latest(fuser) => fuser.push(reading, sink),
            Self::Settled(fuser) => fuser.push(reading, sink),
        }
        .map(|_| ())
    }

    fn finish(&mut self, sink: &mut impl Sink<f64, Echo<f64>>) {
        match self {
            Self::Latest(fuser) => fuser.finish(sink),
            Self::Settled(fuser) => fuser.finish(sink),
        }
    }

    fn snapshot(&mut self, sink: &mut impl Sink<f64, Echo<f64>>) {
        match self {
            Self::Latest(fuser) => fuser.snapshot(sink),
            Self::Settled(fuser) => fuser.snapshot(sink),
        }
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
        sink: &mut impl Sink<f64, Echo<f64>>,
    ) -> PyResult<()> {
        for index in span {
            self.row.t = readings.time(index);
            self.row.readings.clear();
            self.row.readings.push(readings.measured(index));
            for reading in pipeline::readings(&self.row, readings.pose(index), sensors) {
                let pushed = self.engine.push(&reading, sink);
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
/// history, min_angle, range_resolution, field_of_view, emit, on_none, on_two, max_age, max_travel, min_step, drop_held
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
/// >>> fuser = atm.Fuser(atm.Rig.builtin("nomad200"), history=10)
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

    fn list<'py>(&self, py: Python<'py>, echoes: Vec<Echo<f64>>, clock: Clock) -> PyResult<Bound<'py, PyList>> {
        let echoes = echoes.into_iter().map(|echo| PyEcho { echo, clock, rig: Arc::clone(&self.rig) });
        PyList::new(py, echoes.map(|echo| Py::new(py, echo)).collect::<PyResult<Vec<_>>>()?)
    }

    /// Takes all readings in, batch by batch, so that Ctrl-C comes through.
    fn take(&self, readings: &Readings<'_>, clock: Clock) -> PyResult<Vec<Echo<f64>>> {
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
            self.lock().take(readings, first..end, &self.sensors, &mut |echo: &Echo<f64>| echoes.push(*echo))?;
            first = end;
        }
        watch.into_result()?;
        Ok(echoes)
    }
}

#[pymethods]
impl PyFuser {
    #[new]
    #[pyo3(signature = (rig, history=10, *, min_angle=None, range_resolution=None, field_of_view=None, emit="settled",
                        on_none="center", on_two="drop", max_age=None, max_travel=None, min_step=None, drop_held=false))]
    #[expect(clippy::too_many_arguments, reason = "the signature is Python's")]
    fn new(
        rig: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = options::history)] history: usize,
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
    ) -> PyResult<Self> {
        let rig = rig_of(rig)?;
        let options = Options {
            history,
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
        };
        let (settings, sensors) = (options.settings()?, options::models(&rig, &options.defaults()?)?);
        let too_large = |error| raise::value("history", error);
        let (estimator, bounds) = (settings.estimator, settings.bounds);
        let engine = match settings.emit {
            Emit::Latest => {
                let storage = LatestSlots::new(sensors.len(), history).map_err(too_large)?;
                Engine::Latest(Fuser::latest(estimator, bounds, storage))
            }
            Emit::Settled => {
                let storage = SettledSlots::new(sensors.len(), history).map_err(too_large)?;
                Engine::Settled(Fuser::settled(estimator, bounds, storage))
            }
        };
        let state = State { engine, latest: None, clock: None, row: Row::default() };
        Ok(Self { rig, sensors, state: Mutex::new(state) })
    }

    /// Takes readings in, and returns the echoes that this settles.
    ///
    /// Parameters
    /// ----------
    /// t, sensor, range_, x, y, yaw, sensor_index
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
    #[pyo3(signature = (t, sensor, range_, x, y, yaw, *, sensor_index=None))]
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
    ) -> PyResult<Bound<'py, PyList>> {
        let given = Given { t, sensor, range: range_, x, y, yaw, sensor_index };
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
            state.engine.finish(&mut |echo: &Echo<f64>| echoes.push(*echo));
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
            state.engine.snapshot(&mut |echo: &Echo<f64>| echoes.push(*echo));
            (echoes, state.clock)
        });
        self.list(py, echoes, clock.unwrap_or(Clock::Seconds))
    }

    fn __repr__(&self) -> String {
        format!("Fuser(rig='{}', {} sensors)", self.rig.name(), self.sensors.len())
    }
}

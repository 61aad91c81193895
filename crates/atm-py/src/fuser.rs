//! `atm.Fuser` and `atm.Echo`: reading by reading.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use atm::{
    core::{Consensus, ConsensusEcho, Echo, Fuser, Rejected, Sink},
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
    options::{self, Choice, Options},
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

/// An echo of either estimator.
#[derive(Debug, Clone, Copy, PartialEq)]
enum AnyEcho {
    Median(Echo<f64>),
    Consensus(ConsensusEcho<f64>),
}

/// Takes the same field of either.
macro_rules! of_either {
    ($echo:expr, $name:ident => $value:expr) => {
        match &$echo {
            AnyEcho::Median($name) => $value,
            AnyEcho::Consensus($name) => $value,
        }
    };
}

impl AnyEcho {
    const fn consensus(&self) -> Option<&ConsensusEcho<f64>> {
        match self {
            Self::Median(_) => None,
            Self::Consensus(echo) => Some(echo),
        }
    }

    fn normal(&self) -> Option<[f64; 2]> {
        self.consensus()?.normal.map(|normal| [normal.x, normal.y])
    }
}

/// One echo: a point on one arc, with how it was found.
///
/// Attributes as the fields of :func:`fuse`; what only the consensus says is None in echoes of the median. Never changed; two echoes are equal where all of their fields are.
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
    echo: AnyEcho,
    clock: Clock,
    rig: Arc<Rig>,
}

#[pymethods]
impl PyEcho {
    /// The reading's own time: float seconds or int nanoseconds, as it was given.
    #[getter]
    fn t(&self) -> Time {
        match self.clock {
            Clock::Seconds => Time::Seconds(seconds(of_either!(self.echo, echo => echo.t))),
            Clock::Nanoseconds => Time::Nanoseconds(of_either!(self.echo, echo => echo.t)),
        }
    }

    /// The sensor's id.
    #[getter]
    fn sensor(&self) -> &str {
        let sensor = of_either!(self.echo, echo => echo.sensor);
        self.rig.sensors().get(usize::from(sensor)).map_or("", |sensor| sensor.id())
    }

    /// Where it is in the fixed frame, in metres.
    #[getter]
    fn x(&self) -> f64 {
        of_either!(self.echo, echo => echo.position.x)
    }

    /// Where it is in the fixed frame, in metres.
    #[getter]
    fn y(&self) -> f64 {
        of_either!(self.echo, echo => echo.position.y)
    }

    /// How it was found: "median", "single", "center", "near" or "pair"; by the consensus "point", "wall" or "center".
    #[getter]
    fn kind(&self) -> &'static str {
        of_either!(self.echo, echo => echo.kind.name())
    }

    /// The reading, in metres.
    #[getter]
    fn range(&self) -> f64 {
        of_either!(self.echo, echo => echo.range)
    }

    /// Its direction from the boresight, in radians, within half the beam (Sec. III-B).
    #[getter]
    fn azimuth(&self) -> f64 {
        of_either!(self.echo, echo => echo.azimuth())
    }

    /// Transversal crossings on its arc; by the consensus the readings that agree with it.
    #[getter]
    fn crossings(&self) -> u32 {
        match &self.echo {
            AnyEcho::Median(echo) => echo.crossings,
            AnyEcho::Consensus(echo) => echo.support,
        }
    }

    /// Length along the arc in which it lies, in metres (Sec. IV-B).
    #[getter]
    fn resolution(&self) -> f64 {
        of_either!(self.echo, echo => echo.resolution)
    }

    /// Equation (1): the chance that its crossings fell there by accident, or 1 less the consensus's confidence; 1 for center and near.
    #[getter]
    fn significance(&self) -> f64 {
        of_either!(self.echo, echo => echo.significance())
    }

    /// Readings that agree with it, by the consensus.
    #[getter]
    fn support(&self) -> Option<u32> {
        self.echo.consensus().map(|echo| echo.support)
    }

    /// Readings that look there and report clearly farther, or nothing, by the consensus.
    #[getter]
    fn against(&self) -> Option<u32> {
        self.echo.consensus().map(|echo| echo.against)
    }

    /// Standard deviation of the azimuth, in radians, by the consensus.
    #[getter]
    fn sigma_azimuth(&self) -> Option<f64> {
        self.echo.consensus().map(|echo| echo.sigma_azimuth)
    }

    /// Standard deviation of the distance from the sensor, in metres, by the consensus.
    #[getter]
    fn sigma_range(&self) -> Option<f64> {
        self.echo.consensus().map(|echo| echo.sigma_range)
    }

    /// A wall's normal, a unit vector towards the sensor; None but for walls.
    #[getter]
    fn normal_x(&self) -> Option<f64> {
        self.echo.normal().map(|[x, _]| x)
    }

    /// A wall's normal, a unit vector towards the sensor; None but for walls.
    #[getter]
    fn normal_y(&self) -> Option<f64> {
        self.echo.normal().map(|[_, y]| y)
    }

    fn __repr__(&self) -> String {
        let t = match self.t() {
            Time::Seconds(t) => format!("{t:?}"),
            Time::Nanoseconds(t) => t.to_string(),
        };
        format!(
            "Echo(t={t}, sensor='{}', x={:?}, y={:?}, kind='{}', range={:?}, azimuth={:?}, crossings={}, resolution={:?}, \
             significance={:?}{})",
            self.sensor(),
            self.x(),
            self.y(),
            self.kind(),
            self.range(),
            self.azimuth(),
            self.crossings(),
            self.resolution(),
            self.significance(),
            self.words_of_the_consensus(),
        )
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.echo == other.echo && self.clock == other.clock && self.sensor() == other.sensor()
    }

    fn __hash__(&self) -> u64 {
        argument::hash(&self.__repr__())
    }
}

impl PyEcho {
    /// What the consensus says besides, for the representation.
    fn words_of_the_consensus(&self) -> String {
        let Some(echo) = self.echo.consensus() else { return String::new() };
        let normal = self.echo.normal().map(|[x, y]| format!(", normal_x={x:?}, normal_y={y:?}")).unwrap_or_default();
        format!(
            ", support={}, against={}, sigma_azimuth={:?}, sigma_range={:?}{normal}",
            echo.support, echo.against, echo.sigma_azimuth, echo.sigma_range
        )
    }
}

/// Echoes as they come.
struct Found<'a>(&'a mut Vec<AnyEcho>);

impl Sink<f64, Echo<f64>> for Found<'_> {
    fn echo(&mut self, echo: &Echo<f64>) {
        self.0.push(AnyEcho::Median(*echo));
    }
}

impl Sink<f64, ConsensusEcho<f64>> for Found<'_> {
    fn echo(&mut self, echo: &ConsensusEcho<f64>) {
        self.0.push(AnyEcho::Consensus(*echo));
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
/// held, estimator, confidence, range_error
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

    fn list<'py>(&self, py: Python<'py>, echoes: Vec<AnyEcho>, clock: Clock) -> PyResult<Bound<'py, PyList>> {
        let echoes = echoes.into_iter().map(|echo| PyEcho { echo, clock, rig: Arc::clone(&self.rig) });
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
    #[pyo3(signature = (rig, history=10, *, min_angle=None, range_resolution=None, field_of_view=None, emit="settled",
                        on_none="center", on_two="drop", max_age=None, max_travel=None, min_step=None, drop_held=false,
                        held=None, estimator="atm", confidence=None, range_error=None))]
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
        #[pyo3(from_py_with = named::held)] held: Option<&str>,
        #[pyo3(from_py_with = named::estimator)] estimator: &str,
        #[pyo3(from_py_with = named::confidence)] confidence: Option<f64>,
        #[pyo3(from_py_with = named::range_error)] range_error: Option<f64>,
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
            held,
            choice: Choice { estimator, confidence, range_error },
        };
        let (settings, sensors) = (options.settings()?, options::models(&rig, &options.defaults()?)?);
        let too_large = |error| raise::value("history", error);
        let (median, bounds, count) = (settings.estimator, settings.bounds, sensors.len());
        let consensus = options.choice.consensus(&median)?;
        let engine = match settings.emit {
            Emit::Latest => {
                let storage = LatestSlots::new(count, history).map_err(too_large)?;
                match consensus {
                    None => Engine::Latest(Fuser::latest(median, bounds, storage)),
                    Some(consensus) => Engine::LatestConsensus(Fuser::latest(consensus, bounds, storage)),
                }
            }
            Emit::Settled => {
                let storage = SettledSlots::new(count, history).map_err(too_large)?;
                match consensus {
                    None => Engine::Settled(Fuser::settled(median, bounds, storage)),
                    Some(consensus) => Engine::SettledConsensus(Fuser::settled(consensus, bounds, storage)),
                }
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

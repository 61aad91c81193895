//! `atm.fuse_file`: from a log to a file, in one pass and bounded memory.

use atm::{
    core::{Beam, Bounds, MinAngle, RangeResolution, TransversalMedian},
    job::{FuseJob, LogJob, McapWishes},
    log::{
        Input,
        csv::EmptyCell,
        format::Format,
        mcap::{Boresight, ClockChoice, write::SchemaKind},
    },
    pipeline::{self, Defaults, SensorModel, Settings},
    summary::{Dropped, Summary},
    track::MotionLimit,
    units::{self, Scale, UnitError},
};
use pyo3::{exceptions::PyValueError, prelude::*, types::PyString};

use crate::{
    argument::{self, named},
    fuse::{warn, warn_of},
    job,
    options::{self, Choice, LocalMap},
    raise,
    rig::rig as rig_of,
};

/// A number in SI units, or a text with its unit, as the command line takes it.
pub fn quantity(
    name: &str,
    value: Option<&Bound<'_, PyAny>>,
    parse: impl Fn(&str) -> Result<f64, UnitError>,
) -> PyResult<Option<f64>> {
    let Some(value) = value else { return Ok(None) };
    match value.cast::<PyString>() {
        Ok(text) => parse(&text.to_string_lossy()).map(Some).map_err(|error| raise::value(name, error)),
        Err(_) => argument::number(name, value).map(Some),
    }
}

/// A time in nanoseconds: a number of seconds, or a text with its unit.
fn duration(name: &str, value: Option<&Bound<'_, PyAny>>) -> PyResult<Option<u64>> {
    let Some(value) = value else { return Ok(None) };
    let wrong = || raise::value(name, format_args!("{} is no time that is not negative", argument::shown(value)));
    let nanoseconds = match value.cast::<PyString>() {
        Ok(text) => units::duration(&text.to_string_lossy()).map_err(|error| raise::value(name, error))?,
        Err(_) => crate::time::nanoseconds(argument::number(name, value)?).ok_or_else(wrong)?,
    };
    u64::try_from(nanoseconds).map(Some).map_err(|_| wrong())
}

/// Topics: a list of texts, or one text with commas.
fn topics(name: &str, topics: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<String>> {
    Ok(topics.map(|topics| argument::words(name, topics)).transpose()?.unwrap_or_default())
}

/// The fastest motion that is believed, in metres a second or as a text with its unit.
fn speed_limit(speed: Option<&Bound<'_, PyAny>>) -> PyResult<MotionLimit> {
    let Some(speed) = quantity("max_speed", speed, units::speed)? else { return Ok(MotionLimit::DEFAULT) };
    MotionLimit::new(speed).ok_or_else(|| raise::value("max_speed", format_args!("{speed} is not positive")))
}

/// The step in which a log writes lengths.
fn length_unit(text: &str) -> PyResult<Scale> {
    let unit = Scale::length(text).map_err(|error| raise::value("range_unit", error))?;
    let is_positive = unit.apply(1.0) > 0.0;
    if is_positive { Ok(unit) } else { Err(raise::value("range_unit", format_args!("{text} is not positive"))) }
}

fn positive(name: &'static str, value: Option<f64>) -> PyResult<Option<f64>> {
    match value {
        Some(number) if !(number > 0.0 && number.is_finite()) => {
            Err(raise::value(name, format_args!("{number} is not positive and finite")))
        }
        value => Ok(value),
    }
}

/// Turns a log into an echo file: what ``atm fuse`` does, in one pass and with memory that does not grow.
///
/// Parameters
/// ----------
/// input : str or os.PathLike
///     The log; "-" is standard input.
/// rig : Rig or str or os.PathLike
///     The sensors: a :class:`Rig`, a built-in rig's name, or a TOML file. A text table needs one; a recording says it itself.
/// poses : str or os.PathLike, optional
///     A trajectory in a second file, CSV ``t,x,y,yaw`` or TUM. None: the log's own poses.
/// output : str or os.PathLike, optional
///     Where the echoes go; "-" is standard output. None: nowhere, the readings are fused and counted. A file appears complete or not
///     at all; what an unfinished run had written stays beside it as ``.partial``.
/// summary : str or os.PathLike, optional
///     Write the counts as JSON, too.
/// crossings : str or os.PathLike, optional
///     Also write every transversal crossing, as CSV.
/// max_gap : float or str, optional
///     A reading without a pose within this time on both sides is dropped and counted. None: 0.5 s, and more where poses come less
///     often and the robot hardly moves in between.
/// max_speed : float or str, optional
///     A reading between poses that move faster is dropped and counted. None: 10 m/s.
/// empty : {"no-echo", "skip"}, optional
///     What an empty range cell is. None: "no-echo" in long tables, "skip" in wide ones.
/// improvement, at : float or str, optional
///     Choose the smallest angle for this gain in resolution at this distance; instead of `min_angle`.
/// fov : float or str, optional
///     Full beam of sensors of which neither rig nor log says it. None: 22.5 degrees.
/// strict : bool
///     The first unusable record ends the run.
/// from_, to : {"csv", "mcap"}, optional
///     Formats, instead of what content and name say.
/// progress : callable, optional
///     Called now and then with the bytes read and the file's length (None where that is not known), and once at the end. What it
///     raises ends the run.
/// schema : {"foxglove", "ros2"}
///     The messages of a recording that is written.
/// passthrough : bool
///     Whether all that the recording holds is copied into the recording that is written.
/// range_topics : iterable of str or str, optional
///     Recordings: topics of readings, also as one text with commas. None: all of sensor_msgs/Range.
/// pose_topic, fixed_frame : str, optional
///     Recordings: where the poses come from and in which frame they are. None: transforms, else odometry, else poses; the frame odom,
///     else the topmost.
/// tf_topics : iterable of str or str, optional
///     Recordings: topics of transforms, each with the static ones of its namespace. None: those of the readings' namespace.
/// scan_topics : iterable of str or str, optional
///     Recordings: topics of sensor_msgs/LaserScan whose beams are a sonar's cones.
/// range_unit : str, optional
///     Recordings: unit of ranges and limits ("cm", "mm"). None: the rig's, else metres.
/// boresight : {"x", "y", "z", "-x", "-y", "-z"}, optional
///     Recordings: axis of their frames along which sensors look. None: x.
/// clock : {"header", "log", "publish"}, optional
///     Recordings: which time of a message counts. None: the stamp in its header.
/// reorder : float or str, optional
///     Recordings: how much later than others a message may come and still be put in order. None: 2 s.
/// max_message : int, optional
///     Recordings: longest message that is read, in bytes. None: 64 MiB.
/// history, max_age, max_travel, min_step, min_angle, range_resolution, emit, on_none, on_two, keep, drop_held, \
/// held, estimator, confidence, range_error, reach, preset
///     As in :func:`fuse`.
///
/// Quantities are SI numbers, or texts with a unit as on the command line: ``min_angle="30deg"``, ``max_travel="5m"``.
///
/// Returns
/// -------
/// dict
///     What was counted: the keys of ``atm fuse --summary``.
///
/// Raises
/// ------
/// OSError
///     A file can't be read or written.
/// ValueError
///     What is in a file is no log, trajectory or rig, or an option is out of its domain; in the command's words.
/// TypeError
///     An argument of the wrong type.
///
/// Warns
/// -----
/// UserWarning
///     Records that could not be used, each cause with its count and first place; and what is likely wrong with the log: the dict's
///     `advice`.
///
/// Examples
/// --------
/// >>> import atm, pathlib, tempfile
/// >>> with tempfile.TemporaryDirectory() as directory:
/// ...     log = pathlib.Path(directory, "drive.csv")
/// ...     _ = log.write_text("t,sensor,range,x,y,yaw\n0,0,2.5,0,0,0\n0.1,0,2.4,0.1,0,0\n")
/// ...     counts = atm.fuse_file(log, rig="nomad200", output=log.with_name("echoes.csv"))
/// >>> counts["readings"], counts["written"]
/// (2, 2)
#[pyfunction]
#[pyo3(signature = (input, *, rig=None, poses=None, output=None, summary=None, crossings=None, max_gap=None, history=None,
                    max_age=None, max_travel=None, min_step=None, empty=None, min_angle=None, improvement=None, at=None,
                    range_resolution=None, fov=None, emit="settled", on_none="center", on_two="drop", keep=None,
                    drop_held=false, strict=false, from_=None, to=None, schema="foxglove", passthrough=false,
                    range_topics=None, pose_topic=None, fixed_frame=None,
                    clock=None, reorder=None, max_message=None, progress=None, held=None, estimator="atm", confidence=None,
                    range_error=None, tf_topics=None, scan_topics=None, max_speed=None, range_unit=None, boresight=None,
                    reach=None, preset=None))]
#[expect(clippy::too_many_arguments, reason = "the signature is Python's")]
pub fn fuse_file<'py>(
    py: Python<'py>,
    input: &Bound<'py, PyAny>,
    rig: Option<&Bound<'py, PyAny>>,
    poses: Option<&Bound<'py, PyAny>>,
    output: Option<&Bound<'py, PyAny>>,
    summary: Option<&Bound<'py, PyAny>>,
    crossings: Option<&Bound<'py, PyAny>>,
    max_gap: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = options::history)] history: Option<usize>,
    max_age: Option<&Bound<'py, PyAny>>,
    max_travel: Option<&Bound<'py, PyAny>>,
    min_step: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = named::empty)] empty: Option<&str>,
    min_angle: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = named::improvement)] improvement: Option<f64>,
    at: Option<&Bound<'py, PyAny>>,
    range_resolution: Option<&Bound<'py, PyAny>>,
    fov: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = named::emit)] emit: &str,
    #[pyo3(from_py_with = named::on_none)] on_none: &str,
    #[pyo3(from_py_with = named::on_two)] on_two: &str,
    keep: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = named::drop_held)] drop_held: bool,
    #[pyo3(from_py_with = named::strict)] strict: bool,
    #[pyo3(from_py_with = named::from_)] from_: Option<&str>,
    #[pyo3(from_py_with = named::to)] to: Option<&str>,
    #[pyo3(from_py_with = named::schema)] schema: &str,
    #[pyo3(from_py_with = named::passthrough)] passthrough: bool,
    range_topics: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = named::pose_topic)] pose_topic: Option<&str>,
    #[pyo3(from_py_with = named::fixed_frame)] fixed_frame: Option<&str>,
    #[pyo3(from_py_with = named::clock)] clock: Option<&str>,
    reorder: Option<&Bound<'py, PyAny>>,
    max_message: Option<&Bound<'py, PyAny>>,
    progress: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = named::held)] held: Option<&str>,
    #[pyo3(from_py_with = named::estimator)] estimator: &str,
    #[pyo3(from_py_with = named::confidence)] confidence: Option<f64>,
    range_error: Option<&Bound<'py, PyAny>>,
    tf_topics: Option<&Bound<'py, PyAny>>,
    scan_topics: Option<&Bound<'py, PyAny>>,
    max_speed: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = named::range_unit)] range_unit: Option<&str>,
    #[pyo3(from_py_with = named::boresight)] boresight: Option<&str>,
    reach: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = named::preset)] preset: Option<&str>,
) -> PyResult<Bound<'py, PyAny>> {
    if let Some(progress) = progress.filter(|progress| !progress.is_callable()) {
        return Err(raise::kind("progress", format_args!("expected a callable, found {}", argument::shown(progress))));
    }
    let path = |name, value: Option<&Bound<'_, PyAny>>| value.map(|value| argument::path(name, value)).transpose();
    let formats = [("csv", Format::Csv), ("mcap", Format::Mcap)];
    let length = |name, value| quantity(name, value, units::length);
    let beam = quantity("fov", fov, units::angle)?.map(Beam::new).transpose();
    let step = length("range_resolution", range_resolution)?.map(RangeResolution::new).transpose();
    let defaults = Defaults {
        field_of_view: beam.map_err(|error| raise::value("fov", error))?,
        range_resolution: step.map_err(|error| raise::value("range_resolution", error))?,
    };
    let empties = [("no-echo", EmptyCell::NoEcho), ("skip", EmptyCell::Skip)];
    let schemas = [("foxglove", SchemaKind::Foxglove), ("ros2", SchemaKind::Ros2)];
    let clocks = [("header", ClockChoice::Header), ("log", ClockChoice::Log), ("publish", ClockChoice::Publish)];
    let axes = [
        ("x", Boresight::X),
        ("y", Boresight::Y),
        ("z", Boresight::Z),
        ("-x", Boresight::MinusX),
        ("-y", Boresight::MinusY),
        ("-z", Boresight::MinusZ),
    ];
    let mut job = FuseJob {
        log: LogJob {
            input: argument::path("input", input)?,
            parts: Vec::new(),
            opens: Input::open,
            from: from_.map(|word| argument::choice("from_", word, &formats)).transpose()?,
            rig: rig.map(rig_of).transpose()?,
            poses: path("poses", poses)?,
            max_gap: duration("max_gap", max_gap)?,
            max_speed: speed_limit(max_speed)?,
            empty: empty.map(|word| argument::choice("empty", word, &empties)).transpose()?,
            defaults,
            mcap: McapWishes {
                range_topics: topics("range_topics", range_topics)?,
                pose_topic: pose_topic.map(str::to_owned),
                tf_topics: topics("tf_topics", tf_topics)?,
                scan_topics: topics("scan_topics", scan_topics)?,
                fixed_frame: fixed_frame.map(str::to_owned),
                clock: clock.map(|word| argument::choice("clock", word, &clocks)).transpose()?,
                reorder: duration("reorder", reorder)?,
                max_message: max_message
                    .map(|bytes| argument::whole("max_message", bytes))
                    .transpose()?
                    .map(|bytes| bytes as u64),
                range_unit: range_unit.map(length_unit).transpose()?,
                boresight: boresight.map(|word| argument::choice("boresight", word, &axes)).transpose()?,
            },
        },
        rig_file: rig.and_then(|rig| argument::path("rig", rig).ok()),
        output: path("output", output)?,
        to: to.map(|word| argument::choice("to", word, &formats)).transpose()?,
        crossings: path("crossings", crossings)?,
        summary: path("summary", summary)?,
        keep: None,
        schema: argument::choice("schema", schema, &schemas)?,
        passthrough,
    };
    let sensors = job.log.models().map_err(|error| raise::library(&error))?;
    let chosen = Angle {
        min_angle: quantity("min_angle", min_angle, units::angle)?,
        improvement: positive("improvement", improvement)?,
        at: positive("at", length("at", at)?)?,
    };
    let max_age = duration("max_age", max_age)?;
    if max_age == Some(0) {
        return Err(raise::value("max_age", "0 is not positive"));
    }
    let choice = Choice { estimator, confidence, range_error: length("range_error", range_error)? };
    let settings = Settings {
        emit: options::emit(emit)?,
        history: LocalMap { history, reach: length("reach", reach)?, preset }.history()?,
        bounds: options::bounded(
            Bounds::NONE.with_held(options::held(held, drop_held)?),
            max_age,
            length("max_travel", max_travel)?,
            length("min_step", min_step)?,
        )?,
        estimator: choice.estimator(TransversalMedian {
            min_angle: chosen.resolve(&sensors)?,
            on_none: options::on_none(on_none)?,
            on_two: options::on_two(on_two)?,
        })?,
        strict,
    };
    job.keep = options::keep(keep, &settings.estimator)?;
    job.check(&settings).map_err(|error| raise::library(&error))?;
    let progress = progress.map(|progress| progress.clone().unbind());
    let summary = job::run(py, &job, &settings, progress.as_ref())?;
    told(py, &summary)
}

/// How the smallest crossing angle is chosen.
struct Angle {
    min_angle: Option<f64>,
    improvement: Option<f64>,
    at: Option<f64>,
}

impl Angle {
    fn resolve(&self, sensors: &[SensorModel]) -> PyResult<MinAngle<f64>> {
        match (self.min_angle, self.improvement, self.at) {
            (Some(radians), None, None) => MinAngle::new(radians).map_err(|error| raise::value("min_angle", error)),
            (None, Some(improvement), Some(at)) => {
                pipeline::min_angle_for(improvement, at, sensors).map_err(|error| raise::value("improvement", error))
            }
            (None, None, None) => Ok(MinAngle::PAPER),
            (None, ..) => Err(PyValueError::new_err("improvement and at go together")),
            _ => Err(PyValueError::new_err("min_angle goes without improvement and at")),
        }
    }
}

/// Each cause of unusable records, with its count and where it first happened.
fn unusable(dropped: &Dropped) -> Option<String> {
    let causes = dropped.iter().map(|(reason, count, first)| {
        let byte = if first.place.line > 0 { format!(" (byte {})", first.place.byte) } else { String::new() };
        format!("\n  {count} {}, first at {}{byte}: {}", reason.key(), first.place, first.value)
    });
    let causes: String = causes.collect();
    (!causes.is_empty()).then(|| format!("unusable  {} records{causes}", dropped.total()))
}

/// The counts as a dict; what deserves a word is warned of.
fn told<'py>(py: Python<'py>, summary: &Summary) -> PyResult<Bound<'py, PyAny>> {
    if let Some(unusable) = unusable(&summary.dropped) {
        warn(py, &unusable)?;
    }
    warn_of(py, &summary.advice)?;
    let text = serde_json::to_string(summary).map_err(|error| PyValueError::new_err(error.to_string()))?;
    py.import("json")?.call_method1("loads", (text,))
}

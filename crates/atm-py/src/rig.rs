//! `atm.Sensor` and `atm.Rig`.

use std::{path::PathBuf, sync::Arc};

use atm::{
    core::{Isometry2, UnitComplex, Vector2},
    rig::{Ranging, Rig, Sensor},
};
use pyo3::{exceptions::PyIndexError, prelude::*, types::PyTuple};

use crate::{
    argument::{self, named},
    raise,
};

/// One range sensor of a robot: where it sits, what it sees.
///
/// Parameters
/// ----------
/// id : str
///     The name by which logs and echoes call it; not empty.
/// x, y : float
///     Where it sits in the robot's frame (x forwards, y to the left), in metres.
/// yaw : float
///     Where it looks, in radians, counter-clockwise from the robot's x axis.
/// field_of_view : float, optional
///     The FULL angle of its beam, in radians, in (0, pi]. None: the one given when fusing, else 22.5 degrees.
/// min_range, max_range : float
///     A reading r, in metres, is an echo where ``min_range <= r < max_range``: one at the maximum is none.
/// range_resolution : float, optional
///     The step in which it quantises ranges, in metres. None: the one given when fusing, else 1 inch.
/// topic : str, optional
///     The log topic or frame id of the sensor, where that is not its id.
///
/// Raises
/// ------
/// ValueError
///     A value out of its domain; the message names the sensor and the value.
///
/// Examples
/// --------
/// >>> import atm, math
/// >>> left = atm.Sensor("left", x=0.10, y=0.05, yaw=math.pi / 2, max_range=4.0)
/// >>> left.id, left.max_range
/// ('left', 4.0)
#[pyclass(frozen, module = "atm", name = "Sensor")]
#[derive(Debug)]
pub struct PySensor(Sensor);

#[pymethods]
impl PySensor {
    #[new]
    #[pyo3(signature = (id, x=0.0, y=0.0, yaw=0.0, *, field_of_view=None, min_range=0.0, max_range=f64::INFINITY,
                        range_resolution=None, topic=None))]
    #[expect(clippy::too_many_arguments, reason = "the signature is Python's")]
    fn new(
        #[pyo3(from_py_with = named::id)] id: &str,
        #[pyo3(from_py_with = named::x)] x: f64,
        #[pyo3(from_py_with = named::y)] y: f64,
        #[pyo3(from_py_with = named::yaw)] yaw: f64,
        #[pyo3(from_py_with = named::field_of_view)] field_of_view: Option<f64>,
        #[pyo3(from_py_with = named::min_range)] min_range: f64,
        #[pyo3(from_py_with = named::max_range)] max_range: f64,
        #[pyo3(from_py_with = named::range_resolution)] range_resolution: Option<f64>,
        #[pyo3(from_py_with = named::topic)] topic: Option<&str>,
    ) -> PyResult<Self> {
        let ranging = Ranging { field_of_view, min_range, max_range, range_resolution };
        restored(id.to_owned(), [x, y, libm::cos(yaw), libm::sin(yaw)], ranging, topic.map(str::to_owned)).map(Self)
    }

    /// The name by which logs and echoes call it.
    #[getter]
    fn id(&self) -> &str {
        self.0.id()
    }

    /// Where it sits in the robot's frame: forwards, in metres.
    #[getter]
    fn x(&self) -> f64 {
        self.0.mount().translation.vector.x
    }

    /// Where it sits in the robot's frame: to the left, in metres.
    #[getter]
    fn y(&self) -> f64 {
        self.0.mount().translation.vector.y
    }

    /// Where it looks, in radians, within [-pi, pi].
    #[getter]
    fn yaw(&self) -> f64 {
        let boresight = self.0.mount().rotation;
        libm::atan2(boresight.im, boresight.re)
    }

    /// The full angle of its beam, in radians; None where it is not known.
    #[getter]
    fn field_of_view(&self) -> Option<f64> {
        self.0.field_of_view()
    }

    /// The smallest reading that is an echo, in metres.
    #[getter]
    fn min_range(&self) -> f64 {
        self.0.min_range()
    }

    /// From here on a reading is no echo, in metres; may be inf.
    #[getter]
    fn max_range(&self) -> f64 {
        self.0.max_range()
    }

    /// The step of its ranges, in metres; None where it is not known.
    #[getter]
    fn range_resolution(&self) -> Option<f64> {
        self.0.range_resolution()
    }

    /// Its log topic or frame id, where that is not its id.
    #[getter]
    fn topic(&self) -> Option<&str> {
        self.0.topic()
    }

    fn __repr__(&self) -> String {
        format!("Sensor({:?}, x={:?}, y={:?}, yaw={:?})", self.id(), self.x(), self.y(), self.yaw())
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.0 == other.0
    }

    fn __hash__(&self) -> u64 {
        argument::hash(self.0.id())
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Parts)> {
        Ok((restorer(slf.py(), "_restore_sensor")?, parts(&slf.get().0)))
    }
}

/// All of a sensor, for pickling: id, mount (x, y, cos, sin; without a direction where it is open), field of view, limits, range resolution, topic.
type Parts = (String, [f64; 4], Option<f64>, f64, f64, Option<f64>, Option<String>);

fn parts(sensor: &Sensor) -> Parts {
    let (mount, ranging) = (sensor.mount(), sensor.ranging());
    let (position, boresight) = (mount.translation.vector, mount.rotation);
    let [re, im] = if sensor.has_mount() { [boresight.re, boresight.im] } else { [0.0, 0.0] };
    (
        sensor.id().to_owned(),
        [position.x, position.y, re, im],
        ranging.field_of_view,
        ranging.min_range,
        ranging.max_range,
        ranging.range_resolution,
        sensor.topic().map(str::to_owned),
    )
}

fn restored(id: String, mount: [f64; 4], ranging: Ranging, topic: Option<String>) -> PyResult<Sensor> {
    let is_open = matches!(mount, [.., 0.0, 0.0]);
    let [x, y, cos, sin] = if is_open { [0.0, 0.0, 1.0, 0.0] } else { mount };
    let mount = Isometry2::from_parts(Vector2::new(x, y).into(), UnitComplex::from_cos_sin_unchecked(cos, sin));
    let sensor = Sensor::new(id, mount, ranging).map_err(|error| raise::library(&error))?;
    let sensor = if is_open { sensor.with_open_mount() } else { sensor };
    Ok(match topic {
        Some(topic) => sensor.with_topic(topic),
        None => sensor,
    })
}

fn restorer<'py>(py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("atm._atm")?.getattr(name)
}

/// Makes a sensor of its parts, bit by bit: what pickle calls.
#[pyfunction]
pub fn _restore_sensor(
    id: String,
    mount: [f64; 4],
    field_of_view: Option<f64>,
    min_range: f64,
    max_range: f64,
    range_resolution: Option<f64>,
    topic: Option<String>,
) -> PyResult<PySensor> {
    restored(id, mount, Ranging { field_of_view, min_range, max_range, range_resolution }, topic).map(PySensor)
}

/// Makes a rig of its parts: what pickle calls. A rig from TOML is its text and what errors call it, a built-in one its name.
#[pyfunction]
pub fn _restore_rig(name: String, sensors: Vec<Parts>, toml: Option<(String, String)>) -> PyResult<PyRig> {
    if let Some((text, file)) = toml {
        return PyRig::parsed(&text, &file);
    }
    if sensors.is_empty() {
        return PyRig::builtin(&name);
    }
    let sensors =
        sensors.into_iter().map(|(id, mount, field_of_view, min_range, max_range, range_resolution, topic)| {
            restored(id, mount, Ranging { field_of_view, min_range, max_range, range_resolution }, topic)
        });
    PyRig::made(Rig::new(name, sensors.collect::<PyResult<_>>()?))
}

/// The range sensors of a robot. Made by :meth:`ring`, :meth:`from_sensors`, :meth:`from_toml`, :meth:`builtin` or
/// :meth:`load`; never changed afterwards.
///
/// ``len(rig)`` is the number of its sensors. Rigs can be pickled.
///
/// Examples
/// --------
/// >>> import atm
/// >>> rig = atm.Rig.ring(count=4, radius=0.2)
/// >>> rig.ids
/// ('0', '1', '2', '3')
/// >>> len(atm.Rig.builtin("nomad200"))
/// 16
#[pyclass(frozen, module = "atm", name = "Rig")]
#[derive(Debug)]
pub struct PyRig {
    rig: Arc<Rig>,
    /// The text it was read from, and what errors call that.
    toml: Option<(String, String)>,
    /// Whether its name is all there is to know.
    builtin: bool,
}

impl PyRig {
    /// The library's rig.
    pub fn shared(&self) -> Arc<Rig> {
        Arc::clone(&self.rig)
    }

    fn made(rig: atm::error::Result<Rig>) -> PyResult<Self> {
        rig.map(|rig| Self { rig: Arc::new(rig), toml: None, builtin: false }).map_err(|error| raise::library(&error))
    }

    fn parsed(text: &str, file: &str) -> PyResult<Self> {
        let made = Self::made(Rig::parse(text, file))?;
        Ok(Self { toml: Some((text.to_owned(), file.to_owned())), ..made })
    }

    /// The built-in rig of this name, or the one in this file.
    fn loaded(name_or_path: &str) -> PyResult<Self> {
        if Rig::builtin(name_or_path).is_some() {
            return Self::builtin(name_or_path);
        }
        let made = Self::made(Rig::load(name_or_path))?;
        // The text is kept for pickling: the file may not be there where the rig is unpacked. A pipe can't be read twice.
        let again = std::fs::metadata(name_or_path).is_ok_and(|metadata| metadata.is_file());
        let text = again.then(|| std::fs::read_to_string(name_or_path).ok()).flatten();
        Ok(Self { toml: text.map(|text| (text, name_or_path.to_owned())), ..made })
    }
}

#[pymethods]
impl PyRig {
    /// Sensors evenly on a circle, looking outwards, counter-clockwise, with the ids "0", "1", ...
    ///
    /// Parameters
    /// ----------
    /// count : int
    ///     How many, 1 to 65535.
    /// radius : float
    ///     Of the circle, in metres, not negative.
    /// first_yaw : float
    ///     Where sensor "0" looks, in radians, counter-clockwise from the robot's x axis.
    /// field_of_view, min_range, max_range, range_resolution : float
    ///     Of every sensor, as in :class:`Sensor`.
    ///
    /// Returns
    /// -------
    /// Rig
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     A value out of its domain, by name.
    ///
    /// Examples
    /// --------
    /// >>> import atm, math
    /// >>> atm.Rig.ring(count=16, radius=0.2286, field_of_view=math.radians(22.5))
    /// Rig('ring', 16 sensors)
    #[staticmethod]
    #[pyo3(signature = (count, radius, first_yaw=0.0, field_of_view=None, min_range=0.0, max_range=f64::INFINITY,
                        range_resolution=None))]
    fn ring(
        #[pyo3(from_py_with = count)] count: usize,
        #[pyo3(from_py_with = named::radius)] radius: f64,
        #[pyo3(from_py_with = named::first_yaw)] first_yaw: f64,
        #[pyo3(from_py_with = named::field_of_view)] field_of_view: Option<f64>,
        #[pyo3(from_py_with = named::min_range)] min_range: f64,
        #[pyo3(from_py_with = named::max_range)] max_range: f64,
        #[pyo3(from_py_with = named::range_resolution)] range_resolution: Option<f64>,
    ) -> PyResult<Self> {
        let ranging = Ranging { field_of_view, min_range, max_range, range_resolution };
        Self::made(Rig::ring(count, radius, first_yaw, ranging))
    }

    /// The given sensors, in this order.
    ///
    /// Parameters
    /// ----------
    /// sensors : iterable of Sensor
    ///     1 to 65535, no two with one id.
    /// name : str
    ///     The rig's name.
    ///
    /// Returns
    /// -------
    /// Rig
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     No sensors, too many, or two with one id.
    /// TypeError
    ///     Something that is no Sensor, by its index.
    ///
    /// Examples
    /// --------
    /// >>> import atm
    /// >>> atm.Rig.from_sensors([atm.Sensor("left", y=0.1), atm.Sensor("right", y=-0.1)], name="pair").ids
    /// ('left', 'right')
    #[staticmethod]
    #[pyo3(signature = (sensors, name="rig"))]
    fn from_sensors(sensors: &Bound<'_, PyAny>, #[pyo3(from_py_with = named::name)] name: &str) -> PyResult<Self> {
        let mut list = Vec::new();
        for (index, item) in sensors.try_iter()?.enumerate() {
            let item = item?;
            let sensor = item.cast::<PySensor>().map_err(|_| {
                raise::kind(
                    &format!("sensors[{index}]"),
                    format_args!("expected a Sensor, found {}", argument::shown(&item)),
                )
            })?;
            list.push(sensor.get().0.clone());
        }
        Self::made(Rig::new(name, list))
    }

    /// The rig a TOML file or text describes.
    ///
    /// Parameters
    /// ----------
    /// source : str or os.PathLike
    ///     A path; or the text itself, which a str is taken for where it has a line's end or an equals sign.
    ///
    /// Returns
    /// -------
    /// Rig
    ///
    /// Raises
    /// ------
    /// OSError
    ///     The file can't be read.
    /// ValueError
    ///     What is in it is no rig: with file, line, key and value.
    ///
    /// Examples
    /// --------
    /// >>> import atm
    /// >>> atm.Rig.from_toml('name = "bumper"\n[[sensor]]\nid = "front"\nx = "20cm"')
    /// Rig('bumper', 1 sensor)
    #[staticmethod]
    fn from_toml(source: &Bound<'_, PyAny>) -> PyResult<Self> {
        match source.extract::<String>() {
            Ok(text) if text.contains(['\n', '=']) => Self::parsed(&text, "rig"),
            _ => {
                let path = argument::path("source", source)?;
                // A built-in rig's name is a file here.
                Self::loaded(&if Rig::builtin(&path).is_some() { format!("./{path}") } else { path })
            }
        }
    }

    /// A built-in rig: "nomad200" or "robond8".
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     There is none of this name; the message lists those that are.
    ///
    /// Examples
    /// --------
    /// >>> import atm
    /// >>> atm.Rig.builtin("nomad200")
    /// Rig('nomad200', 16 sensors)
    #[staticmethod]
    fn builtin(#[pyo3(from_py_with = named::name)] name: &str) -> PyResult<Self> {
        let rig = Rig::builtin(name).ok_or_else(|| {
            raise::value("name", format_args!("no built-in rig {name:?}; there are {}", Rig::BUILTIN.join(", ")))
        })?;
        Ok(Self { builtin: true, ..Self::made(Ok(rig))? })
    }

    /// The built-in rig of this name, else the rig in this TOML file: what ``atm fuse --rig`` takes.
    ///
    /// Raises
    /// ------
    /// OSError
    ///     The file can't be read.
    /// ValueError
    ///     What is in it is no rig: with file, line, key and value.
    ///
    /// Examples
    /// --------
    /// >>> import atm
    /// >>> atm.Rig.load("robond8").name
    /// 'robond8'
    #[staticmethod]
    fn load(name_or_path: &Bound<'_, PyAny>) -> PyResult<Self> {
        Self::loaded(&argument::path("name_or_path", name_or_path)?)
    }

    /// The rig's name.
    #[getter]
    fn name(&self) -> &str {
        self.rig.name()
    }

    /// The ids of the sensors, in order.
    #[getter]
    fn ids<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.rig.sensors().iter().map(Sensor::id))
    }

    /// The sensors, in order.
    #[getter]
    fn sensors<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.rig.sensors().iter().map(|sensor| PySensor(sensor.clone())))
    }

    fn __len__(&self) -> usize {
        self.rig.sensors().len()
    }

    fn __getitem__(&self, index: usize) -> PyResult<PySensor> {
        let sensor = self.rig.sensors().get(index).cloned();
        sensor.map(PySensor).ok_or_else(|| PyIndexError::new_err("the rig has fewer sensors"))
    }

    fn __repr__(&self) -> String {
        let count = self.__len__();
        format!("Rig('{}', {count} sensor{})", self.rig.name(), if count == 1 { "" } else { "s" })
    }

    #[expect(clippy::type_complexity, reason = "what pickle wants")]
    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, (String, Vec<Parts>, Option<(String, String)>))> {
        let this = slf.get();
        let parts = if this.builtin { Vec::new() } else { this.rig.sensors().iter().map(parts).collect() };
        Ok((restorer(slf.py(), "_restore_rig")?, (this.rig.name().to_owned(), parts, this.toml.clone())))
    }
}

fn count(value: &Bound<'_, PyAny>) -> PyResult<usize> {
    argument::whole("count", value)
}

/// A rig as an argument: a Rig, or what [`Rig::load`] takes.
pub fn rig(argument: &Bound<'_, PyAny>) -> PyResult<Arc<Rig>> {
    if let Ok(rig) = argument.cast::<PyRig>() {
        return Ok(rig.get().shared());
    }
    if argument.extract::<PathBuf>().is_err() {
        return Err(raise::kind(
            "rig",
            format_args!("expected a Rig, a built-in rig's name or a path, found {}", argument::shown(argument)),
        ));
    }
    Ok(PyRig::loaded(&argument::path("rig", argument)?)?.rig)
}

//! `atm.simulate`: drives through worlds, as arrays.

use atm::{core::Beam, pipeline::Defaults, rig::Rig};
use atm_lab::{
    simulate::{Effects, Simulation},
    world::World,
};
use pyo3::{
    prelude::*,
    types::{PyDict, PyString},
};

use crate::{
    argument::{self, named},
    interrupt::Watch,
    raise,
    rig::rig as rig_of,
    table::{Log, Truths},
    time::Clock,
};

/// A world by its name or file, with parameters: a dict of texts with units, or of numbers in SI units.
pub fn world(name: &Bound<'_, PyAny>, set: Option<&Bound<'_, PyDict>>) -> PyResult<World> {
    let mut parameters = Vec::new();
    for (key, value) in set.into_iter().flatten() {
        let key = argument::word("set", &key)?.to_owned();
        let text = match value.cast::<PyString>() {
            Ok(text) => text.to_string_lossy().into_owned(),
            Err(_) => argument::float(argument::number(&format!("set[{key:?}]"), &value)?),
        };
        parameters.push((key, text));
    }
    World::load(&argument::path("world", name)?, &parameters).map_err(|error| raise::library(&error))
}

/// Drives a robot through a world: its log, and where each echo really came from.
///
/// Parameters
/// ----------
/// world : str or os.PathLike
///     A built-in world ("doorway", "closed-wall", "tee", "pole", "specular-wall", "rough-wall", "diffuse-wall", "corners", "room") or a TOML
///     file.
/// rig : Rig or str or os.PathLike
///     The sensors: a :class:`Rig`, a built-in rig's name, or a TOML file.
/// seed : int
///     Which bumps, noise and outliers are drawn. The same arguments give the same bits on every machine.
/// set : dict, optional
///     Parameters of the world: texts with their unit, ``{"opening": "36in"}``, or numbers in SI units. Speed and rate are among them.
/// noise : str, optional
///     What disturbs the drive, as on the command line: ``"range=1cm,dropout=5%,crosstalk=1%,multipath,odometry=1cm,heading=0.5deg"``.
/// field_of_view : float, optional
///     Full beam, in radians, of sensors of which the rig does not say it. None: 22.5 degrees.
///
/// Returns
/// -------
/// log : numpy.ndarray
///     One row a reading: ``t`` (seconds), ``sensor``, ``range`` (metres; inf where nothing is in reach, -inf where something is too close),
///     ``x``, ``y``, ``yaw`` (where the robot believes to be).
/// truth : numpy.ndarray
///     One row an echo: ``t``, ``sensor``, ``x``, ``y`` (metres, in the world's frame), ``azimuth`` (radians from the boresight), ``cause``.
///
/// Raises
/// ------
/// ValueError
///     No such parameter or noise; a sensor that would be inside or behind a surface.
/// OSError
///     No such world or rig, or its file can't be read.
///
/// Examples
/// --------
/// >>> import atm
/// >>> log, truth = atm.simulate("doorway", set={"opening": "36in"}, seed=1)
/// >>> echoes = atm.fuse(*(log[name] for name in log.dtype.names), rig="nomad200")
/// >>> len(log), truth["cause"][0] in ("wall", "corner", "scatterer")
/// (784, True)
#[pyfunction]
#[pyo3(signature = (world, *, rig=None, seed=1, set=None, noise=None, field_of_view=None))]
pub fn simulate<'py>(
    py: Python<'py>,
    world: &Bound<'py, PyAny>,
    rig: Option<&Bound<'py, PyAny>>,
    seed: u64,
    set: Option<&Bound<'py, PyDict>>,
    noise: Option<&str>,
    #[pyo3(from_py_with = named::field_of_view)] field_of_view: Option<f64>,
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
    let world = self::world(world, set)?;
    let rig = match rig {
        Some(rig) => Rig::clone(&*rig_of(rig)?),
        None => Rig::load("nomad200").map_err(|error| raise::library(&error))?,
    };
    let beam = Beam::new(field_of_view.unwrap_or(Defaults::FIELD_OF_VIEW));
    let beam = beam.map_err(|error| raise::value("field_of_view", error))?;
    let effects: Effects = match noise {
        None | Some("") => Effects::default(),
        Some(text) => text.parse().map_err(|error: atm::error::Error| raise::value("noise", error))?,
    };
    let mut watch = Watch::new();
    let (log, truths) = py.detach(|| {
        let simulation = Simulation::new(world, rig, beam.field_of_view(), effects, seed);
        let mut tables = (Log::new(simulation.rig(), Clock::Seconds), Truths::new(simulation.rig(), Clock::Seconds));
        for sweep in simulation.sweeps() {
            if watch.is_over(|_| Ok(())) {
                break;
            }
            let sweep = sweep.map_err(|error| raise::library(&error))?;
            tables.0.sweep(&sweep);
            for ((sensor, _), truth) in sweep.readings.iter().zip(&sweep.truth) {
                if let Some(point) = truth {
                    tables.1.point(sweep.t, *sensor, point);
                }
            }
        }
        Ok::<_, PyErr>(tables)
    })?;
    watch.into_result()?;
    Ok((log.into_array(py)?, truths.into_array(py)?))
}

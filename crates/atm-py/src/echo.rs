//! `atm.Echo`: one echo.

use std::sync::Arc;

use atm::{echo::AnyEcho, rig::Rig};
use pyo3::prelude::*;

use crate::{
    argument,
    time::{Clock, seconds},
};

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
            Clock::Seconds => Time::Seconds(seconds(self.echo.t())),
            Clock::Nanoseconds => Time::Nanoseconds(self.echo.t()),
        }
    }

    /// The sensor's id.
    #[getter]
    fn sensor(&self) -> &str {
        let sensor = self.echo.usual().sensor;
        self.rig.sensors().get(usize::from(sensor)).map_or("", |sensor| sensor.id())
    }

    /// Where it is in the fixed frame, in metres.
    #[getter]
    fn x(&self) -> f64 {
        self.echo.position().x
    }

    /// Where it is in the fixed frame, in metres.
    #[getter]
    fn y(&self) -> f64 {
        self.echo.position().y
    }

    /// How it was found: "median", "single", "center", "near" or "pair"; by the consensus "point", "wall" or "center".
    #[getter]
    fn kind(&self) -> &'static str {
        self.echo.kind()
    }

    /// The reading, in metres.
    #[getter]
    fn range(&self) -> f64 {
        self.echo.usual().range
    }

    /// Its direction from the boresight, in radians, within half the beam (Sec. III-B).
    #[getter]
    fn azimuth(&self) -> f64 {
        self.echo.usual().azimuth
    }

    /// Transversal crossings on its arc; by the consensus the readings that agree with it.
    #[getter]
    fn crossings(&self) -> u32 {
        self.echo.usual().crossings
    }

    /// Length along the arc in which it lies, in metres (Sec. IV-B).
    #[getter]
    fn resolution(&self) -> f64 {
        self.echo.usual().resolution
    }

    /// Equation (1): the chance that its crossings fell there by accident, or 1 less the consensus's confidence; 1 for center and near.
    #[getter]
    fn significance(&self) -> f64 {
        self.echo.usual().significance
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
        self.normal().map(|[x, _]| x)
    }

    /// A wall's normal, a unit vector towards the sensor; None but for walls.
    #[getter]
    fn normal_y(&self) -> Option<f64> {
        self.normal().map(|[_, y]| y)
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
    /// The echo of a reading of one of the rig's sensors, with times as this clock has them.
    pub const fn new(echo: AnyEcho, clock: Clock, rig: Arc<Rig>) -> Self {
        Self { echo, clock, rig }
    }

    fn normal(&self) -> Option<[f64; 2]> {
        self.echo.consensus()?.normal.map(|normal| [normal.x, normal.y])
    }

    /// What the consensus says besides, for the representation.
    fn words_of_the_consensus(&self) -> String {
        let Some(echo) = self.echo.consensus() else { return String::new() };
        let normal = self.normal().map(|[x, y]| format!(", normal_x={x:?}, normal_y={y:?}")).unwrap_or_default();
        format!(
            ", support={}, against={}, sigma_azimuth={:?}, sigma_range={:?}{normal}",
            echo.support, echo.against, echo.sigma_azimuth, echo.sigma_range
        )
    }
}

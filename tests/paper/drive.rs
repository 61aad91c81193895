//! Simulated drives, and what becomes of their readings.

use std::{collections::BTreeMap, f64::consts::PI, sync::Arc};

use atm::{
    core::{
        Arc as RangeArc, ArcCrossing, Bounds, Echo, Fuser, Kind, MinAngle, Point2, Reading, Sink, TransversalMedian,
    },
    echo::AnyEstimator,
    log::Row,
    pipeline::{Defaults, Emit, History, SensorModel, Settings, readings, settled_fuser},
    rig::{Ranging, Rig},
    storage::SettledSlots,
};
use atm_lab::{
    eval::Estimate,
    simulate::{Effects, Simulation},
    truth::{Cause, Truth, TruthPoint},
    world::World,
};

pub const INCH: f64 = 0.0254;
/// Full beam of the Nomad's sensors.
pub const BEAM: f64 = PI / 8.0;
/// H and θmin of the paper (Secs. IV-B and IV-D).
pub const PAPER_HISTORY: usize = 10;
pub const PAPER_ANGLE: f64 = 30.0;

/// A drive of a Nomad 200 through a world, as a log and its truth.
pub struct Drive {
    pub world: World,
    pub sensors: Vec<SensorModel>,
    pub readings: Vec<Reading<f64>>,
    pub truth: Truth,
}

/// What the readings of a drive were fused to.
#[derive(Default)]
pub struct Fused {
    pub echoes: Vec<Echo<f64>>,
    pub crossings: Vec<ArcCrossing<f64>>,
}

impl Drive {
    pub fn new(world: &str, set: &[(&str, &str)], noise: &str, seed: u64) -> Self {
        Self::with_rig(world, set, noise, seed, Rig::builtin("nomad200").unwrap())
    }

    pub fn with_rig(world: &str, set: &[(&str, &str)], noise: &str, seed: u64, rig: Rig) -> Self {
        let set: Vec<_> = set.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        let world = World::load(world, &set).unwrap_or_else(|error| panic!("{error}"));
        let effects = if noise.is_empty() { Effects::default() } else { noise.parse().unwrap() };
        let sensors = Defaults::default().complete(&rig).unwrap();
        let simulation = Simulation::new(world.clone(), rig, BEAM, effects, seed);
        let mut drive = Self { world, sensors, readings: Vec::new(), truth: Truth::default() };
        for sweep in simulation.sweeps() {
            let sweep = sweep.unwrap();
            for ((sensor, _), truth) in sweep.readings.iter().zip(&sweep.truth) {
                if let Some(point) = truth {
                    drive.truth.insert(sweep.t, &sensor.to_string(), *point);
                }
            }
            let row = Row { t: sweep.t, readings: sweep.readings, ..Row::default() };
            drive.readings.extend(readings(&row, sweep.pose, &drive.sensors));
        }
        drive
    }

    /// Where the reading of a sensor at a time came from, if it is an echo.
    pub fn source(&self, t: i64, sensor: u16) -> Option<&TruthPoint> {
        self.truth.get(t, &sensor.to_string())
    }

    /// As the paper fuses.
    pub fn fuse(&self) -> Fused {
        self.fuse_with(PAPER_HISTORY, PAPER_ANGLE)
    }

    /// With another H, and another θmin in degrees.
    pub fn fuse_with(&self, history: usize, degrees: f64) -> Fused {
        let min_angle = MinAngle::new(degrees.to_radians()).unwrap();
        let estimator = TransversalMedian { min_angle, ..TransversalMedian::PAPER };
        let sensors = self.readings.iter().map(|reading| usize::from(reading.sensor) + 1).max().unwrap_or(1);
        let storage = SettledSlots::new(sensors, history).unwrap();
        Fused::by(Fuser::settled(estimator, Bounds::NONE, storage), &self.readings)
    }

    /// As `atm fuse` does without a flag: spaced readings over a travel.
    pub fn fuse_by_travel(&self) -> Fused {
        let settings = Settings {
            emit: Emit::Settled,
            history: History::default(),
            bounds: Bounds::NONE,
            estimator: AnyEstimator::PAPER,
            strict: true,
        };
        Fused::by(settled_fuser(TransversalMedian::PAPER, &settings, &self.sensors).unwrap(), &self.readings)
    }

    /// The centre of every cone.
    pub fn centers(&self) -> Vec<Estimate> {
        let center = |reading: &Reading<f64>| {
            let range = reading.range.echo()?;
            let position = RangeArc::new(&reading.pose, range, &reading.beam).middle();
            Some(estimate(position, reading.t, reading.sensor, 0.0, range, "center"))
        };
        self.readings.iter().filter_map(center).collect()
    }

    /// How far from its reading's true echo point each estimate lies along its arc, in inches.
    pub fn azimuth_errors(&self, estimates: &[Estimate]) -> Vec<f64> {
        let error = |estimate: &Estimate| {
            let (t, sensor) = estimate.key.as_ref()?;
            let truth = self.truth.get(*t, sensor).filter(|truth| truth.cause != Cause::Crosstalk)?;
            Some((estimate.azimuth? - truth.azimuth).abs() * estimate.range? / INCH)
        };
        estimates.iter().filter_map(error).collect()
    }

    /// The same for each crossing by itself.
    pub fn crossing_errors(&self, fused: &Fused) -> Vec<f64> {
        let error = |crossing: &ArcCrossing<f64>| {
            let truth = self.source(crossing.t, crossing.sensor)?;
            let reading =
                self.readings.iter().find(|reading| (reading.t, reading.sensor) == (crossing.t, crossing.sensor));
            Some((crossing.bearing.azimuth() - truth.azimuth).abs() * reading?.range.echo()? / INCH)
        };
        fused.crossings.iter().filter_map(error).collect()
    }
}

impl Fused {
    fn by(mut fuser: Fuser<f64, SettledSlots<f64>>, readings: &[Reading<f64>]) -> Self {
        let mut fused = Self::default();
        for reading in readings {
            fuser.push(reading, &mut fused).unwrap();
        }
        fuser.finish(&mut fused);
        fused
    }

    /// The echoes of these kinds.
    pub fn of(&self, kinds: &[Kind]) -> Vec<Estimate> {
        let echoes = self.echoes.iter().filter(|echo| kinds.contains(&echo.kind));
        let estimate = |echo: &Echo<f64>| {
            estimate(echo.position, echo.t, echo.sensor, echo.azimuth(), echo.range, echo.kind.name())
        };
        echoes.map(estimate).collect()
    }

    pub fn all(&self) -> Vec<Estimate> {
        self.of(&Kind::ALL)
    }

    pub fn medians(&self) -> Vec<Estimate> {
        self.of(&[Kind::Median])
    }

    pub fn crossed(&self) -> Vec<Estimate> {
        self.of(&[Kind::Median, Kind::Single])
    }

    /// The crossings as points of a map.
    pub fn crossing_points(&self) -> Vec<Estimate> {
        let point = |crossing: &ArcCrossing<f64>| Estimate {
            position: crossing.position,
            key: None,
            azimuth: None,
            range: None,
            kind: None,
        };
        self.crossings.iter().map(point).collect()
    }

    /// The crossings on each arc.
    pub fn by_arc(&self) -> BTreeMap<(i64, u16), Vec<&ArcCrossing<f64>>> {
        let mut arcs: BTreeMap<_, Vec<_>> = BTreeMap::new();
        for crossing in &self.crossings {
            arcs.entry((crossing.t, crossing.sensor)).or_default().push(crossing);
        }
        arcs
    }
}

impl Sink<f64, Echo<f64>> for Fused {
    fn echo(&mut self, echo: &Echo<f64>) {
        self.echoes.push(*echo);
    }

    fn wants_crossings(&self) -> bool {
        true
    }

    fn crossing(&mut self, crossing: &ArcCrossing<f64>) {
        self.crossings.push(*crossing);
    }
}

fn estimate(position: Point2<f64>, t: i64, sensor: u16, azimuth: f64, range: f64, kind: &str) -> Estimate {
    let key = Some((t, Arc::from(sensor.to_string())));
    Estimate { position, key, azimuth: Some(azimuth), range: Some(range), kind: Some(Arc::from(kind)) }
}

/// A ring like the Nomad's, of another count of sensors and another reach.
pub fn ring(count: usize, max_range: f64) -> Rig {
    let nomad = Rig::builtin("nomad200").unwrap();
    let first = &nomad.sensors()[0];
    let ranging = Ranging { max_range, ..first.ranging() };
    Rig::ring(count, first.mount().translation.vector.norm(), 0.0, ranging).unwrap()
}

/// The Nomad's ring with twice as many directions, as if the robot turned by half a beam at every place and took its readings
/// once more (Fig. 5).
pub fn interleaved() -> Rig {
    ring(32, 255.0 * INCH)
}

//! Random drives of a small rig, and all that a fuser says of them.

use atm::core::{
    Arrival, Beam, Bounds, Echo, Fuser, Held, Isometry2, Kind, Limits, MinAngle, OnNone, OnTwo, RangeResolution,
    Reading, Rejected, Sink, TransversalMedian, Travel, UnitComplex, Vector2,
};
use atm::storage::SettledSlots;
use proptest::prelude::*;

/// Sensors of the rig.
pub const SENSORS: u16 = 4;

#[derive(Debug, Clone)]
pub struct Drive {
    pub readings: Vec<Reading<f64>>,
    history: usize,
    estimator: TransversalMedian<f64>,
    bounds: Bounds<f64>,
}

/// What is said of one arc.
#[derive(Debug, Clone, PartialEq)]
pub enum Said {
    Echo(Echo<f64>),
    Ignored(u32),
}

/// All that a run says.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Reports {
    pub fates: Vec<Result<Arrival, Rejected>>,
    pub said: Vec<Said>,
}

impl Sink<f64, Echo<f64>> for Reports {
    fn echo(&mut self, echo: &Echo<f64>) {
        self.said.push(Said::Echo(*echo));
    }

    fn ignored(&mut self, crossings: u32) {
        self.said.push(Said::Ignored(crossings));
    }
}

impl Reports {
    pub fn push(&mut self, fuser: &mut Fuser<f64, SettledSlots<f64>>, reading: &Reading<f64>) {
        let fate = fuser.push(reading, self);
        self.fates.push(fate);
    }
}

impl Said {
    pub fn crossings(&self) -> u32 {
        match self {
            Self::Echo(echo) => echo.crossings,
            Self::Ignored(crossings) => *crossings,
        }
    }

    pub fn kind(&self) -> Option<Kind> {
        match self {
            Self::Echo(echo) => Some(echo.kind),
            Self::Ignored(_) => None,
        }
    }
}

impl Drive {
    /// The same settings, with each reading changed.
    pub fn with_each(&self, change: impl Fn(&Reading<f64>) -> Reading<f64>) -> Self {
        Self { readings: self.readings.iter().map(change).collect(), ..self.clone() }
    }

    fn storage(&self) -> SettledSlots<f64> {
        SettledSlots::new(usize::from(SENSORS), self.history).expect("small")
    }

    /// The same drive on a storage that begins with one sensor and grows as more are heard.
    pub fn run_growing(&self, settled: bool) -> Reports {
        let (storage, mut known) = (SettledSlots::new(1, self.history).expect("small"), 1);
        let mut fuser = match settled {
            true => Fuser::settled(self.estimator, self.bounds, storage),
            false => Fuser::latest(self.estimator, self.bounds, storage),
        };
        let mut reports = Reports::default();
        for reading in &self.readings {
            let needed = usize::from(reading.sensor) + 1;
            if needed > known {
                fuser.grow(|storage| storage.grow(needed).expect("small"));
                known = needed;
            }
            reports.push(&mut fuser, reading);
        }
        fuser.finish(&mut reports);
        reports
    }

    pub fn latest(&self) -> Fuser<f64, SettledSlots<f64>> {
        Fuser::latest(self.estimator, self.bounds, self.storage())
    }

    pub fn settled(&self) -> Fuser<f64, SettledSlots<f64>> {
        Fuser::settled(self.estimator, self.bounds, self.storage())
    }

    pub fn run(&self, settled: bool) -> Reports {
        self.run_on(&mut if settled { self.settled() } else { self.latest() })
    }

    pub fn run_on(&self, fuser: &mut Fuser<f64, SettledSlots<f64>>) -> Reports {
        let mut reports = Reports::default();
        for reading in &self.readings {
            reports.push(fuser, reading);
        }
        fuser.finish(&mut reports);
        reports
    }
}

/// One reading before it is placed: sensor, nanoseconds since the last, stride, turn, range.
type Shot = (u16, i64, f64, f64, f64);

/// Any drive of up to 60 readings, with any settings.
pub fn drive() -> impl Strategy<Value = Drive> {
    let stride = prop_oneof![1 => Just(0.0), 3 => 0.0..0.4f64];
    let range = prop_oneof![8 => 0.3..3.0f64, 1 => Just(1.5), 1 => Just(f64::INFINITY), 1 => 0.001..0.02f64];
    let shot = (0..SENSORS, 1..40i64, stride, -0.5..0.5f64, range);
    let angle = prop_oneof![Just(30f64.to_radians()), 0.02..1.57f64];
    let estimator = (
        angle,
        prop_oneof![Just(OnNone::Center), Just(OnNone::Drop)],
        prop_oneof![Just(OnTwo::Drop), Just(OnTwo::Center), Just(OnTwo::Mean)],
    );
    let bounds = (
        prop::option::weighted(0.3, 1..300u64),
        prop::option::weighted(0.3, 0.1..3.0f64),
        prop::option::weighted(0.2, 0.01..0.3f64),
        prop::bool::weighted(0.2),
    );
    (prop::collection::vec(shot, 1..60), 1..8usize, estimator, bounds).prop_map(
        |(shots, history, estimator, bounds)| {
            let (min_angle, on_none, on_two) = estimator;
            let min_angle = MinAngle::new(min_angle).expect("within the domain");
            let estimator = TransversalMedian { min_angle, on_none, on_two };
            Drive { readings: readings(&shots), history, estimator, bounds: bounds_of(bounds) }
        },
    )
}

fn bounds_of((age, travel, step, held): (Option<u64>, Option<f64>, Option<f64>, bool)) -> Bounds<f64> {
    let mut bounds = Bounds::NONE.with_held(if held { Held::Drop } else { Held::Keep });
    if let Some(nanoseconds) = age {
        bounds = bounds.with_max_age(nanoseconds);
    }
    if let Some(metres) = travel {
        bounds = bounds.with_max_travel(Travel::from_metres(metres).expect("within the domain"));
    }
    if let Some(metres) = step {
        bounds = bounds.with_min_step(metres).expect("within the domain");
    }
    bounds
}

fn readings(shots: &[Shot]) -> Vec<Reading<f64>> {
    let (mut t, mut position, mut yaw) = (0, Vector2::zeros(), 0.0);
    let mut readings = Vec::new();
    for &(sensor, pause, stride, turn, range) in shots {
        t += pause;
        yaw += turn;
        position += Vector2::new(libm::cos(yaw), libm::sin(yaw)) * stride;
        let beam_deg = [22.5, 60.0, 120.0, 180.0][usize::from(sensor)];
        let mount = [-1.5, 0.4, 1.5, 2.8][usize::from(sensor)];
        let boresight = yaw + mount;
        let offset = Vector2::new(libm::cos(boresight), libm::sin(boresight)) * 0.2;
        let rotation = UnitComplex::from_cos_sin_unchecked(libm::cos(boresight), libm::sin(boresight));
        readings.push(Reading {
            t,
            sensor,
            range: Limits::NONE.classify(range),
            pose: Isometry2::from_parts((position + offset).into(), rotation),
            robot: position.into(),
            beam: Beam::new(f64::to_radians(beam_deg)).expect("up to half a turn"),
            range_resolution: RangeResolution::new(0.01).expect("positive"),
        });
    }
    readings
}

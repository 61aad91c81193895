//! The same runs on the host: in single precision, which the image must match to the bit, and in double precision.

use std::collections::BTreeMap;

use atm_core::{
    Bounds, Consensus, ConsensusEcho, DomainError, Echo, Estimator, Fuser, LatestArrays, MinAngle, Rejected, Scalar,
    TransversalMedian,
};
use replay::{
    Adversary, Event, Fault, Faults, Fuser32, HISTORY, Line, Log, Outcome, Ring, SENSORS, Store32, WORST_CROSSINGS,
    WORST_SUPPORT, Written, fuse,
};

/// An estimator as an image has it, in single precision, and its like in double.
pub trait Judged: Estimator<f32, Echo: Copy + Told + Written> {
    /// Its like.
    type Double: Estimator<f64, Echo: Copy + Told>;
    /// How many crossings or readings the adversary's worst reading rests on.
    const WORST: u32;
    /// What these are.
    const COUNTED: &'static str;
    /// Both as the image has them.
    fn both() -> (Self, Self::Double)
    where
        Self: Sized;
}

impl Judged for TransversalMedian<f32> {
    type Double = TransversalMedian<f64>;
    const WORST: u32 = WORST_CROSSINGS;
    const COUNTED: &'static str = "crossings, two with every other arc";
    fn both() -> (Self, Self::Double) {
        (Self::PAPER, TransversalMedian::PAPER)
    }
}

impl Judged for Consensus<f32> {
    type Double = Consensus<f64>;
    const WORST: u32 = WORST_SUPPORT;
    const COUNTED: &'static str = "readings that agree with it, every other one";
    fn both() -> (Self, Self::Double) {
        (Self::new(MinAngle::PAPER), Consensus::new(MinAngle::PAPER))
    }
}

/// What is compared of an echo.
pub trait Told {
    /// Its kind, and how many crossings or readings it rests on.
    fn sort(&self) -> (&'static str, u32);
    /// Position and bearing.
    fn numbers(&self) -> [f64; 4];
}

impl<T: Scalar + Into<f64>> Told for Echo<T> {
    fn sort(&self) -> (&'static str, u32) {
        (self.kind.name(), self.crossings)
    }
    fn numbers(&self) -> [f64; 4] {
        [self.position.x, self.position.y, self.bearing.sin(), self.bearing.cos()].map(Into::into)
    }
}

impl<T: Scalar + Into<f64>> Told for ConsensusEcho<T> {
    fn sort(&self) -> (&'static str, u32) {
        (self.kind.name(), self.support)
    }
    fn numbers(&self) -> [f64; 4] {
        [self.position.x, self.position.y, self.bearing.sin(), self.bearing.cos()].map(Into::into)
    }
}

/// What the host made of the runs.
pub struct Reference {
    /// What the image has to print, figures aside.
    pub lines: Vec<String>,
    /// Most crossings, or agreeing readings, on an arc of the adversary's.
    pub worst: u32,
    /// What was inflicted, by number of [`Fault::ALL`], and what was refused for it.
    pub faults: Tally,
    /// Single against double precision, over the recorded log.
    pub precision: Precision,
}

/// Faults, and what became of them.
#[derive(Default)]
pub struct Tally {
    /// Readings of each kind, in the order of [`Fault::ALL`].
    pub inflicted: [u32; Fault::ALL.len()],
    /// Readings that were refused, by reason.
    pub refused: BTreeMap<&'static str, u32>,
    /// Readings that arrived.
    pub arrived: u32,
    /// Echoes that were reported.
    pub echoes: u32,
    /// Echoes whose place or bearing is not finite.
    pub wild_echoes: u32,
}

/// Single against double precision.
#[derive(Default)]
pub struct Precision {
    /// Readings of the log.
    pub readings: u32,
    /// Echoes that were compared.
    pub echoes: u32,
    /// Readings whose kind or count differs.
    pub unlike: u32,
    /// The largest distance between two echoes of one reading, in metres.
    pub distance: f64,
}

struct Runs<E> {
    fuser: Fuser32<E>,
    lines: Vec<String>,
}

impl<E: Judged> Runs<E> {
    fn run(
        &mut self,
        run: &str,
        ring: &Ring<f32>,
        mut event: impl FnMut(u32) -> Option<Event<f32>>,
        mut seen: impl FnMut(&Event<f32>, &Outcome<E::Echo>),
    ) {
        let mut outcome = Outcome::NONE;
        for index in 0.. {
            let Some(event) = event(index) else { break };
            fuse(&mut self.fuser, ring, &event, &mut outcome);
            seen(&event, &outcome);
            self.lines.push(String::from_utf8_lossy(Line::of(run, index, &outcome).finished()).trim_end().to_owned());
        }
        self.fuser.finish(&mut |_: &E::Echo| {});
    }
}

/// Runs it all on the host.
pub fn run<E: Judged>(log: &Log<'_>) -> Result<Reference, DomainError> {
    let (single, double) = E::both();
    let mut runs = Runs { fuser: Fuser::latest(single, Bounds::NONE, Store32::new()), lines: Vec::new() };
    let mut precision = DoublePrecision::new(double)?;
    runs.fuser.set_span(Some(replay::span()?));
    runs.run(
        "log",
        &Ring::<f32>::nomad200()?,
        |index| log.event(index),
        |event, outcome| precision.compare(event, outcome),
    );
    let boundless = Ring::boundless()?;
    let (mut adversary, mut worst) = (Adversary::new(), 0);
    runs.fuser.set_span(None);
    runs.run(
        "adversary",
        &boundless,
        |index| adversary.event(&boundless, index),
        |_, outcome| worst = worst.max(outcome.echo.map_or(0, |echo| echo.sort().1)),
    );
    runs.fuser.set_span(Some(replay::span()?));
    let (mut faults, mut draws, mut tally) = (Faults::new(), Faults::new(), Tally::default());
    runs.run("faults", &boundless, |index| faults.event(log, index), |_, outcome| tally.count(outcome));
    for index in 0.. {
        let Some(event) = log.event(index) else { break };
        tally.inflicted[draws.draw(event.sensor) as usize] += 1;
    }
    Ok(Reference { lines: runs.lines, worst, faults: tally, precision: precision.found })
}

impl Tally {
    fn count(&mut self, outcome: &Outcome<impl Told>) {
        match outcome.arrival {
            Ok(_) => self.arrived += 1,
            Err(Rejected::Pose) => *self.refused.entry("pose").or_default() += 1,
            Err(Rejected::TimeBackwards) => *self.refused.entry("time going back").or_default() += 1,
            Err(Rejected::UnknownSensor) => *self.refused.entry("unknown sensor").or_default() += 1,
            Err(_) => *self.refused.entry("another reason").or_default() += 1,
        }
        if let Some(echo) = &outcome.echo {
            self.echoes += 1;
            self.wild_echoes += u32::from(!echo.numbers().iter().all(|number| number.is_finite()));
        }
    }

    /// How many readings had this fault.
    pub const fn of(&self, fault: Fault) -> u32 {
        self.inflicted[fault as usize]
    }

    /// How many readings were refused for this reason.
    pub fn refused_for(&self, reason: &str) -> u32 {
        self.refused.get(reason).copied().unwrap_or(0)
    }
}

struct DoublePrecision<E> {
    fuser: Fuser<f64, LatestArrays<f64, SENSORS, HISTORY>, E>,
    ring: Ring<f64>,
    found: Precision,
}

impl<E: Estimator<f64, Echo: Copy + Told>> DoublePrecision<E> {
    fn new(estimator: E) -> Result<Self, DomainError> {
        let fuser = Fuser::latest(estimator, Bounds::NONE.with_span(replay::span()?), LatestArrays::new());
        Ok(Self { fuser, ring: Ring::<f64>::nomad200()?, found: Precision::default() })
    }

    fn compare(&mut self, event: &Event<f32>, single: &Outcome<impl Told>) {
        let mut double = Outcome::NONE;
        fuse(&mut self.fuser, &self.ring, &event.widened(), &mut double);
        self.found.readings += 1;
        if !alike(single, &double) {
            self.found.unlike += 1;
        } else if let (Some(a), Some(b)) = (&single.echo, &double.echo) {
            self.found.echoes += 1;
            let ([x, y, ..], [there_x, there_y, ..]) = (a.numbers(), b.numbers());
            self.found.distance = self.found.distance.max((x - there_x).hypot(y - there_y));
        }
    }
}

/// Whether two outcomes agree in all that is no measured quantity.
fn alike(a: &Outcome<impl Told>, b: &Outcome<impl Told>) -> bool {
    a.arrival == b.arrival
        && a.ignored == b.ignored
        && a.echo.as_ref().map(Told::sort) == b.echo.as_ref().map(Told::sort)
}

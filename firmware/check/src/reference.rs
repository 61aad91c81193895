//! The same runs on the host: in single precision, which the image must match to the bit, and in double precision.

use std::collections::BTreeMap;

use atm_core::{Bounds, DomainError, Echo, Fuser, LatestArrays, Rejected, TransversalMedian};
use replay::{Adversary, Event, Fault, Faults, Fuser32, HISTORY, Line, Log, Outcome, Ring, SENSORS, Store32, fuse};

/// What the host made of the runs.
pub struct Reference {
    /// What the image has to print, figures aside.
    pub lines: Vec<String>,
    /// Most crossings on an arc of the adversary's.
    pub worst_crossings: u32,
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
    /// Readings whose kind or count of crossings differs.
    pub unlike: u32,
    /// The largest distance between two echoes of one reading, in metres.
    pub distance: f64,
}

struct Runs {
    fuser: Fuser32,
    lines: Vec<String>,
}

impl Runs {
    fn run(
        &mut self,
        run: &str,
        ring: &Ring<f32>,
        mut event: impl FnMut(u32) -> Option<Event<f32>>,
        mut seen: impl FnMut(&Event<f32>, &Outcome<f32>),
    ) {
        let mut outcome = Outcome::NONE;
        for index in 0.. {
            let Some(event) = event(index) else { break };
            fuse(&mut self.fuser, ring, &event, &mut outcome);
            seen(&event, &outcome);
            self.lines.push(String::from_utf8_lossy(Line::of(run, index, &outcome).finished()).trim_end().to_owned());
        }
        self.fuser.finish(&mut |_: &Echo<f32>| {});
    }
}

/// Runs it all on the host.
pub fn run(log: &Log<'_>) -> Result<Reference, DomainError> {
    let fuser = Fuser::latest(TransversalMedian::PAPER, Bounds::NONE, Store32::new());
    let mut runs = Runs { fuser, lines: Vec::new() };
    let mut precision = DoublePrecision::new()?;
    runs.run(
        "log",
        &Ring::<f32>::nomad200()?,
        |index| log.event(index),
        |event, outcome| precision.compare(event, outcome),
    );
    let boundless = Ring::boundless()?;
    let (mut adversary, mut worst_crossings) = (Adversary::new(), 0);
    runs.run(
        "adversary",
        &boundless,
        |index| adversary.event(&boundless, index),
        |_, outcome| worst_crossings = worst_crossings.max(outcome.echo.map_or(0, |echo| echo.crossings)),
    );
    let (mut faults, mut draws, mut tally) = (Faults::new(), Faults::new(), Tally::default());
    runs.run("faults", &boundless, |index| faults.event(log, index), |_, outcome| tally.count(outcome));
    for index in 0.. {
        let Some(event) = log.event(index) else { break };
        tally.inflicted[draws.draw(event.sensor) as usize] += 1;
    }
    Ok(Reference { lines: runs.lines, worst_crossings, faults: tally, precision: precision.found })
}

impl Tally {
    fn count(&mut self, outcome: &Outcome<f32>) {
        match outcome.arrival {
            Ok(_) => self.arrived += 1,
            Err(Rejected::Pose) => *self.refused.entry("pose").or_default() += 1,
            Err(Rejected::TimeBackwards) => *self.refused.entry("time going back").or_default() += 1,
            Err(Rejected::UnknownSensor) => *self.refused.entry("unknown sensor").or_default() += 1,
            Err(_) => *self.refused.entry("another reason").or_default() += 1,
        }
        if let Some(echo) = &outcome.echo {
            self.echoes += 1;
            let numbers = [echo.position.x, echo.position.y, echo.bearing.sin(), echo.bearing.cos()];
            self.wild_echoes += u32::from(!numbers.iter().all(|number| number.is_finite()));
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

struct DoublePrecision {
    fuser: Fuser<f64, LatestArrays<f64, SENSORS, HISTORY>>,
    ring: Ring<f64>,
    found: Precision,
}

impl DoublePrecision {
    fn new() -> Result<Self, DomainError> {
        let fuser = Fuser::latest(TransversalMedian::PAPER, Bounds::NONE, LatestArrays::new());
        Ok(Self { fuser, ring: Ring::<f64>::nomad200()?, found: Precision::default() })
    }

    fn compare(&mut self, event: &Event<f32>, single: &Outcome<f32>) {
        let mut double = Outcome::NONE;
        fuse(&mut self.fuser, &self.ring, &event.widened(), &mut double);
        self.found.readings += 1;
        if !alike(single, &double) {
            self.found.unlike += 1;
        } else if let (Some(a), Some(b)) = (single.echo, double.echo) {
            self.found.echoes += 1;
            let apart = [f64::from(a.position.x) - b.position.x, f64::from(a.position.y) - b.position.y];
            self.found.distance = self.found.distance.max((apart[0] * apart[0] + apart[1] * apart[1]).sqrt());
        }
    }
}

/// Whether two outcomes agree in all that is no measured quantity.
fn alike(a: &Outcome<f32>, b: &Outcome<f64>) -> bool {
    a.arrival == b.arrival
        && a.ignored == b.ignored
        && a.echo.map(|echo| (echo.kind, echo.crossings)) == b.echo.map(|echo| (echo.kind, echo.crossings))
}

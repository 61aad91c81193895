//! Runs a fuser over a log and keeps all that it says.

use atm::core::{ArcCrossing, Arrival, Echo, Fuser, Rejected, Sink, Storage};

use crate::log::{Float, Log};

/// One arc's report.
#[derive(Debug, Clone)]
pub struct Report<T: Float> {
    pub echo: Option<Echo<T>>,
    /// The count that came with it.
    pub count: u32,
    pub crossings: Vec<ArcCrossing<T>>,
}

/// A sink that keeps everything.
#[derive(Debug)]
pub struct Recorder<T: Float> {
    pub reports: Vec<Report<T>>,
    pending: Vec<ArcCrossing<T>>,
}

impl<T: Float> Recorder<T> {
    pub fn new() -> Self {
        Self { reports: Vec::new(), pending: Vec::new() }
    }

    fn close(&mut self, echo: Option<Echo<T>>, count: u32) {
        let crossings = std::mem::take(&mut self.pending);
        self.reports.push(Report { echo, count, crossings });
    }
}

impl<T: Float> Sink<T, Echo<T>> for Recorder<T> {
    fn echo(&mut self, echo: &Echo<T>) {
        self.close(Some(*echo), echo.crossings);
    }

    fn ignored(&mut self, crossings: u32) {
        self.close(None, crossings);
    }

    fn wants_crossings(&self) -> bool {
        true
    }

    fn crossing(&mut self, crossing: &ArcCrossing<T>) {
        self.pending.push(*crossing);
    }
}

/// What became of a sample, and what was reported meanwhile.
pub type Push<T> = (Result<Arrival, Rejected>, Vec<Report<T>>);

/// What one run said.
#[derive(Debug)]
pub struct Run<T: Float> {
    /// For each sample.
    pub pushes: Vec<Push<T>>,
    /// In the order of the log's samples.
    pub snapshots: Vec<(usize, Vec<Report<T>>)>,
    /// Reported at the end.
    pub rest: Vec<Report<T>>,
}

/// Pushes a whole log, with `snapshot` where the log asks for one.
pub fn run<T: Float, S: Storage<T>>(
    log: &Log,
    fuser: &mut Fuser<T, S>,
    mut snapshot: impl FnMut(&mut Fuser<T, S>, &mut Recorder<T>),
) -> Run<T> {
    let mut run = Run { pushes: Vec::new(), snapshots: Vec::new(), rest: Vec::new() };
    for (index, sample) in log.samples.iter().enumerate() {
        let mut recorder = Recorder::new();
        let fate = fuser.push(&sample.reading(), &mut recorder);
        run.pushes.push((fate, recorder.reports));
        for _ in log.snapshots.iter().filter(|&&place| place == index) {
            let mut recorder = Recorder::new();
            snapshot(fuser, &mut recorder);
            run.snapshots.push((index, recorder.reports));
        }
    }
    let mut recorder = Recorder::new();
    fuser.finish(&mut recorder);
    run.rest = recorder.reports;
    run
}

impl<T: Float> Run<T> {
    /// Every number that was said, bit by bit.
    pub fn bits(&self) -> Vec<u64> {
        let mut bits = Vec::new();
        for (fate, reports) in &self.pushes {
            bits.push(match fate {
                Ok(Arrival::Entered) => 0,
                Ok(Arrival::Held) => 1,
                Ok(Arrival::Duplicate) => 2,
                Ok(_) => 3,
                Err(rejected) => 4 + *rejected as u64,
            });
            reports.iter().for_each(|report| report.bits(&mut bits));
        }
        for (index, reports) in &self.snapshots {
            bits.push(*index as u64);
            reports.iter().for_each(|report| report.bits(&mut bits));
        }
        self.rest.iter().for_each(|report| report.bits(&mut bits));
        bits
    }
}

impl<T: Float> Report<T> {
    /// Crossings come in no particular order, so theirs are added up.
    fn bits(&self, bits: &mut Vec<u64>) {
        bits.push(u64::from(self.count));
        if let Some(echo) = &self.echo {
            bits.extend([echo.t as u64, u64::from(echo.sensor), echo.kind as u64, u64::from(echo.within)]);
            let numbers = [
                echo.position.x,
                echo.position.y,
                echo.range,
                echo.bearing.cos(),
                echo.bearing.sin(),
                echo.resolution,
                echo.interval,
                echo.arc_length,
                echo.significance(),
                echo.scan_significance(),
            ];
            bits.extend(numbers.map(|number| number.widened().to_bits()));
        }
        let sum = self.crossings.iter().fold(0u64, |sum, crossing| {
            let numbers = [crossing.position.x, crossing.position.y, crossing.bearing.sin(), crossing.angle];
            let mixed = numbers
                .map(|number| number.widened().to_bits())
                .iter()
                .enumerate()
                .fold(crossing.t_other as u64 ^ u64::from(crossing.sensor_other), |mixed, (place, bits)| {
                    mixed ^ bits.rotate_left(13 * place as u32)
                });
            sum.wrapping_add(mixed)
        });
        bits.push(sum);
    }
}

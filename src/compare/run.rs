//! One method over a recording.

use std::{sync::Arc, time::Instant};

use atm_core::{Bounds, Echo, Kind, Reading};

use super::{
    method::{AtmRun, Name, Options},
    recording::Recording,
};
use crate::{
    baseline::{Evidence, Findings, Mark, Method},
    error::Result,
    eval::Estimate,
    intake::{Consumer, read},
    log::Row,
    pipeline::{EchoSink, Settings, fuse},
    summary::Summary,
};

/// What a method says of a log.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// The method.
    pub name: Name,
    /// Its points; those of segments and of grids by its own threshold among them. `None` where it does not apply to the log.
    pub estimates: Option<Vec<Estimate>>,
    /// Ends of its straight pieces.
    pub segments: Vec<[atm_core::Point2<f64>; 2]>,
    /// Its map.
    pub evidence: Option<Evidence>,
    /// Time from the first reading to its last word, by the clock on the wall, in seconds; reading the log is not in it.
    pub seconds: f64,
}

/// Runs a method.
///
/// # Errors
/// What it has to remember grows beyond its bound, or a history of that length can't be had.
pub fn run(name: Name, recording: &Recording, options: &Options) -> Result<Outcome> {
    let begun = Instant::now();
    let outcome = match name.atm(options) {
        Some(atm) => atm_outcome(name, &atm, recording, options)?,
        None => match name.method(options, recording.limits())? {
            Some(method) => baseline_outcome(name, method, recording)?,
            None => Outcome { name, estimates: None, segments: Vec::new(), evidence: None, seconds: 0.0 },
        },
    };
    Ok(Outcome { seconds: begun.elapsed().as_secs_f64(), ..outcome })
}

/// The arc-transversal median, by the pipeline of `atm fuse`. What a log has after a reset of its clock is a log of its own
/// for it: the local map is empty, and what was in it is reported.
fn atm_outcome(name: Name, atm: &AtmRun, recording: &Recording, options: &Options) -> Result<Outcome> {
    let settings = Settings {
        emit: atm.emit,
        history: options.history,
        bounds: Bounds::NONE,
        estimator: atm.estimator,
        strict: false,
    };
    let mut echoes = Echoes { ids: recording.ids(), keep: atm.keep, estimates: Vec::new() };
    for mut part in recording.parts() {
        let (_, result) = fuse(&mut part, None, recording.sensors(), &settings, &mut echoes, &mut |_| ());
        result?;
    }
    Ok(Outcome { name, estimates: Some(echoes.estimates), segments: Vec::new(), evidence: None, seconds: 0.0 })
}

/// The sink of those echoes.
struct Echoes<'a> {
    ids: &'a [Arc<str>],
    keep: &'static [Kind],
    estimates: Vec<Estimate>,
}

impl EchoSink for Echoes<'_> {
    fn echo(&mut self, echo: &Echo<f64>) -> Result<bool> {
        let kept = self.keep.contains(&echo.kind);
        if kept {
            self.estimates.push(Estimate {
                position: echo.position,
                key: self.ids.get(usize::from(echo.sensor)).map(|id| (echo.t, Arc::clone(id))),
                azimuth: Some(echo.azimuth()),
                range: Some(echo.range),
                kind: Some(Arc::from(echo.kind.name())),
            });
        }
        Ok(kept)
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}

fn baseline_outcome(name: Name, method: Box<dyn Method>, recording: &Recording) -> Result<Outcome> {
    let mut feeding = Feeding { method };
    let mut summary = Summary::default();
    for (index, mut part) in recording.parts().enumerate() {
        if index > 0 {
            feeding.method.clock_reset();
        }
        read(&mut part, None, recording.sensors(), false, &mut feeding, &mut summary, &mut |_| ())?;
    }
    let Some(findings) = feeding.method.finish()? else {
        return Ok(Outcome { name, estimates: None, segments: Vec::new(), evidence: None, seconds: 0.0 });
    };
    let estimates = findings.marks()?.iter().map(|mark| estimate(mark, recording.ids())).collect();
    let Findings { segments, evidence, .. } = findings;
    let segments = segments.iter().map(|segment| segment.ends.map(|end| end.position)).collect();
    Ok(Outcome { name, estimates: Some(estimates), segments, evidence, seconds: 0.0 })
}

/// A method's point as what is scored.
pub(super) fn estimate(mark: &Mark, ids: &[Arc<str>]) -> Estimate {
    let id = |(t, sensor): (i64, u16)| Some((t, Arc::clone(ids.get(usize::from(sensor))?)));
    Estimate {
        position: mark.position,
        key: mark.key.and_then(id),
        azimuth: mark.azimuth,
        range: mark.range,
        kind: None,
    }
}

/// The consumer that feeds a method.
struct Feeding {
    method: Box<dyn Method>,
}

impl Consumer for Feeding {
    fn reading(&mut self, _: &Row, reading: &Reading<f64>, _: &mut Summary) -> Result<()> {
        self.method.take(reading)
    }
}

//! One method over a recording.

use std::{sync::Arc, time::Instant};

use atm::{
    echo::AnyEcho,
    error::Result,
    intake::{Consumer, read},
    log::Row,
    pipeline::{EchoSink, Settings, fuse},
    summary::Summary,
};
use atm_core::{Bounds, Reading};

use super::{
    method::{Name, Options, PipelineRun},
    recording::Recording,
};
use crate::{
    baseline::{Evidence, Findings, Mark, Method},
    eval::Estimate,
};

/// What a method says of a log.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// The method.
    pub name: Name,
    /// Its points; those of segments and of grids by its own threshold among them. `None` where it does not apply to the log.
    pub estimates: Option<Vec<Estimate>>,
    /// Of each of them how likely it is an accident, by its own estimator; `None` of methods that do not say.
    pub significances: Option<Vec<f64>>,
    /// Ends of its straight pieces.
    pub segments: Vec<[atm_core::Point2<f64>; 2]>,
    /// Its map.
    pub evidence: Option<Evidence>,
    /// Time from the first reading to its last word, by the clock on the wall, in seconds; reading the log is not in it.
    pub seconds: f64,
}

impl Outcome {
    /// Of a method that has nothing to say of the log.
    fn nothing(name: Name) -> Self {
        Self { name, estimates: None, significances: None, segments: Vec::new(), evidence: None, seconds: 0.0 }
    }
}

/// Runs a method.
///
/// # Errors
/// What it has to remember grows beyond its bound, or a history of that length can't be had.
pub fn run(name: Name, recording: &Recording, options: &Options) -> Result<Outcome> {
    let begun = Instant::now();
    let outcome = match name.pipeline(options)? {
        Some(run) => pipeline_outcome(name, &run, recording, options)?,
        None => match name.method(options, recording.limits())? {
            Some(method) => baseline_outcome(name, method, recording)?,
            None => Outcome::nothing(name),
        },
    };
    Ok(Outcome { seconds: begun.elapsed().as_secs_f64(), ..outcome })
}

/// An estimator by the pipeline of `atm fuse`. What a log has after a reset of its clock is a log of its own
/// for it: the local map is empty, and what was in it is reported.
fn pipeline_outcome(name: Name, run: &PipelineRun, recording: &Recording, options: &Options) -> Result<Outcome> {
    let settings = Settings {
        emit: run.emit,
        history: options.history,
        bounds: Bounds::NONE,
        estimator: run.estimator,
        strict: false,
    };
    let mut echoes = Echoes { ids: recording.ids(), keep: run.keep, estimates: Vec::new(), significances: Vec::new() };
    for mut part in recording.parts() {
        let (_, result) = fuse(&mut part, None, recording.sensors(), &settings, &mut echoes, &mut |_| ());
        result?;
    }
    let (estimates, significances) = (Some(echoes.estimates), Some(echoes.significances));
    Ok(Outcome { estimates, significances, ..Outcome::nothing(name) })
}

/// The sink of those echoes.
struct Echoes<'a> {
    ids: &'a [Arc<str>],
    /// All kinds where there are none.
    keep: &'static [&'static str],
    estimates: Vec<Estimate>,
    significances: Vec<f64>,
}

impl EchoSink for Echoes<'_> {
    fn echo(&mut self, echo: &AnyEcho) -> Result<bool> {
        let usual = echo.usual();
        let kept = self.keep.is_empty() || self.keep.contains(&usual.kind);
        if kept {
            self.estimates.push(Estimate {
                position: usual.position,
                key: self.ids.get(usize::from(usual.sensor)).map(|id| (usual.t, Arc::clone(id))),
                azimuth: Some(usual.azimuth),
                range: Some(usual.range),
                kind: Some(Arc::from(usual.kind)),
            });
            self.significances.push(usual.significance);
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
        return Ok(Outcome::nothing(name));
    };
    let estimates = findings.marks()?.iter().map(|mark| estimate(mark, recording.ids())).collect();
    let Findings { segments, evidence, .. } = findings;
    let segments = segments.iter().map(|segment| segment.ends.map(|end| end.position)).collect();
    Ok(Outcome { estimates: Some(estimates), segments, evidence, ..Outcome::nothing(name) })
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

//! `atm fuse`: a log in, echoes out.

use atm::{
    core::{Kind, MinAngle, TransversalMedian},
    job::{Ended, FuseJob},
    pipeline::{self, Emit, SensorModel, Settings},
    summary::Summary,
};

use crate::{
    Failure, Outcome,
    args::{self, Fuse},
    command, is_reader_gone, report,
};

/// Share of echoes of kind `near` above which a guessed range resolution deserves a word.
const MANY_NEAR: f64 = 0.2;

/// Runs the command.
pub fn run(args: &Fuse) -> Result<Outcome, Failure> {
    let job = FuseJob {
        log: args.log.job(&args.input, args.from, args.range_resolution)?,
        rig_file: args.log.rig.clone(),
        output: Some(args.output.clone()),
        to: args.to.map(Into::into),
        crossings: args.crossings.clone(),
        summary: args.summary.clone(),
        keep: (!args.keep.is_empty()).then(|| args.keep.clone()),
        schema: args.schema.into(),
        passthrough: args.passthrough,
    };
    let settings = settings(args, &job.log.models()?)?;
    let mut bar = None;
    let mut progress = |bytes, length| {
        bar.get_or_insert_with(|| report::progress(length, args.quiet)).set_position(bytes);
        true
    };
    let ended = job.run(&settings, &mut progress);
    if let Some(bar) = bar {
        bar.finish_and_clear();
    }
    let Ended { summary, pose_source, notes, result, partials } = ended?;
    if !matches!(&result, Err(error) if is_reader_gone(error)) {
        tell(args, pose_source.as_deref(), &summary, job.log.guesses_resolution());
        for note in &notes {
            report::say(format_args!("{note}"));
        }
    }
    result.map_err(|error| command::unfinished(error, "fused", &partials))?;
    Ok(if summary.is_clean() { Outcome::Done } else { Outcome::Partly })
}

fn settings(args: &Fuse, sensors: &[SensorModel]) -> Result<Settings, Failure> {
    let usage = |error: atm::core::DomainError| Failure::Usage(error.to_string());
    let min_angle = match (args.min_angle, args.improvement, args.at) {
        (Some(angle), ..) => angle,
        (None, Some(improvement), Some(distance)) => {
            pipeline::min_angle_for(improvement, distance, sensors).map_err(usage)?
        }
        _ => MinAngle::PAPER,
    };
    Ok(Settings {
        emit: match args.emit {
            args::Emit::Settled => Emit::Settled,
            args::Emit::Latest => Emit::Latest,
        },
        history: args.history,
        bounds: args.bounds().map_err(usage)?,
        estimator: TransversalMedian { min_angle, on_none: args.on_none.into(), on_two: args.on_two.into() },
        strict: args.strict,
    })
}

/// Says what was counted, and what deserves a word.
fn tell(args: &Fuse, pose_source: Option<&str>, summary: &Summary, guessed: bool) {
    if !args.quiet {
        if let Some(source) = pose_source {
            report::say(format_args!("poses     {source}"));
        }
        report::say(format_args!("{}", report::counts(summary)));
    }
    if let Some(unusable) = report::unusable(&summary.dropped) {
        report::say(format_args!("{unusable}"));
    }
    let (near, total) = (summary.echoes.get(Kind::Near), summary.echoes.total());
    if guessed && near as f64 > MANY_NEAR * total as f64 {
        report::say(format_args!(
            "warning: {near} of {total} echoes are near; a range resolution of 1in was assumed, say --range-resolution if \
             the ranges are finer"
        ));
    }
}

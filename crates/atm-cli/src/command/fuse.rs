//! `atm fuse`: a log in, echoes out.
mod fleet;

use atm::{
    core::{DomainError, MinAngle},
    diagnose::Diagnosis,
    echo::AnyEstimator,
    job::{Ended, FuseJob, LogJob},
    pipeline::{self, Emit, SensorModel, Settings},
    summary::Summary,
};

use crate::{
    Failure, Outcome,
    args::{self, Fuse, NoneOption, TwoOption},
    command, interrupt, is_reader_gone, report,
};

/// Runs the command.
pub fn run(args: &Fuse) -> Result<Outcome, Failure> {
    if let Some(directory) = &args.out_dir {
        return fleet::run(args, directory);
    }
    let [input, parts @ ..] = &args.inputs[..] else {
        return Err(Failure::Usage("no log is named".into()));
    };
    if let Some(option) = [(args.passthrough, "--passthrough"), (args.inputs.iter().any(|input| input == "-"), "-")]
        .into_iter()
        .find_map(|(given, option)| (given && !parts.is_empty()).then_some(option))
    {
        return Err(Failure::Usage(format!("{option}: several recordings can't be read as one like that")));
    }
    let mut job = job(args, input, args.output.clone())?;
    job.log.parts = parts.to_vec();
    let settings = settings(args, &job.log.models()?)?;
    let mut bar = None;
    let mut progress = |bytes, length| {
        bar.get_or_insert_with(|| report::progress(length, args.quiet)).set_position(bytes);
        interrupt::caught().is_none()
    };
    let ended = job.run(&settings, &mut progress);
    if let Some(bar) = bar {
        bar.finish_and_clear();
    }
    let (words, outcome) = said(args, ended);
    for word in &words {
        report::say(format_args!("{word}"));
    }
    outcome
}

/// One log's run.
pub(super) fn job(args: &Fuse, input: &str, output: String) -> Result<FuseJob, Failure> {
    Ok(FuseJob {
        log: LogJob { opens: interrupt::open, ..args.log.job(input, args.from, args.range_resolution)? },
        rig_file: args.log.rig.clone(),
        output: Some(output),
        to: args.to.map(Into::into),
        crossings: args.crossings.clone(),
        summary: args.summary.clone(),
        keep: (!args.keep.is_empty()).then(|| args.keep.clone()),
        schema: args.schema.into(),
        passthrough: args.passthrough,
    })
}

/// What a person is told of a run that has ended, and how it ended.
pub(super) fn said(args: &Fuse, ended: atm::error::Result<Ended>) -> (Vec<String>, Result<Outcome, Failure>) {
    let Ended { summary, pose_source, notes, result, partials } = match ended {
        Ok(ended) => ended,
        Err(error) => return (Vec::new(), Err(error.into())),
    };
    let mut words = Vec::new();
    if !matches!(&result, Err(error) if is_reader_gone(error)) {
        words = counted(args, pose_source.as_deref(), &summary);
        words.extend(notes);
    }
    let outcome = if summary.is_clean() { Outcome::Done } else { Outcome::Partly };
    (words, result.map(|()| outcome).map_err(|error| command::unfinished(error, "fused", &partials)))
}

/// Refuses options that belong to the other estimator.
fn check_estimator(args: &Fuse, estimator: &AnyEstimator) -> Result<(), Failure> {
    let consensus = estimator.is_consensus();
    let options = [
        (consensus && args.on_none != NoneOption::Center, "--on-none"),
        (consensus && args.on_two != TwoOption::Drop, "--on-two"),
        (!consensus && args.confidence.is_some(), "--confidence"),
        (!consensus && args.range_error.is_some(), "--range-error"),
    ];
    let name = if consensus { "consensus" } else { "atm" };
    if let Some((_, option)) = options.into_iter().find(|(given, _)| *given) {
        return Err(Failure::Usage(format!("{option} says nothing to --estimator {name}")));
    }
    match args.keep.iter().find(|kind| !estimator.kinds().contains(kind)) {
        Some(kind) => Err(Failure::Usage(format!("--keep {kind}: --estimator {name} gives no such kind"))),
        None => Ok(()),
    }
}

fn usage(error: DomainError) -> Failure {
    Failure::Usage(error.to_string())
}

pub(super) fn settings(args: &Fuse, sensors: &[SensorModel]) -> Result<Settings, Failure> {
    let min_angle = match (args.min_angle, args.improvement, args.at) {
        (Some(angle), ..) => angle,
        (None, Some(improvement), Some(distance)) => {
            pipeline::min_angle_for(improvement, distance, sensors).map_err(usage)?
        }
        _ => MinAngle::PAPER,
    };
    let estimator = args.estimator(min_angle).map_err(usage)?;
    check_estimator(args, &estimator)?;
    Ok(Settings {
        emit: match args.emit {
            args::Emit::Settled => Emit::Settled,
            args::Emit::Latest => Emit::Latest,
        },
        history: args.local_map.history(),
        bounds: args.bounds().map_err(usage)?,
        estimator,
        strict: args.strict,
    })
}

/// What was counted, and what deserves a word.
fn counted(args: &Fuse, pose_source: Option<&str>, summary: &Summary) -> Vec<String> {
    let mut words = Vec::new();
    if !args.quiet {
        words.extend(pose_source.map(|source| format!("poses     {source}")));
        words.push(report::counts(summary));
    }
    words.extend(report::unusable(&summary.dropped));
    // Records that can't be used are told of above, each with its place, and what a recording shows in its notes.
    let told = |found: &&Diagnosis| !matches!(found, Diagnosis::Unusable { .. } | Diagnosis::Recording(_));
    words.extend(summary.advice.iter().filter(told).map(|found| format!("warning: {found}")));
    words
}

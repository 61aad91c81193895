//! `atm view`: a log in, a page that replays it out.

use std::{ffi::OsString, io::Write as _, path::Path, process::Command};

use atm::{
    core::{Bounds, Consensus, Held, TransversalMedian},
    echo::AnyEstimator,
    job::LogJob,
    log::output::{Output, overwrites},
    pipeline::{Emit, Settings},
};
use atm_lab::{
    view::{MOST_READINGS, Method, Replay, ViewJob, quoted},
    world::World,
};

use crate::{
    Failure, Outcome,
    args::{HeldOption, View},
    interrupt, report,
};

/// Runs the command, which was typed as `typed`.
pub fn run(args: &View, typed: &[OsString]) -> Result<Outcome, Failure> {
    let output = output(args)?;
    let job = job(args, typed)?;
    let mut bar = None;
    let replay = job.run(&mut |bytes, length| {
        bar.get_or_insert_with(|| report::progress(length, args.quiet)).set_position(bytes);
        interrupt::caught().is_none()
    });
    if let Some(bar) = bar {
        bar.finish_and_clear();
    }
    let replay = replay?;
    let mut file = Output::create(&output)?;
    file.write_all(replay.html.as_bytes()).map_err(|error| file.error(error))?;
    file.commit()?;
    if !args.quiet {
        say(&replay, &output);
    }
    if args.open {
        open(&output)?;
    }
    // Every pass meets the same records.
    match replay.summaries.first() {
        Some((_, summary)) if !summary.is_clean() => {
            if let Some(unusable) = report::unusable(&summary.dropped) {
                report::say(format_args!("{unusable}"));
            }
            Ok(Outcome::Partly)
        }
        _ => Ok(Outcome::Done),
    }
}

/// Where the page goes; refuses the names of inputs.
fn output(args: &View) -> Result<String, Failure> {
    let output = args.output.clone().unwrap_or_else(|| {
        let stem = Path::new(&args.input).file_stem().map(|stem| stem.to_string_lossy().into_owned());
        let stem = stem.filter(|_| args.input != "-").unwrap_or_else(|| "atm-view".to_owned());
        format!("{stem}.html")
    });
    let others = [&args.world, &args.truth, &args.log.poses, &args.log.rig];
    let mut read = std::iter::once(&args.input).chain(others.into_iter().flatten());
    match read.find(|input| overwrites(&output, input)) {
        Some(input) => Err(Failure::Usage(format!("{output}: writing it would overwrite the input {input}"))),
        None if output == "-" && args.open => Err(Failure::Usage("--open: standard output can't be opened".into())),
        None => Ok(output),
    }
}

fn job(args: &View, typed: &[OsString]) -> Result<ViewJob, Failure> {
    let wanted: Vec<Method> = args.methods.iter().map(|method| (*method).into()).collect();
    let methods: Vec<Method> = match (wanted.is_empty(), args.input.as_str()) {
        (false, _) => Method::ALL.into_iter().filter(|method| wanted.contains(method)).collect(),
        (true, "-") => vec![Method::Centerline, Method::Atm],
        (true, _) => Method::ALL.to_vec(),
    };
    let held = match args.held {
        HeldOption::Keep => Held::Keep,
        HeldOption::Drop => Held::Drop,
        HeldOption::Edges => Held::Edges,
    };
    let median = AnyEstimator::Median(TransversalMedian { min_angle: args.min_angle, ..TransversalMedian::PAPER });
    let consensus = Consensus::new(args.min_angle).with_range_error(args.range_error);
    let consensus = consensus.map_err(|error| Failure::Usage(error.to_string()))?;
    let mut estimators = Vec::new();
    if methods.contains(&Method::Atm) {
        estimators.push(median);
    }
    if methods.contains(&Method::Consensus) {
        estimators.push(AnyEstimator::Consensus(consensus));
    }
    let bounds = Bounds::NONE.with_held(held);
    Ok(ViewJob {
        log: LogJob { opens: interrupt::open, ..args.log.job(&args.input, args.from, args.range_resolution)? },
        settings: Settings {
            emit: Emit::Settled,
            history: args.local_map.history(),
            bounds,
            estimator: median,
            strict: false,
        },
        estimators,
        methods,
        command: line(typed),
        world: args.world.as_deref().map(|name| World::load(name, &args.set)).transpose()?,
        truth: args.truth.clone(),
        units: args.units.map(Into::into),
        most: MOST_READINGS,
    })
}

/// The command line as it was typed, with the program's name alone.
fn line(typed: &[OsString]) -> String {
    let words: Vec<String> = typed.iter().skip(1).map(|word| word.to_string_lossy().into_owned()).collect();
    quoted(std::iter::once("atm").chain(words.iter().map(String::as_str)))
}

fn say(replay: &Replay, output: &str) {
    for note in &replay.notes {
        report::say(format_args!("{note}"));
    }
    let (readings, stride) = replay.thinned;
    if stride > 1 {
        report::say(format_args!(
            "thinned   {readings} readings are more than the {MOST_READINGS} a page holds: one in {stride} of each sensor is shown"
        ));
    }
    let size = replay.html.len().div_ceil(1000);
    report::say(format_args!("view      {readings} readings in {output}, {size} kB"));
}

/// Opens the page with what the system opens pages with.
fn open(output: &str) -> Result<(), Failure> {
    let (program, before): (&str, &[&str]) = match std::env::consts::OS {
        "macos" => ("open", &[]),
        "windows" => ("cmd", &["/C", "start", ""]),
        _ => ("xdg-open", &[]),
    };
    let started = Command::new(program).args(before).arg(output).status();
    match started {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(Failure::Failed(format!("--open: {program} {output}: {status}; the page is written"))),
        Err(error) => Err(Failure::Failed(format!("--open: {program}: {error}; the page is written: {output}"))),
    }
}

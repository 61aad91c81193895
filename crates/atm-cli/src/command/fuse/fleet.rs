//! Many logs, each fused on its own into a directory; a bad one fails alone.

use std::{
    collections::BTreeMap,
    fs,
    num::NonZeroUsize,
    path::Path,
    sync::{
        atomic::{AtomicUsize, Ordering},
        mpsc,
    },
    thread,
};

use atm::{error::Error, job::FuseJob, log::format::Format, pipeline::Settings};
use indicatif::ProgressBar;

use super::{job, said, settings};
use crate::{Failure, Outcome, args::Fuse, interrupt, report};

/// What is told of one log, and how it ended.
type Told = (Vec<String>, Result<Outcome, Failure>);

/// Fuses every log into `directory`, several at the same time; what is told of them is in the order of the command line.
pub fn run(args: &Fuse, directory: &Path) -> Result<Outcome, Failure> {
    let jobs = jobs(args, directory)?;
    let models = jobs.first().map(|job| job.log.models()).transpose()?.unwrap_or_default();
    let settings = settings(args, &models)?;
    jobs.iter().try_for_each(|job| job.check(&settings))?;
    fs::create_dir_all(directory)
        .map_err(|source| Error::Io { file: directory.display().to_string().into(), source })?;
    let bar = report::progress(length(&args.inputs), args.quiet);
    let (mut done, mut failed, mut partly) = (0, 0, false);
    fuse_all(args, &jobs, &settings, &bar, &mut |job, (words, outcome)| {
        bar.suspend(|| tell(job, &words, &outcome));
        match outcome {
            Ok(outcome) => {
                done += 1;
                partly |= outcome == Outcome::Partly;
            }
            Err(_) => failed += 1,
        }
    });
    bar.finish_and_clear();
    if let Some(interrupted) = interrupt::caught().filter(|_| done < jobs.len()) {
        let message = format!("{interrupted}: {done} of {} logs are fused", jobs.len());
        return Err(Failure::Interrupted(interrupted, message));
    }
    match failed {
        0 if partly => Ok(Outcome::Partly),
        0 => Ok(Outcome::Done),
        failed => Err(Failure::Failed(format!("{failed} of {} logs could not be fused", jobs.len()))),
    }
}

/// A run for each log. Two of them never write the same file.
fn jobs(args: &Fuse, directory: &Path) -> Result<Vec<FuseJob>, Failure> {
    let mut taken = BTreeMap::new();
    let job = |input: &String| {
        let stem = Path::new(input).file_stem().filter(|_| input != "-").and_then(|stem| stem.to_str());
        let Some(stem) = stem else {
            return Err(Failure::Usage(format!("{input}: --out-dir needs logs with names")));
        };
        let format = args.to.map_or_else(|| Format::of_name(input), Format::from);
        let output = directory.join(format!("{stem}.{}", format.extension())).display().to_string();
        if let Some(other) = taken.insert(output.clone(), input.clone()) {
            return Err(Failure::Usage(format!("{other} and {input} would both be fused into {output}")));
        }
        job(args, input, output)
    };
    args.inputs.iter().map(job).collect()
}

/// Bytes of all logs; `None` where one does not say.
fn length(inputs: &[String]) -> Option<u64> {
    inputs.iter().map(|input| fs::metadata(input).ok().map(|file| file.len())).sum()
}

/// Runs the jobs on as many threads as asked for; `ended` hears of each, in their order.
fn fuse_all(
    args: &Fuse,
    jobs: &[FuseJob],
    settings: &Settings,
    bar: &ProgressBar,
    ended: &mut dyn FnMut(&FuseJob, Told),
) {
    let cores = || thread::available_parallelism().map_or(1, NonZeroUsize::get);
    let workers = args.jobs.map_or_else(cores, NonZeroUsize::get).min(jobs.len());
    let (next, (sender, told)) = (&AtomicUsize::new(0), mpsc::channel());
    thread::scope(|scope| {
        for _ in 0..workers {
            let sender = sender.clone();
            scope.spawn(move || {
                // A log that was begun is told of; after a signal, no further one is begun.
                while interrupt::caught().is_none() {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(job) = jobs.get(index) else { return };
                    // Whoever listens does so until the last worker is done.
                    let _ = sender.send((index, fuse(args, job, settings, bar)));
                }
            });
        }
        drop(sender);
        let (mut waiting, mut expected) = (BTreeMap::new(), jobs.iter().enumerate().peekable());
        for (index, words) in told {
            waiting.insert(index, words);
            while let Some((index, job)) = expected.peek()
                && let Some(words) = waiting.remove(index)
            {
                ended(job, words);
                expected.next();
            }
        }
    });
}

/// Fuses one log.
fn fuse(args: &Fuse, job: &FuseJob, settings: &Settings, bar: &ProgressBar) -> Told {
    let mut done = 0;
    let run = job.run(settings, &mut |bytes, _| {
        bar.inc(bytes.saturating_sub(done));
        done = done.max(bytes);
        interrupt::caught().is_none()
    });
    said(args, run)
}

/// Says what there is to say of one log, under its name.
fn tell(job: &FuseJob, words: &[String], outcome: &Result<Outcome, Failure>) {
    let (input, output) = (&job.log.input, job.output.as_deref().unwrap_or_default());
    let error = match outcome {
        Err(Failure::Failed(message) | Failure::Usage(message) | Failure::Interrupted(_, message)) => Some(message),
        _ => None,
    };
    if !words.is_empty() {
        report::say(format_args!("{input} -> {output}"));
    }
    for word in words {
        report::say(format_args!("  {}", word.replace('\n', "\n  ")));
    }
    if let Some(message) = error {
        report::say(format_args!("atm: {message}"));
    }
}

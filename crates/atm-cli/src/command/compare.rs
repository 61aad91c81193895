//! `atm compare`: every method on one log.

mod files;
mod table;

use atm::core::MinAngle;
use atm_lab::{
    compare::{Assessment, Name, Options, Outcome as Said, Recording, as_json, assess, run as run_method},
    truth::Truth,
    world::World,
};

use crate::{Failure, Outcome, args::Compare, report};

/// Runs the command.
pub fn run(args: &Compare) -> Result<Outcome, Failure> {
    files::check(args)?;
    let world = args.world.as_deref().map(|name| World::load(name, &args.set)).transpose()?;
    let truth = args.truth.as_deref().map(Truth::read).transpose()?;
    let recording = record(args)?;
    let options = Options {
        history: args.local_map.history(),
        min_angle: args.min_angle.unwrap_or(MinAngle::PAPER),
        range_error: args.range_error,
        cell: args.cell,
    };
    let names = if args.methods.is_empty() { Name::ALL.to_vec() } else { distinct(&args.methods) };
    let said: Vec<Said> = names.iter().map(|name| run_method(*name, &recording, &options)).collect::<Result<_, _>>()?;
    let assessed = assess(&said, &recording, world.as_ref(), truth.as_ref())?;
    let rows: Vec<(Name, &Assessment)> = names.iter().copied().zip(&assessed).collect();
    crate::print(&if args.json { as_text(&rows)? } else { table::text(&rows, &recording, world.is_some()) })?;
    files::write(args, &said, &recording, world.as_ref())?;
    let Some(unusable) = report::unusable(&recording.summary.dropped) else {
        return Ok(Outcome::Done);
    };
    report::say(format_args!("{unusable}"));
    Ok(Outcome::Partly)
}

/// Each once, in the order in which they were asked for.
fn distinct(names: &[Name]) -> Vec<Name> {
    let mut seen = Vec::new();
    for name in names {
        if !seen.contains(name) {
            seen.push(*name);
        }
    }
    seen
}

fn record(args: &Compare) -> Result<Recording, Failure> {
    let job = args.log.job(&args.input, args.from, args.range_resolution)?;
    let (format, input) = job.open()?;
    let length = input.length;
    let mut log = job.readings(format, input, false)?;
    let (source, track) = log.source();
    let bar = report::progress(length, args.quiet);
    let mut progress = |bytes| bar.set_position(bytes);
    let recording = Recording::read(source, track, &job.sensors()?, args.drop_held, &mut progress);
    bar.finish_and_clear();
    Ok(recording?)
}

fn as_text(rows: &[(Name, &Assessment)]) -> Result<String, Failure> {
    let text = as_json(rows).and_then(|value| serde_json::to_string_pretty(&value));
    Ok(text.map_err(|error| Failure::Failed(error.to_string()))? + "\n")
}

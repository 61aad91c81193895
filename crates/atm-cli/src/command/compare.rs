//! `atm compare`: every method on one log.

mod files;
mod table;

use std::collections::BTreeMap;

use atm::{
    compare::{
        Assessment, Name, Options, Outcome as Said, Recording, against_world, among_themselves, run as run_method,
    },
    core::MinAngle,
    eval::{Judge, Scores},
    log::{View, truth::Truth},
    world::World,
};
use serde_json::{Map, Value, json};

use crate::{Failure, Outcome, args::Compare, report};

/// Runs the command.
pub fn run(args: &Compare) -> Result<Outcome, Failure> {
    files::check(args)?;
    let world = args.world.as_deref().map(|name| World::load(name, &args.set)).transpose()?;
    let truth = args.truth.as_deref().map(Truth::read).transpose()?;
    let recording = record(args)?;
    let options = Options {
        history: args.history,
        min_angle: args.min_angle.unwrap_or(MinAngle::PAPER),
        range_error: args.range_error,
        cell: args.cell,
    };
    let names = if args.methods.is_empty() { Name::ALL.to_vec() } else { distinct(&args.methods) };
    let said: Vec<Said> = names.iter().map(|name| run_method(*name, &recording, &options)).collect::<Result<_, _>>()?;
    let assessed = match &world {
        Some(world) => {
            let views: Vec<View> = recording.views().iter().copied().collect();
            let judge = Judge::new(world, truth.as_ref(), &views);
            against_world(&said, &judge, world, recording.readings(), recording.ids())?
        }
        None => among_themselves(&said, recording.readings())?,
    };
    let rows: Vec<(Name, &Assessment)> = names.iter().copied().zip(&assessed).collect();
    crate::print(&if args.json { as_json(&rows)? } else { table::text(&rows, &recording, world.is_some()) })?;
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

fn as_json(rows: &[(Name, &Assessment)]) -> Result<String, Failure> {
    let failed = |error: serde_json::Error| Failure::Failed(error.to_string());
    let mut object = Map::new();
    for (name, assessment) in rows {
        object.insert(name.word().to_owned(), row_json(assessment).map_err(failed)?);
    }
    Ok(serde_json::to_string_pretty(&object).map_err(failed)? + "\n")
}

/// The keys of `eval` and what is added to them; null where they don't apply.
fn row_json(assessment: &Assessment) -> Result<Value, serde_json::Error> {
    let mut row = match &assessment.scores {
        Some(scores) => serde_json::to_value(scores)?,
        None => nulls(serde_json::to_value(Scores::default())?),
    };
    let added: BTreeMap<&str, Value> = BTreeMap::from([
        ("points", json!(assessment.points)),
        ("seconds_per_reading", json!(assessment.seconds_per_reading)),
        ("best", serde_json::to_value(&assessment.best)?),
        ("same_readings", serde_json::to_value(&assessment.same_readings)?),
        ("map_entropy_bits", serde_json::to_value(assessment.map_entropy_bits)?),
        ("agreement", serde_json::to_value(&assessment.agreement)?),
    ]);
    if let Some(row) = row.as_object_mut() {
        row.extend(added.into_iter().map(|(key, value)| (key.to_owned(), value)));
    }
    Ok(row)
}

/// The same keys without values.
fn nulls(value: Value) -> Value {
    match value {
        Value::Object(object) => object.into_iter().map(|(key, value)| (key, nulls(value))).collect(),
        _ => Value::Null,
    }
}

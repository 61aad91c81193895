//! `atm eval`: how good echoes are, where the world is known.

use atm::{
    core::{Kind, Reflector},
    log::{View, echo_log::EchoLog},
    summary::Dropped,
};
use atm_lab::{
    eval::{Judge, Metrics, Scores, Spread, evaluate, views},
    truth::Truth,
    world::World,
};

use crate::{Failure, Outcome, args::Eval, report};

/// Inches are what the paper speaks; the table shows both.
const INCH: f64 = 0.0254;
/// Width of a column of the table.
const COLUMN: usize = 16;

/// Runs the command.
pub fn run(args: &Eval) -> Result<Outcome, Failure> {
    let world = World::load(&args.world, &args.set)?;
    let mut dropped = Dropped::default();
    let truth = args.truth.as_deref().map(Truth::read).transpose()?;
    let echoes = EchoLog::open(&args.input)?;
    let estimates: Vec<_> = echoes.estimates(|problem| dropped.add(problem)).collect::<Result<_, _>>()?;
    let scores = match &args.drive {
        Some(path) => Judge::new(&world, truth.as_ref(), &views(args, path, &mut dropped)?).scores(&estimates),
        None => evaluate(&estimates, &world, truth.as_ref()),
    };
    crate::print(&if args.json { as_json(&scores)? } else { as_text(&scores) })?;
    let Some(unusable) = report::unusable(&dropped) else {
        return Ok(Outcome::Done);
    };
    report::say(format_args!("{unusable}"));
    Ok(Outcome::Partly)
}

/// From where the log has looked.
fn views(args: &Eval, path: &str, dropped: &mut Dropped) -> Result<Vec<View>, Failure> {
    let job = args.log.job(path, None, None)?;
    let (format, input) = job.open()?;
    let mut log = job.readings(format, input, false)?;
    let (source, track) = log.source();
    let (views, found) = views::of_log(source, track, &job.sensors()?)?;
    dropped.extend(found);
    Ok(views)
}

fn as_json(scores: &Scores) -> Result<String, Failure> {
    let text = serde_json::to_string_pretty(scores).map_err(|error| Failure::Failed(error.to_string()))?;
    Ok(text + "\n")
}

/// One kind of errors.
type Errors = fn(&Metrics) -> &Spread;

fn as_text(scores: &Scores) -> String {
    // The estimators' kinds in their order, then whatever else there is.
    let sharp = [Reflector::Point, Reflector::Wall].map(Reflector::name);
    let known: Vec<&str> = sharp.into_iter().chain(Kind::ALL.map(Kind::name)).collect();
    let others = scores.by_kind.keys().map(String::as_str).filter(|name| !known.contains(name));
    let kinds = known.iter().copied().chain(others).filter_map(|name| Some((name, scores.by_kind.get(name)?)));
    let columns: Vec<(&str, &Metrics)> = std::iter::once(("all", &scores.all)).chain(kinds).collect();
    let mut text = String::from("lengths in inches (metres)\n");
    let mut row = |name: &str, cells: Vec<String>| {
        let cells: String = cells.into_iter().map(|cell| format!("{cell:>COLUMN$}")).collect();
        text += &format!("{name:<19}{cells}\n");
    };
    let each = |cell: &dyn Fn(&Metrics) -> String| columns.iter().map(|(_, metrics)| cell(metrics)).collect();
    row("", columns.iter().map(|(name, _)| (*name).to_owned()).collect());
    row("points", each(&|metrics| metrics.points.to_string()));
    let azimuth: Errors = |metrics| &metrics.azimuth_error_m;
    let surface: Errors = |metrics| &metrics.surface_error_m;
    for (name, spread) in [("azimuth error", azimuth), ("surface error", surface)] {
        row(&format!("{name:<15}p50"), each(&|metrics| length(spread(metrics).p50)));
        row(&format!("{:<15}p90", ""), each(&|metrics| length(spread(metrics).p90)));
        row(&format!("{:<15}p95", ""), each(&|metrics| length(spread(metrics).p95)));
        row(&format!("{:<15}mean", ""), each(&|metrics| length(spread(metrics).mean)));
    }
    row("coverage", each(&|metrics| share(metrics.coverage)));
    row("ghosts", each(&|metrics| metrics.ghosts.to_string()));
    row("doorway", each(&|metrics| length(metrics.doorway_width_m)));
    text
}

fn share(share: Option<f64>) -> String {
    share.map_or_else(|| "-".to_owned(), |share| format!("{:.1} %", 100.0 * share))
}

/// A length in both units.
fn length(metres: Option<f64>) -> String {
    metres.map_or_else(|| "-".to_owned(), |metres| format!("{:.2} ({metres:.3})", metres / INCH))
}

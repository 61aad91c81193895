//! `atm info`: what is in a log.

use std::{fmt::Write as _, sync::Arc};

use atm::{
    core::Limits,
    error::Result,
    log::{
        Source,
        csv::{CsvReadings, Discover, PoseUse, SensorNames},
    },
    pipeline::AnyTrack,
    rig::{Rig, Sensor},
    stamp,
    survey::{SensorSurvey, Survey, survey},
};
use serde_json::{Map, Value, json};

use crate::{Failure, Outcome, args::Info, command, report};

/// A log with what its sensors are called.
struct Findings {
    format: &'static str,
    ids: Vec<String>,
    survey: Survey,
    pose_source: Option<String>,
    rig: Option<Arc<Rig>>,
}

/// Share of held readings above which it deserves a word.
const MANY_HELD: f64 = 0.2;

/// Runs the command.
pub fn run(args: &Info) -> Result<Outcome, Failure> {
    let rig = command::rig(&args.log)?;
    let findings = match &rig {
        Some(rig) => find(args, Some(rig), Arc::clone(rig))?,
        None => find(args, None, Discover::default())?,
    };
    let problems = problems(&findings);
    let text = if args.json { as_json(&findings, &problems) } else { as_text(args, &findings, &problems) };
    crate::print(&text)?;
    let clean = findings.survey.dropped.total() == 0;
    if let Some(unusable) = report::unusable(&findings.survey.dropped) {
        report::say(format_args!("{unusable}"));
    }
    Ok(if clean { Outcome::Done } else { Outcome::Partly })
}

fn find<N: SensorNames>(args: &Info, rig: Option<&Arc<Rig>>, names: N) -> Result<Findings, Failure> {
    let input = command::open(&args.input, args.from)?;
    let format = command::table_format(rig.map(Arc::as_ref));
    let poses = command::pose_use(&args.log, PoseUse::IfThere);
    let mut source = CsvReadings::new(input, &format, poses, command::empty_cell(&args.log), names)?;
    let mut track = command::track(&args.log, rig.map(Arc::as_ref))?;
    let pose_source = match &track {
        Some((_, kind)) => Some(format!("{} ({kind})", args.log.poses.as_deref().unwrap_or_default())),
        None => source.has_poses().then(|| "columns x, y, yaw".to_owned()),
    };
    let format = if source.is_wide() { "csv-wide" } else { "csv-long" };
    let limits: Vec<Limits<f64>> = rig.map(|rig| rig.sensors().iter().map(limits).collect()).unwrap_or_default();
    let track: Option<&mut AnyTrack> = track.as_mut().map(|(track, _)| track);
    let survey = survey(&mut source, track, &limits)?;
    Ok(Findings {
        format,
        ids: source.ids().iter().map(ToString::to_string).collect(),
        survey,
        pose_source,
        rig: rig.cloned(),
    })
}

fn limits(sensor: &Sensor) -> Limits<f64> {
    Limits::new(sensor.min_range(), sensor.max_range()).unwrap_or(Limits::NONE)
}

/// What a person should know before fusing.
fn problems(findings: &Findings) -> Vec<String> {
    let survey = &findings.survey;
    let mut problems = Vec::new();
    for (reason, count, first) in survey.dropped.iter() {
        problems.push(format!("{count} {}, first at {}: {}", reason.key(), first.place, first.value));
    }
    if survey.clock_resets > 0 {
        problems.push(format!("the clock was set back {} times", survey.clock_resets));
    }
    if findings.pose_source.is_none() {
        problems.push("no poses: columns x, y, yaw are missing; give them with --poses".into());
    }
    let silent: Vec<&str> = findings
        .ids
        .iter()
        .enumerate()
        .filter(|(index, _)| survey.sensors.get(*index).is_none_or(|sensor| sensor.readings == 0))
        .map(|(_, id)| id.as_str())
        .collect();
    if !silent.is_empty() {
        problems.push(format!("no readings from {}", silent.join(", ")));
    }
    let (held, readings) = survey.sensors.iter().fold((0, 0), |(h, r), s| (h + s.held, r + s.readings));
    if held as f64 > MANY_HELD * readings as f64 {
        let share = 100.0 * held as f64 / readings as f64;
        problems.push(format!(
            "{share:.0} % of the readings equal their sensor's previous one; if the ring repeats held values, fuse with --drop-held"
        ));
    }
    problems
}

fn as_json(findings: &Findings, problems: &[String]) -> String {
    let mut sensors = Map::new();
    for (index, id) in findings.ids.iter().enumerate() {
        let seen = findings.survey.sensors.get(index).copied().unwrap_or_default();
        let sensor = findings.rig.as_ref().and_then(|rig| rig.sensors().get(index));
        sensors.insert(id.clone(), sensor_json(&seen, sensor));
    }
    let object = json!({
        "format": findings.format,
        "sensors": Value::Object(sensors),
        "start_ns": findings.survey.start,
        "end_ns": findings.survey.end,
        "pose_source": findings.pose_source,
        "empty": findings.survey.empty,
        "clock_resets": findings.survey.clock_resets,
        "longest_gap_s": findings.survey.longest_gap.map(|(gap, _)| gap as f64 * 1e-9),
        "problems": problems,
    });
    format!("{object:#}\n")
}

fn sensor_json(seen: &SensorSurvey, sensor: Option<&Sensor>) -> Value {
    json!({
        "topic": sensor.and_then(Sensor::topic),
        "readings": seen.readings,
        "no_echo": seen.no_echo,
        "held": seen.held,
        "rate_hz": seen.rate(),
        "field_of_view_rad": sensor.and_then(Sensor::field_of_view),
        "min_range_m": sensor.map(Sensor::min_range),
        // An infinite maximum has no number in JSON: null, as for an unknown one.
        "max_range_m": sensor.map(Sensor::max_range),
    })
}

fn as_text(args: &Info, findings: &Findings, problems: &[String]) -> String {
    let survey = &findings.survey;
    let name = if args.input == "-" { "standard input" } else { &args.input };
    let mut text = format!("{name}: {}, {} sensors\n", findings.format, findings.ids.len());
    match (survey.start, survey.end) {
        (Some(start), Some(end)) => {
            let seconds = end.abs_diff(start) as f64 * 1e-9;
            let _ = writeln!(text, "time      {} to {} s ({seconds:.3} s)", stamp::text(start), stamp::text(end));
        }
        _ => text.push_str("time      no usable record\n"),
    }
    if let Some((gap, since)) = survey.longest_gap {
        let _ = writeln!(text, "gap       {:.3} s at most, after {} s", gap as f64 * 1e-9, stamp::text(since));
    }
    let _ = writeln!(text, "poses     {}", findings.pose_source.as_deref().unwrap_or("none"));
    if survey.empty > 0 {
        let _ = writeln!(text, "empty     {} cells skipped", survey.empty);
    }
    let width = findings.ids.iter().map(|id| id.chars().count()).max().unwrap_or(0).max("sensor".len());
    let _ = writeln!(text, "\n{:width$}  readings  no echo     held  rate", "sensor");
    for (index, id) in findings.ids.iter().enumerate() {
        let seen = survey.sensors.get(index).copied().unwrap_or_default();
        let rate = seen.rate().map_or_else(|| "-".to_owned(), |rate| format!("{rate:.2} Hz"));
        let _ = writeln!(text, "{id:width$}  {:8}  {:7}  {:7}  {rate}", seen.readings, seen.no_echo, seen.held);
    }
    for problem in problems {
        let _ = writeln!(text, "\nproblem: {problem}");
    }
    text
}

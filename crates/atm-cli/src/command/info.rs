//! `atm info`: what is in a log.

use std::{fmt::Write as _, sync::Arc};

use atm::{
    core::Limits,
    error::Error,
    job::{LogJob, poses_of},
    log::{
        Input, Source,
        csv::{CsvReadings, Discover, PoseUse, SensorNames},
        format::Format,
        mcap::McapReadings,
    },
    pipeline::AnyTrack,
    rig::{Rig, Sensor},
    stamp,
    survey::{SensorSurvey, Survey, survey},
};
use serde_json::{Map, Value, json};

use crate::{Failure, Outcome, args::Info, report};

/// A log with what its sensors are called.
struct Findings {
    format: &'static str,
    ids: Vec<String>,
    /// By the sensor's index, where a recording says it.
    topics: Vec<Option<String>>,
    survey: Survey,
    pose_source: Option<String>,
    /// What a recording has to say of how it was read.
    notes: Vec<String>,
    rig: Option<Arc<Rig>>,
}

/// Share of held readings above which it deserves a word.
const MANY_HELD: f64 = 0.2;

/// Runs the command.
pub fn run(args: &Info) -> Result<Outcome, Failure> {
    let job = args.log.job(&args.input, args.from, None)?;
    let (format, input) = job.open()?;
    let findings = match &job.rig {
        _ if format == Format::Mcap => find_mcap(&job, input)?,
        Some(rig) => find(&job, input, Arc::clone(rig))?,
        None => find(&job, input, Discover::default())?,
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

fn find<N: SensorNames>(job: &LogJob, input: Input, names: N) -> Result<Findings, Error> {
    let rig = job.rig.as_ref();
    let format = rig.and_then(|rig| rig.log()).map(|formats| formats.readings.clone()).unwrap_or_default();
    let poses = if job.poses.is_some() { PoseUse::Ignored } else { PoseUse::IfThere };
    let mut source = CsvReadings::new(input, &format, poses, job.empty, names)?;
    let mut track = job.track()?;
    let pose_source = match &track {
        Some((_, kind)) => Some(second_file(job, kind)),
        None => source.has_poses().then(|| "columns x, y, yaw".to_owned()),
    };
    let format = if source.is_wide() { "csv-wide" } else { "csv-long" };
    let limits: Vec<Limits<f64>> = rig.map(|rig| rig.sensors().iter().map(limits).collect()).unwrap_or_default();
    let track: Option<&mut AnyTrack> = track.as_mut().map(|(track, _)| track);
    let survey = survey(&mut source, track, &limits)?;
    Ok(Findings {
        format,
        ids: source.ids().iter().map(ToString::to_string).collect(),
        topics: Vec::new(),
        survey,
        pose_source,
        notes: Vec::new(),
        rig: rig.cloned(),
    })
}

fn find_mcap(job: &LogJob, input: Input) -> Result<Findings, Error> {
    let track = job.track()?;
    let second_file = track.as_ref().map(|(_, kind)| second_file(job, kind));
    let track = track.map(|(track, _)| track);
    let options = job.options(PoseUse::IfThere);
    let mut source = McapReadings::open(&job.input, input, job.rig.clone(), track, options)?;
    let survey = survey(&mut source, None, &[])?;
    let ids: Vec<String> = source.ids().iter().map(ToString::to_string).collect();
    let topics = (0..=u16::MAX).zip(&ids).map(|(sensor, _)| source.topic(sensor).map(str::to_owned));
    Ok(Findings {
        format: "mcap",
        topics: topics.collect(),
        ids,
        survey,
        pose_source: second_file.or_else(|| poses_of(&source)),
        notes: source.clock_words().into_iter().chain(source.notes()).collect(),
        rig: job.rig.clone(),
    })
}

fn second_file(job: &LogJob, kind: &str) -> String {
    format!("{} ({kind})", job.poses.as_deref().unwrap_or_default())
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
        problems.push(match findings.format {
            "mcap" => "no poses that hang together with the sensors; give them with --poses".into(),
            _ => "no poses: columns x, y, yaw are missing; give them with --poses".into(),
        });
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
        let topic = findings.topics.get(index).and_then(Option::as_deref);
        sensors.insert(id.clone(), sensor_json(&seen, sensor, topic));
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

fn sensor_json(seen: &SensorSurvey, sensor: Option<&Sensor>, topic: Option<&str>) -> Value {
    let limits = seen.sight.map(|(limits, _)| limits).or_else(|| sensor.map(limits));
    let beam = seen.sight.map(|(_, beam)| beam.field_of_view());
    json!({
        "topic": topic.or_else(|| sensor.and_then(Sensor::topic)),
        "readings": seen.readings,
        "no_echo": seen.no_echo,
        "held": seen.held,
        "rate_hz": seen.rate(),
        "field_of_view_rad": beam.or_else(|| sensor.and_then(Sensor::field_of_view)),
        "min_range_m": limits.map(|limits| limits.min()),
        // An infinite maximum has no number in JSON: null, as for an unknown one.
        "max_range_m": limits.map(|limits| limits.max()),
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
    for note in &findings.notes {
        let _ = writeln!(text, "{note}");
    }
    if survey.empty > 0 {
        let _ = writeln!(text, "empty     {} cells skipped", survey.empty);
    }
    text.push_str(&table(findings));
    for problem in problems {
        let _ = writeln!(text, "\nproblem: {problem}");
    }
    text
}

/// The sensors, one a line.
fn table(findings: &Findings) -> String {
    let survey = &findings.survey;
    let mut text = String::new();
    let sights = survey.sensors.iter().any(|sensor| sensor.sight.is_some());
    let width = findings.ids.iter().map(|id| id.chars().count()).max().unwrap_or(0).max("sensor".len());
    let more = if sights { "           beam      min      max  topic" } else { "" };
    let _ = writeln!(text, "\n{:width$}  readings  no echo     held  rate{more}", "sensor");
    for (index, id) in findings.ids.iter().enumerate() {
        let seen = survey.sensors.get(index).copied().unwrap_or_default();
        let rate = seen.rate().map_or_else(|| "-".to_owned(), |rate| format!("{rate:.2} Hz"));
        let _ = write!(text, "{id:width$}  {:8}  {:7}  {:7}  ", seen.readings, seen.no_echo, seen.held);
        let _ = match seen.sight {
            None => writeln!(text, "{rate}"),
            Some((limits, beam)) => {
                let (beam, min, max) = (beam.field_of_view().to_degrees(), limits.min(), limits.max());
                let topic = findings.topics.get(index).and_then(Option::as_deref).unwrap_or_default();
                writeln!(text, "{rate:10}  {beam:5.1}deg  {min:5.2} m  {max:5.2} m  {topic}")
            }
        };
    }
    text
}

//! `atm info`: what is in a log.
mod text;

use std::sync::Arc;

use atm::{
    core::{Limits, MinAngle, resolution},
    diagnose::{Diagnosis, MapSpan, PAPER_REACH, SensorEvidence, map_travel},
    error::Error,
    job::{LogJob, poses_of},
    log::{
        Input, Source,
        csv::{CsvReadings, Discover, PoseUse, SensorNames},
        format::Format,
        joined::Joined,
        mcap::McapReadings,
        sorted::Sorted,
    },
    pipeline::{AnyTrack, History},
    rig::{Rig, Sensor},
    survey::{Survey, survey},
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
    /// The command that is recommended.
    command: String,
}

/// What the local map is to span, at which distance, and what it does span, in metres.
struct Travel {
    needs: f64,
    reach: f64,
    spans: f64,
}

/// Runs the command.
pub fn run(args: &Info) -> Result<Outcome, Failure> {
    let job = args.log.job(&args.input, args.from, None)?;
    let (format, input) = job.open()?;
    let mut findings = match &job.rig {
        _ if format == Format::Mcap => find_mcap(&job, input)?,
        Some(rig) => find(&job, input, Arc::clone(rig))?,
        None => find(&job, input, Discover::default())?,
    };
    add_problems(&mut findings);
    findings.command = command(args, &findings);
    let text = if args.json { as_json(&findings) } else { text::of(args, &findings) };
    crate::print(&text)?;
    let clean = findings.survey.dropped.total() == 0;
    if let Some(unusable) = report::unusable(&findings.survey.dropped) {
        report::say(format_args!("{unusable}"));
    }
    Ok(if clean { Outcome::Done } else { Outcome::Partly })
}

fn find<N: SensorNames>(job: &LogJob, input: Input, names: N) -> Result<Findings, Error> {
    let rig = job.rig.as_ref();
    let format = job.table_format();
    let poses = if job.poses.is_some() { PoseUse::Ignored } else { PoseUse::IfThere };
    let live = input.length.is_none();
    let source = CsvReadings::new(input, &format, poses, job.empty, names)?;
    let mut track = job.track()?;
    let pose_source = match &track {
        Some((_, kind)) => Some(second_file(job, kind)),
        None => source.has_poses().then(|| "columns x, y, yaw".to_owned()),
    };
    let format = if source.is_wide() { "csv-wide" } else { "csv-long" };
    let track: Option<&mut AnyTrack> = track.as_mut().map(|(track, _)| track);
    let models = job.sensors()?;
    let (survey, ids) = if live {
        let mut source = Joined::new(source.joined_midway(), job.max_gap());
        (survey(&mut source, track, &models)?, source.ids().to_vec())
    } else {
        let mut source = Joined::new(Sorted::new(source), job.max_gap());
        (survey(&mut source, track, &models)?, source.ids().to_vec())
    };
    Ok(Findings {
        format,
        ids: ids.iter().map(ToString::to_string).collect(),
        topics: Vec::new(),
        survey,
        pose_source,
        notes: Vec::new(),
        rig: rig.cloned(),
        command: String::new(),
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
        command: String::new(),
    })
}

fn second_file(job: &LogJob, kind: &str) -> String {
    format!("{} ({kind})", job.poses.as_deref().unwrap_or_default())
}

/// Adds what follows from what the log lacks.
fn add_problems(findings: &mut Findings) {
    let survey = &mut findings.survey;
    let (readings, unusable) = (survey.evidence.readings(), survey.dropped.total());
    // What was dropped has causes of its own; poses are to blame where nothing else is.
    if findings.pose_source.is_none() && readings > 0 && unusable == 0 {
        survey.problems.insert(0, Diagnosis::NoPoses { readings });
    }
    let is_silent = |index: usize| survey.evidence.sensors.get(index).is_none_or(|sensor| sensor.readings == 0);
    let silent = findings.ids.iter().enumerate().filter(|(index, _)| is_silent(*index));
    let sensors: Vec<String> = silent.map(|(_, id)| id.clone()).collect();
    if !sensors.is_empty() {
        survey.problems.push(Diagnosis::Silent { sensors });
    }
}

/// The command that is recommended for this log.
fn command(args: &Info, findings: &Findings) -> String {
    let mut words = vec!["atm fuse".to_owned(), quoted(&args.input)];
    match &args.log.rig {
        Some(rig) => words.extend(["--rig".into(), quoted(rig)]),
        None if findings.format == "mcap" => {}
        None => words.push("--rig RIG.toml".into()),
    }
    match &args.log.poses {
        Some(poses) => words.extend(["--poses".into(), quoted(poses)]),
        None if findings.pose_source.is_none() => words.push("--poses FILE".into()),
        None => {}
    }
    words.extend(args.log.others());
    for flag in findings.survey.problems.iter().filter_map(Diagnosis::command_flag) {
        if !words.iter().any(|word| word == flag) {
            words.push(flag.into());
        }
    }
    words.push(format!("-o echoes.{}", if findings.format == "mcap" { "mcap" } else { "csv" }));
    words.join(" ")
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "/._-+=:,@%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

/// What the local map spans on this drive by default, and what crossings take; `None` without poses.
fn travel(findings: &Findings) -> Option<Travel> {
    let evidence = &findings.survey.evidence;
    evidence.poses.bounds?;
    let reach = evidence.reach().map_or(PAPER_REACH, |reach| reach.min(PAPER_REACH));
    let needs = resolution::travel(reach, &MinAngle::PAPER).ok()?;
    // By default it spans what is needed.
    Some(Travel { needs, reach, spans: map_travel(evidence, MapSpan::Travel(needs * History::MARGIN)) })
}

fn as_json(findings: &Findings) -> String {
    let (survey, evidence) = (&findings.survey, &findings.survey.evidence);
    let mut sensors = Map::new();
    for (index, id) in findings.ids.iter().enumerate() {
        let seen = evidence.sensors.get(index).cloned().unwrap_or_default();
        let sensor = findings.rig.as_ref().and_then(|rig| rig.sensors().get(index));
        let topic = findings.topics.get(index).and_then(Option::as_deref);
        sensors.insert(id.clone(), sensor_json(&seen, sensor, topic));
    }
    let problems: Vec<String> = survey.problems.iter().map(ToString::to_string).collect();
    let travel = travel(findings);
    let poses = &evidence.poses;
    let object = json!({
        "format": findings.format,
        "sensors": Value::Object(sensors),
        "start_ns": evidence.span.map(|(start, _)| start),
        "end_ns": evidence.span.map(|(_, end)| end),
        "pose_source": findings.pose_source,
        "extent_m": poses.extent(),
        "path_m": poses.bounds.map(|_| poses.path),
        "speed_m_s": poses.bounds.and_then(|_| poses.speed()),
        "reach_m": travel.as_ref().map(|travel| travel.reach),
        "needed_travel_m": travel.as_ref().map(|travel| travel.needs),
        "map_travel_m": travel.as_ref().map(|travel| travel.spans),
        "empty": survey.empty,
        "clock_resets": survey.clock_resets,
        "longest_gap_s": survey.longest_gap.map(|(gap, _)| gap as f64 * 1e-9),
        "problems": problems,
        "advice": survey.problems,
        "command": findings.command,
    });
    format!("{object:#}\n")
}

fn sensor_json(seen: &SensorEvidence, sensor: Option<&Sensor>, topic: Option<&str>) -> Value {
    let of_rig = |sensor: &Sensor| Limits::new(sensor.min_range(), sensor.max_range()).unwrap_or(Limits::NONE);
    let limits = seen.sight.map(|(limits, _)| limits).or_else(|| sensor.map(of_rig));
    // A rig that leaves the beam open has a default where the log is read, which is no more than that.
    let beam = match sensor {
        Some(sensor) => sensor.field_of_view(),
        None => seen.sight.map(|(_, beam)| beam.field_of_view()),
    };
    json!({
        "topic": topic.or_else(|| sensor.and_then(Sensor::topic)),
        "readings": seen.readings,
        "no_echo": seen.no_echo(),
        "no_echo_share": (seen.readings > 0).then(|| seen.no_echo() as f64 / seen.readings as f64),
        "held": seen.held,
        "rate_hz": seen.rate(),
        "range_m": {"p5": seen.quantile(0.05), "p50": seen.quantile(0.5), "p95": seen.quantile(0.95)},
        "field_of_view_rad": beam,
        "min_range_m": limits.map(|limits| limits.min()),
        // An infinite maximum has no number in JSON: null, as for an unknown one.
        "max_range_m": limits.map(|limits| limits.max()),
    })
}

//! What is in a log, for a person.

use std::fmt::Write as _;

use atm::{core::MinAngle, stamp};

use super::{Findings, Travel, travel};
use crate::args::Info;

pub(super) fn of(args: &Info, findings: &Findings) -> String {
    let survey = &findings.survey;
    let name = if args.input == "-" { "standard input" } else { &args.input };
    let count = findings.ids.len();
    let mut text = format!("{name}: {}, {count} sensor{}\n", findings.format, if count == 1 { "" } else { "s" });
    match survey.evidence.span {
        Some((start, end)) => {
            let seconds = end.abs_diff(start) as f64 * 1e-9;
            let _ = writeln!(text, "time      {} to {} s ({seconds:.3} s)", stamp::text(start), stamp::text(end));
        }
        None => text.push_str("time      no usable record\n"),
    }
    if let Some((gap, since)) = survey.longest_gap {
        let _ = writeln!(text, "gap       {:.3} s at most, after {} s", gap as f64 * 1e-9, stamp::text(since));
    }
    let _ = writeln!(text, "poses     {}", findings.pose_source.as_deref().unwrap_or("none"));
    path(&mut text, findings);
    for note in &findings.notes {
        let _ = writeln!(text, "{note}");
    }
    if survey.empty > 0 {
        let _ = writeln!(text, "empty     {} cell{} skipped", survey.empty, if survey.empty == 1 { "" } else { "s" });
    }
    text.push_str(&table(findings));
    for problem in &survey.problems {
        let _ = writeln!(text, "\nproblem: {problem}");
    }
    let _ = writeln!(text, "\ntry: {}", findings.command);
    text
}

/// Where the robot went, and whether that is enough.
fn path(text: &mut String, findings: &Findings) {
    let poses = &findings.survey.evidence.poses;
    let Some([x, y]) = poses.extent() else { return };
    let speed = poses.speed().map_or_else(String::new, |speed| format!(", {speed:.3} m/s"));
    let _ = writeln!(text, "path      {:.3} m long, within {x:.3} m by {y:.3} m{speed}", poses.path);
    if let Some(Travel { needs, reach, spans }) = travel(findings) {
        let angle = MinAngle::<f64>::PAPER.radians().to_degrees();
        let _ = writeln!(
            text,
            "travel    {spans:.3} m in the local map; crossings of {angle:.0}deg at {reach:.2} m take {needs:.3} m"
        );
    }
}

/// The sensors, one a line.
fn table(findings: &Findings) -> String {
    let evidence = &findings.survey.evidence;
    let mut text = String::new();
    let recorded = !findings.topics.is_empty();
    let width = findings.ids.iter().map(|id| id.chars().count()).max().unwrap_or(0).max("sensor".len());
    let more = if recorded { "     beam      min      max  topic" } else { "" };
    let _ = writeln!(
        text,
        "\n{:width$}  readings  no echo         held  rate        range 5 %  50 %   95 %{more}",
        "sensor"
    );
    for (index, id) in findings.ids.iter().enumerate() {
        let seen = evidence.sensors.get(index).cloned().unwrap_or_default();
        let rate = seen.rate().map_or_else(|| "-".to_owned(), |rate| format!("{rate:.2} Hz"));
        let share = 100.0 * seen.no_echo() as f64 / seen.readings.max(1) as f64;
        let range = |share| seen.quantile(share).map_or_else(|| "-".to_owned(), |range| format!("{range:.2}"));
        let (low, middle, high) = (range(0.05), range(0.5), range(0.95));
        let _ = write!(
            text,
            "{id:width$}  {:8}  {:7} {share:3.0} % {:7}  {rate:10}  {low:>9}  {middle:>5}  {high:>5}",
            seen.readings,
            seen.no_echo(),
            seen.held
        );
        match seen.sight.filter(|_| recorded) {
            None => text.push('\n'),
            Some((limits, beam)) => {
                let (beam, min, max) = (beam.field_of_view().to_degrees(), limits.min(), limits.max());
                let topic = findings.topics.get(index).and_then(Option::as_deref).unwrap_or_default();
                let _ = writeln!(text, "  {beam:5.1}deg  {min:5.2} m  {max:5.2} m  {topic}");
            }
        }
    }
    text
}

//! What is in a log: sensors, counts, rates, time span, poses, problems.

use atm_core::{Beam, Limits, Meaning};

use crate::{
    error::Result,
    log::{Next, Row, Source},
    pipeline::AnyTrack,
    summary::Dropped,
    track::{Clock, Tick, time_backwards},
};

/// One sensor's part in a log.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SensorSurvey {
    /// Readings, those without echo included.
    pub readings: u64,
    /// Readings without an echo.
    pub no_echo: u64,
    /// Readings equal to the sensor's previous one.
    pub held: u64,
    /// Limits and beam of its last reading, where the log says them.
    pub sight: Option<(Limits<f64>, Beam<f64>)>,
    span: Option<(i64, i64)>,
}

impl SensorSurvey {
    /// Readings in a second over the time from the first to the last; `None` below two instants.
    pub fn rate(&self) -> Option<f64> {
        let (first, last) = self.span?;
        let seconds = last.abs_diff(first) as f64 * 1e-9;
        (seconds > 0.0).then(|| self.readings.saturating_sub(1) as f64 / seconds)
    }
}

/// What is in a log.
#[derive(Debug, Clone, Default)]
pub struct Survey {
    /// By the sensor's index.
    pub sensors: Vec<SensorSurvey>,
    /// Time of the first usable record, in nanoseconds; clock resets begin a new count but not a new span.
    pub start: Option<i64>,
    /// Time of the last usable record, in nanoseconds.
    pub end: Option<i64>,
    /// Records that can't be used.
    pub dropped: Dropped,
    /// Empty cells that were skipped.
    pub empty: u64,
    /// Times at which the clock was set back.
    pub clock_resets: u32,
    /// The longest time between two usable records, in nanoseconds, and when it began.
    pub longest_gap: Option<(u64, i64)>,
}

/// Reads a log to its end. `limits` say by the sensor's index what is an echo where the log does not say it itself; sensors beyond
/// them have none.
///
/// # Errors
/// The log can't be read on.
pub fn survey(source: &mut dyn Source, mut track: Option<&mut AnyTrack>, limits: &[Limits<f64>]) -> Result<Survey> {
    let mut survey = Survey { sensors: vec![SensorSurvey::default(); limits.len()], ..Survey::default() };
    let (mut clock, mut row, mut last) = (Clock::new(), Row::default(), Vec::new());
    loop {
        match source.next_row(&mut row, &mut |problem| survey.dropped.add(problem))? {
            Next::Record => {}
            Next::Unusable => continue,
            Next::End => return Ok(survey),
        }
        if !clock.is_forward(row.t) {
            survey.dropped.add(time_backwards(row.t, clock.now(), row.place.clone()));
            survey.clock_resets += u32::from(clock.admit(row.t) == Tick::Reset);
            continue;
        }
        if let Some(track) = track.as_deref_mut() {
            let pose = track.pose_at(survey.clock_resets, row.t, &mut |problem| survey.dropped.add(problem))?;
            if pose.is_none() {
                survey.dropped.add(crate::intake::no_pose(&row, Some(track.miss())));
                continue;
            }
        }
        if !row.readings.is_empty() {
            clock.admit(row.t);
        }
        survey.add(&row, limits, &mut last);
    }
}

impl Survey {
    fn add(&mut self, row: &Row, limits: &[Limits<f64>], last: &mut Vec<Option<f64>>) {
        if let Some(end) = self.end {
            let gap = row.t.abs_diff(end);
            if row.t > end && self.longest_gap.is_none_or(|(longest, _)| gap > longest) {
                self.longest_gap = Some((gap, end));
            }
        }
        self.start = self.start.or(Some(row.t));
        self.end = Some(row.t);
        self.empty += row.empty;
        for (number, &(sensor, range)) in row.readings.iter().enumerate() {
            let view = row.views.get(number);
            let index = usize::from(sensor);
            if index >= self.sensors.len() {
                self.sensors.resize(index + 1, SensorSurvey::default());
            }
            if index >= last.len() {
                last.resize(index + 1, None);
            }
            let limits = view.map(|view| view.limits).or_else(|| limits.get(index).copied()).unwrap_or(Limits::NONE);
            let echo = limits.classify(range);
            if let (Some(seen), Some(last)) = (self.sensors.get_mut(index), last.get_mut(index)) {
                seen.readings += 1;
                seen.sight = view.map(|view| (view.limits, view.beam)).or(seen.sight);
                seen.no_echo += u64::from(echo.meaning() != Meaning::Echo);
                let value = echo.echo().unwrap_or(f64::NAN);
                seen.held += u64::from(last.replace(value).is_some_and(|last| last.total_cmp(&value).is_eq()));
                seen.span = Some((seen.span.map_or(row.t, |(first, _)| first), row.t));
            }
        }
    }
}

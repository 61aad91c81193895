//! What is in a log: sensors, counts, rates, time span, poses, problems.

use atm_core::MinAngle;

use crate::{
    diagnose::{Diagnosis, Evidence, diagnose},
    error::Result,
    intake::SensorModel,
    log::{Next, Row, Source},
    pipeline::AnyTrack,
    summary::Dropped,
    track::{Clock, Tick, time_backwards},
};

/// What is in a log.
#[derive(Debug, Clone, Default)]
pub struct Survey {
    /// Its sensors, its poses, and its time.
    pub evidence: Evidence,
    /// Records that can't be used.
    pub dropped: Dropped,
    /// Empty cells that were skipped.
    pub empty: u64,
    /// Times at which the clock was set back.
    pub clock_resets: u32,
    /// The longest time between two usable records, in nanoseconds, and when it began.
    pub longest_gap: Option<(u64, i64)>,
    /// What is likely wrong, the costliest first.
    pub problems: Vec<Diagnosis>,
}

/// Reads a log to its end. `models` describe by the sensor's index what the log does not say itself; sensors beyond them have no
/// limits.
///
/// # Errors
/// The log can't be read on.
pub fn survey(source: &mut dyn Source, mut track: Option<&mut AnyTrack>, models: &[SensorModel]) -> Result<Survey> {
    let mut survey = Survey { evidence: Evidence::new(Some(MinAngle::PAPER)), ..Survey::default() };
    let (mut clock, mut row) = (Clock::new(), Row::default());
    loop {
        match source.next_row(&mut row, &mut |problem| survey.dropped.add(problem))? {
            Next::Record => {}
            Next::Unusable => continue,
            Next::End => break,
        }
        if !clock.is_forward(row.t) {
            survey.dropped.add(time_backwards(row.t, clock.now(), row.place.clone()));
            if clock.admit(row.t) == Tick::Reset {
                survey.clock_resets += 1;
                survey.evidence.clock_reset();
            }
            continue;
        }
        let mut pose = row.pose;
        if let Some(track) = track.as_deref_mut() {
            pose = track.pose_at(survey.clock_resets, row.t, &mut |problem| survey.dropped.add(problem))?;
            if pose.is_none() {
                survey.dropped.add(crate::intake::no_pose(&row, Some(track.miss())));
                continue;
            }
        }
        if !row.readings.is_empty() {
            clock.admit(row.t);
        }
        survey.note_gap(row.t);
        survey.empty += row.empty;
        survey.evidence.record(&row, pose, models);
    }
    let (resets, found) = (u64::from(survey.clock_resets), source.diagnoses());
    survey.problems = diagnose(&survey.evidence, &survey.dropped, resets, false, None, found);
    Ok(survey)
}

impl Survey {
    fn note_gap(&mut self, t: i64) {
        if let Some((_, last)) = self.evidence.span
            && t > last
            && self.longest_gap.is_none_or(|(longest, _)| t.abs_diff(last) > longest)
        {
            self.longest_gap = Some((t.abs_diff(last), last));
        }
    }
}

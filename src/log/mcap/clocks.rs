//! Which of a message's times counts, and whether the clocks of a recording are the same.

use std::{collections::BTreeMap, sync::Arc};

use super::{finding::Finding, raw::Message};
use crate::{error::Reason, sample::Sample, track::seconds};

/// The times of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ClockChoice {
    /// The stamp in its header: when it was measured.
    #[default]
    Header,
    /// When it was recorded.
    Log,
    /// When it was sent.
    Publish,
}

/// Stamps farther from the time of recording than this are of another clock: 1 h, in nanoseconds.
const FAR: u64 = 3_600_000_000_000;
/// Offsets that differ by less are the same: 10 ms, in nanoseconds.
const SAME: u64 = 10_000_000;
/// Topics that are listed, at most.
const MOST_SHOWN: usize = 8;

/// The share of the largest gap of poses from which on another clock deserves a word: a quarter.
const NOTEWORTHY: u64 = 4;

/// The times that were met.
pub(super) struct Clocks {
    choice: ClockChoice,
    /// By topic, by how much stamps are later than the times of their recording, in nanoseconds.
    offsets: BTreeMap<Arc<str>, Sample<i64>>,
    /// By topic of readings, by how much its stamps are later than those of its poses, against the times of recording, in nanoseconds.
    lags: BTreeMap<Arc<str>, Sample<i64>>,
    /// The recording has a topic with a simulated time.
    pub(super) is_simulated: bool,
}

impl Clocks {
    pub(super) fn new(choice: ClockChoice) -> Self {
        Self { choice, offsets: BTreeMap::new(), lags: BTreeMap::new(), is_simulated: false }
    }

    /// The time of a message in nanoseconds; else why it has none.
    pub(super) fn time(
        &mut self,
        topic: &Arc<str>,
        stamp: Option<i64>,
        message: &Message<'_>,
    ) -> Result<i64, (Reason, &'static str)> {
        let of_file = |time: u64| i64::try_from(time).map_err(|_| (Reason::BadNumber, "its time is out of reach"));
        if let (Some(stamp), Ok(log_time)) = (stamp.filter(|stamp| *stamp != 0), of_file(message.log_time)) {
            let offset = stamp.saturating_sub(log_time);
            match self.offsets.get_mut(topic) {
                Some(offsets) => offsets.add(offset),
                None => self.offsets.entry(topic.clone()).or_default().add(offset),
            }
        }
        match (self.choice, stamp) {
            (ClockChoice::Header, Some(0)) => {
                Err((Reason::NoStamp, "the stamp in its header is 0; --clock log takes the time of recording"))
            }
            (ClockChoice::Header, Some(stamp)) => Ok(stamp),
            (ClockChoice::Header, None) => Err((Reason::BadNumber, "the stamp in its header is out of reach")),
            (ClockChoice::Log, _) => of_file(message.log_time),
            (ClockChoice::Publish, _) => of_file(message.publish_time),
        }
    }

    /// By how much a reading's stamp is later than those of its poses, against the times of recording, in nanoseconds.
    pub(super) fn compare(&mut self, topic: &Arc<str>, lag: i64) {
        match self.lags.get_mut(topic) {
            Some(lags) => lags.add(lag),
            None => self.lags.entry(topic.clone()).or_default().add(lag),
        }
    }

    /// Which topics' clocks are apart from those of their poses, so far that it matters where poses may be `max_gap` nanoseconds
    /// from a reading.
    pub(super) fn lag(&self, max_gap: u64) -> Option<Finding> {
        let lags = self.lags.iter().filter_map(|(topic, lags)| Some((topic, lags.median()?)));
        let mut far: Vec<(&Arc<str>, i64)> =
            lags.filter(|(_, lag)| lag.unsigned_abs() > max_gap / NOTEWORTHY).collect();
        far.sort_by_key(|(topic, lag)| (std::cmp::Reverse(lag.unsigned_abs()), Arc::clone(topic)));
        let (topic, offset) = far.first()?;
        Some(Finding::ClockOffset { topic: topic.to_string(), others: far.len() - 1, offset: *offset })
    }

    fn medians(&self) -> impl Iterator<Item = (&Arc<str>, i64)> {
        self.offsets.iter().filter_map(|(topic, offsets)| Some((topic, offsets.median()?)))
    }

    /// That time is simulated, or that it is for some.
    pub(super) fn other(&self) -> Option<Finding> {
        let is_far = |(_, offset): &(&Arc<str>, i64)| offset.unsigned_abs() > FAR;
        let (far, near): (Vec<_>, Vec<_>) = self.medians().partition(is_far);
        let (topic, offset) = far.first()?;
        Some(Finding::OtherClock {
            topic: topic.to_string(),
            offset: *offset,
            other: near.first().map(|(other, _)| other.to_string()),
            simulated: self.is_simulated,
            by_stamp: self.choice == ClockChoice::Header,
        })
    }

    /// By how much stamps are later than the times of recording, in words; `None` where there are none.
    pub(super) fn words(&self) -> Option<String> {
        let shown = |offset: i64| {
            let sign = if offset < 0 { "-" } else { "+" };
            format!("{sign}{}", seconds(offset.unsigned_abs()))
        };
        let mut offsets: Vec<(&Arc<str>, i64)> = self.medians().collect();
        offsets.sort_by_key(|(_, offset)| *offset);
        let ((_, least), (_, most)) = (offsets.first()?, offsets.last()?);
        if least.abs_diff(*most) <= SAME {
            return Some(format!("clock     stamps are {} from the times of recording", shown(*least)));
        }
        let listed = offsets.iter().take(MOST_SHOWN).map(|(topic, offset)| format!("{topic} {}", shown(*offset)));
        let listed: Vec<String> = listed.collect();
        let more = match offsets.len().saturating_sub(MOST_SHOWN) {
            0 => String::new(),
            more => format!(", and {more} more up to {}", shown(*most)),
        };
        Some(format!("clock     stamps against the times of recording: {}{more}", listed.join(", ")))
    }
}

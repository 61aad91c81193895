//! Which of a message's times counts, and whether the clocks of a recording are the same.

use std::{collections::BTreeMap, sync::Arc};

use super::raw::Message;
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
const FAR: i128 = 3_600_000_000_000;

/// The share of the largest gap of poses from which on another clock deserves a word: a quarter.
const NOTEWORTHY: u64 = 4;

/// The times that were met.
pub(super) struct Clocks {
    choice: ClockChoice,
    /// By topic, how far the first stamp was from the time of its recording, in nanoseconds.
    offsets: BTreeMap<Arc<str>, i128>,
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
        if let Some(stamp) = stamp.filter(|stamp| *stamp != 0)
            && !self.offsets.contains_key(topic)
        {
            self.offsets.insert(topic.clone(), i128::from(stamp) - i128::from(message.log_time));
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
    pub(super) fn lags(&self, max_gap: u64) -> Option<String> {
        let lags = self.lags.iter().filter_map(|(topic, lags)| Some((topic, lags.median()?)));
        let mut far: Vec<(&Arc<str>, i64)> =
            lags.filter(|(_, lag)| lag.unsigned_abs() > max_gap / NOTEWORTHY).collect();
        far.sort_by_key(|(topic, lag)| (std::cmp::Reverse(lag.unsigned_abs()), Arc::clone(topic)));
        let (first, lag) = far.first()?;
        let more = match far.len() {
            1 => String::new(),
            count => format!(" (and of {} more topics)", count - 1),
        };
        Some(format!(
            "warning: the stamps of {first}{more} are {} {} those of its poses, measured against the times of recording: if its \
             clock is wrong, --clock log is right; if its messages only come late, the stamps are",
            seconds(lag.unsigned_abs()),
            if *lag > 0 { "ahead of" } else { "behind" },
        ))
    }

    /// What is to be said of the clocks: that time is simulated, or that it is for some.
    pub(super) fn words(&self) -> Option<String> {
        let is_far = |offset: &i128| offset.abs() > FAR;
        let (far, near): (Vec<_>, Vec<_>) = self.offsets.iter().partition(|(_, offset)| is_far(offset));
        let (first, offset) = far.first()?;
        let seconds = **offset as f64 * 1e-9;
        let simulated = if self.is_simulated { ", which are of a simulated time" } else { "" };
        Some(match near.first() {
            None => format!("the stamps{simulated} are {seconds:.0} s from the times of recording"),
            Some((other, _)) => format!(
                "the stamps of {first} are {seconds:.0} s from the times of recording, those of {other} are not: one of them is \
                 of another clock{}",
                if self.choice == ClockChoice::Header { "; --clock log puts both on the recorder's" } else { "" }
            ),
        })
    }
}

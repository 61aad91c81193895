//! Which of a message's times counts, and whether the clocks of a recording are the same.

use std::{collections::BTreeMap, sync::Arc};

use super::raw::Message;
use crate::error::Reason;

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

/// The times that were met.
pub(super) struct Clocks {
    choice: ClockChoice,
    /// By topic, how far the first stamp was from the time of its recording, in nanoseconds.
    offsets: BTreeMap<Arc<str>, i128>,
    /// The recording has a topic with a simulated time.
    pub(super) is_simulated: bool,
}

impl Clocks {
    pub(super) fn new(choice: ClockChoice) -> Self {
        Self { choice, offsets: BTreeMap::new(), is_simulated: false }
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

//! Readings in the order of their times, each held back for a while in case that an earlier one comes after it.

use std::{
    cmp::{Ordering, Reverse},
    collections::{BinaryHeap, VecDeque},
};

use crate::track::RESET_RUN;

/// Readings that are held back, at most.
const MOST: usize = 1 << 16;

/// A reading with its times.
#[derive(Debug)]
struct Held<T> {
    t: i64,
    /// Its number in the file.
    number: u64,
    log_time: u64,
    what: T,
}

impl<T> Held<T> {
    const fn key(&self) -> (i64, u64) {
        (self.t, self.number)
    }
}

impl<T> PartialEq for Held<T> {
    fn eq(&self, other: &Self) -> bool {
        self.key() == other.key()
    }
}

impl<T> Eq for Held<T> {}

impl<T> PartialOrd for Held<T> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<T> Ord for Held<T> {
    fn cmp(&self, other: &Self) -> Ordering {
        self.key().cmp(&other.key())
    }
}

/// What comes out.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Out<T> {
    /// The next one.
    Next(T),
    /// One that came too late to be put in order.
    Late(T),
    /// The clock was set back: what comes next is of a new time.
    SetBack,
}

/// Holds readings back until those recorded `window` later have come.
///
/// One that is earlier than what was handed on already came too late. [`RESET_RUN`] of them or more, with none in time between for a
/// whole window, are a clock that was set back: what is held comes out, and then they are put in order as any others.
#[derive(Debug)]
pub(super) struct Order<T> {
    window: u64,
    held: BinaryHeap<Reverse<Held<T>>>,
    late: VecDeque<Held<T>>,
    /// The latest time that was handed on.
    passed: Option<i64>,
    /// The time of recording, as far as it has come.
    now: u64,
    number: u64,
    /// All that is held comes out: it is the end, or the clock was set back.
    flushing: bool,
    /// The late ones turned out to be of their own time.
    set_back: bool,
    /// The late ones come out as such.
    letting_go: bool,
}

impl<T> Order<T> {
    /// Holds readings back for `window` nanoseconds of recording.
    pub(super) fn new(window: u64) -> Self {
        Self {
            window,
            held: BinaryHeap::new(),
            late: VecDeque::new(),
            passed: None,
            now: 0,
            number: 0,
            flushing: false,
            set_back: false,
            letting_go: false,
        }
    }

    /// Something was recorded at this time.
    pub(super) fn goes_on(&mut self, log_time: u64) {
        self.now = log_time;
    }

    /// The latest time that was handed on.
    pub(super) const fn passed(&self) -> Option<i64> {
        self.passed
    }

    /// Whether one of this time would be put in order.
    pub(super) fn is_timely(&self, t: i64) -> bool {
        self.passed.is_none_or(|passed| t >= passed)
    }

    /// Takes one in.
    pub(super) fn push(&mut self, t: i64, log_time: u64, what: T) {
        self.number += 1;
        let held = Held { t, number: self.number, log_time, what };
        if self.is_timely(t) {
            self.letting_go = !self.late.is_empty();
            self.held.push(Reverse(held));
            return;
        }
        // A sweep of many sensors that is late as a whole is no clock set back: the next one is in time again.
        let lasts = self.late.front().and_then(|first| log_time.checked_sub(first.log_time));
        self.late.push_back(held);
        let lasts = lasts.is_some_and(|lasts| lasts >= self.window);
        self.set_back |= (self.late.len() >= RESET_RUN as usize && lasts) || self.late.len() > MOST;
    }

    /// There will be no more.
    pub(super) fn end(&mut self) {
        self.letting_go = !self.late.is_empty() && !self.set_back;
        self.flushing = true;
    }

    /// What is due; `None` where more has to come first.
    pub(super) fn pop(&mut self) -> Option<Out<T>> {
        if self.letting_go {
            match self.late.pop_front() {
                Some(late) => return Some(Out::Late(late.what)),
                None => self.letting_go = false,
            }
        }
        let is_due = self.held.peek().is_some_and(|Reverse(head)| {
            let waited = self.now.checked_sub(head.log_time);
            waited.is_some_and(|waited| waited >= self.window) || self.flushing || self.set_back
        });
        if is_due || self.held.len() > MOST {
            let Reverse(next) = self.held.pop()?;
            self.passed = Some(next.t);
            return Some(Out::Next(next.what));
        }
        if self.set_back {
            self.set_back = false;
            self.passed = None;
            self.held.extend(self.late.drain(..).map(Reverse));
            return Some(Out::SetBack);
        }
        None
    }
}

#[cfg(test)]
mod tests;

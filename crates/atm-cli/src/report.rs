//! What a person is told on standard error.

use std::{
    fmt::{Arguments, Write as _},
    io::Write as _,
};

use atm::summary::{Dropped, Summary};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Says one line. A closed standard error is no reason to stop.
pub fn say(line: Arguments<'_>) {
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// A bar on a terminal, nothing otherwise.
pub fn progress(length: Option<u64>, quiet: bool) -> ProgressBar {
    let bar = match length {
        _ if quiet => ProgressBar::hidden(),
        Some(length) => ProgressBar::with_draw_target(Some(length), ProgressDrawTarget::stderr()),
        None => ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr()),
    };
    let template = match length {
        Some(_) => "{bar:40} {binary_bytes}/{binary_total_bytes} {binary_bytes_per_sec} {eta}",
        None => "{spinner} {binary_bytes} {binary_bytes_per_sec}",
    };
    bar.with_style(ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar()))
}

/// What a run has counted, for a person.
pub fn counts(summary: &Summary) -> String {
    let mut text = format!("readings  {} in the local map, {} without an echo\n", summary.readings, summary.no_echo);
    let kinds: Vec<String> = summary.echoes.iter().map(|(kind, count)| format!("{count} {kind}")).collect();
    let _ = write!(text, "echoes    {}: {}", summary.echoes.total(), kinds.join(", "));
    if summary.written != summary.echoes.total() {
        let _ = write!(text, "; {} written", summary.written);
    }
    let _ = write!(text, "\nignored   {} with exactly two crossings", summary.ignored_pairs);
    if summary.ignored_none > 0 {
        let _ = write!(text, ", {} with none", summary.ignored_none);
    }
    let skipped = &summary.skipped;
    let skips = [
        (skipped.held, "held"),
        (skipped.min_step, "below the smallest step"),
        (skipped.empty, "empty"),
        (summary.duplicates, "duplicates"),
    ];
    let skips: Vec<String> =
        skips.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{count} {what}")).collect();
    if !skips.is_empty() {
        let _ = write!(text, "\nskipped   {}", skips.join(", "));
    }
    if summary.clock_resets > 0 {
        let _ = write!(text, "\nclock     set back {} times", summary.clock_resets);
    }
    text
}

/// Each cause of unusable records, with its count and where it first happened.
pub fn unusable(dropped: &Dropped) -> Option<String> {
    if dropped.total() == 0 {
        return None;
    }
    let mut text = format!("unusable  {} records", dropped.total());
    for (reason, count, first) in dropped.iter() {
        let place = &first.place;
        let byte = if place.line > 0 { format!(" (byte {})", place.byte) } else { String::new() };
        let _ = write!(text, "\n  {count} {}, first at {place}{byte}: {}", reason.key(), first.value);
    }
    Some(text)
}

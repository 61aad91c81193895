//! What is known of one sensor's readings.

use atm_core::{Beam, Limits, Meaning};

use super::histogram::Histogram;

/// The largest echo, and how it comes again.
#[derive(Debug, Clone, Copy, Default)]
struct Highest {
    metres: f64,
    count: u64,
    /// Times the readings came to it from something else.
    runs: u64,
    is_last: bool,
}

/// One sensor's part in a log.
#[derive(Debug, Clone, Default)]
pub struct SensorEvidence {
    /// Readings, those without echo included.
    pub readings: u64,
    /// Those with an echo.
    pub echoes: u64,
    /// Finite ranges at or beyond the maximum.
    pub beyond: u64,
    /// Finite ranges below the minimum.
    pub too_close: u64,
    /// +∞: nothing there.
    pub infinite: u64,
    /// −∞: too close, as REP 117 has it.
    pub minus_infinite: u64,
    /// NaN and negative ranges.
    pub invalid: u64,
    /// Echoes equal to the sensor's previous reading although the robot had moved.
    pub held: u64,
    /// Second readings at the very same time and pose.
    pub duplicates: u64,
    /// Limits and beam of its last reading.
    pub sight: Option<(Limits<f64>, Beam<f64>)>,
    highest: Highest,
    /// The previous reading; NaN where it was no echo.
    last: f64,
    /// When it was taken, and how often the pose had changed then.
    last_at: Option<(i64, u64)>,
    span: Option<(i64, i64)>,
    ranges: Option<Histogram>,
}

impl SensorEvidence {
    /// Readings in a second over the time from the first to the last; `None` below two instants.
    pub fn rate(&self) -> Option<f64> {
        let (first, last) = self.span?;
        let seconds = last.abs_diff(first) as f64 * 1e-9;
        (seconds > 0.0).then(|| self.readings.saturating_sub(1) as f64 / seconds)
    }

    /// Readings without an echo.
    pub fn no_echo(&self) -> u64 {
        self.readings - self.echoes
    }

    /// The range in metres below which this share of the echoes lies, to 1.6 %; `None` without echoes.
    pub fn quantile(&self, share: f64) -> Option<f64> {
        let limits = self.sight.map_or(Limits::NONE, |(limits, _)| limits);
        self.ranges.as_ref()?.quantile(share, limits.min(), limits.max())
    }

    /// The maximum of the last reading's limits, in metres; `None` where it is infinite.
    pub fn max_range(&self) -> Option<f64> {
        self.sight.map(|(limits, _)| limits.max()).filter(|max| max.is_finite())
    }

    /// Finite, positive ranges, echoes or not.
    pub(super) fn finite(&self) -> u64 {
        self.echoes + self.beyond + self.too_close
    }

    pub(super) fn ranges(&self) -> Option<&Histogram> {
        self.ranges.as_ref()
    }

    /// The largest echo in metres, how many echoes are equal to it, in how many separate runs, and how many are up to 3 %
    /// smaller.
    pub(super) fn highest(&self) -> (f64, u64, u64, u64) {
        let Highest { metres, count, runs, .. } = self.highest;
        let near = self.ranges.as_ref().map_or(0, |ranges| ranges.between(0.97 * metres, 1.02 * metres));
        (metres, count, runs, near.saturating_sub(count + self.beyond))
    }

    /// Takes a range in metres in, as it stands in the log, at a time in nanoseconds; `pose` counts the changes of the pose.
    /// `has_histogram`: its size is counted, too.
    #[inline]
    pub(super) fn add(&mut self, range: f64, limits: &Limits<f64>, t: i64, pose: u64, has_histogram: bool) {
        self.readings += 1;
        self.span = Some((self.span.map_or(t, |(first, _)| first), t));
        if self.last_at == Some((t, pose)) {
            self.duplicates += 1;
        }
        let meaning = limits.classify(range).meaning();
        match meaning {
            Meaning::Echo => self.echo(range, pose),
            Meaning::Beyond if range.is_finite() => self.beyond += 1,
            Meaning::Beyond => self.infinite += 1,
            Meaning::TooClose if range.is_finite() => self.too_close += 1,
            Meaning::TooClose => self.minus_infinite += 1,
            _ => self.invalid += 1,
        }
        if meaning != Meaning::Echo {
            self.last = f64::NAN;
            self.highest.is_last = false;
        }
        self.last_at = Some((t, pose));
        if has_histogram && range > 0.0 && range.is_finite() {
            self.ranges.get_or_insert_with(Histogram::new).add(range);
        }
    }

    #[inline]
    fn echo(&mut self, range: f64, pose: u64) {
        self.echoes += 1;
        let moved = self.last_at.is_some_and(|(_, last)| last != pose);
        self.held += u64::from(moved && self.echoes > 1 && range == self.last);
        self.last = range;
        if range > self.highest.metres {
            self.highest = Highest { metres: range, count: 1, runs: 1, is_last: true };
        } else if range == self.highest.metres {
            self.highest.count += u64::from(moved);
            self.highest.runs += u64::from(!self.highest.is_last);
            self.highest.is_last = true;
        } else {
            self.highest.is_last = false;
        }
    }
}

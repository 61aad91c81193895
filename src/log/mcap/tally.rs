//! What is counted of one sensor's readings, to see what is wrong with all of them.

use super::{decode::Measured, finding::Finding, sensors::Sight};

/// Readings below which nothing is said of all of them.
const ENOUGH: u64 = 20;
/// Readings that are so many times the maximum are in another unit.
const FAR_BEYOND: f64 = 5.0;
/// Echoes at exactly the minimum, of which and of how many more nothing is said.
const FEW_CLAMPED: u64 = 4;
const CLAMPED_SHARE: u64 = 10;
/// No sonar's beam is wider: 120°, in radians.
const WIDEST: f64 = 2.0 * std::f64::consts::FRAC_PI_3;

/// What is counted of one sensor.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Tally {
    readings: u64,
    /// That are numbers.
    finite: u64,
    echoes: u64,
    /// That are -Inf, and that are closer than the minimum at all.
    minus_infinite: u64,
    too_close: u64,
    /// That are many times the maximum, with the last of them and the maximum.
    far_beyond: u64,
    beyond: Option<(f64, f64)>,
    /// That are exactly the minimum, and what that is.
    at_minimum: u64,
    minimum: f64,
    /// The beam as messages have it, where that is what counts and it is too wide.
    wide: Option<f64>,
}

impl Tally {
    /// Takes a reading in. `said`: the beam is the message's.
    pub(super) fn add(&mut self, measured: &Measured, sight: &Sight, said: bool) {
        let (min, max, range) = (sight.limits.min(), sight.limits.max(), measured.range);
        self.readings += 1;
        self.finite += u64::from(range.is_finite());
        self.echoes += u64::from(range >= min && range < max);
        self.minus_infinite += u64::from(range == f64::NEG_INFINITY);
        self.too_close += u64::from(range < min);
        if range.is_finite() && range > FAR_BEYOND * max {
            self.far_beyond += 1;
            self.beyond = Some((range, max));
        }
        self.at_minimum += u64::from(range == min && min > 0.0);
        self.minimum = min;
        if said && sight.beam.field_of_view() > WIDEST {
            self.wide = Some(sight.beam.field_of_view());
        }
    }

    /// What is wrong with all of a sensor's readings.
    pub(super) fn findings(&self, id: &str) -> impl Iterator<Item = Finding> {
        let id = || id.to_owned();
        let beyond = self.beyond.filter(|_| self.finite >= ENOUGH / 2 && self.far_beyond == self.finite);
        let beyond = beyond.map(|example| Finding::AllBeyondMaximum { id: id(), readings: self.finite, example });
        let close = self.readings >= ENOUGH && self.too_close == self.readings;
        let close =
            close.then(|| Finding::AllTooClose { id: id(), readings: self.readings, infinite: self.minus_infinite });
        let clamped = self.at_minimum > FEW_CLAMPED && self.at_minimum * CLAMPED_SHARE > self.echoes;
        let clamped = clamped.then(|| Finding::ClampedAtMinimum {
            id: id(),
            readings: (self.at_minimum, self.echoes),
            minimum: self.minimum,
        });
        let wide = self.wide.map(|beam| Finding::WideBeam { id: id(), beam });
        [beyond, close, clamped, wide].into_iter().flatten()
    }
}

#[cfg(test)]
mod tests {
    use atm_core::{Beam, Limits, RangeResolution};

    use super::*;

    /// What is found in readings between 0.2 m and 4 m with a beam in radians that the messages say.
    fn found(ranges: impl IntoIterator<Item = f64>, beam: f64) -> Vec<Finding> {
        let limits = Limits::new(0.2, 4.0).unwrap();
        let range_resolution = RangeResolution::new(0.01).unwrap();
        let sight = Sight { limits, beam: Beam::new(beam).unwrap(), range_resolution };
        let mut tally = Tally::default();
        for range in ranges {
            tally.add(&Measured { field_of_view: beam, min: 0.2, max: 4.0, range }, &sight, true);
        }
        tally.findings("front").collect()
    }

    fn times(count: usize, range: f64) -> impl Iterator<Item = f64> {
        std::iter::repeat_n(range, count)
    }

    #[test]
    fn ordinary_readings_are_nothing_to_speak_of() {
        assert_eq!(found((0..100).map(|k| 0.2 + 0.03 * f64::from(k)), 0.4), []);
        // Nothing there all the time, by each of the values that drivers have for it; a few at the minimum.
        for nothing in [f64::INFINITY, f64::NAN, 4.0, 4.1] {
            assert_eq!(found(times(100, nothing), 0.4), [], "{nothing}");
        }
        assert_eq!(found(times(4, 0.2).chain(times(100, 1.0)), 0.4), []);
        assert_eq!(found(times(19, f64::NEG_INFINITY), 0.4), [], "too few to say it");
    }

    #[test]
    fn what_is_wrong_with_all_of_them_is_found() {
        let is = |found: Vec<Finding>, wanted: fn(&Finding) -> bool| assert!(found.iter().any(wanted), "{found:?}");
        is(found(times(20, 176.0), 0.4), |finding| matches!(finding, Finding::AllBeyondMaximum { readings: 20, .. }));
        is(found(times(20, f64::NEG_INFINITY), 0.4), |finding| {
            matches!(finding, Finding::AllTooClose { readings: 20, infinite: 20, .. })
        });
        is(found(times(10, 0.2).chain(times(50, 1.0)), 0.4), |finding| {
            matches!(finding, Finding::ClampedAtMinimum { readings: (10, 60), .. })
        });
        is(found(times(1, 1.0), 3.0), |finding| matches!(finding, Finding::WideBeam { .. }));
    }
}

//! The consensus: what the readings of the local map agree on, where the median only counts crossings.
//!
//! Each azimuth of an arc stands for two hypotheses: a point there that answers from every side, and a wall through it
//! that answers along its perpendicular. Every other reading of the local map is for them, against them, or silent. The
//! votes are logarithms of odds, so that what they leave of the arc is a distribution: an echo is resolved where nearly
//! all of it lies at one azimuth, and where the readings that agree there hold the information for it.

mod ballot;
mod echo;
mod fit;
mod poll;
mod witness;

pub use self::echo::{ConsensusEcho, Reflector};
use self::{
    fit::{Fit, Information, Place, Shape},
    poll::{Poll, Winner},
    witness::{Tolerance, Vote},
};
use crate::{
    arc::{Bearing, ReportedArc, cross},
    crossing::{Crossing, MinAngle},
    error::DomainError,
    estimator::{Estimator, Verdict},
    partners::Partners,
    resolution::interval,
    scalar::Scalar,
    sensor::RangeResolution,
};

/// A reading that nearly agrees with what is fitted over the others, but not to its rounding: so many votes are lost.
const NEAR_MISS: i32 = 24;
/// How round things are that are taken for points, as a standard deviation in millimetres: a pole answers from another point
/// to every side.
const USUAL_RADIUS: u32 = 25;

/// Points and walls as hypotheses about one arc, weighed by all readings that look there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Consensus<T> {
    /// θmin, for the resolution that is wanted: an echo is resolved where its azimuth lies within L = δ cot(θmin/2) with
    /// 95 % (Sec. IV-B and VI).
    min_angle: MinAngle<T>,
    /// The least confidence of a resolved echo.
    min_confidence: T,
    /// Standard deviation of a range beyond its rounding, in metres.
    range_error: T,
    /// How far along a wall from an echo readings speak for it or against it, in metres.
    window: T,
}

impl<T: Scalar> Consensus<T> {
    /// The resolution that crossings at `min_angle` have, a confidence of 90 %, ranges that are right but for their
    /// rounding, and walls of 0.9 m to either side of an echo.
    pub const fn new(min_angle: MinAngle<T>) -> Self {
        Self { min_angle, min_confidence: T::NINE_TENTHS, range_error: T::ZERO, window: T::NINE_TENTHS }
    }

    /// θmin, for the resolution that is wanted.
    pub const fn min_angle(&self) -> &MinAngle<T> {
        &self.min_angle
    }

    /// With another least confidence, in \[0, 1): more of it costs coverage and leaves fewer ghosts.
    ///
    /// # Errors
    /// A confidence outside \[0, 1).
    pub fn with_min_confidence(self, confidence: T) -> Result<Self, DomainError> {
        if !(confidence >= T::ZERO && confidence < T::ONE) {
            return Err(DomainError::Confidence);
        }
        Ok(Self { min_confidence: confidence, ..self })
    }

    /// With ranges that are wrong by more than their rounding: by a standard deviation of `metres`, of the sensor and of
    /// the pose together.
    ///
    /// It widens the steps of the range, so that their variance is that of both: δ² + 12 σ² in place of δ².
    ///
    /// # Errors
    /// A negative or infinite deviation.
    pub fn with_range_error(self, metres: T) -> Result<Self, DomainError> {
        if !(metres >= T::ZERO && metres.finite()) {
            return Err(DomainError::RangeError);
        }
        Ok(Self { range_error: metres, ..self })
    }

    /// The steps in which ranges can be trusted.
    fn trusted(&self, resolution: RangeResolution<T>) -> RangeResolution<T> {
        let variance = self.range_error * self.range_error * T::from_count(12);
        let step = resolution.metres() * resolution.metres() + variance;
        RangeResolution::new(step.square_root()).unwrap_or(resolution)
    }
}

impl<T: Scalar> Estimator<T> for Consensus<T> {
    type Echo = ConsensusEcho<T>;

    fn estimate(
        &self,
        arc: &ReportedArc<T>,
        partners: &Partners<'_, T>,
        scratch: &mut [T],
        _visit: impl FnMut(usize, &Crossing<T>),
    ) -> Verdict<ConsensusEcho<T>> {
        let arc = &ReportedArc { range_resolution: self.trusted(arc.range_resolution), ..*arc };
        let (near, agreeing) = scratch.split_at_mut(scratch.len() / 2);
        let tolerance = Tolerance::of(arc.range_resolution.metres());
        let poll = Poll::new(arc, partners, near, tolerance, self.window);
        let unresolved = unresolved(arc);
        let Some((winner, confidence)) = poll.decide(interval(arc.range_resolution, &self.min_angle)) else {
            return Verdict::Echo(unresolved);
        };
        let Some(settled) = settle(&poll, &winner, agreeing) else {
            return Verdict::Echo(ConsensusEcho { confidence, ..unresolved });
        };
        let confidence = reconsidered(confidence, settled.votes);
        Verdict::Echo(self.judge(arc, &settled, confidence, unresolved))
    }
}

/// A fitted reflector.
struct Settled<T: Scalar> {
    shape: Shape,
    place: Place<T>,
    information: Information<T>,
    against: u32,
    /// Votes won and lost by the fit.
    votes: i32,
}

impl<T: Scalar> Consensus<T> {
    /// The echo of a fitted reflector, if it is as sharp and as sure as is wanted.
    fn judge(
        &self,
        arc: &ReportedArc<T>,
        settled: &Settled<T>,
        confidence: T,
        unresolved: ConsensusEcho<T>,
    ) -> ConsensusEcho<T> {
        let Settled { shape, place, information, against, .. } = settled;
        let [sigma_range, sigma_across] = deviations(*shape, arc.range_resolution.metres(), information);
        // Twice 1.96 standard deviations.
        let resolution = sigma_across * (T::from_count(392) / T::from_count(100));
        let axis = arc.arc.axis();
        let sin = cross(axis, place.direction) / arc.arc.radius();
        let unresolved = ConsensusEcho { confidence, support: information.support, against: *against, ..unresolved };
        let sharp = resolution <= interval(arc.range_resolution, &self.min_angle);
        if !(sharp && confidence >= self.min_confidence && arc.arc.sees(place.direction) && information.support >= 2) {
            return unresolved;
        }
        ConsensusEcho {
            kind: if *shape == Shape::Point { Reflector::Point } else { Reflector::Wall },
            position: place.position(),
            bearing: Bearing::from_sine(if sin > T::ONE {
                T::ONE
            } else if sin < -T::ONE {
                -T::ONE
            } else {
                sin
            }),
            sigma_azimuth: sigma_across / place.distance,
            sigma_range,
            normal: (*shape == Shape::Wall).then(|| -place.direction),
            resolution,
            ..unresolved
        }
    }
}

/// A confidence whose odds have changed by so many votes.
fn reconsidered<T: Scalar>(confidence: T, votes: i32) -> T {
    let bits = T::from_count(votes.unsigned_abs()) / T::from_count(poll::BIT);
    let factor = (bits * T::TWO.logarithm()).exponential();
    let odds = confidence / (T::ONE - confidence);
    let odds = if votes < 0 { odds / factor } else { odds * factor };
    // Certainty, or more than a number holds.
    if odds.finite() { odds / (T::ONE + odds) } else { T::ONE }
}

/// What is said of an arc on which nothing is resolved: anywhere along it, at any distance that rounds to the reading.
fn unresolved<T: Scalar>(arc: &ReportedArc<T>) -> ConsensusEcho<T> {
    ConsensusEcho {
        t: arc.t,
        sensor: arc.sensor,
        kind: Reflector::Center,
        position: arc.arc.middle(),
        range: arc.arc.radius(),
        bearing: Bearing::AHEAD,
        support: 0,
        against: 0,
        confidence: T::ZERO,
        sigma_azimuth: arc.field_of_view * quantisation(T::ONE),
        sigma_range: quantisation(arc.range_resolution.metres()),
        normal: None,
        resolution: arc.arc_length(),
    }
}

/// Standard deviation of what is uniform over `width`: width / √12.
fn quantisation<T: Scalar>(width: T) -> T {
    width / T::from_count(12).square_root()
}

/// Standard deviations along the ray and across it, in metres.
///
/// The readings' rounding is not all independent. Besides what the information allows, widened by a seventh, a fifth of one
/// reading's variance stays however many agree: both from worlds set apart for tuning. And the distance of a wall is never
/// better than one reading's: passed at one distance, it is rounded the same way by all.
fn deviations<T: Scalar>(shape: Shape, range_resolution: T, information: &Information<T>) -> [T; 2] {
    let one = quantisation(range_resolution);
    let widened = T::from_count(4) / T::from_count(3);
    let common = T::ONE / T::from_count(5);
    let [along, across] = information.variances();
    let along_common = if shape == Shape::Wall { T::ONE } else { common };
    [(along, along_common), (across, common)]
        .map(|(variance, common)| one * (variance * widened + common).square_root())
}

/// Fits the winner over the readings that agree with it.
fn settle<T: Scalar>(poll: &Poll<'_, T>, winner: &Winner<T>, agreeing: &mut [T]) -> Option<Settled<T>> {
    let arc = poll.arc();
    let place =
        Place { sensor: arc.arc.sensor(), direction: winner.direction, distance: arc.arc.radius(), radius: T::ZERO };
    let (one, usual) = (quantisation(arc.range_resolution.metres()), T::from_count(USUAL_RADIUS) / T::from_count(1000));
    let radius_weight = one * one / (usual * usual);
    let mut fit = Fit { shape: winner.shape, place, range: arc.arc.radius(), window: poll.window(), radius_weight };
    let delta = arc.range_resolution.metres();
    // Those within twice the tolerance now; each step then takes those that agree with where it has come to.
    let wide = Tolerance { agree: poll.tolerance().agree * T::TWO, ..*poll.tolerance() };
    let (mut count, mut against, mut votes) = (0, 0, 0);
    for (slot, witness) in poll.witnesses() {
        let (vote, slopes) = fit.ask(&witness, &wide);
        match vote {
            Vote::For(residual) => {
                if residual.magnitude() <= poll.tolerance().agree {
                    votes -= fit.votes(&slopes);
                }
                if let Some(place) = agreeing.get_mut(count) {
                    *place = slot;
                    count += 1;
                }
            }
            Vote::Against => against += 1,
            Vote::Silent => {}
        }
    }
    let agreeing = agreeing.get(..count).unwrap_or_default();
    let tenths = |count| Tolerance { agree: delta * T::from_count(count) / T::from_count(10), ..wide };
    let mut information = None;
    for tolerance in [tenths(12), tenths(12), tenths(7), tenths(7)] {
        information =
            Some(fit.step(agreeing.iter().filter_map(|&slot| poll.witness(slot)), &tolerance, delta * T::TWO)?);
    }
    for witness in agreeing.iter().filter_map(|&slot| poll.witness(slot)) {
        match fit.ask(&witness, &wide) {
            (Vote::For(residual), slopes) if residual.magnitude() <= tenths(7).agree => votes += fit.votes(&slopes),
            (Vote::For(_), _) => votes -= NEAR_MISS,
            _ => {}
        }
    }
    Some(Settled { shape: fit.shape, place: fit.place, information: information?, against, votes })
}

#[cfg(test)]
mod tests;

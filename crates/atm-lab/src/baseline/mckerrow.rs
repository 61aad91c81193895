//! Common tangents (McKerrow, *Echolocation: From Range to Outline Segments*, Robotics and Autonomous Systems 11, 1993; Sec. II-C,
//! Figs. 8 to 10).

use std::collections::{BTreeMap, VecDeque};

use atm::error::Result;
use atm_core::{Point2, Reading, Vector2};

use super::{Findings, Mark, Method, Segment, Sight};

/// Fits a straight wall to two readings of one sensor that moved straight between them.
///
/// Moved by m, with readings r_prev and r_curr, a wall whose normal stands at γ to the motion has r_prev − r_curr = m cos γ. So
/// γ = ± acos((r_prev − r_curr) / m), which has to lie in the beam, \[a − b, a + b\]; the echoes are s + r (cos γ, sin γ). The
/// difference keeps its sign: the absolute value that is printed in the paper is wrong for beams that look backwards. Where
/// both signs of γ lie in the beam the wall may be either of two, and none is drawn.
#[derive(Debug, Default)]
pub struct CommonTangents {
    /// Each sensor's latest readings, as long as it moved straight; the first of them is the last that is far enough away.
    runs: BTreeMap<u16, VecDeque<Sight>>,
    segments: Vec<Segment>,
}

impl CommonTangents {
    /// The move between two readings, at least: 20 in, in metres, for an error of 2.9° broadside with a resolution of 1 in.
    pub const BASELINE: f64 = 0.508;
    /// How far a boresight may turn on a move that is still straight: 1°, in radians.
    const TURN: f64 = std::f64::consts::PI / 180.0;
    /// How far a sensor may stray from its line on a move that is still straight: 1 in, in metres.
    const STRAY: f64 = 0.0254;
    /// Most readings of one sensor that are kept on a straight move; of a sensor that hardly moves the oldest go.
    const MOST: usize = 512;
    /// How much further than exact the last place of a root may carry a move of just the baseline.
    const MICROMETRE: f64 = 1e-6;

    /// Bound on the error of γ, in radians, for ranges in steps of `resolution`: δ / (m sin γ).
    pub fn angle_bound(resolution: f64, moved: f64, gamma: f64) -> f64 {
        resolution / (moved * libm::sin(gamma).abs())
    }

    /// The wall that both readings touch, if there is exactly one.
    pub fn tangent(previous: &Sight, current: &Sight) -> Option<Segment> {
        let step = current.position - previous.position;
        let moved = step.norm();
        let ratio = (previous.range - current.range) / moved;
        if !(moved > 0.0 && ratio.abs() <= 1.0) {
            return None;
        }
        let motion = step / moved;
        let gamma = libm::acos(ratio);
        let seen = |gamma: f64| {
            let (sin, cos) = libm::sincos(gamma);
            let normal = motion * cos + Vector2::new(-motion.y, motion.x) * sin;
            let ends = [previous, current].map(|sight| (sight, sight.position + normal * sight.range));
            ends.iter().all(|(sight, point)| sight.sees(*point)).then_some(ends)
        };
        match (seen(gamma), seen(-gamma)) {
            (Some(ends), None) | (None, Some(ends)) => {
                Some(Segment { ends: ends.map(|(sight, point)| Mark::of(sight, point)) })
            }
            _ => None,
        }
    }

    /// Whether the sensor moved straight from the first of `run` over all of them to `now`.
    fn is_straight(run: &VecDeque<Sight>, now: &Sight) -> bool {
        let Some(first) = run.front() else {
            return true;
        };
        let turned =
            |sight: &Sight| libm::atan2(sight.boresight.perp(&now.boresight), sight.boresight.dot(&now.boresight));
        let along = now.position - first.position;
        let length = along.norm();
        let stray = |sight: &Sight| {
            let offset = sight.position - first.position;
            if length > 0.0 { (along.perp(&offset) / length).abs() } else { offset.norm() }
        };
        run.iter().all(|sight| turned(sight).abs() <= Self::TURN && stray(sight) <= Self::STRAY)
    }

    /// Lets go of what is not needed any more: all before the last reading that is far enough away.
    fn trim(run: &mut VecDeque<Sight>, now: Point2<f64>) {
        let far = |sight: &Sight| (now - sight.position).norm() + Self::MICROMETRE >= Self::BASELINE;
        while run.get(1).is_some_and(far) || run.len() > Self::MOST {
            run.pop_front();
        }
    }
}

impl Method for CommonTangents {
    fn take(&mut self, reading: &Reading<f64>) -> Result<()> {
        let Some(now) = Sight::new(reading) else {
            return Ok(());
        };
        let run = self.runs.entry(now.sensor).or_default();
        if !Self::is_straight(run, &now) {
            run.clear();
        }
        Self::trim(run, now.position);
        if let Some(previous) = run.front()
            && (now.position - previous.position).norm() + Self::MICROMETRE >= Self::BASELINE
        {
            self.segments.extend(Self::tangent(previous, &now));
        }
        run.push_back(now);
        Ok(())
    }

    fn clock_reset(&mut self) {
        self.runs.clear();
    }

    fn finish(self: Box<Self>) -> Result<Option<Findings>> {
        Ok(Some(Findings { segments: self.segments, ..Findings::default() }))
    }
}

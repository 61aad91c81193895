//! What may happen to one reading between the echo and the sensor's rounding, one layer an effect.
//!
//! Each layer draws the same number of times for every reading, whatever comes of it, so that its draws for later readings
//! do not depend on earlier ones.
use nalgebra::{Isometry2, Point2};

use super::{dice::Dice, scene::Reflection};
use crate::truth::Cause;

/// What a sensor is about to report.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sound {
    /// The range, in metres; `None` where nothing was heard.
    pub range: Option<f64>,
    /// Where it came from.
    pub source: Option<Reflection>,
}

/// The sensor that hears it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Listener {
    /// Its pose as it really stands, boresight along x.
    pub pose: Isometry2<f64>,
    /// The ranges it measures, in metres.
    pub min_range: f64,
    pub max_range: f64,
}

/// One effect.
pub(super) trait Layer {
    /// Does to a sound what the effect does.
    fn apply(&mut self, sound: &mut Sound, listener: &Listener);
}

/// Now and then another sensor's sound is heard instead, from any distance.
pub(super) struct Crosstalk {
    share: f64,
    dice: Dice,
}

impl Crosstalk {
    /// Farthest sound that a sensor without a largest range takes for its own, in metres.
    const FARTHEST: f64 = 10.0;

    pub fn new(share: f64, dice: Dice) -> Self {
        Self { share, dice }
    }
}

impl Layer for Crosstalk {
    fn apply(&mut self, sound: &mut Sound, listener: &Listener) {
        let (chance, far) = (self.dice.uniform(0.0, 1.0), self.dice.uniform(0.0, 1.0));
        if chance >= self.share {
            return;
        }
        let max = if listener.max_range.is_finite() { listener.max_range } else { Self::FARTHEST };
        let range = listener.min_range + (max - listener.min_range) * far;
        let point = listener.pose * Point2::new(range, 0.0);
        let source = Reflection { point, range, azimuth: 0.0, cause: Cause::Crosstalk };
        *sound = Sound { range: Some(range), source: Some(source) };
    }
}

/// The range scatters about its true value.
pub(super) struct RangeNoise {
    deviation: f64,
    dice: Dice,
}

impl RangeNoise {
    pub fn new(deviation: f64, dice: Dice) -> Self {
        Self { deviation, dice }
    }
}

impl Layer for RangeNoise {
    fn apply(&mut self, sound: &mut Sound, _: &Listener) {
        let noise = self.deviation * self.dice.normal();
        sound.range = sound.range.map(|range| (range + noise).max(0.0));
    }
}

/// Now and then an echo is missed.
pub(super) struct Dropout {
    share: f64,
    dice: Dice,
}

impl Dropout {
    pub fn new(share: f64, dice: Dice) -> Self {
        Self { share, dice }
    }
}

impl Layer for Dropout {
    fn apply(&mut self, sound: &mut Sound, _: &Listener) {
        if self.dice.uniform(0.0, 1.0) < self.share {
            *sound = Sound { range: None, source: None };
        }
    }
}

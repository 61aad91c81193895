//! A log as plain numbers: what the reference reads, and the readings that the fuser gets.

use std::fmt::Debug;

use atm::core::{
    Beam, Bounds, Held, Isometry2, Limits, MinAngle, OnNone, OnTwo, Point2, RangeResolution, Reading, Scalar, Span,
    TransversalMedian, Travel, UnitComplex,
};
use nalgebra::Translation2;

use crate::margin::Margins;

/// A number type to be compared with the reference, which always computes in `f64`.
pub trait Float: Scalar + Debug {
    /// How far the type's rounding may carry it.
    const MARGINS: Margins;
    fn narrowed(number: f64) -> Self;
    fn widened(self) -> f64;
}

impl Float for f64 {
    const MARGINS: Margins = Margins::DOUBLE;
    fn narrowed(number: f64) -> Self {
        number
    }
    fn widened(self) -> f64 {
        self
    }
}

impl Float for f32 {
    const MARGINS: Margins = Margins::SINGLE;
    fn narrowed(number: f64) -> Self {
        number as Self
    }
    fn widened(self) -> f64 {
        f64::from(self)
    }
}

/// One record: metres, radians, nanoseconds.
#[derive(Debug, Clone)]
pub struct Sample {
    pub t: i64,
    pub sensor: u16,
    /// As a driver gives it: may be infinite, negative, or no number.
    pub range: f64,
    /// An echo is at least the first and below the second.
    pub limits: [f64; 2],
    pub position: [f64; 2],
    /// Cosine and sine of the boresight's direction.
    pub boresight: [f64; 2],
    pub robot: [f64; 2],
    pub field_of_view: f64,
    pub range_resolution: f64,
}

/// What the fuser is set to.
#[derive(Debug, Clone)]
pub struct Rules {
    pub sensors: usize,
    pub history: usize,
    pub min_angle: f64,
    pub on_none: OnNone,
    pub on_two: OnTwo,
    pub max_age: Option<u64>,
    pub max_travel: Option<f64>,
    pub min_step: Option<f64>,
    pub drop_held: bool,
    /// The path that the map spans and the spacing of its readings, in metres, where it is by travel.
    pub span: Option<[f64; 2]>,
}

#[derive(Debug, Clone)]
pub struct Log {
    pub rules: Rules,
    pub samples: Vec<Sample>,
    /// Samples after which a snapshot is asked for.
    pub snapshots: Vec<usize>,
}

impl Log {
    /// The same log in numbers that `T` holds exactly, so that nothing is lost on the way to the fuser.
    pub fn rounded<T: Float>(mut self) -> Self {
        let round = |number: &mut f64| *number = T::narrowed(*number).widened();
        for sample in &mut self.samples {
            [&mut sample.range, &mut sample.field_of_view, &mut sample.range_resolution].into_iter().for_each(round);
            for pair in [&mut sample.limits, &mut sample.position, &mut sample.boresight, &mut sample.robot] {
                pair.iter_mut().for_each(round);
            }
        }
        let rules = &mut self.rules;
        rules.min_angle = T::narrowed(rules.min_angle).widened();
        rules.max_travel.iter_mut().chain(rules.min_step.iter_mut()).for_each(round);
        if let Some([travel, step]) = &mut rules.span {
            // As the span rounds them.
            let span = Span::new(T::narrowed(*travel), rules.history as u16).expect("up to 1000 m are drawn");
            [*travel, *step] = [(span.travel().widened() * 1e6).round() / 1e6, span.step().widened()];
        }
        self
    }
}

impl Rules {
    pub fn estimator<T: Float>(&self) -> TransversalMedian<T> {
        let paper = T::narrowed(30f64.to_radians()).widened();
        let min_angle = if self.min_angle == paper {
            MinAngle::PAPER
        } else {
            MinAngle::new(T::narrowed(self.min_angle)).expect("1 to 90 degrees are drawn")
        };
        TransversalMedian { min_angle, on_none: self.on_none, on_two: self.on_two }
    }

    pub fn bounds<T: Float>(&self) -> Bounds<T> {
        let mut bounds = Bounds::NONE.with_held(if self.drop_held { Held::Drop } else { Held::Keep });
        if let Some(nanoseconds) = self.max_age {
            bounds = bounds.with_max_age(nanoseconds);
        }
        if let Some(metres) = self.max_travel {
            bounds = bounds.with_max_travel(Travel::from_metres(metres).expect("up to 1000 m are drawn"));
        }
        if let Some([metres, _]) = self.span {
            bounds = bounds.with_span(Span::new(T::narrowed(metres), self.history as u16).expect("as above"));
        }
        if let Some(metres) = self.min_step {
            bounds = bounds.with_min_step(T::narrowed(metres)).expect("positive steps are drawn");
        }
        bounds
    }
}

impl Sample {
    pub fn reading<T: Float>(&self) -> Reading<T> {
        let number = T::narrowed;
        let limits = Limits::new(number(self.limits[0]), number(self.limits[1])).expect("min < max is drawn");
        Reading {
            t: self.t,
            sensor: self.sensor,
            range: limits.classify(number(self.range)),
            pose: Isometry2::from_parts(
                Translation2::new(number(self.position[0]), number(self.position[1])),
                UnitComplex::from_cos_sin_unchecked(number(self.boresight[0]), number(self.boresight[1])),
            ),
            robot: Point2::new(number(self.robot[0]), number(self.robot[1])),
            beam: Beam::new(number(self.field_of_view)).expect("up to half a turn is drawn"),
            range_resolution: RangeResolution::new(number(self.range_resolution)).expect("positive steps are drawn"),
        }
    }

    /// The distance, where the reading is an echo: r > 0 and min ≤ r < max.
    pub fn echo(&self) -> Option<f64> {
        (self.range > 0.0 && self.limits[0] <= self.range && self.range < self.limits[1]).then_some(self.range)
    }
}

//! Input of any bits: nothing panics, and no echo lies outside its beam.

use std::f64::consts::{FRAC_PI_2, PI};

use atm::core::{
    Beam, Bounds, Echo, Fuser, Isometry2, Limits, MinAngle, OnNone, OnTwo, Point2, RangeResolution, Reading, Scalar,
    TransversalMedian, Travel, UnitComplex, Vector2,
};
use atm::storage::SettledSlots;
use nalgebra::Translation2;
use proptest::prelude::*;

/// A number as bits, or as what a log may well hold.
#[derive(Debug, Clone, Copy)]
enum Number {
    Bits(u64),
    Plain(f64),
}

trait FromNumber: Scalar {
    /// The gap between 1 and the next number.
    const STEP: f64;
    /// Rounding of an azimuth, in radians, at ranges from 2 cm to 8 m and angles from 5° between arcs.
    const SLACK: f64;
    fn of(number: Number) -> Self;
    fn wide(self) -> f64;
}

impl FromNumber for f64 {
    const STEP: f64 = f64::EPSILON;
    const SLACK: f64 = 1e-11;
    fn of(number: Number) -> Self {
        match number {
            Number::Bits(bits) => Self::from_bits(bits),
            Number::Plain(plain) => plain,
        }
    }
    fn wide(self) -> f64 {
        self
    }
}

impl FromNumber for f32 {
    const STEP: f64 = f32::EPSILON as f64;
    const SLACK: f64 = 1e-3;
    fn of(number: Number) -> Self {
        match number {
            Number::Bits(bits) => Self::from_bits(bits as u32),
            Number::Plain(plain) => plain as Self,
        }
    }
    fn wide(self) -> f64 {
        f64::from(self)
    }
}

/// Everything about a reading, unchecked.
#[derive(Debug, Clone)]
struct Raw {
    t: i64,
    sensor: u16,
    range: Number,
    limits: [Number; 2],
    position: [Number; 2],
    heading: [Number; 2],
    robot: [Number; 2],
    field_of_view: Number,
    range_resolution: Number,
}

fn number() -> impl Strategy<Value = Number> {
    let edges = prop::sample::select(vec![0.0, -0.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, f64::MAX, 5e-324]);
    prop_oneof![
        2 => any::<u64>().prop_map(Number::Bits),
        1 => edges.prop_map(Number::Plain),
        2 => (-15.0..8.0f64).prop_map(|power| Number::Plain(libm::exp10(power))),
        8 => (-2.0..2.0f64).prop_map(Number::Plain),
    ]
}

fn heading() -> impl Strategy<Value = [Number; 2]> {
    let unit = (-3.2..3.2f64).prop_map(|angle| [libm::cos(angle), libm::sin(angle)].map(Number::Plain));
    prop_oneof![1 => [number(), number()], 12 => unit]
}

fn time() -> impl Strategy<Value = i64> {
    prop_oneof![1 => any::<i64>(), 1 => Just(i64::MIN), 1 => Just(i64::MAX), 20 => -1000..1000i64]
}

fn raw() -> impl Strategy<Value = Raw> {
    let sensor = prop_oneof![1 => any::<u16>(), 12 => 0..3u16];
    let limits = prop_oneof![2 => Just([Number::Plain(0.0), Number::Plain(f64::INFINITY)]), 1 => [number(), number()]];
    let beam = prop_oneof![1 => number(), 4 => (0.5..PI).prop_map(Number::Plain)];
    let places = (heading(), [number(), number()], [number(), number()]);
    (time(), sensor, number(), limits, places, beam, number()).prop_map(
        |(t, sensor, range, limits, (heading, position, robot), field_of_view, range_resolution)| Raw {
            t,
            sensor,
            range,
            limits,
            position,
            heading,
            robot,
            field_of_view,
            range_resolution,
        },
    )
}

fn reading<T: FromNumber>(raw: &Raw) -> Reading<T> {
    let limits = Limits::new(T::of(raw.limits[0]), T::of(raw.limits[1])).unwrap_or(Limits::NONE);
    let half_turn = Beam::new(T::PI).expect("the widest beam");
    let centimetre = RangeResolution::new(T::of(Number::Plain(0.01))).expect("positive");
    Reading {
        t: raw.t,
        sensor: raw.sensor,
        range: limits.classify(T::of(raw.range)),
        pose: Isometry2::from_parts(
            Translation2::new(T::of(raw.position[0]), T::of(raw.position[1])),
            UnitComplex::from_cos_sin_unchecked(T::of(raw.heading[0]), T::of(raw.heading[1])),
        ),
        robot: Point2::new(T::of(raw.robot[0]), T::of(raw.robot[1])),
        beam: Beam::new(T::of(raw.field_of_view)).unwrap_or(half_turn),
        range_resolution: RangeResolution::new(T::of(raw.range_resolution)).unwrap_or(centimetre),
    }
}

/// ±90° in any case; within half the beam where the numbers are those of a robot.
fn check<T: FromNumber>(echo: &Echo<T>, half_beam: Option<f64>) {
    let azimuth = echo.azimuth().wide();
    assert!(azimuth.abs() <= FRAC_PI_2 + T::STEP, "{echo:?}");
    if let Some(half_beam) = half_beam {
        assert!(azimuth.abs() <= half_beam + T::SLACK, "{azimuth} off, half the beam is {half_beam}: {echo:?}");
    }
}

fn endure<T: FromNumber>(raws: &[Raw], history: usize, min_angle: Number, bound: Number, age: u64) {
    let readings: Vec<Reading<T>> = raws.iter().map(reading).collect();
    let min_angle = MinAngle::new(T::of(min_angle)).unwrap_or(MinAngle::PAPER);
    let estimator = TransversalMedian { min_angle, on_none: OnNone::Center, on_two: OnTwo::Mean };
    let mut bounds = Bounds::NONE.with_max_age(age);
    if let Ok(travel) = Travel::from_metres(T::of(bound)) {
        bounds = bounds.with_max_travel(travel);
    }
    bounds = bounds.with_min_step(T::of(bound)).unwrap_or(bounds);
    let storage = || SettledSlots::<T>::new(3, history).expect("small");
    for settled in [false, true] {
        let mut fuser = if settled {
            Fuser::settled(estimator, bounds, storage())
        } else {
            Fuser::latest(estimator, bounds, storage())
        };
        let mut sink = |echo: &Echo<T>| check(echo, None);
        for (index, reading) in readings.iter().enumerate() {
            let _ = fuser.push(reading, &mut sink);
            if index % 5 == 4 {
                fuser.snapshot(&mut sink);
                fuser.shift_origin(Vector2::new(reading.pose.translation.vector.x, T::ZERO));
            }
        }
        fuser.finish(&mut sink);
    }
}

proptest! {
    #![proptest_config(super::config())]

    #[test]
    fn any_bits_never_panic_and_echoes_stay_in_their_beams(
        mut raws in prop::collection::vec(raw(), 1..40), in_order in prop::bool::weighted(0.8), history in 1..5usize,
        min_angle in number(), bound in number(), age in any::<u64>(),
    ) {
        if in_order {
            raws.sort_by_key(|raw| raw.t);
        }
        endure::<f64>(&raws, history, min_angle, bound, age);
        endure::<f32>(&raws, history, min_angle, bound, age);
    }
}

/// Arcs of a robot: a place within 4 m, a boresight, a range from 2 cm to 8 m, a beam.
type Look = ([f64; 2], f64, f64, f64);

fn look() -> impl Strategy<Value = Look> {
    let range = prop_oneof![0.02..0.3f64, 0.3..8.0f64];
    ([-4.0..4.0f64, -4.0..4.0f64], -3.2..3.2f64, range, 0.01..PI)
}

fn stay_in_their_beams<T: FromNumber>(looks: &[Look], min_angle: f64) {
    let number = |plain: f64| Number::Plain(plain);
    let min_angle = MinAngle::new(T::of(number(min_angle))).expect("within the domain");
    let estimator = TransversalMedian { min_angle, on_none: OnNone::Center, on_two: OnTwo::Mean };
    let storage = SettledSlots::<T>::new(3, 8).expect("small");
    let mut fuser = Fuser::settled(estimator, Bounds::NONE, storage);
    let mut readings = Vec::<Reading<T>>::new();
    for (index, &(place, boresight, range, field_of_view)) in looks.iter().enumerate() {
        readings.push(reading(&Raw {
            t: index as i64,
            sensor: index as u16 % 3,
            range: number(range),
            limits: [number(0.0), number(f64::INFINITY)],
            position: place.map(number),
            heading: [number(libm::cos(boresight)), number(libm::sin(boresight))],
            robot: place.map(number),
            field_of_view: number(field_of_view),
            range_resolution: number(1e-5),
        }));
    }
    let mut sink = |echo: &Echo<T>| {
        let beam = readings.get(echo.t as usize).map(|reading| reading.beam.field_of_view().wide() / 2.0);
        check(echo, beam);
    };
    for reading in &readings {
        fuser.push(reading, &mut sink).expect("usable");
    }
    fuser.finish(&mut sink);
}

proptest! {
    #![proptest_config(super::config())]

    #[test]
    fn echoes_stay_in_their_beams(looks in prop::collection::vec(look(), 1..60), min_angle in 0.09..1.57f64) {
        stay_in_their_beams::<f64>(&looks, min_angle);
        stay_in_their_beams::<f32>(&looks, min_angle);
    }
}

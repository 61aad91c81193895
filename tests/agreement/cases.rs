//! Who is in the local map when, case by case: readings of one pole from places around it, so that every two arcs that
//! meet cross exactly once, on the pole.

use atm::core::{
    ArcCrossing, Arrival, Beam, Bounds, Echo, Fuser, Held, Isometry2, Kind, Limits, MinAngle, OnNone, OnTwo, Point2,
    RangeResolution, Reading, Rejected, Sink, TransversalMedian, Travel, UnitComplex, Vector2, significance,
};
use atm::storage::SettledSlots;

/// An arc that was reported, by its time: its kind, and the times of the arcs that it met.
#[derive(Debug, PartialEq)]
struct Said {
    t: i64,
    kind: Kind,
    met: Vec<i64>,
}

#[derive(Default)]
struct Notes {
    said: Vec<Said>,
    met: Vec<i64>,
}

impl Sink<f64, Echo<f64>> for Notes {
    fn echo(&mut self, echo: &Echo<f64>) {
        self.met.sort_unstable();
        self.said.push(Said { t: echo.t, kind: echo.kind, met: std::mem::take(&mut self.met) });
    }

    fn wants_crossings(&self) -> bool {
        true
    }

    fn crossing(&mut self, crossing: &ArcCrossing<f64>) {
        self.met.push(crossing.t_other);
    }
}

struct Drive(Fuser<f64, SettledSlots<f64>>);

/// Every arc gives an echo, whatever its crossings.
fn estimator() -> TransversalMedian<f64> {
    let min_angle = MinAngle::new(1f64.to_radians()).unwrap();
    TransversalMedian { min_angle, on_none: OnNone::Center, on_two: OnTwo::Mean }
}

/// A reading of the pole at the origin from 1 m away, 2° further around it for every unit of `t`.
fn reading(t: i64, sensor: u16) -> Reading<f64> {
    let direction = (2.0 * t as f64).to_radians();
    let (sin, cos) = (libm::sin(direction), libm::cos(direction));
    Reading {
        t,
        sensor,
        range: Limits::NONE.classify(1.0),
        pose: Isometry2::from_parts(Vector2::new(cos, sin).into(), UnitComplex::from_cos_sin_unchecked(-cos, -sin)),
        robot: Point2::origin(),
        beam: Beam::new(22.5f64.to_radians()).unwrap(),
        range_resolution: RangeResolution::new(0.001).unwrap(),
    }
}

fn without_echo(t: i64, sensor: u16) -> Reading<f64> {
    Reading { range: Limits::NONE.classify(f64::INFINITY), ..reading(t, sensor) }
}

fn at(x: f64, reading: Reading<f64>) -> Reading<f64> {
    Reading { robot: Point2::new(x, 0.0), ..reading }
}

impl Drive {
    fn latest(history: usize, bounds: Bounds<f64>) -> Self {
        Self(Fuser::latest(estimator(), bounds, SettledSlots::new(3, history).unwrap()))
    }

    fn settled(history: usize, bounds: Bounds<f64>) -> Self {
        Self(Fuser::settled(estimator(), bounds, SettledSlots::new(3, history).unwrap()))
    }

    fn push(&mut self, reading: &Reading<f64>) -> (Result<Arrival, Rejected>, Vec<Said>) {
        let mut notes = Notes::default();
        let fate = self.0.push(reading, &mut notes);
        (fate, notes.said)
    }

    /// Pushes a reading that enters, in `latest`: the times of the arcs it meets.
    fn meets(&mut self, reading: &Reading<f64>) -> Vec<i64> {
        let (fate, mut said) = self.push(reading);
        assert_eq!(fate, Ok(Arrival::Entered));
        said.pop().map(|said| said.met).unwrap_or_default()
    }

    /// Times of the arcs in the local map.
    fn present(&mut self) -> Vec<i64> {
        let mut notes = Notes::default();
        self.0.snapshot(&mut notes);
        notes.said.iter().map(|said| said.t).collect()
    }

    fn finish(&mut self) -> Vec<Said> {
        let mut notes = Notes::default();
        self.0.finish(&mut notes);
        notes.said
    }
}

#[test]
fn own_sensor_hth_later_reading_sends_it_away() {
    let mut latest = Drive::latest(3, Bounds::NONE);
    for t in 0..3 {
        latest.meets(&reading(t, 0));
    }
    assert_eq!(latest.present(), [0, 1, 2]);
    assert_eq!(latest.meets(&reading(3, 0)), [1, 2]);
    assert_eq!(latest.present(), [1, 2, 3]);

    let mut settled = Drive::settled(3, Bounds::NONE);
    for t in 0..3 {
        assert_eq!(settled.push(&reading(t, 0)).1, []);
    }
    let (_, said) = settled.push(&reading(3, 0));
    assert_eq!(said, [Said { t: 0, kind: Kind::Pair, met: vec![1, 2] }]);
}

#[test]
fn own_sensor_meets_h_minus_1_earlier_and_h_minus_1_later_ones() {
    let mut settled = Drive::settled(4, Bounds::NONE);
    let mut said: Vec<_> = (0..12).flat_map(|t| settled.push(&reading(t, 0)).1).collect();
    said.extend(settled.finish());
    assert_eq!(said.len(), 12);
    assert_eq!(said[6], Said { t: 6, kind: Kind::Median, met: vec![3, 4, 5, 7, 8, 9] });
}

/// The one that stood still was its sensor's previous reading, and is not in the map.
#[test]
fn held_reading_replaces_only_what_has_its_range() {
    let bounds = Bounds::NONE.with_held(Held::Edges).with_min_step(0.01).unwrap();
    let mut settled = Drive::settled(4, bounds);
    let still = |t| Reading { pose: reading(1, 0).pose, ..without_echo(t, 0) };
    let fates = [reading(0, 0), reading(1, 0), still(2), without_echo(3, 0)].map(|reading| settled.push(&reading).0);
    assert_eq!(fates, [Arrival::Entered, Arrival::Entered, Arrival::Still, Arrival::Entered].map(Ok));
    assert_eq!(settled.finish().iter().map(|said| said.t).collect::<Vec<_>>(), [0, 1]);
}

/// Each is reported once, however long the run: the log of arrivals has 4 H S places, a count of them 16 bits.
#[test]
fn run_of_held_readings_may_be_longer_than_anything_that_counts_them() {
    for (sensors, length) in [(1, 100), (2, 101), (3, 70_000)] {
        let mut settled = Drive::settled(2, Bounds::NONE.with_held(Held::Edges));
        let (mut entered, mut said) = (0, Vec::new());
        for t in 0..length {
            // The others fire at the beginning and at the end.
            let sensor = if t < sensors || t > length - sensors { t % sensors } else { 0 };
            let (fate, reports) = settled.push(&reading(t, sensor as u16));
            entered += usize::from(fate == Ok(Arrival::Entered));
            said.extend(reports);
        }
        said.extend(settled.finish());
        assert_eq!(said.len(), entered, "{sensors} sensors, {length} readings");
        assert!(said.iter().any(|said| said.t == length - 1), "the last of the run");
        assert!(said.windows(2).all(|pair| pair[0].t < pair[1].t), "in order");
        // With H = 2 a run begins anew every eight.
        assert!(entered as i64 <= 2 * length / 7 + 2 * sensors, "{entered} of {length}");
    }
}

#[test]
fn silent_sensor_cannot_hold_its_arcs() {
    let history = 2;
    let mut latest = Drive::latest(history as usize, Bounds::NONE);
    latest.meets(&reading(0, 1));
    for t in 1..4 * history {
        assert!(latest.meets(&reading(t, 0)).contains(&0), "reading {t} of the other sensor");
    }
    assert_eq!(latest.meets(&reading(4 * history, 0)), [7]);
    assert_eq!(latest.present(), [7, 8]);
}

#[test]
fn silence_is_counted_in_readings_of_one_other_sensor() {
    let mut latest = Drive::latest(2, Bounds::NONE);
    latest.meets(&reading(0, 1));
    // Seven of each of two others are fourteen, but neither sensor's eighth.
    for t in 1..=14 {
        assert!(latest.meets(&reading(t, if t % 2 == 0 { 0 } else { 2 })).contains(&0));
    }
    assert!(!latest.meets(&reading(15, 2)).contains(&0));
}

#[test]
fn leavers_leave_before_the_newcomer_meets_them() {
    let mut settled = Drive::settled(1, Bounds::NONE);
    for t in 0..3 {
        for Said { kind, met, .. } in settled.push(&reading(t, 0)).1 {
            assert_eq!((kind, met), (Kind::Center, vec![]));
        }
    }
}

#[test]
fn reading_without_echo_holds_its_slot() {
    for nothing in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN, -1.0, 0.0] {
        let mut latest = Drive::latest(2, Bounds::NONE);
        latest.meets(&reading(0, 0));
        let without = Reading { range: Limits::NONE.classify(nothing), ..reading(1, 0) };
        assert_eq!(latest.push(&without), (Ok(Arrival::Entered), vec![]));
        assert_eq!(latest.meets(&reading(2, 0)), [0; 0], "{nothing}");
    }
}

#[test]
fn reading_without_echo_counts_against_a_silent_sensor() {
    let mut latest = Drive::latest(1, Bounds::NONE);
    latest.meets(&reading(0, 1));
    for t in 1..=3 {
        latest.push(&without_echo(t, 0)).0.unwrap();
    }
    assert_eq!(latest.present(), [0]);
    latest.push(&without_echo(4, 0)).0.unwrap();
    assert_eq!(latest.present(), [0; 0]);
}

#[test]
fn rejected_reading_does_not_arrive() {
    let unusable = [
        (Reading { sensor: 3, ..reading(2, 0) }, Rejected::UnknownSensor),
        (Reading { robot: Point2::new(f64::NAN, 0.0), ..reading(2, 0) }, Rejected::Pose),
        (at(1000.0, reading(0, 0)), Rejected::TimeBackwards),
    ];
    let mut latest = Drive::latest(2, Bounds::NONE.with_max_travel(Travel::from_metres(5.0).unwrap()));
    latest.meets(&reading(0, 0));
    latest.meets(&reading(1, 0));
    for (reading, expected) in &unusable {
        assert_eq!(latest.push(reading), (Err(*expected), vec![]));
        assert_eq!(latest.present(), [0, 1]);
    }
    // Neither slots, nor the path, nor the time moved on.
    assert_eq!(latest.meets(&reading(1, 1)), [0]);
    assert_eq!(latest.meets(&reading(2, 0)), [1, 1]);
}

#[test]
fn readings_of_one_instant_meet_where_their_sensors_lie_apart() {
    let mut latest = Drive::latest(2, Bounds::NONE);
    latest.meets(&reading(0, 0));
    assert_eq!(latest.meets(&Reading { t: 0, ..reading(20, 1) }), [0]);
}

#[test]
fn reading_leaves_when_older_than_max_age_and_not_at_it() {
    let mut latest = Drive::latest(5, Bounds::NONE.with_max_age(10));
    latest.meets(&reading(0, 0));
    assert_eq!(latest.meets(&reading(10, 0)), [0]);
    assert_eq!(latest.meets(&reading(11, 0)), [10]);
}

#[test]
fn age_is_right_from_one_end_of_time_to_the_other() {
    for (max_age, expected) in [(u64::MAX, vec![i64::MIN]), (u64::MAX - 1, vec![])] {
        let mut latest = Drive::latest(5, Bounds::NONE.with_max_age(max_age));
        latest.meets(&Reading { t: i64::MIN, ..reading(0, 0) });
        assert_eq!(latest.meets(&Reading { t: i64::MAX, ..reading(1, 0) }), expected);
    }
}

#[test]
fn reading_leaves_after_more_than_max_travel_and_not_at_it() {
    let mut latest = Drive::latest(5, Bounds::NONE.with_max_travel(Travel::from_metres(3.0).unwrap()));
    latest.meets(&at(0.0, reading(0, 0)));
    // Two metres there, one back: three of path.
    assert_eq!(latest.meets(&at(2.0, reading(1, 0))), [0]);
    assert_eq!(latest.meets(&at(1.0, reading(2, 0))), [0, 1]);
    assert_eq!(latest.meets(&at(1.001, reading(3, 0))), [1, 2]);
}

#[test]
fn readings_that_leave_at_one_arrival_are_reported_in_input_order() {
    let mut settled = Drive::settled(5, Bounds::NONE.with_max_age(10));
    for (t, sensor) in [(0, 2), (1, 0), (2, 1), (3, 0)] {
        settled.push(&reading(t, sensor)).0.unwrap();
    }
    let times = |said: Vec<Said>| said.into_iter().map(|said| said.t).collect::<Vec<_>>();
    assert_eq!(times(settled.push(&reading(13, 1)).1), [0, 1, 2]);
    assert_eq!(times(settled.finish()), [3, 13]);
}

#[test]
fn held_reading_takes_no_slot_and_no_echo_is_a_value() {
    let mut latest = Drive::latest(2, Bounds::NONE.with_held(Held::Drop));
    latest.meets(&reading(0, 0));
    for t in 1..4 {
        assert_eq!(latest.push(&reading(t, 0)).0, Ok(Arrival::Held));
    }
    assert_eq!(latest.push(&reading(4, 1)).0, Ok(Arrival::Entered), "another sensor's reading is not its previous one");
    assert_eq!(latest.push(&without_echo(5, 0)).0, Ok(Arrival::Entered));
    let too_close = Reading { range: Limits::NONE.classify(0.0), ..reading(6, 0) };
    assert_eq!(latest.push(&too_close).0, Ok(Arrival::Held));
    assert_eq!(latest.present(), [0, 4]);
}

#[test]
fn standing_still_makes_a_median_unless_min_step() {
    let from = |place: i64, t: i64, sensor: u16| Reading { t, ..reading(place, sensor) };
    let last_kind = |bounds: Bounds<f64>| {
        let mut latest = Drive::latest(10, bounds);
        for t in 0..3 {
            latest.push(&from(0, t, 0)).0.unwrap();
        }
        latest.push(&from(20, 3, 1)).1.pop().unwrap().kind
    };
    assert_eq!(last_kind(Bounds::NONE), Kind::Median);
    assert_eq!(last_kind(Bounds::NONE.with_min_step(0.01).unwrap()), Kind::Single);
}

#[test]
fn min_step_is_measured_from_the_last_reading_in_the_local_map() {
    // 2° around the pole are 0.0349 m; the step from the reading that entered adds up over those skipped.
    let mut latest = Drive::latest(10, Bounds::NONE.with_min_step(0.05).unwrap());
    assert_eq!(latest.push(&reading(0, 0)).0, Ok(Arrival::Entered));
    assert_eq!(latest.push(&reading(1, 0)).0, Ok(Arrival::Still));
    assert_eq!(latest.push(&reading(2, 0)).0, Ok(Arrival::Entered));
    assert_eq!(latest.push(&reading(2, 1)).0, Ok(Arrival::Entered), "another sensor has its own steps");
    assert_eq!(latest.present(), [0, 2, 2]);
}

#[test]
fn min_step_does_not_hold_back_a_sensor_whose_arcs_have_all_left() {
    let mut latest = Drive::latest(1, Bounds::NONE.with_min_step(0.01).unwrap());
    latest.meets(&reading(0, 1));
    for t in 1..=4 {
        latest.meets(&reading(t, 0));
    }
    assert_eq!(latest.push(&Reading { t: 5, ..reading(0, 1) }).0, Ok(Arrival::Entered));
}

#[test]
fn near_arc_is_a_partner_for_others_all_the_same() {
    let mut settled = Drive::settled(3, Bounds::NONE);
    // So coarse that the whole arc is no longer than what crossings resolve.
    let coarse = Reading { range_resolution: RangeResolution::new(1.0).unwrap(), ..reading(0, 0) };
    settled.push(&coarse).0.unwrap();
    settled.push(&reading(10, 0)).0.unwrap();
    let expected = [Said { t: 0, kind: Kind::Near, met: vec![10] }, Said { t: 10, kind: Kind::Single, met: vec![0] }];
    assert_eq!(settled.finish(), expected);
}

#[test]
fn crossing_at_the_smallest_angle_itself_counts() {
    // 3, 4, 5: the arcs cross at right angles, and a right angle is asked for.
    let estimator = TransversalMedian { min_angle: MinAngle::new(90f64.to_radians()).unwrap(), ..estimator() };
    let mut fuser = Fuser::latest(estimator, Bounds::NONE, SettledSlots::new(2, 1).unwrap());
    let facing = |sensor: u16, x: f64, y: f64, range: f64, cos: f64, sin: f64| Reading {
        sensor,
        range: Limits::NONE.classify(range),
        pose: Isometry2::from_parts(Vector2::new(x, y).into(), UnitComplex::from_cos_sin_unchecked(cos, sin)),
        ..reading(0, 0)
    };
    let mut notes = Notes::default();
    fuser.push(&facing(0, 3.0, 0.0, 3.0, -1.0, 0.0), &mut notes).unwrap();
    fuser.push(&facing(1, 0.0, 4.0, 4.0, 0.0, -1.0), &mut notes).unwrap();
    assert_eq!(notes.said[1].kind, Kind::Single);
}

#[test]
fn finished_fuser_begins_anew_at_any_time_and_place() {
    let mut settled = Drive::settled(5, Bounds::NONE.with_max_travel(Travel::from_metres(1.0).unwrap()));
    settled.push(&at(0.0, reading(50, 0))).0.unwrap();
    assert_eq!(settled.finish().len(), 1);
    assert_eq!(settled.present(), [0; 0]);
    assert_eq!(settled.push(&at(900.0, reading(-5, 0))), (Ok(Arrival::Entered), vec![]));
    assert_eq!(settled.push(&at(900.5, reading(0, 0))), (Ok(Arrival::Entered), vec![]));
    let said = settled.finish();
    assert_eq!(said[0].met, [0]);
}

#[test]
fn finished_fuser_begins_the_path_anew_to_the_last_micrometre() {
    let met_in_second_log = |step_in_first: f64| {
        let mut latest = Drive::latest(5, Bounds::NONE.with_max_travel(Travel::from_metres(1e-6).unwrap()));
        latest.meets(&at(0.0, reading(0, 0)));
        latest.meets(&at(step_in_first, reading(1, 0)));
        latest.finish();
        latest.meets(&at(0.0, reading(0, 0)));
        latest.meets(&at(1.6e-6, reading(1, 0)))
    };
    assert_eq!(met_in_second_log(0.0), met_in_second_log(0.6e-6));
}

#[test]
fn fifty_crossings_never_keep_a_tenth_of_the_arc_apart() {
    // Of eleven points, two share a tenth of the arc, wherever they lie.
    assert_eq!(significance::scan_chance(2, 50, 0.1f64, 1.0), 1.0);
}

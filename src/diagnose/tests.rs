use std::f64::consts::{FRAC_PI_2, FRAC_PI_6, PI};

use atm_core::{Beam, Isometry2, Limits, MinAngle, RangeResolution, Vector2};

use super::*;
use crate::{
    error::{Place, Problem, Reason},
    intake::SensorModel,
    log::Row,
    summary::Dropped,
    track::Pose,
};

/// Four sensors of 30 degrees, up to 4 m.
fn models() -> Vec<SensorModel> {
    let model = |quarter: i32| SensorModel {
        mount: Isometry2::new(Vector2::zeros(), f64::from(quarter) * FRAC_PI_2),
        limits: Limits::new(0.1, 4.0).unwrap(),
        beam: Beam::new(FRAC_PI_6).unwrap(),
        range_resolution: RangeResolution::new(0.01).unwrap(),
    };
    (0..4).map(model).collect()
}

/// A drive of 5 m, a reading of each sensor every 5 cm, in a room of which no two readings are alike. What is wrong with it
/// is done to it before it is looked at.
struct Drive {
    rows: Vec<Row>,
    models: Vec<SensorModel>,
    resets: Vec<usize>,
    dropped: Dropped,
    drops_held: bool,
}

impl Drive {
    fn new(pose: impl Fn(f64) -> Pose) -> Self {
        let row = |step: u32| {
            let along = f64::from(step) * 0.05;
            let range = |sensor: u16| 1.0 + f64::from(sensor) * 0.5 + (along * 1.7 + f64::from(sensor)).sin() * 0.4;
            Row {
                t: i64::from(step) * 100_000_000,
                pose: Some(pose(along)),
                readings: (0..4).map(|sensor| (sensor, range(sensor))).collect(),
                ..Row::default()
            }
        };
        let (rows, models) = ((0..100).map(row).collect(), models());
        Self { rows, models, resets: Vec::new(), dropped: Dropped::default(), drops_held: false }
    }

    fn straight() -> Self {
        Self::new(|along| Pose { x: along, y: 0.0, yaw: 0.0 })
    }

    /// On a circle of 1 m, with the heading written by `written`.
    fn circle(written: impl Fn(f64) -> f64) -> Self {
        Self::new(|along| Pose { x: along.sin(), y: 1.0 - along.cos(), yaw: written(along) })
    }

    fn ranges(mut self, change: impl Fn(usize, u16, f64) -> f64) -> Self {
        for (number, row) in self.rows.iter_mut().enumerate() {
            for (sensor, range) in &mut row.readings {
                *range = change(number, *sensor, *range);
            }
        }
        self
    }

    fn evidence(&self) -> Evidence {
        let mut evidence = Evidence::new(Some(MinAngle::PAPER));
        for (number, row) in self.rows.iter().enumerate() {
            if self.resets.contains(&number) {
                evidence.clock_reset();
            }
            evidence.record(row, row.pose, &self.models);
        }
        evidence
    }

    fn diagnoses(&self, run: Option<&Run>) -> Vec<Diagnosis> {
        diagnose(&self.evidence(), &self.dropped, self.resets.len() as u64, self.drops_held, run, Vec::new())
    }

    /// What is found, which must be one thing.
    #[track_caller]
    fn only(&self) -> Diagnosis {
        let found = self.diagnoses(None);
        assert_eq!(found.len(), 1, "{found:?}");
        found[0].clone()
    }

    #[track_caller]
    fn is_silent(&self) {
        assert_eq!(self.diagnoses(None), []);
    }
}

fn run(resolved: u64, span: MapSpan) -> Run {
    Run { resolved, arcs: 400, pairs: 0, near: 0, span, min_angle: MinAngle::PAPER }
}

#[track_caller]
fn says(found: &Diagnosis, words: &[&str]) {
    let text = found.to_string();
    for word in words {
        assert!(text.contains(word), "no `{word}` in `{text}`");
    }
}

#[test]
fn nothing_is_found_in_a_drive_that_is_in_order() {
    for drive in [Drive::straight(), Drive::circle(|yaw| yaw), Drive::circle(|yaw| yaw + PI)] {
        drive.is_silent();
        assert_eq!(drive.diagnoses(Some(&run(200, MapSpan::Readings(10)))), []);
    }
}

#[test]
fn millimetres_and_centimetres_are_told_by_the_maximum_that_they_exceed() {
    for (unit, scale) in [("mm", 1000.0), ("cm", 100.0)] {
        let found = Drive::straight().ranges(|_, _, range| range * scale).only();
        assert!(matches!(found, Diagnosis::RangeUnit { unit: Some(found), .. } if found == unit), "{found:?}");
        says(&found, &["400 of 400 ranges", "maximum of 4.00 m", &format!("--range-unit {unit}")]);
    }
    // Without a maximum, by their size.
    let mut drive = Drive::straight().ranges(|_, _, range| range * 1000.0);
    drive.models.iter_mut().for_each(|model| model.limits = Limits::NONE);
    assert!(matches!(drive.only(), Diagnosis::RangeUnit { unit: Some("mm"), .. }));
    // A sensor that says its maximum where there is nothing is in order, in an empty place, too.
    Drive::straight().ranges(|_, _, _| 4.0).is_silent();
    Drive::straight().ranges(|number, _, range| if number == 50 { range } else { 4.05 }).is_silent();
}

#[test]
fn sensors_that_are_too_close_or_hear_nothing_all_the_time_are_told() {
    let close = Drive::straight().ranges(|_, _, _| f64::NEG_INFINITY).only();
    says(&close, &["400 of 400 readings are -inf"]);
    says(&Drive::straight().ranges(|_, _, range| range / 1000.0).only(), &["below the minimum of 0.100 m"]);
    says(&Drive::straight().ranges(|_, _, _| f64::NAN).only(), &["no reading has an echo", "400 nan"]);
    Drive::straight().ranges(|number, _, range| if number % 2 == 0 { range } else { f64::NAN }).is_silent();
}

#[test]
fn a_largest_range_that_piles_up_stands_for_nothing() {
    let clip =
        |limit: f64| move |number: usize, _: u16, range: f64| if number.is_multiple_of(3) { limit } else { range };
    let found = Drive::straight().ranges(clip(3.2)).only();
    says(&found, &["3.20 m stands for nothing", "of 400 echoes", "max_range = \"3.2m\""]);
    // Values a little below it: a wall.
    Drive::straight()
        .ranges(|number, _, range| if number % 3 == 0 { 3.2 - (number % 5) as f64 * 0.01 } else { range })
        .is_silent();
    // One sensor of many: a wall, too.
    Drive::straight()
        .ranges(|number, sensor, range| if number % 3 == 0 && sensor == 2 { 3.2 } else { range })
        .is_silent();
    // Who is silent where there is nothing does not clip.
    Drive::straight()
        .ranges(|number, _, range| {
            if number % 3 == 0 {
                3.2
            } else if number % 3 == 1 {
                f64::INFINITY
            } else {
                range
            }
        })
        .is_silent();
}

#[test]
fn values_that_most_sensors_repeat_on_the_way_are_held() {
    let hold = |number: usize, sensor: u16, _: f64| 1.0 + f64::from(sensor) + ((number / 4) as f64).sin() * 0.3;
    let mut drive = Drive::straight().ranges(hold);
    says(&drive.only(), &["--drop-held", "of 4 sensors"]);
    drive.drops_held = true;
    drive.is_silent();
    // Nothing after nothing is no repetition.
    Drive::straight().ranges(|number, _, range| if number % 9 == 0 { range } else { f64::NAN }).is_silent();
    // One sensor along a smooth wall is honest.
    Drive::straight().ranges(|_, sensor, range| if sensor == 1 { 1.27 } else { range }).is_silent();
    // Along one for the whole of the drive, too, whatever other sensors see.
    let mut alone = Drive::straight().ranges(|_, _, _| 1.27);
    alone.rows.iter_mut().for_each(|row| row.readings.truncate(1));
    alone.is_silent();
    // So is a robot that stands.
    let mut standing = Drive::new(|along| Pose { x: if along < 1.0 { along } else { 1.0 }, y: 0.0, yaw: 0.0 });
    standing = standing.ranges(|number, _, range| if number < 20 { range } else { 1.5 });
    standing.is_silent();
}

#[test]
fn readings_that_are_there_twice_are_no_held_values() {
    let mut drive = Drive::straight();
    drive.rows = drive.rows.iter().flat_map(|row| [row.clone(), row.clone()]).collect();
    says(&drive.only(), &["400 of 800 readings", "not used"]);
}

#[test]
fn headings_are_read_in_the_form_that_fits_the_way() {
    type Written = fn(f64) -> f64;
    let forms: [(HeadingForm, Written); 5] = [
        (HeadingForm::Degrees, f64::to_degrees),
        (HeadingForm::Clockwise, |yaw| -yaw),
        (HeadingForm::DegreesClockwise, |yaw| -yaw.to_degrees()),
        (HeadingForm::Compass, |yaw| FRAC_PI_2 - yaw),
        (HeadingForm::DegreesCompass, |yaw| 90.0 - yaw.to_degrees()),
    ];
    for (form, written) in forms {
        let found = Drive::circle(written).only();
        assert!(matches!(found, Diagnosis::Heading { form: found, .. } if found == form), "{form:?}: {found:?}");
    }
    says(&Drive::circle(f64::to_degrees).only(), &["in degrees", "yaw_unit = \"1deg\""]);
}

#[test]
fn a_robot_that_moves_sideways_has_headings_all_the_same() {
    Drive::new(|along| Pose { x: 0.0, y: along, yaw: 0.0 }).is_silent();
    Drive::new(|along| Pose { x: along.sin(), y: 1.0 - along.cos(), yaw: 0.3 }).is_silent();
    Drive::circle(|yaw| yaw + FRAC_PI_2).is_silent();
    Drive::circle(|yaw| 7.3 * yaw).is_silent();
}

#[test]
fn a_straight_drive_with_a_heading_that_fits_only_in_another_form_is_told() {
    let straight =
        |yaw: f64| Drive::new(move |along| Pose { x: along * FRAC_PI_6.cos(), y: along * FRAC_PI_6.sin(), yaw });
    says(&straight(30.0).only(), &["in degrees"]);
    says(&straight(-FRAC_PI_6).only(), &["clockwise"]);
    straight(FRAC_PI_6).is_silent();
    straight(FRAC_PI_6 - PI).is_silent();
}

#[test]
fn positions_in_degrees_are_told_from_a_robot_that_trembles() {
    let drive = |step: f64| Drive::new(move |along| Pose { x: 4.41 + along * step, y: 52.17, yaw: 0.0 });
    says(&drive(1.0 / 111_000.0).only(), &["latitude and longitude", "4.96 m"]);
    drive(1.0).is_silent();
    // 2 mm to and fro.
    let trembling = Drive::new(|along| Pose { x: 4.41 + (along * 50.0).sin() * 0.002, y: 52.17, yaw: 0.0 });
    says(&trembling.only(), &["do not move"]);
}

#[test]
fn a_robot_that_stands_and_one_in_millimetres_are_told() {
    says(&Drive::new(|_| Pose { x: 1.0, y: 2.0, yaw: 0.0 }).only(), &["poses do not move", "400 readings"]);
    let found = Drive::new(|along| Pose { x: along * 1000.0, y: 0.0, yaw: 0.0 }).only();
    says(&found, &["positions are in mm", "500 m/s", "pose_unit = \"mm\""]);
}

#[test]
fn times_that_stand_still_while_the_robot_moves_are_told() {
    let mut drive = Drive::straight();
    drive.rows.iter_mut().for_each(|row| row.t = 1_661_450_000_000_000_000);
    says(&drive.only(), &["lost their digits", "99 changes", "1 time,", "1661450000 s"]);
    for (number, row) in drive.rows.iter_mut().enumerate() {
        row.t += number as i64 / 2 * 200_000_000;
    }
    drive.is_silent();
}

#[test]
fn rows_that_are_sorted_by_sensor_are_told_from_a_clock_that_was_set_back() {
    let mut drive = Drive::straight();
    let of = |sensor: u16| {
        drive.rows.iter().map(move |row| Row {
            readings: row.readings.iter().copied().filter(|(of, _)| *of == sensor).collect(),
            ..row.clone()
        })
    };
    drive.rows = (0..4).flat_map(of).collect();
    drive.resets = vec![100, 200, 300];
    says(&drive.only(), &["sorted by sensor", "3 times", "sort"]);
    let mut reset = Drive::straight();
    reset.rows.extend(Drive::straight().rows);
    reset.resets = vec![100];
    // A drive that begins where the first began: the sensor is another one, as it was before.
    for row in &mut reset.rows {
        row.readings.rotate_left(1);
        row.readings.truncate(1);
    }
    says(&reset.only(), &["the clock was set back", "1 time;"]);
}

#[test]
fn unusable_records_are_told_with_their_place_and_cure_the_most_first() {
    let mut drive = Drive::straight();
    let place = Place { file: "log.csv".into(), line: 7, byte: 0 };
    for (reason, count) in [(Reason::UnknownSensor, 2), (Reason::NoPose, 30)] {
        for _ in 0..count {
            drive.dropped.add(Problem { reason, place: place.clone(), value: "sensor \"x\"".into() });
        }
    }
    let found = drive.diagnoses(None);
    assert_eq!(found.iter().map(Diagnosis::cost).collect::<Vec<_>>(), [30, 2]);
    says(&found[0], &["30 no_pose, first at log.csv:7", "--max-gap"]);
    says(&found[1], &["2 unknown_sensor", "[[sensor]]"]);
}

#[test]
fn little_that_is_resolved_is_told_with_what_the_map_spans_and_takes() {
    let drive = Drive::straight();
    let short = drive.diagnoses(Some(&run(7, MapSpan::Readings(4))));
    let [found @ Diagnosis::LittleResolved { why: Unresolved::ShortMap { spans, needs, reach, by_count: true }, .. }] =
        &short[..]
    else {
        panic!("{short:?}");
    };
    assert!((spans - 0.198).abs() < 1e-9 && (needs - 1.3148).abs() < 1e-4 && *reach == PAPER_REACH);
    says(found, &["7 of 400 arcs (1.8 %)", "spans 0.198 m", "take 1.31 m", "--history auto"]);
    // As much as is needed, or more than 2 %: no word.
    assert_eq!(drive.diagnoses(Some(&run(8, MapSpan::Readings(4)))), []);
    let spans = drive.diagnoses(Some(&run(7, MapSpan::Travel(1.4))));
    assert!(!matches!(spans[..], [Diagnosis::LittleResolved { why: Unresolved::ShortMap { .. }, .. }]), "{spans:?}");
}

#[test]
fn a_cause_that_was_found_is_told_instead_of_its_effect() {
    let drive = Drive::circle(f64::to_degrees);
    let found = drive.diagnoses(Some(&run(0, MapSpan::Readings(4))));
    assert!(matches!(found[..], [Diagnosis::Heading { .. }]), "{found:?}");
}

#[test]
fn a_path_that_is_too_short_is_not_blamed_on_the_map() {
    let drive = Drive::new(|along| Pose { x: along * 0.1, y: 0.0, yaw: 0.0 });
    let found = drive.diagnoses(Some(&run(0, MapSpan::Travel(1.4))));
    assert!(matches!(found[..], [Diagnosis::LittleResolved { why: Unresolved::ShortPath { .. }, .. }]), "{found:?}");
}

#[test]
fn the_sample_of_arcs_tells_those_that_nothing_crosses() {
    // A sensor ahead of a robot that goes straight on: its arcs lie one in front of the other.
    let mut drive = Drive::straight().ranges(|_, _, _| 2.0);
    drive.rows.iter_mut().for_each(|row| row.readings.truncate(1));
    let crossings = drive.evidence().crossings;
    assert!(crossings.arcs > 0);
    assert_eq!((crossings.uncrossed, crossings.shallow), (crossings.arcs, 0));
    // To the side they cross, near their middles at small angles.
    let mut aside = Drive::straight().ranges(|_, _, _| 3.9);
    aside.rows.iter_mut().for_each(|row| row.readings = vec![(1, 3.9)]);
    let crossings = aside.evidence().crossings;
    assert!(crossings.arcs > 0 && crossings.shallow == crossings.arcs, "{crossings:?}");
}

#[test]
fn a_guessed_resolution_is_told_where_a_fifth_is_near() {
    assert_eq!(guessed_resolution(20, 100), None);
    says(&guessed_resolution(21, 100).unwrap(), &["21 of 100 echoes", "--range-resolution"]);
}

#[test]
fn as_json_it_is_cause_evidence_and_flag() {
    let found = serde_json::to_value(Drive::straight().ranges(|_, _, range| range * 100.0).only()).unwrap();
    assert_eq!(found["cause"], "the ranges are in cm, not in m");
    assert!(found["evidence"].is_string() && found["flag"].is_string(), "{found}");
}

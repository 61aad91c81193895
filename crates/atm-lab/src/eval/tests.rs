use std::sync::Arc;

use nalgebra::{Isometry2, Point2, Vector2};
use proptest::prelude::*;
use serde_json::Value;

use super::*;
use crate::{
    truth::{Cause, Truth, TruthPoint},
    world::World,
};

/// The opening of 36 in (0.9144 m) lies in a wall at y = 70 in (1.778 m), in the middle of a path of 240 in (6.096 m): its jambs
/// are at x = 2.5908 m and 3.5052 m.
fn doorway() -> World {
    World::load("doorway", &[]).unwrap()
}

fn estimate(x: f64, y: f64, kind: &str) -> Estimate {
    let kind = (!kind.is_empty()).then(|| Arc::from(kind));
    Estimate { position: Point2::new(x, y), key: None, azimuth: None, range: None, kind }
}

fn of_reading(t: i64, azimuth: f64, range: f64) -> Estimate {
    Estimate { key: Some((t, "3".into())), azimuth: Some(azimuth), range: Some(range), ..estimate(0.0, 0.0, "median") }
}

#[track_caller]
fn assert_near(found: Option<f64>, expected: f64) {
    assert!(found.is_some_and(|found| (found - expected).abs() < 1e-9), "{found:?} is not {expected}");
}

#[test]
fn surface_errors_and_ghosts_are_distances_from_the_nearest_wall() {
    // On the wall; 0.1 m before it; 0.2 m behind it; in the middle of the opening, 0.4572 m from both jambs.
    let points = [(1.0, 1.778), (1.0, 1.678), (0.5, 1.978), (3.048, 1.778)].map(|(x, y)| estimate(x, y, ""));
    let scores = evaluate(&points, &doorway(), None).all;
    // Sorted 0, 0.1, 0.2, 0.4572: the median lies half way between 0.1 and 0.2, p90 at 0.7 of the last step.
    assert_near(scores.surface_error_m.p50, 0.15);
    assert_near(scores.surface_error_m.p90, 0.2 + 0.7 * 0.2572);
    assert_near(scores.surface_error_m.mean, 0.7572 / 4.0);
    // 6 in are 0.1524 m.
    assert_eq!((scores.points, scores.ghosts), (4, 2));
}

#[test]
fn a_point_is_a_ghost_from_six_inches_on() {
    let ghosts = |off: f64| evaluate(&[estimate(1.0, 1.778 + off, "")], &doorway(), None).all.ghosts;
    assert_eq!((ghosts(0.152), ghosts(0.153)), (0, 1));
}

#[test]
fn azimuth_errors_are_arc_lengths_to_the_true_echo_of_the_same_reading() {
    let mut truth = Truth::default();
    let mut know = |t, azimuth, cause| {
        truth.insert(t, "3", TruthPoint { position: Point2::origin(), azimuth, cause });
    };
    know(1, 0.10, Cause::Corner);
    know(2, -0.05, Cause::Scatterer);
    know(3, 0.0, Cause::Crosstalk);
    // 0.05 rad at 2 m, and 0.15 rad at 4 m.
    let mut points = vec![of_reading(1, 0.15, 2.0), of_reading(2, 0.10, 4.0)];
    // Crosstalk; a reading that is not in the truth; another sensor; points of a grid.
    points.extend([of_reading(3, 0.5, 1.0), of_reading(9, 0.5, 1.0), estimate(0.0, 0.0, "median")]);
    points.push(Estimate { key: Some((1, "4".into())), ..of_reading(1, 0.5, 1.0) });
    let scores = evaluate(&points, &doorway(), Some(&truth));
    let errors = scores.all.azimuth_error_m;
    assert_eq!(errors.count, 2);
    assert_near(errors.p50, 0.35);
    assert_near(errors.p95, 0.1 + 0.95 * 0.5);
    assert_near(errors.mean, 0.35);
    assert_eq!(scores.by_kind["median"].azimuth_error_m, errors);
    assert_eq!(evaluate(&points, &doorway(), None).all.azimuth_error_m, Spread::default());
}

#[test]
fn azimuths_are_compared_the_shorter_way_round() {
    let mut truth = Truth::default();
    truth.insert(1, "3", TruthPoint { position: Point2::origin(), azimuth: 3.1, cause: Cause::Multipath });
    let error = evaluate(&[of_reading(1, -3.1, 1.0)], &doorway(), Some(&truth)).all.azimuth_error_m.p50;
    assert_near(error, std::f64::consts::TAU - 6.2);
}

#[test]
fn kinds_are_scored_by_themselves_and_all_together() {
    let jambs = [estimate(2.5908, 1.778, "median"), estimate(3.5052, 1.778, "median")];
    let middle = [estimate(3.048, 1.778, "center"), estimate(0.0, 1.778, "")];
    let scores = evaluate(&[&jambs[..], &middle].concat(), &doorway(), None);
    assert_eq!(scores.by_kind.keys().collect::<Vec<_>>(), ["center", "median"]);
    assert_near(scores.by_kind["median"].doorway_width_m, 0.9144);
    // The point in the middle halves the opening; alone it marks no jamb.
    assert_near(scores.all.doorway_width_m, 0.4572);
    assert_near(scores.by_kind["center"].doorway_width_m, 0.0);
    assert_eq!((scores.all.points, scores.by_kind["median"].points, scores.by_kind["center"].points), (4, 2, 1));
}

#[test]
fn nothing_covers_nothing_and_finds_no_doorway() {
    let scores = evaluate(&[], &doorway(), None);
    assert_eq!((scores.all.points, scores.all.ghosts, scores.by_kind.len()), (0, 0, 0));
    assert_eq!((scores.all.coverage, scores.all.doorway_width_m), (Some(0.0), Some(0.0)));
    assert_eq!(scores.all.surface_error_m, Spread::default());
    let closed = World::load("closed-wall", &[]).unwrap();
    assert_eq!(evaluate(&[], &closed, None).all.doorway_width_m, None);
}

#[test]
fn coverage_grows_to_all_that_can_be_seen() {
    // A point every 2 in on the wall with the opening and on the one across, as far as the walls go.
    let row = |y: f64| (-160..=290).map(move |i| f64::from(i) * 0.0508).map(move |x| estimate(x, y, ""));
    let world = doorway();
    let near: Vec<_> = row(1.778).collect();
    let both: Vec<_> = row(1.778).chain(row(-1.016)).collect();
    let all: Vec<_> = row(1.778).chain(row(-1.016)).chain(row(4.318)).collect();
    let coverage = |points: &[Estimate]| evaluate(points, &world, None).all.coverage.unwrap();
    let covered = [coverage(&near), coverage(&both), coverage(&all)];
    assert!(covered[0] > 0.2 && covered[0] < covered[1] && covered[1] < covered[2], "{covered:?}");
    assert_near(Some(covered[2]), 1.0);
}

/// A world of two walls, an opening, a pole and a path, all moved.
fn moved_world(motion: &Isometry2<f64>) -> World {
    let place = |x: f64, y: f64| {
        let point = motion * Point2::new(x, y);
        format!("[{:?}, {:?}]", point.x, point.y)
    };
    let pole = motion * Point2::new(1.5, 0.9);
    let text = format!(
        "name = \"moved\"\nmaterial = \"rough\"\n\
         [[wall]]\npoints = [{}, {}]\n[[wall]]\npoints = [{}, {}]\n[[opening]]\nfrom = {}\nto = {}\n\
         [[pole]]\nx = {:?}\ny = {:?}\nradius = 0.1\n[path]\nkind = \"waypoints\"\npoints = [{}, {}]\n",
        place(-2.0, 2.0),
        place(1.0, 2.0),
        place(2.0, 2.0),
        place(5.0, 2.0),
        place(1.0, 2.0),
        place(2.0, 2.0),
        pole.x,
        pole.y,
        place(0.0, 0.0),
        place(3.0, 0.0),
    );
    World::parse(&text, "moved.toml", &[]).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(16) })]
    #[test]
    fn moving_world_and_points_together_changes_no_score(
        x in -100.0..100.0_f64, y in -100.0..100.0_f64, turn in -3.0..3.0_f64,
        points in prop::collection::vec((-1.0..4.0_f64, 1.5..2.4_f64), 0..40),
    ) {
        let motion = Isometry2::new(Vector2::new(x, y), turn);
        let points: Vec<_> = points.into_iter().map(|(x, y)| estimate(x, y, "median")).collect();
        let moved = points.iter().map(|point| Estimate { position: motion * point.position, ..point.clone() });
        let still = evaluate(&points, &moved_world(&Isometry2::identity()), None).all;
        let moved = evaluate(&moved.collect::<Vec<_>>(), &moved_world(&motion), None).all;
        prop_assert_eq!((still.points, still.ghosts), (moved.points, moved.ghosts));
        let same = |one: Option<f64>, other: Option<f64>, slack: f64| match (one, other) {
            (Some(one), Some(other)) => (one - other).abs() <= slack,
            (one, other) => one == other,
        };
        prop_assert!(same(still.surface_error_m.p90, moved.surface_error_m.p90, 1e-9));
        prop_assert!(same(still.surface_error_m.mean, moved.surface_error_m.mean, 1e-9));
        prop_assert!(same(still.doorway_width_m, moved.doorway_width_m, 1e-9));
        // Pieces on the border of what is seen may fall to either side.
        prop_assert!(same(still.coverage, moved.coverage, 0.02), "{:?} {:?}", still.coverage, moved.coverage);
    }
}

#[test]
fn json_has_the_keys_that_others_rely_on_and_null_for_what_there_is_not() {
    let scores = evaluate(&[estimate(0.0, 1.778, "median")], &World::load("closed-wall", &[]).unwrap(), None);
    let json = serde_json::to_value(&scores).unwrap();
    for object in [&json, &json["by_kind"]["median"]] {
        assert_eq!(object["points"], 1);
        assert_eq!(object["ghosts"], 0);
        assert!(object["coverage"].is_number());
        assert_eq!(object.get("doorway_width_m"), Some(&Value::Null));
        for key in ["p50", "p90", "p95", "mean"] {
            assert_eq!(object["azimuth_error_m"].get(key), Some(&Value::Null));
            assert_eq!(object["surface_error_m"][key], 0.0);
        }
    }
}

use atm_core::{Beam as Cone, Isometry2, Limits, RangeResolution, Vector2};
use proptest::prelude::*;

use super::*;

/// How much a length may be off: two pieces at each of two ends.
const SLACK: f64 = 4.0 * PIECE;

fn view(x: f64, y: f64, yaw: f64, beam: f64, reach: f64) -> View {
    View {
        pose: Isometry2::new(Vector2::new(x, y), yaw),
        limits: Limits::new(0.1, reach).unwrap(),
        beam: Cone::new(beam.to_radians()).unwrap(),
        range_resolution: RangeResolution::new(0.01).unwrap(),
    }
}

/// A sensor at the origin that looks along +y.
fn upwards(beam: f64, reach: f64) -> View {
    view(0.0, 0.0, std::f64::consts::FRAC_PI_2, beam, reach)
}

fn wall(from: (f64, f64), to: (f64, f64)) -> Shape {
    Shape::Segment { from: Point2::new(from.0, from.1), to: Point2::new(to.0, to.1) }
}

fn long_wall() -> Shape {
    wall((-10.0, 1.0), (10.0, 1.0))
}

#[track_caller]
fn assert_length(shapes: &[Shape], views: &[View], expected: f64) {
    let found = Observable::new(shapes, views).length();
    assert!((found - expected).abs() <= SLACK, "{found} m instead of {expected} m");
}

#[test]
fn a_beam_sees_what_it_holds_of_a_wall() {
    // At 1 m, tan 45 degrees on either side.
    assert_length(&[long_wall()], &[upwards(90.0, 5.0)], 2.0);
}

#[test]
fn the_range_ends_what_is_seen() {
    // At 1 m, with a reach of 2 m, the root of 3 on either side: less than tan 75 degrees.
    assert_length(&[long_wall()], &[upwards(150.0, 2.0)], 2.0 * 3.0_f64.sqrt());
    assert_length(&[wall((-1.0, 0.05), (1.0, 0.05))], &[upwards(10.0, 2.0)], 0.0);
}

#[test]
fn what_stands_before_a_wall_hides_it_and_is_seen_itself() {
    // The screen of 0.4 m at half the way hides 0.8 m of the 2 m.
    assert_length(&[long_wall(), wall((-0.2, 0.5), (0.2, 0.5))], &[upwards(90.0, 5.0)], 1.2 + 0.4);
    // A post of radius 0.1 m at half the way: its tangents leave at asin 0.2, and the wall lacks 2 tan(asin 0.2) = 0.408 m;
    // of the post, acos 0.2 on either side: 0.274 m.
    let post = Shape::Circle { center: Point2::new(0.0, 0.5), radius: 0.1 };
    assert_length(&[long_wall(), post], &[upwards(90.0, 5.0)], 2.0 - 0.408 + 0.274);
}

#[test]
fn a_post_hides_its_own_far_side() {
    // A sensor at four radii: acos(1/4) = 75.52 degrees on either side of the near point.
    let post = Shape::Circle { center: Point2::new(0.0, 1.0), radius: 0.25 };
    assert_length(&[post], &[upwards(90.0, 5.0)], 0.25 * 2.0 * 75.52_f64.to_radians());
}

#[test]
fn beams_add_what_they_see_and_count_it_once() {
    let views = [upwards(90.0, 5.0), view(0.5, 0.0, std::f64::consts::FRAC_PI_2, 90.0, 5.0), upwards(20.0, 5.0)];
    assert_length(&[long_wall()], &views, 2.5);
    assert_length(&[long_wall()], &[], 0.0);
}

#[test]
fn a_wall_of_any_length_makes_no_more_than_a_million_pieces() {
    let far = wall((-1e9, 1.0), (1e9, 1.0));
    assert!(Observable::new(&[far], &[upwards(90.0, 1e12)]).pieces.len() <= 1_000_000);
}

#[test]
fn a_point_covers_three_inches_on_either_side() {
    let seen = Observable::new(&[long_wall()], &[upwards(90.0, 5.0)]);
    let coverage = |points: &[(f64, f64)]| seen.coverage(points.iter().map(|&(x, y)| Point2::new(x, y))).unwrap();
    // 6 in of 2 m.
    assert!((coverage(&[(0.0, 1.0)]) - 0.1524 / 2.0).abs() <= SLACK / 2.0);
    // Two inches off the wall, the chord of 3 in is 2 √5 = 4.47 in.
    assert!((coverage(&[(0.0, 1.0508)]) - 0.1136 / 2.0).abs() <= SLACK / 2.0);
    assert_eq!(coverage(&[(0.0, 1.08), (5.0, 1.0)]), 0.0);
    let all: Vec<_> = (0..41).map(|i| (-1.0 + 0.05 * f64::from(i), 1.0)).collect();
    assert_eq!(coverage(&all), 1.0);
}

#[test]
fn without_anything_to_see_there_is_no_coverage() {
    assert_eq!(Observable::new(&[long_wall()], &[]).coverage([Point2::new(0.0, 1.0)]), None);
    assert_eq!(Observable::default().coverage([]), None);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn moving_everything_together_changes_nothing(x in -1e3..1e3_f64, y in -1e3..1e3_f64, turn in -3.0..3.0_f64) {
        let motion = Isometry2::new(Vector2::new(x, y), turn);
        let (shapes, views) = ([long_wall(), wall((-0.2, 0.5), (0.2, 0.5))], [upwards(90.0, 5.0)]);
        let points = [Point2::new(-0.7, 1.0), Point2::new(0.1, 0.5), Point2::new(0.9, 1.05)];
        let moved_shapes = shapes.each_ref().map(|shape| match shape {
            Shape::Segment { from, to } => Shape::Segment { from: motion * from, to: motion * to },
            Shape::Circle { center, radius } => Shape::Circle { center: motion * center, radius: *radius },
        });
        let moved_views = views.map(|view| View { pose: motion * view.pose, ..view });
        let (still, moved) = (Observable::new(&shapes, &views), Observable::new(&moved_shapes, &moved_views));
        // A piece on a border may fall to either side.
        prop_assert!((still.length() - moved.length()).abs() <= SLACK);
        let (still, moved) = (still.coverage(points), moved.coverage(points.map(|point| motion * point)));
        prop_assert!((still.unwrap() - moved.unwrap()).abs() <= SLACK);
    }
}

//! McKerrow's common tangents.

use atm_core::{Point2, Reading, Vector2};

use super::{super::*, INCH, NARROW, Sensor, run};

/// What a sensor at `at` (inches) reads, in inches, from a wall whose normal stands at `normal_deg`, `distance` inches from the origin.
fn to_wall(at: (f64, f64), normal_deg: f64, distance: f64) -> f64 {
    let (sin, cos) = normal_deg.to_radians().sin_cos();
    distance - (at.0 * cos + at.1 * sin)
}

/// Two readings 20 in apart along +x, in inches, by a sensor that looks along `boresight_deg`.
fn pair(boresight_deg: f64, ranges: [f64; 2]) -> Vec<Reading<f64>> {
    let reads = |t: i64, x: f64, range: f64| NARROW.reads(t, (x * INCH, 0.0), boresight_deg, range * INCH);
    vec![reads(0, 0.0, ranges[0]), reads(1, 20.0, ranges[1])]
}

fn only_segment(readings: &[Reading<f64>]) -> [Point2<f64>; 2] {
    let segments = run(CommonTangents::default(), readings).unwrap().segments;
    assert_eq!(segments.len(), 1);
    segments[0].ends.map(|mark| mark.position)
}

/// Degrees from the wall's normal to the segment's, and the farthest of its ends from the wall, in inches.
fn error(ends: [Point2<f64>; 2], normal_deg: f64, distance: f64) -> (f64, f64) {
    let along = ends[1] - ends[0];
    // The wall runs along (sin, −cos) where its normal is (cos, sin).
    let (sin, cos) = normal_deg.to_radians().sin_cos();
    let wall = Vector2::new(sin, -cos);
    let turned = wall.perp(&along).atan2(wall.dot(&along)).to_degrees();
    let off = ends.map(|end| ((end.x * cos + end.y * sin) / INCH - distance).abs());
    // A segment has no direction of its own.
    (turned.abs().min(180.0 - turned.abs()), off[0].max(off[1]))
}

#[test]
fn a_wall_from_two_exact_readings_is_within_a_degree_and_an_inch() {
    // For beams that look left (a = 90°), ahead and back: normals up to half a beam off the boresight.
    for boresight in [90.0, 60.0, 130.0, -90.0, -40.0] {
        for off in [-10.0, -5.0, 0.0, 7.0, 11.0] {
            let normal = boresight + off;
            let ranges = [0.0, 20.0].map(|x| to_wall((x, 0.0), normal, 70.0));
            let ends = only_segment(&pair(boresight, ranges));
            let (turned, off_wall) = error(ends, normal, 70.0);
            assert!(turned < 1.0 && off_wall < 1.0, "{boresight} {off}: {turned} deg, {off_wall} in");
        }
    }
}

#[test]
fn a_wall_abreast_by_hand() {
    // Normal 84.26° = acos(0.1): r = 70 and 70 − 20 cos γ = 68. So cos γ = 2/20, and the echoes are (7, 69.65) and
    // (20 + 6.8, 67.66): s + r (0.1, √0.99).
    let ends = only_segment(&pair(90.0, [70.0, 68.0]));
    let root = 0.99f64.sqrt();
    assert!((ends[0] - Point2::new(7.0, 70.0 * root) * INCH).norm() < 1e-12);
    assert!((ends[1] - Point2::new(26.8, 68.0 * root) * INCH).norm() < 1e-12);
}

#[test]
fn rounded_to_an_inch_it_is_within_its_own_bound() {
    // |dγ| ≤ δ / (m sin γ): both readings are off by at most half a step. 2.9° broadside.
    let broadside = CommonTangents::angle_bound(INCH, 20.0 * INCH, std::f64::consts::FRAC_PI_2).to_degrees();
    assert!((broadside - 2.865).abs() < 1e-3, "{broadside}");
    let mut worst: f64 = 0.0;
    for step in 0..200 {
        let distance = 60.0 + 0.173 * f64::from(step);
        let normal = 80.0 + f64::from(step % 21);
        let ranges = [0.0, 20.0].map(|x| to_wall((x, 0.0), normal, distance).round());
        let Some(segment) = run(CommonTangents::default(), &pair(90.0, ranges)).unwrap().segments.first().copied()
        else {
            continue;
        };
        let (turned, _) = error(segment.ends.map(|mark| mark.position), normal, distance);
        // γ as measured may be nearer to the motion than the wall's normal: the bound holds for the worse of both.
        let measured = ((ranges[0] - ranges[1]) / 20.0).acos();
        let sin = normal.to_radians().sin().min(measured.sin());
        let bound = CommonTangents::angle_bound(INCH, 20.0 * INCH, sin.asin()).to_degrees();
        assert!(turned <= bound, "{distance} {normal}: {turned} deg, bound {bound}");
        worst = worst.max(turned / bound);
    }
    assert!(worst > 0.5, "the bound is never near: {worst}");
}

#[test]
fn the_difference_keeps_its_sign() {
    // Looking back at 150°, towards a wall with its normal there: driving away, r grows by 20 cos 30° = 17.32. Without the sign γ
    // would be 30°, out of the beam.
    let ranges = [0.0, 20.0].map(|x| to_wall((x, 0.0), 150.0, 50.0));
    assert!(ranges[1] > ranges[0]);
    let ends = only_segment(&pair(150.0, ranges));
    assert!(error(ends, 150.0, 50.0).0 < 1e-6);
}

#[test]
fn where_both_signs_are_in_the_beam_there_is_none() {
    // Straight ahead, a wall 8° off: γ = +8° and γ = −8° both lie in ±11.25°.
    let ranges = [0.0, 20.0].map(|x| to_wall((x, 0.0), 8.0, 70.0));
    assert!(run(CommonTangents::default(), &pair(0.0, ranges)).unwrap().segments.is_empty());
}

#[test]
fn a_difference_out_of_the_beam_is_no_wall() {
    // Looking left: γ has to lie in 78.75° to 101.25°, so |Δr| ≤ 20 cos 78.75° = 3.90.
    assert_eq!(run(CommonTangents::default(), &pair(90.0, [70.0, 66.2])).unwrap().segments.len(), 1);
    assert!(run(CommonTangents::default(), &pair(90.0, [70.0, 66.0])).unwrap().segments.is_empty());
    assert!(run(CommonTangents::default(), &pair(90.0, [70.0, 40.0])).unwrap().segments.is_empty());
}

#[test]
fn readings_are_paired_over_twenty_inches_of_straight_motion_by_one_sensor() {
    let drive = |turn_deg: f64, other: bool| -> usize {
        let readings: Vec<_> = (0..9)
            .map(|k| {
                let sensor = if other && k % 2 == 1 { Sensor { index: 1, ..NARROW } } else { NARROW };
                let yaw = 90.0 + if k >= 5 { turn_deg } else { 0.0 };
                sensor.reads(k, (5.0 * INCH * k as f64, 0.0), yaw, 70.0 * INCH)
            })
            .collect();
        run(CommonTangents::default(), &readings).unwrap().segments.len()
    };
    // Nine readings 5 in apart: the fifth to the ninth each have one that is 20 in back.
    assert_eq!(drive(0.0, false), 5);
    assert_eq!(drive(3.0, false), 1, "turned after the fifth: only the fifth has one");
    assert_eq!(drive(0.0, true), 3 + 2, "two sensors in turn: 20 in are two of one's readings");
}

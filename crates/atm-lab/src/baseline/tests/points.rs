//! Centerline, interleaving, intersections, triangulation.

use atm::track::Pose;
use atm_core::{Bounds, Echo, Fuser, Kind, LatestArrays, Limits, Point2, Reading, TransversalMedian, Vector2};

use super::{super::*, INCH, NARROW, Sensor, assert_near, run};
use crate::{
    simulate::{Beam, Scene},
    world::World,
};

#[test]
fn centerline_is_range_along_the_boresight() {
    // From (1, 2) at 30°, 2 m: (1 + 2 cos 30°, 2 + 2 sin 30°) = (1 + √3, 3).
    let readings = [NARROW.reads(5, (1.0, 2.0), 30.0, 2.0), NARROW.reads(6, (1.0, 2.0), 30.0, f64::INFINITY)];
    let found = run(Centerline::default(), &readings).unwrap().points;
    assert_eq!(found.len(), 1, "no echo, no point");
    assert!((found[0].position - Point2::new(1.0 + 3f64.sqrt(), 3.0)).norm() < 1e-12);
    assert_eq!((found[0].key, found[0].range), (Some((5, 0)), Some(2.0)));
    assert!(found[0].azimuth.unwrap().abs() < 1e-12);
}

#[test]
fn interleaving_stops_at_every_pose_twice_half_a_beam_apart() {
    let path = [Pose { x: 0.0, y: 0.0, yaw: 0.1 }, Pose { x: 1.0, y: 0.0, yaw: 0.2 }];
    let stops = interleaved(&path, 0.4);
    let seen: Vec<(f64, f64)> = stops.iter().map(|pose| (pose.x, (pose.yaw * 1e6).round() / 1e6)).collect();
    assert_eq!(seen, [(0.0, 0.1), (0.0, 0.3), (1.0, 0.2), (1.0, 0.4)]);
}

#[test]
fn interleaving_applies_to_a_robot_that_turned_by_half_a_beam_where_it_stood() {
    let turning: Vec<_> =
        (0..6).map(|k| NARROW.reads(k, ((k / 2) as f64, 0.0), if k % 2 == 0 { 0.0 } else { 11.25 }, 2.0)).collect();
    assert_eq!(run(Interleave::default(), &turning).unwrap().points.len(), 6);
    let driving: Vec<_> = (0..6).map(|k| NARROW.reads(k, (k as f64, 0.0), 0.0, 2.0)).collect();
    assert!(run(Interleave::default(), &driving).is_none());
    let turning_while_driving: Vec<_> =
        (0..6).map(|k| NARROW.reads(k, (k as f64, 0.0), if k % 2 == 0 { 0.0 } else { 11.25 }, 2.0)).collect();
    assert!(run(Interleave::default(), &turning_while_driving).is_none());
}

/// The ring's beams, in radians.
const FIELD_OF_VIEW: f64 = std::f64::consts::PI / 8.0;

/// The centres of the cones of a ring at each pose, in a corridor with an opening, and how far off each echo was, in radians.
fn centres(world: &World, seed: u64, poses: &[Pose]) -> (Vec<Point2<f64>>, Vec<f64>) {
    let scene = Scene::new(world.clone(), seed);
    let (mut points, mut off) = (Vec::new(), Vec::new());
    for pose in poses {
        for index in 0..16u16 {
            let yaw = pose.yaw + FIELD_OF_VIEW * f64::from(index);
            let at = Point2::new(pose.x, pose.y) + Vector2::new(yaw.cos(), yaw.sin()) * (9.0 * INCH);
            let silent = Sensor { index, ..NARROW }.reads(0, (at.x, at.y), yaw.to_degrees(), f64::INFINITY);
            let Some(heard) = scene.direct(&Beam::new(&silent.pose, FIELD_OF_VIEW), 255.0 * INCH) else {
                continue;
            };
            let reading = Reading { range: Limits::NONE.classify(heard.range), ..silent };
            points.push(run(Centerline::default(), &[reading]).unwrap().points[0].position);
            off.push(heard.azimuth.abs());
        }
    }
    (points, off)
}

/// The widest stretch of the opening without a point within 18 in of the wall's line.
fn open(world: &World, points: &[Point2<f64>]) -> f64 {
    let [from, to] = world.openings()[0].jambs;
    let stands = |point: &&Point2<f64>| (point.y - from.y).abs() < 18.0 * INCH && (from.x..to.x).contains(&point.x);
    let mut across: Vec<f64> = points.iter().filter(stands).map(|point| point.x).collect();
    across.extend([from.x, to.x]);
    across.sort_unstable_by(f64::total_cmp);
    across.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max)
}

#[test]
fn rotating_and_interleaving_does_not_help() {
    // Fig. 5: the cones are as wide as before, so the second half of the centres is as far off as the first, and the opening
    // is no wider.
    let world = World::load("doorway", &[]).unwrap();
    let (mut plain_off, mut turned_off) = (Vec::new(), Vec::new());
    for seed in 1..=10 {
        let path: Vec<Pose> = (0..49).map(|k| Pose { x: f64::from(k) * 5.0 * INCH, y: 0.0, yaw: 0.0 }).collect();
        let (plain, off) = centres(&world, seed, &path);
        let (both, both_off) = centres(&world, seed, &interleaved(&path, FIELD_OF_VIEW));
        assert!(both.len() > plain.len() * 3 / 2, "it does have many more points");
        assert!(open(&world, &both) <= open(&world, &plain), "seed {seed}");
        assert!(open(&world, &both) < 20.0 * INCH, "seed {seed}: {} in of 36 are open", open(&world, &both) / INCH);
        plain_off.extend(off);
        turned_off.extend(both_off);
    }
    let median = |values: &mut Vec<f64>| {
        values.sort_unstable_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let (plain, turned) = (median(&mut plain_off), median(&mut turned_off));
    assert!(turned > 0.9 * plain, "{turned} rad against {plain} rad");
}

#[test]
fn intersections_count_from_any_angle_and_speak_of_the_later_reading() {
    // Radii √2 at (0, 0) and (2, 0) meet in (1, 1), straight ahead of one at 45° and of the other at 135°.
    let flat = [
        NARROW.reads(1, (0.0, 0.0), 45.0, 2f64.sqrt()),
        Sensor { index: 1, ..NARROW }.reads(2, (2.0, 0.0), 135.0, 2f64.sqrt()),
    ];
    let found = run(Intersections::default(), &flat).unwrap().points;
    assert_eq!(found.len(), 1);
    assert!((found[0].position - Point2::new(1.0, 1.0)).norm() < 1e-12);
    assert_eq!(found[0].key, Some((2, 1)));
    // 5 cm apart at 2 m: they meet at 2 asin(0.025 / 2) = 1.4°, and that counts, too.
    let steep = [NARROW.reads(1, (-0.025, 0.0), 90.0, 2.0), NARROW.reads(2, (0.025, 0.0), 90.0, 2.0)];
    let found = run(Intersections::default(), &steep).unwrap().points;
    assert!((found[0].position - Point2::new(0.0, (4.0 - 0.025f64 * 0.025).sqrt())).norm() < 1e-12);
    // From one place they are concentric, and the other intersection here lies behind both sensors.
    let still = [NARROW.reads(1, (0.0, 0.0), 90.0, 2.0), NARROW.reads(2, (0.0, 0.0), 90.0, 2.0)];
    assert!(run(Intersections::default(), &still).unwrap().points.is_empty());
}

#[test]
fn plain_intersections_stand_in_the_doorway_where_the_transversal_median_has_none() {
    // Fig. 14. Jambs at (∓0.45, 1.8); from (∓0.3, 0) each hears its own, r = √(0.15² + 1.8²) = 1.80624. The arcs meet midway, at
    // (0, √(r² − 0.3²)) = (0, 1.78115), 9.56° off either boresight: at 19.1°, no transversal crossing.
    let range = (0.15f64 * 0.15 + 1.8 * 1.8).sqrt();
    let readings = [NARROW.reads(1, (-0.3, 0.0), 90.0, range), NARROW.reads(2, (0.3, 0.0), 90.0, range)];
    let found = run(Intersections::default(), &readings).unwrap().points;
    assert_eq!(found.len(), 1);
    assert!((found[0].position - Point2::new(0.0, 1.781_15)).norm() < 1e-5);
    let mut crossed = 0;
    let mut fuser = Fuser::latest(TransversalMedian::PAPER, Bounds::NONE, LatestArrays::<f64, 1, 10>::new());
    for reading in &readings {
        let mut count = |echo: &Echo<f64>| crossed += u32::from(matches!(echo.kind, Kind::Median | Kind::Single));
        fuser.push(reading, &mut count).unwrap();
    }
    assert_eq!(crossed, 0);
}

#[test]
fn triangulation_finds_a_thin_pole_from_ten_readings() {
    // A pole of radius 1 in at (0, 1): each reading is the distance of its axis less 1 in.
    let (pole, radius) = (Point2::new(0.0, 1.0), INCH);
    let readings: Vec<_> = (0..10)
        .map(|k| {
            let x = -0.45 + 0.1 * k as f64;
            let range = (pole - Point2::new(x, 0.0)).norm() - radius;
            Sensor::with_beam(60.0).reads(k, (x, 0.0), 90.0, range)
        })
        .collect();
    let found = run(TriangulationFusion::default(), &readings).unwrap().points;
    // The first three have fewer than three before them.
    assert_eq!(found.len(), 7);
    for mark in found {
        let off = ((mark.position - pole).norm() - radius).abs();
        assert!(off <= 0.5 * INCH, "{:?} is {} in off", mark.position, off / INCH);
    }
}

#[test]
fn triangulation_takes_the_mean_of_three_hits_within_the_gate_and_nothing_less() {
    // The last reading is the circle of radius 1 around (0, 0), looking along +x. Circles that meet it in (cos α, sin α) are those
    // around (cos α, sin α − 1) with radius 1, from which the point is straight above. Newest first: α = 0°, 30° (0.52 m
    // away: no hit), 4°, 2°: the mean of (1, 0), (0.99756, 0.06976), (0.99939, 0.03490).
    let meets = |t: i64, alpha_deg: f64| {
        let (sin, cos) = alpha_deg.to_radians().sin_cos();
        Sensor::with_beam(30.0).reads(t, (cos, sin - 1.0), 90.0, 1.0)
    };
    let last = Sensor::with_beam(90.0).reads(9, (0.0, 0.0), 0.0, 1.0);
    let found = |alphas: &[f64]| {
        let mut readings: Vec<_> = alphas.iter().enumerate().map(|(t, &alpha)| meets(t as i64, alpha)).collect();
        readings.push(last);
        let points = run(TriangulationFusion::default(), &readings).unwrap().points;
        points.into_iter().filter(|mark| mark.key == Some((9, 0))).collect::<Vec<_>>()
    };
    let three = found(&[2.0, 4.0, 30.0, 0.0]);
    assert_eq!(three.len(), 1);
    assert_near(three[0].position.x, (1.0 + 0.997_564 + 0.999_391) / 3.0, 1e-6);
    assert_near(three[0].position.y, (0.0 + 0.069_756 + 0.034_899) / 3.0, 1e-6);
    assert!(found(&[4.0, 30.0, 0.0]).is_empty(), "two hits");
}

#[test]
fn what_was_seen_before_the_clock_was_set_back_is_forgotten() {
    let readings = [NARROW.reads(1, (-0.3, 0.0), 90.0, 1.8), NARROW.reads(2, (0.3, 0.0), 90.0, 1.8)];
    for reset in [false, true] {
        let mut method = Box::new(Intersections::default());
        method.take(&readings[0]).unwrap();
        if reset {
            method.clock_reset();
        }
        method.take(&readings[1]).unwrap();
        assert_eq!(method.finish().unwrap().unwrap().points.is_empty(), reset);
    }
}

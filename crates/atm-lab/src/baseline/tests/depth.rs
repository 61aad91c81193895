//! Leonard's regions of constant depth.

use atm_core::{Point2, Reading, Vector2};

use super::run;
use super::{super::*, INCH, Sensor};

/// What a sensor hears: feet of perpendiculars on walls, and points that answer from anywhere; all in metres.
struct Room {
    /// Ends of mirror-like walls.
    walls: Vec<[Point2<f64>; 2]>,
    /// Corners.
    corners: Vec<Point2<f64>>,
}

impl Room {
    /// The range in whole inches, as metres.
    fn range(&self, at: Point2<f64>, heading: f64, half_beam: f64) -> f64 {
        let feet = self.walls.iter().filter_map(|[from, to]| {
            let along = to - from;
            let share = along.dot(&(at - from)) / along.norm_squared();
            (0.0..=1.0).contains(&share).then(|| from + along * share)
        });
        let boresight = Vector2::new(heading.cos(), heading.sin());
        let heard = feet.chain(self.corners.iter().copied()).map(|point| point - at);
        let nearest = heard
            .filter(|away| boresight.perp(away).atan2(boresight.dot(away)).abs() <= half_beam)
            .map(|away| away.norm())
            .fold(f64::INFINITY, f64::min);
        (nearest / INCH).round() * INCH
    }

    /// 144 readings: 16 sensors on a ring of radius 9 in, 9 turns of 2.5°, the first by `first_deg`.
    fn turn(&self, at: Point2<f64>, first_deg: f64) -> Vec<Reading<f64>> {
        let mut readings = Vec::new();
        for step in 0..9 {
            for index in 0..16u16 {
                let heading = (first_deg + 2.5 * f64::from(step) + 22.5 * f64::from(index)).to_radians();
                let sensor = at + Vector2::new(heading.cos(), heading.sin()) * (9.0 * INCH);
                let range = self.range(sensor, heading, 11.25f64.to_radians());
                let rig = Sensor { index, ..super::NARROW };
                let reading = rig.reads(i64::from(step), (sensor.x, sensor.y), heading.to_degrees(), range);
                readings.push(Reading { robot: at, ..reading });
            }
        }
        readings
    }
}

fn rectangle(width: f64, height: f64) -> Room {
    let corners = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)].map(|(x, y)| Point2::new(x, y) * INCH);
    let walls = (0..4).map(|k| [corners[k], corners[(k + 1) % 4]]).collect();
    Room { walls, corners: corners.to_vec() }
}

#[test]
fn turning_in_a_rectangular_room_gives_its_four_normals() {
    let room = rectangle(200.0, 150.0);
    for (x, y, first) in [(80.0, 60.0, 0.0), (120.0, 90.0, 0.7), (70.0, 75.0, 1.9)] {
        let readings = room.turn(Point2::new(x, y) * INCH, first);
        assert_eq!(readings.len(), 144);
        let sights: Vec<Sight> = readings.iter().filter_map(Sight::new).collect();
        let found = regions(&sights);
        for (normal, distance) in [(0.0f64, 200.0 - x), (90.0, 150.0 - y), (180.0, x), (270.0, y)] {
            let toward = Vector2::new(normal.to_radians().cos(), normal.to_radians().sin());
            let nearest = found.iter().min_by(|a, b| b.normal.dot(&toward).total_cmp(&a.normal.dot(&toward))).unwrap();
            let off = nearest.normal.perp(&toward).atan2(nearest.normal.dot(&toward)).to_degrees().abs();
            assert!(off <= 1.25 + 1e-9, "normal {normal} at {x} {y}: {off} deg off");
            let depth = toward.dot(&(nearest.mark.position - Point2::new(x, y) * INCH)) / INCH;
            assert!((depth - distance).abs() <= 0.6, "{depth} in, not {distance}");
            assert!(nearest.width.to_degrees() >= 10.0);
        }
    }
}

#[test]
fn a_convex_corner_is_told_from_a_wall_over_several_poses() {
    // A wall along y = 2 m and a post's corner at (1.0, −1.5), from five stops half a metre apart.
    let corner = Point2::new(1.0, -1.5);
    let room = Room { walls: vec![[Point2::new(-5.0, 2.0), Point2::new(5.0, 2.0)]], corners: vec![corner] };
    let readings: Vec<_> =
        (0..5).flat_map(|stop| room.turn(Point2::new(-0.5 + 0.5 * f64::from(stop), 0.0), 0.4)).collect();
    let found = run(ConstantDepth::default(), &readings).unwrap();
    assert_eq!(found.points.len(), 5, "the corner, once from each stop");
    for mark in &found.points {
        assert!((mark.position - corner).norm() < 2.0 * INCH, "{:?}", mark.position);
    }
    assert_eq!(found.segments.len(), 4, "the wall, from each stop to the next");
    for end in found.segments.iter().flat_map(|segment| segment.ends) {
        assert!((end.position.y - 2.0).abs() < INCH, "{:?}", end.position);
    }
}

#[test]
fn a_region_is_an_inch_deep_and_ten_degrees_wide() {
    // Readings of one turning sensor every 2.5°: the plateau from 20° to 20° + width lies 3 in nearer than the rest, but for one
    // range that is `more` inches farther.
    let turn = |width: f64, more: f64| {
        let sights: Vec<Sight> = (0..144)
            .filter_map(|k| {
                let heading = 2.5 * f64::from(k);
                let on = (20.0..=20.0 + width).contains(&heading);
                let inches = if !on {
                    60.0 + 2.0 * f64::from(k % 2)
                } else if heading == 30.0 {
                    57.0 + more
                } else {
                    57.0
                };
                Sight::new(&super::NARROW.reads(0, (0.0, 0.0), heading, inches * INCH))
            })
            .collect();
        regions(&sights)
    };
    let found = turn(20.0, 0.0);
    assert_eq!(found.len(), 1);
    assert!((found[0].width.to_degrees() - 20.0).abs() < 1e-6);
    assert!((found[0].normal.y.atan2(found[0].normal.x).to_degrees() - 30.0).abs() < 1e-6);
    assert_eq!(turn(20.0, 1.0).len(), 1, "an inch is within the tolerance");
    assert_eq!(turn(20.0, 1.5).len(), 0, "an inch and a half leaves 7.5° on either side");
    assert_eq!(turn(10.0, 0.0).len(), 1);
    assert_eq!(turn(7.5, 0.0).len(), 0);
}

#[test]
fn it_does_not_apply_to_a_ring_that_does_not_turn() {
    let room = rectangle(200.0, 150.0);
    let driving: Vec<_> = (0..5)
        .flat_map(|k| room.turn(Point2::new(80.0 + 5.0 * f64::from(k), 60.0) * INCH, 0.0).into_iter().take(16))
        .collect();
    assert!(run(ConstantDepth::default(), &driving).is_none());
}

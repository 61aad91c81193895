use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use nalgebra::{Isometry2, Vector2};

use super::*;

fn scene(tables: &str) -> Scene {
    let text =
        format!("material = \"specular\"\n{tables}\n[path]\nkind = \"straight\"\nfrom = [50, 50]\nto = [60, 50]\n");
    Scene::new(World::parse(&text, "test", &[]).unwrap_or_else(|error| panic!("{error}")), 1)
}

fn beam(x: f64, y: f64, yaw: f64) -> Beam {
    Beam::new(&Isometry2::new(Vector2::new(x, y), yaw), PI / 8.0)
}

fn assert_at(point: Point2<f64>, x: f64, y: f64) {
    assert!((point - Point2::new(x, y)).norm() < 1e-12, "{point}");
}

/// A mirror at 45° in front of the sensor.
const SLANTED: &str = "[[wall]]\npoints = [[1.5, -0.5], [2.5, 0.5]]\n";

#[test]
fn wall_seen_in_a_mirror_answers_over_three_bounces() {
    // From the origin along x, 2 m to the mirror, then up to the wall at y = 3.
    let scene = scene(&format!("{SLANTED}[[wall]]\npoints = [[1, 3], [3, 3]]\n"));
    let ghost = nearest(&scene, &beam(0.0, 0.0, 0.0), f64::INFINITY).unwrap();
    assert!((ghost.range - 5.0).abs() < 1e-12 && ghost.azimuth.abs() < 1e-12, "{ghost:?}");
    assert_at(ghost.point, 2.0, 3.0);
    assert_eq!(ghost.cause, Cause::Multipath);
}

#[test]
fn pole_seen_in_a_mirror_answers() {
    let scene = scene(&format!("{SLANTED}[[pole]]\nx = 2.2\ny = 3\nradius = 0.1\n"));
    let ghost = nearest(&scene, &beam(0.0, 0.0, 0.0), f64::INFINITY).unwrap();
    // Seen from the image at (2, -2).
    assert!((ghost.range - (0.04_f64 + 25.0).sqrt() + 0.1).abs() < 1e-12, "{ghost:?}");
}

#[test]
fn what_stands_in_either_leg_of_the_way_hides_the_ghost() {
    let wall = "[[wall]]\npoints = [[1, 3], [3, 3]]\n";
    for screen in ["[[1, -0.3], [1.01, 0.3]]", "[[1.7, 1.5], [2.3, 1.51]]"] {
        let scene = scene(&format!("{SLANTED}{wall}[[wall]]\npoints = {screen}\nmaterial = \"diffuse\"\n"));
        let ghost = nearest(&scene, &beam(0.0, 0.0, 0.0), f64::INFINITY);
        assert!(ghost.is_none_or(|ghost| (ghost.range - 5.0).abs() > 0.1), "{ghost:?}");
    }
}

#[test]
fn corner_that_is_not_square_returns_sound_over_two_bounces() {
    // Walls from the origin at ±40°, an angle of 80°. The second image of (2, 0) is turned by 160°: 4 sin 80° = 3.939 m off.
    let (x, y) = (5.0 * 40f64.to_radians().cos(), 5.0 * 40f64.to_radians().sin());
    let scene = scene(&format!("[[wall]]\npoints = [[{x}, {y}], [0, 0], [{x}, {}]]\n", -y));
    let wide = Beam::new(&Isometry2::new(Vector2::new(2.0, 0.0), PI), FRAC_PI_4);
    let ghost = nearest(&scene, &wide, f64::INFINITY).unwrap();
    assert!((ghost.range - 2.0 * 80f64.to_radians().sin()).abs() < 1e-12, "{ghost:?}");
    assert!((ghost.azimuth.abs() - 10f64.to_radians()).abs() < 1e-12, "leaves towards the image: {ghost:?}");
    // Both ways leave and arrive 10° off the axis: a beam of 19° hears neither.
    let narrow = Beam::new(&Isometry2::new(Vector2::new(2.0, 0.0), PI), 19f64.to_radians());
    assert!(nearest(&scene, &narrow, f64::INFINITY).is_none());
}

#[test]
fn square_corner_gives_no_ghost_beside_its_own_echo() {
    let scene = scene("[[wall]]\npoints = [[3, 3], [0, 0], [3, -3]]\n");
    let beam = beam(2.0, 0.3, PI);
    let direct = scene.direct(&beam, f64::INFINITY).unwrap();
    assert_eq!(direct.cause, Cause::Corner);
    assert!(nearest(&scene, &beam, direct.range).is_none());
}

#[test]
fn three_mirrors_return_sound_around() {
    // Walls of an equilateral triangle about the origin: from its middle out, around two others, and back.
    let corner = |degrees: f64| format!("[{}, {}]", 4.0 * degrees.to_radians().cos(), 4.0 * degrees.to_radians().sin());
    let scene =
        scene(&format!("[[wall]]\npoints = [{}, {}, {}]\nclosed = true\n", corner(90.0), corner(210.0), corner(330.0)));
    let wide = Beam::new(&Isometry2::new(Vector2::new(0.1, 0.2), -FRAC_PI_2), PI);
    let ghost = nearest(&scene, &wide, f64::INFINITY).unwrap();
    // By hand: all sequences of two or three different walls, and of a wall and the foot on another, by brute force below.
    let shortest = shortest_by_shooting(&scene, Point2::new(0.1, 0.2));
    assert!((ghost.range - shortest).abs() < 1e-3, "{ghost:?} against {shortest}");
}

/// The shortest way back to a point over two or three bounces, by shooting rays in 200,000 directions into the lower half.
fn shortest_by_shooting(scene: &Scene, from: Point2<f64>) -> f64 {
    let walls: Vec<_> = scene
        .world()
        .surfaces()
        .iter()
        .filter_map(|surface| match surface.shape {
            Shape::Segment { from, to } => Some((from, to)),
            Shape::Circle { .. } => None,
        })
        .collect();
    let mut best = f64::INFINITY;
    for ray in 0..200_000 {
        let yaw = -PI * f64::from(ray) / 200_000.0;
        let (mut at, mut direction, mut length) = (from, Vector2::new(yaw.cos(), yaw.sin()), 0.0);
        for bounce in 1..=3 {
            let hit = walls.iter().filter_map(|(start, to)| {
                let way = to - start;
                let far = (start - at).perp(&way) / direction.perp(&way);
                let share = (start - at).perp(&direction) / direction.perp(&way);
                (far > 1e-9 && (0.0..=1.0).contains(&share)).then_some((far, way))
            });
            let Some((far, way)) = hit.min_by(|a, b| a.0.total_cmp(&b.0)) else { break };
            at += direction * far;
            length += far;
            let along = way.normalize();
            direction = along * (2.0 * along.dot(&direction)) - direction;
            // Passing the sensor within a fifth of a millimetre is a return, if the sound arrives from below, too.
            let back = from - at;
            if bounce > 1 && direction.perp(&back).abs() < 2e-4 && direction.dot(&back) > 0.0 && back.y >= 0.0 {
                best = best.min((length + back.norm()) / 2.0);
            }
        }
    }
    best
}

#[test]
fn rough_wall_is_a_mirror_only_beyond_the_critical_angle() {
    let world = |critical: &str, slope: f64| {
        let (x, y) = (slope.to_radians().cos(), slope.to_radians().sin());
        let wall =
            format!("[[wall]]\npoints = [[{}, {}], [{}, {}]]\nmaterial = \"diffuse\"\n", 2.0 - x, -y, 2.0 + x, y);
        let (far_x, far_y) = (2.0 + 3.0 * (2.0 * slope).to_radians().cos(), 3.0 * (2.0 * slope).to_radians().sin());
        scene(
            &format!("[[pole]]\nx = {far_x}\ny = {far_y}\nradius = 0.05\n{wall}")
                .replace("[[pole]]", &format!("critical_angle = \"{critical}\"\n[[pole]]")),
        )
    };
    // A wall 20° off the beam is met at an incidence of 70°.
    assert!(nearest(&world("65deg", 20.0), &beam(0.0, 0.0, 0.0), f64::INFINITY).is_some());
    assert!(nearest(&world("75deg", 20.0), &beam(0.0, 0.0, 0.0), f64::INFINITY).is_none());
}

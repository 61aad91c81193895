use nalgebra::Isometry2;

use super::*;

/// An inch, in metres.
const INCH: f64 = 0.0254;
/// The Nomad's beam: 22.5°.
const BEAM: f64 = std::f64::consts::PI / 8.0;

/// A world of these tables, its path out of the way.
fn world(tables: &str) -> World {
    let text = format!("{tables}\n[path]\nkind = \"straight\"\nfrom = [50, 50]\nto = [60, 50]\n");
    World::parse(&text, "test", &[]).unwrap_or_else(|error| panic!("{error}"))
}

/// Walls through points in inches, of one material.
fn walls(material: &str, polylines: &[&[(f64, f64)]]) -> World {
    let wall = |points: &&[(f64, f64)]| {
        let points: Vec<String> = points.iter().map(|(x, y)| format!("[\"{x}in\", \"{y}in\"]")).collect();
        format!("[[wall]]\npoints = [{}]\n", points.join(", "))
    };
    world(&format!("material = \"{material}\"\n{}", polylines.iter().map(wall).collect::<String>()))
}

/// A closed wall 70 in ahead of a sensor at the origin that looks along +y.
const AHEAD: &[(f64, f64)] = &[(200.0, 70.0), (-200.0, 70.0)];

/// Bumps at (x, y) in inches on the first wall, seen from the front.
fn with_bumps(world: World, bumps: &[(f64, f64)]) -> Scene {
    let bump = |&(x, y): &(f64, f64)| Bump { sides: [Point2::new(x * INCH, y * INCH); 2], surface: 0 };
    Scene::with_bumps(world, bumps.iter().map(bump).collect())
}

fn bare(world: World) -> Scene {
    Scene::with_bumps(world, Vec::new())
}

/// The beam of a sensor at a place in inches, `degrees` counter-clockwise of +y, 22.5° wide.
fn beam_at((x, y): (f64, f64), degrees: f64) -> Beam {
    Beam::new(&Isometry2::new(Vector2::new(x * INCH, y * INCH), (90.0 + degrees).to_radians()), BEAM)
}

fn beam(degrees: f64) -> Beam {
    beam_at((0.0, 0.0), degrees)
}

/// Cause and range in inches, if anything is heard.
fn heard(scene: &Scene, beam: &Beam) -> Option<(Cause, f64)> {
    scene.direct(beam, f64::INFINITY).map(|found| (found.cause, found.range / INCH))
}

#[track_caller]
fn assert_heard(scene: &Scene, beam: &Beam, cause: Cause, inches: f64) {
    let (found, range) = heard(scene, beam).expect("an echo");
    assert_eq!(found, cause);
    assert!((range - inches).abs() < 1e-9, "{range} in");
}

#[test]
fn specular_wall_answers_at_the_foot_of_the_perpendicular_across_the_whole_beam() {
    let scene = bare(walls("specular", &[AHEAD]));
    for degrees in [0.0, 11.24, -11.24] {
        assert_heard(&scene, &beam(degrees), Cause::Wall, 70.0);
    }
    assert_eq!(heard(&scene, &beam(11.26)), None);
}

#[test]
fn rough_wall_is_a_weak_mirror_up_to_half_the_half_beam() {
    let scene = bare(walls("rough", &[AHEAD]));
    assert_heard(&scene, &beam(5.6), Cause::Wall, 70.0);
    assert_eq!(heard(&scene, &beam(5.65)), None);
}

#[test]
fn mirror_ends_with_the_wall() {
    let until = |end: f64| bare(walls("specular", &[&[(end, 70.0), (-200.0, 70.0)]]));
    assert_heard(&until(0.0), &beam(0.0), Cause::Wall, 70.0);
    // Beyond it only its end is heard, which is farther away.
    let (cause, range) = heard(&until(-1.0), &beam(0.0)).unwrap();
    assert!(cause == Cause::Corner && range > 70.0);
}

#[test]
fn bump_beats_the_mirror_only_where_it_is_nearer() {
    // (8, 69.5): 69.962 in, before the wall's 70; (9, 69.5): 70.080 in, behind it.
    let near = with_bumps(walls("rough", &[AHEAD]), &[(8.0, 69.5)]);
    assert_heard(&near, &beam(0.0), Cause::Scatterer, (64.0_f64 + 69.5 * 69.5).sqrt());
    let far = with_bumps(walls("rough", &[AHEAD]), &[(9.0, 69.5)]);
    assert_heard(&far, &beam(0.0), Cause::Wall, 70.0);
}

#[test]
fn bump_is_hidden_by_another_wall() {
    let screen: &[(f64, f64)] = &[(1.0, 30.0), (-1.0, 30.0)];
    let shaded = with_bumps(walls("rough", &[AHEAD, screen]), &[(0.0, 69.0)]);
    assert_heard(&shaded, &beam(0.0), Cause::Wall, 30.0);
    // Off the screen's perpendicular its ends are heard, and the bump behind it is not.
    let aside = beam_at((0.0, 0.0), 6.0);
    assert_heard(&shaded, &aside, Cause::Corner, 901.0_f64.sqrt());
}

#[test]
fn jamb_answers_off_the_perpendicular_and_hides_the_room_beside_it() {
    let left: &[(f64, f64)] = &[(-18.0, 70.0), (-200.0, 70.0)];
    let back: &[(f64, f64)] = &[(200.0, 170.0), (-200.0, 170.0)];
    let mut scene = walls("rough", &[back, left]);
    // Seen from the origin the bump at (-50, 170) passes the wall's line at x = -20.6, inside the left wall.
    let doorway = with_bumps(std::mem::replace(&mut scene, walls("rough", &[back])), &[(-50.0, 170.0)]);
    assert_heard(&doorway, &beam(20.0), Cause::Corner, (18.0_f64 * 18.0 + 70.0 * 70.0).sqrt());
    // 16.4° off +y, more than 11.25° off a beam turned to 27.7°.
    assert_eq!(heard(&doorway, &beam(27.7)), None);
    assert_heard(&doorway, &beam(0.0), Cause::Wall, 170.0);
    let without_wall = with_bumps(scene, &[(-50.0, 170.0)]);
    assert_heard(&without_wall, &beam(20.0), Cause::Scatterer, (50.0_f64 * 50.0 + 170.0 * 170.0).sqrt());
}

#[test]
fn thin_wall_shows_its_bumps_on_the_side_they_are_seen_from() {
    let bump = Bump { sides: [Point2::new(0.0, 69.5 * INCH), Point2::new(0.0, 70.5 * INCH)], surface: 0 };
    // From its first end on, its left is below.
    let scene = Scene::with_bumps(walls("rough", &[AHEAD]), vec![bump]);
    assert_heard(&scene, &beam(8.0), Cause::Scatterer, 69.5);
    assert_heard(&scene, &beam_at((0.0, 140.0), 188.0), Cause::Scatterer, 69.5);
}

#[test]
fn pole_is_heard_at_any_bearing_in_the_beam() {
    let scene = bare(world("[[pole]]\nx = 0\ny = 2\nradius = 0.1\nmaterial = \"specular\""));
    for degrees in [0.0, 11.24, -11.24] {
        assert_heard(&scene, &beam(degrees), Cause::Pole, 1.9 / INCH);
    }
    assert_eq!(heard(&scene, &beam(11.3)), None);
}

#[test]
fn pole_hides_what_is_behind_it() {
    let pole = "[[pole]]\nx = 0\ny = 1\nradius = 0.3\nmaterial = \"specular\"\n";
    let far = "[[pole]]\nx = 0.5\ny = 3\nradius = 0.1\nmaterial = \"specular\"\n";
    let scene = bare(world(&format!("{pole}{far}")));
    // The near pole's middle is out of a beam from 73° to 83°; the far one's, at 80.5°, passes it 0.16 m off its middle.
    let aside = Beam::new(&Isometry2::new(Vector2::zeros(), 78f64.to_radians()), 10f64.to_radians());
    assert_eq!(heard(&scene, &aside), None);
    let alone = bare(world(far));
    assert_eq!(heard(&alone, &aside).map(|found| found.0), Some(Cause::Pole));
}

#[test]
fn square_corner_returns_its_apex_and_a_dull_one_is_silent() {
    let corner = |x: f64| bare(walls("specular", &[&[(-100.0, 0.0), (0.0, 100.0), (x, 0.0)]]));
    assert_heard(&corner(100.0), &beam_at((0.0, 30.0), 0.0), Cause::Corner, 70.0);
    assert_heard(&corner(100.0), &beam_at((3.0, 30.0), 0.0), Cause::Corner, (70.0_f64 * 70.0 + 9.0).sqrt());
    // 45° and 56° off the axis: not square, and no foot is in the beam.
    assert_eq!(heard(&corner(150.0), &beam_at((0.0, 30.0), 0.0)), None);
    // From behind it is an edge, whatever its angle.
    assert_heard(&corner(150.0), &beam_at((0.0, 150.0), 180.0), Cause::Corner, 50.0);
}

#[test]
fn diffuse_wall_answers_at_the_beams_edge_up_to_the_critical_angle() {
    let wall = "critical_angle = \"50deg\"\n[[wall]]\npoints = [[-9, 2], [9, 2]]\nmaterial = \"diffuse\"\n";
    let scene = bare(world(wall));
    let range = |degrees: f64| scene.direct(&beam(degrees), f64::INFINITY).map(|found| found.range);
    let at = |degrees: f64| 2.0 / degrees.to_radians().cos();
    assert!((range(5.0).unwrap() - 2.0).abs() < 1e-12, "the foot is in the beam");
    assert!((range(30.0).unwrap() - at(18.75)).abs() < 1e-12);
    assert!((range(-61.2).unwrap() - at(49.95)).abs() < 1e-12);
    assert_eq!(range(61.3), None);
}

#[test]
fn diffuse_wall_answers_from_beside_what_hides_its_nearest_point() {
    // The screen at y = 1 from x = -0.1 to 0.3 hides the wall from x = -0.2 to 0.6. Its own ends are edges.
    let walls = "[[wall]]\npoints = [[-9, 2], [9, 2]]\nmaterial = \"diffuse\"\n\
                 [[wall]]\npoints = [[-0.1, 1], [0.3, 1]]\nmaterial = \"specular\"\n";
    let scene = bare(world(walls));
    let surface = scene.world.surfaces()[0];
    let nearest = |degrees| diffuse::nearest(&scene.world, &beam(degrees), 0, &surface.shape, f64::INFINITY);
    let point = nearest(0.0).unwrap();
    assert!((point - Point2::new(-0.2, 2.0)).norm() < 1e-12, "{point}");
    // Turned to the right the left end is out of the beam: from -2° on, tan 9.25° · 2 = 0.326 is hidden, too.
    let point = nearest(-14.0).unwrap();
    assert!((point - Point2::new(0.6, 2.0)).norm() < 1e-12, "{point}");
}

#[test]
fn bumps_keep_their_spacing_and_depth() {
    // A slanted wall, along (3, 4) / 5.
    let scene = Scene::new(walls("rough", &[&[(0.0, 0.0), (3000.0, 4000.0)]]), 7);
    let along = |p: &Point2<f64>| (0.6 * p.x + 0.8 * p.y) / INCH;
    let depth = |p: &Point2<f64>| (-0.8 * p.x + 0.6 * p.y) / INCH;
    assert!((104..=417).contains(&scene.bumps().len()));
    for pair in scene.bumps().windows(2) {
        let spacing = along(&pair[1].sides[0]) - along(&pair[0].sides[0]);
        assert!((12.0 - 1e-9..48.0 + 1e-9).contains(&spacing), "{spacing}");
        let [left, right] = pair[0].sides;
        assert!((-1e-9..1.0 + 1e-9).contains(&depth(&left)) && (depth(&left) + depth(&right)).abs() < 1e-9);
    }
}

#[test]
fn only_rough_surfaces_have_bumps() {
    for name in ["specular-wall", "diffuse-wall", "pole", "corners"] {
        assert!(Scene::new(World::load(name, &[]).unwrap(), 1).bumps().is_empty(), "{name}");
    }
    assert!(!Scene::new(World::load("rough-wall", &[]).unwrap(), 1).bumps().is_empty());
}

use super::*;

/// A closed wall 70 in to the left of a sensor at the origin that looks along +y, with bumps at (x, y) in inches.
fn wall_ahead(bumps: &[(f64, f64)]) -> RoughWall {
    let bumps = bumps.iter().map(|&(x, y)| at(x, y)).collect();
    RoughWall::new(at(200.0, 70.0), at(-200.0, 70.0), bumps)
}

fn at(x: f64, y: f64) -> Point2<f64> {
    Point2::new(inches(x), inches(y))
}

fn world(walls: Vec<RoughWall>, edges: Vec<Point2<f64>>) -> RoughWorld {
    RoughWorld { walls, edges }
}

/// The beam of a sensor at the origin, `degrees` counter-clockwise of +y, 22.5° wide.
fn beam(degrees: f64) -> Beam {
    Beam::new(Point2::origin(), (90.0 + degrees).to_radians(), FIELD_OF_VIEW)
}

fn heard(world: &RoughWorld, beam: &Beam) -> (Cause, f64) {
    let found = world.reflection(beam).expect("an echo");
    (found.cause, found.range / inches(1.0))
}

fn assert_inches(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-9, "{found} in");
}

#[test]
fn bare_wall_answers_at_the_foot_of_the_perpendicular() {
    let (cause, range) = heard(&world(vec![wall_ahead(&[])], vec![]), &beam(0.0));
    assert_eq!(cause, Cause::Mirror);
    assert_inches(range, 70.0);
}

#[test]
fn mirror_is_heard_up_to_half_the_half_beam_off_axis() {
    let world = world(vec![wall_ahead(&[])], vec![]);
    assert!(world.reflection(&beam(5.6)).is_some());
    assert!(world.reflection(&beam(5.65)).is_none());
}

#[test]
fn mirror_ends_with_the_wall() {
    let until = |end: f64| RoughWall::new(at(end, 70.0), at(-200.0, 70.0), vec![]);
    assert!(world(vec![until(0.0)], vec![]).reflection(&beam(0.0)).is_some());
    assert!(world(vec![until(-0.01)], vec![]).reflection(&beam(0.0)).is_none());
}

#[test]
fn bump_beats_the_mirror_only_where_it_is_nearer() {
    // (8, 69.5): 69.962 in, before the wall's 70; (9, 69.5): 70.080 in, behind it.
    let near = world(vec![wall_ahead(&[(8.0, 69.5)])], vec![]);
    let (cause, range) = heard(&near, &beam(0.0));
    assert_eq!(cause, Cause::Scatterer);
    assert_inches(range, (64.0_f64 + 69.5 * 69.5).sqrt());
    let far = world(vec![wall_ahead(&[(9.0, 69.5)])], vec![]);
    assert_eq!(heard(&far, &beam(0.0)).0, Cause::Mirror);
}

#[test]
fn bump_is_heard_up_to_the_border_of_the_beam() {
    // atan(20 / 70) = 15.9454° clockwise of +y, so the borders are beams turned by -4.6954° and -27.1954°.
    let stub = RoughWall::new(at(200.0, 70.0), at(10.0, 70.0), vec![at(20.0, 70.0)]);
    let world = world(vec![stub], vec![]);
    for (degrees, inside) in [(-4.69, false), (-4.70, true), (-27.19, true), (-27.20, false)] {
        assert_eq!(world.reflection(&beam(degrees)).is_some(), inside, "{degrees}°");
    }
}

#[test]
fn bump_is_hidden_from_behind_its_wall_and_by_another_wall() {
    let behind = RoughWall::new(at(-200.0, 70.0), at(200.0, 70.0), vec![at(0.0, 70.5)]);
    assert!(world(vec![behind], vec![]).reflection(&beam(0.0)).is_none());
    let screen = RoughWall::new(at(1.0, 30.0), at(-1.0, 30.0), vec![]);
    let shaded = world(vec![wall_ahead(&[(0.0, 69.0)]), screen], vec![]);
    assert_inches(heard(&shaded, &beam(0.0)).1, 30.0);
    assert!(shaded.reflection(&beam(6.0)).is_none());
}

#[test]
fn jamb_answers_off_the_perpendicular_and_hides_the_room_beside_it() {
    let left = RoughWall::new(at(-18.0, 70.0), at(-200.0, 70.0), vec![]);
    let back = RoughWall::new(at(200.0, 170.0), at(-200.0, 170.0), vec![at(-50.0, 170.0)]);
    // Seen from the origin the bump at (-50, 170) passes the wall's line at x = -20.6, inside the left wall.
    let doorway = world(vec![left, back], vec![at(-18.0, 70.0)]);
    let (cause, range) = heard(&doorway, &beam(20.0));
    assert_eq!(cause, Cause::Edge);
    assert_inches(range, (18.0_f64 * 18.0 + 70.0 * 70.0).sqrt());
    // 16.4° off +y, more than 11.25° off a beam turned to 27.7°.
    assert!(doorway.reflection(&beam(27.7)).is_none());
    let (cause, range) = heard(&doorway, &beam(0.0));
    assert_eq!(cause, Cause::Mirror);
    assert_inches(range, 170.0);
}

#[test]
fn reading_rounds_halves_up_and_marks_what_is_out_of_range() {
    let reading = |inch: f64| nomad_reading(Some(inches(inch)));
    assert_eq!(reading(61.49), 1.5494);
    assert_eq!(reading(61.5), 1.5748);
    assert_eq!(reading(5.5), 0.1524);
    assert_eq!(reading(5.49), f64::NEG_INFINITY);
    assert_eq!(reading(254.49), 6.4516);
    assert_eq!(reading(254.5), f64::INFINITY);
    assert_eq!(nomad_reading(None), f64::INFINITY);
}

#[test]
fn bumps_keep_their_spacing_and_depth() {
    let mut random = ChaCha8Rng::from_seed([7; 32]);
    // A slanted wall, along (3, 4) / 5.
    let wall = RoughWall::draw(at(0.0, 0.0), at(3000.0, 4000.0), &mut random);
    let along = |p: &Point2<f64>| 0.6 * p.x + 0.8 * p.y;
    let depth = |p: &Point2<f64>| -0.8 * p.x + 0.6 * p.y;
    assert!((104..=417).contains(&wall.scatterers().len()));
    for pair in wall.scatterers().windows(2) {
        let spacing = along(&pair[1]) - along(&pair[0]);
        assert!((MIN_SPACING - 1e-9..MAX_SPACING + 1e-9).contains(&spacing));
        assert!((-1e-9..MAX_DEPTH + 1e-9).contains(&depth(&pair[0])));
    }
    assert!(RoughWall::draw(at(1.0, 1.0), at(1.0, 1.0), &mut random).scatterers().is_empty());
}

#[test]
fn opening_lies_abreast_of_the_middle_of_the_path() {
    assert!((OPENING_END - OPENING_START - OPENING).abs() < 1e-12);
    let middle = STEP * f64::from(SWEEPS - 1) / 2.0;
    assert!(((OPENING_START + OPENING_END) / 2.0 - middle).abs() < 1e-12);
}

#[test]
fn sample_log_is_the_one_this_code_writes() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/doorway.csv");
    let stored = std::fs::read_to_string(path).expect("the sample log");
    assert!(stored == doorway_log(DOORWAY_SEED), "write it anew: make_doorway");
}

#[test]
fn log_has_every_sensor_once_a_sweep_and_differs_by_seed() {
    let log = doorway_log(2);
    assert_eq!(log.lines().count(), 1 + 49 * 16);
    assert_eq!(log.lines().next(), Some("t,sensor,range,x,y,yaw"));
    let last: Vec<&str> = log.lines().last().expect("a row").split(',').collect();
    assert_eq!([last[0], last[1], last[3]], ["48", "15", "6.096"]);
    assert_ne!(log, doorway_log(3));
}

/// Widest stretch of the opening without the centre of an arc within 12 in of the wall's line, in inches.
fn gap_between_centers(log: &str) -> f64 {
    let mut xs = vec![OPENING_START, OPENING_END];
    for row in log.lines().skip(1) {
        let cells: Vec<f64> = row.split(',').map(|c| c.parse().expect("number")).collect();
        let yaw = FIELD_OF_VIEW * cells[1];
        let reach = RING_RADIUS + cells[2];
        let (x, y) = (cells[3] + reach * libm::cos(yaw), reach * libm::sin(yaw));
        if (y - WALL_DISTANCE).abs() <= inches(12.0) && (OPENING_START..OPENING_END).contains(&x) {
            xs.push(x);
        }
    }
    xs.sort_by(f64::total_cmp);
    let widest = xs.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    widest / inches(1.0)
}

#[test]
fn centers_of_the_arcs_all_but_close_the_opening() {
    for seed in 1..=30 {
        let gap = gap_between_centers(&doorway_log(seed));
        assert!(gap < 16.0, "seed {seed}: {gap} in");
    }
}

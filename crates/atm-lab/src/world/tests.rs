use super::*;

const PATH: &str = "[path]\nkind = \"straight\"\nfrom = [0, 0]\nto = [1, 0]\n";
const WALL: &str = "[[wall]]\npoints = [[-1, 1], [2, 1]]\n";

fn set(pairs: &[(&str, &str)]) -> Vec<(String, String)> {
    pairs.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect()
}

fn load(name: &str, pairs: &[(&str, &str)]) -> Result<World> {
    World::load(name, &set(pairs))
}

#[track_caller]
fn said<T>(result: Result<T>) -> String {
    result.err().expect("a refusal").to_string()
}

fn parse(text: &str) -> Result<World> {
    World::parse(text, "w.toml", &[])
}

/// Insists on what is said of a file.
#[track_caller]
fn refused(text: &str, expected: &str) {
    assert_eq!(said(parse(text)), expected);
}

#[test]
fn every_built_in_world_is_there_and_can_be_driven_through() {
    for name in World::BUILTIN {
        let world = load(name, &[]).unwrap();
        assert_eq!(world.name(), name);
        assert!(!world.surfaces().is_empty() && world.path().sweep_count() > 10, "{name}");
        for (_, pose) in world.path().sweeps() {
            assert!(world.distance(Point2::new(pose.x, pose.y)) > 0.2286, "{name}: the ring is in a wall at {pose:?}");
        }
    }
}

#[test]
fn doorway_has_the_opening_that_is_set_abreast_of_the_middle_of_the_path() {
    let world = load("doorway", &[("opening", "1m"), ("distance", "2m"), ("length", "5m")]).unwrap();
    let [opening] = world.openings() else { panic!("one opening") };
    assert!((opening.width() - 1.0).abs() < 1e-12);
    assert_eq!(opening.jambs.map(|jamb| (jamb.x, jamb.y)), [(2.0, 2.0), (3.0, 2.0)]);
    assert!((world.distance(Point2::new(2.5, 2.0)) - 0.5).abs() < 1e-12);
    let [(0, first), .., (_, last)] = world.path().sweeps().collect::<Vec<_>>()[..] else { panic!("sweeps") };
    assert_eq!((first.x, last.x), (0.0, 4.953), "39 steps of 5 in");
}

#[test]
fn closed_wall_is_the_doorway_with_its_opening_shut() {
    let (open, closed) = (load("doorway", &[]).unwrap(), load("closed-wall", &[]).unwrap());
    assert!(closed.openings().is_empty());
    assert_eq!(open.surfaces(), &closed.surfaces()[..4]);
    let middle = Point2::new(120.0 * 0.0254, 70.0 * 0.0254);
    assert!(closed.distance(middle) < 1e-12 && (open.distance(middle) - 18.0 * 0.0254).abs() < 1e-12);
}

#[test]
fn distance_is_that_to_the_nearest_of_all_surfaces() {
    let world = load("room", &[]).unwrap();
    for step in 0..400 {
        let point = Point2::new(f64::from(step % 20) * 0.35 - 0.3, f64::from(step / 20) * 0.3 - 0.4);
        let every = world.surfaces().iter().map(|surface| surface.shape.distance(point));
        assert_eq!(world.distance(point), every.fold(f64::INFINITY, f64::min), "{point}");
    }
}

#[test]
fn parameters_are_checked_by_name_and_value() {
    let refused = |key, value, words: &str| {
        let said = said(load("doorway", &[(key, value)]));
        assert!(said.starts_with(&format!("doorway: {key} = {value}: ")) && said.contains(words), "{said}");
    };
    refused("opening", "-36in", "must be above zero");
    refused("opening", "0", "must be above zero");
    refused("opening", "36deg", "no unit `deg`");
    refused("material", "velvet", "expected one of specular, rough, diffuse");
    refused("width", "1m", "no such parameter; expected one of opening, distance, length");
    refused("path", "flying", "expected one of straight, weaving, turning");
    refused("rate", "0Hz", "must be above zero");
    assert!(said(load("doorway", &[("critical_angle", "90deg")])).contains("below 90deg"));
    assert!(said(load("doorway", &[("distance", "2000km")])).contains("no unit"));
    assert!(said(load("doorway", &[("distance", "2e6m")])).contains("at most 1000 km away"));
    assert!(said(load("doorway", &[("length", "1e5m")])).contains("more than 100 km of rough surfaces"));
    assert!(said(load("doorway", &[("speed", "1e-12")])).contains("sweeps: at most"));
    assert!(said(load("tee", &[("opening", "3m")])).contains("opening is not less than width"));
}

#[test]
fn path_of_a_built_in_world_can_be_chosen() {
    let world = load("rough-wall", &[("path", "weaving"), ("amplitude", "10cm"), ("wavelength", "1m")]).unwrap();
    let most = world.path().sweeps().map(|(_, pose)| pose.y.abs()).fold(0.0, f64::max);
    assert!((0.09..=0.1).contains(&most), "{most}");
    let world = load("rough-wall", &[("path", "turning"), ("turn_step", "10deg")]).unwrap();
    let sweeps: Vec<_> = world.path().sweeps().collect();
    assert_eq!(sweeps.len(), 37);
    assert!((sweeps[9].1.yaw - std::f64::consts::FRAC_PI_2).abs() < 1e-9 && sweeps[9].1.x == 3.048);
    let said = said(load("rough-wall", &[("path", "weaving"), ("amplitude", "80in")]));
    assert!(said.contains("the path: leads through the wall from (13.716, 1.778) to (-7.620, 1.778)"), "{said}");
}

#[test]
fn waypoints_are_driven_straight_from_one_to_the_next() {
    let text = format!("{WALL}[path]\nkind = \"waypoints\"\npoints = [[0, 0], [0.3, 0], [0.3, -0.3]]\nspeed = 0.1\n");
    let poses: Vec<_> = parse(&text).unwrap().path().sweeps().map(|(t, pose)| (t, pose.x, pose.y, pose.yaw)).collect();
    // Poses are given to nine decimals.
    let down = -(std::f64::consts::FRAC_PI_2 * 1e9).round() / 1e9;
    let expected = [
        (0, 0.0, 0.0, 0.0),
        (1_000_000_000, 0.1, 0.0, 0.0),
        (2_000_000_000, 0.2, 0.0, 0.0),
        (3_000_000_000, 0.3, 0.0, down),
        (4_000_000_000, 0.3, -0.1, down),
        (5_000_000_000, 0.3, -0.2, down),
        (6_000_000_000, 0.3, -0.3, down),
    ];
    assert_eq!(poses, expected);
}

#[test]
fn a_file_is_a_world_with_its_materials() {
    let text = format!(
        "name = \"hall\"\nmaterial = \"diffuse\"\ncritical_angle = \"45deg\"\n{WALL}[[wall]]\npoints = [[0, \"-4ft\"], [1, -2], [3, -2]]\n\
         closed = true\nmaterial = \"rough\"\n[[pole]]\nx = 5\ny = 0\nradius = \"2cm\"\nmaterial = \"specular\"\n{PATH}"
    );
    let world = parse(&text).unwrap();
    assert_eq!((world.name(), world.critical_angle()), ("hall", 45.0 * (PI / 180.0)));
    let materials: Vec<_> = world.surfaces().iter().map(|surface| surface.material).collect();
    assert_eq!(materials, [Material::Diffuse, Material::Rough, Material::Rough, Material::Rough, Material::Specular]);
    assert_eq!(world.surfaces()[4].shape, Shape::Circle { center: Point2::new(5.0, 0.0), radius: 0.02 });
    let set = set(&[("material", "specular"), ("speed", "1m/s")]);
    let world = World::parse(&text, "w.toml", &set).unwrap();
    assert_eq!((world.surfaces()[0].material, world.path().speed()), (Material::Specular, 1.0));
    assert_eq!(world.surfaces()[1].material, Material::Rough, "its own word counts");
}

#[test]
fn what_is_no_world_is_named_by_line_and_key() {
    refused("", "w.toml: `path` is missing");
    refused(PATH, "w.toml: an empty world: expected at least one wall or pole");
    refused(
        &format!("[[wall]]\npoints = [\n  [0, 1],\n  [0, 1]]\n{PATH}"),
        "w.toml:4: `wall.points` = [0, 1]: a wall of no length: its ends must be more than 3 mm apart",
    );
    refused(
        &format!("[[wall]]\npoints = [[0, 1]]\n{PATH}"),
        "w.toml:2: `wall.points` = [[0, 1]]: a wall of no length: expected at least two points",
    );
    refused(
        &format!("{WALL}material = \"velvet\"\n{PATH}"),
        "w.toml:3: `wall.material` = \"velvet\": no such material; expected one of specular, rough, diffuse",
    );
    refused(
        &format!("[[pole]]\nx = 1\ny = 1\nradius = \"-2cm\"\n{PATH}"),
        "w.toml:4: `pole.radius` = \"-2cm\": must be above zero and at most 1000 km",
    );
    for path in ["yaw = \"3917671e300deg\"", "turn = \"-1e7rad\""] {
        let text = format!("{WALL}[path]\nkind = \"turning\"\nat = [0, 0]\n{path}\nturn_step = \"1e6rad\"\n");
        let words = World::parse(&text, "w.toml", &[]).unwrap_err().to_string();
        assert!(words.ends_with("yaw and turn must be at most 1000000 rad"), "{words}");
    }
    refused(
        &format!("{WALL}thick = 1\n{PATH}"),
        "w.toml:3: unknown key `thick` in [[wall]]; expected one of points, closed, material",
    );
    refused(
        &format!("[[wall]]\npoints = [[0, 1], [1]]\n{PATH}"),
        "w.toml:2: `wall.points` = [1]: expected a point: [x, y]",
    );
    refused(
        &format!("critical_angle = \"0deg\"\n{WALL}{PATH}"),
        "w.toml:1: `critical_angle` = \"0deg\": must be above 0deg and below 90deg",
    );
    refused(
        &format!("{WALL}[path]\nkind = \"flying\"\n"),
        "w.toml:4: `path.kind` = \"flying\": expected one of straight, weaving, turning, waypoints",
    );
}

#[test]
fn path_through_a_wall_and_robot_in_a_pole_are_named_with_both_lines() {
    refused(
        "[[wall]]\npoints = [[0.5, -1], [0.5, 1]]\n[path]\nkind = \"straight\"\nfrom = [0, 0]\nto = [1, 0]\n",
        "w.toml:3: `path`: leads through what line 2 describes",
    );
    refused(
        &format!("[[pole]]\nx = 0.1\ny = 0\nradius = 0.2\n{PATH}"),
        "w.toml:5: `path`: the robot would start inside what line 4 describes",
    );
    refused(
        &format!("[[wall]]\npoints = [[0, -1], [0, 1]]\n{PATH}"),
        "w.toml:3: `path`: the robot would start inside what line 2 describes",
    );
    refused(
        &format!("{WALL}[path]\nkind = \"straight\"\nfrom = [1, 0]\nto = [1, 0]\n"),
        "w.toml:3: `path`: a path of no length",
    );
    refused(
        &format!("{WALL}[path]\nkind = \"waypoints\"\npoints = [[0, 0], [0, 0]]\n"),
        "w.toml:3: `path`: points 1 and 2 are the same",
    );
    refused(
        &format!("{WALL}[path]\nkind = \"straight\"\nfrom = [0, 0]\nto = [1, 0]\nspeed = -1\n"),
        "w.toml:7: `path.speed` = -1: must be above zero",
    );
}

#[test]
fn opening_lies_between_ends_of_walls() {
    let opening =
        |to: &str| format!("{WALL}[[wall]]\npoints = [[3, 1], [4, 1]]\n[[opening]]\nfrom = [2, 1]\nto = {to}\n{PATH}");
    assert_eq!(parse(&opening("[3, 1]")).unwrap().openings()[0].width(), 1.0);
    refused(
        &opening("[3.5, 1]"),
        "w.toml:6: `opening.from` = [2, 1]: must begin and end at convex corners or at ends of walls",
    );
    refused(&opening("[2, 1]"), "w.toml:6: `opening.from` = [2, 1]: has no width");
}

#[test]
fn name_that_is_neither_built_in_nor_a_file_is_answered_with_those_there_are() {
    let said = said(load("dooorway", &[]));
    assert!(
        said.starts_with("dooorway: no such world file, and no built-in world of this name (doorway, closed-wall, tee"),
        "{said}"
    );
}

#[test]
fn sight_through_a_joint_is_blocked_whatever_the_angle() {
    let text = format!("[[wall]]\npoints = [[-3, 2], [0.1, 1.3], [2.2, 3]]\n{PATH}");
    let world = parse(&text).unwrap();
    for step in 0..1000 {
        let yaw = 0.3 + f64::from(step) * 0.002;
        let joint = Point2::new(0.1, 1.3);
        let away = nalgebra::Vector2::new(libm::cos(yaw), libm::sin(yaw));
        // Straight across: from below to above.
        assert!(!world.sees(joint - away, joint + away * 1.5, &[]) || yaw < 0.69, "{yaw}");
    }
}

//! What the messages say: the numbers of the tables, and where the robot was.

use std::{
    collections::{BTreeMap, BTreeSet},
    f64::consts::PI,
};

use atm::{
    log::mcap::write::{Contents, Frames, Options, SchemaKind, Transforms},
    pipeline::Emit,
    stamp,
};

use crate::{
    cdr::Cdr,
    cloud::Cloud,
    proto::Proto,
    sample::{KINDS, Logged, doorway, fuse, messages, of_topic, options, recorded, sensor_names, sink, tables},
};

/// A number as a table writes it.
fn text(value: f64) -> String {
    // A negative zero and a whole number are written with their point, as the table does.
    format!("{value:?}")
}

fn row(cells: &[String]) -> String {
    cells.join(",")
}

/// One table's numbers may be written differently from another's: they are compared as bits.
fn parsed(row: &str) -> Vec<Result<u64, String>> {
    row.split(',').map(|cell| cell.parse::<f64>().map(f64::to_bits).map_err(|_| cell.to_owned())).collect()
}

#[track_caller]
fn assert_same_rows(found: &[String], expected: &[String]) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert_eq!(parsed(found), parsed(expected), "{found} is not {expected}");
    }
}

fn place(point: &BTreeMap<String, f64>) -> [f64; 2] {
    // What is exact wins.
    ["x", "y"].map(|name| *point.get(&format!("exact_{name}")).unwrap_or(&point[name]))
}

fn echo_rows(file: &[u8]) -> Vec<String> {
    let names = sensor_names(file);
    let kinds = ["median", "single", "center", "near", "pair"];
    let mut rows = Vec::new();
    for message in of_topic(file, "/atm/echoes") {
        let cloud = Cloud::of(&message);
        for point in &cloud.points {
            let [x, y] = place(point);
            assert_eq!(point["z"], 0.0);
            rows.push(row(&[
                stamp::text(cloud.t + point["t"] as i64),
                names[&(point["sensor"] as u16)].clone(),
                text(x),
                text(y),
                kinds[point["kind"] as usize].to_owned(),
                text(point["range"]),
                text(point["azimuth"]),
                text(point["crossings"]),
                text(point["resolution"]),
                text(point["significance"]),
            ]));
        }
    }
    rows
}

fn crossing_rows(file: &[u8]) -> Vec<String> {
    let names = sensor_names(file);
    let mut rows = Vec::new();
    for message in of_topic(file, "/atm/crossings/points") {
        let cloud = Cloud::of(&message);
        for point in &cloud.points {
            let [x, y] = place(point);
            rows.push(row(&[
                stamp::text(cloud.t + point["t"] as i64),
                names[&(point["sensor"] as u16)].clone(),
                stamp::text(cloud.t + point["t_other"] as i64),
                names[&(point["sensor_other"] as u16)].clone(),
                text(x),
                text(y),
                text(point["azimuth"]),
                text(point["angle"]),
            ]));
        }
    }
    rows
}

#[test]
fn echoes_and_crossings_are_those_of_the_tables_to_the_last_bit() {
    let [echoes, crossings] = tables(&doorway());
    assert_eq!(echoes.len(), 621);
    for kind in KINDS {
        let file = recorded(&doorway(), options(kind));
        assert_same_rows(&echo_rows(&file), &echoes);
        assert_same_rows(&crossing_rows(&file), &crossings);
    }
}

#[test]
fn crossings_alone_are_those_of_the_table_too() {
    let [_, crossings] = tables(&doorway());
    for kind in KINDS {
        let file = recorded(&doorway(), Options { contents: Contents::Crossings, ..options(kind) });
        let topics: BTreeSet<String> = messages(&file).into_iter().map(|message| message.topic).collect();
        assert_eq!(Vec::from_iter(topics), ["/atm/crossings", "/atm/crossings/points"]);
        assert_same_rows(&crossing_rows(&file), &crossings);
    }
}

#[test]
fn times_that_seconds_in_floats_could_not_hold_come_back() {
    // 2026 with single nanoseconds, and every row a second later, so that one message at the end spans more than 2³² ns.
    let moved = |line: &str| {
        let (t, rest) = line.split_once(',').unwrap();
        let t = stamp::parse(t.as_bytes(), 9).unwrap() + 1_790_000_000_123_456_789;
        format!("{},{rest}\n", stamp::text(t))
    };
    let doorway = doorway();
    let mut lines = doorway.lines();
    let table = format!("{}\n{}", lines.next().unwrap(), lines.map(moved).collect::<String>());
    let [echoes, crossings] = tables(&table);
    assert!(echoes[0].starts_with("1790000000.123456789,"), "{}", echoes[0]);
    for kind in KINDS {
        let file = recorded(&table, options(kind));
        assert_same_rows(&echo_rows(&file), &echoes);
        assert_same_rows(&crossing_rows(&file), &crossings);
        let last = of_topic(&file, "/atm/echoes").iter().map(|message| message.log_time).filter(|t| *t > 0).max();
        let at_the_end = of_topic(&file, "/atm/echoes").iter().filter(|message| Some(message.log_time) == last).count();
        assert!(at_the_end > 1, "ten seconds of readings do not fit one message's offsets");
    }
}

#[test]
fn kinds_of_echoes_are_numbered_as_documented() {
    use atm::log::mcap::write::points::KINDS;
    assert_eq!(KINDS, ["median", "single", "center", "near", "pair", "point", "wall"]);
}

/// Each transform: stamp, parent, child, pose.
fn transforms(message: &Logged) -> Vec<(i64, String, String, [f64; 3])> {
    if message.schema == "foxglove.FrameTransforms" {
        let one = |one: Proto<'_>| (one.stamp(1), one.text(2).to_owned(), one.text(3).to_owned(), one.place(4, 5));
        return Proto::new(&message.data).messages(1).map(one).collect();
    }
    assert_eq!(message.schema, "tf2_msgs/msg/TFMessage");
    let mut list = Cdr::new(&message.data);
    let count = list.u32();
    let transforms = (0..count)
        .map(|_| {
            let (t, parent) = list.header();
            (t, parent.to_owned(), list.string().to_owned(), list.pose())
        })
        .collect();
    list.end();
    transforms
}

fn all_transforms(file: &[u8], topic: &str) -> Vec<(i64, String, String, [f64; 3])> {
    of_topic(file, topic).iter().flat_map(transforms).collect()
}

/// Time in nanoseconds and pose of each distinct row of the sample.
fn sample_poses() -> Vec<(i64, [f64; 3])> {
    let mut poses: Vec<(i64, [f64; 3])> = Vec::new();
    for line in doorway().lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let t = (cells[0].parse::<f64>().unwrap() * 1e9).round() as i64;
        let pose = [3, 4, 5].map(|cell: usize| cells[cell].parse().unwrap());
        if poses.last().is_none_or(|(last, _)| *last != t) {
            poses.push((t, pose));
        }
    }
    poses
}

fn assert_near(found: [f64; 3], expected: [f64; 3]) {
    for (found, expected) in found.into_iter().zip(expected) {
        assert!((found - expected).abs() < 1e-12, "{found} is not {expected}");
    }
}

#[test]
fn transforms_say_where_the_robot_and_its_sensors_were() {
    for kind in KINDS {
        let file = recorded(&doorway(), options(kind));
        let mounts = all_transforms(&file, "/tf_static");
        assert_eq!(mounts.len(), 16);
        for (index, (t, parent, child, pose)) in mounts.into_iter().enumerate() {
            assert_eq!((t, parent.as_str(), child), (0, "base_link", index.to_string()));
            let direction = index as f64 * PI / 8.0;
            let wrapped = if direction > PI { direction - 2.0 * PI } else { direction };
            assert_near(pose, [0.2286 * direction.cos(), 0.2286 * direction.sin(), wrapped]);
        }
        let robot = all_transforms(&file, "/tf");
        assert_eq!(robot.len(), sample_poses().len());
        for ((t, parent, child, pose), (expected_t, expected)) in robot.into_iter().zip(sample_poses()) {
            assert_eq!((t, parent.as_str(), child.as_str()), (expected_t, "odom", "base_link"));
            assert_near(pose, expected);
        }
    }
}

#[test]
fn sensors_that_nobody_mounted_follow_from_their_readings() {
    for kind in KINDS {
        let file = recorded(&doorway(), Options { frames: Frames::default(), ..options(kind) });
        assert!(of_topic(&file, "/tf_static").is_empty());
        let all = all_transforms(&file, "/tf");
        let mut parents: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
        for (_, parent, child, pose) in &all {
            parents.entry(child).or_default().insert(parent);
            if let Ok(index) = child.parse::<u8>() {
                let direction = f64::from(index) * PI / 8.0;
                let (dx, dy) = (pose[0] - 0.2286 * direction.cos(), pose[1] - 0.2286 * direction.sin());
                assert!(dx.hypot(dy) < 1e-12, "{child}");
            }
        }
        assert_eq!(parents.len(), 17);
        assert!(parents.values().all(|parents| parents.len() == 1), "{parents:?}");
    }
}

#[test]
fn transforms_that_another_recording_has_are_not_repeated() {
    for kind in KINDS {
        let topics = |transforms| {
            let file = {
                let options = options(kind);
                recorded(&doorway(), Options { frames: Frames { transforms, ..options.frames.clone() }, ..options })
            };
            let topics = messages(&file).into_iter().map(|message| message.topic);
            Vec::from_iter(topics.filter(|topic| topic.starts_with("/tf")).collect::<BTreeSet<_>>())
        };
        assert_eq!(topics(Transforms::All), ["/tf", "/tf_static"]);
        assert_eq!(topics(Transforms::Robot), ["/tf"]);
        assert_eq!(topics(Transforms::None), [""; 0]);
    }
}

/// The points of the drawings of one message: a name for each, and its points; none where it is wiped away.
fn drawings(message: &Logged) -> Vec<(String, Vec<[f64; 2]>)> {
    if message.schema == "foxglove.SceneUpdate" {
        let scene = Proto::new(&message.data);
        let wiped = scene.messages(1).map(|one| (one.text(3).to_owned(), Vec::new()));
        let drawn = scene.messages(2).map(|one| {
            assert_eq!(one.text(2), "odom");
            let line = one.message(11);
            (one.text(3).to_owned(), line.messages(5).map(|point| [point.double(1), point.double(2)]).collect())
        });
        return wiped.chain(drawn).collect();
    }
    assert_eq!(message.schema, "visualization_msgs/msg/MarkerArray");
    let mut list = Cdr::new(&message.data);
    let count = list.u32();
    let markers = (0..count).map(|_| marker(&mut list)).collect();
    list.end();
    markers
}

fn marker(list: &mut Cdr<'_>) -> (String, Vec<[f64; 2]>) {
    assert_eq!(list.header().1, "odom");
    let name = format!("{}/{}", list.string(), list.i32());
    let (kind, action) = (list.i32(), list.i32());
    assert!([4, 7].contains(&kind) && [0, 2].contains(&action));
    list.pose();
    assert!((0..3).all(|_| list.f64() > 0.0), "a size");
    assert!((0..4).map(|_| list.f32()).all(|part| (0.0..=1.0).contains(&part)), "a colour");
    assert_eq!((list.i32(), list.u32(), list.u8()), (0, 0, 0), "for ever, and not locked");
    let count = list.u32();
    let points: Vec<[f64; 2]> = (0..count)
        .map(|_| {
            let [x, y, _] = [list.f64(), list.f64(), list.f64()];
            [x, y]
        })
        .collect();
    assert_eq!((list.u32(), list.string()), (0, ""), "no colours, no texture");
    list.header();
    assert_eq!((list.string(), list.bytes().len(), list.u32()), ("", 0, 0));
    assert_eq!((list.string(), list.string(), list.string()), ("", "", ""));
    assert_eq!((list.bytes().len(), list.u8()), (0, 0));
    assert_eq!(points.is_empty(), action == 2);
    (name, points)
}

#[test]
fn arcs_are_drawn_at_their_range_and_within_the_beam() {
    let readings: Vec<Vec<f64>> =
        doorway().lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    for kind in KINDS {
        let file = recorded(&doorway(), options(kind));
        let all: Vec<_> = of_topic(&file, "/atm/arcs").iter().map(drawings).collect();
        assert_eq!(all.iter().flatten().count(), readings.len());
        let drawn: BTreeMap<(usize, &str), &Vec<[f64; 2]>> = (0..)
            .zip(&all)
            .flat_map(|(sweep, all)| {
                all.iter().map(move |(name, points)| ((sweep, name.split('/').next().unwrap()), points))
            })
            .collect();
        for (index, reading) in readings.iter().enumerate() {
            let [_, sensor, range, x, y, yaw] = reading[..] else { panic!() };
            let points = drawn[&(index / 16, sensor.to_string().as_str())];
            let direction = yaw + sensor * PI / 8.0;
            let (x, y) = (x + 0.2286 * direction.cos(), y + 0.2286 * direction.sin());
            assert_eq!(points.is_empty(), !(0.1524..6.477).contains(&range));
            for (step, point) in points.iter().enumerate() {
                let (dx, dy) = (point[0] - x, point[1] - y);
                assert!((dx.hypot(dy) - range).abs() < 1e-9);
                let azimuth = (dy.atan2(dx) - direction + 3.0 * PI).rem_euclid(2.0 * PI) - PI;
                let expected = PI / 8.0 * (step as f64 / (points.len() - 1) as f64 - 0.5);
                assert!((azimuth - expected).abs() < 1e-9, "{azimuth} is not {expected}");
            }
        }
        // A name is used again after ten readings of its sensor: the local map is what is to be seen.
        let names: BTreeSet<String> = all.iter().flatten().map(|(name, _)| name.clone()).collect();
        assert_eq!(names.len(), 160);
        assert!(names.contains("15/9") && names.contains("0/0"));
    }
}

#[test]
fn viewers_that_draw_points_alone_see_arcs_crossings_and_path() {
    for kind in KINDS {
        let file = recorded(&doorway(), options(kind));
        let count = |topic| of_topic(&file, topic).iter().map(|message| Cloud::of(message).points.len()).sum::<usize>();
        let drawn =
            |topic| of_topic(&file, topic).iter().flat_map(drawings).map(|(_, points)| points.len()).sum::<usize>();
        assert_eq!(count("/atm/arcs/points"), drawn("/atm/arcs"));
        // A mark is one sphere, or a cross of four ends.
        let ends = if kind == SchemaKind::Foxglove { 4 } else { 1 };
        assert_eq!(count("/atm/crossings/points") * ends, drawn("/atm/crossings"));
        // The last ones hold everything.
        let last = |topic| Cloud::of(of_topic(&file, topic).last().expect("there is one")).points;
        assert_eq!(last("/atm/map").len(), 621);
        let (path, end) = (last("/atm/path/points"), sample_poses().last().unwrap().1);
        assert!((path.last().unwrap()["x"] - end[0]).abs() < 1e-6, "single precision");
        assert!(path.len() > 10);
    }
}

#[test]
fn the_frames_are_those_asked_for() {
    let table: String = doorway().lines().take(300).map(|line| format!("{line}\n")).collect();
    for kind in KINDS {
        let mut sink = sink(options(kind));
        // As late as can be: a log may say itself what its frames are.
        let frames = Frames { fixed: "map".to_owned(), robot: "5".to_owned(), ..options(kind).frames };
        sink.set_frames(frames);
        fuse(&table, Emit::Settled, &mut sink).unwrap();
        let file = sink.finish().unwrap();
        for message in messages(&file).iter().filter(|message| message.schema.contains("PointCloud")) {
            assert_eq!(Cloud::of(message).frame, "map");
        }
        // A sensor that is called as the robot's frame does not become its own parent.
        let mounts = all_transforms(&file, "/tf_static");
        assert!(mounts.iter().all(|(_, parent, child, _)| parent == "5" && child != "5"));
        assert!(mounts.iter().any(|(_, _, child, _)| child == "sensor/5"));
    }
}

#[test]
fn stamps_beyond_what_ros_holds_are_the_nearest_that_it_does() {
    // The year 2100, in the second row's place of the sample.
    let table = "t,sensor,range,x,y,yaw\n4102444800,0,1.0,0,0,0\n4102444801,0,1.0,0,0,0\n";
    let stamps = |kind| {
        let file = recorded(table, options(kind));
        all_transforms(&file, "/tf").into_iter().map(|(t, ..)| t).collect::<Vec<_>>()
    };
    assert_eq!(stamps(SchemaKind::Foxglove), [4_102_444_800_000_000_000, 4_102_444_801_000_000_000]);
    assert_eq!(stamps(SchemaKind::Ros2), [2_147_483_647_999_999_999; 2]);
    // Before 1970 the log times have nothing left to say, and the stamps do.
    let table = "t,sensor,range,x,y,yaw\n-1.5,0,1.0,0,0,0\n";
    for kind in KINDS {
        let file = recorded(table, options(kind));
        assert_eq!(all_transforms(&file, "/tf")[0].0, -1_500_000_000);
        assert!(messages(&file).iter().all(|message| message.log_time == 0));
    }
}

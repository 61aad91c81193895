use std::{fs, io};

use super::*;

/// Half a picometre: what the rounding of a sine may amount to on a robot.
const ROUNDING: f64 = 5e-13;

fn said<T>(result: Result<T>) -> String {
    result.err().map(|error| error.to_string()).unwrap_or_default()
}

fn assert_at(sensor: &Sensor, x: f64, y: f64, yaw_deg: f64) {
    let (position, boresight) = (sensor.mount().translation, sensor.mount().rotation);
    let yaw = yaw_deg * PI / 180.0;
    let distance = (position.x - x).abs() + (position.y - y).abs();
    let turn = (boresight.re - yaw.cos()).abs() + (boresight.im - yaw.sin()).abs();
    assert!(distance < ROUNDING && turn < ROUNDING, "sensor {}: {}", sensor.id(), sensor.mount());
}

#[test]
fn every_built_in_rig_is_there_under_its_own_name() {
    for name in Rig::BUILTIN {
        assert_eq!(Rig::builtin(name).unwrap().name(), name);
        assert_eq!(Rig::load(name).unwrap().name(), name);
    }
    assert!(Rig::builtin("nomad").is_none());
}

#[test]
fn nomad200_is_a_ring_of_sixteen_in_inches() {
    let rig = Rig::builtin("nomad200").unwrap();
    assert_eq!(rig.sensors().len(), 16);
    for (i, sensor) in rig.sensors().iter().enumerate() {
        assert_eq!(sensor.id(), i.to_string());
        assert_eq!(sensor.field_of_view(), Some(22.5 * (PI / 180.0)));
        assert_eq!(sensor.min_range(), 0.1524);
        assert_eq!(sensor.max_range(), 6.477);
        assert_eq!(sensor.range_resolution(), Some(0.0254));
    }
    assert_at(&rig.sensors()[0], 0.2286, 0.0, 0.0);
    assert_at(&rig.sensors()[4], 0.0, 0.2286, 90.0);
    assert_at(&rig.sensors()[8], -0.2286, 0.0, 180.0);
    assert_at(&rig.sensors()[14], 0.161_644_610_179_244_75, -0.161_644_610_179_244_75, -45.0);
    assert_eq!(rig.log(), None);
}

#[test]
fn robond8_sits_at_the_centre_and_looks_right_first() {
    let rig = Rig::builtin("robond8").unwrap();
    let yaws = [-90.0, -37.5, -22.5, -7.5, 7.5, 22.5, 37.5, 90.0];
    assert_eq!(rig.sensors().len(), yaws.len());
    for (i, (sensor, yaw)) in rig.sensors().iter().zip(yaws).enumerate() {
        assert_eq!(sensor.id(), i.to_string());
        assert_at(sensor, 0.0, 0.0, yaw);
        assert_eq!(sensor.field_of_view(), Some(20.0 * (PI / 180.0)));
        assert_eq!((sensor.min_range(), sensor.max_range()), (0.17, 5.0));
        assert_eq!(sensor.range_resolution(), Some(0.01));
    }
}

#[test]
fn robond8_reads_its_recording() {
    let rig = Rig::builtin("robond8").unwrap();
    let log = rig.log().unwrap();
    // First line of measurement.txt: 1686487 5110 5110 2320 …
    assert_eq!(log.readings.columns.as_deref().unwrap(), ["t", "0", "1", "2", "3", "4", "5", "6", "7"]);
    assert_eq!(log.readings.range.apply(2320.0), 2.32);
    assert_eq!(log.readings.no_echo, [5110.0]);
    assert_eq!(log.poses.columns.as_deref().unwrap(), ["t", "x", "y", "yaw"]);
    assert_eq!(log.poses.pose.apply(-9400.0), -9.4);
    assert_eq!(log.poses.yaw.apply(900.0), PI / 2.0);
    for table in [&log.readings, &log.poses] {
        assert_eq!((table.header, table.delimiter, table.time_shift), (false, Some(b' '), 6));
    }
}

#[test]
fn a_ring_goes_counter_clockwise_from_its_first_yaw() {
    let rig = Rig::ring(4, 0.5, PI / 2.0, Ranging::default()).unwrap();
    assert_at(&rig.sensors()[0], 0.0, 0.5, 90.0);
    assert_at(&rig.sensors()[1], -0.5, 0.0, 180.0);
    assert_at(&rig.sensors()[2], 0.0, -0.5, 270.0);
    assert_at(&rig.sensors()[3], 0.5, 0.0, 0.0);
    assert_eq!(rig.name(), "ring");
}

#[test]
fn a_ring_in_code_has_the_bits_of_the_same_ring_in_a_file() {
    let ranging = Ranging {
        field_of_view: Some(22.5 * (PI / 180.0)),
        min_range: 0.1524,
        max_range: 6.477,
        range_resolution: Some(0.0254),
    };
    let ring = Rig::ring(16, 0.2286, 0.0, ranging).unwrap();
    assert_eq!(ring.sensors(), Rig::builtin("nomad200").unwrap().sensors());
}

#[test]
fn a_ring_out_of_its_domain_is_refused() {
    let ring = |count, radius, first_yaw| Rig::ring(count, radius, first_yaw, Ranging::default());
    assert_eq!(said(ring(0, 0.2, 0.0)), "ring: count must be 1 to 65535");
    assert_eq!(said(ring(65_536, 0.2, 0.0)), "ring: count must be 1 to 65535");
    assert!(ring(65_535, 0.0, 0.0).is_ok());
    for radius in [-0.1, f64::NAN, f64::INFINITY] {
        assert_eq!(said(ring(1, radius, 0.0)), "ring: radius must be finite and not negative");
    }
    assert_eq!(said(ring(1, 0.1, f64::NAN)), "ring: first_yaw must be finite");
}

#[test]
fn ranging_out_of_its_domain_is_refused() {
    let refused = |ranging| said(Sensor::new("a", Isometry2::identity(), ranging));
    let default = Ranging::default();
    for angle in [0.0, -0.1, PI + 1e-9, f64::NAN, f64::INFINITY] {
        let ranging = Ranging { field_of_view: Some(angle), ..default };
        assert_eq!(refused(ranging), "sensor `a`: field_of_view must be above 0deg and at most 180deg");
    }
    assert_eq!(refused(Ranging { field_of_view: Some(PI), ..default }), "");
    for min_range in [-1e-9, f64::NAN, f64::INFINITY] {
        assert_ne!(refused(Ranging { min_range, ..default }), "");
    }
    for max_range in [0.0, -1.0, f64::NAN, f64::NEG_INFINITY] {
        assert_eq!(refused(Ranging { max_range, ..default }), "sensor `a`: max_range must be above zero");
    }
    let equal = Ranging { min_range: 2.0, max_range: 2.0, ..default };
    assert_eq!(refused(equal), "sensor `a`: min_range must be less than max_range");
    for step in [0.0, -0.01, f64::NAN, f64::INFINITY] {
        assert_ne!(refused(Ranging { range_resolution: Some(step), ..default }), "");
    }
}

#[test]
fn a_sensor_without_id_or_with_an_infinite_mount_is_refused() {
    assert_ne!(said(Sensor::new("", Isometry2::identity(), Ranging::default())), "");
    let mount = Isometry2::from_parts(Translation2::new(f64::INFINITY, 0.0), direction(0.0));
    assert_eq!(said(Sensor::new("a", mount, Ranging::default())), "sensor `a`: the mount must be finite");
    let mount = Isometry2::from_parts(Translation2::new(0.0, 0.0), direction(f64::NAN));
    assert_ne!(said(Sensor::new("a", mount, Ranging::default())), "");
}

#[test]
fn ids_give_indices_and_unknown_ones_none() {
    let rig = Rig::builtin("nomad200").unwrap();
    assert_eq!(rig.index_of("0"), Some(0));
    assert_eq!(rig.index_of("15"), Some(15));
    for id in ["16", "", "01", " 1", "-1"] {
        assert_eq!(rig.index_of(id), None, "{id:?}");
    }
    let largest = Rig::ring(MAX_SENSORS, 1.0, 0.0, Ranging::default()).unwrap();
    assert_eq!(largest.index_of("65534"), Some(65_534));
}

#[test]
fn rigs_without_sensors_or_with_two_of_one_id_are_refused() {
    let sensor = |id: &str| Sensor::new(id, Isometry2::identity(), Ranging::default()).unwrap();
    assert_eq!(said(Rig::new("none", vec![])), "none: 0 sensors: must be 1 to 65535");
    let twins = vec![sensor("a"), sensor("b"), sensor("a")];
    assert_eq!(said(Rig::new("twins", twins)), "twins: two sensors have the id `a`");
    let many = (0..=MAX_SENSORS).map(|i| sensor(&i.to_string())).collect();
    assert_ne!(said(Rig::new("many", many)), "");
}

#[test]
fn a_file_is_loaded_and_named_by_its_stem() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("my robot.toml");
    fs::write(&path, "[ring]\ncount = 3\nradius = 0.1\n").unwrap();
    let rig = Rig::load(path.to_str().unwrap()).unwrap();
    assert_eq!((rig.name(), rig.sensors().len()), ("my robot", 3));
}

#[test]
fn a_missing_file_lists_the_built_in_rigs() {
    let error = Rig::load("nomad2000").unwrap_err();
    let message = "nomad2000: no such rig file, and no built-in rig of this name (nomad200, robond8)";
    assert_eq!(error.to_string(), message);
    assert!(matches!(error, Error::Io { source, .. } if source.kind() == io::ErrorKind::NotFound));
}

#[test]
fn a_directory_is_no_rig_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_str().unwrap();
    assert_eq!(said(Rig::load(path)), format!("{path}: is a directory, not a rig file"));
}

#[test]
fn a_file_that_is_not_utf8_is_refused_with_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("latin1.toml");
    fs::write(&path, b"# one\nname = \"Gr\xf6\xdfe\"\n").unwrap();
    let file = path.to_str().unwrap();
    assert_eq!(said(Rig::load(file)), format!("{file}:2: not UTF-8 text (byte 16)"));
}

#[test]
fn a_file_above_the_limit_is_refused_and_one_at_it_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("large.toml");
    let mut text = b"[ring]\ncount = 1\nradius = 0\n#".to_vec();
    text.resize(MAX_FILE as usize, b' ');
    fs::write(&path, &text).unwrap();
    let file = path.to_str().unwrap();
    assert_eq!(said(Rig::load(file)), "");
    text.push(b' ');
    fs::write(&path, &text).unwrap();
    assert_eq!(said(Rig::load(file)), format!("{file}: larger than 16 MiB: no rig file"));
}

#[test]
fn an_endless_source_is_refused_without_reading_on() {
    if cfg!(unix) {
        assert_eq!(said(Rig::load("/dev/zero")), "/dev/zero: larger than 16 MiB: no rig file");
    }
}

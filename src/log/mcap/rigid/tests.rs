use std::f64::consts::{FRAC_PI_2, PI};

use super::*;

fn flat(x: f64, y: f64, yaw: f64) -> Rigid {
    Rigid::flat(x, y, yaw.cos(), yaw.sin())
}

fn pitched(pitch: f64) -> Rigid {
    Rigid::new([0.0; 3], [0.0, (pitch / 2.0).sin(), 0.0, (pitch / 2.0).cos()]).unwrap()
}

#[track_caller]
fn assert_pose(found: &Rigid, x: f64, y: f64, yaw: f64) {
    let Pose { x: at_x, y: at_y, yaw: heading } = found.on_plane();
    let turn = libm::remainder(heading - yaw, 2.0 * PI);
    assert!((at_x - x).abs() < 1e-14 && (at_y - y).abs() < 1e-14 && turn.abs() < 1e-15, "{found:?}");
}

#[test]
fn headings_of_a_whole_turn_come_back() {
    for step in -36..=36 {
        let yaw = f64::from(step) * PI / 18.0;
        assert_pose(&flat(1.0, 2.0, yaw), 1.0, 2.0, yaw);
    }
}

#[test]
fn one_in_the_other_and_back() {
    let (robot, mount) = (flat(3.0, 1.0, FRAC_PI_2), flat(0.5, 0.25, 0.3));
    assert_pose(&robot.of(&mount), 3.0 - 0.25, 1.0 + 0.5, FRAC_PI_2 + 0.3);
    assert_pose(&robot.inverse().of(&robot.of(&mount)), 0.5, 0.25, 0.3);
    let tilted = robot.of(&pitched(0.4));
    let [x, y, z] = tilted.of(&tilted.inverse()).forward();
    assert!((x - 1.0).abs() < 1e-15 && y.abs() < 1e-15 && z.abs() < 1e-15);
}

#[test]
fn a_pitch_turns_the_boresight_down() {
    let [x, y, z] = flat(0.0, 0.0, FRAC_PI_2).of(&pitched(0.2)).forward();
    assert!(x.abs() < 1e-15 && (y - 0.2_f64.cos()).abs() < 1e-15 && (z + 0.2_f64.sin()).abs() < 1e-15);
}

#[test]
fn between_two_headings_it_goes_evenly_the_shorter_way() {
    for (from, to, share, between) in [
        (0.1, 0.5, 0.25, 0.2),
        (3.0, -3.0, 0.5, PI),
        (1.0, 1.0, 0.3, 1.0),
        (0.0, 1e-9, 0.5, 5e-10),
        (-2.0, 1.0, 0.5, -0.5),
    ] {
        assert_pose(&flat(0.0, 4.0, from).towards(&flat(2.0, 0.0, to), share), 2.0 * share, 4.0 - 4.0 * share, between);
    }
    // The other sign of a quaternion is the same rotation.
    let other = Rigid::new([2.0, 0.0, 0.0], [0.0, 0.0, -(0.25_f64).sin(), -(0.25_f64).cos()]).unwrap();
    assert_pose(&flat(0.0, 0.0, 0.1).towards(&other, 0.25), 0.5, 0.0, 0.2);
}

#[test]
fn between_two_pitches_it_is_half_of_each() {
    let [x, _, z] = pitched(0.2).towards(&pitched(0.6), 0.5).forward();
    assert!((x - 0.4_f64.cos()).abs() < 1e-15 && (z + 0.4_f64.sin()).abs() < 1e-15);
}

#[test]
fn quaternions_of_any_length_but_none() {
    assert_pose(&Rigid::new([1.0, 2.0, 3.0], [0.0, 0.0, 3.0, 3.0]).unwrap(), 1.0, 2.0, FRAC_PI_2);
    for bad in [[0.0; 4], [f64::NAN, 0.0, 0.0, 1.0], [f64::INFINITY; 4], [f64::MAX; 4]] {
        assert!(Rigid::new([0.0; 3], bad).is_err());
    }
    assert!(Rigid::new([f64::NAN, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]).is_err());
}

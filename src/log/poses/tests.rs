use std::f64::consts::{FRAC_PI_2, PI};

use super::*;
use crate::log::tests::{input, message};

/// Time and pose of every usable record, and the problems as text.
fn read_all(text: &str, format: Option<&TableFormat>) -> (Vec<(i64, Pose)>, Vec<String>) {
    let mut log = PoseLog::new(input(text), format).unwrap();
    let (mut poses, mut problems) = (Vec::new(), Vec::new());
    while let Some(stamped) = log.next_pose(&mut |problem| problems.push(problem.to_string())).unwrap() {
        poses.push((stamped.t, stamped.pose));
    }
    (poses, problems)
}

/// The yaw a TUM quaternion stands for.
fn yaw(quaternion: &str) -> f64 {
    let (poses, problems) = read_all(&format!("0 0 0 0 {quaternion}\n"), None);
    assert_eq!(problems, [""; 0]);
    poses[0].1.yaw
}

#[test]
fn csv_with_a_header_is_read() {
    let (poses, problems) = read_all("yaw,t,x,y,more\n0.5,1.25,1,-2,z\n", None);
    assert_eq!((poses, problems), (vec![(1_250_000_000, Pose { x: 1.0, y: -2.0, yaw: 0.5 })], vec![]));
}

#[test]
fn eight_numbers_between_blanks_are_tum() {
    let text = "# timestamp tx ty tz qx qy qz qw\n1.5 1 -2 0.3 0 0 0 1\n2.5\t3 4 0.3 0 0 1 0\n";
    assert!(PoseLog::new(input(text), None).unwrap().is_tum());
    let (poses, problems) = read_all(text, None);
    assert_eq!(problems, [""; 0]);
    assert_eq!(poses[0], (1_500_000_000, Pose { x: 1.0, y: -2.0, yaw: 0.0 }));
    assert_eq!(poses[1], (2_500_000_000, Pose { x: 3.0, y: 4.0, yaw: PI }));
}

#[test]
fn a_quaternion_turns_into_its_yaw_whatever_its_norm_and_sign() {
    let half = 0.5f64.sqrt();
    for quaternion in ["0 0 1 1", "0 0 -1 -1", "0 0 7 7", "0 0 1e-100 1e-100", "0.1e1 1 1 1"] {
        assert!((yaw(quaternion) - FRAC_PI_2).abs() < 1e-15, "{quaternion}");
    }
    assert!((yaw(&format!("0 0 -{half} {half}")) + FRAC_PI_2).abs() < 1e-15);
    // Pitch of 60 degrees after a yaw of 30: (cos 15°, 0, 0, sin 15°) (cos 30°, 0, sin 30°, 0).
    assert!(
        (yaw("-0.12940952255126037 0.4829629131445341 0.22414386804201339 0.8365163037378079") - PI / 6.0).abs()
            < 1e-12
    );
}

#[test]
fn a_quaternion_without_direction_is_a_bad_pose() {
    let (poses, problems) = read_all(
        "1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 0\n3 0 0 0 0 0 nan 1\n4 0 0 0 1e300 0 0 1\n5 x 0 0 0 0 0 1\n6 0 0 0 0\n",
        None,
    );
    assert_eq!(poses.len(), 1);
    assert_eq!(
        problems,
        [
            "log.csv:2: bad_pose: quaternion \"0\" \"0\" \"0\" \"0\" has no direction",
            "log.csv:3: bad_pose: qz \"nan\"",
            "log.csv:4: bad_pose: quaternion \"1e300\" \"0\" \"0\" \"1\" has no direction",
            "log.csv:5: bad_number: x \"x\"",
            "log.csv:6: missing_field: 5 fields, 8 needed",
        ]
    );
}

#[test]
fn bad_poses_are_passed_over() {
    let (poses, problems) = read_all("t,x,y,yaw\n1,nan,0,0\n2,0,0,1\n3,0\nx,0,0,0\n", None);
    assert_eq!(poses, [(2_000_000_000, Pose { x: 0.0, y: 0.0, yaw: 1.0 })]);
    assert_eq!(
        problems,
        [
            "log.csv:2: bad_pose: x \"nan\"",
            "log.csv:4: missing_field: 2 fields, 4 needed",
            "log.csv:5: bad_number: t \"x\""
        ]
    );
}

#[test]
fn a_rigs_format_is_used_and_tum_is_still_recognised() {
    let format = TableFormat {
        header: false,
        delimiter: Some(b' '),
        columns: Some(["t", "x", "y", "yaw"].map(str::to_owned).to_vec()),
        time_shift: 6,
        pose: Scale::length("mm").unwrap(),
        yaw: Scale::angle("0.1deg").unwrap(),
        ..TableFormat::default()
    };
    let (poses, _) = read_all("1686487 500 -250 1800\n", Some(&format));
    assert_eq!(poses, [(1_686_487_000_000, Pose { x: 0.5, y: -0.25, yaw: PI })]);
    assert!(PoseLog::new(input("1.5 1 2 0 0 0 0 1\n"), Some(&format)).unwrap().is_tum());
    let columns = ["t", "x", "y", "yaw", "a", "b", "c", "d"].map(str::to_owned).to_vec();
    let eight = TableFormat { columns: Some(columns), ..format };
    assert!(!PoseLog::new(input("1.5 1 2 0 0 0 0 1\n"), Some(&eight)).unwrap().is_tum());
}

#[test]
fn what_is_neither_says_what_is_missing() {
    let refused = |text: &str| message(PoseLog::new(input(text), None));
    assert_eq!(
        refused("time,x,y,heading\n"),
        "log.csv:1: neither TUM (t x y z qx qy qz qw) nor CSV with t, x, y, yaw: no column t, yaw; the columns are: time, x, y, heading"
    );
    assert!(refused("1 2 3 4 5 6 7\n").contains("neither TUM"));
    assert!(refused("1 2 3 4 5 6 7 8 9\n").contains("neither TUM"));
    assert!(refused("").contains("is empty"));
}

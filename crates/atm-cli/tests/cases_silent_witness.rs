//! A sensor that hears nothing says nothing of what lies beyond its own maximum range.

mod support;

use support::{cases::case, *};

/// A pole that one sensor reads 17 times, and a second one, 3 m away, that reaches 2 m and hears nothing: whether that is written as
/// `inf` or as `nan` makes no difference.
#[test]
fn what_lies_beyond_a_sensors_reach_is_not_denied_by_its_silence() {
    let Some(rig) = case("silent_witness/rig.toml") else { return };
    let points = |log: &str| {
        let log = case(log).expect("beside the rig");
        let ran = atm(["fuse", &log, "--rig", &rig, "--estimator", "consensus", "--keep", "point", "-o", "-"]).exits(0);
        ran.text().lines().skip(1).count()
    };
    assert_eq!(points("silent_witness/inf.csv"), 17);
    assert_eq!(points("silent_witness/nan.csv"), 17);
}

//! Recordings as people have them: a robot along +x, three sonars of 40 degrees, one post at (1.5, 1.2). Each is fused right, or
//! what is wrong with it is said.

mod support;

use support::{cases::case, *};

const POST: [f64; 2] = [1.5, 1.2];
/// Ranges are 32 bits wide.
const SLACK: f64 = 1e-6;

/// Fuses a case as the table of cases does; `None` where the cases are missing.
#[track_caller]
fn fuse(name: &str, more: &[&str]) -> Option<Ran> {
    let log = case(&format!("recordings/{name}"))?;
    Some(atm(["fuse", &log, "--history", "60"].iter().chain(more)))
}

#[track_caller]
fn rig(name: &str) -> String {
    case(&format!("recordings/{name}")).unwrap_or_default()
}

/// Insists on so many medians and no other echo, all of them on the post.
#[track_caller]
fn all_on_the_post(ran: &Ran, medians: usize) {
    let echoes = ran.echoes();
    assert_eq!((count(&echoes, "median"), echoes.len()), (medians, medians), "{}", ran.stderr);
    for echo in &echoes {
        let error = (echo.x - POST[0]).hypot(echo.y - POST[1]);
        assert!(error < SLACK, "{} m beside the post at {}", error, echo.t);
    }
}

/// Insists that nothing was written, and that this was said.
#[track_caller]
fn refused(ran: Ran, words: &[&str]) {
    ran.exits(1).says(words).writes_nothing();
}

/// Insists that nothing is said but the counts.
#[track_caller]
fn is_silent(ran: &Ran) {
    for word in ["warning", "unusable", "problem"] {
        assert!(!ran.stderr.contains(word), "{}", ran.stderr);
    }
}

#[test]
fn base_is_right_and_nothing_is_said_of_it() {
    let Some(ran) = fuse("base.mcap", &[]) else { return };
    let ran = ran.exits(0);
    all_on_the_post(&ran, 84);
    is_silent(&ran);
    let info = atm(["info", &rig("base.mcap")]).exits(0);
    assert!(!String::from_utf8_lossy(&info.stdout).contains("warning"), "{info:?}");
}

#[test]
fn transforms_of_two_robots_are_kept_apart_by_their_namespace() {
    let Some(ran) = fuse("two_robots_ranges_of_one.mcap", &[]) else { return };
    // The last three are later than any transform.
    all_on_the_post(&ran.exits(3).says(&["3 no_pose"]), 84);
    // With a map of one reading nothing is crossed: the first echo is the middle of its arc.
    let centers = atm(["fuse", &rig("two_robots_ranges_of_one.mcap"), "--history", "1"]).echoes();
    let first = centers.first().expect("an echo");
    assert_near(first.x, 1.3706, 5e-5);
    assert_near(first.y, 1.3446, 5e-5);
    for flags in [["--pose-topic", "/robot1/tf"], ["--tf-topics", "/robot1/tf,/robot1/tf_static"]] {
        all_on_the_post(&fuse("two_robots_ranges_of_one.mcap", &flags).expect("the case").exits(3), 84);
    }
}

#[test]
fn of_two_robots_with_readings_the_first_is_fused_and_the_other_is_named_with_the_flag() {
    for name in ["two_robots_same_stamps.mcap", "two_robots_interleaved.mcap"] {
        let Some(ran) = fuse(name, &[]) else { return };
        let ran = ran.exits(3).says(&["300 other_robot", "/robot2", "--tf-topics /robot2/tf"]);
        assert!(ran.echoes().iter().all(|echo| (echo.x - POST[0]).hypot(echo.y - POST[1]) < SLACK));
        let other = "/robot2/sonar_left,/robot2/sonar_fl,/robot2/sonar_rl";
        let ran = fuse(name, &["--range-topics", other]).expect("the case");
        assert!(!ran.stderr.contains("other_robot"), "{}", ran.stderr);
        let echoes = ran.echoes();
        assert!(count(&echoes, "median") > 50, "{}", ran.stderr);
        assert!(echoes.iter().all(|echo| (echo.x - POST[0]).hypot(echo.y - POST[1]) < SLACK), "{}", ran.stderr);
        let chosen = fuse(name, &["--tf-topics", "/robot2/tf"]).expect("the case").exits(3);
        assert_eq!(chosen.stdout, ran.stdout, "{}", chosen.stderr);
    }
}

#[test]
fn a_robot_whose_frames_have_another_prefix_is_named_with_its_fixed_frame() {
    let Some(ran) = fuse("two_robots_prefixed.mcap", &[]) else { return };
    all_on_the_post(&ran.exits(3).says(&["300 other_robot", "--fixed-frame robot2/odom"]), 84);
    let other = fuse("two_robots_prefixed.mcap", &["--fixed-frame", "robot2/odom"]).expect("the case").exits(3);
    assert!(count(&other.echoes(), "median") > 50);
}

#[test]
fn two_publishers_of_one_transform_are_noticed() {
    let Some(ran) = fuse("two_publishers.mcap", &[]) else { return };
    refused(ran, &["impossible_motion", "--max-speed", "two sources publish them"]);
    let trusting = fuse("two_publishers.mcap", &["--max-speed", "1000m/s"]).expect("the case");
    refused(trusting, &["impossible_motion", "to and fro"]);
}

#[test]
fn a_mount_that_the_rig_leaves_open_comes_from_the_transforms() {
    let Some(ran) = fuse("base.mcap", &["--rig", &rig("rig_nomount.toml")]) else { return };
    all_on_the_post(&ran.exits(0), 84);
}

#[test]
fn the_rigs_unit_of_ranges_applies_and_so_does_the_flag() {
    let Some(ran) = fuse("centimetres.mcap", &["--rig", &rig("rig_cm.toml")]) else { return };
    all_on_the_post(&ran.exits(0), 84);
    all_on_the_post(&fuse("centimetres.mcap", &["--range-unit", "cm"]).expect("the case").exits(0), 84);
}

#[test]
fn the_rigs_values_without_echo_apply() {
    let Some(ran) = fuse("none_is_32766.mcap", &["--rig", &rig("rig_noecho.toml")]) else { return };
    all_on_the_post(&ran.exits(0), 84);
}

#[test]
fn a_rig_of_one_sensor_leaves_the_others_to_the_recording() {
    let Some(ran) = fuse("one_mount_missing.mcap", &["--rig", &rig("rig_rl.toml")]) else { return };
    all_on_the_post(&ran.exits(0), 84);
    let without = fuse("one_mount_missing.mcap", &[]).expect("the case");
    all_on_the_post(&without.exits(3).says(&["100 no_transform", "sonar_rl", "--rig"]), 55);
}

#[test]
fn a_rig_with_topics_tells_sensors_of_one_frame_apart() {
    let Some(ran) = fuse("all_in_base_link.mcap", &["--rig", &rig("rig_topic.toml")]) else { return };
    all_on_the_post(&ran.exits(0), 84);
    fuse("all_in_base_link.mcap", &[]).expect("the case").exits(3).says(&["200 shared_frame", "--rig", "topic ="]);
}

#[test]
fn stamps_of_another_clock_are_named_and_the_clock_of_the_recorder_is_right() {
    let Some(ran) = fuse("stamps_5s_late.mcap", &[]) else { return };
    ran.exits(3).says(&["/sonar_fl", "5.000 s behind those of its poses", "--clock log"]);
    all_on_the_post(&fuse("stamps_5s_late.mcap", &["--clock", "log"]).expect("the case").exits(0), 84);
    let ran = fuse("stamps_300s_ahead.mcap", &[]).expect("the case");
    refused(ran, &["300 s ahead of those of its poses", "--clock log"]);
    all_on_the_post(&fuse("stamps_300s_ahead.mcap", &["--clock", "log"]).expect("the case").exits(0), 84);
    let info = atm(["info", &rig("stamps_5s_late.mcap")]).exits(3);
    let text = String::from_utf8_lossy(&info.stdout).into_owned();
    assert!(text.contains("-5.000 s") && text.contains("--clock log"), "{text}");
}

#[test]
fn poses_once_a_second_do_where_the_robot_is_slow_and_that_is_said() {
    for name in ["tf_1Hz.mcap", "mount_1Hz_on_tf.mcap"] {
        let Some(ran) = fuse(name, &[]) else { return };
        let ran = ran.says(&["poses up to 1.000 s apart are used", "--max-gap"]);
        // Of one the last three are later than any transform.
        let (status, medians) = if name == "tf_1Hz.mcap" { (0, 84) } else { (3, 83) };
        all_on_the_post(&ran.exits(status), medians);
        all_on_the_post(&fuse(name, &["--max-gap", "1s"]).expect("the case").exits(status), medians);
        let strict = fuse(name, &["--max-gap", "0.5s"]).expect("the case");
        refused(strict, &["no_pose", "1.000 s apart", "--max-gap 1s"]);
    }
    fuse("tf_1Hz.mcap", &[]).expect("the case").says(&["moved 0.30 m"]);
}

#[test]
fn two_recordings_in_one_file_are_both_read() {
    let Some(ran) = fuse("concatenated.mcap", &[]) else { return };
    all_on_the_post(&ran.exits(0), 84);
}

#[test]
fn bytes_behind_the_end_are_counted() {
    let Some(ran) = fuse("trailing_bytes.mcap", &[]) else { return };
    all_on_the_post(&ran.exits(3).says(&["1 trailing_data", "5000 bytes", "byte 13094"]), 84);
}

#[test]
fn the_parts_of_a_split_recording_are_one() {
    let Some(second) = case("recordings/split_1.mcap") else { return };
    all_on_the_post(&fuse("split_0.mcap", &[&second]).expect("the case").exits(0), 84);
    refused(fuse("split_1.mcap", &[]).expect("the case"), &["150 are no_transform", "in no transform", "--rig"]);
}

#[test]
fn a_recording_of_which_nothing_can_be_used_leaves_no_file() {
    let Some(log) = case("recordings/fov_56.mcap") else { return };
    let scratch = Scratch::new();
    for name in ["echoes.csv", "echoes.mcap"] {
        let out = scratch.name(name);
        atm(["fuse", &log, "-o", &out]).exits(1).says(&["no reading can be used"]);
        assert_eq!(std::fs::read_dir(scratch.name("")).expect("the directory").count(), 0, "{name}");
    }
}

#[test]
fn a_beam_in_degrees_is_named_and_a_rig_cures_it() {
    let Some(ran) = fuse("fov_56.mcap", &[]) else { return };
    refused(ran, &["300 bad_limits", "56", "degrees?", "--rig", "field_of_view"]);
    all_on_the_post(&fuse("fov_56.mcap", &["--rig", &rig("rig_topic.toml")]).expect("the case").exits(0), 84);
    fuse("fov_3.mcap", &[]).expect("the case").exits(0).says(&["warning", "171.9deg", "degrees?", "field_of_view"]);
}

#[test]
fn limits_the_wrong_way_round_are_named_and_a_rig_cures_them() {
    let Some(ran) = fuse("limits_swapped.mcap", &[]) else { return };
    refused(ran, &["300 bad_limits", "min_range 20", "above", "max_range 0", "--rig"]);
    let scratch = Scratch::new();
    let text = std::fs::read_to_string(rig("rig_topic.toml")).expect("the rig");
    let limited = scratch.file("rig.toml", format!("min_range = \"0.02m\"\nmax_range = \"4m\"\n{text}"));
    all_on_the_post(&fuse("limits_swapped.mcap", &["--rig", &limited]).expect("the case").exits(0), 84);
}

#[test]
fn readings_that_are_all_without_echo_are_named_by_what_they_are() {
    let Some(ran) = fuse("always_minus_inf.mcap", &[]) else { return };
    ran.exits(0).says(&["warning", "100 of 100", "-Inf", "too close"]);
    let ran = fuse("centimetres_range_only.mcap", &[]).expect("the case").exits(0);
    ran.says(&["warning", "at or above max_range", "centimetres?", "range_unit"]);
    fuse("clamped.mcap", &[]).expect("the case").exits(0).says(&["warning", "min_range", "clamped"]);
}

#[test]
fn optical_frames_are_noticed_and_read_by_option() {
    let Some(ran) = fuse("optical_frames.mcap", &[]) else { return };
    ran.exits(0).says(&["_optical_frame", "--boresight z"]);
    all_on_the_post(&fuse("optical_frames.mcap", &["--boresight", "z"]).expect("the case").exits(0), 84);
}

#[test]
fn a_sonar_that_looks_down_is_named_with_the_way_out() {
    let Some(ran) = fuse("sonar_along_minus_z.mcap", &[]) else { return };
    refused(ran, &["100 tilted", "-90.0deg out of the plane", "--boresight", "--rig"]);
    fuse("sonar_along_minus_z.mcap", &["--boresight", "z"]).expect("the case").exits(0);
}

#[test]
fn messages_and_whole_files_in_zstd_are_unpacked() {
    for name in ["message_zstd.mcap", "whole_file.mcap.zstd"] {
        let Some(ran) = fuse(name, &[]) else { return };
        all_on_the_post(&ran.exits(0), 84);
        atm(["info", &rig(name)]).exits(0);
    }
}

#[test]
fn idl_of_the_omg_and_numbers_of_python_in_json_are_read() {
    for name in ["omgidl.mcap", "json_infinity.mcap"] {
        let Some(ran) = fuse(name, &[]) else { return };
        all_on_the_post(&ran.exits(0), 84);
    }
}

#[test]
fn arrays_of_readings_are_read() {
    let Some(ran) = fuse("range_array.mcap", &[]) else { return };
    all_on_the_post(&ran.exits(0), 84);
}

#[test]
fn scans_of_few_beams_are_read_on_request() {
    for (name, kind) in [("laser_scan_few_beams.mcap", "median"), ("four_beam_scan.mcap", "median")] {
        let Some(ran) = fuse(name, &[]) else { return };
        refused(ran, &["no topic has readings", "--scan-topics /scan"]);
        let ran = fuse(name, &["--scan-topics", "/scan"]).expect("the case").exits(0);
        assert!(!ran.echoes().is_empty(), "{kind} {}", ran.stderr);
    }
    refused(fuse("sonar_pointcloud.mcap", &[]).expect("the case"), &["no topic has readings", "/RosAria/sonar", "rig"]);
}

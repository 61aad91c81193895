//! Wrong arguments: exit 2, a message that names them, and nothing done.

mod support;

use support::*;

#[track_caller]
fn refused(flags: &[&str], words: &[&str]) {
    let scratch = Scratch::new();
    let out = scratch.name("echoes.csv");
    let ran = fuse_sample(&[&["-o", &out], flags].concat());
    assert_eq!(ran.status, 2, "{flags:?}: {}", ran.stderr);
    ran.says(words).writes_nothing();
    assert_eq!(scratch.list(), [""; 0], "{flags:?}");
}

#[test]
fn a_bare_angle_is_refused_and_the_message_says_why() {
    refused(&["--min-angle", "30"], &["--min-angle", "30", "unit", "deg"]);
    refused(&["--fov", "22.5"], &["--fov", "22.5", "unit", "deg"]);
    atm(["plan", "--distance", "1m", "--min-angle", "30"]).exits(2).says(&["unit", "deg"]);
}

#[test]
fn values_out_of_their_domain_are_refused() {
    for [flag, value] in [
        ["--min-angle", "0deg"],
        ["--min-angle", "0.99deg"],
        ["--min-angle", "90.01deg"],
        ["--min-angle", "nandeg"],
        ["--history", "0"],
        ["--history", "2.5"],
        ["--history", "99999999999999999999"],
        ["--fov", "200deg"],
        ["--fov", "0deg"],
        ["--range-resolution", "0in"],
        ["--range-resolution", "inf"],
        ["--max-age", "0s"],
        ["--max-travel", "0m"],
        ["--min-step", "0cm"],
        ["--max-gap", "1m"],
        ["--keep", "median,best"],
        ["--emit", "soon"],
        ["--on-none", "mean"],
        ["--on-two", "median"],
        ["--empty", "nan"],
        ["--from", "xml"],
    ] {
        refused(&[flag, value], &[flag]);
    }
    for flag in ["--range-resolution=-1in", "--max-age=-1s", "--max-gap=-1s", "--min-step=-1in", "--min-angle=-30deg"] {
        refused(&[flag], &[flag.split('=').next().expect("a flag")]);
    }
}

#[test]
fn flags_that_contradict_or_need_each_other_are_refused() {
    refused(&["--improvement", "10"], &["--at"]);
    refused(&["--at", "100in"], &["--improvement"]);
    refused(&["--improvement", "10", "--at", "100in", "--min-angle", "30deg"], &["--min-angle"]);
    // The whole arc holds 39 steps of the range at 100 in: more can't be gained.
    refused(&["--improvement", "40", "--at", "100in"], &["improvement"]);
    refused(&["--improvement", "0", "--at", "100in"], &["--improvement"]);
    refused(&["--no-such-flag"], &["--no-such-flag"]);
    fuse_text("", &["--poses", "-"]).exits(2).says(&["standard input"]).writes_nothing();
}

#[test]
fn no_rig_is_refused_with_the_choices() {
    let ran = atm(["fuse", SAMPLE]).exits(2).writes_nothing();
    ran.says(&["--rig", "nomad200", "robond8"]);
}

#[test]
fn an_unknown_rig_fails_with_the_choices() {
    let ran = atm(["fuse", SAMPLE, "--rig", "nomad2000"]).exits(1).writes_nothing();
    ran.says(&["nomad2000", "nomad200", "robond8"]);
}

#[test]
fn a_rig_file_that_is_wrong_is_named_with_line_and_value() {
    let scratch = Scratch::new();
    for (text, words) in [
        ("[ring]\ncount = 16\nradius = \"9\nfirst_yaw = \"0deg\"\n", &[":3"][..]),
        ("[ring]\ncount = 16\nradius = \"9in\"\nfirst_yaw = \"90\"\n", &[":4", "first_yaw", "90"]),
        ("[ring]\ncount = 16\nradius = \"9in\"\nspin = 3\n", &[":4", "spin"]),
        ("field_of_view = \"200deg\"\n[ring]\ncount = 16\nradius = \"9in\"\n", &[":1", "field_of_view"]),
        ("name = \"empty\"\n", &["sensor"]),
    ] {
        let rig = scratch.file("rig.toml", text);
        atm(["fuse", SAMPLE, "--rig", &rig]).exits(1).says(&[&rig]).says(words).writes_nothing();
    }
}

#[test]
fn no_command_and_no_input_are_refused() {
    atm([""; 0]).exits(2).writes_nothing();
    atm(["fuse"]).exits(2).writes_nothing();
    atm(["melt", SAMPLE]).exits(2).says(&["melt"]);
}

#[test]
fn help_and_version_go_to_standard_output() {
    assert!(atm(["--help"]).exits(0).text().contains("fuse"));
    assert!(atm(["--version"]).exits(0).text().starts_with("atm "));
    let help = atm(["fuse", "--help"]).exits(0);
    for flag in [
        "--rig",
        "--poses",
        "--max-gap",
        "--history",
        "--max-age",
        "--max-travel",
        "--min-step",
        "--empty",
        "--min-angle",
        "--improvement",
        "--at",
        "--range-resolution",
        "--fov",
        "--emit",
        "--on-none",
        "--on-two",
        "--keep",
        "--drop-held",
        "--crossings",
        "--strict",
        "--quiet",
        "--summary",
        "--from",
        "--to",
    ] {
        assert!(help.text().contains(flag), "{flag}");
    }
}

//! `atm eval` and `atm draw` of echoes in a recording: the same as of the table of the same run, in either kind of messages, and
//! what is said of recordings that hold none.
#![cfg(feature = "lab")]

mod support;

use std::fs;

use support::{
    recording::{CLOUD, CloudField, Layout, Recording, cloud, drive, stamp},
    *,
};

const SCHEMAS: [&str; 2] = ["foxglove", "ros2"];

/// A simulated drive, its truth, and its echoes and crossings as tables and as recordings of one kind.
struct Run {
    scratch: Scratch,
    log: String,
    truth: String,
    /// Echoes and crossings.
    tables: [String; 2],
    recordings: [String; 2],
}

fn run(schema: &str, estimator: &str) -> Run {
    let scratch = Scratch::new();
    let [log, truth] = ["drive.csv", "truth.csv"].map(|name| scratch.name(name));
    atm(["simulate", "doorway", "-o", &log, "--truth", &truth, "--seed", "3"]).exits(0);
    let fuse = |extension: &str| {
        let files = ["echoes", "crossings"].map(|name| scratch.name(&format!("{name}.{extension}")));
        let [echoes, crossings] = &files;
        let outputs = ["-o", echoes, "--schema", schema, "--estimator", estimator, "-q"];
        let crossings = ["--crossings", crossings];
        let crossings = if estimator == "atm" { &crossings[..] } else { &[] };
        atm(["fuse", &log, "--rig", "nomad200"].iter().chain(&outputs).chain(crossings)).exits(0);
        files
    };
    let (tables, recordings) = (fuse("csv"), fuse("mcap"));
    Run { scratch, log, truth, tables, recordings }
}

#[track_caller]
fn drawn(args: &[&str]) -> String {
    atm(["draw", "-o", "-"].iter().chain(args)).exits(0).text().to_owned()
}

#[test]
fn scores_are_those_of_the_table() {
    for schema in SCHEMAS {
        let Run { log, truth, tables: [table, _], recordings: [recording, _], .. } = &run(schema, "atm");
        let more: [&[&str]; 3] = [
            &["--json"],
            &["--json", "--truth", truth, "--log", log, "--rig", "nomad200"],
            &["--truth", truth, "--set", "opening=30in"],
        ];
        for more in more {
            let eval = |echoes: &str| atm(["eval", echoes, "--world", "doorway"].iter().chain(more)).exits(0);
            eval(recording).writes(eval(table).stdout);
        }
        let bytes = fs::read(recording).expect("it was written");
        let args = ["eval", "-", "--world", "doorway", "--truth", truth, "--json"];
        let scores = atm_fed(args, bytes).exits(0).json();
        // That both are the same says nothing if there is nothing.
        assert!(scores["azimuth_error_m"]["count"].as_u64() > Some(300), "{scores}");
        assert!(scores["by_kind"]["median"]["points"].as_u64() > Some(50), "{scores}");
    }
}

#[test]
fn pictures_are_those_of_the_tables() {
    for schema in SCHEMAS {
        let Run { log, tables, recordings, scratch, .. } = &run(schema, "atm");
        let picture = |[echoes, crossings]: &[String; 2]| {
            let world = ["--world", "doorway", "--rig", "nomad200"];
            [
                drawn(&[echoes]),
                drawn(&[crossings]),
                drawn(&[&world[..], &[echoes, crossings, log, "--reading", "20,3"]].concat()),
            ]
        };
        let [alone, crossings, with_all] = picture(recordings);
        assert!([&alone, &crossings, &with_all] == picture(tables).each_ref(), "{schema}");
        assert!(alone.contains("class=\"median\"") && crossings.contains("class=\"crossings\""));
        assert!(with_all.contains("class=\"partners\"") && with_all.contains("class=\"ring\""));
        // Down a pipe, and as pixels.
        let bytes = fs::read(&recordings[0]).expect("it was written");
        atm_fed(["draw", "-", "-o", "-"], bytes).exits(0).writes(alone);
        let [of_recording, of_table] = [(&recordings[0], "a.png"), (&tables[0], "b.png")].map(|(echoes, name)| {
            let name = scratch.name(name);
            atm(["draw", echoes, "-o", &name]).exits(0);
            fs::read(name).expect("a picture")
        });
        assert!(of_recording == of_table);
    }
}

#[test]
fn what_the_consensus_says_besides_changes_neither_scores_nor_pictures() {
    for schema in SCHEMAS {
        let Run { log, truth, tables: [table, _], recordings: [recording, _], .. } = &run(schema, "consensus");
        let eval = |echoes: &str| {
            let args =
                ["eval", echoes, "--world", "doorway", "--truth", truth, "--log", log, "--rig", "nomad200", "--json"];
            atm(args).exits(0)
        };
        let of_table = eval(table);
        assert!(of_table.json()["by_kind"]["wall"]["points"].as_u64() > Some(20), "the case is empty");
        eval(recording).writes(of_table.stdout);
        let picture = drawn(&[recording, "--world", "doorway"]);
        assert!(picture == drawn(&[table, "--world", "doorway"]));
        assert!(picture.contains("class=\"point\"") && picture.contains("class=\"wall\""));
    }
}

#[test]
fn live_recordings_without_chunks_are_read_as_well() {
    for schema in SCHEMAS {
        let latest =
            |to: &str| fuse_text(sample(), &["--emit", "latest", "--to", to, "--schema", schema]).exits(0).stdout;
        let eval = |echoes: Vec<u8>| atm_fed(["eval", "-", "--world", "doorway"], echoes).exits(0).stdout;
        assert_same(&eval(latest("mcap")), &eval(latest("csv")));
    }
}

#[test]
fn of_a_recording_with_both_the_echoes_are_drawn_and_the_readings_where_they_are_asked_for() {
    let scratch = Scratch::new();
    let (log, both, alone) =
        (scratch.file("drive.mcap", drive().bytes()), scratch.name("both.mcap"), scratch.name("a.csv"));
    atm(["fuse", &log, "-o", &both, "--passthrough", "-q"]).exits(0);
    atm(["fuse", &log, "-o", &alone, "-q"]).exits(0);
    assert!(drawn(&[&both]) == drawn(&[&alone]));
    let readings = ["--range-topics", "/sonar/0,/sonar/5"];
    assert!(drawn(&[&[both.as_str()], &readings[..]].concat()) == drawn(&[&[log.as_str()], &readings[..]].concat()));
    // Only what has readings is drawn as such.
    let echoes = scratch.name("echoes.mcap");
    atm(["fuse", &log, "-o", &echoes, "-q"]).exits(0);
    assert!(drawn(&[&[echoes.as_str()], &readings[..]].concat()) == drawn(&[&alone]));
    let eval = |echoes: &str| atm(["eval", echoes, "--world", "doorway"]).exits(0).stdout;
    assert_same(&eval(&both), &eval(&alone));
}

/// An echo's fields, as ROS 2 has them, with one more and a kind that is not among the usual.
const FIELDS: [CloudField<'static>; 10] = [
    ("x", 7, &[1.0, 2.0]),
    ("y", 7, &[0.5, 0.5]),
    ("exact_x", 8, &[1.0, 2.0]),
    ("support", 8, &[0.5, 0.5]),
    ("exact_y", 8, &[1.778, 1.778]),
    ("range", 8, &[2.0, 2.0]),
    ("azimuth", 8, &[0.0, 0.1]),
    ("t", 6, &[0.0, 5.0]),
    ("sensor", 4, &[0.0, 7.0]),
    ("kind", 2, &[0.0, 1.0]),
];

/// A recording with one cloud of echoes, of which sensors 0 and 7 are known.
fn recording(topic: &str, schema: &str, message: Vec<u8>) -> Vec<u8> {
    let mut recording = Recording::default();
    recording.metadata.push(("atm.sensors".into(), [("0".into(), "a".into()), ("7".into(), "b".into())].into()));
    recording.push(topic, schema, stamp(3.0), message);
    recording.laid_out(Layout::Bare)
}

/// Two echoes, one of whose fields is another.
fn echoes(field: CloudField<'_>) -> Vec<u8> {
    let fields = FIELDS.map(|known| if known.0 == field.0 { field } else { known });
    recording("/atm/echoes", CLOUD, cloud(stamp(3.0), &fields))
}

fn eval(bytes: &[u8]) -> Ran {
    atm_fed(["eval", "-", "--world", "doorway", "--json"], bytes)
}

#[test]
fn fields_are_found_by_name_and_others_are_ignored() {
    let scores = eval(&echoes(FIELDS[0])).exits(0).json();
    assert_eq!((scores["points"].as_u64(), scores["surface_error_m"]["p95"].as_f64()), (Some(2), Some(0.0)));
    assert_eq!(scores["by_kind"].as_object().expect("kinds").keys().collect::<Vec<_>>(), ["median", "single"]);
    // Without exact ones, the place is that of `x` and `y`.
    let coarse: Vec<CloudField<'_>> = FIELDS.into_iter().filter(|(name, ..)| !name.starts_with("exact")).collect();
    let scores = eval(&recording("/atm/echoes", CLOUD, cloud(stamp(3.0), &coarse))).exits(0).json();
    assert_near(scores["surface_error_m"]["p50"].as_f64().expect("an error"), 1.278, 1e-12);
}

#[test]
fn points_that_can_not_be_used_are_named_and_the_rest_is_scored() {
    let cases: [(CloudField<'_>, &str); 7] = [
        (("exact_x", 8, &[1.0, f64::NAN]), "/atm/echoes at 4003: x NaN in point 2"),
        (("exact_y", 8, &[f64::INFINITY, 1.778]), "/atm/echoes at 4003: y inf in point 1"),
        (("range", 8, &[2.0, f64::NEG_INFINITY]), "/atm/echoes at 4003: range -inf in point 2"),
        (("azimuth", 7, &[f64::NAN, 0.0]), "/atm/echoes at 4003: azimuth NaN in point 1"),
        (("kind", 2, &[0.0, 99.0]), "/atm/echoes at 4003: kind 99 in point 2"),
        (("sensor", 4, &[5.0, 7.0]), "/atm/echoes at 4003: sensor 5 has no id in the metadata atm.sensors"),
        (("sensor", 6, &[0.0, 65543.0]), "/atm/echoes at 4003: sensor 65543 has no id"),
    ];
    for (field, words) in cases {
        let reason = if field.0 == "sensor" { "1 unknown_sensor, " } else { "1 bad_number, " };
        let ran = eval(&echoes(field)).exits(3).says(&[reason, "standard input, byte ", words]);
        assert_eq!(ran.json()["points"], 1, "{words}");
        let drawn = atm_fed(["draw", "-", "-o", "-"], echoes(field)).exits(3).says(&[words]);
        assert!(drawn.text().starts_with("<svg"));
    }
}

#[test]
fn recordings_without_echoes_are_refused_with_what_they_have() {
    let scratch = Scratch::new();
    let refused = |bytes: &[u8], words: &[&str]| {
        eval(bytes).exits(1).says(&["standard input, byte "]).says(words).writes_nothing();
        let file = scratch.file("echoes.mcap", bytes);
        atm(["eval", &file, "--world", "doorway"]).exits(1).says(&["echoes.mcap, byte "]).says(words).writes_nothing();
    };
    refused(&drive().bytes(), &["there is no topic /atm/echoes", "/sonar/3 (sensor_msgs/msg/Range)"]);
    refused(&drive().laid_out(Layout::Bare), &["there is no topic /atm/echoes", "/sonar/3 (sensor_msgs/msg/Range)"]);
    refused(&Recording::default().bytes(), &["there is no topic /atm/echoes", "there are no topics at all"]);
    let mut other = Recording::default();
    other.push("/atm/echoes", support::recording::RANGE, stamp(3.0), vec![0; 40]);
    let words =
        ["the messages of /atm/echoes are sensor_msgs/msg/Range in `cdr`, and have to be sensor_msgs/msg/PointCloud2"];
    refused(&other.bytes(), &words);
    refused(&other.laid_out(Layout::Bare), &words);
    for missing in ["azimuth", "range", "t", "sensor", "kind"] {
        let fields: Vec<CloudField<'_>> = FIELDS.into_iter().filter(|(name, ..)| *name != missing).collect();
        let words =
            format!("/atm/echoes at 4003: its points have no field `{missing}`; they have x, y, exact_x, support");
        refused(&recording("/atm/echoes", CLOUD, cloud(stamp(3.0), &fields)), &[&words]);
    }
    let words = "/atm/echoes at 4003: the field `kind` of its points is float64, and has to be uint8, uint16 or uint32";
    refused(&echoes(("kind", 8, &[0.0, 1.0])), &[words]);
    refused(
        &echoes(("azimuth", 2, &[0.0, 1.0])),
        &["the field `azimuth` of its points is uint8, and has to be float32"],
    );
    let crossings = scratch.name("crossings.mcap");
    fuse_sample(&["--crossings", &crossings, "-q"]).exits(0);
    atm(["eval", &crossings, "--world", "doorway"]).exits(1).says(&["no topic /atm/echoes", "/atm/crossings/points"]);
}

#[test]
fn damaged_recordings_give_what_of_them_can_be_read() {
    let scratch = Scratch::new();
    for schema in SCHEMAS {
        let whole = fuse_sample(&["--to", "mcap", "--schema", schema]).exits(0).stdout;
        let points = eval(&whole).exits(0).json()["points"].as_u64().expect("a count");
        for cut in [5, 9, 1000, whole.len() / 2, whole.len() - 1] {
            let file = scratch.file("cut.mcap", &whole[..cut]);
            let args = ["eval", &file, "--world", "doorway", "--json"];
            let ran = atm(args).exits(3).says(&["1 truncated", "cut.mcap, byte "]);
            let found = ran.json()["points"].as_u64().expect("a count");
            assert!(found == points || cut < whole.len() - 1, "{found} of {points} at {cut}");
            // Cut before it says what it has, it is taken for a drive.
            if cut > whole.len() / 3 {
                atm(["draw", &file, "-o", "-"]).exits(3).says(&["1 truncated"]);
            }
        }
        let middle = eval(&whole[..whole.len() / 2]).json()["points"].as_u64().expect("a count");
        assert!(middle > 0 && middle < points, "{middle} of {points}");
    }
    // A chunk that was changed is left out; from a pipe, the sum over all data is wrong as well.
    let mut changed = fuse_sample(&["--to", "mcap"]).exits(0).stdout;
    let middle = changed.len() / 3;
    changed[middle] ^= 1;
    assert_eq!(eval(&changed).exits(3).says(&["2 bad_chunk", "standard input, byte "]).json()["points"], 0);
    // A message that ends early is passed over, and the next one read.
    let message = cloud(stamp(3.0), &FIELDS);
    for cut in [0, 3, 40, message.len() - 2] {
        let mut recording = Recording::default();
        recording.metadata.push(("atm.sensors".into(), [("0".into(), "a".into()), ("7".into(), "b".into())].into()));
        recording.push("/atm/echoes", CLOUD, stamp(3.0), message[..cut].to_vec());
        recording.push("/atm/echoes", CLOUD, stamp(4.0), message.clone());
        let ran = eval(&recording.bytes()).exits(3).says(&["1 bad_message", "byte 93: /atm/echoes at 4003: "]);
        assert_eq!(ran.json()["points"], 2, "cut at {cut}");
    }
}

#[test]
fn ids_that_contradict_each_other_are_named() {
    let mut recording = Recording::default();
    for (index, id) in [("0", "a"), ("7", "b"), ("0", "c"), ("left", "d")] {
        recording.metadata.push(("atm.sensors".into(), [(index.into(), id.into())].into()));
    }
    recording.push("/atm/echoes", CLOUD, stamp(3.0), cloud(stamp(3.0), &FIELDS));
    let ran = eval(&recording.bytes()).exits(3);
    let ran =
        ran.says(&["2 bad_message", "two ids of sensor 0, such as \"c\"", "1 unknown_sensor", "sensor 0 has two ids"]);
    assert_eq!(ran.json()["points"], 1);
}

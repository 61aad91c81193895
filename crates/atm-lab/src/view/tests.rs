use std::sync::Arc;

use atm::{intake::Defaults, job::McapWishes, pipeline::History, rig::Rig, track::MotionLimit};
use atm_core::{Bounds, Consensus, MinAngle};

use super::*;

fn job(input: &str) -> ViewJob {
    let log = LogJob {
        input: input.to_owned(),
        parts: Vec::new(),
        opens: Input::open,
        from: None,
        rig: Some(Arc::new(Rig::load("nomad200").unwrap())),
        poses: None,
        max_gap: None,
        max_speed: MotionLimit::default(),
        empty: None,
        defaults: Defaults::default(),
        mcap: McapWishes::default(),
    };
    let settings = Settings {
        emit: Emit::Settled,
        history: History::PAPER,
        bounds: Bounds::NONE,
        estimator: AnyEstimator::PAPER,
        strict: false,
    };
    ViewJob {
        log,
        settings,
        estimators: vec![AnyEstimator::PAPER, AnyEstimator::Consensus(Consensus::new(MinAngle::PAPER))],
        methods: Method::ALL.to_vec(),
        command: "atm view".to_owned(),
        world: None,
        truth: None,
        units: None,
        most: MOST_READINGS,
    }
}

const DOORWAY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/doorway.csv");

fn said(html: &str) -> serde_json::Value {
    let (_, rest) = html.split_once("type=\"application/json\">").unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

#[test]
fn the_sample_is_a_page_of_at_most_400_kb_with_all_its_echoes() {
    let replay = job(DOORWAY).run(&mut |_, _| true).unwrap();
    assert!(replay.html.len() <= 400_000, "{} bytes", replay.html.len());
    let said = said(&replay.html);
    let count = |name: &str| {
        let list = said["columns"]["list"].as_array().unwrap();
        list.iter().find(|column| column["name"] == name).unwrap()["count"].as_u64().unwrap()
    };
    // The counts by the paper's preset.
    assert_eq!((count("reading.range"), count("atm.reading")), (784, 621));
    assert_eq!(said["methods"][1]["counts"]["echoes"]["median"], 122);
    assert_eq!(said["units"], "in");
    assert_eq!(replay.thinned, (784, 1));
}

#[test]
fn more_readings_than_wanted_are_thinned_evenly_by_sensor() {
    let replay = ViewJob { most: 100, ..job(DOORWAY) }.run(&mut |_, _| true).unwrap();
    let said = said(&replay.html);
    assert_eq!(said["thinned"], serde_json::json!({ "stride": 16, "readings": 784 }));
    let list = said["columns"]["list"].as_array().unwrap();
    // 49 readings of each of the 16 sensors: every eighth would be 112, every sixteenth is 64.
    assert_eq!(list.iter().find(|column| column["name"] == "reading.range").unwrap()["count"], 16 * 4);
    // What was counted is of the whole log.
    assert_eq!(said["methods"][1]["counts"]["echoes"]["median"], 122);
}

#[test]
fn words_of_a_log_are_never_html() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("<script>alert(1)<!--.csv");
    std::fs::write(&path, "t,sensor,range,x,y,yaw\n0,</script><b>,2.5,0,0,0\n0.1,</script><b>,2.4,0.1,0,0\n").unwrap();
    let rig = "[[sensor]]\nid = \"</script><b>\"\nx = \"0m\"\ny = \"0m\"\nyaw = \"0deg\"\n";
    let rig = Rig::parse(rig, "rig.toml").unwrap();
    let mut job = job(path.to_str().unwrap());
    job.log.rig = Some(Arc::new(rig));
    job.command = "atm view '<script>alert(1)<!--.csv'".to_owned();
    let html = job.run(&mut |_, _| true).unwrap().html;
    assert!(!html.contains("<script>alert") && !html.contains("</script><b>"));
    assert_eq!(said(&html)["sensors"][0], "</script><b>");
}

#[test]
fn the_page_asks_nothing_of_the_network() {
    let html = job(DOORWAY).run(&mut |_, _| true).unwrap().html;
    assert!(html.contains("default-src 'none'"));
    for (index, _) in html.match_indices("://") {
        // Names of XML, which nobody fetches.
        assert!(
            html[..index].ends_with("http") && html[index..].starts_with("://www.w3.org/"),
            "{}",
            &html[index - 20..index + 40]
        );
    }
}

#[test]
fn standard_input_is_read_once_only() {
    let refused = job("-").run(&mut |_, _| true).unwrap_err().to_string();
    assert!(refused.contains("standard input"), "{refused}");
}

#[test]
fn a_log_without_readings_has_no_replay() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("empty.csv");
    std::fs::write(&path, "t,sensor,range,x,y,yaw\n").unwrap();
    assert!(job(path.to_str().unwrap()).run(&mut |_, _| true).is_err());
}

#[test]
fn a_command_line_can_be_typed_again() {
    assert_eq!(quoted(["atm", "view", "it's here.csv", ""]), r"atm view 'it'\''s here.csv' ''");
    assert_eq!(quoted(["--set", "opening=36in"]), "--set opening=36in");
}

/// The drive as it is gathered, of at most so many readings.
fn gathered(most: usize) -> Gathering {
    let (job, mut drive) = (job(DOORWAY), Gathering::new(most));
    job.pass(AnyEstimator::PAPER, &mut drive, &mut |_, _| true, None).unwrap();
    drive.finish();
    drive
}

#[test]
fn what_is_kept_of_a_thinned_drive_is_what_it_was() {
    use std::collections::BTreeSet;
    let (whole, thin) = (gathered(10_000), gathered(300));
    let key = |drive: &Gathering, shot: u32| {
        let shot = drive.shots[shot as usize];
        (drive.places[shot.pose as usize].t, shot.sensor, shot.range)
    };
    let shots =
        |drive: &Gathering| -> BTreeSet<_> { (0..drive.shots.len() as u32).map(|shot| key(drive, shot)).collect() };
    let kept = shots(&thin);
    assert_eq!(thin.stride, 4);
    assert!(kept.is_subset(&shots(&whole)) && kept.len() == thin.shots.len());
    let found = |drive: &Gathering| -> BTreeSet<_> {
        let found =
            drive.found.iter().map(|found| (key(drive, found.shot), found.kind, found.azimuth, found.crossings));
        found.filter(|(key, ..)| kept.contains(key)).collect()
    };
    assert!(found(&thin) == found(&whole) && !found(&thin).is_empty());
    let meetings = |drive: &Gathering| -> BTreeSet<_> {
        let ends = drive.meetings.iter().map(|one| (key(drive, one.on), key(drive, one.with), one.azimuth));
        ends.filter(|(on, with, _)| kept.contains(on) && kept.contains(with)).collect()
    };
    assert!(meetings(&thin) == meetings(&whole) && !meetings(&thin).is_empty());
    assert!(thin.shots.iter().all(|shot| shot.left >= shot.pose && (shot.left as usize) < thin.places.len()));
}

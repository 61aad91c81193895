//! `atm fuse --estimator consensus`: its columns, its options, and the doorway.

mod support;

use std::collections::{BTreeMap, HashMap};

use support::*;

/// The usual columns, and what follows them.
const CONSENSUS_HEADER: &str = "t,sensor,x,y,kind,range,azimuth,crossings,resolution,significance,support,against,\
                                sigma_azimuth,sigma_range,normal_x,normal_y";

const CONSENSUS: [&str; 2] = ["--estimator", "consensus"];

fn consensus(more: &[&str]) -> Ran {
    let args: Vec<&str> = CONSENSUS.iter().chain(more).copied().collect();
    fuse_sample(&args)
}

/// The cells of each row by their columns' names.
fn rows(ran: &Ran) -> Vec<HashMap<String, String>> {
    let mut lines = ran.text().lines();
    let header: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells.len(), header.len(), "{line}");
        header.iter().map(|name| (*name).to_owned()).zip(cells.into_iter().map(str::to_owned)).collect()
    };
    lines.map(row).collect()
}

fn resolved(ran: &Ran) -> Vec<HashMap<String, String>> {
    rows(ran).into_iter().filter(|row| row["kind"] != "center").collect()
}

/// Readings of the sample by time and sensor.
fn readings() -> HashMap<(String, String), Row> {
    sample_rows().into_iter().map(|row| ((row.t.clone(), row.sensor.clone()), row)).collect()
}

#[test]
fn atm_stays_the_default_to_the_last_byte() {
    fuse_sample(&["--estimator", "atm"]).exits(0).writes(fuse_sample(&[]).stdout);
}

#[test]
fn usual_columns_come_first_and_every_echo_gets_a_row() {
    let ran = consensus(&[]).exits(0);
    assert_eq!(ran.text().lines().next(), Some(CONSENSUS_HEADER));
    assert!(CONSENSUS_HEADER.starts_with(HEADER));
    let echoes = sample_rows().iter().filter(|row| row.echo().is_some()).count();
    assert_eq!(rows(&ran).len(), echoes);
}

#[test]
fn position_lies_at_the_azimuth_within_the_beam_and_a_step_of_the_reading() {
    let readings = readings();
    for row in rows(&consensus(&[]).exits(0)) {
        let (x, y, direction) = readings[&(row["t"].clone(), row["sensor"].clone())].sensor_pose();
        let azimuth = number(&row["azimuth"]);
        assert!(azimuth.abs() <= BEAM / 2.0 + 1e-9, "{row:?}");
        let (dx, dy) = (number(&row["x"]) - x, number(&row["y"]) - y);
        let distance = dx.hypot(dy);
        assert!((distance - number(&row["range"])).abs() < INCH, "{row:?}");
        let (sin, cos) = (direction + azimuth).sin_cos();
        assert_near(dx, distance * cos, 1e-9);
        assert_near(dy, distance * sin, 1e-9);
    }
}

#[test]
fn uncertainties_stand_beside_what_they_belong_to() {
    for row in rows(&consensus(&[]).exits(0)) {
        let (range, sigma) = (number(&row["range"]), number(&row["sigma_azimuth"]));
        let normal = (row["normal_x"].as_str(), row["normal_y"].as_str());
        match row["kind"].as_str() {
            "center" => {
                // Uniform over the beam, and over a step of the range.
                assert_near(sigma, BEAM / 12f64.sqrt(), 1e-9);
                assert_near(number(&row["sigma_range"]), INCH / 12f64.sqrt(), 1e-9);
                assert_near(number(&row["resolution"]), BEAM * range, 1e-9);
                assert_eq!((normal, row["significance"].as_str()), (("", ""), "1.0"));
            }
            kind => {
                // Resolved is what is as sharp as the paper's crossings.
                let resolution = number(&row["resolution"]);
                assert!(resolution <= PAPER_INTERVAL, "{row:?}");
                assert_near(resolution / (2.0 * 1.96 * sigma * range), 1.0, 0.02);
                assert!(number(&row["significance"]) <= 0.1 + 1e-12, "{row:?}");
                assert_eq!(row["support"], row["crossings"]);
                assert_eq!(normal == ("", ""), kind == "point", "{row:?}");
            }
        }
    }
}

#[test]
fn walls_of_the_sample_have_the_normals_of_its_walls() {
    // All its walls run along x: the one with the opening is left of the path, the other one right of it.
    let walls: Vec<_> = resolved(&consensus(&[]).exits(0)).into_iter().filter(|row| row["kind"] == "wall").collect();
    assert!(walls.len() >= 20, "{}", walls.len());
    for wall in walls {
        let (x, y) = (number(&wall["normal_x"]), number(&wall["normal_y"]));
        assert_near(x.hypot(y), 1.0, 1e-9);
        assert!(x.abs() < 3f64.to_radians().sin() && y * number(&wall["y"]) < 0.0, "{wall:?}");
    }
}

#[test]
fn opening_of_36_inches_is_found_with_points_on_both_jambs() {
    let (start, end, wall) = (102.0 * INCH, 138.0 * INCH, 70.0 * INCH);
    let echoes = resolved(&consensus(&[]).exits(0));
    let on_wall = |row: &&HashMap<String, String>| (number(&row["y"]) - wall).abs() < 4.0 * INCH;
    let mut along: Vec<f64> = echoes.iter().filter(on_wall).map(|row| number(&row["x"])).collect();
    along.retain(|x| (start - 24.0 * INCH..end + 24.0 * INCH).contains(x));
    along.sort_by(f64::total_cmp);
    let gap = along.windows(2).map(|pair| (pair[0], pair[1])).max_by(|a, b| (a.1 - a.0).total_cmp(&(b.1 - b.0)));
    let (left, right) = gap.expect("points on the wall");
    assert!((left - start).abs() < 1.5 * INCH && (right - end).abs() < 1.5 * INCH, "{left} to {right}");
}

#[test]
fn confidence_of_none_resolves_more_and_of_nearly_all_less() {
    let count = |confidence| resolved(&consensus(&["--confidence", confidence]).exits(0)).len();
    let (none, usual, most) = (count("0"), resolved(&consensus(&[]).exits(0)).len(), count("0.999"));
    assert!(none > usual && usual > most && most > 0, "{none} {usual} {most}");
}

#[test]
fn kinds_are_counted_and_kept_by_their_names() {
    let args: Vec<&str> = FUSE.iter().chain(&CONSENSUS).chain(&["--keep", "wall"]).copied().collect();
    let (ran, summary) = with_summary(&args, "");
    let ran = ran.exits(0).says(&[" point, ", " wall, ", " center"]);
    let names: Vec<&String> = summary["echoes"].as_object().expect("an object").keys().collect();
    assert_eq!(names, ["point", "wall", "center"]);
    assert_eq!(rows(&ran).len() as u64, tally(&summary, "/echoes/wall"));
    assert_eq!(rows(&ran).len() as u64, tally(&summary, "/written"));
}

#[test]
fn options_of_one_estimator_are_refused_with_the_other() {
    let refused = |args: &[&str], words: &[&str]| {
        fuse_sample(args).exits(2).says(words).writes_nothing();
    };
    let with_consensus = |more: &[&'static str]| CONSENSUS.iter().chain(more).copied().collect::<Vec<_>>();
    refused(&with_consensus(&["--on-two", "mean"]), &["--on-two", "consensus"]);
    refused(&with_consensus(&["--on-none", "drop"]), &["--on-none", "consensus"]);
    refused(&with_consensus(&["--crossings", "crossings.csv"]), &["--crossings", "consensus"]);
    refused(&with_consensus(&["--keep", "median"]), &["median", "consensus"]);
    refused(&["--keep", "wall"], &["wall", "atm"]);
    refused(&["--confidence", "0.5"], &["--confidence", "atm"]);
    refused(&["--range-error", "1cm"], &["--range-error", "atm"]);
    refused(&with_consensus(&["--confidence", "1"]), &["1", "share"]);
    refused(&with_consensus(&["--range-error=-1cm"]), &["-1cm"]);
}

#[test]
fn edges_of_held_runs_are_their_first_and_last_reading() {
    let mut by_sensor: BTreeMap<String, Vec<(String, Option<String>)>> = BTreeMap::new();
    for row in sample_rows() {
        let value = row.echo().map(|_| row.range.clone());
        by_sensor.entry(row.sensor.clone()).or_default().push((row.t, value));
    }
    let mut expected = Vec::new();
    let mut skipped = 0;
    for (sensor, readings) in by_sensor {
        for (place, (t, value)) in readings.iter().enumerate() {
            let same = |other: Option<&(String, Option<String>)>| other.is_some_and(|(_, other)| other == value);
            let inside =
                same(place.checked_sub(1).and_then(|before| readings.get(before))) && same(readings.get(place + 1));
            skipped += u64::from(inside);
            if !inside && value.is_some() {
                expected.push((t.clone(), sensor.clone()));
            }
        }
    }
    assert!(skipped > 50, "{skipped}");
    // No arc is ignored, so that each reading that stays is reported.
    let args: Vec<&str> = FUSE.iter().chain(&["--held", "edges", "--on-two", "center"]).copied().collect();
    let (ran, summary) = with_summary(&args, "");
    assert_eq!(tally(&summary, "/skipped/held"), skipped);
    assert_eq!(tally(&summary, "/readings") + skipped, 784);
    let mut reported: Vec<_> = ran.exits(0).echoes().into_iter().map(|echo| (echo.t, echo.sensor)).collect();
    reported.sort();
    expected.sort();
    assert_eq!(reported, expected);
}

#[test]
fn held_values_are_dropped_under_either_name_and_kept_by_default() {
    fuse_sample(&["--held", "drop"]).exits(0).writes(fuse_sample(&["--drop-held"]).exits(0).stdout);
    fuse_sample(&["--held", "keep"]).exits(0).writes(fuse_sample(&[]).exits(0).stdout);
    fuse_sample(&["--held", "drop", "--drop-held"]).exits(2);
}

#[test]
fn a_log_without_echoes_is_counted_by_its_own_kinds() {
    let scratch = Scratch::new();
    let log = scratch.file("log.csv", "t,sensor,range,x,y,yaw\n0,0,inf,0,0,0\n");
    let ran = atm(["fuse", &log, "--rig", "nomad200", "-o", "-"].iter().chain(&CONSENSUS)).exits(0);
    assert_eq!(ran.text(), format!("{CONSENSUS_HEADER}\n"));
    ran.says(&["0: 0 point, 0 wall, 0 center"]);
}

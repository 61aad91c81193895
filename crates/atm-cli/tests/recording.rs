//! A real recording: eight sonars in a corridor (Udacity's robotics course).
//!
//! It is looked for in `$ATM_TEST_DATA`, else in `../shared/data` beside the repository. Without it these tests say so and
//! pass, except where `CI` is set.
#![cfg(feature = "lab")]

mod support;

use std::{
    env, fs,
    io::{self, Write},
    path::PathBuf,
};

use serde_json::Value;
use support::*;

/// The log and its poses, if they are there.
fn recording() -> Option<(String, String)> {
    let place = env::var_os("ATM_TEST_DATA").map_or_else(|| root().join("../shared/data"), PathBuf::from);
    let place = place.join("udacity-sonar8");
    let files = ["measurement.txt", "poses.txt"].map(|name| place.join(name));
    if files.iter().all(|file| file.is_file()) {
        return Some(files.map(|file| file.to_str().expect("a path in UTF-8").to_owned()).into());
    }
    let missing =
        format!("no recording in {}; set ATM_TEST_DATA to the directory that holds udacity-sonar8", place.display());
    assert!(env::var_os("CI").is_none(), "{missing}");
    // Straight to standard error: what a passing test prints is not shown.
    let _ = writeln!(io::stderr(), "\n*** SKIPPED: {missing} ***");
    None
}

fn fuse(more: &[&str]) -> Option<(Ran, Value)> {
    let (log, poses) = recording()?;
    let args: Vec<&str> = ["fuse", &log, "--poses", &poses, "--rig", "robond8"].iter().chain(more).copied().collect();
    Some(with_summary(&args, ""))
}

/// As the paper has it: the last ten readings of every sensor.
fn fuse_by_count(more: &[&str]) -> Option<(Ran, Value)> {
    fuse(&[&["--preset", "paper"], more].concat())
}

#[test]
fn with_no_flag_more_is_resolved_than_by_count_with_the_best_ones() {
    let (Some((_, by_travel)), Some((_, by_count))) = (fuse(&[]), fuse_by_count(&["--drop-held"])) else { return };
    let medians = |summary| tally(summary, "/echoes/median");
    assert!(medians(&by_travel) >= 3 * medians(&by_count), "{by_travel}\n{by_count}");
}

#[test]
fn one_command_fuses_it_and_names_every_kind() {
    let Some((ran, summary)) = fuse(&[]) else { return };
    let ran = ran.exits(0).says(&["median", "single", "center", "near", "pair"]);
    assert!(!ran.stderr.contains("unusable"), "{}", ran.stderr);
    // 413 lines of eight readings, 2,211 of them between 170 mm and 5 m.
    assert_eq!((tally(&summary, "/readings"), tally(&summary, "/no_echo")), (413 * 8, 413 * 8 - 2211));
    let echoes = ran.echoes();
    assert_eq!(echoes.len() as u64 + tally(&summary, "/ignored_pairs"), 2211);
    assert_eq!(summary["dropped"], serde_json::json!({}));
    // Milliseconds in the file, seconds here: the first sweep has four echoes.
    assert_eq!(echoes.iter().filter(|echo| echo.t == "1686.487").count(), 4);
}

#[test]
fn first_echoes_stand_where_the_first_readings_say() {
    let Some((ran, _)) = fuse_by_count(&[]) else { return };
    // The robot stands at the origin; sensors 2, 3, 6 and 7 hear 2.32, 2.36, 2.16 and 1.19 m.
    let bearings = [("2", -22.5, 2.32), ("3", -7.5, 2.36), ("6", 37.5, 2.16), ("7", 90.0, 1.19)];
    let echoes = ran.echoes();
    for (echo, (sensor, bearing, range)) in echoes.iter().zip(bearings) {
        let (sin, cos) = f64::to_radians(bearing).sin_cos();
        assert_eq!((echo.sensor.as_str(), echo.range, echo.kind.as_str()), (sensor, range, "center"));
        assert_near(echo.x, range * cos, 1e-9);
        assert_near(echo.y, range * sin, 1e-9);
    }
}

#[test]
fn held_values_hide_medians_and_singles_until_they_are_dropped() {
    let (Some((_, held)), Some((ran, dropped))) = (fuse_by_count(&[]), fuse_by_count(&["--drop-held"])) else {
        return;
    };
    assert_eq!(tally(&held, "/skipped/held"), 0);
    let skipped = tally(&dropped, "/skipped/held");
    assert!(skipped > 1000, "{skipped}");
    assert_eq!(skipped + tally(&dropped, "/readings"), 413 * 8);
    ran.exits(0).says(&[&format!("{skipped} held")]);
    for kind in ["/echoes/median", "/echoes/single"] {
        let (before, after) = (tally(&held, kind), tally(&dropped, kind));
        assert!(after > 2 * before, "{kind}: {before} with held values, {after} without");
    }
}

#[test]
fn info_says_what_it_is_and_that_values_are_held() {
    let Some((log, poses)) = recording() else { return };
    let ran = atm(["info", &log, "--rig", "robond8", "--poses", &poses, "--json"]).exits(0);
    let found = ran.json();
    assert_eq!(
        (found["start_ns"].as_i64(), found["sensors"].as_object().map(serde_json::Map::len)),
        (Some(1_686_487_000_000), Some(8))
    );
    assert_eq!(found["sensors"]["0"]["readings"], 413);
    assert!(found["problems"].to_string().contains("--drop-held"), "{found}");
}

#[test]
fn consensus_has_jambs_as_points_and_the_corridor_as_walls() {
    let more = ["--held", "edges", "--estimator", "consensus", "--range-error", "2cm", "--keep", "point,wall"];
    let (Some((consensus, summary)), Some((atm, _))) =
        (fuse_by_count(&more), fuse_by_count(&["--drop-held", "--keep", "median,single"]))
    else {
        return;
    };
    assert!(tally(&summary, "/skipped/held") > 1000);
    let jambs = atm.exits(0).echoes();
    let consensus = consensus.exits(0);
    let rows: Vec<Vec<&str>> = consensus.text().lines().skip(1).map(|line| line.split(',').collect()).collect();
    let of_kind = |kind| rows.iter().filter(move |row| row[4] == kind);
    // There is no truth; where the medians and singles stand, many arcs cross.
    let points: Vec<f64> = of_kind("point")
        .map(|row| {
            let (x, y) = (number(row[2]), number(row[3]));
            jambs.iter().map(|jamb| (jamb.x - x).hypot(jamb.y - y)).fold(f64::INFINITY, f64::min)
        })
        .collect();
    assert!(points.len() > 40 && points.iter().all(|&distance| distance < 0.25), "{points:?}");
    // The first corridor runs along x, some 2.1 m wide, from the origin to where the robot turns.
    let walls: Vec<(f64, f64)> = of_kind("wall")
        .filter(|row| number(row[2]) < 10.0)
        .map(|row| (number(row[14]).atan2(number(row[15]).abs()).to_degrees().abs(), number(row[3])))
        .collect();
    let along = walls.iter().filter(|(tilt, _)| *tilt < 5.0).count();
    let in_place = walls.iter().filter(|(_, y)| (1.1..1.3).contains(y) || (-1.0..-0.8).contains(y)).count();
    assert!(walls.len() > 100, "{}", walls.len());
    assert!(
        along * 10 >= walls.len() * 9 && in_place * 10 >= walls.len() * 9,
        "{along}, {in_place} of {}",
        walls.len()
    );
}

/// Set to write what was measured into the page instead of holding it against it: `scripts/methods` does.
const WRITE: &str = "ATM_WRITE_PAGE";

/// What `atm compare` prints for a terminal, as the page has it: without times, and without methods that don't apply.
fn as_on_the_page(printed: &str) -> String {
    let header =
        "| | points | entropy at 5 cm | at 10 cm | agrees | with atm |\n|---|--:|--:|--:|--:|--:|\n".to_owned();
    let rows = printed.lines().skip(2).map(|line| line.split_whitespace().collect::<Vec<_>>());
    let rows = rows.take_while(|row| row.len() == 7).filter(|row| row[1] != "-");
    header + &rows.map(|row| format!("| {} |\n", row[..6].join(" | "))).collect::<String>()
}

#[test]
fn the_page_of_the_methods_shows_its_table_and_its_maps() {
    let Some((log, poses)) = recording() else { return };
    let scratch = Scratch::new();
    let drawn = scratch.name("pictures");
    let args = ["--rig", "robond8", "--preset", "paper", "--drop-held", "--range-error", "2cm", "--draw", &drawn];
    let ran = atm(["compare", &log, "--poses", &poses].iter().chain(&args)).exits(0);
    let (table, picture) = (as_on_the_page(ran.text()), fs::read(format!("{drawn}/side-by-side.png")).unwrap());
    let [page, picture_place] =
        ["methods.md", "methods.png"].map(|name| root().join("docs").join(name).to_str().unwrap().to_owned());
    let text = read(&page);
    let (before, rest) = text.split_once("<!-- measured: recording -->\n").expect("a place for the table");
    let (shown, after) = rest.split_once("<!-- end -->").expect("an end of that place");
    if env::var_os(WRITE).is_some_and(|set| !set.is_empty()) {
        fs::write(&page, format!("{before}<!-- measured: recording -->\n{table}<!-- end -->{after}")).unwrap();
        fs::write(&picture_place, picture).unwrap();
        return;
    }
    assert_eq!(shown, table, "scripts/methods writes it");
    assert!(fs::read(picture_place).unwrap() == picture, "scripts/methods draws it");
}

#[test]
fn the_page_of_the_consensus_shows_what_is_drawn_of_it() {
    let Some((log, poses)) = recording() else { return };
    let scratch = Scratch::new();
    let (median, consensus, drawn) =
        (scratch.name("atm.csv"), scratch.name("consensus.csv"), scratch.name("drawn.svg"));
    let log_of = |command| [command, log.as_str(), "--poses", poses.as_str(), "--rig", "robond8"];
    atm(log_of("fuse").iter().chain(&["--preset", "paper", "--held", "drop", "-o", &median])).exits(0);
    let more =
        ["--preset", "paper", "--held", "edges", "--estimator", "consensus", "--range-error", "2cm", "-o", &consensus];
    atm(log_of("fuse").iter().chain(&more)).exits(0);
    let page = read(root().join("docs/accuracy.md").to_str().expect("a path in UTF-8"));
    // Its panels, as the page has them between quotes.
    let (_, command) = page.split_once("atm draw measurement.txt").expect("the command of the picture");
    let (command, _) = command.split_once("```").expect("its end");
    let panels = command.split('\'').skip(1).step_by(2).flat_map(|panel| ["--panel", panel]);
    let args =
        log_of("draw").into_iter().chain([median.as_str(), &consensus, "--size", "1500", "-o", &drawn]).chain(panels);
    atm(args.collect::<Vec<_>>()).exits(0);
    let place = root().join("docs/accuracy-recording.svg");
    let place = place.to_str().expect("a path in UTF-8");
    if env::var_os(WRITE).is_some_and(|set| !set.is_empty()) {
        fs::write(place, read(&drawn)).unwrap();
        return;
    }
    assert_same(read(&drawn).as_bytes(), read(place).as_bytes());
}

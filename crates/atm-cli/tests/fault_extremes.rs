//! Logs and rigs at the edges: numbers as large, small and many as they may be.

mod support;

use std::{fmt::Write as _, time::Instant};

use support::{fault::*, *};

/// The sample's rows, changed.
fn changed(change: impl Fn(usize, &mut Row)) -> String {
    let mut log = String::from("t,sensor,range,x,y,yaw\n");
    for (index, mut row) in sample_rows().into_iter().enumerate() {
        change(index, &mut row);
        let Row { t, sensor, range, x, y, yaw } = row;
        writeln!(log, "{t},{sensor},{range},{x},{y},{yaw}").expect("memory");
    }
    log
}

/// An echo but for its time.
fn timeless(echoes: Vec<Echo>) -> Vec<Echo> {
    echoes.into_iter().map(|echo| Echo { t: String::new(), ..echo }).collect()
}

#[test]
fn times_that_are_all_the_same_change_nothing_but_the_times() {
    let log = changed(|_, row| row.t = "17".to_owned());
    for emit in ["settled", "latest"] {
        let found = fuse_text(&log, &["--emit", emit]).exits(0).echoes();
        assert!(found.iter().all(|echo| echo.t == "17.0"));
        assert_eq!(timeless(found), timeless(fuse_sample(&["--emit", emit]).echoes()));
    }
}

#[test]
fn time_reaches_from_one_end_of_its_range_to_the_other() {
    let rows = sample_rows().len();
    // 2^63 ns are 9223372036.854775808 s.
    let at = |index: usize| match index {
        index if index < rows / 3 => "-9223372036.854775808",
        index if index < 2 * rows / 3 => "0",
        _ => "9223372036.854775807",
    };
    let log = changed(|index, row| row.t = at(index).to_owned());
    let found = fuse_text(&log, &[]).exits(0).echoes();
    assert_eq!(found.first().expect("echoes").t, "-9223372036.854775808");
    assert_eq!(found.last().expect("echoes").t, "9223372036.854775807");
    assert_eq!(timeless(found), timeless(fuse_sample(&[]).echoes()));
    // Ages are right across the whole of it: nothing of one third is as old as half of all time.
    let bounded = fuse_text(&log, &["--max-age", "9e9s"]).exits(0).echoes();
    assert_ne!(timeless(bounded), timeless(fuse_sample(&[]).echoes()));
    fuse_text("t,sensor,range,x,y,yaw\n9223372036.854775808,0,1,0,0,0\n", &[]).exits(3).says(&["bad_number", "t "]);
}

#[test]
fn a_robot_a_light_hour_away_gets_finite_echoes_on_their_arcs() {
    // 10^12 m: neighbouring numbers are 0.1 mm apart.
    let log = changed(|_, row| row.x = (1e12 + number(&row.x)).to_string());
    let poses: Vec<_> = sample_rows().iter().map(Row::sensor_pose).collect();
    let found = fuse_text(&log, &["--on-none", "drop"]).exits(0).echoes();
    assert!(found.len() > 50, "{}", found.len());
    for echo in &found {
        let near = |(x, y, _): &(f64, f64, f64)| ((echo.x - 1e12 - x).hypot(echo.y - y) - echo.range).abs() < 1e-3;
        assert!(poses.iter().any(near), "{echo:?} is on no arc");
    }
}

#[test]
fn coordinates_beyond_reason_end_no_run() {
    for far in ["1e300", "-1.7976931348623157e308", "5e-324"] {
        let log = changed(|index, row| {
            if index % 5 == 0 {
                row.x = far.to_owned();
            }
            if index % 7 == 0 {
                row.yaw = far.to_owned();
            }
        });
        for emit in ["settled", "latest"] {
            let (ran, counts) = with_summary(&["fuse", "-", "--rig", "nomad200", "--emit", emit], &log);
            assert!(ran.status == 0 || ran.status == 3, "{}", ran.stderr);
            let numbers = |echo: &Echo| [echo.x, echo.y, echo.range, echo.azimuth, echo.resolution, echo.significance];
            assert!(ran.echoes().iter().flat_map(numbers).all(f64::is_finite), "{far}");
            let dropped = |reason: &str| counts["dropped"][reason].as_u64().unwrap_or(0);
            let all = tally(&counts, "/readings") + dropped("bad_pose") + dropped("impossible_motion");
            assert_eq!(all + tally(&counts, "/duplicates"), 784, "{far}");
        }
    }
}

#[test]
fn the_smallest_ranges_are_echoes_where_the_sensor_is() {
    let scratch = Scratch::new();
    let rig = scratch.file("rig.toml", "[ring]\ncount = 16\nradius = \"9in\"\n");
    let log = changed(|_, row| row.range = "1e-300".to_owned());
    let found = atm_fed(["fuse", "-", "--rig", &rig], &log).exits(0).echoes();
    assert_eq!(found.len(), 784);
    for (echo, row) in found.iter().zip(sample_rows()) {
        let (x, y, _) = row.sensor_pose();
        assert_eq!((echo.kind.as_str(), echo.range, echo.azimuth), ("near", 1e-300, 0.0));
        assert!((echo.x - x).hypot(echo.y - y) < 1e-12, "{echo:?}");
    }
}

#[test]
fn a_rig_without_sensors_is_refused() {
    let scratch = Scratch::new();
    for (text, word) in [
        ("name = \"none\"\n", "no sensors"),
        ("sensor = []\n", "sensor"),
        ("[ring]\ncount = 0\nradius = \"1m\"\n", "must be 1 to 65535"),
        ("[ring]\ncount = 65536\nradius = \"1m\"\n", "must be 1 to 65535"),
        ("[ring]\ncount = 18446744073709551616\nradius = \"1m\"\n", "must be 1 to 65535"),
    ] {
        let rig = scratch.file("rig.toml", text);
        atm(["fuse", SAMPLE, "--rig", &rig]).exits(1).says(&[&rig, word]).writes_nothing();
    }
}

/// A rig of as many sensors as there may be.
fn crowd(scratch: &Scratch) -> String {
    scratch.file("crowd.toml", "field_of_view = \"60deg\"\n[ring]\ncount = 65535\nradius = \"1m\"\n")
}

#[test]
fn as_many_sensors_as_there_may_be_in_a_long_table() {
    let scratch = Scratch::new();
    let rig = crowd(&scratch);
    let mut log = String::from("t,sensor,range,x,y,yaw\n");
    for row in 0..600 {
        writeln!(log, "{row},{},1.5,0,0,0", row * 7919 % 65_535).expect("memory");
    }
    let fuse = ["fuse", "-", "--rig", &rig, "--history", "1"];
    for emit in ["settled", "latest"] {
        let (ran, counts) = with_summary(&[&fuse[..], &["--emit", emit]].concat(), &log);
        ran.exits(0);
        assert_eq!(tally(&counts, "/readings"), 600);
    }
    atm_fed(["info", "-", "--rig", &rig], &log).exits(0);
    // What does not fit in memory is refused beforehand.
    atm_fed(["fuse", "-", "--rig", &rig, "--history", "1000"], &log).exits(2).says(&["65535 sensors", "slots"]);
    atm_fed(["fuse", "-", "--rig", &rig, "--history", "10001"], &log).exits(2).says(&["10001"]);
}

#[test]
fn as_many_sensors_as_there_may_be_in_a_wide_table() {
    let scratch = Scratch::new();
    let rig = crowd(&scratch);
    let ids: Vec<String> = (0..65_535).map(|id: u32| id.to_string()).collect();
    let mut log = format!("t,x,y,yaw,{}\n", ids.join(","));
    // Most of them did not fire.
    for row in 0..4 {
        let cells: Vec<&str> = (0..65_535).map(|id| if id % 4096 == row { "2" } else { "" }).collect();
        writeln!(log, "{row},0,0,0,{}", cells.join(",")).expect("memory");
    }
    let (ran, counts) = with_summary(&["fuse", "-", "--rig", &rig, "--history", "1"], &log);
    ran.exits(0);
    assert_eq!((tally(&counts, "/readings"), tally(&counts, "/skipped/empty")), (64, 4 * 65_535 - 64));
}

#[test]
fn one_sensor_more_than_there_may_be_is_said_of_a_log_without_a_rig() {
    let ids: Vec<String> = (0..65_536).map(|id: u32| id.to_string()).collect();
    let log = format!("t,x,y,yaw,{}\n", ids.join(","));
    atm_fed(["info", "-"], &log).exits(1).says(&["standard input:1", "too many columns"]);
}

/// Rigs that are made to take long.
#[test]
fn no_rig_takes_more_than_its_length_asks_for() {
    let scratch = Scratch::new();
    let many = |text: &str, count: usize| text.repeat(count);
    let texts = [
        format!("a = {}", many("[", 500_000)),
        format!("a = {}", many("{b = ", 500_000)),
        format!("{}a = 1", many("a.", 500_000)),
        format!("[{}a]", many("a.", 500_000)),
        many("[[a]]\n[[a.b]]\n", 100_000),
        (0..200_000).fold(String::new(), |text, index| text + &format!("k{index} = 1\n")),
        format!("[ring]\ncount = 2\nradius = \"1m\"\n[log]\nno_echo = [{}]", many("1,", 500_000)),
        format!("[ring]\ncount = 2\nradius = \"1e-{}m\"\n[log]\nno_echo = [{}]", many("9", 500_000), many("1,", 2000)),
    ];
    for text in texts {
        let rig = scratch.file("rig.toml", &text);
        let start = Instant::now();
        atm(["fuse", SAMPLE, "--rig", &rig]).exits(1).says(&[&rig]).writes_nothing();
        // Each takes a few tenths of a second; what is not linear would take minutes.
        assert!(start.elapsed().as_secs() < 20, "{:?}: {}", start.elapsed(), &text[..20]);
    }
}

#[test]
fn a_soak_in_small_gives_the_same_as_its_last_part_alone() {
    // Time goes on for ever, and nothing of what was before is left after the pause.
    let (before, last) = (drive(20_000), drive(2000));
    let later = |row: &str| row.split_once(',').map(|(t, rest)| format!("{},{rest}\n", number(t) + 1e6));
    let last: String = last.lines().skip(1).filter_map(later).collect();
    let header = "t,sensor,range,x,y,yaw\n";
    let alone = undisturbed(&format!("{header}{last}"), &["--max-age", "5s"]);
    let both = undisturbed(&format!("{before}{last}"), &["--max-age", "5s"]);
    let rows = alone.strip_prefix(HEADER).expect("a header").trim_start();
    assert!(rows.lines().count() > 1000);
    assert!(both.ends_with(rows));
}

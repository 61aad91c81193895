//! `atm fuse`: what each flag does.

mod support;

use std::collections::{HashMap, HashSet};

use support::*;

/// The rig of the sample in TOML, without the lines that begin with one of `without`.
fn rig(scratch: &Scratch, without: &[&str]) -> String {
    let lines = [
        "field_of_view = \"22.5deg\"",
        "min_range = \"6in\"",
        "max_range = \"255in\"",
        "range_resolution = \"1in\"",
        "[ring]",
        "count = 16",
        "radius = \"9in\"",
        "first_yaw = \"0deg\"",
    ];
    let kept: Vec<&str> = lines.into_iter().filter(|line| !without.iter().any(|key| line.starts_with(key))).collect();
    scratch.file("rig.toml", kept.join("\n"))
}

fn sample_summary(more: &[&str]) -> (Ran, serde_json::Value) {
    let args: Vec<&str> = FUSE.iter().chain(more).copied().collect();
    with_summary(&args, "")
}

#[test]
fn keep_writes_only_these_kinds_and_changes_none_of_them() {
    let all = fuse_sample(&[]).exits(0);
    let (kept, summary) = sample_summary(&["--keep", "median,single"]);
    let rows = |text: &str| -> Vec<String> {
        text.lines().filter(|line| line.contains(",median,") || line.contains(",single,")).map(str::to_owned).collect()
    };
    assert_eq!(kept.text().lines().skip(1).collect::<Vec<_>>(), rows(all.text()));
    // The counts are those before anything is left out; what was written is said beside them.
    assert_eq!(tally(&summary, "/echoes/center") as usize, count(&all.echoes(), "center"));
    assert_eq!(tally(&summary, "/written") as usize, kept.echoes().len());
}

#[test]
fn summary_has_all_keys_and_its_counts_add_up() {
    let (ran, summary) = sample_summary(&[]);
    let keys = [
        "readings",
        "no_echo",
        "echoes",
        "written",
        "ignored_pairs",
        "skipped",
        "dropped",
        "clock_resets",
        "input_damaged",
    ];
    for key in keys {
        assert!(summary.get(key).is_some(), "no {key} in {summary}");
    }
    let echoes = ran.exits(0).echoes();
    let mut total = 0;
    for kind in ["median", "single", "center", "near", "pair"] {
        assert_eq!(tally(&summary, &format!("/echoes/{kind}")) as usize, count(&echoes, kind), "{kind}");
        total += tally(&summary, &format!("/echoes/{kind}"));
    }
    for skipped in ["held", "min_step", "empty"] {
        assert_eq!(tally(&summary, &format!("/skipped/{skipped}")), 0, "{skipped}");
    }
    let silent = sample_rows().iter().filter(|row| row.echo().is_none()).count() as u64;
    assert_eq!(tally(&summary, "/readings"), 784);
    assert_eq!(tally(&summary, "/no_echo"), silent);
    assert_eq!(tally(&summary, "/written"), total);
    assert_eq!(tally(&summary, "/readings"), total + tally(&summary, "/ignored_pairs") + silent);
    assert_eq!(summary["dropped"], serde_json::json!({}));
    assert_eq!((tally(&summary, "/clock_resets"), &summary["input_damaged"]), (0, &false.into()));
}

#[test]
fn settled_is_the_default_emission() {
    fuse_sample(&["--emit", "settled"]).exits(0).writes(fuse_sample(&[]).stdout);
}

#[test]
fn latest_reports_in_input_order_and_knows_nothing_of_what_comes() {
    let whole = fuse_sample(&["--emit", "latest"]).exits(0);
    let order: Vec<_> = sample_rows().into_iter().map(|row| (row.t, row.sensor)).collect();
    let places: Vec<usize> = whole
        .echoes()
        .iter()
        .map(|echo| order.iter().position(|key| *key == echo.key()).expect("the echo's reading"))
        .collect();
    assert!(places.is_sorted_by(|a, b| a < b));
    let log = sample();
    let begun: String = log.split_inclusive('\n').take(401).collect();
    let begun = fuse_text(begun, &["--emit", "latest"]).exits(0);
    assert!(whole.stdout.starts_with(&begun.stdout));
}

#[test]
fn latest_finds_no_crossings_that_settled_misses() {
    let settled: HashMap<_, _> =
        fuse_sample(&["--on-two", "center"]).echoes().into_iter().map(|echo| (echo.key(), echo.crossings)).collect();
    let latest = fuse_sample(&["--emit", "latest", "--on-two", "center"]).echoes();
    assert_eq!(latest.len(), settled.len());
    assert!(latest.iter().all(|echo| echo.crossings <= settled[&echo.key()]));
    assert!(latest.iter().any(|echo| echo.crossings < settled[&echo.key()]));
}

#[test]
fn on_none_drop_leaves_out_the_centers() {
    let (ran, summary) = sample_summary(&["--on-none", "drop"]);
    let all = fuse_sample(&[]).echoes();
    let crossed: Vec<Echo> = all.into_iter().filter(|echo| !echo.is("center")).collect();
    assert_eq!(ran.exits(0).echoes(), crossed);
    assert_eq!(tally(&summary, "/echoes/center"), 0);
    assert_eq!(tally(&summary, "/ignored_pairs"), 55);
}

#[test]
fn on_two_center_takes_the_center_of_the_arcs_that_were_ignored() {
    let (ran, summary) = sample_summary(&["--on-two", "center"]);
    assert_eq!(tally(&summary, "/ignored_pairs"), 0);
    let pairs: Vec<Echo> = ran.exits(0).echoes().into_iter().filter(|echo| echo.is("pair")).collect();
    assert_eq!(pairs.len(), 55);
    for pair in pairs {
        assert_eq!((pair.crossings, pair.azimuth), (2, 0.0));
        assert_near(pair.resolution, BEAM * pair.range, 1e-12);
    }
}

#[test]
fn on_two_mean_takes_the_mean_of_the_two_crossings() {
    let scratch = Scratch::new();
    let path = scratch.name("crossings.csv");
    let echoes = fuse_sample(&["--on-two", "mean", "--crossings", &path]).exits(0).echoes();
    let mut azimuths: HashMap<(String, String), Vec<f64>> = HashMap::new();
    for line in read(&path).lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        azimuths.entry((cells[0].into(), cells[1].into())).or_default().push(number(cells[6]));
    }
    let pairs: Vec<Echo> = echoes.into_iter().filter(|echo| echo.is("pair")).collect();
    assert_eq!(pairs.len(), 55);
    for pair in pairs {
        let [one, two] = azimuths[&pair.key()][..] else { panic!("not two crossings: {pair:?}") };
        assert_near(pair.azimuth, (one + two) / 2.0, 1e-9);
        assert_near(pair.resolution, PAPER_INTERVAL + pair.range * (one - two).abs(), 1e-9);
    }
}

#[test]
fn improvement_chooses_the_angle_that_gives_it() {
    let echoes = fuse_sample(&["--improvement", "10", "--at", "100in"]).exits(0).echoes();
    // A tenth of the arc at 100 in.
    let interval = 100.0 * INCH * BEAM / 10.0;
    for echo in echoes.iter().filter(|echo| echo.is("median") || echo.is("single")) {
        assert_near(echo.resolution, interval, 1e-12);
    }
    // 2 atan(n δ / (d φ)) is 28.57 degrees.
    let angle = format!("{}rad", 2.0 * (10.0 * INCH / (100.0 * INCH * BEAM)).atan());
    let by_angle = fuse_sample(&["--min-angle", &angle]).exits(0).echoes();
    assert_eq!(echoes.len(), by_angle.len());
    for (echo, by_angle) in echoes.iter().zip(&by_angle) {
        assert_eq!((echo.key(), &echo.kind, echo.crossings), (by_angle.key(), &by_angle.kind, by_angle.crossings));
    }
}

#[test]
fn min_angle_is_30_degrees_by_default_and_takes_radians() {
    let default = fuse_sample(&[]).exits(0).stdout;
    fuse_sample(&["--min-angle", "30deg"]).exits(0).writes(&default);
    fuse_sample(&["--min-angle", "0.5235987755982988rad"]).exits(0).writes(&default);
}

#[test]
fn a_larger_min_angle_leaves_fewer_crossings_and_a_shorter_interval() {
    let echoes = fuse_sample(&["--min-angle", "60deg"]).exits(0).echoes();
    assert!(count(&echoes, "center") > count(&fuse_sample(&[]).echoes(), "center"));
    // 1/sin 60 + 1/tan 60 is the square root of three.
    for echo in echoes.iter().filter(|echo| echo.is("single") || echo.is("median")) {
        assert_near(echo.resolution, INCH * 3_f64.sqrt(), 1e-12);
    }
}

#[test]
fn min_step_skips_sensors_that_have_not_moved_far_enough() {
    // 5 in from sweep to sweep: every second one is 10 in on, 25 of 49.
    let (ran, summary) = sample_summary(&["--history", "10", "--min-step", "8in"]);
    assert_eq!((tally(&summary, "/readings"), tally(&summary, "/skipped/min_step")), (25 * 16, 24 * 16));
    let every_second: String = sample()
        .lines()
        .filter(|line| line.split(',').next().and_then(|t| t.parse::<f64>().ok()).is_none_or(|t| t % 2.0 == 0.0))
        .map(|line| format!("{line}\n"))
        .collect();
    ran.exits(0).writes(fuse_text(every_second, &["--history", "10"]).exits(0).stdout);
}

#[test]
fn drop_held_skips_repeated_values_no_echo_counting_as_one() {
    let (mut last, mut held) = (HashMap::new(), 0);
    for row in sample_rows() {
        let value = row.echo().map_or("none".to_owned(), |_| row.range.clone());
        held += u64::from(last.insert(row.sensor, value.clone()) == Some(value));
    }
    assert!(held > 100, "{held}");
    let (ran, summary) = sample_summary(&["--drop-held"]);
    ran.exits(0).says(&[&format!("{held} held")]);
    assert_eq!((tally(&summary, "/skipped/held"), tally(&summary, "/readings")), (held, 784 - held));
}

#[test]
fn empty_cells_are_readings_without_echo_in_long_tables_by_default() {
    let log = "t,sensor,range,x,y,yaw\n0,0,1,0,0,0\n0,1,,0,0,0\n1,0,,0,0,0\n";
    for (more, no_echo, empty) in [(&[][..], 2, 0), (&["--empty", "no-echo"], 2, 0), (&["--empty", "skip"], 0, 2)] {
        let args: Vec<&str> = FUSE_STDIN.iter().chain(more).copied().collect();
        let (ran, summary) = with_summary(&args, log);
        ran.exits(0);
        assert_eq!((tally(&summary, "/no_echo"), tally(&summary, "/skipped/empty")), (no_echo, empty), "{more:?}");
    }
}

#[test]
fn empty_cells_are_sensors_that_did_not_fire_in_wide_tables_by_default() {
    let ids: Vec<String> = (0..16).map(|id: i32| id.to_string()).collect();
    let log = format!("t,x,y,yaw,{}\n0,0,0,0,1{}\n", ids.join(","), ",".repeat(15));
    for (more, no_echo, empty) in [(&[][..], 0, 15), (&["--empty", "no-echo"], 15, 0), (&["--empty", "skip"], 0, 15)] {
        let args: Vec<&str> = FUSE_STDIN.iter().chain(more).copied().collect();
        let (ran, summary) = with_summary(&args, &log);
        assert_eq!(ran.exits(0).echoes().len(), 1);
        assert_eq!((tally(&summary, "/no_echo"), tally(&summary, "/skipped/empty")), (no_echo, empty), "{more:?}");
    }
}

#[test]
fn fov_counts_only_where_the_rig_has_none() {
    let scratch = Scratch::new();
    let own = fuse_sample(&[]).exits(0).stdout;
    fuse_sample(&["--fov", "10deg"]).exits(0).writes(&own);
    let rig = rig(&scratch, &["field_of_view"]);
    let bare = ["fuse", SAMPLE, "--rig", &rig];
    // 22.5 degrees by default.
    atm(bare).exits(0).writes(&own);
    let narrow = atm(bare.iter().chain(&["--fov", "10deg"])).exits(0).echoes();
    for echo in narrow.iter().filter(|echo| echo.is("center")) {
        assert_near(echo.resolution, 10_f64.to_radians() * echo.range, 1e-9);
    }
}

#[test]
fn range_resolution_beats_that_of_the_rig() {
    let echoes = fuse_sample(&["--range-resolution", "2in"]).exits(0).echoes();
    let singles: Vec<&Echo> = echoes.iter().filter(|echo| echo.is("single")).collect();
    assert!(!singles.is_empty());
    for single in singles {
        assert_near(single.resolution, 2.0 * PAPER_INTERVAL, 1e-12);
    }
    // Up to here the whole arc is no longer than the interval (Sec. IV-B: 9.50 in with 1 in).
    let close = 2.0 * PAPER_INTERVAL / BEAM;
    for echo in &echoes {
        assert_eq!(echo.is("near"), echo.range <= close, "{echo:?}");
    }
}

#[test]
fn near_echoes_are_centers_whatever_crosses_them() {
    let echoes = fuse_sample(&["--range-resolution", "10in"]).exits(0).echoes();
    let near: Vec<&Echo> = echoes.iter().filter(|echo| echo.is("near")).collect();
    assert!(near.iter().any(|echo| echo.crossings > 2));
    for echo in near {
        assert_eq!((echo.azimuth, echo.significance), (0.0, 1.0));
        assert_near(echo.resolution, BEAM * echo.range, 1e-12);
    }
}

#[test]
fn a_guessed_range_resolution_is_said_where_many_echoes_are_near() {
    let scratch = Scratch::new();
    let rig = rig(&scratch, &["range_resolution"]);
    // Below 9.50 in is near: with a quarter of the readings there, it deserves a word, with one in ten it does not.
    let log = |near: usize| {
        let range = |index: usize| if index < near { "0.2" } else { "2" };
        let rows = (0..20).map(|index| format!("{index},0,{},{index},0,0\n", range(index)));
        format!("t,sensor,range,x,y,yaw\n{}", rows.collect::<String>())
    };
    let args = ["fuse", "-", "--rig", &rig];
    atm_fed(args, log(5)).exits(0).says(&["warning", "--range-resolution", "1in"]);
    let silent = |ran: Ran| assert!(!ran.exits(0).stderr.contains("warning"));
    silent(atm_fed(args, log(2)));
    silent(atm_fed(args.iter().chain(&["--range-resolution", "1in"]), log(5)));
    silent(fuse_text(log(5), &[]));
}

/// A robot turning in place before a pole two metres off: every arc holds it, and all cross there.
#[test]
fn history_is_how_many_readings_of_a_sensor_meet() {
    let scratch = Scratch::new();
    let rig = scratch.file("one.toml", "field_of_view = \"180deg\"\n[[sensor]]\nid = \"a\"\n");
    // On a circle about the pole, 40 degrees from one reading to the next: every two cross at 40 degrees or more.
    let mut log = String::from("t,sensor,range,x,y,yaw\n");
    for t in 0..9 {
        let angle = f64::from(40 * t).to_radians();
        let (x, y) = (-2.0 * angle.cos(), -2.0 * angle.sin());
        log += &format!("{t},a,2,{x},{y},{angle}\n");
    }
    let path = scratch.name("crossings.csv");
    for history in [1, 2, 4] {
        let history_flag = history.to_string();
        let args = ["fuse", "-", "--rig", &rig, "--history", &history_flag, "--crossings", &path, "--on-none", "drop"];
        atm_fed(args, &log).exits(0);
        let ages: HashSet<u64> = read(&path)
            .lines()
            .skip(1)
            .map(|line| line.split(',').collect::<Vec<_>>())
            .map(|cells| (number(cells[0]) - number(cells[2])).abs() as u64)
            .collect();
        assert_eq!(ages, (1..history).collect(), "H = {history}");
    }
}

#[test]
fn history_is_by_travel_by_default_and_by_count_as_a_number_alone() {
    let default = fuse_sample(&[]).exits(0).stdout;
    fuse_sample(&["--history", "auto"]).exits(0).writes(&default);
    fuse_sample(&["--reach", "100in"]).exits(0).writes(&default);
    fuse_sample(&["--reach", "100in", "--history", "50"]).exits(0).writes(&default);
    let paper = fuse_sample(&["--preset", "paper"]).exits(0).stdout;
    assert!(paper != default);
    fuse_sample(&["--history", "10"]).exits(0).writes(&paper);
    for more in [&["--history", "10"][..], &["--reach", "1m"]] {
        fuse_sample(&[&["--preset", "paper"], more].concat()).exits(2).says(&["--preset"]).writes_nothing();
    }
}

/// What version 0.1 gave out by default, but for how times are written.
#[test]
fn the_papers_preset_gives_what_it_always_gave() {
    let (_, summary) = sample_summary(&["--preset", "paper"]);
    for (kind, count) in [("median", 122), ("single", 57), ("center", 442)] {
        assert_eq!(tally(&summary, &format!("/echoes/{kind}")), count, "{kind}");
    }
    assert_eq!(tally(&summary, "/ignored_pairs"), 65);
    assert_eq!(summary["map_travel_m"], serde_json::Value::Null);
    let (_, summary) = sample_summary(&[]);
    assert_near(summary["map_travel_m"].as_f64().expect("a length"), 1.25 * 51.764 * INCH, 1e-4);
}

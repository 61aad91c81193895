//! `atm fuse --crossings`: every transversal crossing.

mod support;

use std::collections::HashMap;

use support::*;

type Key = (String, String);

struct Crossing {
    arc: Key,
    other: Key,
    x: f64,
    y: f64,
    azimuth: f64,
    angle: f64,
}

/// Reads a table of crossings, and insists on its form.
fn crossings(path: &str) -> Vec<Crossing> {
    let text = read(path);
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some(CROSSINGS_HEADER));
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let [t, sensor, t_other, sensor_other, x, y, azimuth, angle] = cells[..] else {
            panic!("not eight cells: {line}");
        };
        Crossing {
            arc: (t.into(), sensor.into()),
            other: (t_other.into(), sensor_other.into()),
            x: number(x),
            y: number(y),
            azimuth: number(azimuth),
            angle: number(angle),
        }
    };
    lines.map(row).collect()
}

/// Fuses the sample: its echoes and crossings.
fn run(more: &[&str]) -> (Vec<Echo>, Vec<Crossing>) {
    let scratch = Scratch::new();
    let path = scratch.name("crossings.csv");
    let ran = fuse_sample(&["--crossings", &path]);
    // Asking for the crossings changes no echo.
    ran.exits(0).writes(fuse_sample(&[]).stdout);
    let args: Vec<&str> = ["--crossings", &path].iter().chain(more).copied().collect();
    let echoes = fuse_sample(&args).exits(0).echoes();
    (echoes, crossings(&path))
}

fn by_arc(crossings: &[Crossing]) -> HashMap<Key, usize> {
    let mut counts = HashMap::new();
    for crossing in crossings {
        *counts.entry(crossing.arc.clone()).or_default() += 1;
    }
    counts
}

#[test]
fn rows_of_an_arc_are_as_many_as_its_echo_counts_and_ignored_arcs_have_two() {
    // With 4 in, some arcs are near, some ignored, and some of both kinds are crossed.
    for more in [&[][..], &["--emit", "latest"], &["--range-resolution", "4in"], &["--min-angle", "20deg"]] {
        let (echoes, crossings) = run(more);
        let mut rows = by_arc(&crossings);
        for echo in &echoes {
            assert_eq!(rows.remove(&echo.key()).unwrap_or(0), echo.crossings, "{more:?} {echo:?}");
        }
        let echo_count = sample_rows().iter().filter(|row| row.echo().is_some()).count();
        assert_eq!(rows.len(), echo_count - echoes.len(), "{more:?}: the arcs that gave no echo");
        assert!(!rows.is_empty());
        assert!(rows.values().all(|&count| count == 2), "{more:?}: {rows:?}");
        if more.contains(&"4in") {
            assert!(echoes.iter().any(|echo| echo.is("near") && echo.crossings > 0));
        }
    }
}

#[test]
fn keep_leaves_out_echoes_but_no_crossings() {
    let (all, kept) = (run(&[]).1, run(&["--keep", "single"]).1);
    assert_eq!(all.len(), kept.len());
}

#[test]
fn every_crossing_lies_on_both_arcs_at_the_angle_it_says() {
    let rows: HashMap<Key, Row> =
        sample_rows().into_iter().map(|row| ((row.t.clone(), row.sensor.clone()), row)).collect();
    let (_, crossings) = run(&[]);
    assert!(crossings.len() > 500, "{}", crossings.len());
    for crossing in &crossings {
        let mut radii = Vec::new();
        for (index, key) in [&crossing.arc, &crossing.other].into_iter().enumerate() {
            let row = &rows[key];
            let (x, y, direction) = row.sensor_pose();
            let (dx, dy) = (crossing.x - x, crossing.y - y);
            assert_near(dx.hypot(dy), row.echo().expect("an arc"), 1e-9);
            let azimuth =
                (dy * direction.cos() - dx * direction.sin()).atan2(dx * direction.cos() + dy * direction.sin());
            assert!(azimuth.abs() <= BEAM / 2.0 + 1e-9);
            if index == 0 {
                assert_near(crossing.azimuth, azimuth, 1e-9);
            }
            radii.push((dx, dy));
        }
        let [(ax, ay), (bx, by)] = radii[..] else { unreachable!() };
        // Between two lines, not between two directions: folded to a right angle at most.
        let angle = (ax * by - ay * bx).abs().atan2((ax * bx + ay * by).abs());
        assert_near(crossing.angle, angle, 1e-9);
        assert!(angle >= 30_f64.to_radians() - 1e-9);
    }
}

#[test]
fn settled_reports_every_crossing_from_both_of_its_arcs() {
    let (_, crossings) = run(&[]);
    let mut points: HashMap<(&Key, &Key), Vec<(f64, f64)>> = HashMap::new();
    for crossing in &crossings {
        points.entry((&crossing.arc, &crossing.other)).or_default().push((crossing.x, crossing.y));
    }
    for crossing in &crossings {
        let back = points.get(&(&crossing.other, &crossing.arc)).expect("the crossing from its other arc");
        assert!(back.iter().any(|(x, y)| (x - crossing.x).hypot(y - crossing.y) < 1e-9));
    }
}

#[test]
fn latest_reports_every_crossing_once_when_its_later_arc_arrives() {
    let order: HashMap<Key, usize> =
        sample_rows().into_iter().enumerate().map(|(index, row)| ((row.t, row.sensor), index)).collect();
    let (_, latest) = run(&["--emit", "latest"]);
    assert!(latest.iter().all(|crossing| order[&crossing.other] < order[&crossing.arc]));
    assert_eq!(2 * latest.len(), run(&[]).1.len());
}

/// Sweeps, a second and 5 in apart, between the two arcs of each crossing.
fn sweeps_between(crossings: &[Crossing]) -> Vec<f64> {
    let mut sweeps: Vec<f64> =
        crossings.iter().map(|crossing| (number(&crossing.arc.0) - number(&crossing.other.0)).abs()).collect();
    sweeps.sort_by(f64::total_cmp);
    sweeps
}

#[test]
fn bounds_on_age_and_travel_leave_the_crossings_within_them_and_no_others() {
    let all = sweeps_between(&run(&[]).1);
    let cases = [
        (["--max-age", "0.5s"], 0.0),
        (["--max-age", "6s"], 6.0),
        (["--max-age", "7999ms"], 7.0),
        (["--max-age", "8"], 8.0),
        (["--max-travel", "32in"], 6.0),
        (["--max-travel", "1m"], 7.0),
    ];
    for (bound, most) in cases {
        let within: Vec<f64> = all.iter().copied().filter(|sweeps| *sweeps <= most).collect();
        assert!(within.len() < all.len());
        assert_eq!(within.is_empty(), most == 0.0, "{bound:?}: the case is to show something");
        assert_eq!(sweeps_between(&run(&bound).1), within, "{bound:?}");
    }
}

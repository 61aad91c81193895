//! What the method is for (Sec. V): the opening that cones close and medians open, on the sample log.
//!
//! The measure, in one place: of the points within 12 in of the line of the wall, the largest interval along the wall,
//! within the opening, that is free of them. The opening is 36 in wide, in a wall 70 in from the path.

mod support;

use support::*;

/// The sample's world, in metres: where along the wall the opening begins and ends, and the wall's distance.
const OPENING_START: f64 = 102.0 * INCH;
const OPENING_END: f64 = 138.0 * INCH;
const WALL_DISTANCE: f64 = 70.0 * INCH;

/// How far from the wall's line a point may lie to count as part of the wall.
const BAND: f64 = 12.0 * INCH;
/// How far beside a jamb, along the wall, a point may lie to mark it: the interval of Sec. IV-B.
const JAMB: f64 = PAPER_INTERVAL;

/// The places along the wall of the points that lie near its line.
fn on_wall(points: impl IntoIterator<Item = (f64, f64)>) -> Vec<f64> {
    let near = |(x, y): (f64, f64)| ((y - WALL_DISTANCE).abs() <= BAND).then_some(x);
    points.into_iter().filter_map(near).collect()
}

/// The largest interval of the opening that is free of points, in inches.
fn width(on_wall: &[f64]) -> f64 {
    let inside = on_wall.iter().copied().filter(|x| (OPENING_START..=OPENING_END).contains(x));
    let mut places: Vec<f64> = inside.chain([OPENING_START, OPENING_END]).collect();
    places.sort_by(f64::total_cmp);
    places.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max) / INCH
}

fn marks(on_wall: &[f64], jamb: f64) -> bool {
    on_wall.iter().any(|x| (x - jamb).abs() <= JAMB)
}

fn points(echoes: &[Echo]) -> Vec<(f64, f64)> {
    echoes.iter().map(|echo| (echo.x, echo.y)).collect()
}

/// The centre of every cone: the reading, straight ahead of its sensor.
fn centers() -> Vec<(f64, f64)> {
    let center = |row: &Row| {
        let (x, y, direction) = row.sensor_pose();
        let (sin, cos) = direction.sin_cos();
        row.echo().map(|range| (x + range * cos, y + range * sin))
    };
    sample_rows().iter().filter_map(center).collect()
}

#[test]
fn medians_and_singles_leave_the_opening_open_and_mark_both_jambs() {
    let kept = fuse_sample(&["--keep", "median,single"]).exits(0).echoes();
    let wall = on_wall(points(&kept));
    let open = width(&wall);
    println!("median,single: {open:.1} in of 36 in");
    assert!(open >= 28.0, "{open} in");
    assert!(marks(&wall, OPENING_START) && marks(&wall, OPENING_END), "{wall:?}");
}

#[test]
fn centers_of_the_cones_close_the_opening() {
    let closed = width(&on_wall(centers()));
    println!("centres of the cones: {closed:.1} in of 36 in");
    assert!(closed < 16.0, "{closed} in");
}

#[test]
fn the_measure_is_36_in_without_points_and_halved_by_one_in_the_middle() {
    let middle = (OPENING_START + OPENING_END) / 2.0;
    assert_near(width(&[]), 36.0, 1e-9);
    assert_near(width(&on_wall([(middle, WALL_DISTANCE + 11.9 * INCH)])), 18.0, 1e-9);
    assert_near(width(&on_wall([(middle, WALL_DISTANCE - 12.1 * INCH)])), 36.0, 1e-9);
}

#[test]
fn all_kinds_together_are_said_to_close_it_again() {
    for emit in ["settled", "latest"] {
        let echoes = fuse_sample(&["--emit", emit]).exits(0).echoes();
        for kinds in
            [&["median"][..], &["median", "single"], &["center"], &["median", "single", "center", "near", "pair"]]
        {
            let kept: Vec<Echo> = echoes.iter().filter(|echo| kinds.contains(&echo.kind.as_str())).cloned().collect();
            println!("{emit} {}: {:.1} in of 36 in", kinds.join(","), width(&on_wall(points(&kept))));
        }
    }
    let latest =
        |more: &[&str]| width(&on_wall(points(&fuse_sample(&[&["--emit", "latest"][..], more].concat()).echoes())));
    let (all, crossed) = (latest(&[]), latest(&["--keep", "median,single"]));
    assert!(all < crossed, "the centers of arcs without crossings stand in the opening");
    // So the command says what to keep for driving.
    assert!(atm(["fuse", "--help"]).text().contains("--keep median,single"));
}

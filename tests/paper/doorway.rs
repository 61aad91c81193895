//! The opening that cones close and medians open (Secs. II-A and III; Figs. 4 to 6, 13, 14, 16, 17).

use atm::{core::Point2, log::echo_table::Estimate};
use atm_lab::world::Gap;

use super::{
    drive::{Drive, INCH, interleaved},
    page,
    spread::{cell, median, number, percent},
};

const SEEDS: std::ops::RangeInclusive<u64> = 1..=100;
/// Openings and the wall's distances in inches, with what counts as open: the robot is 18 in wide.
const SIZES: [(f64, f64); 2] = [(36.0, 70.0), (30.0, 60.0)];
/// θmin for plain intersections: as good as none.
const NO_THRESHOLD: f64 = 1.0;

/// A way to place points.
struct Method {
    name: &'static str,
    widths: Vec<f64>,
}

/// What each method leaves of the opening, in inches, seed by seed, and in the control.
struct Measured {
    centers: Method,
    interleaved: Method,
    plain: Method,
    transversal: Method,
    all: Method,
    crossed: Method,
    medians: Method,
    closed_centers: Method,
    closed_crossed: Method,
}

impl Measured {
    fn methods(&self) -> [&Method; 9] {
        [
            &self.centers,
            &self.interleaved,
            &self.plain,
            &self.transversal,
            &self.all,
            &self.crossed,
            &self.medians,
            &self.closed_centers,
            &self.closed_crossed,
        ]
    }
}

fn width(jambs: [Point2<f64>; 2], points: &[Estimate]) -> f64 {
    let points: Vec<_> = points.iter().map(|point| point.position).collect();
    Gap::between(jambs, &points).width() / INCH
}

fn measure((opening, distance): (f64, f64)) -> Measured {
    let (opening, distance) = (format!("{opening}in"), format!("{distance}in"));
    let set = [("opening", &*opening), ("distance", &*distance)];
    let method = |name| Method { name, widths: Vec::new() };
    let mut measured = Measured {
        centers: method("centre of the cone (Fig. 6)"),
        interleaved: method("centre, robot turned by half a beam and interleaved (Fig. 5)"),
        plain: method("plain intersections (Fig. 14)"),
        transversal: method("all crossings from 30° on (Fig. 16)"),
        all: method("everything atm emits"),
        crossed: method("atm, `median` and `single`"),
        medians: method("atm, `median` (Fig. 17)"),
        closed_centers: method("control, no opening: centre of the cone"),
        closed_crossed: method("control, no opening: `median` and `single`"),
    };
    for seed in SEEDS {
        let drive = Drive::new("doorway", &set, "", seed);
        let jambs = drive.world.openings()[0].jambs;
        let fused = drive.fuse();
        let turned = Drive::with_rig("doorway", &set, "", seed, interleaved());
        let closed = Drive::new("closed-wall", &set, "", seed);
        let put = |method: &mut Method, points: &[Estimate]| method.widths.push(width(jambs, points));
        put(&mut measured.centers, &drive.centers());
        put(&mut measured.interleaved, &turned.centers());
        put(&mut measured.plain, &drive.fuse_with(10, NO_THRESHOLD).crossing_points());
        put(&mut measured.transversal, &fused.crossing_points());
        put(&mut measured.all, &fused.all());
        put(&mut measured.crossed, &fused.crossed());
        put(&mut measured.medians, &fused.medians());
        put(&mut measured.closed_centers, &closed.centers());
        put(&mut measured.closed_crossed, &closed.fuse().crossed());
    }
    measured
}

#[test]
fn medians_open_what_centres_and_plain_intersections_close() {
    let both = SIZES.map(measure);
    let open = |widths: &[f64], opening: f64| format!("{} %", number(percent(widths, |width| width >= 0.75 * opening)));
    let rows = both[0].methods().into_iter().zip(both[1].methods()).map(|(wide, narrow)| {
        vec![
            wide.name.to_owned(),
            cell(&wide.widths),
            open(&wide.widths, 36.0),
            cell(&narrow.widths),
            open(&narrow.widths, 30.0),
        ]
    });
    let header = ["points", "of 36 in, 70 in away", "27 in or more", "of 30 in, 60 in away", "22.5 in or more"];
    page::shows("doorway", &header, &rows.collect::<Vec<_>>());

    for (measured, (opening, _)) in both.iter().zip(SIZES) {
        let most = |method: &Method| method.widths.iter().copied().fold(0.0, f64::max);
        assert!(most(&measured.centers) < 0.45 * opening, "centres close it, whatever the seed");
        assert!(most(&measured.plain) < 0.35 * opening, "plain intersections fill it");
        let middle = |method: &Method| median(&method.widths) / opening;
        assert!(middle(&measured.transversal) < 0.55, "crossings alone, without a median, halve it");
        assert!(middle(&measured.all) < 0.75, "arcs without a crossing close it again");
        assert!(middle(&measured.crossed) > 0.9 && middle(&measured.medians) > 0.9, "medians and singles open it");
        assert!(percent(&measured.crossed.widths, |width| width >= 0.75 * opening) > 75.0);
        assert!(
            middle(&measured.closed_centers) < 0.2 && middle(&measured.closed_crossed) < 0.2,
            "a wall is no doorway"
        );
    }
}

#[test]
fn rotating_and_interleaving_does_not_help() {
    let (mut rows, mut middle) = (Vec::new(), Vec::new());
    for (name, rig) in [("centre of the cone", None), ("turned and interleaved", Some(interleaved()))] {
        let (mut errors, mut widths, mut points) = (Vec::new(), Vec::new(), Vec::new());
        for seed in SEEDS {
            let drive = match &rig {
                Some(rig) => Drive::with_rig("doorway", &[], "", seed, rig.clone()),
                None => Drive::new("doorway", &[], "", seed),
            };
            let centers = drive.centers();
            errors.extend(drive.azimuth_errors(&centers));
            points.push(centers.len() as f64);
            widths.push(width(drive.world.openings()[0].jambs, &centers));
        }
        middle.push((median(&errors), median(&widths)));
        rows.push(vec![name.to_owned(), number(median(&points)), cell(&errors), cell(&widths)]);
    }
    page::shows("interleaved", &["", "points", "azimuth error, in", "of the 36 in opening"], &rows);
    let [(error, width), (turned_error, turned_width)] = middle[..] else { panic!("two methods") };
    // Twice the readings: half the error, if it helped.
    assert!(turned_error > 0.8 * error, "{turned_error} in against {error} in");
    assert!(turned_width <= width, "{turned_width} in against {width} in");
}

#[test]
fn narrow_corridor_at_the_base_of_a_tee_is_found_on_the_way_through_it() {
    let (mut centers, mut crossed, mut ahead, mut none) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for seed in SEEDS {
        let mut drive = Drive::new("tee", &[], "", seed);
        let jambs = drive.world.openings()[0].jambs;
        centers.push(width(jambs, &drive.centers()));
        crossed.push(width(jambs, &drive.fuse().crossed()));
        // As far as 50 in before the base.
        drive.readings.retain(|reading| reading.robot.y >= jambs[0].y + 50.0 * INCH);
        let points: Vec<_> = drive.fuse().crossed().iter().map(|point| point.position).collect();
        let gap = Gap::between(jambs, &points);
        ahead.push(gap.width() / INCH);
        none.push((gap.free.1 - gap.free.0) / INCH);
    }
    let row = |name: &str, widths: &[f64]| vec![name.to_owned(), cell(widths)];
    let rows = [
        row("centre of the cone, all the way", &centers),
        row("`median` and `single`, all the way", &crossed),
        row("`median` and `single`, up to 50 in before the base", &ahead),
        row("the same, jambs marked or not", &none),
    ];
    page::shows("tee", &["points", "of 36 in"], &rows);
    assert!(median(&centers) < 20.0 && median(&crossed) > 32.0);
    assert!(percent(&crossed, |width| width >= 27.0) > 75.0);
}

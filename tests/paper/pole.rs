//! Equation (2) on a pole 100 in away, and how many readings it takes (Secs. IV-B and IV-D).

use atm::core::{Beam, MinAngle, RangeResolution, resolution};

use super::{
    drive::{BEAM, Drive, INCH},
    page,
    spread::{median, number, quantile},
};

/// Drives of slightly different length, so that the sweeps fall differently beside the pole: a step is 5 in.
const DRIVES: u32 = 60;

/// Errors of the echoes of all drives, in inches.
#[derive(Default)]
struct Pole {
    medians: Vec<f64>,
    singles: usize,
    errors: Vec<f64>,
    all_errors: Vec<f64>,
    /// Of each single crossing.
    crossing_errors: Vec<f64>,
}

impl Pole {
    fn measure(radius: &str, history: usize, degrees: f64) -> Self {
        let mut pole = Self::default();
        for drive in 0..DRIVES {
            let length = format!("{}in", 240.0 + f64::from(drive) * 10.0 / f64::from(DRIVES));
            let drive = Drive::new("pole", &[("length", &length), ("radius", radius)], "", 1);
            let fused = drive.fuse_with(history, degrees);
            let medians = fused.medians();
            pole.medians.push(medians.len() as f64);
            pole.singles += fused.crossed().len() - medians.len();
            pole.errors.extend(drive.azimuth_errors(&medians));
            pole.all_errors.extend(drive.azimuth_errors(&fused.crossed()));
            pole.crossing_errors.extend(drive.crossing_errors(&fused));
        }
        pole
    }
}

/// The least half-error of Sec. IV-B at an angle, in inches: half of L(θmin).
fn half_interval(degrees: f64) -> f64 {
    let angle = MinAngle::new(degrees.to_radians()).unwrap();
    resolution::interval(RangeResolution::new(INCH).unwrap(), &angle) / INCH / 2.0
}

#[test]
fn formula_gives_ten_and_a_half_fold_at_a_hundred_inches() {
    let (angle, beam) = (MinAngle::new(30f64.to_radians()).unwrap(), Beam::new(BEAM).unwrap());
    let gain = resolution::improvement(100.0 * INCH, &beam, RangeResolution::new(INCH).unwrap(), &angle).unwrap();
    // 100 · π/8 / (2 + √3).
    assert!((gain - 10.522).abs() < 5e-4, "{gain}");
    assert!((half_interval(30.0) - 1.866).abs() < 5e-4);
}

#[test]
fn half_interval_is_kept_once_enough_readings_are_and_not_with_ten() {
    let histories = [10, 11, 12, 13, 14, 16, 20];
    let measured = histories.map(|history| Pole::measure("1in", history, 30.0));
    let rows = histories.iter().zip(&measured).map(|(history, pole)| {
        vec![
            history.to_string(),
            number(median(&pole.medians)),
            number(pole.singles as f64 / f64::from(DRIVES)),
            number(quantile(&pole.errors, 0.95)),
            number(quantile(&pole.all_errors, 0.95)),
        ]
    });
    let header = ["H", "`median` in a drive", "`single`", "95 % of medians within, in", "95 % of both within, in"];
    page::shows("history", &header, &rows.collect::<Vec<_>>());
    for (history, pole) in histories.iter().zip(&measured) {
        let points = pole.all_errors.len();
        if *history < 12 {
            assert_eq!(points, 0, "H = {history}: 51.8 in take 12 readings");
            continue;
        }
        assert!(points > 100 && quantile(&pole.all_errors, 0.95) <= half_interval(30.0), "H = {history}");
        if *history >= 14 {
            assert!(median(&pole.medians) >= 5.0 && quantile(&pole.errors, 0.95) <= 1.5, "H = {history}");
        }
    }
}

#[test]
fn crossings_on_a_thin_pole_stay_within_the_interval_of_each_angle() {
    let angles = [10.0, 20.0, 30.0, 45.0, 60.0];
    let measured = angles.map(|degrees| Pole::measure("0.01in", 30, degrees));
    let most = |pole: &Pole| quantile(&pole.crossing_errors, 1.0);
    let rows = angles.iter().zip(&measured).map(|(degrees, pole)| {
        vec![
            format!("{degrees}°"),
            number(pole.crossing_errors.len() as f64 / f64::from(DRIVES)),
            number(half_interval(*degrees)),
            number(most(pole)),
            number(quantile(&pole.crossing_errors, 0.95)),
            number(median(&pole.medians)),
            number(quantile(&pole.errors, 0.95)),
        ]
    });
    let header = [
        "θmin",
        "crossings in a drive",
        "L / 2, in",
        "all crossings within, in",
        "95 % within, in",
        "`median` in a drive",
        "95 % of medians within, in",
    ];
    page::shows("pole", &header, &rows.collect::<Vec<_>>());
    for (degrees, pole) in angles.iter().zip(&measured) {
        // The rhombus of Sec. IV-B is an approximation: bands of arcs are bent.
        assert!(most(pole) <= 1.03 * half_interval(*degrees), "{degrees}°: {}", most(pole));
        assert!(most(pole) > 0.7 * half_interval(*degrees), "{degrees}°: {}", most(pole));
    }
    for (pair, degrees) in measured.windows(2).zip(&angles[1..]) {
        assert!(pair[1].crossing_errors.len() < pair[0].crossing_errors.len(), "fewer at {degrees}°");
        assert!(
            quantile(&pair[1].crossing_errors, 0.95) < quantile(&pair[0].crossing_errors, 0.95),
            "finer at {degrees}°"
        );
    }
}

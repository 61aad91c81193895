//! The median holds as long as fewer than half of an arc's crossings are bad (Sec. III-B).

use atm::core::Kind;
use atm_lab::truth::Cause;

use super::{
    drive::{Drive, INCH, ring},
    page,
    spread::{cell, number, percent},
};

const SEEDS: std::ops::RangeInclusive<u64> = 1..=40;
/// Long enough for many crossings on each arc.
const HISTORY: usize = 30;
/// Reach of the sensors, in inches: false readings are drawn from all of it, and are to cross the true ones.
const REACH: f64 = 75.0;
/// The bad share of an arc's crossings, in tenths, up to which each row of the table counts.
const CLASSES: [(f64, f64, &str); 5] = [
    (0.0, 0.0, "none"),
    (0.0, 0.25, "up to 25 %"),
    (0.25, 0.5, "25 % to below half"),
    (0.5, 0.75, "half to 75 %"),
    (0.75, 1.0, "more"),
];

/// An arc whose reading is true, with its crossings by whether their other arcs are.
struct Arc {
    bad_share: f64,
    /// How far the median lies from the true echo point, in inches.
    error: f64,
    /// Whether it lies among the good crossings.
    held: bool,
}

/// Arcs on a pole among readings of which some are another sensor's sound.
fn arcs(crosstalk: &str) -> Vec<Arc> {
    let mut found = Vec::new();
    for seed in SEEDS {
        let set = [("path", "weaving"), ("distance", "60in"), ("rate", "4Hz"), ("radius", "0.1in")];
        let drive = Drive::with_rig("pole", &set, &format!("crosstalk={crosstalk}"), seed, ring(16, REACH * INCH));
        let fused = drive.fuse_with(HISTORY, 30.0);
        let is_true = |t, sensor| drive.source(t, sensor).is_some_and(|source| source.cause == Cause::Pole);
        let by_arc = fused.by_arc();
        for echo in fused.echoes.iter().filter(|echo| echo.kind == Kind::Median && is_true(echo.t, echo.sensor)) {
            let crossings = &by_arc[&(echo.t, echo.sensor)];
            let azimuths = |good: bool| {
                let chosen =
                    crossings.iter().filter(move |crossing| is_true(crossing.t_other, crossing.sensor_other) == good);
                chosen.map(|crossing| crossing.bearing.azimuth()).collect::<Vec<_>>()
            };
            let (good, bad) = (azimuths(true), azimuths(false));
            let truth = drive.source(echo.t, echo.sensor).unwrap().azimuth;
            let (low, high) = good.iter().fold((f64::MAX, f64::MIN), |(low, high), at| (low.min(*at), high.max(*at)));
            found.push(Arc {
                bad_share: bad.len() as f64 / (good.len() + bad.len()) as f64,
                error: (echo.azimuth() - truth).abs() * echo.range / INCH,
                held: (low - 1e-12..=high + 1e-12).contains(&echo.azimuth()),
            });
        }
    }
    found
}

#[test]
fn median_holds_below_half_bad_crossings() {
    let arcs: Vec<Arc> = ["5%", "30%", "60%", "75%"].into_iter().flat_map(arcs).collect();
    let class = |(above, up_to, _): (f64, f64, &str)| {
        arcs.iter().filter(move |arc| match up_to {
            0.0 => arc.bad_share == 0.0,
            0.5 => arc.bad_share > above && arc.bad_share < up_to,
            0.75 => arc.bad_share >= above && arc.bad_share <= up_to,
            _ => arc.bad_share > above && arc.bad_share <= up_to,
        })
    };
    let rows = CLASSES.map(|bounds| {
        let held: Vec<f64> = class(bounds).map(|arc| f64::from(u8::from(arc.held))).collect();
        let errors: Vec<f64> = class(bounds).map(|arc| arc.error).collect();
        vec![
            bounds.2.to_owned(),
            held.len().to_string(),
            format!("{} %", number(percent(&held, |held| held > 0.5))),
            cell(&errors),
        ]
    });
    page::shows(
        "contamination",
        &["bad crossings on the arc", "arcs", "median among the good ones", "azimuth error, in"],
        &rows,
    );

    assert!(arcs.iter().filter(|arc| arc.bad_share < 0.5).all(|arc| arc.held), "below half it always holds");
    let beyond: Vec<&Arc> = arcs.iter().filter(|arc| arc.bad_share > 0.5).collect();
    assert!(
        beyond.len() > 50 && beyond.iter().filter(|arc| !arc.held).count() * 4 > beyond.len(),
        "and beyond it often not"
    );
    let contaminated: Vec<f64> = class(CLASSES[2]).map(|arc| arc.error).collect();
    assert!(contaminated.len() > 100 && percent(&contaminated, |error| error <= 1.9) > 80.0);
}

//! The median with weights, with each partner counted once, and at lower angles: what was tried, and is not built.

use std::collections::HashMap;

use atm::{
    core::{
        Bounds, Crossing, Estimator, Fuser, MinAngle, Partners, Point2, ReportedArc, UnitComplex, Verdict, crossings,
        resolution,
    },
    storage::SettledSlots,
};

use crate::{
    drive::{CASES, Disturbance, Drive, INCH},
    number,
    score::quantile,
};

/// A median of crossings that weigh more the steeper they are.
#[derive(Clone, Copy)]
struct Weighted {
    name: &'static str,
    min_angle_deg: f64,
    /// sin²θ/(1 + cos²θ), the inverse of a crossing's variance along the arc, instead of 1.
    steep_count_more: bool,
    /// The crossings with one partner weigh 1 together.
    distinct_partners: bool,
}

const fn plain(name: &'static str, min_angle_deg: f64) -> Weighted {
    Weighted { name, min_angle_deg, steep_count_more: false, distinct_partners: false }
}

const VARIANTS: [Weighted; 7] = [
    plain("the paper's, 30°", 30.0),
    Weighted { distinct_partners: true, ..plain("distinct partners, 30°", 30.0) },
    Weighted { steep_count_more: true, ..plain("weights, 30°", 30.0) },
    Weighted { steep_count_more: true, ..plain("weights, 20°", 20.0) },
    plain("no weights, 20°", 20.0),
    Weighted { steep_count_more: true, ..plain("weights, 10°", 10.0) },
    plain("no weights, 10°", 10.0),
];

/// A median or a single.
#[derive(Clone, Copy)]
struct Found {
    reading: (i64, u16),
    azimuth: f64,
    range: f64,
    position: Point2<f64>,
    /// What lies within the paper's interval of it: more is surer.
    mass: f64,
}

impl Estimator<f64> for Weighted {
    type Echo = Found;

    fn estimate(
        &self,
        arc: &ReportedArc<f64>,
        partners: &Partners<'_, f64>,
        _scratch: &mut [f64],
        _visit: impl FnMut(usize, &Crossing<f64>),
    ) -> Verdict<Found> {
        let min_angle = MinAngle::new(self.min_angle_deg.to_radians()).expect("an angle");
        let mut found: Vec<(f64, f64, usize)> = Vec::new();
        partners.for_each_transversal(&arc.arc, &min_angle, |slot, other| {
            crossings(&arc.arc, other, &min_angle, |crossing| {
                let (sin, cos) = crossing.angle().sin_cos();
                let weight = if self.steep_count_more { sin * sin / (1.0 + cos * cos) } else { 1.0 };
                found.push((crossing.bearing().azimuth(), weight, slot));
            });
        });
        let mut count = found.len();
        if self.distinct_partners {
            let mut of_partner: HashMap<usize, f64> = HashMap::new();
            for (.., slot) in &found {
                *of_partner.entry(*slot).or_default() += 1.0;
            }
            count = of_partner.len();
            for (_, weight, slot) in &mut found {
                *weight /= of_partner[slot];
            }
        }
        // As in Sec. III-B and IV-B.
        let interval = resolution::interval(arc.range_resolution, &MinAngle::PAPER);
        if count == 0 || count == 2 || arc.arc_length() <= interval {
            return Verdict::Ignored(count as u32);
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let azimuth = weighted_median(&found);
        let half = interval / arc.arc.radius() / 2.0;
        let near = found.iter().filter(|(place, ..)| (place - azimuth).abs() <= half);
        let turn = UnitComplex::new(azimuth);
        Verdict::Echo(Found {
            reading: (arc.t, arc.sensor),
            azimuth,
            range: arc.arc.radius(),
            position: arc.arc.sensor() + turn * (arc.arc.middle() - arc.arc.sensor()),
            mass: near.map(|(_, weight, _)| weight).sum(),
        })
    }
}

/// Half of the weight lies on either side; the mean of two places where it is exactly half. Of at least one, in order.
fn weighted_median(found: &[(f64, f64, usize)]) -> f64 {
    let half = found.iter().map(|(_, weight, _)| weight).sum::<f64>() / 2.0;
    let place = |beyond: f64| {
        let mut sum = 0.0;
        let reached = found.iter().find(|(_, weight, _)| {
            sum += weight;
            sum >= half * beyond
        });
        reached.or(found.last()).map_or(0.0, |(azimuth, ..)| *azimuth)
    };
    (place(1.0 - 1e-12) + place(1.0 + 1e-12)) / 2.0
}

/// Error along the arc and distance to the nearest surface, in inches, the surest first.
struct Scored {
    mass: f64,
    error: Option<f64>,
    surface: f64,
}

fn score(drive: &Drive, variant: Weighted) -> Vec<Scored> {
    let storage = SettledSlots::new(16, 10).expect("a small local map");
    let mut fuser = Fuser::settled(variant, Bounds::NONE, storage);
    let mut found = HashMap::new();
    let mut sink = |echo: &Found| {
        found.insert(echo.reading, *echo);
    };
    for heard in &drive.heard {
        fuser.push(&heard.reading, &mut sink).expect("readings in order");
    }
    fuser.finish(&mut sink);
    let scored = |heard: &crate::drive::Heard| {
        let found = found.get(&(heard.reading.t, heard.reading.sensor))?;
        let error = heard.truth.map(|truth| (found.azimuth - truth.azimuth).abs() * found.range / INCH);
        Some(Scored { mass: found.mass, error, surface: drive.world.distance(found.position) / INCH })
    };
    drive.heard.iter().filter_map(scored).collect()
}

/// Prints a table: each variant's own coverage, and as many of its surest as the paper's has.
pub fn print(title: &str, seeds: std::ops::Range<u64>, disturbance: &Disturbance) {
    println!("### The median with weights: {title}\n");
    println!("| | medians and singles | error 50 / 90 % | ghosts | as many as the paper's: 50 / 90 % |");
    println!("|---|---|---|---|---|");
    let cases = CASES.iter().filter(|case| !case.name.starts_with("pole"));
    let drives: Vec<Vec<Drive>> =
        cases.map(|case| seeds.clone().map(|seed| Drive::new(case, seed, disturbance)).collect()).collect();
    let mut papers: Vec<usize> = Vec::new();
    for variant in VARIANTS {
        let (mut all, mut equal) = (Vec::new(), Vec::new());
        let mut ghosts = 0;
        for (number, drives) in drives.iter().enumerate() {
            let mut scored: Vec<Scored> = drives.iter().flat_map(|drive| score(drive, variant)).collect();
            scored.sort_by(|a, b| b.mass.total_cmp(&a.mass));
            if papers.len() == number {
                papers.push(scored.len());
            }
            ghosts += scored.iter().filter(|scored| scored.surface > 6.0).count();
            equal.extend(scored.iter().take(papers[number]).filter_map(|scored| scored.error));
            all.extend(scored);
        }
        let errors: Vec<f64> = all.iter().filter_map(|scored| scored.error).collect();
        let spread = |errors: &[f64]| [0.5, 0.9].map(|share| number(quantile(errors.to_vec(), share))).join(" / ");
        println!(
            "| {} | {} | {} in | {:.1} % | {} in |",
            variant.name,
            all.len(),
            spread(&errors),
            100.0 * ghosts as f64 / all.len().max(1) as f64,
            spread(&equal)
        );
    }
    println!();
}

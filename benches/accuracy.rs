//! The tables of `docs/accuracy.md`: the consensus beside the median, on simulated drives. `cargo bench --bench accuracy`.
//!
//! The seeds are neither those it was tuned on nor those of the tests. Takes a minute or two.
#[path = "../tests/consensus/drive.rs"]
mod drive;
#[path = "../tests/consensus/score.rs"]
mod score;
#[path = "accuracy/weighted.rs"]
mod weighted;

use std::ops::Range;

use atm::core::{Consensus, Reflector};

use crate::{
    drive::{CASES, Disturbance, INCH},
    score::{Scored, Table, When, errors, ghosts, quantile, usual},
};

/// Drives of every case.
const SEEDS: Range<u64> = 2001..2031;

/// Detours and other sensors' sound.
fn disturbed() -> Disturbance {
    Disturbance { multipath: 0.15, crosstalk: 0.05, ..Disturbance::default() }
}

fn main() {
    let clean = Disturbance::default();
    println!("{} drives of each case, seeds {} to {}\n", SEEDS.count(), SEEDS.start, SEEDS.end - 1);
    print("Exact poses, ranges in whole inches, settled", &clean, usual(), When::Settled);
    print("The same, latest", &clean, usual(), When::Latest);
    print("15 % detours, 5 % crosstalk, settled", &disturbed(), usual(), When::Settled);
    let noisy = Disturbance { effects: "range=0.3in,odometry=0.5cm".parse().expect("effects"), ..clean };
    let told = usual().with_range_error(0.35 * INCH).expect("an error");
    print(
        "Ranges wrong by 0.3 in, odometry by 0.5 cm a metre, and the consensus told of 0.35 in, settled",
        &noisy,
        told,
        When::Settled,
    );
    print("The same, and the consensus told of nothing", &noisy, usual(), When::Settled);
    weighted::print("clean", SEEDS, &clean);
    weighted::print("15 % detours, 5 % crosstalk", SEEDS, &disturbed());
    curve("Clean", &clean);
    curve("15 % detours, 5 % crosstalk", &disturbed());
}

fn print(title: &str, disturbance: &Disturbance, estimator: Consensus<f64>, when: When) {
    println!("### {title}\n");
    println!(
        "| | echoes | ATM resolves | consensus | equal: ATM 50 / 90 % | consensus | ratios | ghosts of ATM / consensus | points in their ellipse | walls | openings within 3 in |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    let mut kinds = [(0.0, 0.0); 2];
    let mut ghost_counts = [0.0; 3];
    for case in &CASES {
        let table = Table::new(case, SEEDS, disturbance, estimator, when);
        let (atm, consensus) = table.equal();
        let spread = |scored: &[Scored]| [0.5, 0.9].map(|share| quantile(errors(scored), share));
        let (a, c) = (spread(atm), spread(consensus));
        for (total, scored) in ghost_counts.iter_mut().zip([atm, consensus]) {
            *total += ghosts(scored) * scored.len() as f64;
        }
        ghost_counts[2] += atm.len() as f64;
        let mut cells = Vec::new();
        for (kind, total) in [Reflector::Point, Reflector::Wall].into_iter().zip(&mut kinds) {
            let (count, share) = table.calibration(kind);
            if count > 0 {
                *total = (total.0 + count as f64, total.1 + count as f64 * share);
            }
            cells.push(if count > 0 { format!("{:.1} % of {count}", 100.0 * share) } else { "–".into() });
        }
        let row = [
            case.name.to_owned(),
            table.echoes.to_string(),
            table.atm.len().to_string(),
            table.consensus.len().to_string(),
            format!("{} / {} in", number(a[0]), number(a[1])),
            format!("{} / {} in", number(c[0]), number(c[1])),
            format!("{} / {}", number(c[0] / a[0]), number(c[1] / a[1])),
            format!("{:.2} / {:.2} %", 100.0 * ghosts(atm), 100.0 * ghosts(consensus)),
            cells.join(" | "),
            openings(&table),
        ];
        println!("| {} |", row.join(" | "));
        walls(&table);
    }
    let share = |(all, inside): (f64, f64)| 100.0 * inside / all;
    println!(
        "\nAll points {:.1} %, all walls {:.1} % in their 95 % ellipse. Ghosts at equal coverage: {} and {} of {}.\n",
        share(kinds[0]),
        share(kinds[1]),
        ghost_counts[0].round(),
        ghost_counts[1].round(),
        ghost_counts[2]
    );
}

fn number(value: f64) -> String {
    if value.is_nan() { "–".into() } else { format!("{value:.2}") }
}

/// Of each method, as `found/drives`.
fn openings(table: &Table) -> String {
    let cell = |excess: &Vec<f64>| {
        format!("{}/{}", excess.iter().filter(|excess| excess.abs() <= 3.0 * INCH).count(), excess.len())
    };
    if table.openings.iter().all(Vec::is_empty) { "–".into() } else { table.openings.each_ref().map(cell).join(", ") }
}

/// Where walls stand and how they are turned, on standard error beside the table.
fn walls(table: &Table) {
    let (surface, tilt): (Vec<f64>, Vec<f64>) =
        table.walls().map(|wall| (wall.surface / INCH, wall.tilt.to_degrees())).unzip();
    if !surface.is_empty() {
        eprintln!(
            "  {} walls: to the surface 95 % {:.2} in, most {:.2} in; normal 95 % {:.2}, most {:.2} deg",
            surface.len(),
            quantile(surface.clone(), 0.95),
            quantile(surface, 1.0),
            quantile(tilt.clone(), 0.95),
            quantile(tilt, 1.0)
        );
    }
}

/// Coverage, error and ghosts by the least confidence, over all cases but the poles.
fn curve(title: &str, disturbance: &Disturbance) {
    println!("### By confidence: {title}\n");
    println!("| least confidence | resolved of echoes | azimuth error 50 / 90 % | ghosts |");
    println!("|---|---|---|---|");
    let mut atm = (0, 0, Vec::new(), 0.0);
    for confidence in [0.3, 0.5, 0.7, 0.8, 0.9, 0.95, 0.98, 0.99, 0.999] {
        let (mut echoes, mut resolved, mut all, mut ghost) = (0, 0, Vec::new(), 0.0);
        atm = (0, 0, Vec::new(), 0.0);
        for case in CASES.iter().filter(|case| !case.name.starts_with("pole")) {
            let estimator = usual().with_min_confidence(confidence).expect("a share");
            let table = Table::new(case, SEEDS.start..SEEDS.start + 10, disturbance, estimator, When::Settled);
            echoes += table.echoes;
            resolved += table.consensus.len();
            all.extend(errors(&table.consensus));
            ghost += ghosts(&table.consensus) * table.consensus.len() as f64;
            atm.0 += table.echoes;
            atm.1 += table.atm.len();
            atm.2.extend(errors(&table.atm));
            atm.3 += ghosts(&table.atm) * table.atm.len() as f64;
        }
        row(&format!("{confidence}"), echoes, resolved, all, ghost);
    }
    row("ATM, medians and singles", atm.0, atm.1, atm.2, atm.3);
    println!();
}

fn row(name: &str, echoes: usize, resolved: usize, errors: Vec<f64>, ghosts: f64) {
    let [half, most] = [0.5, 0.9].map(|share| quantile(errors.clone(), share));
    let (coverage, ghosts) = (100.0 * resolved as f64 / echoes as f64, 100.0 * ghosts / resolved.max(1) as f64);
    println!("| {name} | {coverage:.0} % | {half:.2} / {most:.2} in | {ghosts:.2} % |");
}

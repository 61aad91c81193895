//! Coverage against cleanliness: what is left of a method when only its surest points are kept.

use atm::core::Point2;
use atm_lab::{
    compare::{Name, Outcome},
    eval::{Estimate, Judge},
};

use crate::{
    drive::Driven,
    table::{Table, headings},
};

/// Of a method's points the surest shares that are kept.
const KEPT: [f64; 4] = [1.0, 0.5, 0.25, 0.1];
/// The worlds it is measured in: those with rough surfaces, edges and corners.
const WORLDS: [&str; 4] = ["doorway", "room", "rough-wall", "corners"];

/// For each share of [`KEPT`] the points, the ghosts among them and the coverage; `None` of a method that does not say how sure it is.
pub type Curve = [Option<(f64, f64, f64)>; KEPT.len()];

/// The curve of one method on one drive.
pub fn of(said: &Outcome, judge: &Judge<'_>) -> Curve {
    KEPT.map(|share| {
        let all = judge.scores(&surest(said, share)?).all;
        Some((all.points as f64, all.ghosts as f64, all.coverage.unwrap_or(0.0)))
    })
}

/// So many of a method's points: those that are least likely accidents, or its strongest cells.
fn surest(said: &Outcome, share: f64) -> Option<Vec<Estimate>> {
    let all = said.estimates.as_ref()?;
    let count = (all.len() as f64 * share).round() as usize;
    Some(match (&said.significances, &said.evidence) {
        _ if share >= 1.0 => all.clone(),
        (Some(significances), _) => {
            let mut surest: Vec<(&f64, &Estimate)> = significances.iter().zip(all).collect();
            surest.sort_by(|a, b| a.0.total_cmp(b.0));
            surest.into_iter().take(count).map(|(_, estimate)| estimate.clone()).collect()
        }
        (None, Some(evidence)) => {
            let mut cells: Vec<_> =
                evidence.grid.cells().filter(|(_, value)| *value > evidence.occupied_above).collect();
            cells.sort_by(|a, b| b.1.total_cmp(&a.1));
            cells.into_iter().take(count).map(|(cell, _)| anonymous(evidence.grid.center(cell))).collect()
        }
        (None, None) => return None,
    })
}

fn anonymous(position: Point2<f64>) -> Estimate {
    Estimate { position, key: None, azimuth: None, range: None, kind: None }
}

/// Over the points of all drives together, and the mean of their coverage.
pub fn table(driven: &[Driven]) -> Table {
    let curves: Vec<&[Curve]> = driven
        .iter()
        .filter(|driven| WORLDS.contains(&driven.world))
        .flat_map(|driven| &driven.drives)
        .map(|drive| drive.curve.as_slice())
        .collect();
    let cell = |method: usize, kept: usize| {
        let (mut points, mut ghosts, mut coverage, mut count) = (0.0, 0.0, 0.0, 0.0);
        for (all, ghostly, covered) in curves.iter().filter_map(|curve| *curve.get(method)?.get(kept)?) {
            (points, ghosts, coverage, count) = (points + all, ghosts + ghostly, coverage + covered, count + 1.0);
        }
        (points > 0.0).then(|| format!("{:.2} / {:.0}", 100.0 * ghosts / points, 100.0 * coverage / count))
    };
    let row = |(method, name): (usize, &Name)| {
        let cells: Vec<Option<String>> = (0..KEPT.len()).map(|kept| cell(method, kept)).collect();
        let filled = cells.iter().any(Option::is_some);
        let cells = cells.into_iter().map(|cell| cell.unwrap_or_else(|| "-".to_owned()));
        filled.then(|| [name.word().to_owned()].into_iter().chain(cells).collect())
    };
    Table {
        name: "curve",
        title: "The surest points alone: ghosts, % of them / coverage, %",
        header: headings(&["", "all", "half", "a quarter", "a tenth"]),
        words: 1,
        rows: Name::ALL.iter().enumerate().filter_map(row).collect(),
    }
}

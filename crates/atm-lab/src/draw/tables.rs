//! What of points in tables and recordings can be drawn: a layer for each kind.
use std::collections::BTreeSet;

use atm::{
    error::Result,
    log::{crossing_log::CrossingLog, echo_log::EchoLog, echo_table::EchoTable},
    summary::Dropped,
};
use atm_core::Point2;

use super::{drive::Key, scene::Scene};
use crate::thinned::Thinned;

/// Most kinds that are layers of their own; points of further kinds are drawn together.
const MOST_KINDS: usize = 32;
/// The layer of points without a kind, and of those that are too many kinds.
const POINTS: &str = "points";

/// The layers of a log of echoes: one for each kind, in the order in which they turn up, and a ring around the point of the
/// reading that is `shown`.
///
/// # Errors
/// It can't be read on.
pub fn echoes(mut echoes: EchoLog, shown: Option<&Key>, dropped: &mut Dropped) -> Result<Scene> {
    let mut kinds: Vec<(String, Thinned<Point2<f64>>)> = Vec::new();
    let mut ring = None;
    while let Some(estimate) = echoes.next_estimate(&mut |problem| dropped.add(problem))? {
        let kind = estimate.kind.as_deref().unwrap_or(POINTS);
        let index = match kinds.iter().position(|(known, _)| known == kind) {
            Some(index) => index,
            None if kinds.len() < MOST_KINDS => {
                kinds.push((kind.to_owned(), Thinned::new()));
                kinds.len() - 1
            }
            None => kinds.iter().position(|(known, _)| known == POINTS).unwrap_or(0),
        };
        if let Some((kind, points)) = kinds.get_mut(index) {
            points.push(estimate.position);
            if estimate.key.is_some() && estimate.key.as_ref() == shown {
                ring = Some((kind.clone(), estimate.position));
            }
        }
    }
    let mut scene = Scene::new();
    for (kind, points) in kinds {
        scene.marks(&kind, points.iter().copied());
    }
    if let Some((kind, point)) = ring {
        scene.rings(&kind, [point]);
    }
    Ok(scene)
}

/// The layer `truth` of a truth file.
///
/// # Errors
/// The table can't be read on.
pub fn truth(mut table: EchoTable, dropped: &mut Dropped) -> Result<Scene> {
    let mut points = Thinned::new();
    while let Some(estimate) = table.next_estimate(&mut |problem| dropped.add(problem))? {
        points.push(estimate.position);
    }
    let mut scene = Scene::new();
    scene.marks("truth", points.iter().copied());
    Ok(scene)
}

/// The layer `crossings` of a log of crossings, and the readings whose arcs cross the one that is `shown`.
///
/// # Errors
/// It can't be read on.
pub fn crossings(
    mut crossings: CrossingLog,
    shown: Option<&Key>,
    dropped: &mut Dropped,
) -> Result<(Scene, BTreeSet<Key>)> {
    let (mut points, mut partners) = (Thinned::new(), BTreeSet::new());
    while let Some(crossing) = crossings.next_crossing(&mut |problem| dropped.add(problem))? {
        points.push(crossing.position);
        if Some(&crossing.on) == shown {
            partners.insert(crossing.with);
        }
    }
    let mut scene = Scene::new();
    scene.marks("crossings", points.iter().copied());
    Ok((scene, partners))
}

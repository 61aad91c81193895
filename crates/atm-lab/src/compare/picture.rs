//! One method as a scene.

use atm::error::{Error, Result};

use super::{recording::Recording, run::Outcome};
use crate::{
    baseline::Evidence,
    draw::{Grid, Scene},
    map::Cell,
    world::World,
};

/// Most cells of a map that are drawn.
const MOST_CELLS: usize = 1 << 22;

/// The walls where they are known, the path, and what the method says.
///
/// # Errors
/// A map that is too large to be drawn.
pub fn scene(outcome: &Outcome, recording: &Recording, world: Option<&World>) -> Result<Scene> {
    let mut scene = Scene::new();
    if let Some(evidence) = &outcome.evidence {
        scene.grid(cells(evidence)?);
    }
    if let Some(world) = world {
        scene.extend(&Scene::of_world(world));
    }
    scene.path(recording.path());
    if !outcome.segments.is_empty() {
        scene.segments(outcome.name.word(), outcome.segments.iter().copied());
    }
    // The points of a grid are its cells, and those along a segment only score it.
    let points = outcome.estimates.iter().flatten();
    if outcome.evidence.is_none() {
        let shown = points.filter(|one| outcome.segments.is_empty() || one.key.is_some());
        scene.marks(outcome.name.word(), shown.map(|one| one.position));
    }
    Ok(scene)
}

/// The occupied cells of a map in black.
///
/// # Errors
/// More than four million cells in the rectangle around them.
pub fn cells(evidence: &Evidence) -> Result<Grid> {
    let grid = &evidence.grid;
    let occupied = || grid.cells().filter(|(_, value)| *value > evidence.occupied_above).map(|(cell, _)| cell);
    let low_row = occupied().map(|cell| cell.row).min().unwrap_or(0);
    let low_column = occupied().map(|cell| cell.column).min().unwrap_or(0);
    let height = occupied().map(|cell| cell.row.abs_diff(low_row)).max().map_or(0, |last| last as usize + 1);
    let width = occupied().map(|cell| cell.column.abs_diff(low_column)).max().map_or(0, |last| last as usize + 1);
    if height.saturating_mul(width) > MOST_CELLS {
        return Err(Error::Map { message: format!("a map of {width} x {height} cells is too large to be drawn") });
    }
    let mut values = vec![0.0; height * width];
    for cell in occupied() {
        let place = cell.row.abs_diff(low_row) as usize * width + cell.column.abs_diff(low_column) as usize;
        if let Some(value) = values.get_mut(place) {
            *value = 1.0;
        }
    }
    let corner = grid.corner(Cell { row: low_row, column: low_column });
    Ok(Grid { corner, cell: grid.resolution(), columns: width, values })
}

//! How good the points of a method are, where the world is known: errors, coverage, ghosts, and what is left of a doorway.
//!
//! Every length with a role has a name: a point within [`COVERED`] covers a piece of surface, one farther than [`GHOST`] from
//! every surface is a ghost, and one within [`crate::world::DOORWAY_DEPTH`] of the line between two jambs stands in the opening.
mod nearness;
mod observable;
mod scores;
mod spread;
pub mod views;

pub use self::{
    observable::{COVERED, Observable},
    scores::{GHOST, Judge, Metrics, Scores, evaluate},
    spread::Spread,
};
pub use atm::log::echo_table::Estimate;

#[cfg(test)]
mod tests;

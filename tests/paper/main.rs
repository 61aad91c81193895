//! The claims of the paper, each over many fixed seeds, and the tables of docs/paper.md that show them.
//!
//! The bounds in the assertions are wider than what was measured, and narrower than what a broken threshold, median or beam
//! test gives. Lengths are inches, as in the paper.

mod angle;
mod contamination;
mod doorway;
mod drive;
mod page;
mod pole;
mod rates;
mod spread;
mod walls;

//! What proves and shows the arc-transversal median: worlds and a simulator of beams in them, the other methods and their maps,
//! scores where the world is known, the comparison, and pictures.
// `!(x <= limit)` is how a guard is written here: it holds for NaN too.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

pub mod baseline;
pub mod compare;
pub mod draw;
pub mod eval;
pub mod map;
pub mod simulate;
pub mod thinned;
pub mod truth;
pub mod view;
pub mod world;

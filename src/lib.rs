//! Sharp echo points from wide-beam range sensors on a moving robot: the arc-transversal median
//! (Choset, Nagatani, Lazar 2003), on logs.
// `!(x <= limit)` is how a guard is written here: it holds for NaN too.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

pub use atm_core as core;

pub mod diagnose;
pub mod echo;
pub mod error;
pub mod intake;
pub mod job;
pub mod log;
pub mod pipeline;
pub mod rig;
mod sample;
pub mod stamp;
pub mod storage;
pub mod style;
pub mod summary;
pub mod survey;
pub mod toml_document;
pub mod track;
pub mod units;

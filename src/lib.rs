//! Sharp echo points from wide-beam range sensors on a moving robot: the arc-transversal median
//! (Choset, Nagatani, Lazar 2003), on logs.
pub use atm_core as core;

pub mod error;
pub mod log;
pub mod rig;
pub mod stamp;
pub mod storage;
pub mod track;
pub mod units;
pub mod world;
pub mod pipeline;
pub mod summary;
pub mod survey;

//! How good the points of a method are, where the world is known.
pub mod doorway;
mod spread;

pub use self::spread::Spread;
pub use crate::log::echo_table::Estimate;

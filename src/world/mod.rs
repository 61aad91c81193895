//! Worlds to make readings in.
pub mod rough;

//! One file a command, each a thin adapter over the library.

pub mod draw;
pub mod eval;
pub mod fuse;
pub mod info;
pub mod plan;
pub mod simulate;

//! What has to hold for any input: one module for each target of the same name.
//!
//! Each `check` panics where something does not hold. They are plain functions, so that a finding can be replayed in a debugger.

pub mod csv;
pub mod echoes;
pub mod fuser;
pub mod layouts;
pub mod mcap;
pub mod messages;
pub mod pieces;
pub mod poses;
pub mod rig;
pub mod text;
pub mod unpacked;
pub mod world;

//! Rough walls

//! poses

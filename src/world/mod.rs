//! Worlds to make readings in: walls, what a beam hears of them, and the logs of drives past them.
//!
//! A world answers one question: which point does this beam hear first, and why that one. Rounding and range limits come
//! after it, so that the true point stays known.
pub mod rough;

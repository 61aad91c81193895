//! The methods that the arc-transversal median is weighed against (Sec. II), each written anew from its publication.
//!
//! A [`Method`] takes the readings of a log one after another and says at its end where it believes something to be: as points, as
//! straight segments, or as a grid whose cells hold evidence. `docs/methods.md` has the formulas, the sources, and what came of
//! measuring them.
// `!(x <= limit)` is how a guard is written here: it holds for NaN too.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

mod arc_map;
mod centerline;
mod circles;
mod directional_maximum;
mod elfes;
mod finding;
mod himm;
mod history;
mod interleave;
mod intersections;
mod mckerrow;
mod moravec_elfes;
mod morphology;
mod range_layer;
mod rcd;
mod sight;
mod tbf;
mod uniform;
mod voting;

use atm_core::Reading;

pub use self::{
    centerline::Centerline,
    directional_maximum::DirectionalMaximum,
    elfes::Elfes,
    finding::{Evidence, Findings, Mark, Segment},
    himm::Himm,
    interleave::{Interleave, interleaved},
    intersections::Intersections,
    mckerrow::CommonTangents,
    moravec_elfes::MoravecElfes,
    morphology::Morphology,
    range_layer::RangeLayer,
    rcd::{ConstantDepth, Depth, regions},
    sight::Sight,
    tbf::TriangulationFusion,
    uniform::UniformArcs,
    voting::Voting,
};
use atm::error::Result;

/// H of the methods that remember readings: as in the local map of the paper (Sec. IV-D).
pub const HISTORY: usize = 10;
/// Width of the cells of the grid methods that don't come with their own, in metres.
pub const CELL: f64 = 0.05;
/// Most readings that a method which needs them all at its end remembers.
const MOST_READINGS: usize = 1 << 22;

/// A way from readings to where things are.
pub trait Method {
    /// Takes the next reading, in the order of the log.
    ///
    /// # Errors
    /// What the method has to remember grows beyond its bound.
    fn take(&mut self, reading: &Reading<f64>) -> Result<()>;

    /// The clock was set back: what comes next was not seen together with what came before.
    fn clock_reset(&mut self) {}

    /// What the method found. `None` where it does not apply to this log at all, such as to a robot that never turned in place.
    ///
    /// # Errors
    /// As [`Method::take`].
    fn finish(self: Box<Self>) -> Result<Option<Findings>>;
}

#[cfg(test)]
mod tests;

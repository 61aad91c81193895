//! The methods by name.

use atm::{
    echo::AnyEstimator,
    error::{Error, Result},
    pipeline::{Emit, History},
};
use atm_core::{Consensus, Kind, Limits, MinAngle, OnNone, OnTwo, Reflector, TransversalMedian};

use crate::baseline::{
    CELL, Centerline, CommonTangents, ConstantDepth, DirectionalMaximum, Elfes, Himm, Interleave, Intersections,
    Method, MoravecElfes, Morphology, RangeLayer, TriangulationFusion, UniformArcs, Voting,
};

/// What can be chosen for all methods.
#[derive(Debug, Clone, Copy)]
pub struct Options {
    /// Which readings the local map of the arc-transversal median and of the consensus holds.
    pub history: History,
    /// θmin of the arc-transversal median, and the resolution that the consensus is asked for.
    pub min_angle: MinAngle<f64>,
    /// Standard deviation of a range beyond its rounding, for the consensus, in metres.
    pub range_error: f64,
    /// Width of the cells of every grid, in metres; the method's own where it is not given.
    pub cell: Option<f64>,
}

impl Default for Options {
    fn default() -> Self {
        Self { history: History::default(), min_angle: MinAngle::PAPER, range_error: 0.0, cell: None }
    }
}

/// A method, with its options where it has some.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Name {
    /// The arc-transversal median as in the paper.
    Atm,
    /// The same, of which only the kinds `median` and `single` are kept.
    AtmMedianSingle,
    /// The same, where an arc that nothing crosses gives nothing.
    AtmNoneDrop,
    /// The same, where an arc with two crossings gives its centre.
    AtmTwoCenter,
    /// The same, where an arc with two crossings gives their mean.
    AtmTwoMean,
    /// The same without delay: each echo from the arcs before it.
    AtmLatest,
    /// The consensus of points and walls, [`Consensus`].
    Consensus,
    /// The same, of which only the kinds `point` and `wall` are kept.
    ConsensusPointWall,
    /// See [`Centerline`].
    Centerline,
    /// See [`Interleave`].
    Interleave,
    /// See [`Intersections`].
    Intersections,
    /// See [`UniformArcs`].
    Uniform,
    /// See [`MoravecElfes`].
    MoravecElfes,
    /// See [`Elfes`].
    Elfes,
    /// See [`Himm`].
    Himm,
    /// See [`CommonTangents`].
    McKerrow,
    /// See [`ConstantDepth`].
    Rcd,
    /// See [`TriangulationFusion`].
    Tbf,
    /// See [`Voting`].
    Voting,
    /// See [`Morphology`].
    Morphology,
    /// See [`DirectionalMaximum`].
    DirectionalMaximum,
    /// See [`RangeLayer`].
    RangeLayer,
}

/// A run of the pipeline.
pub(super) struct PipelineRun {
    pub(super) emit: Emit,
    pub(super) estimator: AnyEstimator,
    /// Whether only these kinds are kept.
    pub(super) keep: &'static [&'static str],
}

/// Kinds of the median that need a crossing.
const CROSSED: &[&str] = &[Kind::Median.name(), Kind::Single.name()];
/// Kinds of the consensus that are resolved.
const RESOLVED: &[&str] = &[Reflector::Point.name(), Reflector::Wall.name()];

impl Name {
    /// All of them, in the order in which they are listed.
    pub const ALL: [Self; 22] = [
        Self::Atm,
        Self::AtmMedianSingle,
        Self::AtmNoneDrop,
        Self::AtmTwoCenter,
        Self::AtmTwoMean,
        Self::AtmLatest,
        Self::Consensus,
        Self::ConsensusPointWall,
        Self::Centerline,
        Self::Interleave,
        Self::Intersections,
        Self::McKerrow,
        Self::Rcd,
        Self::Tbf,
        Self::DirectionalMaximum,
        Self::Uniform,
        Self::MoravecElfes,
        Self::Elfes,
        Self::Himm,
        Self::Voting,
        Self::Morphology,
        Self::RangeLayer,
    ];

    /// Its word.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Atm => "atm",
            Self::AtmMedianSingle => "atm-median-single",
            Self::AtmNoneDrop => "atm-none-drop",
            Self::AtmTwoCenter => "atm-two-center",
            Self::AtmTwoMean => "atm-two-mean",
            Self::AtmLatest => "atm-latest",
            Self::Consensus => "consensus",
            Self::ConsensusPointWall => "consensus-point-wall",
            Self::Centerline => "centerline",
            Self::Interleave => "interleave",
            Self::Intersections => "intersections",
            Self::Uniform => "uniform",
            Self::MoravecElfes => "moravec-elfes",
            Self::Elfes => "elfes",
            Self::Himm => "himm",
            Self::McKerrow => "mckerrow",
            Self::Rcd => "rcd",
            Self::Tbf => "tbf",
            Self::Voting => "voting",
            Self::Morphology => "morphology",
            Self::DirectionalMaximum => "directional-maximum",
            Self::RangeLayer => "range-layer",
        }
    }

    /// The method of this word.
    pub fn from_word(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|name| name.word() == word)
    }

    /// How the pipeline is to run, if it is one of its estimators.
    pub(super) fn pipeline(self, options: &Options) -> Result<Option<PipelineRun>> {
        let paper = TransversalMedian { min_angle: options.min_angle, ..TransversalMedian::PAPER };
        let by = |estimator| PipelineRun { emit: Emit::Settled, estimator, keep: &[] };
        let run = |median| by(AnyEstimator::Median(median));
        let consensus = Consensus::new(options.min_angle).with_range_error(options.range_error);
        let consensus = consensus.map_err(|error| Error::Settings { message: error.to_string() })?;
        let consensus = by(AnyEstimator::Consensus(consensus));
        Ok(Some(match self {
            Self::Atm => run(paper),
            Self::AtmMedianSingle => PipelineRun { keep: CROSSED, ..run(paper) },
            Self::AtmNoneDrop => run(TransversalMedian { on_none: OnNone::Drop, ..paper }),
            Self::AtmTwoCenter => run(TransversalMedian { on_two: OnTwo::Center, ..paper }),
            Self::AtmTwoMean => run(TransversalMedian { on_two: OnTwo::Mean, ..paper }),
            Self::AtmLatest => PipelineRun { emit: Emit::Latest, ..run(paper) },
            Self::Consensus => consensus,
            Self::ConsensusPointWall => PipelineRun { keep: RESOLVED, ..consensus },
            _ => return Ok(None),
        }))
    }

    /// A new one of the other methods, for sensors with these range limits; `None` for the pipeline's own.
    pub(super) fn method(self, options: &Options, limits: Vec<Limits<f64>>) -> Result<Option<Box<dyn Method>>> {
        let cell = options.cell.unwrap_or(CELL);
        Ok(Some(match self {
            Self::Centerline => Box::new(Centerline::default()),
            Self::Interleave => Box::new(Interleave::default()),
            Self::Intersections => Box::new(Intersections::default()),
            Self::Uniform => Box::new(UniformArcs::new(cell, limits)?),
            Self::MoravecElfes => Box::new(MoravecElfes::new(cell, limits)),
            Self::Elfes => Box::new(Elfes::new(cell, limits)?),
            Self::Himm => Box::new(Himm::new(options.cell.unwrap_or(Himm::CELL), limits)?),
            Self::McKerrow => Box::new(CommonTangents::default()),
            Self::Rcd => Box::new(ConstantDepth::default()),
            Self::Tbf => Box::new(TriangulationFusion::default()),
            Self::Voting => Box::new(Voting::new(cell)?),
            Self::Morphology => Box::new(Morphology::new(cell)?),
            Self::DirectionalMaximum => Box::new(DirectionalMaximum::new(cell)),
            Self::RangeLayer => Box::new(RangeLayer::new(cell)?),
            _ => return Ok(None),
        }))
    }
}

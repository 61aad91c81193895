//! Echoes and estimators, whichever they are.

use atm_core::{Consensus, ConsensusEcho, Echo, Kind, MinAngle, Point2, Reflector, TransversalMedian};

/// Kinds of the median's echoes, by their words.
const MEDIAN: [&str; Kind::ALL.len()] = {
    let [a, b, c, d, e] = Kind::ALL;
    [a.name(), b.name(), c.name(), d.name(), e.name()]
};
/// And of the consensus's.
const CONSENSUS: [&str; Reflector::ALL.len()] = {
    let [a, b, c] = Reflector::ALL;
    [a.name(), b.name(), c.name()]
};

/// Who says where on its arc an echo came from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AnyEstimator {
    /// The arc-transversal median.
    Median(TransversalMedian<f64>),
    /// The consensus of points and walls.
    Consensus(Consensus<f64>),
}

impl AnyEstimator {
    /// The median as in the paper.
    pub const PAPER: Self = Self::Median(TransversalMedian::PAPER);

    /// The words for kinds of its echoes, in the order in which they are listed.
    pub const fn kinds(&self) -> &'static [&'static str] {
        match self {
            Self::Median(_) => &MEDIAN,
            Self::Consensus(_) => &CONSENSUS,
        }
    }

    /// θmin.
    pub const fn min_angle(&self) -> &MinAngle<f64> {
        match self {
            Self::Median(median) => &median.min_angle,
            Self::Consensus(consensus) => consensus.min_angle(),
        }
    }

    /// Whether it is the consensus, whose echoes say more than others.
    pub const fn is_consensus(&self) -> bool {
        matches!(self, Self::Consensus(_))
    }
}

impl Default for AnyEstimator {
    fn default() -> Self {
        Self::PAPER
    }
}

/// An echo of either estimator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AnyEcho {
    /// Of the median.
    Median(Echo<f64>),
    /// Of the consensus.
    Consensus(ConsensusEcho<f64>),
}

/// What every echo has: the columns that all tables of echoes share, in their order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Usual {
    /// The reading's own time, in nanoseconds.
    pub t: i64,
    /// The sensor's index.
    pub sensor: u16,
    /// Where it is in the fixed frame, in metres.
    pub position: Point2<f64>,
    /// The word for how it was found, or what stands there.
    pub kind: &'static str,
    /// The reading, in metres.
    pub range: f64,
    /// Direction from the boresight, in radians.
    pub azimuth: f64,
    /// Transversal crossings on its arc; of the consensus the readings that agree with it.
    pub crossings: u32,
    /// Length along the arc in which it lies, in metres; of the consensus with 95 %.
    pub resolution: f64,
    /// Equation (1); of the consensus what is missing of full confidence.
    pub significance: f64,
}

impl AnyEcho {
    /// The reading's own time, in nanoseconds.
    pub const fn t(&self) -> i64 {
        match self {
            Self::Median(echo) => echo.t,
            Self::Consensus(echo) => echo.t,
        }
    }

    /// Where it is in the fixed frame, in metres.
    pub const fn position(&self) -> Point2<f64> {
        match self {
            Self::Median(echo) => echo.position,
            Self::Consensus(echo) => echo.position,
        }
    }

    /// The word for how it was found, or what stands there.
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::Median(echo) => echo.kind.name(),
            Self::Consensus(echo) => echo.kind.name(),
        }
    }

    /// The kind's place in the list of its estimator's, [`AnyEstimator::kinds`].
    pub fn place(&self) -> usize {
        match self {
            Self::Median(echo) => Kind::ALL.iter().position(|kind| *kind == echo.kind),
            Self::Consensus(echo) => Reflector::ALL.iter().position(|kind| *kind == echo.kind),
        }
        .unwrap_or(usize::MAX)
    }

    /// What every echo has.
    pub fn usual(&self) -> Usual {
        let (t, position, kind) = (self.t(), self.position(), self.kind());
        match self {
            Self::Median(echo) => Usual {
                t,
                sensor: echo.sensor,
                position,
                kind,
                range: echo.range,
                azimuth: echo.azimuth(),
                crossings: echo.crossings,
                resolution: echo.resolution,
                significance: echo.significance(),
            },
            Self::Consensus(echo) => Usual {
                t,
                sensor: echo.sensor,
                position,
                kind,
                range: echo.range,
                azimuth: echo.azimuth(),
                crossings: echo.support,
                resolution: echo.resolution,
                significance: echo.significance(),
            },
        }
    }

    /// What the consensus says besides.
    pub const fn consensus(&self) -> Option<&ConsensusEcho<f64>> {
        match self {
            Self::Median(_) => None,
            Self::Consensus(echo) => Some(echo),
        }
    }
}

impl From<Echo<f64>> for AnyEcho {
    fn from(echo: Echo<f64>) -> Self {
        Self::Median(echo)
    }
}

impl From<ConsensusEcho<f64>> for AnyEcho {
    fn from(echo: ConsensusEcho<f64>) -> Self {
        Self::Consensus(echo)
    }
}

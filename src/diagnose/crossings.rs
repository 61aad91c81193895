//! How steeply arcs cross one another at all: what the estimator, which sees steep crossings only, can't say.

use std::{collections::VecDeque, f64::consts::PI};

use atm_core::{Arc, MinAngle, crossings};

/// Arcs that are kept to be crossed.
const KEPT: usize = 128;
/// Every so many echoes one is crossed with those: often at first, so that short logs have their say.
const DENSE: u64 = 64;
const SPARSE: u64 = 256;
/// Up to so many echoes it is often.
const MANY: u64 = 4096;

/// A sample of arcs, and how they cross arcs from elsewhere on the path.
#[derive(Debug, Clone, Default)]
pub struct CrossingEvidence {
    /// Arcs in the sample.
    pub arcs: u64,
    /// Those that no other arc crosses.
    pub uncrossed: u64,
    /// Those that are crossed, but at no angle that counts.
    pub shallow: u64,
    echoes: u64,
    kept: VecDeque<Arc<f64>>,
}

impl CrossingEvidence {
    /// Whether the next echo is one of the sample.
    #[inline]
    pub(super) fn wants(&mut self) -> bool {
        self.echoes += 1;
        self.echoes.is_multiple_of(if self.echoes <= MANY { DENSE } else { SPARSE })
    }

    /// Keeps an arc to be crossed.
    pub(super) fn keep(&mut self, arc: Arc<f64>) {
        if self.kept.len() >= KEPT {
            self.kept.pop_front();
        }
        self.kept.push_back(arc);
    }

    /// Takes an arc into the sample, where there is something to cross it.
    pub(super) fn sample(&mut self, arc: &Arc<f64>, min_angle: &MinAngle<f64>) {
        let Ok(shallowest) = MinAngle::new(PI / 180.0) else { return };
        if self.kept.is_empty() {
            return;
        }
        let (mut any, mut steep) = (false, false);
        for other in &self.kept {
            crossings(arc, other, &shallowest, |crossing| {
                any = true;
                steep |= crossing.angle() >= min_angle.radians();
            });
            if steep {
                break;
            }
        }
        self.arcs += 1;
        self.uncrossed += u64::from(!any);
        self.shallow += u64::from(any && !steep);
    }

    /// What comes has nothing to do with what came.
    pub(super) fn forget(&mut self) {
        self.kept.clear();
    }
}

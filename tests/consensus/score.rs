//! Estimates of both methods on one drive, and how good they are.

use std::collections::HashMap;

use atm::{
    core::{
        Bounds, Consensus, ConsensusEcho, Echo, Estimator, Fuser, Kind, MinAngle, Point2, Reflector, TransversalMedian,
        Vector2,
    },
    storage::SettledSlots,
};

use crate::drive::{Case, Disturbance, Drive, INCH};

/// Farther than this from every surface, a point is a ghost.
const GHOST: f64 = 6.0 * INCH;
/// χ² of two degrees of freedom that 95 % stay below.
const CHI_SQUARED: f64 = 5.991;

/// A resolved echo.
#[derive(Debug, Clone, Copy)]
pub struct Resolved {
    pub position: Point2<f64>,
    pub azimuth: f64,
    /// The surest come first.
    pub rank: f64,
    /// Standard deviations along the arc and of the range, in metres; the kind; the wall's normal.
    pub consensus: Option<(f64, f64, Reflector, Option<Vector2<f64>>)>,
}

/// A resolved echo against the truth.
#[derive(Debug, Clone, Copy)]
pub struct Scored {
    pub resolved: Resolved,
    /// Along the arc, in metres; `None` for what came over a detour or from another sensor.
    pub error: Option<f64>,
    /// Whether the truth lies in the 95 % ellipse.
    pub inside: bool,
    /// To the nearest surface, in metres.
    pub surface: f64,
    /// Of a wall, from the true direction of its echo, in radians.
    pub tilt: f64,
}

impl Scored {
    pub fn is_ghost(&self) -> bool {
        self.surface > GHOST
    }

    pub fn kind(&self) -> Option<Reflector> {
        self.resolved.consensus.map(|(_, _, kind, _)| kind)
    }
}

/// When echoes are reported.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum When {
    Settled,
    Latest,
}

/// Medians and singles of the median, as in the paper; the one whose crossings are least of an accident first.
pub fn atm(echo: &Echo<f64>) -> Option<Resolved> {
    matches!(echo.kind, Kind::Median | Kind::Single).then(|| Resolved {
        position: echo.position,
        azimuth: echo.azimuth(),
        rank: echo.log_significance(),
        consensus: None,
    })
}

/// Points and walls of the consensus; the sharpest first, doubt counting as bluntness.
pub fn consensus(echo: &ConsensusEcho<f64>) -> Option<Resolved> {
    let along = echo.sigma_azimuth * echo.range;
    (echo.kind != Reflector::Center).then(|| Resolved {
        position: echo.position,
        azimuth: echo.azimuth(),
        rank: along * (1.0 + 20.0 * (1.0 - echo.confidence)),
        consensus: Some((along, echo.sigma_range, echo.kind, echo.normal)),
    })
}

/// The usual consensus.
pub fn usual() -> Consensus<f64> {
    Consensus::new(MinAngle::PAPER)
}

/// Both methods over many drives of one case.
#[derive(Debug, Clone, Default)]
pub struct Table {
    /// Echoes with a truth.
    pub echoes: usize,
    pub atm: Vec<Scored>,
    pub consensus: Vec<Scored>,
    /// Per drive: what the opening is too wide by, in metres; of both methods.
    pub openings: [Vec<f64>; 2],
}

impl Table {
    pub fn new(
        case: &Case,
        seeds: std::ops::Range<u64>,
        disturbance: &Disturbance,
        estimator: Consensus<f64>,
        when: When,
    ) -> Self {
        let mut table = Self::default();
        for seed in seeds {
            let drive = Drive::new(case, seed, disturbance);
            table.echoes += drive.heard.iter().filter(|heard| heard.truth.is_some()).count();
            let ours = run(&drive, TransversalMedian::PAPER, when, |echo| (echo.t, echo.sensor, atm(echo)));
            let theirs = run(&drive, estimator, when, |echo| (echo.t, echo.sensor, consensus(echo)));
            for (scored, openings) in [&ours, &theirs].into_iter().zip(&mut table.openings) {
                openings.extend(opening(&drive, scored));
            }
            table.atm.extend(ours);
            table.consensus.extend(theirs);
        }
        for scored in [&mut table.atm, &mut table.consensus] {
            scored.sort_by(|a, b| a.resolved.rank.total_cmp(&b.resolved.rank));
        }
        table
    }

    /// As many of either, the surest.
    pub fn equal(&self) -> (&[Scored], &[Scored]) {
        let count = self.atm.len().min(self.consensus.len());
        (&self.atm[..count], &self.consensus[..count])
    }

    /// Of the consensus's echoes of a kind that have a truth: how many, and the share whose truth is in their ellipse.
    pub fn calibration(&self, kind: Reflector) -> (usize, f64) {
        let of_kind = self.consensus.iter().filter(|scored| scored.kind() == Some(kind) && scored.error.is_some());
        let (count, inside) =
            of_kind.fold((0, 0), |(all, inside), scored| (all + 1, inside + usize::from(scored.inside)));
        (count, inside as f64 / count as f64)
    }

    pub fn walls(&self) -> impl Iterator<Item = &Scored> {
        self.consensus.iter().filter(|scored| scored.kind() == Some(Reflector::Wall) && scored.error.is_some())
    }
}

/// Errors along the arc, in inches.
pub fn errors(scored: &[Scored]) -> Vec<f64> {
    scored.iter().filter_map(|scored| scored.error).map(|error| error / INCH).collect()
}

/// The share of ghosts.
pub fn ghosts(scored: &[Scored]) -> f64 {
    scored.iter().filter(|scored| scored.is_ghost()).count() as f64 / scored.len().max(1) as f64
}

/// The value below which a share of them lies; NaN of none.
pub fn quantile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let place = (values.len().saturating_sub(1) as f64 * share).round() as usize;
    values.get(place).copied().unwrap_or(f64::NAN)
}

fn run<E: Estimator<f64>>(
    drive: &Drive,
    estimator: E,
    when: When,
    judge: impl Fn(&E::Echo) -> (i64, u16, Option<Resolved>),
) -> Vec<Scored> {
    let storage = SettledSlots::new(16, 10).expect("a small local map");
    let mut fuser = match when {
        When::Settled => Fuser::settled(estimator, Bounds::NONE, storage),
        When::Latest => Fuser::latest(estimator, Bounds::NONE, storage),
    };
    let mut resolved = HashMap::new();
    let mut sink = |echo: &E::Echo| {
        let (t, sensor, found) = judge(echo);
        resolved.extend(found.map(|found| ((t, sensor), found)));
    };
    for heard in &drive.heard {
        fuser.push(&heard.reading, &mut sink).expect("readings in order");
    }
    fuser.finish(&mut sink);
    let scored = |heard: &crate::drive::Heard| {
        let resolved = *resolved.get(&(heard.reading.t, heard.reading.sensor))?;
        Some(score(drive, heard, resolved))
    };
    drive.heard.iter().filter_map(scored).collect()
}

fn score(drive: &Drive, heard: &crate::drive::Heard, resolved: Resolved) -> Scored {
    let pose = heard.reading.pose;
    let range = (resolved.position - Point2::from(pose.translation.vector)).norm();
    let error = heard.truth.map(|truth| (resolved.azimuth - truth.azimuth).abs() * range);
    let mut scored =
        Scored { resolved, error, inside: false, surface: drive.world.distance(resolved.position), tilt: f64::NAN };
    if let (Some(truth), Some(error), Some((along, sigma_range, _, normal))) = (heard.truth, error, resolved.consensus)
    {
        scored.inside = (error / along).powi(2) + ((range - truth.range) / sigma_range).powi(2) <= CHI_SQUARED;
        let direction = pose.rotation.angle() + truth.azimuth;
        scored.tilt = normal.map_or(f64::NAN, |normal| normal.angle(&-Vector2::new(direction.cos(), direction.sin())));
    }
    scored
}

/// How much wider than it is the opening appears: the widest gap in it between points near its line, which have to stand
/// within two feet of the jambs. The whole width too narrow where there are none.
fn opening(drive: &Drive, scored: &[Scored]) -> Option<f64> {
    let [from, to] = drive.world.openings().first()?.jambs;
    let (width, along) = ((to - from).norm(), (to - from).normalize());
    let beyond = 24.0 * INCH;
    let mut places: Vec<f64> = scored
        .iter()
        .map(|scored| scored.resolved.position - from)
        .filter(|offset| offset.perp(&along).abs() <= GHOST)
        .map(|offset| offset.dot(&along))
        .filter(|place| (-beyond..width + beyond).contains(place))
        .collect();
    places.sort_by(f64::total_cmp);
    let in_the_opening = |pair: &&[f64]| matches!(pair, [a, b] if *a < width * 0.8 && *b > width * 0.2);
    let gaps = places.windows(2).filter(in_the_opening).map(|pair| pair[1] - pair[0]);
    Some(gaps.fold(0.0, f64::max) - width)
}

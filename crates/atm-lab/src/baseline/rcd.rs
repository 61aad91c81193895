//! Regions of constant depth (Leonard and Durrant-Whyte, *Directed Sonar Sensing for Mobile Robot Navigation*, Kluwer 1992;
//! Sec. II-C, Figs. 11 and 12).

use std::f64::consts::{PI, TAU};

use atm::error::Result;
use atm_core::{Point2, Reading, Vector2};

use super::{Findings, Mark, Method, Segment, Sight};

/// Finds surfaces from a robot that turns in place, and tells corners from walls over several places.
///
/// At each stop the readings are ordered by where their sensors looked. A run of neighbours whose ranges differ by no more than 1 in
/// and that is at least 10° wide is a region of constant depth; the centre of its smallest ranges looks along the surface's
/// normal. Regions of several stops that are one point seen from directions at least 10° apart are a convex corner;
/// regions that look the same way and touch one line are a wall.
#[derive(Debug, Default)]
pub struct ConstantDepth {
    /// Where the robot stands.
    place: Option<Point2<f64>>,
    /// Where its sensors looked from there, echo or not.
    headings: Vec<f64>,
    /// The echoes from there.
    stop: Vec<Sight>,
    /// The stops at which the robot turned, each with its regions.
    stops: Vec<Vec<Depth>>,
}

/// A region of constant depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Depth {
    /// Where its echo came from.
    pub mark: Mark,
    /// Unit vector from the sensor to there: the surface's normal, inwards.
    pub normal: Vector2<f64>,
    /// Its width, in radians.
    pub width: f64,
}

/// Ranges of one region differ by no more than this: 1 in, in metres.
const TOLERANCE: f64 = 0.0254;
/// The smallest width of a region: 10°.
const MIN_WIDTH: f64 = 10.0 * PI / 180.0;
/// Neighbours look no farther apart than this: two steps of 2.5°.
const MAX_GAP: f64 = 5.0 * PI / 180.0;
/// What rounding may add to a difference of ranges, in metres, or of angles, in radians.
const ROUNDING: f64 = 1e-6;
/// How far a robot that stands may have moved, in metres: what odometry makes of turning in place.
const STANDING: f64 = 0.02;
/// Most readings of one stop; more say nothing new.
const MOST_READINGS: usize = 4096;
/// Stops over which a region is followed.
const FOLLOWED: usize = 10;
/// A point that stays within this is stationary: 4 in, in metres.
const STATIONARY: f64 = 0.1016;
/// A stationary point has to be seen from directions at least this far apart: the foot on a wall stays, too, for who goes towards it.
const PARALLAX: f64 = 10.0 * PI / 180.0;
/// Normals of one wall differ by no more than this: two steps of 2.5°.
const PARALLEL: f64 = 5.0 * PI / 180.0;

impl ConstantDepth {
    /// The stop is over: its regions count if the robot turned.
    fn leave(&mut self) {
        let (headings, stop) = (std::mem::take(&mut self.headings), std::mem::take(&mut self.stop));
        self.place = None;
        if has_turned(headings) {
            self.stops.push(regions(&stop));
        }
    }
}

/// Whether the sensors looked over at least half a turn without a gap.
fn has_turned(mut headings: Vec<f64>) -> bool {
    headings.sort_unstable_by(f64::total_cmp);
    let gaps = headings.windows(2).map(|pair| pair[1] - pair[0]);
    gaps.filter(|&gap| gap <= MAX_GAP + ROUNDING).sum::<f64>() >= PI
}

/// The regions of constant depth of one stop, the widest first; they don't overlap.
pub fn regions(stop: &[Sight]) -> Vec<Depth> {
    let mut around: Vec<Sight> = stop.to_vec();
    around.sort_by(|a, b| a.heading().total_cmp(&b.heading()).then(a.sensor.cmp(&b.sensor)));
    let mut runs: Vec<Run> = (0..around.len()).map(|first| Run::from(&around, first)).collect();
    runs.retain(|run| run.width + ROUNDING >= MIN_WIDTH);
    runs.sort_by(|a, b| b.width.total_cmp(&a.width).then(a.first.cmp(&b.first)));
    let mut taken = vec![false; around.len()];
    let mut depths = Vec::new();
    for run in runs {
        let members = || (0..run.length).map(|step| (run.first + step) % around.len());
        if members().any(|index| taken.get(index).copied().unwrap_or(true)) {
            continue;
        }
        members().for_each(|index| taken[index] = true);
        let sights: Vec<Sight> = members().filter_map(|index| around.get(index).copied()).collect();
        depths.extend(depth(&sights, run.width));
    }
    depths
}

/// A run of neighbours with nearly the same range.
struct Run {
    first: usize,
    length: usize,
    width: f64,
}

impl Run {
    /// The longest run, counter-clockwise, that begins with reading `first` of all `around`.
    fn from(around: &[Sight], first: usize) -> Self {
        let mut run = Self { first, length: 0, width: 0.0 };
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut last: Option<f64> = None;
        while run.length < around.len() {
            let Some(sight) = around.get((first + run.length) % around.len()) else {
                break;
            };
            let gap = last.map_or(0.0, |last| (sight.heading() - last).rem_euclid(TAU));
            (low, high) = (low.min(sight.range), high.max(sight.range));
            if gap > MAX_GAP + ROUNDING || high - low > TOLERANCE + ROUNDING {
                break;
            }
            run.width += gap;
            run.length += 1;
            last = Some(sight.heading());
        }
        run
    }
}

/// What the readings of one region, in order, say of the surface.
fn depth(sights: &[Sight], width: f64) -> Option<Depth> {
    let nearest = sights.iter().map(|sight| sight.range).min_by(f64::total_cmp)?;
    // Ranges in whole steps are equal to the nearest or one step more; half a step is between, whatever rounding does.
    let smallest = |sight: &Sight| sight.range - nearest <= sight.resolution / 2.0;
    let (mut best, mut begun) = (0..0, 0);
    for (index, sight) in sights.iter().enumerate() {
        if !smallest(sight) {
            begun = index + 1;
        } else if index + 1 - begun > best.len() {
            best = begun..index + 1;
        }
    }
    let run = sights.get(best)?;
    let (middle, opposite) = (run.get(run.len() / 2)?, run.get((run.len() - 1) / 2)?);
    let normal = (run.first()?.boresight + run.last()?.boresight).try_normalize(0.0)?;
    // An even number has two in the middle: halfway between them.
    let sensor = Point2::from((middle.position.coords + opposite.position.coords) / 2.0);
    Some(Depth { mark: Mark::of(middle, sensor + normal * nearest), normal, width })
}

/// How one region is related to one of another stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Relation {
    Corner,
    Wall,
}

fn relation(a: &Depth, b: &Depth) -> Option<Relation> {
    let apart = b.mark.position - a.mark.position;
    let turn = libm::atan2(a.normal.perp(&b.normal), a.normal.dot(&b.normal)).abs();
    if turn >= PARALLAX && apart.norm() <= STATIONARY {
        return Some(Relation::Corner);
    }
    let off = (a.normal + b.normal).try_normalize(0.0)?.dot(&apart).abs();
    // The echoes on one wall lie one beside the other; how far off is what the angle and the step of the ranges allow.
    let line = turn <= PARALLEL + ROUNDING && apart.norm() > STATIONARY;
    (line && off <= TOLERANCE + apart.norm() * libm::sin(PARALLEL / 2.0)).then_some(Relation::Wall)
}

/// Corners as points, walls as segments, and what was seen once as the point it was seen at.
fn classify(stops: &[Vec<Depth>]) -> Findings {
    let mut findings = Findings::default();
    for (index, stop) in stops.iter().enumerate() {
        let near = index.saturating_sub(FOLLOWED)..(index + FOLLOWED + 1).min(stops.len());
        let others = || near.clone().filter(|&other| other != index);
        for depth in stop {
            let related = |wanted: Relation| {
                others().flat_map(move |other| {
                    let later = other > index;
                    let same = stops.get(other).into_iter().flatten();
                    same.filter(move |other| relation(depth, other) == Some(wanted)).map(move |other| (later, *other))
                })
            };
            let corner: Vec<Point2<f64>> = related(Relation::Corner).map(|(_, other)| other.mark.position).collect();
            let walls: Vec<(bool, Depth)> = related(Relation::Wall).collect();
            if !corner.is_empty() && corner.len() >= walls.len() {
                let sum = corner.iter().fold(depth.mark.position.coords, |sum, point| sum + point.coords);
                let position = Point2::from(sum / (corner.len() + 1) as f64);
                findings.points.push(Mark { position, ..depth.mark });
            } else if walls.is_empty() {
                findings.points.push(depth.mark);
            } else if let Some((_, next)) = walls.iter().find(|(later, _)| *later) {
                // Each wall piece once: from the earlier stop to the next.
                findings.segments.push(Segment { ends: [depth.mark, next.mark] });
            }
        }
    }
    findings
}

impl Method for ConstantDepth {
    fn take(&mut self, reading: &Reading<f64>) -> Result<()> {
        if self.place.is_some_and(|place| (reading.robot - place).norm() > STANDING) {
            self.leave();
        }
        self.place.get_or_insert(reading.robot);
        if self.headings.len() < MOST_READINGS {
            self.headings.push(libm::atan2(reading.pose.rotation.im, reading.pose.rotation.re));
            self.stop.extend(Sight::new(reading));
        }
        Ok(())
    }

    fn clock_reset(&mut self) {
        self.leave();
    }

    fn finish(mut self: Box<Self>) -> Result<Option<Findings>> {
        self.leave();
        Ok((!self.stops.is_empty()).then(|| classify(&self.stops)))
    }
}

//! One sweep of the sensors: what goes into one message of each sort.

use atm_core::{ArcCrossing, Isometry2, Point2, Reading};

use super::content::{Color, Drawing, Form, Scene};
use crate::{echo::AnyEcho, log::Row, style, track::Pose};

/// A sweep lasts no longer, in nanoseconds of log time: so much later than its report an echo may be logged.
const LONGEST: u64 = 100_000_000;
/// Echoes or crossings of one message, at most.
pub(super) const MOST_POINTS: usize = 1 << 14;
/// Turn from one point of a drawn arc to the next, at most, in radians: 2.5°, 0.02 % of the radius beside the circle.
const ARC_STEP: f64 = std::f64::consts::PI / 72.0;
/// Fewest parts of a drawn arc.
const LEAST_STEPS: f64 = 4.0;
/// Readings of one sensor whose arcs stay drawn, at most.
const MOST_DRAWN: usize = 100;

const ARC_COLOR: Color = Color::new(style::ARCS.on_dark, 0xa0);
const ARC_WIDTH: f64 = 0.005;
pub(super) const CROSSING_COLOR: Color = Color::new(style::CROSSINGS.on_dark, 0xff);
const CROSSING_SIZE: f64 = 0.02;
/// Whose drawings of crossings are: no sensor's.
pub(super) const CROSSING_GROUP: u16 = u16::MAX;

/// Where something was at a time: the robot in the fixed frame, or a sensor on the robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Placed {
    pub(super) t: i64,
    /// `None` is the robot.
    pub(super) sensor: Option<u16>,
    pub(super) pose: Pose,
}

/// What is gathered until each sensor has had its turn.
pub(super) struct Sweep {
    /// Log time of the first record, and of the latest.
    begun: Option<u64>,
    /// Time of the latest record's readings.
    pub(super) t: i64,
    /// By sensor, the sweep in which it was last seen.
    seen: Vec<u64>,
    number: u64,
    pub(super) placed: Vec<Placed>,
    pub(super) pose: Option<(i64, Pose)>,
    pub(super) echoes: Vec<AnyEcho>,
    pub(super) crossings: Vec<ArcCrossing<f64>>,
    pub(super) arcs: Scene,
    pub(super) marks: Scene,
    /// By sensor, its readings so far, as drawn.
    drawn: Vec<u32>,
    /// How many of a sensor's readings stay drawn.
    slots: u32,
}

impl Sweep {
    /// `history` readings of each sensor stay drawn, at most a hundred.
    pub(super) fn new(history: usize) -> Self {
        Self {
            begun: None,
            t: 0,
            seen: Vec::new(),
            number: 1,
            placed: Vec::new(),
            pose: None,
            echoes: Vec::new(),
            crossings: Vec::new(),
            arcs: Scene::new(ARC_COLOR, ARC_WIDTH),
            marks: Scene::new(CROSSING_COLOR, CROSSING_SIZE),
            drawn: Vec::new(),
            slots: history.clamp(1, MOST_DRAWN) as u32,
        }
    }

    /// Whether the record, logged at `log_time`, belongs to the next sweep: a sensor has its turn again, or it is too late.
    pub(super) fn is_over(&self, row: &Row, log_time: u64) -> bool {
        let Some(begun) = self.begun else { return false };
        let again = |&(sensor, _): &(u16, f64)| self.seen.get(usize::from(sensor)) == Some(&self.number);
        log_time.saturating_sub(begun) > LONGEST || row.readings.iter().any(again)
    }

    /// Takes a record in.
    pub(super) fn record(&mut self, row: &Row, log_time: u64, pose: Pose) {
        self.begun.get_or_insert(log_time);
        self.t = row.t;
        for &(sensor, _) in &row.readings {
            let index = usize::from(sensor);
            if index >= self.seen.len() {
                self.seen.resize(index + 1, 0);
            }
            if let Some(seen) = self.seen.get_mut(index) {
                *seen = self.number;
            }
        }
        let placed = Placed { t: row.t, sensor: None, pose };
        if self.pose != Some((row.t, pose)) || self.placed.is_empty() {
            self.placed.push(placed);
        }
        self.pose = Some((row.t, pose));
    }

    /// Draws a reading's arc in the place of its sensor's oldest; one without an echo wipes that away.
    pub(super) fn draw(&mut self, reading: &Reading<f64>) {
        let index = usize::from(reading.sensor);
        if index >= self.drawn.len() {
            self.drawn.resize(index + 1, 0);
        }
        let Some(drawn) = self.drawn.get_mut(index) else { return };
        let slot = *drawn;
        *drawn = (slot + 1) % self.slots;
        let form = reading.range.echo().map(|range| {
            let start = self.arcs.points.len();
            trace_arc(&reading.pose, range, reading.beam.field_of_view(), &mut self.arcs.points);
            Form::Line(start..self.arcs.points.len())
        });
        self.arcs.drawings.push(Drawing { t: reading.t, group: reading.sensor, slot, form });
    }

    /// Draws the crossings gathered so far, in the place of those of an earlier sweep.
    pub(super) fn draw_crossings(&mut self) {
        self.marks.clear();
        let Some(first) = self.crossings.first() else { return };
        self.marks.points.extend(self.crossings.iter().map(|crossing| crossing.position));
        let slot = (self.number % u64::from(self.slots)) as u32;
        let form = Some(Form::Marks(0..self.marks.points.len()));
        self.marks.drawings.push(Drawing { t: first.t, group: CROSSING_GROUP, slot, form });
    }

    /// Begins the next sweep.
    pub(super) fn clear(&mut self) {
        self.begun = None;
        self.number += 1;
        self.placed.clear();
        self.echoes.clear();
        self.crossings.clear();
        self.arcs.clear();
        self.marks.clear();
    }
}

/// Points along an arc, from one edge of the beam to the other.
fn trace_arc(sensor: &Isometry2<f64>, range: f64, field_of_view: f64, points: &mut Vec<Point2<f64>>) {
    let steps = (field_of_view / ARC_STEP).ceil().max(LEAST_STEPS);
    let (position, heading) = (sensor.translation.vector, sensor.rotation);
    for step in 0..=steps as u32 {
        let azimuth = field_of_view * (f64::from(step) / steps - 0.5);
        let (sin, cos) = libm::sincos(azimuth);
        points.push(Point2::new(
            position.x + range * (heading.re * cos - heading.im * sin),
            position.y + range * (heading.im * cos + heading.re * sin),
        ));
    }
}

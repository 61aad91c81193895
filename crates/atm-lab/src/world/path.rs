//! How a robot drives through a world: one pose for each sweep of its sensors.
use std::f64::consts::TAU;

use atm::track::Pose;
use nalgebra::{Point2, Vector2};

/// The paper's speed, in metres per second: 5 in/s (Sec. IV-D).
pub const PAPER_SPEED: f64 = 0.127;
/// The paper's update rate, in hertz (Sec. IV-D).
pub const PAPER_RATE: f64 = 1.0;
/// Steps of a pose as it is driven and logged: a nanometre and a nanoradian, so that logs hold short decimals.
const STEPS: f64 = 1e9;
/// Nanoseconds in a second.
const NANOSECONDS: f64 = 1e9;
/// Pieces in which a wave is drawn.
const DRAWN: f64 = 64.0;

/// A trajectory, its speed, and the rate of the sweeps.
#[derive(Debug, Clone, PartialEq)]
pub struct Path {
    pub(crate) course: Course,
    pub(crate) speed: f64,
    pub(crate) rate: f64,
}

/// The line along which a robot drives, in metres and radians.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Course {
    /// Straight from one point to another, looking ahead.
    Straight {
        /// Where it begins.
        from: Point2<f64>,
        /// Where it ends.
        to: Point2<f64>,
    },
    /// A sine wave about the straight line, looking along it; speed counts along the straight line.
    Weaving {
        /// Where it begins.
        from: Point2<f64>,
        /// Where it ends.
        to: Point2<f64>,
        /// How far it goes to either side.
        amplitude: f64,
        /// Length of one wave along the straight line.
        wavelength: f64,
    },
    /// On the spot.
    Turning {
        /// Where.
        at: Point2<f64>,
        /// Yaw at the beginning.
        yaw: f64,
        /// How far it turns, counter-clockwise; negative for clockwise.
        turn: f64,
        /// How far from one sweep to the next, above 0.
        step: f64,
    },
    /// Straight from each point to the next, looking ahead, turning at once.
    Waypoints(Vec<Point2<f64>>),
}

impl Path {
    /// The line along which it goes.
    pub fn course(&self) -> &Course {
        &self.course
    }

    /// Speed in metres per second, above 0.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// Sweeps in a second, above 0.
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// Time in nanoseconds and pose of every sweep, from 0 on; the last one is at the end of the line or before it.
    pub fn sweeps(&self) -> impl Iterator<Item = (i64, Pose)> {
        (0..self.sweep_count()).map(|sweep| {
            let seconds = sweep as f64 / self.rate;
            let pose = self.course.pose(self.step() * sweep as f64);
            ((seconds * NANOSECONDS).round() as i64, pose)
        })
    }

    /// Number of sweeps, at least 1.
    pub fn sweep_count(&self) -> u64 {
        /// What a length may lack of a whole number of steps by rounding.
        const SLACK: f64 = 1e-6;
        let steps = self.course.length() / self.step();
        // The conversion saturates, too.
        ((steps + SLACK).floor() as u64).saturating_add(1)
    }

    /// The line as a polyline of at least one point.
    pub fn line(&self) -> Vec<Point2<f64>> {
        match &self.course {
            Course::Straight { from, to } => vec![*from, *to],
            Course::Turning { at, .. } => vec![*at],
            Course::Waypoints(points) => points.clone(),
            Course::Weaving { wavelength, .. } => {
                let length = self.course.length();
                let pieces = (length / wavelength * DRAWN).ceil();
                let pose = |piece: u32| self.course.pose(length * f64::from(piece) / pieces);
                // Saturates; a checked path has no more than a thousand waves.
                (0..=pieces as u32).map(pose).map(|pose| Point2::new(pose.x, pose.y)).collect()
            }
        }
    }

    /// Metres along the line from one sweep to the next; radians where the robot only turns.
    fn step(&self) -> f64 {
        match self.course {
            Course::Turning { step, .. } => step,
            _ => self.speed / self.rate,
        }
    }
}

impl Course {
    /// Length in metres; radians where the robot only turns.
    pub fn length(&self) -> f64 {
        match self {
            Self::Straight { from, to } | Self::Weaving { from, to, .. } => (to - from).norm(),
            Self::Turning { turn, .. } => turn.abs(),
            Self::Waypoints(points) => legs(points).map(|(from, to)| (to - from).norm()).sum(),
        }
    }

    /// The pose at this much progress.
    fn pose(&self, progress: f64) -> Pose {
        let (at, yaw) = match self {
            Self::Straight { from, to } => along(*from, *to, progress),
            Self::Weaving { from, to, amplitude, wavelength } => {
                let (foot, heading) = along(*from, *to, progress);
                let phase = TAU * progress / wavelength;
                let side = Vector2::new(-libm::sin(heading), libm::cos(heading));
                let slope = amplitude * TAU / wavelength * libm::cos(phase);
                (foot + side * (amplitude * libm::sin(phase)), heading + libm::atan(slope))
            }
            Self::Turning { at, yaw, turn, .. } => (*at, yaw + turn.signum() * progress),
            Self::Waypoints(points) => on_legs(points, progress),
        };
        rounded(Pose { x: at.x, y: at.y, yaw })
    }
}

/// The straight pieces of a polyline.
fn legs(points: &[Point2<f64>]) -> impl Iterator<Item = (Point2<f64>, Point2<f64>)> {
    points.iter().copied().zip(points.iter().copied().skip(1))
}

/// The point this far along the way from one point to another, and the direction of the way.
fn along(from: Point2<f64>, to: Point2<f64>, progress: f64) -> (Point2<f64>, f64) {
    let way = to - from;
    (from + way * (progress / way.norm()), libm::atan2(way.y, way.x))
}

/// The point this far along a polyline, and the direction of its piece; at a corner that of the piece that begins there.
fn on_legs(points: &[Point2<f64>], progress: f64) -> (Point2<f64>, f64) {
    let mut left = progress;
    let mut last = (points.first().copied().unwrap_or_default(), 0.0);
    for (from, to) in legs(points) {
        let length = (to - from).norm();
        if left < length {
            return along(from, to, left);
        }
        left -= length;
        last = along(from, to, length);
    }
    last
}

/// The nearest pose in whole nanometres and nanoradians.
pub(crate) fn rounded(pose: Pose) -> Pose {
    let rounded = |value: f64| (value * STEPS).round() / STEPS;
    Pose { x: rounded(pose.x), y: rounded(pose.y), yaw: rounded(pose.yaw) }
}

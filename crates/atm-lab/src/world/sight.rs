//! Whether one point of a world is seen from another.
//!
//! A line of sight that only touches the end of a wall or the rim of a pole passes: a jamb is seen past its own wall. It is
//! blocked where walls touch it from both sides, as at a joint. All tests are signs of areas; no slack takes part.
use nalgebra::Point2;

use super::surface::Shape;

/// What a surface does to a line of sight.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Hit {
    /// It leaves it free.
    Free,
    /// It crosses it.
    Blocked,
    /// An end of it lies on the line, and the rest to the left.
    TouchesLeft,
    /// An end of it lies on the line, and the rest to the right.
    TouchesRight,
}

/// Where surfaces touched a line of sight so far.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Touched {
    left: bool,
    right: bool,
}

impl Touched {
    /// Takes the next surface's hit; whether the line is blocked now.
    pub fn block(&mut self, hit: Hit) -> bool {
        match hit {
            Hit::Free => {}
            Hit::Blocked => return true,
            Hit::TouchesLeft => self.left = true,
            Hit::TouchesRight => self.right = true,
        }
        self.left && self.right
    }
}

impl Shape {
    /// What this does to the open line of sight from `a` to `b`; a pole hides what is inside of it.
    pub(crate) fn hit(&self, a: Point2<f64>, b: Point2<f64>) -> Hit {
        match *self {
            Self::Segment { from, to } => segment(from, to, a, b),
            Self::Circle { center, radius } if disc(center, radius, a, b) => Hit::Blocked,
            Self::Circle { .. } => Hit::Free,
        }
    }

    /// Smallest distance from the straight way between `a` and `b`, in metres; 0 where they cross, and within a pole.
    pub(crate) fn clearance(&self, a: Point2<f64>, b: Point2<f64>) -> f64 {
        let way = Self::Segment { from: a, to: b };
        match *self {
            Self::Segment { from, to } if segment(from, to, a, b) == Hit::Free => {
                let ends = [self.distance(a), self.distance(b), way.distance(from), way.distance(to)];
                ends.into_iter().fold(f64::INFINITY, f64::min)
            }
            Self::Segment { .. } => 0.0,
            Self::Circle { center, radius } => (way.distance(center) - radius).max(0.0),
        }
    }
}

/// Twice the signed area of a triangle: above 0 where `r` lies to the left of the way from `p` to `q`.
pub(crate) fn side(p: Point2<f64>, q: Point2<f64>, r: Point2<f64>) -> f64 {
    (q - p).perp(&(r - p))
}

fn segment(from: Point2<f64>, to: Point2<f64>, a: Point2<f64>, b: Point2<f64>) -> Hit {
    let (at_from, at_to) = (side(a, b, from), side(a, b, to));
    // A factor that underflows is a touch, too.
    if at_from * at_to < 0.0 {
        let across = side(from, to, a) * side(from, to, b) < 0.0;
        return if across { Hit::Blocked } else { Hit::Free };
    }
    let (touching, rest) = match (at_from == 0.0, at_to == 0.0) {
        (true, false) => (from, at_to),
        (false, true) => (to, at_from),
        _ => return Hit::Free,
    };
    let (way, along) = (b - a, touching - a);
    let between = (0.0..way.norm_squared()).contains(&way.dot(&along)) && way.dot(&along) > 0.0;
    match (between, rest > 0.0) {
        (false, _) => Hit::Free,
        (true, true) => Hit::TouchesLeft,
        (true, false) => Hit::TouchesRight,
    }
}

/// Whether the open line of sight passes through the inside of a disc.
fn disc(center: Point2<f64>, radius: f64, a: Point2<f64>, b: Point2<f64>) -> bool {
    let (way, to_center) = (b - a, center - a);
    if (center - b).norm() < radius {
        return true;
    }
    let (along, length) = (way.dot(&to_center), way.norm());
    (0.0..length * length).contains(&along) && way.perp(&to_center).abs() < radius * length
}

#[cfg(test)]
mod tests;

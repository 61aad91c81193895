//! The part of a world's surface that a drive could have seen.
use atm::{log::View, units::inches};
use nalgebra::Point2;

use super::nearness::Nearness;
use crate::world::{Shape, sight::Touched};

/// Length of the pieces into which surfaces are divided, in metres.
const PIECE: f64 = inches(1.0);
/// Most pieces of all surfaces together; where it would take more, pieces are longer.
const MOST_PIECES: f64 = 1e6;
/// A piece of surface is covered by a point this near to its middle, in metres.
pub const COVERED: f64 = inches(3.0);

/// The pieces of surface that some beam could have seen.
///
/// Every surface is divided into equal pieces of at most 1 in. A piece is observable if for some beam of the drive its middle
/// lies within the sensor's range limits and within the beam, borders included, and no surface blocks the line of sight:
/// one that only touches it hides nothing, two that meet there do, and a pole hides its own far side. Whether sound would come back from there is
/// not asked: that is the method's trouble, and the material's.
#[derive(Debug, Clone, Default)]
pub struct Observable {
    /// Middle and length of each.
    pieces: Vec<(Point2<f64>, f64)>,
}

impl Observable {
    /// What the beams of these views could have seen of the shapes; the readings themselves do not matter.
    pub fn new<'a>(shapes: impl IntoIterator<Item = &'a Shape>, views: &[View]) -> Self {
        let shapes: Vec<&Shape> = shapes.into_iter().collect();
        let beams: Vec<Beam<'_>> = views.iter().map(Beam::new).collect();
        let total: f64 = shapes.iter().map(|shape| shape.length()).sum();
        let longest = PIECE.max(total / MOST_PIECES);
        let mut pieces = Vec::new();
        for (index, shape) in shapes.iter().enumerate() {
            let count = (shape.length() / longest).ceil().max(1.0);
            let size = shape.length() / count;
            for piece in 0..count as u64 {
                let middle = along(shape, (piece as f64 + 0.5) / count);
                if beams.iter().any(|beam| beam.holds(middle) && !hidden(beam.sensor(), middle, &shapes, index)) {
                    pieces.push((middle, size));
                }
            }
        }
        Self { pieces }
    }

    /// Length of the observable surface, in metres.
    pub fn length(&self) -> f64 {
        self.pieces.iter().map(|(_, length)| length).sum()
    }

    /// The share of the observable surface within [`COVERED`] of some point; `None` where there is none to cover.
    pub fn coverage(&self, points: impl IntoIterator<Item = Point2<f64>>) -> Option<f64> {
        let (near, all) = (Nearness::new(points, COVERED), self.length());
        let lengths = self.pieces.iter().filter(|(middle, _)| near.any(*middle)).map(|(_, length)| length);
        // Not sum(): an empty one is −0.
        let covered = lengths.fold(0.0, |sum, length| sum + length);
        (all > 0.0).then(|| covered / all)
    }
}

/// The place after a share of the way along a segment, or around a circle.
fn along(shape: &Shape, share: f64) -> Point2<f64> {
    match shape {
        Shape::Segment { from, to } => from + (to - from) * share,
        Shape::Circle { center, radius } => {
            let turn = std::f64::consts::TAU * share;
            center + nalgebra::Vector2::new(libm::cos(turn), libm::sin(turn)) * *radius
        }
    }
}

/// What one sensor can see at one moment.
struct Beam<'a> {
    view: &'a View,
    cos_half: f64,
}

impl<'a> Beam<'a> {
    fn new(view: &'a View) -> Self {
        Self { view, cos_half: libm::cos(view.beam.field_of_view() / 2.0) }
    }

    fn sensor(&self) -> Point2<f64> {
        Point2::from(self.view.pose.translation.vector)
    }

    fn holds(&self, place: Point2<f64>) -> bool {
        let ray = place - self.sensor();
        let (range, heading) = (ray.norm(), self.view.pose.rotation);
        self.view.limits.classify(range).echo().is_some()
            && ray.x * heading.re + ray.y * heading.im >= range * self.cos_half
    }
}

/// Whether some shape hides the place, which lies on the shape of index `own`, from the sensor.
fn hidden(sensor: Point2<f64>, place: Point2<f64>, shapes: &[&Shape], own: usize) -> bool {
    let mut touched = Touched::default();
    shapes.iter().enumerate().any(|(index, shape)| match shape {
        Shape::Segment { .. } if index == own => false,
        Shape::Circle { center, .. } if index == own => (place - center).dot(&(sensor - place)) <= 0.0,
        _ => touched.block(shape.hit(sensor, place)),
    })
}

#[cfg(test)]
mod tests;

//! Where two arcs cross, by angles: half the triangle's angle from its sides, directions by the arc tangent.

use std::f64::consts::{PI, TAU};

use crate::{history::distance, log::Sample, margin::Margins};

/// One reading's arc.
#[derive(Debug, Clone, Copy)]
pub struct Span {
    pub sensor: [f64; 2],
    pub heading: f64,
    pub half_beam: f64,
    pub radius: f64,
}

/// A point that lies on two arcs, seen from both.
#[derive(Debug, Clone, Copy)]
pub struct Cut {
    /// From the first arc's boresight and from the second's.
    pub azimuths: [f64; 2],
    pub position: [f64; 2],
    pub angle: f64,
    /// Whether rounding may decide that it does not count.
    pub doubtful: bool,
}

impl Span {
    pub fn of(sample: &Sample) -> Option<Self> {
        Some(Self {
            sensor: sample.position,
            heading: sample.boresight[1].atan2(sample.boresight[0]),
            half_beam: sample.field_of_view / 2.0,
            radius: sample.echo()?,
        })
    }

    pub fn point(&self, azimuth: f64) -> [f64; 2] {
        on_circle(self.sensor, self.radius, self.heading + azimuth)
    }

    fn azimuth(&self, point: [f64; 2]) -> f64 {
        wrapped(direction(self.sensor, point) - self.heading)
    }
}

/// The crossings of two arcs that are at least `min_angle` steep and in both beams, or may be.
pub fn cuts(a: &Span, b: &Span, min_angle: f64, margins: &Margins) -> Vec<Cut> {
    let between = distance(a.sensor, b.sensor);
    let half_perimeter = (a.radius + b.radius + between) / 2.0;
    let [short_a, short_b, short_between] = [a.radius, b.radius, between].map(|side| half_perimeter - side);
    // No triangle: apart, one in the other, or concentric.
    if between == 0.0 || short_a <= 0.0 || short_b <= 0.0 || short_between <= 0.0 {
        return Vec::new();
    }
    // The angle at the first sensor between the other one and the crossing: tan²(γ/2) of a triangle with known sides.
    let opening = 2.0 * (short_a * short_between).sqrt().atan2((half_perimeter * short_b).sqrt());
    let towards = direction(a.sensor, b.sensor);
    let mut found = Vec::new();
    for side in [-1.0, 1.0] {
        let position = on_circle(a.sensor, a.radius, towards + side * opening);
        let azimuths = [a.azimuth(position), b.azimuth(position)];
        let turn = wrapped(direction(a.sensor, position) - direction(b.sensor, position)).abs();
        let angle = if turn > PI / 2.0 { PI - turn } else { turn };
        let slack = (angle - min_angle).min(a.half_beam - azimuths[0].abs()).min(b.half_beam - azimuths[1].abs());
        if slack >= -margins.angle {
            found.push(Cut { azimuths, position, angle, doubtful: slack <= margins.angle });
        }
    }
    found
}

fn on_circle(center: [f64; 2], radius: f64, direction: f64) -> [f64; 2] {
    [center[0] + radius * direction.cos(), center[1] + radius * direction.sin()]
}

fn direction(from: [f64; 2], to: [f64; 2]) -> f64 {
    (to[1] - from[1]).atan2(to[0] - from[0])
}

/// The same angle within half a turn to either side.
fn wrapped(mut angle: f64) -> f64 {
    while angle > PI {
        angle -= TAU;
    }
    while angle < -PI {
        angle += TAU;
    }
    angle
}

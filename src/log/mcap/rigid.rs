//! Poses in space: where a frame is in another.

use crate::track::{Pose, Step};

/// A rotation, then a translation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rigid {
    translation: [f64; 3],
    /// A unit quaternion x, y, z, w.
    rotation: [f64; 4],
}

impl Rigid {
    /// No rotation and no translation.
    pub(super) const IDENTITY: Self = Self { translation: [0.0; 3], rotation: [0.0, 0.0, 0.0, 1.0] };

    /// Of a translation in metres and a quaternion x, y, z, w of any length but 0; the words are what is wrong with them.
    pub(super) fn new(translation: [f64; 3], quaternion: [f64; 4]) -> Result<Self, String> {
        if !translation.iter().all(|part| part.is_finite()) {
            return Err(format!("the translation {translation:?} is not finite"));
        }
        let length = quaternion.iter().map(|part| part * part).sum::<f64>().sqrt();
        if !(length.is_finite() && length > 0.0) {
            return Err(format!("the quaternion {quaternion:?} has no direction"));
        }
        Ok(Self { translation, rotation: quaternion.map(|part| part / length) })
    }

    /// In the plane.
    pub(super) fn flat(x: f64, y: f64, cos: f64, sin: f64) -> Self {
        // Half the angle, without an angle: along the direction half way between it and the x axis.
        let (w, z) = if cos > -0.5 { (1.0 + cos, sin) } else { (sin, 1.0 - cos) };
        let length = (w * w + z * z).sqrt();
        Self { translation: [x, y, 0.0], rotation: [0.0, 0.0, z / length, w / length] }
    }

    fn turn(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [i, j, k, w] = self.rotation;
        // v + 2 w (q × v) + 2 q × (q × v)
        let (a, b, c) = (2.0 * (j * z - k * y), 2.0 * (k * x - i * z), 2.0 * (i * y - j * x));
        [x + w * a + (j * c - k * b), y + w * b + (k * a - i * c), z + w * c + (i * b - j * a)]
    }

    /// This, with `inner` in it: from `inner`'s frame to that of this.
    pub(super) fn of(&self, inner: &Self) -> Self {
        let moved = self.turn(inner.translation);
        let mut translation = self.translation;
        for (sum, part) in translation.iter_mut().zip(moved) {
            *sum += part;
        }
        let ([ax, ay, az, aw], [bx, by, bz, bw]) = (self.rotation, inner.rotation);
        let rotation = [
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
            aw * bw - ax * bx - ay * by - az * bz,
        ];
        Self { translation, rotation }
    }

    /// The way back.
    pub(super) fn inverse(&self) -> Self {
        let [x, y, z, w] = self.rotation;
        let back = Self { translation: [0.0; 3], rotation: [-x, -y, -z, w] };
        Self { translation: back.turn(self.translation).map(|part| -part), ..back }
    }

    /// The pose this share of the way to another: the position on a straight line, the rotation evenly along the shorter way
    /// (Shoemake 1985).
    pub(super) fn towards(&self, other: &Self, share: f64) -> Self {
        let mut translation = self.translation;
        for (from, to) in translation.iter_mut().zip(other.translation) {
            *from += share * (to - *from);
        }
        let dot: f64 = self.rotation.iter().zip(other.rotation).map(|(a, b)| a * b).sum();
        // Both signs of a quaternion are the same rotation.
        let end = if dot < 0.0 { other.rotation.map(|part| -part) } else { other.rotation };
        let size = |sign: f64| {
            let parts = self.rotation.iter().zip(end).map(|(a, b)| (b + sign * a) * (b + sign * a));
            parts.sum::<f64>().sqrt()
        };
        // Half the angle between them from the sides of a rhombus: exact where a cosine would not be.
        let angle = 2.0 * libm::atan2(size(-1.0), size(1.0));
        let (from, to) = if angle > 0.0 {
            let sine = libm::sin(angle);
            (libm::sin((1.0 - share) * angle) / sine, libm::sin(share * angle) / sine)
        } else {
            (1.0, 0.0)
        };
        let mut rotation = self.rotation;
        for (part, end) in rotation.iter_mut().zip(end) {
            *part = from * *part + to * end;
        }
        Self { translation, rotation }
    }

    /// The way to another, turning the shorter way.
    pub(super) fn step_to(&self, other: &Self) -> Step {
        let distance =
            self.translation.iter().zip(other.translation).map(|(a, b)| (b - a) * (b - a)).sum::<f64>().sqrt();
        let [mut apart, mut across] = [0.0, 0.0];
        let dot: f64 = self.rotation.iter().zip(other.rotation).map(|(a, b)| a * b).sum();
        let sign = if dot < 0.0 { -1.0 } else { 1.0 };
        for (from, to) in self.rotation.iter().zip(other.rotation) {
            apart += (sign * to - from) * (sign * to - from);
            across += (sign * to + from) * (sign * to + from);
        }
        // Twice the angle between the quaternions, which is twice that from the sides of a rhombus.
        Step { distance, turn: 4.0 * libm::atan2(apart.sqrt(), across.sqrt()) }
    }

    /// Position seen from above, in metres.
    pub(super) fn position(&self) -> (f64, f64) {
        let [x, y, _] = self.translation;
        (x, y)
    }

    /// The direction of the x axis.
    pub(super) fn forward(&self) -> [f64; 3] {
        let [x, y, z, w] = self.rotation;
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)]
    }

    /// What of it is in the plane: position, and the heading of the x axis.
    pub(super) fn on_plane(&self) -> Pose {
        let ((x, y), [cos, sin, _]) = (self.position(), self.forward());
        Pose { x, y, yaw: libm::atan2(sin, cos) }
    }
}

#[cfg(test)]
mod tests;

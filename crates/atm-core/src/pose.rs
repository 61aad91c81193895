//! Where the robot is: the path it has travelled, and a moving origin for single precision.

use nalgebra::{Isometry2, Point2, Vector2};

use crate::{error::DomainError, scalar::Scalar};

/// A length of path in whole micrometres, so that adding never loses any; wraps after 4294 m.
///
/// Only differences between readings in one local map are ever taken, and they are bounded by [`Travel::MAX`] and one
/// step, so wrapping does no harm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Travel(pub(crate) u32);

impl Travel {
    /// The longest bound: 1000 m. No dead reckoning is good for more.
    pub const MAX: Self = Self(1_000_000_000);

    /// A bound in metres, in (0, 1000], rounded to the nearest micrometre.
    pub fn from_metres<T: Scalar>(metres: T) -> Result<Self, DomainError> {
        let micrometres = (metres * T::MICROMETRES + T::HALF).round_down();
        if !(metres > T::ZERO && micrometres <= T::from_count(Self::MAX.0)) {
            return Err(DomainError::MaxTravel);
        }
        Ok(Self(micrometres.to_count()))
    }
}

/// Adds up the path: the sum of |Δposition| over consecutive readings.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Odometer<T: Scalar> {
    last: Option<Point2<T>>,
    /// The part of a micrometre that the whole number does not hold yet.
    fraction: T,
    travel: u32,
}

impl<T: Scalar> Odometer<T> {
    /// A step longer than this counts as this much, which is longer than any bound.
    pub(crate) const LONGEST_STEP: Travel = Travel(Travel::MAX.0 + 1);

    pub(crate) const fn new() -> Self {
        Self { last: None, fraction: T::ZERO, travel: 0 }
    }

    /// Takes a position in. A step shorter than `least` (metres) waits for more of it, so that poses that tremble make no
    /// path; one longer than `most` counts as that.
    pub(crate) fn advance(&mut self, position: Point2<T>, least: T, most: Travel) -> Travel {
        let Some(last) = self.last else {
            self.last = Some(position);
            return Travel(self.travel);
        };
        let step = position - last;
        let squared = step.x * step.x + step.y * step.y;
        // The sensors of a ring fire together: nothing to add.
        if !(squared <= least * least) {
            self.last = Some(position);
            let length = squared.square_root();
            let micrometres = length * T::MICROMETRES + self.fraction;
            let whole = micrometres.round_down();
            let fraction = micrometres - whole;
            self.fraction = if fraction >= T::ZERO && fraction < T::ONE { fraction } else { T::ZERO };
            self.travel = self.travel.wrapping_add(whole.to_count().min(most.0));
        }
        Travel(self.travel)
    }

    /// Forgets where the path was: what comes next begins a new one.
    pub(crate) const fn lift(&mut self) {
        self.last = None;
        self.fraction = T::ZERO;
    }

    pub(crate) fn shift(&mut self, by: Vector2<T>) {
        if let Some(last) = &mut self.last {
            *last -= by;
        }
    }
}

/// Whether a pose can be used: finite, with a heading of unit length.
pub(crate) fn usable<T: Scalar>(pose: &Isometry2<T>) -> bool {
    let (x, y) = (pose.translation.vector.x, pose.translation.vector.y);
    let (cos, sin) = (pose.rotation.re, pose.rotation.im);
    x.finite() && y.finite() && (cos * cos + sin * sin - T::ONE).magnitude() <= T::HEADING_SLACK
}

/// An origin that follows the robot, for firmware in `f32`.
///
/// At the size of UTM coordinates neighbouring `f32` numbers are half a metre apart. So the robot keeps its position in
/// whole micrometres, and the fuser works relative to an anchor nearby:
///
/// ```
/// use atm_core::{Anchor, Vector2};
/// let mut anchor = Anchor::new();
/// // Each time before the readings of a pose are pushed:
/// let (local, moved) = anchor.localize::<f32>([512_345_678_901, 5_401_234_567_890]);
/// assert!(local.x.abs() <= 16.8 && local.y.abs() <= 16.8);
/// if let Some(by) = moved {
///     // fuser.shift_origin(by);
///     assert!(by.norm() > 0.0);
/// }
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Anchor {
    /// Micrometres, multiples of [`Anchor::GRID`].
    origin: [i64; 2],
}

impl Anchor {
    /// The anchor moves in steps of 2²³ µm = 8.39 m, which an `f32` holds exactly.
    pub const GRID: i64 = 1 << 23;
    /// It moves when a coordinate is farther off than this: 2²⁴ µm = 16.8 m.
    pub const LEASH: u64 = 1 << 24;

    /// An anchor at the origin of the fixed frame.
    pub const fn new() -> Self {
        Self { origin: [0; 2] }
    }

    /// The anchor's position in the fixed frame, in micrometres: add it to an echo's position.
    pub const fn origin(&self) -> [i64; 2] {
        self.origin
    }

    /// `position` (micrometres, fixed frame) in metres relative to the anchor, and by how much the anchor moved, if it
    /// had to: pass that to [`crate::Fuser::shift_origin`] before the next reading.
    pub fn localize<T: Scalar>(&mut self, position: [i64; 2]) -> (Point2<T>, Option<Vector2<T>>) {
        let mut moved = [0i64; 2];
        for ((origin, &position), moved) in self.origin.iter_mut().zip(&position).zip(&mut moved) {
            if position.abs_diff(*origin) > Self::LEASH {
                let nearest = position.saturating_add(Self::GRID / 2).div_euclid(Self::GRID).wrapping_mul(Self::GRID);
                *moved = nearest.wrapping_sub(*origin);
                *origin = nearest;
            }
        }
        let local = |axis: usize| -> T {
            let position = position.get(axis).copied().unwrap_or(0);
            let origin = self.origin.get(axis).copied().unwrap_or(0);
            metres(position.wrapping_sub(origin))
        };
        let by = (moved != [0; 2]).then(|| Vector2::new(metres(moved[0]), metres(moved[1])));
        (Point2::new(local(0), local(1)), by)
    }
}

/// Whole micrometres in metres, split so that 32 bits at a time are converted: no 64-bit soft float routine.
fn metres<T: Scalar>(micrometres: i64) -> T {
    let magnitude = micrometres.unsigned_abs();
    let high = T::from_count((magnitude >> 32) as u32);
    let low = T::from_count(magnitude as u32);
    let two_to_the_16 = T::from_count(1 << 16);
    let value = (high * two_to_the_16 * two_to_the_16 + low) / T::MICROMETRES;
    if micrometres < 0 { -value } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn odometer_adds_steps_and_keeps_what_is_shorter_than_a_micrometre() {
        let mut odometer = Odometer::<f64>::new();
        odometer.advance(Point2::new(0.0, 0.0), 0.0, Odometer::<f64>::LONGEST_STEP);
        for step in 1..=10_000 {
            odometer.advance(Point2::new(f64::from(step) * 0.3e-6, 0.0), 0.0, Odometer::<f64>::LONGEST_STEP);
        }
        let Travel(travel) = odometer.advance(Point2::new(0.003, 4.0), 0.0, Odometer::<f64>::LONGEST_STEP);
        assert!((4_002_999..=4_003_001).contains(&travel), "{travel}");
    }

    #[test]
    fn leap_of_any_length_counts_as_more_than_any_bound() {
        for leap in [2000.0, 1e300, f64::MAX] {
            let mut odometer = Odometer::<f64>::new();
            let Travel(before) = odometer.advance(Point2::new(-leap, 0.0), 0.0, Odometer::<f64>::LONGEST_STEP);
            let Travel(after) = odometer.advance(Point2::new(leap, 0.0), 0.0, Odometer::<f64>::LONGEST_STEP);
            assert!(after.wrapping_sub(before) > Travel::MAX.0);
        }
    }

    #[test]
    fn travel_bound_domain() {
        assert!(Travel::from_metres(0.0f64).is_err());
        assert!(Travel::from_metres(1000.5f64).is_err());
        assert!(Travel::from_metres(f64::NAN).is_err());
        assert_eq!(Travel::from_metres(1.5f64), Ok(Travel(1_500_000)));
    }

    #[test]
    fn anchor_stays_until_the_leash_is_taut_then_moves_by_whole_grid_steps() {
        let mut anchor = Anchor::new();
        let (local, moved) = anchor.localize::<f32>([16_000_000, 0]);
        assert_eq!((local, moved), (Point2::new(16.0, 0.0), None));
        let (local, moved) = anchor.localize::<f32>([17_000_000, -3]);
        assert_eq!(moved, Some(Vector2::new(16.777_216, 0.0)));
        assert!((local.x - 0.222_784).abs() < 1e-6);
        assert_eq!(anchor.origin(), [1 << 24, 0]);
    }

    #[test]
    fn anchor_takes_any_position() {
        for position in [i64::MIN, i64::MAX, 0, -1] {
            let mut anchor = Anchor::new();
            let (local, _) = anchor.localize::<f32>([position, position]);
            assert!(local.x.abs() <= 16.8, "{position}: {}", local.x);
        }
    }
}

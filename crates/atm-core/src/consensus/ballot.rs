//! The ballot: how many votes each azimuth of an arc gets.
//!
//! A witness agrees with a hypothesis for the azimuths of an interval, whose ends have closed forms, so votes are cast for
//! intervals and counted in one pass. Votes are whole numbers: their sum depends on no order, and is the same in single
//! and double precision but where an interval ends within rounding of a place's middle.

use nalgebra::Vector2;

use crate::{
    arc::{cross, dot},
    scalar::Scalar,
};

/// Places into which the azimuths of a sector are divided: 0.18° each for the paper's beam. They serve to find a maximum
/// and its rivals; what is reported is fitted without them.
pub(super) const PLACES: usize = 128;

/// Votes for every place of a sector.
#[derive(Debug, Clone)]
pub(super) struct Ballot {
    /// Votes, or, while they are cast, their differences from one place to the next.
    votes: [i32; PLACES + 1],
}

impl Ballot {
    pub const fn new() -> Self {
        Self { votes: [0; PLACES + 1] }
    }

    /// Turns differences into votes.
    pub fn count(mut self, handicap: i32) -> [i32; PLACES] {
        let mut sum = -handicap;
        let mut counted = [0; PLACES];
        for (place, difference) in counted.iter_mut().zip(&mut self.votes) {
            sum += *difference;
            *place = sum;
        }
        counted
    }

    /// Casts `votes` for the places whose middles lie between two positions, in places from the sector's right edge. Whether
    /// there are any.
    fn cast<T: Scalar>(&mut self, from: T, to: T, votes: i32) -> bool {
        let (first, end) = ((from + T::HALF).to_count() as usize, (to + T::HALF).to_count() as usize);
        if first < end {
            self.add(first, end.min(PLACES), votes);
        }
        first < end
    }

    /// Casts `votes` for the place that holds a position.
    fn cast_at<T: Scalar>(&mut self, position: T, votes: i32) {
        let place = (position.to_count() as usize).min(PLACES - 1);
        self.add(place, place + 1, votes);
    }

    fn add(&mut self, first: usize, end: usize, votes: i32) {
        if let Some(place) = self.votes.get_mut(first) {
            *place += votes;
        }
        if let Some(place) = self.votes.get_mut(end) {
            *place -= votes;
        }
    }
}

/// The directions within an angle of an axis, named by u = tan(azimuth / 2): monotone, and free of trigonometry.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sector<T: Scalar> {
    /// A unit vector.
    axis: Vector2<T>,
    /// u of the left edge: the tangent of half the half angle.
    edge: T,
    /// Of the half angle.
    cos: T,
    /// Of the half angle.
    sin: T,
}

impl<T: Scalar> Sector<T> {
    pub fn new(axis: Vector2<T>, edge: T) -> Self {
        let square = edge * edge;
        let scale = T::ONE / (T::ONE + square);
        Self { axis, edge, cos: (T::ONE - square) * scale, sin: T::TWO * edge * scale }
    }

    /// The unit vector in direction u.
    pub fn direction(&self, u: T) -> Vector2<T> {
        let scale = T::ONE / (T::ONE + u * u);
        let (cos, sin) = ((T::ONE - u * u) * scale, T::TWO * u * scale);
        let left = Vector2::new(-self.axis.y, self.axis.x);
        self.axis * cos + left * sin
    }

    /// u at a position in places from the right edge.
    pub fn at(&self, places: T) -> T {
        self.edge * (places * T::TWO / T::from_count(PLACES as u32) - T::ONE)
    }

    /// Casts `votes` for all directions n with low ≤ n·w ≤ high of which `admits` holds in the middle.
    ///
    /// n·w = c has the solutions u = tan((ψ ± γ)/2), ψ the azimuth of w and γ = acos(c/|w|), which is
    /// (w_aside ± √(|w|² − c²)) / (c + w_ahead).
    pub fn cast(
        &self,
        ballot: &mut Ballot,
        w: Vector2<T>,
        [low, high]: [T; 2],
        votes: i32,
        admits: impl Fn(Vector2<T>) -> bool,
    ) {
        let (ahead, aside) = (dot(self.axis, w), cross(self.axis, w));
        if self.misses(ahead, aside, low, high) {
            return;
        }
        let square = ahead * ahead + aside * aside;
        let length = square.square_root();
        if low > length || high < -length {
            return;
        }
        let inner = roots(ahead, aside, square, if high < length { high } else { length });
        let outer = roots(ahead, aside, square, if low > -length { low } else { -length });
        // The two sides may go on in each other, along w or behind it. A part too narrow for a place of its own then counts
        // only where the other one is, too.
        let meet = high >= length || low <= -length;
        let (mut counted, mut narrow) = (false, None);
        let mut cast = |from: T, to: T| {
            if from <= to {
                let admitted = admits(self.direction((from + to) * T::HALF));
                if admitted {
                    let scale = T::from_count(PLACES as u32 / 2);
                    let [from, to] = [from, to].map(|u| (u / self.edge + T::ONE) * scale);
                    if ballot.cast(from, to, votes) {
                        counted = true;
                    } else if meet {
                        narrow = Some((from + to) * T::HALF);
                    } else {
                        ballot.cast_at((from + to) * T::HALF, votes);
                    }
                }
            }
        };
        let clipped = |u: T| {
            if u > self.edge {
                self.edge
            } else if u < -self.edge {
                -self.edge
            } else {
                u
            }
        };
        // Left of w, then right of it; an interval that passes behind comes back on the other side.
        for [from, to] in [[inner[0], outer[0]], [outer[1], inner[1]]] {
            if from <= to {
                if from <= self.edge && to >= -self.edge {
                    cast(clipped(from), clipped(to));
                }
            } else {
                if from <= self.edge {
                    cast(clipped(from), self.edge);
                }
                if to >= -self.edge {
                    cast(-self.edge, clipped(to));
                }
            }
        }
        if let (false, Some(position)) = (counted, narrow) {
            ballot.cast_at(position, votes);
        }
    }

    /// Whether surely no direction of the sector has low ≤ n·w ≤ high.
    fn misses(&self, ahead: T, aside: T, low: T, high: T) -> bool {
        let Self { cos, sin, .. } = *self;
        let (left, right) = (ahead * cos + aside * sin, ahead * cos - aside * sin);
        let (least, most) = if left < right { (left, right) } else { (right, left) };
        // Between the edges n·w can pass its extremes only if w, or its opposite, lies there.
        let within = aside.magnitude() * cos <= ahead.magnitude() * sin;
        (low > most && !(within && ahead > T::ZERO)) || (high < least && !(within && ahead < T::ZERO))
    }
}

/// The two u with n·w = c, left of w first, by whichever form does not cancel.
fn roots<T: Scalar>(ahead: T, aside: T, square: T, c: T) -> [T; 2] {
    let rest = square - c * c;
    let root = if rest > T::ZERO { rest.square_root() } else { T::ZERO };
    let quotient = |numerator: T, denominator: T| {
        // 0/0: w straight ahead or straight behind, and n along it.
        if denominator != T::ZERO {
            numerator / denominator
        } else if ahead > T::ZERO {
            T::ZERO
        } else {
            T::INFINITY
        }
    };
    if aside >= T::ZERO {
        [quotient(aside + root, c + ahead), quotient(c - ahead, aside + root)]
    } else {
        [quotient(c - ahead, aside - root), quotient(aside - root, c + ahead)]
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn heading(radians: f64) -> Vector2<f64> {
        Vector2::new(radians.cos(), radians.sin())
    }

    /// The middle of a place, in radians from the sector's axis.
    fn azimuth(place: usize, half_angle: f64) -> f64 {
        let u = (half_angle / 2.0).tan() * ((place as f64 + 0.5) * 2.0 / PLACES as f64 - 1.0);
        2.0 * u.atan()
    }

    fn cast(axis: f64, half_angle: f64, w: Vector2<f64>, range: [f64; 2]) -> [i32; PLACES] {
        let mut ballot = Ballot::new();
        Sector::new(heading(axis), (half_angle / 2.0).tan()).cast(&mut ballot, w, range, 7, |_| true);
        ballot.count(0)
    }

    #[test]
    fn projection_between_half_and_one_is_sixty_degrees_to_either_side() {
        // w ahead and of length 1: n·w = cos(azimuth) ≥ ½ within 60°.
        let counted = cast(0.3, 80f64.to_radians(), heading(0.3), [0.5, 2.0]);
        for (place, &votes) in counted.iter().enumerate() {
            let within = azimuth(place, 80f64.to_radians()).abs() < 60f64.to_radians();
            assert_eq!(votes, if within { 7 } else { 0 }, "{place}");
        }
    }

    #[test]
    fn interval_narrower_than_a_place_is_not_lost() {
        let counted = cast(0.0, 0.2, heading(1.0), [0.95f64.cos(), 0.949_999f64.cos()]);
        assert_eq!(counted.iter().sum::<i32>(), 7);
    }

    /// Behind w, 0.3° from the right edge: one side of the interval is narrower than the place in which the other begins.
    #[test]
    fn place_in_which_both_sides_of_an_interval_meet_is_counted_once() {
        let axis = 0.665_131_590_428_767_5;
        let counted = cast(axis, 1.297_514_094_622_743_7, heading(2.514_915_046_854_537_4) * 0.01, [-0.0102, -0.0092]);
        assert_eq!(counted[0], 7);
        assert!(counted.iter().all(|&votes| votes == 0 || votes == 7));
    }

    #[test]
    fn interval_about_w_narrower_than_a_place_is_counted_once() {
        let counted = cast(0.0, 0.2, heading(0.05), [0.999_999_9, 2.0]);
        assert_eq!(counted.iter().sum::<i32>(), 7);
    }

    #[test]
    fn handicap_is_taken_from_every_place() {
        assert_eq!(Ballot::new().count(3), [-3; PLACES]);
    }

    proptest! {
        /// Against each place's own projection, by trigonometry; places at an interval's very end may be either.
        #[test]
        fn votes_fall_where_the_projection_lies_between_the_bounds(
            axis in -3.2..3.2f64,
            half_angle in 0.01..1.57f64,
            direction in -3.2..3.2f64,
            length in 0.01..10f64,
            middle in -1.2..1.2f64,
            half_width in 0.05..0.5f64,
        ) {
            let w = heading(direction) * length;
            let (low, high) = ((middle - half_width) * length, (middle + half_width) * length);
            let counted = cast(axis, half_angle, w, [low, high]);
            let step = half_angle * 2.0 / PLACES as f64;
            for (place, &votes) in counted.iter().enumerate() {
                let at = |azimuth: f64| {
                    let projection = length * (axis + azimuth - direction).cos();
                    low <= projection && projection <= high
                };
                let azimuth = azimuth(place, half_angle);
                let near = [at(azimuth - step), at(azimuth), at(azimuth + step)];
                if near == [true; 3] {
                    prop_assert_eq!(votes, 7, "place {}", place);
                } else if near == [false; 3] {
                    prop_assert_eq!(votes, 0, "place {}", place);
                }
            }
        }
    }
}

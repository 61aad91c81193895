//! The poll: which azimuth of an arc, and which shape there, the readings that look there agree on.

use nalgebra::{Point2, Vector2};

use super::{
    ballot::{Ballot, PLACES, Sector},
    fit::Shape,
    witness::{Tolerance, Vote, Witness},
};
use crate::{
    arc::{ReportedArc, dot},
    partners::Partners,
    scalar::Scalar,
};

/// So many votes are one bit: they double or halve the odds of an azimuth.
pub(super) const BIT: u32 = 16;
/// A witness for a point: odds of 5.2.
const FOR_POINT: u32 = 38;
/// A witness for a wall: odds of 3.7. Fewer than for a point, because neighbours on a path agree on a wall with the same
/// error.
const FOR_WALL: u32 = 30;
/// A witness against: odds of 2.7. Not more, because it may be a ghost itself.
const AGAINST: i32 = 23;
/// What a reflector has to beat: that its witnesses agree by accident. Odds of 12.
const HANDICAP: i32 = 58;
/// Azimuths with fewer votes than a maximum, but by no more than this, belong to it.
const DROP: i32 = 28;
/// tan of a quarter of the 55° beyond a beam's edge in which a diffuse wall's normal is looked for, in thousandths.
const EDGE_TANGENT: u32 = 245;
/// What a wall at the beam's edge has to beat.
const EDGE_HANDICAP: i32 = 92;
/// And how many votes it can have: that others see a wall says little of what this reading heard.
const EDGE_MOST: i32 = 185;
/// Maxima at which witnesses against are heard.
const MAXIMA: usize = 6;

/// The hypothesis that fared best.
#[derive(Debug, Clone, Copy)]
pub(super) struct Winner<T: Scalar> {
    pub shape: Shape,
    /// Its direction from the sensor, a unit vector.
    pub direction: Vector2<T>,
}

/// One arc before the readings that look there.
pub(super) struct Poll<'a, T: Scalar> {
    arc: &'a ReportedArc<T>,
    partners: &'a Partners<'a, T>,
    /// Their slots.
    near: &'a [T],
    tolerance: Tolerance<T>,
    window: T,
}

/// Votes for a point and for a wall at every place of the arc.
type Votes = [[i32; PLACES]; 2];

impl<'a, T: Scalar> Poll<'a, T> {
    /// Gathers the readings that may have a word on any azimuth of `arc`; `room` takes their slots.
    pub fn new(
        arc: &'a ReportedArc<T>,
        partners: &'a Partners<'a, T>,
        room: &'a mut [T],
        tolerance: Tolerance<T>,
        window: T,
    ) -> Self {
        let mut count = 0;
        let (middle, reach) = (arc.arc.middle(), arc.arc.reach + window);
        partners.for_each_reading(|slot| {
            let concerned = Witness::of(partners.columns, slot).is_some_and(|witness| witness.concerns(middle, reach));
            if let (true, Some(place)) = (concerned, room.get_mut(count)) {
                // Exact in an f32 up to 16.8 million slots; a map beyond that has no witnesses there.
                *place = T::from_count(slot as u32);
                count += 1;
            }
        });
        Self { arc, partners, near: room.get(..count).unwrap_or_default(), tolerance, window }
    }

    pub const fn arc(&self) -> &ReportedArc<T> {
        self.arc
    }

    pub const fn tolerance(&self) -> &Tolerance<T> {
        &self.tolerance
    }

    pub const fn window(&self) -> T {
        self.window
    }

    /// The reading in a slot.
    #[inline]
    pub fn witness(&self, slot: T) -> Option<Witness<T>> {
        Witness::of(self.partners.columns, slot.to_count() as usize)
    }

    /// The readings that may have a word, with their slots.
    #[inline]
    pub fn witnesses(&self) -> impl Iterator<Item = (T, Witness<T>)> {
        self.near.iter().filter_map(|&slot| Some((slot, self.witness(slot)?)))
    }

    /// The best hypothesis, and the share of all that the readings allow which lies at its azimuth, or within half of
    /// `interval` (metres along the arc) of it. `None` where that can't be much.
    pub fn decide(&self, interval: T) -> Option<(Winner<T>, T)> {
        let axis = self.arc.arc.axis() / self.arc.arc.radius();
        let edge = self.arc.arc.reach / (self.arc.arc.radius() * T::TWO);
        let sector = Sector::new(axis, edge);
        let mut votes = self.count(&sector);
        let best = self.hear_those_against(&sector, &mut votes)?;
        let middle = T::from_count((best.from + best.to) as u32) * T::HALF;
        // Half the interval, in places.
        let half = (interval / self.arc.arc_length() * T::from_count(PLACES as u32 / 2)).to_count() as usize;
        let mut shares = Shares::at(&best, &votes, half.clamp(1, PLACES));
        // What is in doubt already needs no rival.
        if best.shape == Shape::Point && shares.confidence::<T>() >= T::HALF {
            shares = shares.beside(self.edge_rival(&sector, edge));
        }
        Some((Winner { shape: best.shape, direction: sector.direction(sector.at(middle)) }, shares.confidence()))
    }

    /// Counts the votes for.
    fn count(&self, sector: &Sector<T>) -> Votes {
        let (mut point, mut wall) = (Ballot::new(), Ballot::new());
        for (_, witness) in self.witnesses() {
            if witness.echo {
                self.vote_for_point(sector, &mut point, &witness);
                self.vote_for_wall(sector, &mut wall, &witness);
            }
        }
        [point.count(HANDICAP), wall.count(HANDICAP)]
    }

    /// Casts a witness's votes for a point: for the azimuths n from which it is as far as it reports. With w from the arc's
    /// sensor to the witness's, D² = r² + w² − 2 r n·w.
    fn vote_for_point(&self, sector: &Sector<T>, ballot: &mut Ballot, witness: &Witness<T>) {
        let (sensor, radius) = (self.arc.arc.sensor(), self.arc.arc.radius());
        let w = witness.sensor - sensor;
        let sum = radius * radius + dot(w, w);
        let scale = T::HALF / radius;
        let at = |distance: T| (sum - distance * distance) * scale;
        let nearest = witness.range - self.tolerance.agree;
        let nearest = if nearest > T::ZERO { nearest } else { T::ZERO };
        let cosine = (radius * radius + witness.range * witness.range - dot(w, w)) / (radius * witness.range * T::TWO);
        let votes = votes_for_point(T::ONE - cosine * cosine);
        if votes > 0 {
            sector.cast(ballot, w, [at(witness.range + self.tolerance.agree), at(nearest)], votes, |direction| {
                witness.sees(sensor + direction * radius - witness.sensor)
            });
        }
    }

    /// Casts a witness's votes for a wall: for the normals n that make it as far as it reports. With w from the witness's
    /// sensor to the arc's, D = r + n·w.
    fn vote_for_wall(&self, sector: &Sector<T>, ballot: &mut Ballot, witness: &Witness<T>) {
        let w = self.arc.arc.sensor() - witness.sensor;
        let farther = witness.range - self.arc.arc.radius();
        let offset_squared = dot(w, w) - farther * farther;
        if !(offset_squared <= self.window * self.window) {
            return;
        }
        let votes = votes_for_wall(offset_squared);
        if votes > 0 {
            let range = [farther - self.tolerance.agree, farther + self.tolerance.agree];
            sector.cast(ballot, w, range, votes, |direction| witness.sees(direction));
        }
    }

    /// Hears the witnesses against at the best maxima, in order of their votes, until the rest can't win.
    fn hear_those_against(&self, sector: &Sector<T>, votes: &mut Votes) -> Option<Best> {
        let mut unheard = *votes;
        let mut best: Option<Best> = None;
        for _ in 0..MAXIMA {
            let Some(next) = maximum(&unheard) else { break };
            if next.net < 0 || best.is_some_and(|best| next.net < best.net - DROP) {
                break;
            }
            let middle = T::from_count((next.from + next.to) as u32) * T::HALF;
            let against = self.against(next.shape, sector.direction(sector.at(middle))) * AGAINST;
            let [votes, unheard] = [&mut *votes, &mut unheard].map(|votes| {
                let of_shape = votes.get_mut(next.shape as usize);
                of_shape.and_then(|votes| votes.get_mut(next.from..next.to)).unwrap_or_default()
            });
            votes.iter_mut().for_each(|votes| *votes -= against);
            unheard.fill(HEARD);
            let next = Best { net: next.net - against, ..next };
            if best.is_none_or(|best| next.net > best.net) {
                best = Some(next);
            }
        }
        best
    }

    /// Votes for what is told from a point by nothing on the arc: a smooth diffuse wall that the beam meets aslant and
    /// hears at its edge. The wall goes through an end of the arc, with a normal beyond it.
    fn edge_rival(&self, sector: &Sector<T>, edge: T) -> i32 {
        let half = T::from_count(EDGE_TANGENT) / T::from_count(1000);
        let turned = (edge + half) / (T::ONE - edge * half);
        let mut most = i32::MIN + EDGE_HANDICAP;
        for side in [T::ONE, -T::ONE] {
            let normals = Sector::new(sector.direction(turned * side), half);
            let end = self.arc.arc.sensor() + sector.direction(edge * side) * self.arc.arc.radius();
            let mut ballot = Ballot::new();
            for (_, witness) in self.witnesses() {
                let w = end - witness.sensor;
                let offset_squared = dot(w, w) - witness.range * witness.range;
                if witness.echo && offset_squared <= self.window * self.window {
                    let votes = votes_for_wall(offset_squared);
                    let range = [witness.range - self.tolerance.agree, witness.range + self.tolerance.agree];
                    if votes > 0 {
                        normals.cast(&mut ballot, w, range, votes, |direction| witness.sees(direction));
                    }
                }
            }
            let counted = ballot.count(0);
            let Some((place, &votes)) = counted.iter().enumerate().max_by_key(|(_, votes)| **votes) else { continue };
            let normal = normals.direction(normals.at(T::from_count(place as u32) + T::HALF));
            let against = self
                .witnesses()
                .filter(|(_, witness)| witness.on_wall(end, normal, self.window, &self.tolerance).0 == Vote::Against);
            most = most.max((votes - against.count() as i32 * AGAINST).min(EDGE_MOST));
        }
        most - EDGE_HANDICAP
    }

    /// How many are against.
    fn against(&self, shape: Shape, direction: Vector2<T>) -> i32 {
        let position: Point2<T> = self.arc.arc.sensor() + direction * self.arc.arc.radius();
        let is_against = |witness: &Witness<T>| match shape {
            Shape::Point => witness.on_point(position, &self.tolerance) == Vote::Against,
            Shape::Wall => witness.on_wall(position, direction, self.window, &self.tolerance).0 == Vote::Against,
        };
        self.witnesses().filter(|(_, witness)| is_against(witness)).count() as i32
    }
}

/// A maximum: places `from..to` of a shape, with the votes of the best of them.
#[derive(Debug, Clone, Copy)]
struct Best {
    shape: Shape,
    from: usize,
    to: usize,
    net: i32,
}

/// Votes of a witness for a point that it sees under an angle of so much sin²θ to the arc's own ray: all from 14° on.
pub(super) fn votes_for_point<T: Scalar>(sine_squared: T) -> i32 {
    votes(FOR_POINT, sine_squared / (T::from_count(6) / T::from_count(100)))
}

/// Votes of a witness for a wall that it hears so far along it from the echo (squared, in m²): all from 0.3 m on.
pub(super) fn votes_for_wall<T: Scalar>(offset_squared: T) -> i32 {
    votes(FOR_WALL, offset_squared / (T::from_count(9) / T::from_count(100)))
}

/// Votes of full weight `most`, of a weight that counts up to 1.
fn votes<T: Scalar>(most: u32, weight: T) -> i32 {
    if !(weight > T::ZERO) {
        return 0;
    }
    let weight = if weight < T::ONE { weight } else { T::ONE };
    (T::from_count(most) * weight + T::HALF).to_count() as i32
}

/// What a place has that has been heard: fewer votes than any other.
const HEARD: i32 = i32::MIN;

/// The best place, with its neighbours that are nearly as good.
fn maximum(votes: &Votes) -> Option<Best> {
    let most = |shape: Shape| votes.get(shape as usize).and_then(|votes| votes.iter().copied().max());
    let (point, wall) = (most(Shape::Point)?, most(Shape::Wall)?);
    let (shape, net) = if wall > point { (Shape::Wall, wall) } else { (Shape::Point, point) };
    let votes = votes.get(shape as usize)?;
    let place = votes.iter().position(|&votes| votes == net)?;
    let belongs = |place: &usize| votes.get(*place).is_some_and(|&votes| votes >= net.saturating_sub(DROP));
    let to = (place + 1..PLACES).take_while(belongs).last().unwrap_or(place) + 1;
    let from = (0..place).rev().take_while(belongs).last().unwrap_or(place);
    (net != HEARD).then_some(Best { shape, from, to, net })
}

/// 2^24 · 2^(−k/16): the odds of k votes fewer.
const ODDS: [u32; BIT as usize] = [
    16_777_216, 16_065_917, 15_384_775, 14_732_511, 14_107_901, 13_509_772, 12_937_002, 12_388_516, 11_863_283,
    11_360_319, 10_878_679, 10_417_458, 9_975_792, 9_552_851, 9_147_842, 8_760_003,
];

/// Odds of `net` votes relative to `most`, which is not fewer.
fn odds(net: i32, most: i32) -> u64 {
    let fewer = most.wrapping_sub(net).unsigned_abs();
    let odds = ODDS.get((fewer % BIT) as usize).copied().unwrap_or(0);
    u64::from(odds >> (fewer / BIT).min(31))
}

/// How the odds are shared out.
#[derive(Debug, Clone, Copy)]
struct Shares {
    /// Votes of the best place, or of the accident that beats it.
    most: i32,
    /// Odds at a maximum, of point and wall.
    within: u64,
    /// Odds of point and wall at every place, and that none of them is true.
    all: u64,
}

impl Shares {
    /// At the places of a maximum, or within `half` places of its middle where that is more.
    fn at(best: &Best, votes: &Votes, half: usize) -> Self {
        // Rounded outwards on both sides.
        let (right, left) = ((best.from + best.to) / 2, (best.from + best.to).div_ceil(2));
        let near = best.from.min(right.saturating_sub(half))..best.to.max(left + half).min(PLACES);
        let most = votes.iter().flatten().copied().max().unwrap_or(0).max(0);
        let sum = |votes: &[i32]| votes.iter().map(|&net| odds(net, most)).sum::<u64>();
        let within = votes.iter().map(|votes| sum(votes.get(near.clone()).unwrap_or_default())).sum();
        let all = votes.iter().map(|votes| sum(votes)).sum::<u64>() + odds(0, most) * PLACES as u64;
        Self { most, within, all }
    }

    /// With a rival of so many votes; more than the best has make no difference any more.
    fn beside(&self, rival: i32) -> Self {
        Self { all: self.all + odds(rival.min(self.most), self.most) * PLACES as u64, ..*self }
    }

    /// The maximum's share. Sums stay below 2^34.
    fn confidence<T: Scalar>(&self) -> T {
        T::from_count((self.within >> 8) as u32) / T::from_count(((self.all >> 8) as u32).max(1))
    }
}

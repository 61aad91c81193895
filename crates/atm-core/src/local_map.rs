//! The local map: which readings are partners when (Sec. IV-D, Length of sonar history): by travel, or the last H of every
//! sensor.
mod by_travel;

use nalgebra::{Point2, Vector2};

use crate::{
    columns::{Columns, Entry, Ring},
    error::DomainError,
    pose::{Odometer, Travel},
    scalar::Scalar,
    storage::Storage,
    sweep::Boxes,
};

/// The local map by travel: it spans a length of path, and keeps its readings spaced (Sec. IV-D).
///
/// What the paper derives is a travel, 2 d sin(θmin/2): so far a robot has to move before arcs on something at distance d
/// cross at θmin. A reading stays as a partner when its sensor has moved by the spacing, or turned by half its beam, since
/// the last one of it that stayed; until then the newest one replaces the one before it. So the map holds the same picture
/// at any rate and speed, nothing piles up while the robot stands, and every reading still gets its echo.
///
/// ```
/// use atm_core::{Bounds, MinAngle, Span};
/// // Ten readings of each sensor over the 1.31 m that a crossing of 30° at 100 in takes.
/// let bounds = Bounds::<f64>::NONE.with_span(Span::for_reach(2.54, &MinAngle::PAPER, 10)?);
/// assert!((bounds.span().unwrap().step() - 0.1315).abs() < 1e-4);
/// # Ok::<(), atm_core::DomainError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span<T> {
    pub(crate) travel: Travel,
    pub(crate) step: T,
}

impl<T: Scalar> Span<T> {
    /// A robot that covers more than this share of the span from one reading to the next is sparse with readings: what lies
    /// between two of them counts as no more of the span, and the map holds the paper's ten (Sec. IV-D) at least.
    pub const LONGEST_STEP: u16 = 10;

    /// A map of the last `travel` metres of path, in (0, 1000], with a reading of each sensor for every `travel / history`
    /// of it.
    ///
    /// # Errors
    /// [`DomainError::MaxTravel`].
    pub fn new(travel: T, history: u16) -> Result<Self, DomainError> {
        let history = T::from_count(u32::from(history.max(1)));
        Ok(Self { travel: Travel::from_metres(travel)?, step: travel / history })
    }

    /// The travel after which arcs on something at `reach` (metres, positive) cross at θmin: 2 reach sin(θmin/2).
    ///
    /// # Errors
    /// [`DomainError::Distance`], [`DomainError::MaxTravel`].
    pub fn for_reach(reach: T, min_angle: &crate::MinAngle<T>, history: u16) -> Result<Self, DomainError> {
        Self::new(crate::resolution::travel(reach, min_angle)?, history)
    }

    /// With another spacing, in metres: a little below what the robot covers from one reading to the next, where H is small and
    /// each reading is to stay.
    ///
    /// # Errors
    /// [`DomainError::MinStep`] unless it is positive and finite.
    pub fn with_step(self, step: T) -> Result<Self, DomainError> {
        if step > T::ZERO && step.finite() { Ok(Self { step, ..self }) } else { Err(DomainError::MinStep) }
    }

    /// The path that the map spans, in metres.
    pub fn travel(&self) -> T {
        T::from_count(self.travel.0) / T::MICROMETRES
    }

    /// The spacing, in metres.
    pub const fn step(&self) -> T {
        self.step
    }
}

/// More bounds on the local map than H, and readings that take no place in it.
///
/// ```
/// use atm_core::{Bounds, Travel};
/// let bounds = Bounds::<f64>::NONE.with_max_age(30_000_000_000).with_max_travel(Travel::from_metres(5.0)?);
/// # Ok::<(), atm_core::DomainError>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Bounds<T> {
    pub(crate) max_age: Option<u64>,
    pub(crate) max_travel: Option<Travel>,
    pub(crate) min_step: Option<T>,
    pub(crate) held: Held,
    pub(crate) span: Option<Span<T>>,
}

/// What becomes of a reading that is equal to its sensor's previous one, all without echo being equal.
///
/// A ring that reports faster than it fires repeats values that it holds, which are no news; along a wall the same value
/// is news each time. Nothing in a reading tells the two apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Held {
    /// It is a reading like any other.
    #[default]
    Keep,
    /// It is skipped.
    Drop,
    /// Of a run of equal readings the first stays and the last before a change: each one after the second takes the place
    /// of the one before it. Right at both ends of a wall, and wrong by one held value at most. A run of more than 4 H
    /// begins anew every 4 H. With `latest` the ones after the second are partners to others, and are not reported.
    Edges,
}

impl<T: Scalar> Bounds<T> {
    /// H alone: the last H readings of every sensor, the paper's rule.
    pub const NONE: Self = Self { max_age: None, max_travel: None, min_step: None, held: Held::Keep, span: None };

    /// A reading leaves at the first arrival that is more than this later, in nanoseconds.
    pub const fn with_max_age(self, nanoseconds: u64) -> Self {
        Self { max_age: Some(nanoseconds), ..self }
    }

    /// A reading leaves at the first arrival after more than this much path.
    pub const fn with_max_travel(self, travel: Travel) -> Self {
        Self { max_travel: Some(travel), ..self }
    }

    /// A reading whose sensor moved less than this (metres, positive) since its last one in the local map is skipped.
    ///
    /// A robot that stands still repeats the same crossing with every reading, and so turns a single into a confident
    /// median.
    pub fn with_min_step(self, metres: T) -> Result<Self, crate::DomainError> {
        if !(metres > T::ZERO && metres.finite()) {
            return Err(crate::DomainError::MinStep);
        }
        Ok(Self { min_step: Some(metres), ..self })
    }

    /// What becomes of readings equal to their sensor's previous ones.
    pub const fn with_held(self, held: Held) -> Self {
        Self { held, ..self }
    }

    /// What becomes of a reading equal to its sensor's previous one.
    pub const fn held(&self) -> Held {
        self.held
    }

    /// The local map spans a travel, and its readings are spaced; H is the most readings of a sensor that it holds.
    pub const fn with_span(self, span: Span<T>) -> Self {
        Self { span: Some(span), ..self }
    }

    /// The travel that the local map spans, where it is not H readings alone.
    pub const fn span(&self) -> Option<Span<T>> {
        self.span
    }

    /// Between which lengths a step of the robot counts as path.
    pub(crate) fn steps(&self) -> (T, Travel) {
        match self.span {
            Some(span) => (span.step * T::HALF, Travel(span.travel.0 / u32::from(Span::<T>::LONGEST_STEP))),
            None => (T::ZERO, Odometer::<T>::LONGEST_STEP),
        }
    }

    /// The longest path between partners, where there is a bound.
    fn longest_path(&self) -> Option<Travel> {
        let span = self.span.map(|span| span.travel);
        match (span, self.max_travel) {
            (Some(span), Some(most)) => Some(if span.0 < most.0 { span } else { most }),
            (span, most) => span.or(most),
        }
    }
}

/// What decides who leaves when a reading arrives.
pub(crate) struct Newcomer {
    pub sensor: u16,
    pub t: i64,
    pub travel: Travel,
}

/// The storage, and what has arrived and left so far.
#[derive(Debug, Clone)]
pub(crate) struct LocalMap<S> {
    pub(crate) storage: S,
    /// Departed readings stay until no arc that met them is present.
    keeps_departed: bool,
    /// Number of the next arrival, counted with wrapping.
    arrivals: u32,
    /// Number of the oldest arrival that may still be present.
    oldest: u32,
    /// Where the next arrival goes in the log.
    log_head: usize,
    /// The sensor whose departed readings were looked through last.
    turn: usize,
    /// By travel: no reading of the local map was taken before this time, or this much path.
    since: (i64, Travel),
    /// By travel: where the oldest reading that waits for its report is, and how many wait.
    waiting: (usize, usize),
}

impl<S> LocalMap<S> {
    pub(crate) const fn new(storage: S, keeps_departed: bool) -> Self {
        let (since, waiting) = ((0, Travel(0)), (0, 0));
        Self { storage, keeps_departed, arrivals: 0, oldest: 0, log_head: 0, turn: 0, since, waiting }
    }

    /// Whether a sensor's newest reading was taken at this time and place: what comes then says nothing new, and each of
    /// its crossings would count twice.
    pub(crate) fn repeats<T: Scalar>(&mut self, sensor: u16, t: i64, place: Point2<T>) -> bool
    where
        S: Storage<T>,
    {
        let columns = self.storage.columns();
        let Some(ring) = columns.rings.get(usize::from(sensor)) else { return false };
        let slot = usize::from(sensor) * columns.depth + usize::from(ring.newest);
        ring.last.is_some() && columns.time(slot) == t && columns.sensor_position(slot) == place
    }

    /// Whether nothing is in it, and nothing waits.
    pub(crate) fn is_empty<T: Scalar>(&mut self) -> bool
    where
        S: Storage<T>,
    {
        self.waiting.1 == 0 && self.storage.columns().rings.iter().all(|ring| ring.present == 0)
    }

    /// The number of the next arrival.
    pub(crate) const fn arrivals(&self) -> u32 {
        self.arrivals
    }

    /// Counts a sensor's equal readings in a row, this one included or the first of a new run: 0 for the first.
    pub(crate) fn count_run<T: Scalar>(&mut self, sensor: u16, goes_on: bool) -> u16
    where
        S: Storage<T>,
    {
        let columns = self.storage.columns();
        let Some(ring) = columns.rings.get_mut(usize::from(sensor)) else { return 0 };
        ring.since_oldest = if goes_on { ring.since_oldest.saturating_add(1) } else { 0 };
        ring.since_oldest
    }

    /// Puts a reading into its sensor's next slot, and says which.
    #[inline]
    pub(crate) fn enter<T: Scalar>(&mut self, sensor: u16, entry: Entry<T>) -> usize
    where
        S: Storage<T>,
    {
        let mut columns = self.storage.columns();
        let depth = columns.depth;
        if let Some(place) = columns.log.get_mut(self.log_head) {
            *place = sensor;
        }
        self.log_head = if self.log_head + 1 < columns.log.len() { self.log_head + 1 } else { 0 };
        let mut slot = usize::from(sensor) * depth;
        if let Some(ring) = columns.rings.get_mut(usize::from(sensor)) {
            ring.newest = if usize::from(ring.newest) + 1 < depth { ring.newest + 1 } else { 0 };
            ring.present += 1;
            ring.kept = if usize::from(ring.kept) < depth { ring.kept + 1 } else { ring.kept };
            ring.since_oldest += 1;
            slot += usize::from(ring.newest);
        }
        columns.write(slot, &Entry { arrival: self.arrivals, ..entry });
        self.arrivals = self.arrivals.wrapping_add(1);
        slot
    }

    /// Takes the newest reading of a sensor back, as if it had not arrived, if it and the one before it have this range, too.
    ///
    /// Its arrival stays in the log, where nothing answers to it any more.
    pub(crate) fn take_back_held<T: Scalar>(&mut self, sensor: u16, range: Option<T>) -> bool
    where
        S: Storage<T>,
    {
        let mut columns = self.storage.columns();
        let depth = columns.depth;
        let Some(ring) = columns.rings.get_mut(usize::from(sensor)) else { return false };
        let is_held = |age| {
            let slot = usize::from(sensor) * depth + back(ring.newest, age, depth);
            columns.radius.get(slot).copied().filter(|radius| *radius > T::ZERO) == range
        };
        if ring.present < 2 || !is_held(0) || !is_held(1) {
            return false;
        }
        let slot = usize::from(sensor) * depth + usize::from(ring.newest);
        ring.newest = back(ring.newest, 1, depth) as u16;
        ring.present -= 1;
        ring.kept = ring.kept.saturating_sub(1);
        columns.blank(slot);
        true
    }

    /// The slot of the next reading that has to leave before `newcomer` enters; oldest first.
    ///
    /// Rules (b) to (d) depend only on what came after a reading, so whoever they send away is the oldest of all; only
    /// rule (a), H later readings of its own sensor, can reach past it.
    #[inline]
    pub(crate) fn next_leaver<T: Scalar>(&mut self, newcomer: &Newcomer, bounds: &Bounds<T>) -> Option<usize>
    where
        S: Storage<T>,
    {
        let history = self.storage.history();
        let oldest = self.oldest_present();
        let columns = self.storage.columns();
        let ring = columns.rings.get(usize::from(newcomer.sensor))?;
        if let Some((_, slot)) = oldest {
            // The newcomer is its sensor's next reading. Of the oldest one's own sensor so many come only where each takes
            // the place of the one before it: rule (a) counts them once, the log one by one.
            let outpaced = usize::from(ring.since_oldest) + 1 >= 4 * history;
            let age = newcomer.t.wrapping_sub(columns.time(slot)) as u64;
            let aged = bounds.max_age.is_some_and(|limit| age > limit);
            let travel = newcomer.travel.0.wrapping_sub(columns.travelled(slot));
            let far = bounds.max_travel.is_some_and(|limit| travel > limit.0);
            if outpaced || aged || far {
                return Some(slot);
            }
        }
        (usize::from(ring.present) >= history).then(|| front(&columns, newcomer.sensor)).flatten()
    }

    /// The oldest reading of the local map: its sensor and slot.
    #[inline]
    pub(crate) fn oldest_present<T: Scalar>(&mut self) -> Option<(u16, usize)>
    where
        S: Storage<T>,
    {
        let columns = self.storage.columns();
        while self.oldest != self.arrivals {
            let sensor = logged(&columns, self.log_head, self.arrivals.wrapping_sub(self.oldest))?;
            if let Some(slot) = front(&columns, sensor)
                && columns.arrived(slot) == self.oldest
            {
                return Some((sensor, slot));
            }
            if let Some(ring) = columns.rings.get_mut(usize::from(sensor)) {
                ring.since_oldest = ring.since_oldest.saturating_sub(1);
            }
            self.oldest = self.oldest.wrapping_add(1);
        }
        None
    }

    /// Takes a sensor's oldest reading out of the local map.
    #[inline]
    pub(crate) fn depart<T: Scalar>(&mut self, slot: usize)
    where
        S: Storage<T>,
    {
        let mut columns = self.storage.columns();
        let sensor = slot.checked_div(columns.depth).unwrap_or(0);
        if let Some(ring) = columns.rings.get_mut(sensor) {
            ring.present = ring.present.saturating_sub(1);
        }
        if !self.keeps_departed {
            return columns.blank(slot);
        }
        if let Some(departure) = columns.departure.get_mut(slot) {
            *departure = self.arrivals;
        }
        self.forget_unmet(sensor);
        // One other sensor in turn, so that none is left out for long.
        self.turn = if self.turn + 1 < self.storage.columns().rings.len() { self.turn + 1 } else { 0 };
        self.forget_unmet(self.turn);
    }

    /// Stops keeping what left a sensor's ring before the oldest reading of the local map arrived: nothing present has met
    /// it.
    fn forget_unmet<T: Scalar>(&mut self, sensor: usize)
    where
        S: Storage<T>,
    {
        let oldest = self.oldest;
        let mut columns = self.storage.columns();
        while let Some(&ring) = columns.rings.get(sensor)
            && ring.kept > ring.present
        {
            let slot = sensor * columns.depth + back(ring.newest, ring.kept - 1, columns.depth);
            if columns.departed(slot).is_none_or(|departure| is_after(departure, oldest)) {
                break;
            }
            columns.blank(slot);
            if let Some(ring) = columns.rings.get_mut(sensor) {
                ring.kept -= 1;
            }
        }
    }

    /// The slot of the `ordinal`-th arrival since the oldest reading, if that one is present.
    pub(crate) fn present_at<T: Scalar>(&mut self, ordinal: u32) -> Option<usize>
    where
        S: Storage<T>,
    {
        let arrival = self.oldest.wrapping_add(ordinal);
        let columns = self.storage.columns();
        let sensor = logged(&columns, self.log_head, self.arrivals.wrapping_sub(arrival))?;
        let ring = columns.rings.get(usize::from(sensor))?;
        let depth = columns.depth;
        (0..ring.present)
            .map(|age| usize::from(sensor) * depth + back(ring.newest, age, depth))
            .find(|&slot| columns.arrived(slot) == arrival)
    }

    /// Arrivals since the oldest reading of the local map, that one included.
    pub(crate) const fn span(&self) -> u32 {
        self.arrivals.wrapping_sub(self.oldest)
    }

    /// Forgets what departed, when nothing is present.
    pub(crate) fn forget<T: Scalar>(&mut self)
    where
        S: Storage<T>,
    {
        let columns = self.storage.columns();
        for ring in columns.rings {
            *ring = Ring { newest: ring.newest, ..Ring::EMPTY };
        }
        columns.reach.fill(T::NAN);
        columns.boxes.fill(Boxes::EMPTY);
    }

    /// Brings the log of arrivals in order, the newest at its end, so that it can be made longer.
    pub(crate) fn unroll_log<T: Scalar>(&mut self)
    where
        S: Storage<T>,
    {
        let log = self.storage.columns().log;
        log.rotate_left(self.log_head.min(log.len()));
        self.log_head = log.len();
    }

    /// Goes on behind the newest arrival of an unrolled log, which may be longer by now.
    pub(crate) fn reroll_log<T: Scalar>(&mut self)
    where
        S: Storage<T>,
    {
        if self.log_head >= self.storage.columns().log.len() {
            self.log_head = 0;
        }
    }

    /// Moves the origin of the fixed frame.
    pub(crate) fn shift<T: Scalar>(&mut self, by: Vector2<T>)
    where
        S: Storage<T>,
    {
        self.storage.columns().shift(by);
    }
}

/// The slot of a sensor's oldest reading in the local map.
#[inline]
fn front<T: Scalar>(columns: &Columns<'_, T>, sensor: u16) -> Option<usize> {
    let ring = columns.rings.get(usize::from(sensor))?;
    let age = ring.present.checked_sub(1)?;
    let depth = columns.depth;
    Some(usize::from(sensor) * depth + back(ring.newest, age, depth))
}

/// The place `age` before `newest` in a ring of `depth`.
#[inline]
pub(crate) fn back(newest: u16, age: u16, depth: usize) -> usize {
    let (newest, age) = (usize::from(newest), usize::from(age));
    if newest >= age { newest - age } else { (newest + depth).saturating_sub(age) }
}

/// The sensor of the arrival that lies `back` before the log's head.
#[inline]
fn logged<T: Scalar>(columns: &Columns<'_, T>, head: usize, back: u32) -> Option<u16> {
    let back = back as usize;
    let place = if head >= back { head - back } else { (head + columns.log.len()).checked_sub(back)? };
    columns.log.get(place).copied()
}

/// Whether one count of arrivals lies after another; both wrap, and are never half the numbers apart.
pub(crate) const fn is_after(a: u32, b: u32) -> bool {
    a.wrapping_sub(b).cast_signed() > 0
}

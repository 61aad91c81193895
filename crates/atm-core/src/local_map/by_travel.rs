//! The local map by travel: spaced readings over a length of path, and reports that wait for what could still cross them.

use nalgebra::{Point2, Vector2};

use crate::{
    columns::{Columns, Entry, Waiting},
    local_map::{Bounds, LocalMap, Newcomer, back, front, is_after},
    pose::Travel,
    scalar::Scalar,
    sensor::Beam,
    storage::Storage,
};

/// How a reading takes its place among its sensor's.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    /// It takes the slot of the newest one, which leaves.
    replaces: bool,
    /// It stays: the next one does not take its slot.
    stays: bool,
}

impl<S> LocalMap<S> {
    /// Where a reading goes: it stays if its sensor has moved by `step`, or turned by half its beam, since the last one that
    /// stayed. `ousts`: it takes the newest one's place whatever that is.
    #[inline]
    pub(crate) fn place<T: Scalar>(
        &mut self,
        sensor: u16,
        at: (Point2<T>, Vector2<T>),
        beam: &Beam<T>,
        step: T,
        ousts: bool,
    ) -> Place
    where
        S: Storage<T>,
    {
        let columns = self.storage.columns();
        let Some(ring) = columns.rings.get(usize::from(sensor)).filter(|ring| ring.present > 0) else {
            return Place { replaces: false, stays: true };
        };
        let replaces = ring.passing || ousts;
        let age = u16::from(replaces);
        let last_that_stayed = usize::from(sensor) * columns.depth + back(ring.newest, age, columns.depth);
        let (place, boresight) = at;
        let stays = ring.present <= age || columns.has_moved(last_that_stayed, place, boresight, beam, step);
        Place { replaces, stays }
    }

    /// Takes everything out of the local map that is too old, or too far back along the path.
    #[inline]
    pub(crate) fn expire<T: Scalar>(&mut self, newcomer: &Newcomer, bounds: &Bounds<T>)
    where
        S: Storage<T>,
    {
        if !is_past(newcomer, self.since, bounds) {
            return;
        }
        self.since = (newcomer.t, newcomer.travel);
        for sensor in 0..self.storage.columns().rings.len() {
            while let Some((slot, taken)) = self.oldest_of(sensor as u16) {
                if is_past(newcomer, taken, bounds) {
                    self.depart(slot);
                    continue;
                }
                let path = |travel: Travel| newcomer.travel.0.wrapping_sub(travel.0);
                let travel = if path(taken.1) > path(self.since.1) { taken.1 } else { self.since.1 };
                self.since = (self.since.0.min(taken.0), travel);
                break;
            }
        }
    }

    /// A sensor's oldest reading in the local map: its slot, its time and the path until then.
    fn oldest_of<T: Scalar>(&mut self, sensor: u16) -> Option<(usize, (i64, Travel))>
    where
        S: Storage<T>,
    {
        let columns = self.storage.columns();
        let slot = front(&columns, sensor)?;
        Some((slot, (columns.time(slot), Travel(columns.travelled(slot)))))
    }

    /// The next reading that has waited long enough when `newcomer` comes to its `place`: everything that could still cross
    /// it is too old or too far along the path, or its sensor needs the slot of a partner.
    #[inline]
    pub(crate) fn next_due<T: Scalar>(
        &mut self,
        newcomer: &Newcomer,
        bounds: &Bounds<T>,
        place: Place,
    ) -> Option<Waiting<T>>
    where
        S: Storage<T>,
    {
        let limit = self.storage.history() * 2;
        let oldest = self.first_waiting()?;
        let past = is_past(newcomer, (oldest.arc.t, oldest.travel), bounds);
        let columns = self.storage.columns();
        let crowded = || {
            let ring = columns.rings.get(usize::from(newcomer.sensor))?;
            let last = ring.kept.checked_sub(1).filter(|_| usize::from(ring.kept) >= limit.min(columns.depth))?;
            let slot = usize::from(newcomer.sensor) * columns.depth + back(ring.newest, last, columns.depth);
            columns.departed(slot).filter(|&departure| is_after(departure, oldest.arrival))
        };
        let due = past || (!place.replaces && crowded().is_some());
        if due { self.take_waiting() } else { None }
    }

    /// Puts a reading into its place, and says into which slot.
    #[inline]
    pub(crate) fn enter_spaced<T: Scalar>(&mut self, sensor: u16, place: Place, entry: Entry<T>) -> usize
    where
        S: Storage<T>,
    {
        if !place.replaces {
            self.make_room(sensor);
        }
        let mut columns = self.storage.columns();
        let depth = columns.depth;
        let mut slot = usize::from(sensor) * depth;
        if let Some(ring) = columns.rings.get_mut(usize::from(sensor)) {
            if !place.replaces {
                ring.newest = if usize::from(ring.newest) + 1 < depth { ring.newest + 1 } else { 0 };
                ring.present += 1;
                ring.kept = if usize::from(ring.kept) < depth { ring.kept + 1 } else { ring.kept };
            }
            ring.passing = !place.stays;
            slot += usize::from(ring.newest);
        }
        columns.write(slot, &Entry { arrival: self.arrivals, ..entry });
        if self.waiting.1 == 0 {
            self.oldest = self.arrivals;
        }
        self.arrivals = self.arrivals.wrapping_add(1);
        slot
    }

    /// Makes room for one more reading of a sensor: at most H are in the local map, and as many that left are kept.
    fn make_room<T: Scalar>(&mut self, sensor: u16)
    where
        S: Storage<T>,
    {
        let history = self.storage.history();
        let columns = self.storage.columns();
        let present = columns.rings.get(usize::from(sensor)).map_or(0, |ring| usize::from(ring.present));
        if let Some(slot) = front(&columns, sensor).filter(|_| present >= history) {
            self.depart(slot);
        }
        let mut columns = self.storage.columns();
        let (depth, index) = (columns.depth, usize::from(sensor));
        if !self.keeps_departed {
            return;
        }
        let Some(ring) = columns.rings.get_mut(index) else { return };
        if usize::from(ring.kept) >= (2 * history).min(depth) {
            let slot = index * depth + back(ring.newest, ring.kept - 1, depth);
            ring.kept -= 1;
            columns.blank(slot);
        }
    }

    /// Lets a reading wait for its report. Where there is no room, hands out the one that has to be reported for it: the one
    /// that has waited longest, or itself.
    #[inline]
    pub(crate) fn wait<T: Scalar>(&mut self, reading: Waiting<T>) -> Option<Waiting<T>>
    where
        S: Storage<T>,
    {
        let room = self.storage.columns().waiting.len();
        let mut early = None;
        if self.waiting.1 >= room && !self.grow_waiting() {
            early = self.take_waiting();
            if early.is_none() {
                return Some(reading);
            }
        }
        let columns = self.storage.columns();
        let (first, count) = self.waiting;
        let place = first + count;
        let place = if place < columns.waiting.len() { place } else { place - columns.waiting.len() };
        if let Some(free) = columns.waiting.get_mut(place) {
            *free = reading;
            self.waiting.1 += 1;
        }
        early
    }

    fn grow_waiting<T: Scalar>(&mut self) -> bool
    where
        S: Storage<T>,
    {
        let waiting = self.storage.columns().waiting;
        let first = self.waiting.0.min(waiting.len());
        waiting.rotate_left(first);
        self.waiting.0 = 0;
        self.storage.grow_waiting()
    }

    /// Takes the reading out that has waited longest.
    pub(crate) fn take_waiting<T: Scalar>(&mut self) -> Option<Waiting<T>>
    where
        S: Storage<T>,
    {
        let taken = self.first_waiting()?;
        let room = self.storage.columns().waiting.len();
        self.waiting.0 = if self.waiting.0 + 1 < room { self.waiting.0 + 1 } else { 0 };
        self.waiting.1 -= 1;
        let next: Option<Waiting<T>> = self.first_waiting();
        self.oldest = next.map_or(self.arrivals, |next| next.arrival);
        Some(taken)
    }

    fn first_waiting<T: Scalar>(&mut self) -> Option<Waiting<T>>
    where
        S: Storage<T>,
    {
        let (first, count) = self.waiting;
        if count == 0 {
            return None;
        }
        self.storage.columns().waiting.get(first).copied()
    }

    /// Cancels the report of a sensor's newest reading, if it still waits.
    pub(crate) fn cancel_newest<T: Scalar>(&mut self, sensor: u16)
    where
        S: Storage<T>,
    {
        let (first, count) = self.waiting;
        let columns = self.storage.columns();
        let Some(ring) = columns.rings.get(usize::from(sensor)) else { return };
        let newest = columns.arrived(usize::from(sensor) * columns.depth + usize::from(ring.newest));
        let room = columns.waiting.len();
        for age in (0..count).rev() {
            let place = first + age;
            let place = if place < room { place } else { place - room };
            match columns.waiting.get_mut(place) {
                Some(waiting) if waiting.arrival == newest => {
                    // It keeps its turn, and its arc is none.
                    waiting.arc.arc = Waiting::NONE.arc.arc;
                    return;
                }
                Some(waiting) if is_after(waiting.arrival, newest) => {}
                _ => return,
            }
        }
    }

    /// Empties the local map; nothing waits any more.
    pub(crate) fn clear<T: Scalar>(&mut self)
    where
        S: Storage<T>,
    {
        self.waiting = (0, 0);
        self.oldest = self.arrivals;
        self.forget();
    }

    /// The slot of the reading of the local map that arrived first after the one before: `age` is how many arrivals ago that
    /// one was, `u32::MAX` for none. With its own age.
    pub(crate) fn next_present<T: Scalar>(&mut self, age: u32) -> Option<(usize, u32)>
    where
        S: Storage<T>,
    {
        let arrivals = self.arrivals;
        let columns = self.storage.columns();
        let next_of = |sensor: usize| next_of_ring(&columns, sensor, arrivals, age);
        (0..columns.rings.len()).filter_map(next_of).max_by_key(|&(_, age)| age)
    }
}

/// A sensor's oldest reading in the local map that arrived less than `age` arrivals ago: its slot, and how long ago that was.
fn next_of_ring<T: Scalar>(columns: &Columns<'_, T>, sensor: usize, arrivals: u32, age: u32) -> Option<(usize, u32)> {
    let ring = columns.rings.get(sensor)?;
    let of = |place: u16| {
        let slot = sensor * columns.depth + back(ring.newest, place, columns.depth);
        (slot, arrivals.wrapping_sub(columns.arrived(slot)))
    };
    // Readings that are older than `age` begin at this place from the newest on.
    let (mut low, mut high) = (0, ring.present);
    while low < high {
        let middle = low.midpoint(high);
        if of(middle).1 < age { low = middle + 1 } else { high = middle }
    }
    low.checked_sub(1).map(of)
}

/// Whether what was taken at a time and a length of path lies farther back than the bounds allow.
#[inline]
fn is_past<T: Scalar>(newcomer: &Newcomer, (t, travel): (i64, Travel), bounds: &Bounds<T>) -> bool {
    let age = newcomer.t.wrapping_sub(t).cast_unsigned();
    let path = newcomer.travel.0.wrapping_sub(travel.0);
    bounds.max_age.is_some_and(|limit| age > limit) || bounds.longest_path().is_some_and(|limit| path > limit.0)
}

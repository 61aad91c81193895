//! What a local map holds: columns of slots, a ring of them for each sensor.

use core::ops::Range;

use nalgebra::{Point2, Vector2};

use crate::{
    arc::{Arc, ReportedArc, dot},
    pose::Travel,
    scalar::Scalar,
    sensor::{Beam, RangeResolution},
    sweep::{BLOCK, Boxes, Field, Instructions},
};

/// A sensor's place in its ring of slots.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Ring<T> {
    /// Slot of the newest reading, from the ring's start.
    pub(crate) newest: u16,
    /// Readings in the local map.
    pub(crate) present: u16,
    /// Readings that some arc in the local map has met: those present and, in settled storage, some that left.
    pub(crate) kept: u16,
    /// Readings since the oldest arc of the local map arrived, that one included. By travel: equal readings in a row.
    pub(crate) since_oldest: u16,
    /// By travel: the newest reading is replaced by the next one, its sensor having moved too little since the one before.
    pub(crate) passing: bool,
    /// The last usable reading: metres, NaN for none without echo.
    pub(crate) last: Option<T>,
}

impl<T> Ring<T> {
    /// A sensor that has not been heard of.
    pub const EMPTY: Self = Self { newest: 0, present: 0, kept: 0, since_oldest: 0, passing: false, last: None };
}

/// The columns of a storage, S sensors · D slots long where nothing else is said.
#[derive(Debug)]
pub struct Columns<'a, T: Scalar> {
    /// D: slots of each sensor, one after the other.
    pub depth: usize,
    /// What the pass over the columns may use.
    pub instructions: Instructions,
    /// The middle of the arc; where nothing is, the boresight from the sensor, tan(φ/4) long.
    pub middle_x: &'a mut [T],
    /// The middle of the arc.
    pub middle_y: &'a mut [T],
    /// The arc's reach; NaN where there is no arc to meet.
    pub reach: &'a mut [T],
    /// The sensor's position.
    pub sensor_x: &'a mut [T],
    /// The sensor's position.
    pub sensor_y: &'a mut [T],
    /// The reading; where nothing is, the distance up to which that is said, negative; NaN for any other one without echo.
    pub radius: &'a mut [T],
    /// The reading's time.
    pub t: &'a mut [i64],
    /// The path travelled until the reading.
    pub travel: &'a mut [u32],
    /// The number of the arrival, counted with wrapping.
    pub arrival: &'a mut [u32],
    /// The number of the arrival that made it leave; itself while it is present. Empty unless settled.
    pub departure: &'a mut [u32],
    /// The beam's full angle. May be empty: then there is no snapshot.
    pub field_of_view: &'a mut [T],
    /// The range resolution. Empty where `field_of_view` is.
    pub range_resolution: &'a mut [T],
    /// The sensor of each arrival, a ring of 4 H S entries.
    pub log: &'a mut [u16],
    /// One for each sensor: S entries.
    pub rings: &'a mut [Ring<T>],
    /// A box for each [`BLOCK`] slots, of which D then has to be a multiple. May be empty: then every arc is tested.
    pub boxes: &'a mut [Boxes<T>],
    /// Readings that wait for what could still cross them. Empty unless settled.
    pub waiting: &'a mut [Waiting<T>],
}

/// A reading of a map by travel that waits for its report.
#[derive(Debug, Clone, Copy)]
pub struct Waiting<T: Scalar> {
    pub(crate) arc: ReportedArc<T>,
    pub(crate) arrival: u32,
    pub(crate) travel: Travel,
}

impl<T: Scalar> Waiting<T> {
    /// None. An arc of no length crosses nothing.
    pub const NONE: Self = Self { arc: ReportedArc::NONE, arrival: 0, travel: Travel(0) };
}

/// One reading as it enters a slot.
pub(crate) struct Entry<T: Scalar> {
    pub sensor_position: Point2<T>,
    pub arc: Option<Arc<T>>,
    pub boresight: Vector2<T>,
    /// How far a reading reaches that reports nothing, in metres, possibly +∞.
    pub beyond: Option<T>,
    pub t: i64,
    pub travel: Travel,
    pub arrival: u32,
    pub beam: Beam<T>,
    pub range_resolution: RangeResolution<T>,
}

/// Where a reading looks, and how far the first thing there is.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sight<T: Scalar> {
    pub sensor: Point2<T>,
    /// Along the boresight, and its length.
    pub axis: Vector2<T>,
    pub length: T,
    /// tan(φ/4), as numerator and denominator.
    pub tangent: [T; 2],
    /// Metres. Without an echo, how far it reaches: there is nothing before that.
    pub range: T,
    /// Whether there is an echo at that range.
    pub echo: bool,
}

fn put<V>(column: &mut [V], slot: usize, value: V) {
    if let Some(place) = column.get_mut(slot) {
        *place = value;
    }
}

fn get<V: Copy>(column: &[V], slot: usize, otherwise: V) -> V {
    column.get(slot).copied().unwrap_or(otherwise)
}

/// A column's part, empty where it ends before.
pub(crate) fn part<'a, V>(column: &'a [V], slots: &Range<usize>) -> &'a [V] {
    column.get(slots.clone()).unwrap_or_default()
}

impl<T: Scalar> Columns<'_, T> {
    #[inline(always)]
    pub(crate) fn write(&mut self, slot: usize, entry: &Entry<T>) {
        let (middle, radius, reach) = match &entry.arc {
            Some(arc) => (arc.middle, arc.radius, arc.reach),
            // No arc to meet, but a sight: see [`Columns::sight`].
            None => {
                let middle = entry.sensor_position + entry.boresight * entry.beam.quarter_tangent();
                (middle, entry.beyond.map_or(T::NAN, |limit| -limit), T::NAN)
            }
        };
        put(self.middle_x, slot, middle.x);
        put(self.middle_y, slot, middle.y);
        put(self.reach, slot, reach);
        put(self.sensor_x, slot, entry.sensor_position.x);
        put(self.sensor_y, slot, entry.sensor_position.y);
        put(self.radius, slot, radius);
        put(self.t, slot, entry.t);
        put(self.travel, slot, entry.travel.0);
        put(self.arrival, slot, entry.arrival);
        put(self.departure, slot, entry.arrival);
        put(self.field_of_view, slot, entry.beam.field_of_view());
        put(self.range_resolution, slot, entry.range_resolution.metres());
        if self.boxes.is_empty() {
            return;
        }
        // What a block still holds of a ring's last round stays in its box until the block is full.
        match slot % BLOCK {
            0 => self.fit_box(slot),
            _ => self.widen_box(slot),
        }
    }

    /// Blanks a slot out, so that nothing crosses its arc any more.
    #[inline(always)]
    pub(crate) fn blank(&mut self, slot: usize) {
        put(self.reach, slot, T::NAN);
        if !self.boxes.is_empty() && slot % BLOCK == BLOCK - 1 {
            self.fit_box(slot);
        }
    }

    /// Makes the box around a slot's block hold the slot's arc too.
    #[inline]
    fn widen_box(&mut self, slot: usize) {
        let block = slot / BLOCK;
        if let Some(boxes) = self.boxes.get_mut(block / BLOCK) {
            let at = |column: &[T]| get(column, slot, T::NAN);
            boxes.include(block % BLOCK, at(self.middle_x), at(self.middle_y), at(self.reach));
        }
    }

    /// Makes the box around a slot's block hold the arcs that are in it now, and no more.
    fn fit_box(&mut self, slot: usize) {
        let block = slot / BLOCK;
        let Some(boxes) = self.boxes.get_mut(block / BLOCK) else {
            return;
        };
        boxes.empty(block % BLOCK);
        let slots = block * BLOCK..(block + 1) * BLOCK;
        let (xs, ys) = (part(self.middle_x, &slots), part(self.middle_y, &slots));
        for ((&x, &y), &reach) in xs.iter().zip(ys).zip(part(self.reach, &slots)) {
            boxes.include(block % BLOCK, x, y, reach);
        }
    }

    /// What a sweep reads.
    #[inline(always)]
    pub(crate) fn field(&self) -> Field<'_, T> {
        Field {
            boxes: self.boxes,
            middle_x: self.middle_x.as_chunks().0,
            middle_y: self.middle_y.as_chunks().0,
            reach: self.reach.as_chunks().0,
            sensor_x: self.sensor_x.as_chunks().0,
            sensor_y: self.sensor_y.as_chunks().0,
            radius: self.radius.as_chunks().0,
        }
    }

    /// The slot's arc; NaN throughout where there is none.
    #[inline(always)]
    pub(crate) fn arc(&self, slot: usize) -> Arc<T> {
        let at = |column: &[T]| get(column, slot, T::NAN);
        Arc {
            sensor: self.sensor_position(slot),
            middle: Point2::new(at(self.middle_x), at(self.middle_y)),
            radius: at(self.radius),
            reach: at(self.reach),
        }
    }

    /// What the slot's reading says of the space before it; `None` for one that was too close, or invalid.
    ///
    /// A reading that reports nothing makes no arc. It is kept in the columns that an arc would take: as its radius the
    /// distance it reaches, negative, and as the arc's middle its boresight from the sensor, as long as the tangent of a
    /// quarter of its beam.
    #[inline(always)]
    pub(crate) fn sight(&self, slot: usize) -> Option<Sight<T>> {
        let Arc { sensor, middle, radius, reach } = self.arc(slot);
        let axis = middle - sensor;
        if radius > T::ZERO {
            let tangent = [reach, radius * T::TWO];
            return Some(Sight { sensor, axis, length: radius, tangent, range: radius, echo: true });
        }
        if !(radius < T::ZERO) {
            return None;
        }
        let length = (axis.x * axis.x + axis.y * axis.y).square_root();
        Some(Sight { sensor, axis, length, tangent: [length, T::ONE], range: -radius, echo: false })
    }

    /// Whether a sensor at `place` that looks along `boresight` (of unit length) has moved by `step` since the reading in the
    /// slot, or turned by half its beam.
    pub(crate) fn has_moved(
        &self,
        slot: usize,
        place: Point2<T>,
        boresight: Vector2<T>,
        beam: &Beam<T>,
        step: T,
    ) -> bool {
        let moved = place - self.sensor_position(slot);
        if moved.x * moved.x + moved.y * moved.y >= step * step {
            return true;
        }
        let axis = Point2::new(get(self.middle_x, slot, T::NAN), get(self.middle_y, slot, T::NAN))
            - self.sensor_position(slot);
        // cos(φ/2) by tan(φ/4), without its denominator. The axis' length would cost a root: both sides are squared where
        // they are positive.
        let tangent = beam.quarter_tangent() * beam.quarter_tangent();
        let (across, along) = (T::ONE - tangent, dot(axis, boresight) * (T::ONE + tangent));
        !(along > T::ZERO) || along * along <= across * across * dot(axis, axis)
    }

    pub(crate) fn sensor_position(&self, slot: usize) -> Point2<T> {
        Point2::new(get(self.sensor_x, slot, T::NAN), get(self.sensor_y, slot, T::NAN))
    }

    pub(crate) fn time(&self, slot: usize) -> i64 {
        get(self.t, slot, 0)
    }

    pub(crate) fn travelled(&self, slot: usize) -> u32 {
        get(self.travel, slot, 0)
    }

    pub(crate) fn arrived(&self, slot: usize) -> u32 {
        get(self.arrival, slot, 0)
    }

    /// The arrival at which the slot's reading left, if it has.
    pub(crate) fn departed(&self, slot: usize) -> Option<u32> {
        let departure = get(self.departure, slot, 0);
        (departure != self.arrived(slot)).then_some(departure)
    }

    pub(crate) fn shift(&mut self, by: Vector2<T>) {
        for x in self.middle_x.iter_mut().chain(self.sensor_x.iter_mut()) {
            *x -= by.x;
        }
        for y in self.middle_y.iter_mut().chain(self.sensor_y.iter_mut()) {
            *y -= by.y;
        }
        for slot in (0..self.boxes.len() * BLOCK * BLOCK).step_by(BLOCK) {
            self.fit_box(slot);
        }
    }
}

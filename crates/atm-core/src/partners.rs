//! The arcs that an arc may cross: the pass over the whole local map, in memory order and without a branch for each.

use core::ops::Range;

use nalgebra::Vector2;

use crate::{
    arc::Arc,
    crossing::{MinAngle, Triangle},
    local_map::{back, is_after},
    scalar::Scalar,
    storage::Columns,
};

/// Which arcs a reported arc is crossed with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scope {
    /// Those in the local map; departed ones have been blanked out.
    Present,
    /// Those in the local map, of a storage that keeps departed ones as well.
    PresentOfKept,
    /// Those that it met: each arrived before the other left.
    Met,
}

/// The arcs that a reported arc may cross.
pub struct Partners<'a, T> {
    pub(crate) columns: &'a Columns<'a, T>,
    pub(crate) slot: usize,
    pub(crate) scope: Scope,
}

/// Arcs tested in one loop without a branch, a bit of the result for each.
const BLOCK: usize = 32;

impl<T: Scalar> Partners<'_, T> {
    /// Visits the partners that may have a transversal crossing with `arc`, each with its slot: first their bounding
    /// circles, then the angle at which the circles cross, in memory order and without a branch for each; then, for the
    /// few that pass, whether the two have met.
    #[inline(always)]
    pub fn for_each_transversal(&self, arc: &Arc<T>, min_angle: &MinAngle<T>, mut visit: impl FnMut(usize, &Arc<T>)) {
        let arrival = self.columns.arrived(self.slot);
        let mut candidate = |slot: usize| {
            if slot != self.slot && self.meets(slot, arrival) {
                visit(slot, &self.columns.arc(slot));
            }
        };
        if self.scope == Scope::Present {
            return self.scan(0, self.columns.middle_x.len(), arc, min_angle, &mut candidate);
        }
        let depth = self.columns.depth();
        for (sensor, ring) in self.columns.rings.iter().enumerate() {
            let count = if self.scope == Scope::Met { ring.kept } else { ring.present };
            let Some(age) = count.checked_sub(1) else { continue };
            let start = sensor * depth;
            let (first, newest) = (back(ring.newest, age, depth), usize::from(ring.newest));
            if first <= newest {
                self.scan(start + first, start + newest + 1, arc, min_angle, &mut candidate);
            } else {
                self.scan(start + first, start + depth, arc, min_angle, &mut candidate);
                self.scan(start, start + newest + 1, arc, min_angle, &mut candidate);
            }
        }
    }

    fn meets(&self, slot: usize, arrival: u32) -> bool {
        match self.scope {
            Scope::Present => true,
            Scope::PresentOfKept => self.columns.departed(slot).is_none(),
            Scope::Met => self.columns.departed(slot).is_none_or(|departure| is_after(departure, arrival)),
        }
    }

    #[inline(always)]
    fn scan(&self, from: usize, to: usize, arc: &Arc<T>, min_angle: &MinAngle<T>, candidate: &mut impl FnMut(usize)) {
        if usize::BITS < 64 {
            return self.scan_singly(from..to, arc, candidate);
        }
        for start in (from..to).step_by(BLOCK) {
            let block = start..to.min(start + BLOCK);
            // Most blocks have no arc nearby; only the others are asked for the angle.
            let mut hits = self.near(block.clone(), arc);
            if hits != 0 {
                hits &= self.transversal(block, arc, min_angle);
            }
            while hits != 0 {
                candidate(start + hits.trailing_zeros() as usize);
                hits &= hits - 1;
            }
        }
    }

    /// The same for a microcontroller, which has no vectors to fill: each arc by itself, and no mask to shift.
    #[inline(always)]
    fn scan_singly(&self, slots: Range<usize>, arc: &Arc<T>, candidate: &mut impl FnMut(usize)) {
        let columns = self.columns;
        let (xs, ys) = (part(columns.middle_x, &slots), part(columns.middle_y, &slots));
        for (((slot, &x), &y), &reach) in slots.clone().zip(xs).zip(ys).zip(part(columns.reach, &slots)) {
            if is_near(arc, x, y, reach) {
                candidate(slot);
            }
        }
    }

    /// Which arcs of a block lie near enough to meet `arc`: a bit for each.
    #[inline(always)]
    fn near(&self, block: Range<usize>, arc: &Arc<T>) -> u64 {
        let columns = self.columns;
        let (xs, ys) = (part(columns.middle_x, &block), part(columns.middle_y, &block));
        let reaches = part(columns.reach, &block);
        mask(xs, ys, reaches, |x, y, reach| is_near(arc, x, y, reach))
    }

    /// Which arcs' circles cross that of `arc` steeply enough: a bit for each.
    #[inline(always)]
    fn transversal(&self, block: Range<usize>, arc: &Arc<T>, min_angle: &MinAngle<T>) -> u64 {
        let columns = self.columns;
        let (xs, ys) = (part(columns.sensor_x, &block), part(columns.sensor_y, &block));
        let radii = part(columns.radius, &block);
        mask(xs, ys, radii, |x, y, radius| {
            let between = Vector2::new(x - arc.sensor.x, y - arc.sensor.y);
            Triangle::new(between, arc.radius, radius).is_transversal(min_angle)
        })
    }
}

/// A bit for each place of three columns that passes a test, of at most 64.
#[inline(always)]
fn mask<T: Copy>(xs: &[T], ys: &[T], zs: &[T], test: impl Fn(T, T, T) -> bool) -> u64 {
    // Written out for a whole block, whose length the compiler then knows, and for what is left.
    if let (Some(xs), Some(ys), Some(zs)) = (xs.as_array::<BLOCK>(), ys.as_array::<BLOCK>(), zs.as_array::<BLOCK>()) {
        return collect(xs.iter().zip(ys).zip(zs), test);
    }
    collect(xs.iter().zip(ys).zip(zs), test)
}

#[inline(always)]
fn collect<'a, T: Copy + 'a>(
    places: impl Iterator<Item = ((&'a T, &'a T), &'a T)>,
    test: impl Fn(T, T, T) -> bool,
) -> u64 {
    places.enumerate().fold(0, |hits, (lane, ((&x, &y), &z))| hits | u64::from(test(x, y, z)) << lane)
}

/// Whether the circle of `reach` about the middle of an arc touches that about the middle of `arc`.
#[inline(always)]
fn is_near<T: Scalar>(arc: &Arc<T>, x: T, y: T, reach: T) -> bool {
    let (x, y, both) = (x - arc.middle.x, y - arc.middle.y, reach + arc.reach);
    // NaN, a slot without an arc, compares false.
    x * x + y * y <= both * both
}

fn part<'a, T>(column: &'a [T], block: &Range<usize>) -> &'a [T] {
    column.get(block.clone()).unwrap_or_default()
}

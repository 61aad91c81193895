//! The arcs that an arc may cross: the pass over the whole local map.

use core::ops::Range;

use crate::{
    arc::Arc,
    columns::{Columns, part},
    crossing::MinAngle,
    local_map::{back, is_after},
    scalar::Scalar,
    sweep::{BLOCK, Probe, SPAN, is_near},
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
pub struct Partners<'a, T: Scalar> {
    pub(crate) columns: &'a Columns<'a, T>,
    /// The arrival of the arc's own reading.
    pub(crate) arrival: u32,
    pub(crate) scope: Scope,
}

impl<T: Scalar> Partners<'_, T> {
    /// Visits the partners that may have a transversal crossing with `arc`, each with its slot: those whose bounding
    /// circle touches its own; on a storage with boxes, of these only those whose circle crosses its own steeply enough.
    #[inline(always)]
    pub fn for_each_transversal(&self, arc: &Arc<T>, min_angle: &MinAngle<T>, mut visit: impl FnMut(usize, &Arc<T>)) {
        let mut candidate = |slot: usize| {
            if self.meets(slot) {
                visit(slot, &self.columns.arc(slot));
            }
        };
        if self.columns.boxes.is_empty() {
            self.scan(arc, &mut candidate);
        } else {
            self.sweep(arc, min_angle, &mut candidate);
        }
    }

    /// Visits the slot of every reading that the arc met, with or without an echo, sensor by sensor.
    pub(crate) fn for_each_reading(&self, mut visit: impl FnMut(usize)) {
        let depth = self.columns.depth;
        for (sensor, ring) in self.columns.rings.iter().enumerate() {
            let count = if self.scope == Scope::Met { ring.kept } else { ring.present };
            for age in (0..count).rev() {
                let slot = sensor * depth + back(ring.newest, age, depth);
                if self.meets(slot) {
                    visit(slot);
                }
            }
        }
    }

    fn meets(&self, slot: usize) -> bool {
        if self.columns.arrived(slot) == self.arrival {
            return false;
        }
        match self.scope {
            Scope::Present => true,
            Scope::PresentOfKept => self.columns.departed(slot).is_none(),
            Scope::Met => self.columns.departed(slot).is_none_or(|departure| is_after(departure, self.arrival)),
        }
    }

    /// All slots at once, without those that boxes rule out: what is no longer kept has been blanked out.
    #[inline(always)]
    fn sweep(&self, arc: &Arc<T>, min_angle: &MinAngle<T>, candidate: &mut impl FnMut(usize)) {
        let (field, probe) = (self.columns.field(), Probe { arc, min_angle });
        let mut found = [0; SPAN];
        for first in (0..self.columns.middle_x.len() / BLOCK).step_by(SPAN) {
            let mut blocks = T::sweep(self.columns.instructions, &field, first, &probe, &mut found);
            while blocks != 0 {
                let index = blocks.trailing_zeros() as usize;
                let mut lanes = found.get(index).copied().unwrap_or(0);
                while lanes != 0 {
                    candidate((first + index) * BLOCK + lanes.trailing_zeros() as usize);
                    lanes &= lanes - 1;
                }
                blocks &= blocks - 1;
            }
        }
    }

    /// The slots of each sensor that are in the local map or kept, one after the other: what a microcontroller does, which
    /// has no vectors to fill.
    #[inline(always)]
    fn scan(&self, arc: &Arc<T>, candidate: &mut impl FnMut(usize)) {
        if self.scope == Scope::Present {
            return self.scan_singly(0..self.columns.middle_x.len(), arc, candidate);
        }
        let depth = self.columns.depth;
        for (sensor, ring) in self.columns.rings.iter().enumerate() {
            let count = if self.scope == Scope::Met { ring.kept } else { ring.present };
            let Some(age) = count.checked_sub(1) else { continue };
            let start = sensor * depth;
            let (first, newest) = (back(ring.newest, age, depth), usize::from(ring.newest));
            if first <= newest {
                self.scan_singly(start + first..start + newest + 1, arc, candidate);
            } else {
                self.scan_singly(start + first..start + depth, arc, candidate);
                self.scan_singly(start..start + newest + 1, arc, candidate);
            }
        }
    }

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
}

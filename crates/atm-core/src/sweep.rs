//! Which arcs of the local map may cross an arc: whole blocks of them are ruled out by a box, the others are tested eight
//! at a time and without a branch for each.
//!
//! The same arcs come out whatever instructions are used: every comparison is of the same numbers, computed by the same
//! operations in the same order.

#[cfg(target_arch = "x86_64")]
mod x86_64;

use nalgebra::Vector2;

use crate::{
    arc::Arc,
    crossing::{MinAngle, Triangle},
    scalar::Scalar,
};

/// Slots of a block, and blocks of a row: as many numbers as the widest vectors hold.
pub const BLOCK: usize = 8;

/// Blocks that one sweep goes over: a bit of a word for each.
pub(crate) const SPAN: usize = 64;

/// Boxes of eight blocks of arcs side by side. A box holds the middles of its arcs, and their farthest reach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Boxes<T> {
    low_x: [T; BLOCK],
    high_x: [T; BLOCK],
    low_y: [T; BLOCK],
    high_y: [T; BLOCK],
    reach: [T; BLOCK],
}

impl<T: Scalar> Boxes<T> {
    /// Boxes that hold nothing, and are near nothing.
    pub const EMPTY: Self = Self {
        low_x: [T::INFINITY; BLOCK],
        high_x: [T::NEGATIVE_INFINITY; BLOCK],
        low_y: [T::INFINITY; BLOCK],
        high_y: [T::NEGATIVE_INFINITY; BLOCK],
        reach: [T::ZERO; BLOCK],
    };

    /// Makes a box hold an arc too; not a slot without one, whose reach is NaN.
    #[inline]
    pub(crate) fn include(&mut self, lane: usize, x: T, y: T, reach: T) {
        if !(reach >= T::ZERO) {
            return;
        }
        let lower = |column: &mut [T; BLOCK], value: T| {
            if let Some(low) = column.get_mut(lane)
                && value < *low
            {
                *low = value;
            }
        };
        let raise = |column: &mut [T; BLOCK], value: T| {
            if let Some(high) = column.get_mut(lane)
                && value > *high
            {
                *high = value;
            }
        };
        lower(&mut self.low_x, x);
        raise(&mut self.high_x, x);
        lower(&mut self.low_y, y);
        raise(&mut self.high_y, y);
        raise(&mut self.reach, reach);
    }

    /// Makes a box hold nothing.
    #[inline]
    pub(crate) fn empty(&mut self, lane: usize) {
        let columns = [&mut self.low_x, &mut self.high_x, &mut self.low_y, &mut self.high_y, &mut self.reach];
        let infinity = T::INFINITY;
        for (column, value) in
            columns.into_iter().zip([infinity, T::NEGATIVE_INFINITY, infinity, T::NEGATIVE_INFINITY, T::ZERO])
        {
            if let Some(place) = column.get_mut(lane) {
                *place = value;
            }
        }
    }
}

/// The columns of the local map that a sweep reads, in blocks, and the boxes around those.
#[derive(Clone, Copy)]
pub struct Field<'a, T> {
    /// Each of eight blocks.
    pub boxes: &'a [Boxes<T>],
    pub middle_x: &'a [[T; BLOCK]],
    pub middle_y: &'a [[T; BLOCK]],
    pub reach: &'a [[T; BLOCK]],
    pub sensor_x: &'a [[T; BLOCK]],
    pub sensor_y: &'a [[T; BLOCK]],
    pub radius: &'a [[T; BLOCK]],
}

/// The columns of one block.
struct Block<'a, T> {
    middle_x: &'a [T; BLOCK],
    middle_y: &'a [T; BLOCK],
    reach: &'a [T; BLOCK],
    sensor_x: &'a [T; BLOCK],
    sensor_y: &'a [T; BLOCK],
    radius: &'a [T; BLOCK],
}

impl<'a, T> Field<'a, T> {
    #[inline(always)]
    fn block(&self, index: usize) -> Option<Block<'a, T>> {
        Some(Block {
            middle_x: self.middle_x.get(index)?,
            middle_y: self.middle_y.get(index)?,
            reach: self.reach.get(index)?,
            sensor_x: self.sensor_x.get(index)?,
            sensor_y: self.sensor_y.get(index)?,
            radius: self.radius.get(index)?,
        })
    }

    /// The boxes of the blocks from `first` on, [`SPAN`] of them at most.
    #[inline(always)]
    fn boxes(&self, first: usize) -> &'a [Boxes<T>] {
        let rest = self.boxes.get(first / BLOCK..).unwrap_or_default();
        rest.get(..SPAN / BLOCK).unwrap_or(rest)
    }
}

/// The arc whose partners are sought.
#[derive(Clone, Copy)]
pub struct Probe<'a, T: Scalar> {
    pub arc: &'a Arc<T>,
    pub min_angle: &'a MinAngle<T>,
}

/// What a sweep has found: a byte for each block, with a bit for each of its arcs.
pub type Found = [u8; SPAN];

/// Whether the circle of `reach` about the middle of an arc touches that about the middle of `arc`.
#[inline(always)]
pub(crate) fn is_near<T: Scalar>(arc: &Arc<T>, x: T, y: T, reach: T) -> bool {
    let (x, y, both) = (x - arc.middle.x, y - arc.middle.y, reach + arc.reach);
    // NaN, a slot without an arc, compares false.
    x * x + y * y <= both * both
}

/// Goes over the blocks from `first` on, [`SPAN`] of them at most, with whatever vectors the compiler makes of it. A bit of the
/// result is set where the byte of its block is not 0; the bytes of other blocks mean nothing.
pub(crate) fn sweep<T: Scalar>(field: &Field<'_, T>, first: usize, probe: &Probe<'_, T>, found: &mut Found) -> u64 {
    let (mut near, mut hit) = (0u64, 0u64);
    for (row, boxes) in field.boxes(first).iter().enumerate() {
        near |= u64::from(near_boxes(boxes, probe)) << (row * BLOCK);
    }
    while near != 0 {
        let index = near.trailing_zeros() as usize;
        near &= near - 1;
        if let (Some(block), Some(byte)) = (field.block(first + index), found.get_mut(index)) {
            *byte = transversal(&block, probe);
            hit |= u64::from(*byte != 0) << index;
        }
    }
    hit
}

/// Which boxes hold an arc that may be near.
///
/// Exactly so, rounding included: from a point outside a box, the nearest edge is at most as far as any middle inside, the
/// sum of reaches is at least as large, and subtraction, addition and squares round without changing an order.
#[inline]
fn near_boxes<T: Scalar>(boxes: &Boxes<T>, probe: &Probe<'_, T>) -> u8 {
    let Probe { arc, .. } = probe;
    let larger = |a: T, b: T| if a > b { a } else { b };
    let sides = boxes.low_x.iter().zip(&boxes.high_x).zip(boxes.low_y.iter().zip(&boxes.high_y));
    sides.zip(&boxes.reach).enumerate().fold(0, |bits, (lane, (((&west, &east), (&south, &north)), &reach))| {
        let x = larger(west - arc.middle.x, larger(arc.middle.x - east, T::ZERO));
        let y = larger(south - arc.middle.y, larger(arc.middle.y - north, T::ZERO));
        let both = reach + arc.reach;
        bits | u8::from(x * x + y * y <= both * both) << lane
    })
}

/// Which arcs of a block lie near enough to meet the probe, on a circle that crosses the probe's steeply enough.
#[inline]
fn transversal<T: Scalar>(block: &Block<'_, T>, probe: &Probe<'_, T>) -> u8 {
    let Probe { arc, min_angle } = probe;
    let near = block.middle_x.iter().zip(block.middle_y).zip(block.reach);
    let near =
        near.enumerate().fold(0, |bits, (lane, ((&x, &y), &reach))| bits | u8::from(is_near(arc, x, y, reach)) << lane);
    if near == 0 {
        return 0;
    }
    let circles = block.sensor_x.iter().zip(block.sensor_y).zip(block.radius);
    near & circles.enumerate().fold(0, |bits, (lane, ((&x, &y), &radius))| {
        let between = Vector2::new(x - arc.sensor.x, y - arc.sensor.y);
        bits | u8::from(Triangle::new(between, arc.radius, radius).is_transversal(min_angle)) << lane
    })
}

/// The vector instructions that a sweep in double precision may use. Whatever it uses, the same arcs come out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Instructions(Level);

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(not(all(target_arch = "x86_64", any(feature = "std", test))), allow(dead_code))]
enum Level {
    #[default]
    Baseline,
    Avx,
    Avx512,
}

impl Instructions {
    /// Those that every processor of the target has.
    pub const BASELINE: Self = Self(Level::Baseline);

    /// The widest that this processor has.
    #[cfg(any(feature = "std", test))]
    pub fn widest() -> Self {
        Self::available().last().unwrap_or_default()
    }

    /// All that this processor has, the widest last.
    #[cfg(any(feature = "std", test))]
    pub fn available() -> impl Iterator<Item = Self> {
        #[cfg(target_arch = "x86_64")]
        let (avx, avx512) = (std::is_x86_feature_detected!("avx"), std::is_x86_feature_detected!("avx512f"));
        #[cfg(not(target_arch = "x86_64"))]
        let (avx, avx512) = (false, false);
        let levels = [(true, Level::Baseline), (avx, Level::Avx), (avx512, Level::Avx512)];
        levels.into_iter().filter_map(|(has, level)| has.then_some(Self(level)))
    }

    /// Their name: `baseline`, `avx` or `avx512`.
    pub const fn name(self) -> &'static str {
        match self.0 {
            Level::Baseline => "baseline",
            Level::Avx => "avx",
            Level::Avx512 => "avx512",
        }
    }
}

/// [`sweep`] in double precision with the given instructions.
#[cfg_attr(not(target_arch = "x86_64"), allow(unused_variables))]
pub(crate) fn sweep_double(
    instructions: Instructions,
    field: &Field<'_, f64>,
    first: usize,
    probe: &Probe<'_, f64>,
    found: &mut Found,
) -> u64 {
    #[cfg(target_arch = "x86_64")]
    return x86_64::sweep(instructions.0, field, first, probe, found);
    #[cfg(not(target_arch = "x86_64"))]
    sweep(field, first, probe, found)
}

#[cfg(test)]
mod tests;

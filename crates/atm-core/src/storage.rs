//! Where the local map lives: arrays of const size on a microcontroller, anything else on a host.

use crate::{
    columns::{Columns, Ring, Waiting},
    scalar::Scalar,
    sweep::Instructions,
};

/// Memory for a local map: columns of slots, `D` of them for each sensor in turn, and a log of who arrived.
///
/// Implement it to keep the map elsewhere; the lengths that [`Columns`] asks for are all there is to it.
/// [`SnapshotStorage`] and [`SettledStorage`] say what more a storage can do.
pub trait Storage<T: Scalar> {
    /// H: readings of each sensor in the local map; at least 1.
    fn history(&self) -> usize;

    /// The columns.
    fn columns(&mut self) -> Columns<'_, T>;

    /// Makes room for more readings that wait for their report, behind those there are; `false` where it can't.
    fn grow_waiting(&mut self) -> bool {
        false
    }

    /// The columns, and room for the crossings on one arc: two for each slot.
    fn with_scratch<R>(&mut self, work: impl FnOnce(Columns<'_, T>, &mut [T]) -> R) -> R;
}

/// A storage whose columns `field_of_view` and `range_resolution` are not empty, so that arcs can be reported after
/// their arrival.
pub trait SnapshotStorage<T: Scalar>: Storage<T> {}

/// A storage with 5 H slots for each sensor and the column `departure`, so that an arc can be crossed with every arc it
/// met when it leaves.
///
/// An arc stays for fewer than 4 H readings of any other sensor, and finds at most H of them at its arrival.
pub trait SettledStorage<T: Scalar>: SnapshotStorage<T> {}

/// How many times H slots a [`SettledStorage`] has for each sensor.
pub const SETTLED_BLOCKS: usize = 5;

/// How many times H · sensors entries the log of arrivals has: an arc leaves at the 4 H-th reading of another sensor.
pub const LOG_BLOCKS: usize = 4;

/// Const storage for the causal mode alone: S sensors, H readings of each.
///
/// 40 bytes a slot in `f32` and 8 more of log, besides 16 a sensor: 16 sensors with H = 10 take 7.9 kB. A `static` can
/// hold it. Echoes of earlier arcs need [`Arrays`].
#[derive(Debug, Clone)]
pub struct LatestArrays<T, const S: usize, const H: usize> {
    middle_x: [[T; H]; S],
    middle_y: [[T; H]; S],
    reach: [[T; H]; S],
    sensor_x: [[T; H]; S],
    sensor_y: [[T; H]; S],
    radius: [[T; H]; S],
    t: [[i64; H]; S],
    travel: [[u32; H]; S],
    arrival: [[u32; H]; S],
    log: [[[u16; H]; LOG_BLOCKS]; S],
    rings: [Ring<T>; S],
}

impl<T: Scalar, const S: usize, const H: usize> LatestArrays<T, S, H> {
    const FITS: () = assert!(S >= 1 && S <= 65_535 && H >= 1 && H <= 10_000, "1 to 65,535 sensors, H from 1 to 10,000");

    /// Empty storage.
    pub const fn new() -> Self {
        let () = Self::FITS;
        Self {
            middle_x: [[T::NAN; H]; S],
            middle_y: [[T::NAN; H]; S],
            reach: [[T::NAN; H]; S],
            sensor_x: [[T::NAN; H]; S],
            sensor_y: [[T::NAN; H]; S],
            radius: [[T::NAN; H]; S],
            t: [[0; H]; S],
            travel: [[0; H]; S],
            arrival: [[0; H]; S],
            log: [[[0; H]; LOG_BLOCKS]; S],
            rings: [Ring::EMPTY; S],
        }
    }
}

impl<T: Scalar, const S: usize, const H: usize> Default for LatestArrays<T, S, H> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Scalar, const S: usize, const H: usize> Storage<T> for LatestArrays<T, S, H> {
    fn history(&self) -> usize {
        H
    }

    #[inline]
    fn columns(&mut self) -> Columns<'_, T> {
        Columns {
            depth: H,
            instructions: Instructions::BASELINE,
            middle_x: self.middle_x.as_flattened_mut(),
            middle_y: self.middle_y.as_flattened_mut(),
            reach: self.reach.as_flattened_mut(),
            sensor_x: self.sensor_x.as_flattened_mut(),
            sensor_y: self.sensor_y.as_flattened_mut(),
            radius: self.radius.as_flattened_mut(),
            t: self.t.as_flattened_mut(),
            travel: self.travel.as_flattened_mut(),
            arrival: self.arrival.as_flattened_mut(),
            departure: &mut [],
            field_of_view: &mut [],
            range_resolution: &mut [],
            log: self.log.as_flattened_mut().as_flattened_mut(),
            rings: &mut self.rings,
            boxes: &mut [],
            waiting: &mut [],
        }
    }

    fn with_scratch<R>(&mut self, work: impl FnOnce(Columns<'_, T>, &mut [T]) -> R) -> R {
        // On the stack, where it is needed for one reading at a time: 8 bytes a slot in f32. Not zeros: those a
        // microcontroller's compiler leaves to a memset that takes four instructions for each.
        let mut scratch = [[[T::NAN; 2]; H]; S];
        work(self.columns(), scratch.as_flattened_mut().as_flattened_mut())
    }
}

/// Const storage for every mode: S sensors, H readings of each, B · H slots a sensor.
///
/// B = 1 serves `latest` and snapshots, B = 5 `settled` as well. 60 bytes a slot in `f32`, 8 more of log for each of the
/// H · S readings, and 20 a sensor. In a map by travel ([`crate::Bounds::with_span`]) `settled` needs W as well: so many
/// readings of each sensor can wait for their report, 64 bytes each in `f32`; where more come within the span, the one that
/// has waited longest is reported early.
#[derive(Debug, Clone)]
pub struct Arrays<T: Scalar, const S: usize, const H: usize, const B: usize, const W: usize = 0> {
    middle_x: [[[T; H]; B]; S],
    middle_y: [[[T; H]; B]; S],
    reach: [[[T; H]; B]; S],
    sensor_x: [[[T; H]; B]; S],
    sensor_y: [[[T; H]; B]; S],
    radius: [[[T; H]; B]; S],
    field_of_view: [[[T; H]; B]; S],
    range_resolution: [[[T; H]; B]; S],
    t: [[[i64; H]; B]; S],
    travel: [[[u32; H]; B]; S],
    arrival: [[[u32; H]; B]; S],
    departure: [[[u32; H]; B]; S],
    scratch: [[[[T; 2]; H]; B]; S],
    log: [[[u16; H]; LOG_BLOCKS]; S],
    rings: [Ring<T>; S],
    waiting: [[Waiting<T>; W]; S],
}

impl<T: Scalar, const S: usize, const H: usize, const B: usize, const W: usize> Arrays<T, S, H, B, W> {
    const FITS: () = assert!(
        S >= 1 && S <= 65_535 && H >= 1 && H <= 10_000 && (B == 1 || B == SETTLED_BLOCKS),
        "1 to 65,535 sensors, H from 1 to 10,000, B = 1 or 5"
    );

    /// Empty storage.
    pub const fn new() -> Self {
        let () = Self::FITS;
        let blank = [[[T::NAN; H]; B]; S];
        Self {
            middle_x: blank,
            middle_y: blank,
            reach: blank,
            sensor_x: blank,
            sensor_y: blank,
            radius: blank,
            field_of_view: blank,
            range_resolution: blank,
            t: [[[0; H]; B]; S],
            travel: [[[0; H]; B]; S],
            arrival: [[[0; H]; B]; S],
            departure: [[[0; H]; B]; S],
            scratch: [[[[T::ZERO; 2]; H]; B]; S],
            log: [[[0; H]; LOG_BLOCKS]; S],
            rings: [Ring::EMPTY; S],
            waiting: [[Waiting::NONE; W]; S],
        }
    }

    fn split(&mut self) -> (Columns<'_, T>, &mut [T]) {
        let columns = Columns {
            depth: H * B,
            instructions: Instructions::BASELINE,
            middle_x: self.middle_x.as_flattened_mut().as_flattened_mut(),
            middle_y: self.middle_y.as_flattened_mut().as_flattened_mut(),
            reach: self.reach.as_flattened_mut().as_flattened_mut(),
            sensor_x: self.sensor_x.as_flattened_mut().as_flattened_mut(),
            sensor_y: self.sensor_y.as_flattened_mut().as_flattened_mut(),
            radius: self.radius.as_flattened_mut().as_flattened_mut(),
            t: self.t.as_flattened_mut().as_flattened_mut(),
            travel: self.travel.as_flattened_mut().as_flattened_mut(),
            arrival: self.arrival.as_flattened_mut().as_flattened_mut(),
            departure: self.departure.as_flattened_mut().as_flattened_mut(),
            field_of_view: self.field_of_view.as_flattened_mut().as_flattened_mut(),
            range_resolution: self.range_resolution.as_flattened_mut().as_flattened_mut(),
            log: self.log.as_flattened_mut().as_flattened_mut(),
            rings: &mut self.rings,
            boxes: &mut [],
            waiting: self.waiting.as_flattened_mut(),
        };
        (columns, self.scratch.as_flattened_mut().as_flattened_mut().as_flattened_mut())
    }
}

impl<T: Scalar, const S: usize, const H: usize, const B: usize, const W: usize> Default for Arrays<T, S, H, B, W> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Scalar, const S: usize, const H: usize, const B: usize, const W: usize> Storage<T> for Arrays<T, S, H, B, W> {
    fn history(&self) -> usize {
        H
    }

    fn columns(&mut self) -> Columns<'_, T> {
        self.split().0
    }

    fn with_scratch<R>(&mut self, work: impl FnOnce(Columns<'_, T>, &mut [T]) -> R) -> R {
        let (columns, scratch) = self.split();
        work(columns, scratch)
    }
}

impl<T: Scalar, const S: usize, const H: usize, const B: usize, const W: usize> SnapshotStorage<T>
    for Arrays<T, S, H, B, W>
{
}
impl<T: Scalar, const S: usize, const H: usize, const W: usize> SettledStorage<T>
    for Arrays<T, S, H, SETTLED_BLOCKS, W>
{
}

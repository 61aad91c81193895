//! A local map whose size is chosen at run time.

use atm_core::{Columns, LOG_BLOCKS, Ring, SETTLED_BLOCKS, Scalar, SettledStorage, SnapshotStorage, Storage};
use thiserror::Error;

/// Storage on the heap, `B` · H slots for each sensor: allocated once, never grown.
#[derive(Debug, Clone)]
pub struct Slots<T, const B: usize> {
    history: usize,
    /// The columns of numbers, one after the other in the order of [`Slots::columns`].
    numbers: Vec<T>,
    t: Vec<i64>,
    /// Travel, arrival, departure.
    counts: Vec<u32>,
    log: Vec<u16>,
    rings: Vec<Ring<T>>,
    scratch: Vec<T>,
}

/// Enough for `latest` and snapshots.
pub type LatestSlots<T> = Slots<T, 1>;

/// Enough for `settled` as well.
pub type SettledSlots<T> = Slots<T, SETTLED_BLOCKS>;

/// Columns of numbers, of eight different meanings.
const NUMBERS: usize = 8;

/// A local map that can't be had.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum StorageError {
    /// H out of range.
    #[error("the history must be 1 to {} readings of each sensor, not {0}", Slots::<f64, 1>::MAX_HISTORY)]
    History(usize),
    /// Number of sensors out of range.
    #[error("there must be 1 to 65535 sensors, not {0}")]
    Sensors(usize),
    /// More slots than are allowed.
    #[error("{sensors} sensors with a history of {history} need more slots than {}", Slots::<f64, 1>::MAX_SLOTS)]
    TooLarge {
        /// Sensors asked for.
        sensors: usize,
        /// H asked for.
        history: usize,
    },
}

impl<T: Scalar, const B: usize> Slots<T, B> {
    /// The largest H.
    pub const MAX_HISTORY: usize = 10_000;
    /// The largest number of slots: 2²⁵, some 3 GB in `f64`.
    pub const MAX_SLOTS: usize = 1 << 25;

    /// Room for `history` readings of each of `sensors` sensors.
    ///
    /// # Errors
    /// `history` not in 1..=10,000, `sensors` not in 1..=65,535, or more than 2²⁵ slots together.
    pub fn new(sensors: usize, history: usize) -> Result<Self, StorageError> {
        if !(1..=Self::MAX_HISTORY).contains(&history) {
            return Err(StorageError::History(history));
        }
        if !(1..=usize::from(u16::MAX)).contains(&sensors) {
            return Err(StorageError::Sensors(sensors));
        }
        let slots = sensors * history * B;
        if slots > Self::MAX_SLOTS {
            return Err(StorageError::TooLarge { sensors, history });
        }
        Ok(Self {
            history,
            numbers: vec![T::NAN; NUMBERS * slots],
            t: vec![0; slots],
            counts: vec![0; 3 * slots],
            log: vec![0; LOG_BLOCKS * sensors * history],
            rings: vec![Ring::EMPTY; sensors],
            scratch: vec![T::ZERO; 2 * slots],
        })
    }

    fn split(&mut self) -> (Columns<'_, T>, &mut [T]) {
        let slots = self.t.len();
        let (middle_x, rest) = self.numbers.split_at_mut(slots);
        let (middle_y, rest) = rest.split_at_mut(slots);
        let (reach, rest) = rest.split_at_mut(slots);
        let (sensor_x, rest) = rest.split_at_mut(slots);
        let (sensor_y, rest) = rest.split_at_mut(slots);
        let (radius, rest) = rest.split_at_mut(slots);
        let (field_of_view, range_resolution) = rest.split_at_mut(slots);
        let (travel, rest) = self.counts.split_at_mut(slots);
        let (arrival, departure) = rest.split_at_mut(slots);
        let columns = Columns {
            middle_x,
            middle_y,
            reach,
            sensor_x,
            sensor_y,
            radius,
            t: &mut self.t,
            travel,
            arrival,
            departure,
            field_of_view,
            range_resolution,
            log: &mut self.log,
            rings: &mut self.rings,
        };
        (columns, &mut self.scratch)
    }
}

impl<T: Scalar, const B: usize> Storage<T> for Slots<T, B> {
    fn history(&self) -> usize {
        self.history
    }

    #[inline]
    fn columns(&mut self) -> Columns<'_, T> {
        self.split().0
    }

    #[inline]
    fn with_scratch<R>(&mut self, work: impl FnOnce(Columns<'_, T>, &mut [T]) -> R) -> R {
        let (columns, scratch) = self.split();
        work(columns, scratch)
    }
}

impl<T: Scalar, const B: usize> SnapshotStorage<T> for Slots<T, B> {}
impl<T: Scalar> SettledStorage<T> for SettledSlots<T> {}

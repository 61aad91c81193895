//! A local map whose size is chosen at run time.

use atm_core::{Columns, LOG_BLOCKS, Ring, SETTLED_BLOCKS, Scalar, SettledStorage, SnapshotStorage, Storage};
use thiserror::Error;

/// Storage on the heap, `B` · H slots for each sensor: allocated once, never grown.
#[derive(Debug, Clone)]
pub struct Slots<T, const B: usize> {
    history: usize,
    middle_x: Vec<T>,
    middle_y: Vec<T>,
    reach: Vec<T>,
    sensor_x: Vec<T>,
    sensor_y: Vec<T>,
    radius: Vec<T>,
    field_of_view: Vec<T>,
    range_resolution: Vec<T>,
    t: Vec<i64>,
    travel: Vec<u32>,
    arrival: Vec<u32>,
    departure: Vec<u32>,
    log: Vec<u16>,
    rings: Vec<Ring<T>>,
    scratch: Vec<T>,
}

/// Enough for `latest` and snapshots.
pub type LatestSlots<T> = Slots<T, 1>;

/// Enough for `settled` as well.
pub type SettledSlots<T> = Slots<T, SETTLED_BLOCKS>;

/// A local map that can't be had.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum StorageError {
    /// H out of range.
    #[error("the history must be 1 to {most} readings of each sensor, not {0}", most = Slots::<f64, 1>::MAX_HISTORY)]
    History(usize),
    /// Number of sensors out of range.
    #[error("there must be 1 to 65535 sensors, not {0}")]
    Sensors(usize),
    /// More slots than are allowed.
    #[error("{sensors} sensors with a history of {history} need more than {most} slots", most = Slots::<f64, 1>::MAX_SLOTS)]
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
        let blank = vec![T::NAN; slots];
        Ok(Self {
            history,
            middle_x: blank.clone(),
            middle_y: blank.clone(),
            reach: blank.clone(),
            sensor_x: blank.clone(),
            sensor_y: blank.clone(),
            radius: blank.clone(),
            field_of_view: blank.clone(),
            range_resolution: blank,
            t: vec![0; slots],
            travel: vec![0; slots],
            arrival: vec![0; slots],
            departure: vec![0; slots],
            log: vec![0; LOG_BLOCKS * sensors * history],
            rings: vec![Ring::EMPTY; sensors],
            scratch: vec![T::ZERO; 2 * slots],
        })
    }

    #[inline]
    fn split(&mut self) -> (Columns<'_, T>, &mut [T]) {
        let columns = Columns {
            middle_x: &mut self.middle_x,
            middle_y: &mut self.middle_y,
            reach: &mut self.reach,
            sensor_x: &mut self.sensor_x,
            sensor_y: &mut self.sensor_y,
            radius: &mut self.radius,
            t: &mut self.t,
            travel: &mut self.travel,
            arrival: &mut self.arrival,
            departure: &mut self.departure,
            field_of_view: &mut self.field_of_view,
            range_resolution: &mut self.range_resolution,
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

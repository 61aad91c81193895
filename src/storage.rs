//! A local map whose size is chosen at run time.

use atm_core::{
    BLOCK, Boxes, Columns, Instructions, LOG_BLOCKS, Ring, SETTLED_BLOCKS, Scalar, SettledStorage, SnapshotStorage,
    Storage, Waiting,
};
use thiserror::Error;

/// Storage on the heap, `B` · H slots for each sensor, rounded up to whole blocks: grown only where sensors are added, and
/// where readings of a map by travel wait for their report.
#[derive(Debug, Clone)]
pub struct Slots<T: Scalar, const B: usize> {
    history: usize,
    /// How many times H slots each sensor has, and how many times H entries of the log of arrivals.
    blocks: usize,
    log_blocks: usize,
    depth: usize,
    instructions: Instructions,
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
    boxes: Vec<Boxes<T>>,
    scratch: Vec<T>,
    waiting: Vec<Waiting<T>>,
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
    /// Readings of each sensor that can wait for their report in a map by travel, on average: one is 112 bytes in `f64`. A
    /// robot that stands for longer, or that reads more often while it makes its way, has the one that has waited longest
    /// reported early, from what it has met.
    pub const MAX_WAITING: usize = 4096;

    /// Room for `history` readings of each of `sensors` sensors.
    ///
    /// # Errors
    /// `history` not in 1..=10,000, `sensors` not in 1..=65,535, or more than 2²⁵ slots together.
    pub fn new(sensors: usize, history: usize) -> Result<Self, StorageError> {
        Self::with_blocks(sensors, history, B, LOG_BLOCKS)
    }

    /// Room for a map by travel ([`atm_core::Bounds::with_span`]) alone: `history` readings of each of `sensors` sensors, and
    /// as many that have left it.
    ///
    /// # Errors
    /// As [`Slots::new`].
    pub fn by_travel(sensors: usize, history: usize) -> Result<Self, StorageError> {
        Self::with_blocks(sensors, history, B.min(2), 0)
    }

    fn with_blocks(sensors: usize, history: usize, blocks: usize, log_blocks: usize) -> Result<Self, StorageError> {
        let mut slots = Self {
            history,
            blocks,
            log_blocks,
            depth: (history * blocks).next_multiple_of(BLOCK),
            instructions: Instructions::widest(),
            middle_x: Vec::new(),
            middle_y: Vec::new(),
            reach: Vec::new(),
            sensor_x: Vec::new(),
            sensor_y: Vec::new(),
            radius: Vec::new(),
            field_of_view: Vec::new(),
            range_resolution: Vec::new(),
            t: Vec::new(),
            travel: Vec::new(),
            arrival: Vec::new(),
            departure: Vec::new(),
            log: Vec::new(),
            rings: Vec::new(),
            boxes: Vec::new(),
            scratch: Vec::new(),
            waiting: Vec::new(),
        };
        slots.grow(sensors)?;
        Ok(slots)
    }

    /// The same with other instructions: what they are changes no echo.
    pub fn with_instructions(self, instructions: Instructions) -> Self {
        Self { instructions, ..self }
    }

    /// Makes room for `sensors` in all; those it has keep their place. Fewer than it has change nothing.
    ///
    /// Inside a fuser, through [`atm_core::Fuser::grow`] alone.
    ///
    /// # Errors
    /// As [`Slots::new`]; then nothing has changed.
    pub fn grow(&mut self, sensors: usize) -> Result<(), StorageError> {
        let history = self.history;
        if !(1..=Self::MAX_HISTORY).contains(&history) {
            return Err(StorageError::History(history));
        }
        if !(1..=usize::from(u16::MAX)).contains(&sensors) {
            return Err(StorageError::Sensors(sensors));
        }
        if sensors * history * self.blocks > Self::MAX_SLOTS {
            return Err(StorageError::TooLarge { sensors, history });
        }
        if sensors <= self.rings.len() {
            return Ok(());
        }
        let slots = sensors * self.depth;
        for column in [
            &mut self.middle_x,
            &mut self.middle_y,
            &mut self.reach,
            &mut self.sensor_x,
            &mut self.sensor_y,
            &mut self.radius,
            &mut self.field_of_view,
            &mut self.range_resolution,
        ] {
            column.resize(slots, T::NAN);
        }
        self.t.resize(slots, 0);
        for column in [&mut self.travel, &mut self.arrival, &mut self.departure] {
            column.resize(slots, 0);
        }
        self.log.resize(self.log_blocks * sensors * history, 0);
        self.rings.resize(sensors, Ring::EMPTY);
        self.boxes.resize(slots.div_ceil(BLOCK * BLOCK), Boxes::EMPTY);
        self.scratch.resize(2 * slots, T::ZERO);
        Ok(())
    }

    #[inline]
    fn split(&mut self) -> (Columns<'_, T>, &mut [T]) {
        let columns = Columns {
            depth: self.depth,
            instructions: self.instructions,
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
            boxes: &mut self.boxes,
            waiting: &mut self.waiting,
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

    fn grow_waiting(&mut self) -> bool {
        let most = Self::MAX_WAITING * self.rings.len();
        let room = (self.waiting.len() * 2).clamp(64, most.max(64));
        let grows = room > self.waiting.len();
        self.waiting.resize(room, Waiting::NONE);
        grows
    }

    #[inline]
    fn with_scratch<R>(&mut self, work: impl FnOnce(Columns<'_, T>, &mut [T]) -> R) -> R {
        let (columns, scratch) = self.split();
        work(columns, scratch)
    }
}

impl<T: Scalar, const B: usize> SnapshotStorage<T> for Slots<T, B> {}
impl<T: Scalar> SettledStorage<T> for SettledSlots<T> {}

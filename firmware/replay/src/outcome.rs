//! What one reading led to.

use atm_core::{Arrival, Echo, Fuser, Rejected, Scalar, Sink, Storage};

use crate::{event::Event, ring::Ring};

/// What one reading led to.
#[derive(Debug, Clone, Copy)]
pub struct Outcome<T: Scalar> {
    /// Whether it arrived.
    pub arrival: Result<Arrival, Rejected>,
    /// The echo it gave.
    pub echo: Option<Echo<T>>,
    /// The number of crossings, where that is why it gave none.
    pub ignored: Option<u32>,
}

impl<T: Scalar> Outcome<T> {
    /// Nothing yet.
    pub const NONE: Self = Self { arrival: Ok(Arrival::Entered), echo: None, ignored: None };
}

impl<T: Scalar> Sink<T, Echo<T>> for Outcome<T> {
    fn echo(&mut self, echo: &Echo<T>) {
        self.echo = Some(*echo);
    }

    fn ignored(&mut self, crossings: u32) {
        self.ignored = Some(crossings);
    }
}

/// From a raw reading to what it led to.
#[inline]
pub fn fuse<T: Scalar, S: Storage<T>>(
    fuser: &mut Fuser<T, S>,
    ring: &Ring<T>,
    event: &Event<T>,
    outcome: &mut Outcome<T>,
) {
    *outcome = Outcome::NONE;
    outcome.arrival = fuser.push(&ring.reading(event), outcome);
}

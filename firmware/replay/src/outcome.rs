//! What one reading led to.

use atm_core::{Arrival, Estimator, Fuser, Rejected, Scalar, Sink, Storage};

use crate::{event::Event, ring::Ring};

/// What one reading led to: with `E` an echo.
#[derive(Debug, Clone, Copy)]
pub struct Outcome<E> {
    /// Whether it arrived.
    pub arrival: Result<Arrival, Rejected>,
    /// The echo it gave.
    pub echo: Option<E>,
    /// The number of crossings, where that is why it gave none.
    pub ignored: Option<u32>,
}

impl<E> Outcome<E> {
    /// Nothing yet.
    pub const NONE: Self = Self { arrival: Ok(Arrival::Entered), echo: None, ignored: None };
}

impl<T: Scalar, E: Copy> Sink<T, E> for Outcome<E> {
    fn echo(&mut self, echo: &E) {
        self.echo = Some(*echo);
    }

    fn ignored(&mut self, crossings: u32) {
        self.ignored = Some(crossings);
    }
}

/// From a raw reading to what it led to.
#[inline]
pub fn fuse<T: Scalar, S: Storage<T>, E: Estimator<T, Echo: Copy>>(
    fuser: &mut Fuser<T, S, E>,
    ring: &Ring<T>,
    event: &Event<T>,
    outcome: &mut Outcome<E::Echo>,
) {
    *outcome = Outcome::NONE;
    outcome.arrival = fuser.push(&ring.reading(event), outcome);
}

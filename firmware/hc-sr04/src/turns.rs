//! Whose turn it is: firing one after another, so that no sensor hears another's sound.

/// Gives N sensors of a ring their turns: one at a time, with a pause after each, neighbours in time far apart in angle.
#[derive(Debug, Clone, Copy)]
pub struct Turns<const N: usize> {
    stride: usize,
    pause: u32,
    next: usize,
    /// When the last one fired.
    fired: Option<u32>,
}

impl<const N: usize> Turns<N> {
    /// From one burst to the next, in µs, so that the last echo of one has died away: the data sheet asks for 60 ms.
    pub const PAUSE: u32 = 60_000;

    const FITS: () = assert!(N >= 1 && N <= 65_535, "1 to 65,535 sensors");

    /// Turns with the data sheet's pause.
    pub const fn new() -> Self {
        Self::with_pause(Self::PAUSE)
    }

    /// Turns with a pause in µs from one burst to the next. A sweep takes N of them: 16 sensors, 0.96 s.
    pub const fn with_pause(pause: u32) -> Self {
        let () = Self::FITS;
        Self { stride: stride(N), pause, next: 0, fired: None }
    }

    /// Whose turn it is, and whose turn comes then, a pause later; `None` while the pause lasts.
    pub fn take(&mut self, now: u32) -> Option<u16> {
        if self.fired.is_some_and(|fired| now.wrapping_sub(fired) < self.pause) {
            return None;
        }
        let sensor = self.next;
        self.next = (sensor + self.stride) % N;
        self.fired = Some(now);
        Some(sensor as u16)
    }

    /// When the pause ends; `None` if no sensor has fired yet.
    pub fn due(&self) -> Option<u32> {
        self.fired.map(|fired| fired.wrapping_add(self.pause))
    }
}

impl<const N: usize> Default for Turns<N> {
    fn default() -> Self {
        Self::new()
    }
}

/// The step around a ring of `n` that reaches every sensor and comes nearest to the opposite one: the largest that is at
/// most half the ring and has no divisor in common with it.
const fn stride(n: usize) -> usize {
    let mut stride = n / 2;
    while stride > 1 {
        let (mut a, mut b) = (n, stride);
        while b != 0 {
            (a, b) = (b, a % b);
        }
        if a == 1 {
            return stride;
        }
        stride -= 1;
    }
    1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn order<const N: usize>() -> [u16; N] {
        let mut turns = Turns::<N>::with_pause(1);
        core::array::from_fn(|now| turns.take(now as u32).unwrap())
    }

    #[test]
    fn every_sensor_has_one_turn_in_a_sweep() {
        fn once<const N: usize>() {
            let mut order = order::<N>();
            order.sort_unstable();
            assert_eq!(order, core::array::from_fn(|sensor| sensor as u16));
        }
        once::<1>();
        once::<2>();
        once::<3>();
        once::<6>();
        once::<8>();
        once::<16>();
    }

    #[test]
    fn neighbours_in_time_look_in_nearly_opposite_directions() {
        assert_eq!(&order::<16>()[..4], &[0, 7, 14, 5]);
        assert_eq!(&order::<8>()[..4], &[0, 3, 6, 1]);
    }

    #[test]
    fn pause_lasts_its_time_also_where_the_clock_wraps() {
        let mut turns = Turns::<4>::new();
        let start = u32::MAX - 10;
        assert_eq!(turns.take(start), Some(0));
        assert_eq!(turns.take(start.wrapping_add(59_999)), None);
        assert_eq!(turns.take(start.wrapping_add(60_000)), Some(1));
        assert_eq!(turns.due(), Some(start.wrapping_add(120_000)));
    }
}

//! One raw reading, as a driver would hand it over.

/// One sensor's raw reading, with where the robot was.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event<T> {
    /// When, in nanoseconds.
    pub t: i64,
    /// The sensor's index.
    pub sensor: u16,
    /// What it said, in metres; ±∞ and NaN as in REP 117.
    pub range: T,
    /// The robot's position in the fixed frame, in metres.
    pub position: [T; 2],
    /// The robot's heading: a unit vector, so that no angle needs a sine.
    pub heading: [T; 2],
}

impl Event<f32> {
    /// The same numbers in double precision.
    pub fn widened(&self) -> Event<f64> {
        let Self { t, sensor, range, position, heading } = *self;
        Event { t, sensor, range: f64::from(range), position: position.map(f64::from), heading: heading.map(f64::from) }
    }
}

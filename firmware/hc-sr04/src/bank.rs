//! Several sensors that take turns.

use core::task::Poll;

use embedded_hal::digital::{InputPin, OutputPin};

use crate::{
    sensor::{HcSr04, Look, Measurement},
    turns::Turns,
};

/// N sensors that take turns: at any time at most one is sounding or listening.
#[derive(Debug)]
pub struct Bank<T, E, const N: usize> {
    sensors: [HcSr04<T, E>; N],
    turns: Turns<N>,
    active: Option<u16>,
}

impl<T: OutputPin, E: InputPin, const N: usize> Bank<T, E, N> {
    /// Sensors in the order of their angles.
    pub const fn new(sensors: [HcSr04<T, E>; N], turns: Turns<N>) -> Self {
        Self { sensors, turns, active: None }
    }

    /// Starts the next sensor when it is due, looks at the one that is measuring, and returns: `Ready` with the sensor
    /// and what it measured.
    ///
    /// Call it at edges of any echo line, and at [`Bank::deadline`].
    ///
    /// # Errors
    /// A line that can't be set or read: the sensor loses its turn.
    pub fn poll(&mut self, now: u32) -> Look<(u16, Measurement), T, E> {
        if self.active.is_none() {
            let Some(sensor) = self.turns.take(now) else { return Ok(Poll::Pending) };
            if let Some(driver) = self.sensors.get_mut(usize::from(sensor)) {
                driver.start(now)?;
                self.active = Some(sensor);
            }
            return Ok(Poll::Pending);
        }
        let Some((sensor, driver)) =
            self.active.and_then(|sensor| Some((sensor, self.sensors.get_mut(usize::from(sensor))?)))
        else {
            return Ok(Poll::Pending);
        };
        let measurement = driver.poll(now).inspect_err(|_| self.active = None)?;
        if measurement.is_ready() {
            self.active = None;
        }
        Ok(measurement.map(|measurement| (sensor, measurement)))
    }

    /// When to poll at the latest if no line changes before. `None` before the first poll.
    pub fn deadline(&self) -> Option<u32> {
        match self.active.and_then(|sensor| self.sensors.get(usize::from(sensor))) {
            Some(driver) => driver.deadline(),
            None => self.turns.due(),
        }
    }

    /// The sensor that is measuring.
    pub const fn active(&self) -> Option<u16> {
        self.active
    }
}

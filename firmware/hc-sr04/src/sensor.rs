//! One sensor: a state machine that is asked, and never waits.

use core::{fmt, task::Poll};

use embedded_hal::digital::{ErrorType, InputPin, OutputPin};

use crate::air::Air;

/// What a sensor measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measurement {
    /// An echo after this time, there and back.
    Echo {
        /// Width of the pulse on the echo line.
        microseconds: u32,
    },
    /// The pulse was longer than any echo takes: nothing is there.
    Beyond,
    /// No pulse came, or an old one does not end: no sensor is there, or it is broken.
    Silent,
}

impl Measurement {
    /// The range in metres; +∞ for nothing there, NaN for no sensor (REP 117), as `atm_core::Limits::classify` takes it.
    pub fn range(&self, air: &Air) -> f32 {
        match *self {
            Self::Echo { microseconds } => air.range(microseconds),
            Self::Beyond => f32::INFINITY,
            Self::Silent => f32::NAN,
        }
    }
}

/// A line that could not be set or read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Error<T, E> {
    /// The trigger line.
    Trigger(T),
    /// The echo line.
    Echo(E),
}

impl<T: fmt::Debug, E: fmt::Debug> fmt::Display for Error<T, E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Trigger(error) => write!(f, "the trigger line: {error:?}"),
            Self::Echo(error) => write!(f, "the echo line: {error:?}"),
        }
    }
}

impl<T: fmt::Debug, E: fmt::Debug> core::error::Error for Error<T, E> {}

/// What a look at the lines gives: a measurement, `Pending` while there is none, or the line that failed.
pub type Look<M, T, E> = Result<Poll<M>, Error<<T as ErrorType>::Error, <E as ErrorType>::Error>>;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    Idle,
    /// The trigger line is high since then.
    Triggering(u32),
    /// The trigger line is low since then; the sensor sends its burst.
    Sending(u32),
    /// The echo line is high since then.
    Listening(u32),
    /// The echo line was high before anything was sent, since then.
    Stuck(u32),
}

/// An ultrasonic sensor with a trigger line and an echo line.
#[derive(Debug)]
pub struct HcSr04<T, E> {
    trigger: T,
    echo: E,
    state: State,
}

impl<T: OutputPin, E: InputPin> HcSr04<T, E> {
    /// How long the trigger line must be high (data sheet), in µs.
    pub const TRIGGER: u32 = 10;
    /// The echo line rises when the burst is out, after half a millisecond; some kin take longer. In µs.
    pub const LONGEST_BURST: u32 = 5_000;
    /// An echo from 4 m, the farthest that the data sheet promises, takes 25.5 ms at -40 °C. In µs.
    pub const LONGEST_ECHO: u32 = 26_000;
    /// Without an echo the sensor lets its line fall after 38 ms; some kin take 200. In µs.
    pub const GIVEN_UP: u32 = 40_000;

    /// A sensor on two lines, the trigger line low.
    pub const fn new(trigger: T, echo: E) -> Self {
        Self { trigger, echo, state: State::Idle }
    }

    /// Starts a measurement: raises the trigger line. One that is under way is given up.
    ///
    /// Poll next at [`HcSr04::deadline`], 10 µs later.
    ///
    /// # Errors
    /// A line that can't be set or read; then no measurement is under way.
    pub fn start(&mut self, now: u32) -> Result<(), Error<T::Error, E::Error>> {
        self.state = State::Idle;
        if self.echo.is_high().map_err(Error::Echo)? {
            // Still busy with its last measurement: a burst now would be mistaken.
            self.state = State::Stuck(now);
            return Ok(());
        }
        self.trigger.set_high().map_err(Error::Trigger)?;
        self.state = State::Triggering(now);
        Ok(())
    }

    /// Looks at the lines, and returns: `Pending` while a measurement is under way, and when none is.
    ///
    /// `now` is when the echo line changed, where hardware captured that.
    ///
    /// # Errors
    /// A line that can't be set or read; the measurement goes on.
    pub fn poll(&mut self, now: u32) -> Look<Measurement, T, E> {
        match self.state {
            State::Idle => {}
            State::Triggering(since) => {
                if passed(since, now, Self::TRIGGER) {
                    self.trigger.set_low().map_err(Error::Trigger)?;
                    self.state = State::Sending(now);
                }
            }
            State::Sending(since) => {
                if self.echo.is_high().map_err(Error::Echo)? {
                    self.state = State::Listening(now);
                } else if passed(since, now, Self::LONGEST_BURST) {
                    return Ok(self.finish(Measurement::Silent));
                }
            }
            State::Listening(since) => {
                let microseconds = now.wrapping_sub(since);
                if self.echo.is_low().map_err(Error::Echo)? {
                    let echo = microseconds <= Self::LONGEST_ECHO;
                    return Ok(self.finish(if echo {
                        Measurement::Echo { microseconds }
                    } else {
                        Measurement::Beyond
                    }));
                }
                if microseconds >= Self::GIVEN_UP {
                    return Ok(self.finish(Measurement::Beyond));
                }
            }
            State::Stuck(since) => {
                if self.echo.is_low().map_err(Error::Echo)? {
                    return self.start(now).map(|()| Poll::Pending);
                }
                if passed(since, now, Self::GIVEN_UP) {
                    return Ok(self.finish(Measurement::Silent));
                }
            }
        }
        Ok(Poll::Pending)
    }

    /// When to poll at the latest if the echo line does not change before; `None` if no measurement is under way.
    pub const fn deadline(&self) -> Option<u32> {
        match self.state {
            State::Idle => None,
            State::Triggering(since) => Some(since.wrapping_add(Self::TRIGGER)),
            State::Sending(since) => Some(since.wrapping_add(Self::LONGEST_BURST)),
            State::Listening(since) | State::Stuck(since) => Some(since.wrapping_add(Self::GIVEN_UP)),
        }
    }

    /// The echo line, to wait for its edges.
    pub const fn echo_pin(&mut self) -> &mut E {
        &mut self.echo
    }

    /// The two lines, trigger and echo.
    pub fn release(self) -> (T, E) {
        (self.trigger, self.echo)
    }

    const fn finish(&mut self, measurement: Measurement) -> Poll<Measurement> {
        self.state = State::Idle;
        Poll::Ready(measurement)
    }
}

const fn passed(since: u32, now: u32, microseconds: u32) -> bool {
    now.wrapping_sub(since) >= microseconds
}

//! How fast sound is.

use core::fmt;

/// Air of one temperature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Air {
    metres_per_second: f32,
}

/// The temperature is outside -40 to 85 °C, or no number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TemperatureOutOfRange;

impl fmt::Display for TemperatureOutOfRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the air temperature must lie in [-40, 85] degrees Celsius")
    }
}

impl core::error::Error for TemperatureOutOfRange {}

impl Air {
    /// The temperatures at which electronics are usually good.
    const CELSIUS: core::ops::RangeInclusive<f32> = -40.0..=85.0;

    /// Air at a temperature, in -40 to 85 °C.
    ///
    /// 331.3 m/s at 0 °C, and √(1 + t / 273.15 °C) of that at t, by the first four terms of the root's series: within
    /// 0.05 % over the domain, which is less than humidity does. 20 °C off is 3.5 % of every range.
    pub fn at_celsius(celsius: f32) -> Result<Self, TemperatureOutOfRange> {
        const AT_ZERO: f32 = 331.3;
        if !Self::CELSIUS.contains(&celsius) {
            return Err(TemperatureOutOfRange);
        }
        let share = celsius / 273.15;
        Ok(Self { metres_per_second: AT_ZERO * (1.0 + share * (0.5 - share * (0.125 - share * 0.0625))) })
    }

    /// The speed of sound, in m/s.
    pub const fn metres_per_second(&self) -> f32 {
        self.metres_per_second
    }

    /// How far away that is from which sound comes back after this time: half the way there and back, in metres.
    pub fn range(&self, microseconds: u32) -> f32 {
        // To a whole micrometre, so an f32 is plenty.
        self.metres_per_second * (microseconds as f32 * 1e-6) / 2.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speed_of_sound_is_that_of_the_tables() {
        // Engineering tables for dry air, in m/s.
        for (celsius, speed) in [(-20.0, 318.9), (0.0, 331.3), (20.0, 343.2), (40.0, 354.7), (80.0, 376.7)] {
            let found = Air::at_celsius(celsius).unwrap().metres_per_second();
            assert!((found / speed - 1.0).abs() < 0.001, "{celsius} degrees: {found}");
        }
    }

    #[test]
    fn a_metre_is_5_83_milliseconds_at_20_degrees() {
        let air = Air::at_celsius(20.0).unwrap();
        assert!((air.range(5_828) - 1.0).abs() < 0.001, "{}", air.range(5_828));
    }

    #[test]
    fn temperature_domain() {
        assert!(Air::at_celsius(-40.0).is_ok());
        assert!(Air::at_celsius(85.0).is_ok());
        assert_eq!(Air::at_celsius(85.1), Err(TemperatureOutOfRange));
        assert_eq!(Air::at_celsius(f32::NAN), Err(TemperatureOutOfRange));
    }
}

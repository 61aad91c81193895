//! What is switched on beside geometry and rounding, and the layers it makes.
use std::str::FromStr;

use atm::{
    error::{Error, Result},
    units,
};

use super::{
    dice::{Dice, Purpose},
    layer::{Crosstalk, Dropout, Layer, RangeNoise},
};

/// What disturbs a simulated drive; by default nothing does.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Effects {
    /// Whether sound comes back over mirrors, by up to three bounces.
    pub multipath: bool,
    /// Share of readings that are another sensor's sound, within [0, 1].
    pub crosstalk: f64,
    /// Standard deviation of the range, in metres, at least 0.
    pub range: f64,
    /// Share of echoes that are missed, within [0, 1].
    pub dropout: f64,
    /// Standard deviation of the logged position after a metre, in metres, at least 0; it grows with the root of the way.
    pub odometry: f64,
    /// Standard deviation of the logged yaw after a metre, in radians, at least 0; it grows with the root of the way, of which a
    /// radian of turning is a metre.
    pub heading: f64,
}

/// The names of the effects, with a value that would do.
const EXAMPLES: [(&str, &str); 6] = [
    ("multipath", ""),
    ("crosstalk", "1%"),
    ("range", "1cm"),
    ("dropout", "5%"),
    ("odometry", "1cm"),
    ("heading", "0.5deg"),
];

impl Effects {
    /// The layers between an echo and the sensor's rounding, in their order.
    pub(super) fn layers(&self, seed: u64) -> Vec<Box<dyn Layer>> {
        let mut layers: Vec<Box<dyn Layer>> = Vec::new();
        if self.crosstalk > 0.0 {
            layers.push(Box::new(Crosstalk::new(self.crosstalk, Dice::new(seed, Purpose::Crosstalk))));
        }
        if self.range > 0.0 {
            layers.push(Box::new(RangeNoise::new(self.range, Dice::new(seed, Purpose::RangeNoise))));
        }
        if self.dropout > 0.0 {
            layers.push(Box::new(Dropout::new(self.dropout, Dice::new(seed, Purpose::Dropout))));
        }
        layers
    }

    /// Sets one effect from its name and value.
    fn set(&mut self, name: &str, value: Option<&str>) -> Result<(), String> {
        let given = || value.ok_or_else(|| format!("{name} needs a value"));
        let amount = |read: fn(&str) -> Result<f64, units::UnitError>| match read(given()?) {
            Ok(amount) if amount >= 0.0 => Ok(amount),
            Ok(_) => Err("must not be negative".to_owned()),
            Err(error) => Err(error.to_string()),
        };
        match (name, value) {
            ("multipath", None) => self.multipath = true,
            ("multipath", Some(_)) => return Err("takes no value".to_owned()),
            ("crosstalk", _) => self.crosstalk = share(given()?)?,
            ("dropout", _) => self.dropout = share(given()?)?,
            ("range", _) => self.range = amount(units::length)?,
            ("odometry", _) => self.odometry = amount(units::length)?,
            ("heading", _) => self.heading = amount(units::angle)?,
            _ => return Err(format!("no such effect; expected one of {}", EXAMPLES.map(|(name, _)| name).join(", "))),
        }
        Ok(())
    }
}

impl FromStr for Effects {
    type Err = Error;

    /// Reads `range=1cm,dropout=5%,multipath`.
    fn from_str(text: &str) -> Result<Self> {
        let mut effects = Self::default();
        for part in text.split(',') {
            let (name, value) = match part.split_once('=') {
                Some((name, value)) => (name.trim(), Some(value.trim())),
                None => (part.trim(), None),
            };
            effects.set(name, value).map_err(|message| Error::Settings {
                message: format!("--noise {}: {message}{}", units::shorten(part), example(name)),
            })?;
        }
        Ok(effects)
    }
}

/// How an effect is written.
fn example(name: &str) -> String {
    match EXAMPLES.iter().find(|(known, _)| *known == name) {
        Some((name, "")) => format!(" (like {name})"),
        Some((name, value)) => format!(" (like {name}={value})"),
        None => String::new(),
    }
}

/// Reads a share: `5%` or `0.05`.
fn share(text: &str) -> Result<f64, String> {
    let (number, whole) = match text.strip_suffix('%') {
        Some(number) => (number.trim_end(), 100.0),
        None => (text, 1.0),
    };
    match number.parse::<f64>() {
        Ok(value) if (0.0..=whole).contains(&value) => Ok(value / whole),
        _ => Err("must be a share from 0% to 100%".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(text: &str) -> String {
        text.parse::<Effects>().unwrap_err().to_string()
    }

    #[test]
    fn effects_are_read_with_their_units() {
        let effects: Effects = "range=1cm, dropout=5%,multipath,heading=180deg,crosstalk=0.25".parse().unwrap();
        let expected = Effects {
            multipath: true,
            crosstalk: 0.25,
            range: 0.01,
            dropout: 0.05,
            heading: std::f64::consts::PI,
            ..Effects::default()
        };
        assert_eq!(effects, expected);
    }

    #[test]
    fn what_is_no_effect_is_named() {
        assert!(said("ranges=1cm").contains("ranges=1cm: no such effect; expected one of multipath, crosstalk"));
        assert!(said("range").contains("range: range needs a value (like range=1cm)"));
        assert!(said("range=-1cm").contains("must not be negative"));
        assert!(said("range=1deg").contains("no unit `deg`"));
        assert!(said("heading=1").contains("has no unit"));
        assert!(said("dropout=101%").contains("from 0% to 100%"));
        assert!(said("dropout=nan").contains("from 0% to 100%"));
        assert!(said("multipath=1").contains("takes no value"));
        assert!(said("").contains("no such effect"));
    }
}

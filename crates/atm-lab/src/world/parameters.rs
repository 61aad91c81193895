//! What a user sets of a world: `--set opening=36in`.
use std::cell::RefCell;

use atm::{
    error::{Error, Result},
    units::{self, UnitError},
};

use super::{Material, world_error};

/// The parameters that were set, and the names of those that were asked for.
pub(super) struct Parameters<'a> {
    world: &'a str,
    set: &'a [(String, String)],
    known: RefCell<Vec<&'static str>>,
}

impl<'a> Parameters<'a> {
    /// Parameters of the world that errors call `world`; of one set twice the later counts.
    pub fn new(world: &'a str, set: &'a [(String, String)]) -> Self {
        Self { world, set, known: RefCell::default() }
    }

    /// A length above zero, in metres.
    pub fn length(&self, key: &'static str, otherwise: f64) -> Result<f64> {
        self.positive(key, otherwise, units::length)
    }

    /// A speed above zero, in metres per second.
    pub fn speed(&self, key: &'static str, otherwise: f64) -> Result<f64> {
        self.positive(key, otherwise, units::speed)
    }

    /// A rate above zero, in hertz.
    pub fn rate(&self, key: &'static str, otherwise: f64) -> Result<f64> {
        self.positive(key, otherwise, units::rate)
    }

    /// An angle above zero, in radians.
    pub fn angle(&self, key: &'static str, otherwise: f64) -> Result<f64> {
        self.positive(key, otherwise, units::angle)
    }

    /// A material by its name.
    pub fn material(&self, key: &'static str, otherwise: Material) -> Result<Material> {
        let choice = self.choice(key, otherwise.name(), &Material::ALL.map(Material::name))?;
        Ok(Material::from_name(choice).unwrap_or(otherwise))
    }

    /// One of several words.
    pub fn choice(&self, key: &'static str, otherwise: &'static str, words: &[&'static str]) -> Result<&'static str> {
        let Some(value) = self.get(key) else { return Ok(otherwise) };
        let known = words.iter().find(|word| **word == value);
        known.copied().ok_or_else(|| self.error(key, value, &format!("expected one of {}", words.join(", "))))
    }

    /// Refuses what was set and never asked for.
    pub fn finish(&self) -> Result<()> {
        let known = self.known.borrow();
        let Some((key, value)) = self.set.iter().find(|(key, _)| !known.contains(&key.as_str())) else { return Ok(()) };
        let expected = format!("no such parameter; expected one of {}", known.join(", "));
        Err(self.error(key, value, &expected))
    }

    /// An error of one parameter.
    pub fn error(&self, key: &str, value: &str, message: &str) -> Error {
        let (key, value) = (units::shorten(key), units::shorten(value));
        world_error(self.world, format!("{key} = {value}: {message}"))
    }

    fn get(&self, key: &'static str) -> Option<&'a str> {
        self.known.borrow_mut().push(key);
        self.set.iter().rev().find(|(name, _)| name == key).map(|(_, value)| value.as_str())
    }

    fn positive(&self, key: &'static str, otherwise: f64, read: fn(&str) -> Result<f64, UnitError>) -> Result<f64> {
        let Some(text) = self.get(key) else { return Ok(otherwise) };
        match read(text) {
            Ok(value) if value > 0.0 => Ok(value),
            Ok(_) => Err(self.error(key, text, "must be above zero")),
            Err(error) => Err(self.error(key, text, &error.to_string())),
        }
    }
}

//! Values of flags: text with a unit in, checked numbers out.

use std::{fmt::Display, str::FromStr};

use atm::{
    core::{Beam, Kind, MinAngle, RangeResolution, Reflector, Travel},
    track::MotionLimit,
    units::{self, Scale},
};

/// A kind of either estimator, by its name.
pub fn kind(text: &str) -> Result<&'static str, String> {
    let (kinds, reflectors) = (Kind::ALL.map(Kind::name), Reflector::ALL.map(Reflector::name));
    let all = || kinds.into_iter().chain(reflectors);
    all().find(|kind| *kind == text).ok_or_else(|| {
        format!("{text} is none of {}; nor of {} (--estimator consensus)", kinds.join(", "), reflectors.join(", "))
    })
}

pub fn confidence(text: &str) -> Result<f64, String> {
    match f64::from_str(text) {
        Ok(share) if (0.0..1.0).contains(&share) => Ok(share),
        _ => Err(format!("{text} is no share from 0 to below 1")),
    }
}

pub fn error_length(text: &str) -> Result<f64, String> {
    let length = units::length(text).map_err(words)?;
    if length >= 0.0 { Ok(length) } else { Err(format!("{text} is negative")) }
}

fn words(error: impl Display) -> String {
    error.to_string()
}

fn positive(value: f64, text: &str) -> Result<f64, String> {
    if value > 0.0 { Ok(value) } else { Err(format!("{text} is not positive")) }
}

pub fn positive_number(text: &str) -> Result<f64, String> {
    match f64::from_str(text) {
        Ok(number) if number.is_finite() => positive(number, text),
        _ => Err(format!("{text} is no number")),
    }
}

pub fn positive_length(text: &str) -> Result<f64, String> {
    positive(units::length(text).map_err(words)?, text)
}

pub fn positive_speed(text: &str) -> Result<f64, String> {
    positive(units::speed(text).map_err(words)?, text)
}

pub fn max_speed(text: &str) -> Result<MotionLimit, String> {
    MotionLimit::new(positive_speed(text)?).ok_or_else(|| format!("{text} is not positive"))
}

pub fn positive_rate(text: &str) -> Result<f64, String> {
    positive(units::rate(text).map_err(words)?, text)
}

pub fn duration(text: &str) -> Result<u64, String> {
    u64::try_from(units::duration(text).map_err(words)?).map_err(|_| format!("{text} is negative"))
}

pub fn positive_duration(text: &str) -> Result<u64, String> {
    match duration(text)? {
        0 => Err(format!("{text} is not positive")),
        nanoseconds => Ok(nanoseconds),
    }
}

pub fn travel(text: &str) -> Result<Travel, String> {
    Travel::from_metres(units::length(text).map_err(words)?).map_err(words)
}

pub fn range_resolution(text: &str) -> Result<RangeResolution<f64>, String> {
    RangeResolution::new(units::length(text).map_err(words)?).map_err(words)
}

pub fn beam(text: &str) -> Result<Beam<f64>, String> {
    Beam::new(units::angle(text).map_err(words)?).map_err(words)
}

pub fn min_angle(text: &str) -> Result<MinAngle<f64>, String> {
    MinAngle::new(units::angle(text).map_err(words)?).map_err(words)
}

/// A number of bytes, with or without a multiple of 1024.
pub fn bytes(text: &str) -> Result<u64, String> {
    let split = text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
    let (number, unit) = text.split_at(split);
    let shift = match unit {
        "" | "B" => 0,
        "k" | "kB" | "KiB" => 10,
        "M" | "MB" | "MiB" => 20,
        "G" | "GB" | "GiB" => 30,
        _ => return Err(format!("{text} has none of the units k, M, G")),
    };
    let number: Option<u64> = number.parse().ok();
    match number.and_then(|number| number.checked_mul(1 << shift)) {
        Some(bytes) if bytes > 0 => Ok(bytes),
        _ => Err(format!("{text} is no positive number of bytes")),
    }
}

/// `KEY=VALUE`, as it stands: what keys there are depends on the world.
#[cfg(feature = "lab")]
pub fn parameter(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() => Ok((key.trim().to_owned(), value.trim().to_owned())),
        _ => Err(format!("{text} is not KEY=VALUE, like opening=36in")),
    }
}

/// The step in which a log writes lengths: `cm`, `0.25mm`.
pub fn length_unit(text: &str) -> Result<Scale, String> {
    let unit = Scale::length(text).map_err(words)?;
    if unit.apply(1.0) > 0.0 { Ok(unit) } else { Err(format!("{text} is not positive")) }
}

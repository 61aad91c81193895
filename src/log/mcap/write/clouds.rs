//! Echoes and crossings as the points of clouds.

use atm_core::{ArcCrossing, Kind};

use super::{
    content::Color,
    points::{ALIGNMENT, kind_number},
    sweep::MOST_POINTS,
};
use crate::{echo::AnyEcho, style};

/// A kind's colour, for viewers' dark grounds; what lies nowhere better than in its cone is let shine through.
pub(super) fn color_of(kind: &str) -> Color {
    let alpha = if kind == Kind::Center.name() { 0xc0 } else { 0xff };
    let style = style::named(kind).or_else(|| style::named(Kind::Center.name()));
    Color::new(style.map_or(0, |style| style.on_dark), alpha)
}

/// The fields of an echo behind its place, in their order.
pub(super) fn put_echo(bytes: &mut Vec<u8>, echo: &AnyEcho, since: i64) {
    let usual = echo.usual();
    put_all(bytes, &[usual.range, usual.azimuth, usual.resolution, usual.significance]);
    bytes.extend_from_slice(&offset(usual.t, since).to_le_bytes());
    bytes.extend_from_slice(&usual.crossings.to_le_bytes());
    bytes.extend_from_slice(&usual.sensor.to_le_bytes());
    bytes.push(kind_number(usual.kind));
    if let Some(echo) = echo.consensus() {
        // Points begin at multiples of it.
        bytes.resize(bytes.len().next_multiple_of(ALIGNMENT), 0);
        let [x, y] = echo.normal.map_or([f64::NAN; 2], |normal| [normal.x, normal.y]);
        put_all(bytes, &[echo.sigma_azimuth, echo.sigma_range, x, y]);
        bytes.extend_from_slice(&echo.support.to_le_bytes());
        bytes.extend_from_slice(&echo.against.to_le_bytes());
    }
}

fn put_all(bytes: &mut Vec<u8>, values: &[f64]) {
    for value in values {
        bytes.extend_from_slice(&value.to_le_bytes());
    }
}

/// Runs of at most [`MOST_POINTS`] that lie within 2³² ns: so wide is a point's own time.
pub(super) fn runs<'a, T>(all: &'a [T], t: impl Fn(&T) -> i64 + 'a) -> impl Iterator<Item = &'a [T]> {
    let mut rest = all;
    std::iter::from_fn(move || {
        let (mut first, mut last) = (i64::MAX, i64::MIN);
        let fits = |one: &T| {
            first = first.min(t(one));
            last = last.max(t(one));
            last.abs_diff(first) <= u64::from(u32::MAX)
        };
        let length = rest.iter().take(MOST_POINTS).map(fits).take_while(|fits| *fits).count();
        let (run, after) = rest.split_at_checked(length)?;
        rest = after;
        (!run.is_empty()).then_some(run)
    })
}

pub(super) fn earliest<T>(run: &[T], t: impl Fn(&T) -> i64) -> i64 {
    run.iter().map(t).min().unwrap_or(0)
}

/// The fields of a crossing behind its place, in their order.
pub(super) fn put_crossing(bytes: &mut Vec<u8>, crossing: &ArcCrossing<f64>, since: i64) {
    let other = (i128::from(crossing.t_other) - i128::from(since)) as f64;
    put_all(bytes, &[crossing.bearing.azimuth(), crossing.angle, other]);
    bytes.extend_from_slice(&offset(crossing.t, since).to_le_bytes());
    bytes.extend_from_slice(&crossing.sensor.to_le_bytes());
    bytes.extend_from_slice(&crossing.sensor_other.to_le_bytes());
}

/// Nanoseconds from the message's stamp; within a run they fit.
fn offset(t: i64, since: i64) -> u32 {
    u32::try_from(t.abs_diff(since)).unwrap_or(u32::MAX)
}

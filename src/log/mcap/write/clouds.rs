//! Echoes and crossings as the points of clouds.

use atm_core::{ArcCrossing, Echo, Kind};

use super::{content::Color, points::kind_number, sweep::MOST_POINTS};

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

/// The fields of an echo behind its place, in their order.
pub(super) fn put_echo(bytes: &mut Vec<u8>, echo: &Echo<f64>, since: i64) {
    for value in [echo.range, echo.azimuth(), echo.resolution, echo.significance()] {
        bytes.extend_from_slice(&value.to_le_bytes());
    }
    bytes.extend_from_slice(&offset(echo.t, since).to_le_bytes());
    bytes.extend_from_slice(&echo.crossings.to_le_bytes());
    bytes.extend_from_slice(&echo.sensor.to_le_bytes());
    bytes.push(kind_number(echo.kind));
}

/// The fields of a crossing behind its place, in their order.
pub(super) fn put_crossing(bytes: &mut Vec<u8>, crossing: &ArcCrossing<f64>, since: i64) {
    let other = (i128::from(crossing.t_other) - i128::from(since)) as f64;
    for value in [crossing.bearing.azimuth(), crossing.angle, other] {
        bytes.extend_from_slice(&value.to_le_bytes());
    }
    bytes.extend_from_slice(&offset(crossing.t, since).to_le_bytes());
    bytes.extend_from_slice(&crossing.sensor.to_le_bytes());
    bytes.extend_from_slice(&crossing.sensor_other.to_le_bytes());
}

/// Nanoseconds from the message's stamp; within a run they fit.
fn offset(t: i64, since: i64) -> u32 {
    u32::try_from(t.abs_diff(since)).unwrap_or(u32::MAX)
}

/// Colours that people with any colour vision tell apart (Okabe and Ito, "Color Universal Design"): blue is sharp, orange is not.
pub(super) const fn color_of(kind: Kind) -> Color {
    match kind {
        Kind::Median => Color::new(0x00_72_b2, 0xff),
        Kind::Single => Color::new(0x56_b4_e9, 0xff),
        Kind::Near => Color::new(0xcc_79_a7, 0xff),
        Kind::Pair => Color::new(0xe6_9f_00, 0xff),
        _ => Color::new(0xd5_5e_00, 0xc0),
    }
}

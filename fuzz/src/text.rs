//! Quantities and times as text: nothing panics, what is read is finite, and times survive being written.

use atm::{stamp, units};

/// The bytes are one argument or cell.
pub fn check(bytes: &[u8]) {
    for shift in [0, 3, 6, 9] {
        if let Some(t) = stamp::parse(bytes, shift) {
            close(bytes, shift, t);
            let mut written = Vec::new();
            stamp::write(t, &mut written);
            assert_eq!(stamp::parse(&written, 9), Some(t), "{}", String::from_utf8_lossy(&written));
        }
    }
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    for read in [units::length, units::angle, units::speed, units::rate] {
        match read(text) {
            Ok(value) => assert!(value.is_finite()),
            Err(error) => assert!(error.to_string().len() < 1024),
        }
    }
    let _ = units::duration(text);
    for step in [units::Scale::length(text), units::Scale::angle(text)] {
        assert!(step.map_or(1.0, |step| step.apply(1.0)).is_finite());
    }
}

/// The standard library reads the same number, as far as a float holds it.
fn close(bytes: &[u8], shift: i32, t: i64) {
    let text = std::str::from_utf8(bytes.trim_ascii()).expect("digits are ASCII");
    let value: f64 = text.parse().expect("what is a time is a number");
    let nanoseconds = value * 10f64.powi(shift);
    assert!((nanoseconds - t as f64).abs() <= 0.5 + 1e-15 * nanoseconds.abs() * 4.0, "{text}: {t}");
}

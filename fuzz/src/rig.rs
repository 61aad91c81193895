//! Rig files: whatever the text, a rig whose invariants hold, or an error that names the file.

use atm::{intake::Defaults, rig::Rig};

/// The bytes are the file.
pub fn check(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let rig = match Rig::parse(text, "rig.toml") {
        Ok(rig) => rig,
        Err(error) => {
            let words = error.to_string();
            assert!(words.starts_with("rig.toml") || words.contains("sensor"), "{words}");
            // A message is read by a person, on a terminal.
            assert!(words.len() < 4096 && !words.chars().any(|c| c.is_control() && c != '\n'), "{words:?}");
            return;
        }
    };
    assert!((1..=usize::from(u16::MAX)).contains(&rig.sensors().len()));
    for (index, sensor) in rig.sensors().iter().enumerate() {
        assert_eq!(rig.index_of(sensor.id()).map(usize::from), Some(index));
        let mount = sensor.mount();
        let (position, turn) = (mount.translation.vector, mount.rotation);
        assert!(position.iter().chain([&turn.re, &turn.im]).all(|part| part.is_finite()));
        assert!(sensor.min_range() >= 0.0 && sensor.min_range() < sensor.max_range());
    }
    Defaults::default().complete(&rig).expect("what a rig holds is within its domain");
    // The same text, the same rig.
    assert_eq!(Rig::parse(text, "rig.toml").expect("as before").sensors(), rig.sensors());
}

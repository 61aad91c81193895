//! World files: whatever the text, a world that can be driven through, or an error that names the file.

use std::{f64::consts::PI, sync::LazyLock};

use atm::{
    core::Point2,
    rig::{Ranging, Rig},
};
use atm_lab::{
    simulate::{Effects, Simulation},
    world::World,
};

static RIG: LazyLock<Rig> = LazyLock::new(|| Rig::ring(2, 0.2, 0.0, Ranging::default()).expect("a rig"));
/// Surfaces of a world that is driven through: mirrors are sought among three of them at a time.
const MOST: usize = 12;

/// The bytes are the file.
pub fn check(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let world = match World::parse(text, "world.toml", &[]) {
        Ok(world) => world,
        Err(error) => {
            let words = error.to_string();
            assert!(words.starts_with("world.toml"), "{words}");
            // A message is read by a person, on a terminal.
            assert!(words.len() < 4096 && !words.chars().any(|c| c.is_control() && c != '\n'), "{words:?}");
            return;
        }
    };
    for point in [Point2::origin(), Point2::new(1e12, -1e12), Point2::new(-0.5, 3.0)] {
        assert!(world.distance(point) >= 0.0);
    }
    for (_, pose) in world.path().sweeps().take(20) {
        assert!(pose.x.is_finite() && pose.y.is_finite() && pose.yaw.is_finite(), "{pose:?}");
    }
    if world.surfaces().len() > MOST || world.surfaces().iter().any(|surface| surface.shape.length() > 100.0) {
        return;
    }
    let simulation = Simulation::new(world, RIG.clone(), PI / 8.0, Effects::default(), 1);
    for sweep in simulation.sweeps().take(2) {
        let Ok(_) = sweep else { return };
    }
}

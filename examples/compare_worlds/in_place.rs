//! Robots that turn where they stand: once around, and by half a beam at every stop.

use std::error::Error;

use atm::{
    core::{Isometry2, Point2, UnitComplex, Vector2},
    intake::Defaults,
    rig::Rig,
    track::Pose,
};
use atm_lab::{
    baseline::interleaved,
    compare::Name,
    simulate::{Beam, Effects, Scene},
    world::{Gap, World},
};

use crate::{
    drive::{Driven, median},
    scores::turned,
    table::{Table, cm, headings, text},
};

/// Turning once around, which is what regions of constant depth need and nothing else can use.
pub fn turning(worlds: &[&'static str], effects: Effects, seeds: u64) -> Result<Table, Box<dyn Error>> {
    let mut rows = Vec::new();
    for world in worlds {
        let driven = Driven::through(world, &[("path".into(), "turning".into())], effects, seeds)?;
        for method in [Name::Rcd, Name::Centerline, Name::AtmMedianSingle] {
            rows.push(headings(&[world, method.word()]).into_iter().chain(turned(&driven, method)).collect());
        }
    }
    Ok(Table {
        name: "turning",
        title: "Turning once in place, 2.5° a sweep",
        header: headings(&["", "", "points", "azimuth, cm", "surface, cm", "coverage, %", "ghosts, %"]),
        words: 2,
        rows,
    })
}

/// The centres of the cones along the doorway's path, as it is driven and with a stop at each pose to turn by half a beam.
pub fn interleaving(seeds: u64) -> Result<Table, Box<dyn Error>> {
    let world = World::load("doorway", &[])?;
    let straight: Vec<Pose> = world.path().sweeps().map(|(_, pose)| pose).collect();
    let turned = interleaved(&straight, Defaults::FIELD_OF_VIEW);
    let mut rows = Vec::new();
    for (name, poses) in [("straight past", &straight), ("turned by half a beam at every stop", &turned)] {
        let drives: Vec<[Option<f64>; 3]> =
            (1..=seeds).map(|seed| centres(&world, poses, seed)).collect::<Option<_>>().ok_or("no such rig")?;
        let of = |index: usize| median(drives.iter().map(|drive| drive.get(index).copied().flatten()));
        rows.push(vec![name.to_owned(), text(of(0), 0), text(cm(of(1)), 1), text(cm(of(2)), 0)]);
    }
    Ok(Table {
        name: "interleaving",
        title: "Rotate and interleave, doorway",
        header: headings(&["", "points", "azimuth, cm", "doorway, cm"]),
        words: 1,
        rows,
    })
}

/// How many echoes there are, how far off along the arc their centres are (median), and what they leave of the doorway.
fn centres(world: &World, poses: &[Pose], seed: u64) -> Option<[Option<f64>; 3]> {
    let scene = Scene::new(world.clone(), seed);
    let rig = Rig::builtin("nomad200")?;
    let (mut points, mut off) = (Vec::new(), Vec::new());
    for pose in poses {
        let heading = UnitComplex::from_cos_sin_unchecked(pose.yaw.cos(), pose.yaw.sin());
        let robot = Isometry2::from_parts(Vector2::new(pose.x, pose.y).into(), heading);
        for sensor in rig.sensors() {
            let place = robot * sensor.mount();
            let heard = scene.direct(&Beam::new(&place, Defaults::FIELD_OF_VIEW), sensor.max_range());
            let step = sensor.range_resolution().unwrap_or(Defaults::RANGE_RESOLUTION);
            if let Some(heard) = heard.filter(|heard| heard.range >= sensor.min_range()) {
                points.push(place * Point2::new((heard.range / step).round() * step, 0.0));
                off.push(Some(heard.azimuth.abs() * heard.range));
            }
        }
    }
    let width = world.openings().first().map(|opening| Gap::between(opening.jambs, &points).width());
    Some([Some(points.len() as f64), median(off.into_iter()), width])
}

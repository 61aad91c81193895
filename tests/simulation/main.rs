//! What beams hear, against a second computation that samples every surface.

mod brute_force;
mod draw;

use atm_lab::{simulate::Scene, world::Material};
use brute_force::{Place, Second};
use draw::Draw;

/// Random beams in random worlds, for each material.
const WORLDS: u64 = 400;
const BEAMS: u32 = 25;
/// How far two ranges may be apart, in metres.
const AGREE: f64 = 1e-4;

/// What was compared.
#[derive(Debug, Default)]
struct Tally {
    beams: u32,
    heard: u32,
    slivers: u32,
}

fn compare(material: Material) -> Tally {
    let mut tally = Tally::default();
    for seed in 0..WORLDS {
        let mut draw = Draw::new(seed, material);
        let world = draw.world();
        let scene = Scene::new(world, seed);
        let second = Second::new(&scene);
        for _ in 0..BEAMS {
            let place = draw.place(&second);
            tally.beams += 1;
            compare_one(&scene, &second, &place, &mut tally, &format!("seed {seed}: {place:?}"));
        }
    }
    println!("{material}: {tally:?}");
    tally
}

fn compare_one(scene: &Scene, second: &Second, place: &Place, tally: &mut Tally, case: &str) {
    let heard = scene.direct(&place.beam(), f64::INFINITY);
    let sampled = second.nearest(place);
    let Some(heard) = heard else {
        assert_eq!(sampled, None, "{case}: silent, but something answers");
        return;
    };
    tally.heard += 1;
    assert!((heard.range - (heard.point - place.origin).norm()).abs() < 1e-12, "{case}: {heard:?}");
    assert!((place.azimuth(heard.point) - heard.azimuth).abs() < 1e-12, "{case}: {heard:?}");
    assert!(second.admits(place, heard.point), "{case}: {heard:?} is not admissible, {sampled:?} m is");
    match sampled {
        Some(range) => {
            assert!(heard.range <= range + AGREE, "{case}: {heard:?}, but {range} m is nearer");
            tally.slivers += u32::from(heard.range < range - AGREE);
        }
        // What is narrower than the samples are apart was found all the same: it is admissible.
        None => tally.slivers += 1,
    }
}

fn check(material: Material) {
    let tally = compare(material);
    assert_eq!(tally.beams, 10_000);
    assert!(tally.heard > 3_000, "{tally:?}");
    assert!(tally.slivers < tally.beams / 500, "{tally:?}: the samples are too coarse to say anything");
}

#[test]
fn specular_worlds_agree_with_dense_sampling() {
    check(Material::Specular);
}

#[test]
fn rough_worlds_agree_with_dense_sampling() {
    check(Material::Rough);
}

#[test]
fn diffuse_worlds_agree_with_dense_sampling() {
    check(Material::Diffuse);
}

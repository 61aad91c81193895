use std::{f64::consts::PI, fmt::Write};

use nalgebra::Point2;

use super::*;
use crate::truth::Cause;

const BEAM: f64 = PI / 8.0;
const INCH: f64 = 0.0254;

fn simulation(world: &str, set: &[(&str, &str)], noise: &str, seed: u64) -> Simulation {
    let set: Vec<_> = set.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    let effects = if noise.is_empty() { Effects::default() } else { noise.parse().unwrap() };
    Simulation::new(World::load(world, &set).unwrap(), Rig::builtin("nomad200").unwrap(), BEAM, effects, seed)
}

fn sweeps(simulation: &Simulation) -> Vec<Sweep> {
    simulation.sweeps().map(Result::unwrap).collect()
}

/// All readings one after another, with their truth.
fn readings(sweeps: &[Sweep]) -> Vec<(f64, Option<TruthPoint>)> {
    sweeps.iter().flat_map(|sweep| sweep.readings.iter().map(|(_, range)| *range).zip(sweep.truth.clone())).collect()
}

#[test]
fn ranges_are_rounded_to_the_step_last_and_limits_count_afterwards() {
    let rig = Rig::builtin("nomad200").unwrap();
    let reported = |inches: f64| reported(Some(inches * INCH), &rig.sensors()[0]);
    assert_eq!(reported(61.49), 1.5494);
    assert_eq!(reported(61.5), 1.5748, "halves go up");
    assert_eq!(reported(5.5), 0.1524);
    assert_eq!(reported(5.49), f64::NEG_INFINITY);
    assert_eq!(reported(254.49), 6.4516);
    assert_eq!(reported(254.5), f64::INFINITY);
    assert_eq!(super::reported(None, &rig.sensors()[0]), f64::INFINITY);
}

#[test]
fn truth_lies_at_the_reading_from_the_true_pose_and_in_the_beam() {
    for world in World::BUILTIN {
        let simulation = simulation(world, &[], "odometry=5cm,heading=3deg", 3);
        for sweep in sweeps(&simulation) {
            for ((sensor, range), truth) in sweep.readings.iter().zip(&sweep.truth) {
                assert_eq!(range.is_finite(), truth.is_some());
                let Some(truth) = truth else { continue };
                let mount = simulation.rig().sensors()[usize::from(*sensor)].mount();
                let at = (isometry(sweep.true_pose) * mount).inverse() * truth.position;
                assert!((at.coords.norm() - range).abs() <= INCH / 2.0 + 1e-9, "{world}: {sweep:?}");
                assert!((at.y.atan2(at.x) - truth.azimuth).abs() < 1e-9 && truth.azimuth.abs() <= BEAM / 2.0 + 1e-9);
                // A bump stands out by an inch at most, and so does a pole's nearest point: it is on its rim.
                assert!(simulation.scene().world().distance(truth.position) <= MAX_DEPTH);
            }
        }
    }
}

#[test]
fn causes_are_those_of_the_world() {
    let causes = |world: &str, set: &[(&str, &str)]| {
        let mut causes: Vec<Cause> = readings(&sweeps(&simulation(world, set, "", 1)))
            .iter()
            .filter_map(|(_, truth)| truth.map(|truth| truth.cause))
            .collect();
        causes.sort();
        causes.dedup();
        causes
    };
    assert_eq!(causes("specular-wall", &[]), [Cause::Wall]);
    assert_eq!(causes("diffuse-wall", &[]), [Cause::Wall]);
    assert_eq!(causes("rough-wall", &[]), [Cause::Wall, Cause::Scatterer]);
    assert_eq!(causes("pole", &[]), [Cause::Pole]);
    assert_eq!(causes("corners", &[]), [Cause::Wall, Cause::Corner]);
}

#[test]
fn odometry_noise_is_in_the_logged_pose_and_nowhere_else() {
    let (plain, noisy) = (
        sweeps(&simulation("doorway", &[], "", 1)),
        sweeps(&simulation("doorway", &[], "odometry=2cm,heading=1deg", 1)),
    );
    assert_eq!(readings(&plain), readings(&noisy));
    assert!(plain.iter().all(|sweep| sweep.pose == sweep.true_pose));
    assert_eq!(noisy[0].pose, noisy[0].true_pose, "it begins where it is");
    assert!(noisy.iter().skip(1).all(|sweep| sweep.pose != sweep.true_pose));
}

#[test]
fn odometry_drifts_with_the_root_of_the_way() {
    // After 6.096 m, over many seeds.
    let (mut offs, mut turns) = (Vec::new(), Vec::new());
    for seed in 0..400 {
        let last = sweeps(&simulation("pole", &[], "odometry=2cm", seed)).pop().unwrap();
        offs.push((last.pose.y - last.true_pose.y) / 0.02);
        let last = sweeps(&simulation("pole", &[], "heading=2deg", seed)).pop().unwrap();
        turns.push((last.pose.yaw - last.true_pose.yaw).to_degrees() / 2.0);
    }
    for draws in [offs, turns] {
        let variance = draws.iter().map(|draw| draw * draw).sum::<f64>() / 400.0;
        // Four deviations of a variance from 400 draws: 28 %.
        assert!((variance / 6.096 - 1.0).abs() < 0.28, "{variance}");
    }
}

#[test]
fn range_noise_comes_before_rounding() {
    let simulation = simulation("specular-wall", &[], "range=2in", 5);
    let errors: Vec<f64> =
        readings(&sweeps(&simulation)).iter().filter_map(|(range, truth)| truth.map(|_| range / INCH)).collect();
    assert!(errors.iter().all(|inches| (inches - inches.round()).abs() < 1e-6), "whole inches still");
    // Sensors 3, 4 and 5 of 49 sweeps; only the middle one faces the wall: 70 - 9 = 61 in.
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    let deviation = (errors.iter().map(|error| (error - mean).powi(2)).sum::<f64>() / errors.len() as f64).sqrt();
    assert!((mean - 61.0).abs() < 1.2 && (deviation - 2.0).abs() < 0.9, "{mean} ± {deviation}");
}

#[test]
fn dropouts_and_crosstalk_come_as_often_as_asked_for() {
    let plain = readings(&sweeps(&simulation("doorway", &[("length", "60m")], "", 1)));
    let missed = readings(&sweeps(&simulation("doorway", &[("length", "60m")], "dropout=20%", 1)));
    let echoes = plain.iter().filter(|(range, _)| range.is_finite()).count() as f64;
    let left = missed.iter().filter(|(range, _)| range.is_finite()).count() as f64;
    assert!((left / echoes - 0.8).abs() < 0.02, "{left} of {echoes}");
    assert!(plain.iter().zip(&missed).all(|(plain, missed)| missed.0 == plain.0 || missed.0 == f64::INFINITY));

    let talked = readings(&sweeps(&simulation("doorway", &[("length", "60m")], "crosstalk=10%", 1)));
    let false_ones =
        talked.iter().filter(|(_, truth)| truth.is_some_and(|truth| truth.cause == Cause::Crosstalk)).count();
    assert!((false_ones as f64 / talked.len() as f64 - 0.1).abs() < 0.015, "{false_ones} of {}", talked.len());
    let is_false = |truth: Option<TruthPoint>| truth.is_none_or(|truth| truth.cause == Cause::Crosstalk);
    assert!(plain.iter().zip(&talked).all(|(plain, talked)| plain == talked || is_false(talked.1)));
}

#[test]
fn switching_one_effect_on_leaves_the_draws_of_the_others_alone() {
    let missed = |noise: &str| -> Vec<bool> {
        readings(&sweeps(&simulation("rough-wall", &[], noise, 9))).iter().map(|(_, truth)| truth.is_none()).collect()
    };
    assert_eq!(missed("dropout=30%"), missed("dropout=30%,range=1mm,odometry=1cm"));
    let poses = |noise: &str| {
        sweeps(&simulation("rough-wall", &[], noise, 9)).iter().map(|sweep| sweep.pose).collect::<Vec<_>>()
    };
    assert_eq!(poses("odometry=1cm"), poses("odometry=1cm,dropout=50%,crosstalk=5%,range=3cm,multipath"));
}

#[test]
fn mirrors_only_add_echoes_that_are_nearer() {
    let plain = readings(&sweeps(&simulation("room", &[], "", 1)));
    let mirrored = readings(&sweeps(&simulation("room", &[], "multipath", 1)));
    let ghosts =
        mirrored.iter().filter(|(_, truth)| truth.is_some_and(|truth| truth.cause == Cause::Multipath)).count();
    assert!(ghosts > 5, "{ghosts}");
    for (plain, mirrored) in plain.iter().zip(&mirrored) {
        let is_ghost = mirrored.1.is_some_and(|truth| truth.cause == Cause::Multipath);
        assert!(if is_ghost { mirrored.0 <= plain.0 } else { mirrored == plain });
    }
}

#[test]
fn sensor_behind_a_wall_ends_the_drive_with_its_name() {
    let simulation = simulation("rough-wall", &[("distance", "20cm")], "", 1);
    let error = simulation.sweeps().find_map(Result::err).unwrap().to_string();
    assert_eq!(
        error,
        "rough-wall: at t = 0 s sensor 3 would be inside or behind a surface: the path is too close to it"
    );
}

/// Fowler, Noll and Vo's hash of 64 bits.
fn hash(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

#[test]
fn all_effects_together_give_the_same_bits_on_every_machine() {
    let noise = "multipath,crosstalk=2%,range=5mm,dropout=3%,odometry=1cm,heading=0.5deg";
    let mut text = String::new();
    for sweep in sweeps(&simulation("room", &[], noise, 42)) {
        write!(text, "{sweep:?}").unwrap();
    }
    assert_eq!(hash(&text), 0x6e21_ea36_aeac_c3a8, "{:#x}", hash(&text));
}

#[test]
fn seeds_differ() {
    let log = |seed| readings(&sweeps(&simulation("rough-wall", &[], "", seed)));
    assert_ne!(log(1), log(2));
}

#[test]
fn sweep_knows_every_sensor_once() {
    for sweep in sweeps(&simulation("tee", &[], "", 1)) {
        assert!(sweep.readings.iter().map(|(sensor, _)| *sensor).eq(0..16));
        assert_eq!(sweep.truth.len(), 16);
        let _: Point2<f64> = Point2::new(sweep.pose.x, sweep.pose.y);
    }
}

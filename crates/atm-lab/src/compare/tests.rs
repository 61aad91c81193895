use std::sync::Arc;

use atm::{
    intake::Defaults,
    log::{
        Input,
        csv::{CsvReadings, PoseUse},
    },
    rig::Rig,
};

use super::*;
use crate::{
    eval::{Estimate, Judge, Scores},
    simulate::{Effects, Simulation},
    world::World,
};

/// A log of the built-in ring, as text.
fn recording(text: String, drop_held: bool) -> Recording {
    let rig = Arc::new(Rig::builtin("nomad200").unwrap());
    let sensors = Defaults::default().complete(&rig).unwrap();
    let input = Input { reader: Box::new(std::io::Cursor::new(text)), name: "log.csv".into(), length: None };
    let mut log = CsvReadings::new(input, &Default::default(), PoseUse::Needed, None, rig).unwrap();
    Recording::read(&mut log, None, &sensors, drop_held, &mut |_| ()).unwrap()
}

/// A drive through a world.
fn drive(world: &World) -> Recording {
    let rig = Rig::builtin("nomad200").unwrap();
    simulated(&Simulation::new(world.clone(), rig, 0.4, Effects::default(), 1)).unwrap().0
}

const HEADER: &str = "t,sensor,range,x,y,yaw\n";

#[test]
fn held_readings_are_left_out_by_sensor_and_a_reading_without_echo_is_a_value() {
    // Sensor 0: 1, 1, inf, inf, 1; sensor 1 says 1 between them, which is nothing to it.
    let rows = ["0,0,1", "0,1,1", "1,0,1", "2,0,inf", "3,0,7", "4,0,1"];
    let text: String = rows.iter().map(|row| format!("{row},0,0,0\n")).collect();
    let all = recording(format!("{HEADER}{text}"), false);
    let dropped = recording(format!("{HEADER}{text}"), true);
    assert_eq!((all.readings(), all.summary.no_echo), (6, 2), "7 m is beyond the ring's reach");
    assert_eq!((dropped.readings(), dropped.summary.skipped.held), (4, 2));
    let said = run(Name::Centerline, &dropped, &Options::default()).unwrap().estimates.unwrap();
    let times: Vec<i64> = said.iter().map(|estimate| estimate.key.as_ref().unwrap().0).collect();
    assert_eq!(times, [0, 0, 4_000_000_000]);
}

#[test]
fn a_clock_that_is_set_back_parts_the_log_for_every_method() {
    // A pair that crosses at 90°, 1 s apart; then the clock goes back for good, which takes 16 rows to be believed, and the
    // same pair's second reading comes alone.
    let ring = |t: i64, x: f64| format!("{t},0,1.2,{x},0,0.785398163397448\n");
    let other = |t: i64| format!("{t},4,1.2,1.7,0,0.785398163397448\n");
    let mut text = format!("{HEADER}{}{}", ring(1000, 0.0), other(1001));
    let together = run(Name::Intersections, &recording(text.clone(), false), &Options::default()).unwrap();
    assert_eq!(together.estimates.unwrap().len(), 1);
    text = format!("{HEADER}{}", ring(1000, 0.0));
    for t in 0..17 {
        text += &format!("{t},0,inf,0,0,0\n");
    }
    text += &other(20);
    let apart = recording(text, false);
    assert_eq!((apart.parts().count(), apart.summary.clock_resets), (2, 1));
    let said = run(Name::Intersections, &apart, &Options::default()).unwrap();
    assert!(said.estimates.unwrap().is_empty());
}

#[test]
fn what_does_not_apply_is_nothing() {
    let straight = drive(&World::load("doorway", &[]).unwrap());
    for name in [Name::Rcd, Name::Interleave] {
        let said = run(name, &straight, &Options::default()).unwrap();
        assert!(said.estimates.is_none());
        let judged = among_themselves(&[said], straight.readings()).unwrap();
        assert_eq!((judged[0].points, judged[0].map_entropy_bits), (None, Sharpness::default()));
        assert!(judged[0].agreement.is_none());
    }
    let turning = World::load("corners", &[("path".into(), "turning".into())]).unwrap();
    let said = run(Name::Rcd, &drive(&turning), &Options::default()).unwrap();
    assert!(!said.estimates.unwrap().is_empty());
}

/// The judge of a world, and what all methods say of a drive through it.
fn doorway() -> (World, Recording, Vec<Outcome>) {
    let world = World::load("doorway", &[]).unwrap();
    let recording = drive(&world);
    let said = Name::ALL.iter().map(|name| run(*name, &recording, &Options::default()).unwrap()).collect();
    (world, recording, said)
}

#[test]
fn every_method_is_scored_as_eval_scores_its_points_and_grids_have_a_best() {
    let (world, recording, said) = doorway();
    let views: Vec<_> = recording.views().iter().copied().collect();
    let judge = Judge::new(&world, None, &views);
    let judged = against_world(&said, &judge, &world, recording.readings(), recording.ids()).unwrap();
    for (outcome, assessment) in said.iter().zip(&judged) {
        let expected: Option<Scores> = outcome.estimates.as_ref().map(|estimates| judge.scores(estimates));
        assert_eq!(assessment.scores, expected, "{:?}", outcome.name);
        assert_eq!(assessment.best.is_some(), outcome.evidence.is_some());
        if let Some(best) = &assessment.best {
            assert!(fit(&best.scores) >= fit(assessment.scores.as_ref().unwrap()) - 0.05, "{:?}", outcome.name);
        }
    }
    let of = |name: Name| &judged[Name::ALL.iter().position(|other| *other == name).unwrap()];
    let same = of(Name::AtmMedianSingle).same_readings.as_ref().unwrap();
    let echoes = of(Name::Centerline).points.unwrap();
    assert!((same.answered - of(Name::AtmMedianSingle).points.unwrap() as f64 / echoes as f64).abs() < 1e-12);
    assert!(of(Name::Voting).same_readings.is_none());
}

/// Coverage and the share of points that are no ghosts, together: not what `best` maximises, but close.
fn fit(scores: &Scores) -> f64 {
    let precision = 1.0 - scores.all.ghosts as f64 / scores.all.points.max(1) as f64;
    let coverage = scores.all.coverage.unwrap();
    2.0 * precision * coverage / (precision + coverage).max(1e-9)
}

#[test]
fn plain_intersections_narrow_the_doorway_that_median_and_single_leave() {
    let (world, recording, said) = doorway();
    let views: Vec<_> = recording.views().iter().copied().collect();
    let judged =
        against_world(&said, &Judge::new(&world, None, &views), &world, recording.readings(), recording.ids()).unwrap();
    let width = |name: Name| {
        let index = Name::ALL.iter().position(|other| *other == name).unwrap();
        judged[index].scores.as_ref().unwrap().all.doorway_width_m.unwrap()
    };
    // Of 36 in.
    assert!(width(Name::AtmMedianSingle) > 0.0254 * 34.0, "{}", width(Name::AtmMedianSingle));
    assert!(width(Name::Intersections) < 0.0254 * 12.0, "{}", width(Name::Intersections));
    assert!(width(Name::Centerline) < 0.0254 * 18.0, "{}", width(Name::Centerline));
}

#[test]
fn agreement_is_the_share_of_points_near_the_others() {
    let said = |name, places: &[f64]| Outcome {
        significances: None,
        name,
        estimates: Some(places.iter().map(|x| at(*x)).collect()),
        segments: Vec::new(),
        evidence: None,
        seconds: 3.0,
    };
    let judged = among_themselves(&[said(Name::Atm, &[0.0, 1.0, 2.0]), said(Name::Tbf, &[0.05, 9.0])], 4).unwrap();
    assert_eq!(judged[0].agreement.as_ref().unwrap()["tbf"], Some(1.0 / 3.0));
    assert_eq!(judged[1].agreement.as_ref().unwrap()["atm"], Some(0.5));
    assert_eq!((judged[0].points, judged[0].seconds_per_reading), (Some(3), 0.75));
    assert!(judged[0].scores.is_none());
}

fn at(x: f64) -> Estimate {
    Estimate { position: atm_core::Point2::new(x, 0.0), key: None, azimuth: None, range: None, kind: None }
}

#[test]
fn names_and_words_are_one_to_one() {
    for name in Name::ALL {
        assert_eq!(Name::from_word(name.word()), Some(name));
    }
    assert_eq!(Name::from_word("gvg"), None);
}

#[test]
fn a_picture_has_the_walls_the_path_and_what_the_method_says() {
    let (world, recording, said) = doorway();
    let names = |name: Name| {
        let outcome = said.iter().find(|one| one.name == name).unwrap();
        let scene = scene(outcome, &recording, Some(&world)).unwrap();
        scene.names().into_iter().map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(names(Name::Atm), ["walls", "opening", "path", "atm"]);
    assert_eq!(names(Name::Himm), ["grid", "walls", "opening", "path"]);
    assert_eq!(names(Name::McKerrow), ["walls", "opening", "path", "mckerrow"]);
    let himm = said.iter().find(|one| one.name == Name::Himm).unwrap();
    let drawn = cells(himm.evidence.as_ref().unwrap()).unwrap();
    let black = drawn.values.iter().filter(|value| **value == 1.0).count();
    assert_eq!(black, himm.estimates.as_ref().unwrap().len());
}

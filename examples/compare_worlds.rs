//! The measured tables of `docs/methods.md`: every method on the same drives through the built-in worlds.
//!
//! `cargo run --release --example compare_worlds [SEEDS] [NOISE]`, 30 seeds and no noise unless said; NOISE as `atm simulate --noise`
//! takes it. What stands in a cell is the median over the seeds.
use std::{collections::BTreeSet, error::Error};

use atm::{
    baseline::interleaved,
    compare::{Assessment, Name, Options, Outcome, against_world, run, simulated},
    core::{Isometry2, Point2, UnitComplex, Vector2},
    eval::{Estimate, Judge, doorway::Gap},
    intake::Defaults,
    log::View,
    rig::Rig,
    simulate::{Beam, Effects, Scene, Simulation},
    track::Pose,
    world::World,
};

/// The worlds, and what their columns are called.
const WORLDS: [&str; 9] =
    ["doorway", "closed-wall", "tee", "room", "rough-wall", "specular-wall", "diffuse-wall", "corners", "pole"];

/// The assessments of one world, a row a seed and a column a method.
type Seeds = Vec<Vec<Assessment>>;

/// Two methods that leave the hard readings out, and two that answer them all, to be compared on what the first two both answer.
const SHARED: [Name; 4] = [Name::AtmMedianSingle, Name::Tbf, Name::Atm, Name::Centerline];

/// The worlds of the curve: those with rough surfaces, edges and corners.
const CURVE: [&str; 4] = ["doorway", "room", "rough-wall", "corners"];
/// Of a method's points the surest shares that are kept.
const KEPT: [f64; 4] = [1.0, 0.5, 0.25, 0.1];
/// How many readings two methods both answer, and the median azimuth error of each of [`SHARED`] on them, in metres.
type OnTheSame = (f64, [Option<f64>; 4]);

/// For each of [`KEPT`]: points, ghosts among them, coverage.
type Curve = [Option<(f64, f64, f64)>; 4];

/// One drive.
struct Drive {
    methods: Vec<Assessment>,
    /// The first two of [`SHARED`] answer these.
    shared: OnTheSame,
    /// Of each method.
    curve: Vec<Curve>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let seeds: u64 = args.next().map_or(Ok(30), |text| text.parse())?;
    let effects: Effects = args.next().map_or(Ok(Effects::default()), |text| text.parse())?;
    let (mut worlds, mut shared, mut curves) = (Vec::new(), Vec::new(), Vec::new());
    for name in WORLDS {
        let world = World::load(name, &[])?;
        let drives = (1..=seeds).map(|seed| assess(&world, effects, seed)).collect::<Result<Vec<Drive>, _>>()?;
        shared.push(drives.iter().map(|drive| drive.shared).collect());
        if CURVE.contains(&name) {
            curves.extend(drives.iter().map(|drive| drive.curve.clone()));
        }
        worlds.push(drives.into_iter().map(|drive| drive.methods).collect());
    }
    points(&worlds);
    grids(&worlds);
    same_readings(&worlds);
    both_answer(&shared);
    curve(&curves);
    turning(effects, seeds)?;
    interleaving(seeds)
}

/// Every method on one drive.
fn assess(world: &World, effects: Effects, seed: u64) -> Result<Drive, Box<dyn Error>> {
    let rig = Rig::builtin("nomad200").ok_or("no such rig")?;
    let simulation = Simulation::new(world.clone(), rig, Defaults::FIELD_OF_VIEW, effects, seed);
    let (recording, truth) = simulated(&simulation)?;
    let said: Vec<_> =
        Name::ALL.iter().map(|name| run(*name, &recording, &Options::default())).collect::<Result<_, _>>()?;
    let views: Vec<View> = recording.views().iter().copied().collect();
    let judge = Judge::new(world, Some(&truth), &views);
    let methods = against_world(&said, &judge, world, recording.readings(), recording.ids())?;
    let curve = said.iter().map(|one| KEPT.map(|share| kept(one, share, &judge))).collect();
    Ok(Drive { methods, shared: shared(&said, &judge), curve })
}

/// The methods of [`SHARED`] on the readings that the first two both answer.
fn shared(said: &[Outcome], judge: &Judge<'_>) -> OnTheSame {
    let of =
        |name: Name| said.iter().find(|one| one.name == name).and_then(|one| one.estimates.as_deref()).unwrap_or(&[]);
    let keys = |name: Name| of(name).iter().filter_map(|one| one.key.as_ref()).collect::<BTreeSet<_>>();
    let (first, second) = (keys(SHARED[0]), keys(SHARED[1]));
    let both: BTreeSet<_> = first.intersection(&second).copied().collect();
    let errors = SHARED.map(|name| {
        let same = of(name).iter().filter(|one| one.key.as_ref().is_some_and(|key| both.contains(key)));
        judge.scores(&same.cloned().collect::<Vec<_>>()).all.azimuth_error_m.p50
    });
    (both.len() as f64, errors)
}

/// An estimate without a place.
fn nothing() -> Estimate {
    Estimate { position: Point2::origin(), key: None, azimuth: None, range: None, kind: None }
}

/// A method's surest points, so many of all: the least significant accidents, or the strongest cells. `None` of a share of what says
/// nothing of how sure it is.
fn kept(said: &Outcome, share: f64, judge: &Judge<'_>) -> Option<(f64, f64, f64)> {
    let all = said.estimates.as_ref()?;
    let count = (all.len() as f64 * share).round() as usize;
    let some: Vec<Estimate> = match (&said.significances, &said.evidence) {
        _ if share >= 1.0 => all.clone(),
        (Some(significances), _) => {
            let mut surest: Vec<(&f64, &Estimate)> = significances.iter().zip(all).collect();
            surest.sort_by(|a, b| a.0.total_cmp(b.0));
            surest.into_iter().take(count).map(|(_, estimate)| estimate.clone()).collect()
        }
        (None, Some(evidence)) => {
            let above = |(_, value): &(_, f64)| *value > evidence.occupied_above;
            let mut cells: Vec<_> = evidence.grid.cells().filter(above).collect();
            cells.sort_by(|a, b| b.1.total_cmp(&a.1));
            let point = |cell| Estimate { position: evidence.grid.center(cell), ..nothing() };
            cells.into_iter().take(count).map(|(cell, _)| point(cell)).collect()
        }
        (None, None) => return None,
    };
    let all = judge.scores(&some).all;
    Some((all.points as f64, all.ghosts as f64, all.coverage.unwrap_or(0.0)))
}

/// Coverage against cleanliness, over all drives of [`CURVE`] together.
fn curve(drives: &[Vec<Curve>]) {
    println!(
        "\n**The surest points alone: ghosts, % of them / coverage, %**\n\n| |all|half|a quarter|a tenth|\n|---|--:|--:|--:|--:|"
    );
    for (method, name) in Name::ALL.iter().enumerate() {
        let cell = |kept: usize| {
            let (mut points, mut ghosts, mut coverage, mut count) = (0.0, 0.0, 0.0, 0.0);
            for (all, ghostly, covered) in drives.iter().filter_map(|drive| *drive.get(method)?.get(kept)?) {
                (points, ghosts, coverage, count) = (points + all, ghosts + ghostly, coverage + covered, count + 1.0);
            }
            if points > 0.0 {
                format!("{:.2} / {:.0}", 100.0 * ghosts / points, 100.0 * coverage / count)
            } else {
                "-".to_owned()
            }
        };
        if (0..KEPT.len()).any(|kept| cell(kept) != "-") {
            println!("|{}|{}|", name.word(), [0, 1, 2, 3].map(cell).join("|"));
        }
    }
}

/// The median over the seeds; `-` where there is nothing.
fn median(values: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let mut values: Vec<f64> = values.flatten().collect();
    values.sort_by(f64::total_cmp);
    let middle = |index: usize| values.get(index).copied();
    let half = values.len() / 2;
    if values.len() % 2 == 1 { middle(half) } else { Some((middle(half.checked_sub(1)?)? + middle(half)?) / 2.0) }
}

/// A table of one number: methods down, worlds across.
fn table(title: &str, worlds: &[Seeds], digits: usize, number: impl Fn(&Assessment) -> Option<f64>) {
    println!("\n{title}\n\n| |{}|\n|---|{}", WORLDS.join("|"), "--:|".repeat(WORLDS.len()));
    for (index, name) in Name::ALL.iter().enumerate() {
        let cells: Vec<Option<f64>> =
            worlds.iter().map(|seeds| median(seeds.iter().map(|row| row.get(index).and_then(&number)))).collect();
        if cells.iter().any(Option::is_some) {
            let cells: Vec<String> = cells.into_iter().map(|cell| text(cell, digits)).collect();
            println!("|{}|{}|", name.word(), cells.join("|"));
        }
    }
}

fn text(number: Option<f64>, digits: usize) -> String {
    number.map_or_else(|| "-".to_owned(), |number| format!("{number:.digits$}"))
}

/// Metres in centimetres.
fn cm(metres: Option<f64>) -> Option<f64> {
    metres.map(|metres| 100.0 * metres)
}

fn points(worlds: &[Seeds]) {
    table("**Points**", worlds, 0, |row| Some(row.points? as f64));
    table("**Azimuth error, median, cm along the arc**", worlds, 1, |row| {
        cm(row.scores.as_ref()?.all.azimuth_error_m.p50)
    });
    table("**Azimuth error, 90 %, cm along the arc**", worlds, 1, |row| {
        cm(row.scores.as_ref()?.all.azimuth_error_m.p90)
    });
    table("**Distance to the nearest surface, median, cm**", worlds, 1, |row| {
        cm(row.scores.as_ref()?.all.surface_error_m.p50)
    });
    table("**Distance to the nearest surface, 90 %, cm**", worlds, 1, |row| {
        cm(row.scores.as_ref()?.all.surface_error_m.p90)
    });
    table("**Coverage, %**", worlds, 0, |row| Some(100.0 * row.scores.as_ref()?.all.coverage?));
    table("**Ghosts, % of the points**", worlds, 1, |row| {
        let all = &row.scores.as_ref()?.all;
        (all.points > 0).then(|| 100.0 * all.ghosts as f64 / all.points as f64)
    });
    table("**Doorway, cm of 91.4**", worlds, 0, |row| cm(row.scores.as_ref()?.all.doorway_width_m));
}

fn grids(worlds: &[Seeds]) {
    table(
        "**Best threshold, which a robot can't know: distance to the nearest surface, median, cm**",
        worlds,
        1,
        |row| cm(row.best.as_ref()?.scores.all.surface_error_m.p50),
    );
    table("**Best threshold: coverage, %**", worlds, 0, |row| Some(100.0 * row.best.as_ref()?.scores.all.coverage?));
    table("**Best threshold: doorway, cm of 91.4**", worlds, 0, |row| {
        cm(row.best.as_ref()?.scores.all.doorway_width_m)
    });
}

fn same_readings(worlds: &[Seeds]) {
    table("**Readings answered, % of those with an echo**", worlds, 0, |row| {
        Some(100.0 * row.same_readings.as_ref()?.answered)
    });
    table("**The centres of the cones on the same readings: azimuth error, median, cm**", worlds, 1, |row| {
        cm(row.same_readings.as_ref()?.centerline_azimuth_error_m.p50)
    });
    table("**atm on the same readings: azimuth error, median, cm**", worlds, 1, |row| {
        cm(row.same_readings.as_ref()?.atm_azimuth_error_m.p50)
    });
}

fn both_answer(worlds: &[Vec<OnTheSame>]) {
    println!("\n**On the readings that atm-median-single and tbf both answer: azimuth error, median, cm**\n");
    println!("| |{}|\n|---|{}", WORLDS.join("|"), "--:|".repeat(WORLDS.len()));
    let counts = worlds.iter().map(|seeds| text(median(seeds.iter().map(|(count, _)| Some(*count))), 0));
    println!("|readings|{}|", counts.collect::<Vec<_>>().join("|"));
    for (index, name) in SHARED.iter().enumerate() {
        let of = |(_, errors): &OnTheSame| cm(errors.get(index).copied().flatten());
        let cells = worlds.iter().map(|seeds| text(median(seeds.iter().map(of)), 1));
        println!("|{}|{}|", name.word(), cells.collect::<Vec<_>>().join("|"));
    }
}

/// A robot that turns in place, which is what regions of constant depth need and nothing else can use.
fn turning(effects: Effects, seeds: u64) -> Result<(), Box<dyn Error>> {
    println!("\n**Turning once in place, 2.5° a sweep**\n\n| | |points|azimuth, cm|surface, cm|coverage, %|ghosts, %|");
    println!("|---|---|--:|--:|--:|--:|--:|");
    for name in ["corners", "specular-wall", "doorway"] {
        let world = World::load(name, &[("path".into(), "turning".into())])?;
        let drives = (1..=seeds).map(|seed| assess(&world, effects, seed)).collect::<Result<Vec<Drive>, _>>()?;
        let rows: Seeds = drives.into_iter().map(|drive| drive.methods).collect();
        for method in [Name::Rcd, Name::Centerline, Name::AtmMedianSingle] {
            let index = Name::ALL.iter().position(|other| *other == method).unwrap_or(0);
            let of = |number: &dyn Fn(&Assessment) -> Option<f64>| {
                median(rows.iter().map(|row| row.get(index).and_then(number)))
            };
            let ghosts = |row: &Assessment| {
                let all = &row.scores.as_ref()?.all;
                (all.points > 0).then(|| 100.0 * all.ghosts as f64 / all.points as f64)
            };
            println!(
                "|{name}|{}|{}|{}|{}|{}|{}|",
                method.word(),
                text(of(&|row| Some(row.points? as f64)), 0),
                text(of(&|row| cm(row.scores.as_ref()?.all.azimuth_error_m.p50)), 1),
                text(of(&|row| cm(row.scores.as_ref()?.all.surface_error_m.p50)), 1),
                text(of(&|row| Some(100.0 * row.scores.as_ref()?.all.coverage?)), 0),
                text(of(&ghosts), 1),
            );
        }
    }
    Ok(())
}

/// The centres of the cones along the doorway's path, as it is driven and with a stop at each pose to turn by half a beam.
fn interleaving(seeds: u64) -> Result<(), Box<dyn Error>> {
    let world = World::load("doorway", &[])?;
    let straight: Vec<Pose> = world.path().sweeps().map(|(_, pose)| pose).collect();
    let turned = interleaved(&straight, Defaults::FIELD_OF_VIEW);
    println!("\n**Rotate and interleave, doorway**\n\n| |points|azimuth, cm|doorway, cm|\n|---|--:|--:|--:|");
    for (name, poses) in [("straight past", &straight), ("turned by half a beam at every stop", &turned)] {
        let drives: Vec<[Option<f64>; 3]> =
            (1..=seeds).map(|seed| centres(&world, poses, seed)).collect::<Option<_>>().ok_or("no such rig")?;
        let of = |index: usize| median(drives.iter().map(|drive| drive.get(index).copied().flatten()));
        println!("|{name}|{}|{}|{}|", text(of(0), 0), text(cm(of(1)), 1), text(cm(of(2)), 0));
    }
    Ok(())
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

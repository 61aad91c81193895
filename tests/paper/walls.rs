//! What flat walls of three materials make of it (Sec. IV-D, "Detecting Flat Walls"; Fig. 20).

use atm::{
    core::{Kind, OnNone},
    log::echo_table::Estimate,
};

use super::{
    drive::{Drive, Fused, INCH},
    page,
    spread::{cell, median, number, percent, quantile},
};

const SEEDS: std::ops::RangeInclusive<u64> = 1..=60;
/// Distance of the wall from the path, in inches.
const WALL: f64 = 70.0;
/// Half the interval of Sec. IV-B, 3.73 in, in inches.
const HALF_INTERVAL: f64 = 1.866;

/// What became of all drives past one wall.
#[derive(Default)]
struct Wall {
    drives: f64,
    medians: usize,
    singles: usize,
    others: usize,
    /// How far before the wall the echoes with crossings stand, in inches.
    shifts: Vec<f64>,
    errors: Vec<f64>,
    center_errors: Vec<f64>,
}

impl Wall {
    fn measure(world: &str, path: &str) -> Self {
        let mut wall = Self::default();
        for seed in SEEDS {
            let drive = Drive::new(world, &[("path", path)], "", seed);
            wall.add(&drive, &drive.fuse());
        }
        wall
    }

    fn add(&mut self, drive: &Drive, fused: &Fused) {
        let count = |kind| fused.echoes.iter().filter(|echo| echo.kind == kind).count();
        self.drives += 1.0;
        self.medians += count(Kind::Median);
        self.singles += count(Kind::Single);
        self.others += fused.echoes.len() - count(Kind::Median) - count(Kind::Single);
        let crossed = fused.crossed();
        self.shifts.extend(shifts(&crossed));
        self.errors.extend(drive.azimuth_errors(&crossed));
        self.center_errors.extend(drive.azimuth_errors(&drive.centers()));
    }

    fn row(&self, name: &str) -> Vec<String> {
        let each = |count: usize| number(count as f64 / self.drives);
        vec![
            name.to_owned(),
            format!("{} / {} / {}", each(self.medians), each(self.singles), each(self.others)),
            cell(&self.shifts),
            cell(&self.errors),
            cell(&self.center_errors),
        ]
    }
}

fn shifts(points: &[Estimate]) -> impl Iterator<Item = f64> {
    points.iter().map(|point| WALL - point.position.y / INCH)
}

#[test]
fn rough_walls_are_seen_sharply_smooth_ones_as_by_the_centre_and_diffuse_ones_wrongly() {
    let specular = Wall::measure("specular-wall", "straight");
    let specular_weaving = Wall::measure("specular-wall", "weaving");
    let rough = Wall::measure("rough-wall", "straight");
    let rough_weaving = Wall::measure("rough-wall", "weaving");
    let diffuse = Wall::measure("diffuse-wall", "straight");
    let diffuse_weaving = Wall::measure("diffuse-wall", "weaving");
    let header = [
        "wall, path",
        "`median` / `single` / `center` in a drive",
        "shift towards the robot, in",
        "azimuth error of `median` and `single`, in",
        "of the centre of the cone, in",
    ];
    page::shows(
        "walls",
        &header,
        &[
            specular.row("specular, straight"),
            specular_weaving.row("specular, weaving"),
            rough.row("rough, straight"),
            rough_weaving.row("rough, weaving"),
            diffuse.row("diffuse, straight"),
            diffuse_weaving.row("diffuse, weaving"),
        ],
    );

    // "As good as the centerline approach when passing along a wall".
    assert_eq!((specular.medians, specular.singles), (0, 0));
    // "Less than 1 in".
    for wall in [&rough, &rough_weaving] {
        assert!(median(&wall.shifts) < 1.0 && median(&wall.shifts) > 0.0, "{}", median(&wall.shifts));
        assert!(percent(&wall.shifts, |shift| shift <= 1.5) > 90.0);
        assert!(median(&wall.errors) < 0.8 && median(&wall.center_errors) > 4.0, "{}", median(&wall.errors));
    }
    // Spurious crossings: short of the wall, and no sharper than the interval promises.
    assert!(quantile(&diffuse_weaving.shifts, 0.5) > 0.9);
    assert!(median(&diffuse_weaving.errors) > HALF_INTERVAL, "{}", median(&diffuse_weaving.errors));
    assert!(diffuse_weaving.medians > 0);
}

#[test]
fn specular_wall_gives_the_centres_bit_by_bit() {
    let drive = Drive::new("specular-wall", &[], "", 1);
    let place =
        |points: &[Estimate]| points.iter().map(|point| (point.key.clone(), point.position)).collect::<Vec<_>>();
    let (mut fused, mut centers) = (place(&drive.fuse().all()), place(&drive.centers()));
    fused.sort_by(|a, b| a.0.cmp(&b.0));
    centers.sort_by(|a, b| a.0.cmp(&b.0));
    assert_eq!(fused, centers);
    assert!(!fused.is_empty() && OnNone::default() == OnNone::Center);
}

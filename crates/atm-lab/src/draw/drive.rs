//! What of a log can be drawn: the path, the arcs, and one reading with its beam.
use std::{collections::BTreeSet, sync::Arc};

use atm::{
    error::Result,
    intake::{self, AnyTrack, Consumer, SensorModel},
    log::{Row, Source},
    summary::{Dropped, Summary},
    track::Pose,
};
use atm_core::{Isometry2, Point2, Reading, UnitComplex};

use super::scene::{Cone, Robot, Scene};
use crate::thinned::Thinned;

/// A reading by its time in nanoseconds and its sensor's id.
pub type Key = (i64, Arc<str>);

/// The layers of a log: `path`, `arcs`, `centerline` (where each reading is put that is taken to lie straight ahead); and where a
/// reading is `shown`: `beam`, `beams` (all of its instant), `partners` (the arcs of these readings), and `robot`.
///
/// Records that can't be used are counted.
///
/// # Errors
/// The log can't be read on.
pub fn drive(
    source: &mut dyn Source,
    track: Option<&mut AnyTrack>,
    sensors: &[SensorModel],
    shown: Option<&Key>,
    partners: &BTreeSet<Key>,
) -> Result<(Scene, Dropped)> {
    let mut summary = Summary::default();
    let mut drive = Drive { shown, partners, ..Drive::EMPTY };
    intake::read(source, track, sensors, false, &mut drive, &mut summary, &mut |_| {})?;
    Ok((drive.scene(), summary.dropped))
}

struct Drive<'a> {
    shown: Option<&'a Key>,
    partners: &'a BTreeSet<Key>,
    ids: Vec<Arc<str>>,
    path: Thinned<Option<Point2<f64>>>,
    last: Option<Pose>,
    cones: Thinned<Cone>,
    beam: Option<Cone>,
    beams: Vec<Cone>,
    crossing: Vec<Cone>,
    robot: Option<Robot>,
}

impl Drive<'_> {
    const EMPTY: Drive<'static> = Drive {
        shown: None,
        partners: &BTreeSet::new(),
        ids: Vec::new(),
        path: Thinned::new(),
        last: None,
        cones: Thinned::new(),
        beam: None,
        beams: Vec::new(),
        crossing: Vec::new(),
        robot: None,
    };

    /// The one reading that is shown, and what is of its instant.
    fn show(&mut self, reading: &Reading<f64>, id: &Arc<str>, cone: Option<Cone>) {
        let Some((t, sensor)) = self.shown else {
            return;
        };
        if reading.t == *t {
            self.beams.extend(cone);
            if id == sensor {
                self.beam = cone;
                let radius = (Point2::from(reading.pose.translation.vector) - reading.robot).norm();
                self.robot = self.last.map(|pose| Robot { pose: isometry(pose), radius });
            }
        }
    }

    fn scene(self) -> Scene {
        let mut scene = Scene::new();
        scene.path(self.path.iter().copied());
        scene.arcs("arcs", self.cones.iter().copied());
        scene.beams("beams", self.beams);
        scene.beams("beam", self.beam);
        scene.arcs("partners", self.crossing);
        if let Some(robot) = self.robot {
            scene.robot(robot);
        }
        scene.marks("centerline", self.cones.iter().map(|cone| cone.at(0.0)));
        if let Some(beam) = self.beam {
            scene.rings("centerline", [beam.at(0.0)]);
        }
        scene
    }
}

fn isometry(pose: Pose) -> Isometry2<f64> {
    let heading = UnitComplex::from_cos_sin_unchecked(libm::cos(pose.yaw), libm::sin(pose.yaw));
    Isometry2::from_parts(nalgebra::Vector2::new(pose.x, pose.y).into(), heading)
}

impl Consumer for Drive<'_> {
    fn sensors(&mut self, ids: &[Arc<str>]) -> Result<()> {
        self.ids = ids.to_vec();
        Ok(())
    }

    fn record(&mut self, _row: &Row, pose: Pose) -> Result<()> {
        // A long table repeats the pose with every sensor.
        if self.last.is_none_or(|last| (last.x, last.y) != (pose.x, pose.y)) {
            self.path.push(Some(Point2::new(pose.x, pose.y)));
        }
        self.last = Some(pose);
        Ok(())
    }

    fn reading(&mut self, _row: &Row, reading: &Reading<f64>, _summary: &mut Summary) -> Result<()> {
        let cone = Cone::of(reading);
        if let Some(cone) = cone {
            self.cones.push(cone);
        }
        if let Some(id) = self.ids.get(usize::from(reading.sensor)).map(Arc::clone) {
            self.show(reading, &id, cone);
            if !self.partners.is_empty() && self.partners.contains(&(reading.t, id)) {
                self.crossing.extend(cone);
            }
        }
        Ok(())
    }

    fn clock_reset(&mut self, _summary: &mut Summary) -> Result<()> {
        self.path.push(None);
        self.last = None;
        Ok(())
    }
}

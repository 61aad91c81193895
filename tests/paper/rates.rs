//! The local map by travel: the same drive at any rate and speed (Sec. IV-D, length of sonar history).

use atm::core::Vector2;

use super::{
    drive::{Drive, Fused},
    page,
    spread::{number, quantile},
};

/// The paper's pace, in inches a second and hertz.
const PACE: (&str, &str) = ("5in/s", "1Hz");
/// Others at which a robot covers no more than that from one reading to the next.
const DENSE: [(&str, &str); 5] =
    [("5in/s", "5Hz"), ("0.1m/s", "20Hz"), ("0.3m/s", "20Hz"), ("0.3m/s", "50Hz"), ("1m/s", "200Hz")];
/// And more.
const SPARSE: [(&str, &str); 3] = [("1m/s", "5Hz"), ("0.3m/s", "1Hz"), ("1m/s", "1Hz")];
/// How much less may be resolved than at the paper's pace, and how much larger the errors may be.
const SLACK: f64 = 1.25;

/// What the echoes of a drive come to.
struct Outcome {
    /// Share of resolved echoes.
    resolved: f64,
    /// Errors of those along their arcs, in inches.
    errors: [f64; 2],
}

impl Outcome {
    fn of(drive: &Drive, fused: &Fused) -> Self {
        let crossed = fused.crossed();
        let errors = drive.azimuth_errors(&crossed);
        Self {
            resolved: crossed.len() as f64 / fused.echoes.len().max(1) as f64,
            errors: [quantile(&errors, 0.5), quantile(&errors, 0.9)],
        }
    }

    fn cells(&self) -> [String; 2] {
        let errors = if self.resolved > 0.0 {
            format!("{} / {}", number(self.errors[0]), number(self.errors[1]))
        } else {
            "–".to_owned()
        };
        [format!("{:.1} %", 100.0 * self.resolved), errors]
    }
}

fn drive(world: &str, (speed, rate): (&str, &str)) -> Drive {
    Drive::new(world, &[("speed", speed), ("rate", rate)], "", 1)
}

#[test]
fn same_drive_at_any_rate_gives_the_same_picture() {
    let mut rows = Vec::new();
    for world in ["doorway", "room", "tee"] {
        let mut paper: Option<Outcome> = None;
        for pace in [&[PACE][..], &DENSE, &SPARSE].concat() {
            let drive = drive(world, pace);
            let (by_travel, by_count) =
                (Outcome::of(&drive, &drive.fuse_by_travel()), Outcome::of(&drive, &drive.fuse()));
            let name = vec![world.to_owned(), pace.1.to_owned(), pace.0.to_owned()];
            rows.push([name, by_travel.cells().to_vec(), by_count.cells().to_vec()].concat());
            let Some(paper) = &paper else {
                // At the paper's pace both rules are nearly the same.
                assert!(by_travel.resolved >= by_count.resolved, "{world}");
                paper = Some(by_travel);
                continue;
            };
            if SPARSE.contains(&pace) {
                continue;
            }
            assert!(by_travel.resolved >= paper.resolved / SLACK, "{world} {pace:?}: {}", by_travel.resolved);
            for (error, least) in by_travel.errors.iter().zip(&paper.errors) {
                assert!(*error <= least * SLACK, "{world} {pace:?}: {error} in, {least} in at the paper's pace");
            }
        }
    }
    let header =
        ["world", "rate", "speed", "resolved, by travel", "50 / 90 %, in", "resolved, last ten", "50 / 90 %, in "];
    page::shows("rates", &header, &rows);
}

/// A robot that stands for a while, its poses trembling by a millimetre, loses nothing of what it has seen on the way.
#[test]
fn standing_still_changes_nothing_of_the_rest() {
    let moving = drive("room", ("0.3m/s", "20Hz"));
    let mut standing = drive("room", ("0.3m/s", "20Hz"));
    let middle = moving.readings.len() / 2 / 16 * 16;
    let pause = 600;
    let (before, after) = moving.readings.split_at(middle);
    let step = before[16].t - before[0].t;
    standing.readings = before.to_vec();
    for round in 1..=pause {
        for reading in &before[middle - 16..] {
            let tremble = Vector2::new(f64::from(round % 3 - 1), f64::from(round % 2)) * 0.001;
            let mut again = *reading;
            again.t += i64::from(round) * step;
            again.pose.translation.vector += tremble;
            again.robot += tremble;
            standing.readings.push(again);
        }
    }
    standing.readings.extend(after.iter().map(|reading| {
        let mut later = *reading;
        later.t += i64::from(pause) * step;
        later
    }));
    let (moved, stood) = (moving.fuse_by_travel(), standing.fuse_by_travel());
    let resolved = |fused: &Fused| fused.crossed().len();
    let in_pause = |t: i64| t >= before[middle - 1].t && t <= before[middle - 1].t + i64::from(pause) * step;
    let on_the_way =
        stood.crossed().iter().filter(|echo| echo.key.as_ref().is_some_and(|key| !in_pause(key.0))).count();
    let share = on_the_way as f64 / resolved(&moved) as f64;
    assert!((0.97..=1.03).contains(&share), "{share} of what is resolved without the pause");
    assert!(stood.echoes.len() > moved.echoes.len() + 800, "every reading still gets its echo");
}

/// Driving the same way backwards resolves as much.
#[test]
fn driving_backwards_gives_the_same_picture() {
    let forwards = drive("doorway", ("0.3m/s", "20Hz"));
    let mut backwards = drive("doorway", ("0.3m/s", "20Hz"));
    let end = forwards.readings.last().map_or(0, |last| last.t);
    backwards.readings.reverse();
    for reading in &mut backwards.readings {
        reading.t = end - reading.t;
    }
    let share = |drive: &Drive| Outcome::of(drive, &drive.fuse_by_travel()).resolved;
    let (there, back) = (share(&forwards), share(&backwards));
    assert!((back / there).max(there / back) <= 1.1, "{there} there, {back} back");
}

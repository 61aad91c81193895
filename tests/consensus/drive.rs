//! Simulated drives with the truth of every echo, and what disturbs them beyond what the simulator does.

use atm::{
    core::{Beam, Isometry2, Limits, Point2, RangeResolution, Reading, Vector2},
    rig::Rig,
    track::Pose,
};
use atm_lab::{
    simulate::{Effects, Simulation},
    truth::Cause,
    world::World,
};
use rand_chacha::{
    ChaCha8Rng,
    rand_core::{Rng, SeedableRng},
};

pub const INCH: f64 = 0.0254;
/// Full beam of the Nomad's sensors.
pub const BEAM: f64 = std::f64::consts::PI / 8.0;
/// From where on the Nomad reports nothing.
const MAX_RANGE: f64 = 255.0 * INCH;

/// A world, and what of it a seed chooses.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    pub name: &'static str,
    world: &'static str,
    set: fn(&mut Draw) -> Vec<(&'static str, String)>,
}

/// The drives of all tables: geometry is drawn anew for each seed, and every second one weaves where the world lets it.
pub const CASES: [Case; 9] = [
    Case { name: "rough wall", world: "rough-wall", set: |draw| vec![draw.distance(), draw.path()] },
    Case { name: "specular wall", world: "specular-wall", set: |draw| vec![draw.distance(), draw.path()] },
    Case { name: "diffuse wall", world: "diffuse-wall", set: |draw| vec![draw.distance(), draw.path()] },
    Case { name: "doorway, 70 in", world: "doorway", set: |draw| vec![("distance", "70in".into()), draw.length()] },
    Case { name: "doorway, 100 in", world: "doorway", set: |draw| vec![("distance", "100in".into()), draw.length()] },
    Case {
        name: "corners",
        world: "corners",
        set: |draw| {
            let (width, depth) = (draw.inches(50.0, 80.0), draw.inches(25.0, 55.0));
            vec![draw.distance(), draw.path(), ("width", width), ("depth", depth)]
        },
    },
    Case { name: "room", world: "room", set: |_| Vec::new() },
    Case {
        name: "pole, 40-80 in",
        world: "pole",
        set: |draw| vec![("distance", draw.inches(40.0, 80.0)), draw.length(), draw.path()],
    },
    Case { name: "pole, 100 in", world: "pole", set: |draw| vec![draw.length()] },
];

/// What a seed chooses.
pub struct Draw {
    random: ChaCha8Rng,
    seed: u64,
}

impl Draw {
    /// Uniform in [low, high).
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64)
    }

    fn inches(&mut self, low: f64, high: f64) -> String {
        format!("{}in", self.uniform(low, high))
    }

    fn distance(&mut self) -> (&'static str, String) {
        ("distance", self.inches(55.0, 85.0))
    }

    /// Moves what stands in the middle of the path against where the robot fires.
    fn length(&mut self) -> (&'static str, String) {
        ("length", self.inches(240.0, 245.0))
    }

    fn path(&mut self) -> (&'static str, String) {
        ("path", if self.seed.is_multiple_of(2) { "straight" } else { "weaving" }.into())
    }
}

/// What disturbs the readings.
#[derive(Debug, Clone, Copy, Default)]
pub struct Disturbance {
    /// Share of echoes that come late, by 6 to 65 in, as over a detour.
    pub multipath: f64,
    /// Share of readings that are anything from 8 to 244 in.
    pub crosstalk: f64,
    /// Of the simulator.
    pub effects: Effects,
}

/// Where an echo came from.
#[derive(Debug, Clone, Copy)]
pub struct TrueEcho {
    /// From the boresight, in radians.
    pub azimuth: f64,
    /// From the sensor, in metres.
    pub range: f64,
}

/// A reading with what is known of it.
#[derive(Debug, Clone, Copy)]
pub struct Heard {
    pub reading: Reading<f64>,
    /// `None` where it is no echo, and where nothing stands there.
    pub truth: Option<TrueEcho>,
}

/// One drive of a Nomad 200.
pub struct Drive {
    pub world: World,
    pub heard: Vec<Heard>,
}

impl Drive {
    pub fn new(case: &Case, seed: u64, disturbance: &Disturbance) -> Self {
        let mut draw = Draw { random: ChaCha8Rng::seed_from_u64(seed), seed };
        let set: Vec<(String, String)> =
            (case.set)(&mut draw).into_iter().map(|(key, value)| (key.to_owned(), value)).collect();
        let world = World::load(case.world, &set).expect("a built-in world");
        let rig = Rig::builtin("nomad200").expect("a built-in rig");
        let simulation = Simulation::new(world.clone(), rig.clone(), BEAM, disturbance.effects, seed);
        let mut heard = Vec::new();
        for sweep in simulation.sweeps() {
            let sweep = sweep.expect("a path through free space");
            for (&(sensor, range), truth) in sweep.readings.iter().zip(&sweep.truth) {
                let mount = rig.sensors().get(usize::from(sensor)).expect("a sensor of the rig").mount();
                let stood = Point2::from((isometry(sweep.true_pose) * mount).translation.vector);
                let truth = truth.as_ref().filter(|truth| !matches!(truth.cause, Cause::Multipath | Cause::Crosstalk));
                let truth =
                    truth.map(|truth| TrueEcho { azimuth: truth.azimuth, range: (truth.position - stood).norm() });
                let (range, truth) = disturb(range, truth, disturbance, &mut draw);
                heard.push(Heard { reading: reading(sweep.t, sensor, range, isometry(sweep.pose) * mount), truth });
            }
        }
        Self { world, heard }
    }
}

fn isometry(pose: Pose) -> Isometry2<f64> {
    Isometry2::new(Vector2::new(pose.x, pose.y), pose.yaw)
}

fn disturb(range: f64, truth: Option<TrueEcho>, disturbance: &Disturbance, draw: &mut Draw) -> (f64, Option<TrueEcho>) {
    let whole = |range: f64| (range / INCH).round() * INCH;
    let (detour, other, how_far) = (draw.uniform(0.0, 1.0), draw.uniform(0.0, 1.0), draw.uniform(0.0, 1.0));
    if other < disturbance.crosstalk {
        return (whole(0.2 + 6.0 * how_far), None);
    }
    if range.is_finite() && detour < disturbance.multipath {
        return (whole(range + 0.15 + 1.5 * how_far), None);
    }
    (range, truth)
}

fn reading(t: i64, sensor: u16, range: f64, pose: Isometry2<f64>) -> Reading<f64> {
    Reading {
        t,
        sensor,
        range: Limits::new(6.0 * INCH, MAX_RANGE - 1e-9).expect("limits").classify(range),
        pose,
        robot: Point2::from(pose.translation.vector),
        beam: Beam::new(BEAM).expect("a beam"),
        range_resolution: RangeResolution::new(INCH).expect("a step"),
    }
}

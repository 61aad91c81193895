//! Drives through a world, and what every method made of them.

use std::{collections::BTreeSet, error::Error};

use atm::{intake::Defaults, log::View, pipeline::History, rig::Rig};
use atm_lab::{
    compare::{Assessment, Name, Options, Outcome, against_world, run, simulated},
    eval::Judge,
    simulate::{Effects, Simulation},
    world::World,
};

use crate::curve::{self, Curve};

/// Two methods that leave the hard readings out, and two that answer them all, to be compared on what the first two both answer.
pub const SHARED: [Name; 4] = [Name::AtmMedianSingle, Name::Tbf, Name::Atm, Name::Centerline];

/// How many readings two methods both answer, and the median azimuth error of each of [`SHARED`] on them, in metres.
type OnTheSame = (f64, [Option<f64>; 4]);

/// All drives through one world.
pub struct Driven {
    pub world: &'static str,
    /// One a seed.
    pub drives: Vec<Drive>,
}

/// One drive.
pub struct Drive {
    /// In the order of [`Name::ALL`].
    methods: Vec<Assessment>,
    /// The first two of [`SHARED`] answer these.
    pub shared: OnTheSame,
    /// Of each method.
    pub curve: Vec<Curve>,
}

impl Driven {
    /// The drives of seeds 1 to `seeds` along the world's own path.
    pub fn through(
        world: &'static str,
        parameters: &[(String, String)],
        effects: Effects,
        seeds: u64,
    ) -> Result<Self, Box<dyn Error>> {
        let loaded = World::load(world, parameters)?;
        let drives = (1..=seeds).map(|seed| Drive::of(&loaded, effects, seed)).collect::<Result<_, _>>()?;
        Ok(Self { world, drives })
    }

    /// The median over the drives of a number of one method.
    pub fn median(&self, method: Name, number: impl Fn(&Assessment) -> Option<f64>) -> Option<f64> {
        median(self.drives.iter().map(|drive| number(drive.assessment(method)?)))
    }
}

impl Drive {
    fn of(world: &World, effects: Effects, seed: u64) -> Result<Self, Box<dyn Error>> {
        let rig = Rig::builtin("nomad200").ok_or("no such rig")?;
        let simulation = Simulation::new(world.clone(), rig, Defaults::FIELD_OF_VIEW, effects, seed);
        let (recording, truth) = simulated(&simulation)?;
        let said: Vec<_> =
            Name::ALL.iter().map(|name| run(*name, &recording, &as_in_the_paper())).collect::<Result<_, _>>()?;
        let views: Vec<View> = recording.views().iter().copied().collect();
        let judge = Judge::new(world, Some(&truth), &views);
        let methods = against_world(&said, &judge, world, recording.readings(), recording.ids())?;
        let curve = said.iter().map(|one| curve::of(one, &judge)).collect();
        Ok(Self { methods, shared: shared(&said, &judge), curve })
    }

    fn assessment(&self, method: Name) -> Option<&Assessment> {
        self.methods.get(Name::ALL.iter().position(|name| *name == method)?)
    }
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

/// The median of what there is.
pub fn median(values: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let mut values: Vec<f64> = values.flatten().collect();
    values.sort_by(f64::total_cmp);
    let middle = |index: usize| values.get(index).copied();
    let half = values.len() / 2;
    if values.len() % 2 == 1 { middle(half) } else { Some((middle(half.checked_sub(1)?)? + middle(half)?) / 2.0) }
}

/// The last ten readings of every sensor, as the page says.
fn as_in_the_paper() -> Options {
    Options { history: History::PAPER, ..Options::default() }
}

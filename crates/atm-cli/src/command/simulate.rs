//! `atm simulate`: a world in, the log of a drive through it out.

use std::sync::Arc;

use atm::{
    error::{Error, Result},
    log::{
        format::Format as Found,
        mcap::write::RecordingWriter,
        output::{Output, overwrites, same_file},
        writer::{CsvLog, LogWriter},
    },
    rig::Rig,
};
use atm_lab::{
    simulate::{Simulation, Sweep},
    truth::TruthWriter,
    world::World,
};

use crate::{Failure, Outcome, args::Simulate, command};

/// When a drive in a recording begins, in nanoseconds: ROS takes a stamp of 0 for none.
const RECORDING_START: i64 = 1_000_000_000;

/// Runs the command.
pub fn run(args: &Simulate) -> Result<Outcome, Failure> {
    check_outputs(args)?;
    let rig = Rig::load(&args.rig)?;
    let world = World::load(&args.world, &args.parameters()).map_err(|error| refused(args, error))?;
    let simulation = Simulation::new(world, rig, args.fov.field_of_view(), args.noise, args.seed);
    let mut files = Files::create(args, simulation.rig())?;
    let partials = files.partials.clone();
    let driven = simulation.sweeps().try_for_each(|sweep| files.write(simulation.rig(), &sweep?));
    driven.and_then(|()| files.commit()).map_err(|error| command::unfinished(error, "driven", &partials))?;
    Ok(Outcome::Done)
}

/// A wrong parameter is a wrong argument where the world is built in.
fn refused(args: &Simulate, error: Error) -> Failure {
    match Failure::from(error) {
        Failure::Failed(message) if World::BUILTIN.contains(&&*args.world) => Failure::Usage(message),
        failure => failure,
    }
}

/// Refuses outputs that can't be written, or that would destroy an input or one another.
fn check_outputs(args: &Simulate) -> Result<(), Failure> {
    let usage = |message: String| Err(Failure::Usage(message));
    for output in [Some(&args.output), args.truth.as_ref()].into_iter().flatten() {
        if let Some(input) = [&args.world, &args.rig].into_iter().find(|input| overwrites(output, input)) {
            return usage(format!("{output}: writing it would overwrite the input {input}"));
        }
    }
    match &args.truth {
        Some(truth) if *truth == args.output || same_file(truth, &args.output) => {
            usage(format!("{truth} is named for two outputs"))
        }
        _ => Ok(()),
    }
}

/// The files that are written.
struct Files {
    log: Box<dyn LogWriter<Output>>,
    truth: Option<(TruthWriter<Output>, Arc<str>)>,
    /// Time of the first sweep, in nanoseconds.
    start: i64,
    /// Those that hold what was written until [`Files::commit`].
    partials: Vec<String>,
}

impl Files {
    fn create(args: &Simulate, rig: &Rig) -> Result<Self> {
        let mut partials = Vec::new();
        let mut create = |path: &str| {
            let output = Output::create(path)?;
            partials.extend(output.partial_path().map(|path| path.display().to_string()));
            let name = Arc::clone(output.name());
            Ok::<_, Error>((output, name))
        };
        let (output, name) = create(&args.output)?;
        let format = args.to.map_or(Found::of_name(&args.output), Found::from);
        let start = if format == Found::Mcap { RECORDING_START } else { 0 };
        let log: Box<dyn LogWriter<Output>> = match format {
            Found::Mcap => Box::new(RecordingWriter::create(output, name, rig, start)?),
            _ => Box::new(CsvLog::create(output, name, rig)?),
        };
        let truth = match &args.truth {
            Some(path) => {
                let (output, name) = create(path)?;
                let table = TruthWriter::new(output).map_err(|source| Error::Io { file: Arc::clone(&name), source })?;
                Some((table, name))
            }
            None => None,
        };
        Ok(Self { log, truth, start, partials })
    }

    fn write(&mut self, rig: &Rig, sweep: &Sweep) -> Result<()> {
        let t = sweep.t + self.start;
        self.log.sweep(t, sweep.pose, &sweep.readings)?;
        let Some((table, name)) = &mut self.truth else { return Ok(()) };
        for ((index, _), truth) in sweep.readings.iter().zip(&sweep.truth) {
            if let (Some(point), Some(id)) = (truth, rig.ids().get(usize::from(*index))) {
                let written = table.write(t, id, point);
                written.map_err(|source| Error::Io { file: Arc::clone(name), source })?;
            }
        }
        Ok(())
    }

    /// Puts the files under their names.
    fn commit(self) -> Result<()> {
        let log = self.log.finish()?;
        if let Some((truth, _)) = self.truth {
            truth.into_inner().commit()?;
        }
        log.commit()
    }
}

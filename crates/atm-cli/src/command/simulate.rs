//! `atm simulate`: a world in, the log of a drive through it out.

use std::sync::Arc;

use atm::{
    error::{Error, Result},
    log::{
        output::{Output, overwrites, same_file},
        truth::TruthWriter,
        writer::{CsvLog, LogWriter},
    },
    rig::Rig,
    simulate::{Simulation, Sweep},
    world::World,
};

use crate::{
    Failure, Outcome,
    args::{Format, Simulate},
};

/// Runs the command.
pub fn run(args: &Simulate) -> Result<Outcome, Failure> {
    check_outputs(args)?;
    let rig = Rig::load(&args.rig)?;
    let world = World::load(&args.world, &args.parameters()).map_err(|error| refused(args, error))?;
    let simulation = Simulation::new(world, rig, args.fov.field_of_view(), args.noise, args.seed);
    let mut tables = Tables::create(args, simulation.rig())?;
    let partials = tables.partials();
    let driven = simulation.sweeps().try_for_each(|sweep| tables.write(simulation.rig(), &sweep?));
    driven.and_then(|()| tables.commit()).map_err(|error| unfinished(error, &partials))?;
    Ok(Outcome::Done)
}

/// What is said of a drive that did not end well: why, and where what it had written is.
fn unfinished(error: Error, partials: &[String]) -> Failure {
    match Failure::from(error) {
        Failure::Failed(message) if !partials.is_empty() => {
            Failure::Failed(format!("{message}\natm: what was driven until then is in {}", partials.join(" and ")))
        }
        failure => failure,
    }
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
    let to_mcap = args.output.to_ascii_lowercase().ends_with(".mcap") && args.to.is_none();
    if to_mcap || args.to == Some(Format::Mcap) {
        return usage(format!("{}: MCAP is not supported yet; atm reads and writes text tables (CSV)", args.output));
    }
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

/// The tables that are written.
struct Tables {
    log: CsvLog<Output>,
    truth: Option<(TruthWriter<Output>, Arc<str>)>,
}

impl Tables {
    fn create(args: &Simulate, rig: &Rig) -> Result<Self> {
        let output = Output::create(&args.output)?;
        let name = Arc::clone(output.name());
        let log = CsvLog::new(output, rig).map_err(|source| Error::Io { file: name, source })?;
        let truth = match &args.truth {
            Some(path) => {
                let output = Output::create(path)?;
                let name = Arc::clone(output.name());
                let failed = |source| Error::Io { file: Arc::clone(&name), source };
                Some((TruthWriter::new(output).map_err(failed)?, name))
            }
            None => None,
        };
        Ok(Self { log, truth })
    }

    fn write(&mut self, rig: &Rig, sweep: &Sweep) -> Result<()> {
        let written = self.log.sweep(sweep.t, sweep.pose, &sweep.readings);
        written.map_err(|error| self.log.get_ref().error(error))?;
        let Some((table, name)) = &mut self.truth else { return Ok(()) };
        for ((index, _), truth) in sweep.readings.iter().zip(&sweep.truth) {
            if let (Some(point), Some(id)) = (truth, rig.ids().get(usize::from(*index))) {
                let written = table.write(sweep.t, id, point);
                written.map_err(|source| Error::Io { file: Arc::clone(name), source })?;
            }
        }
        Ok(())
    }

    /// The files that hold what was written until [`Tables::commit`].
    fn partials(&self) -> Vec<String> {
        let truth = self.truth.as_ref().map(|(table, _)| table.get_ref());
        let outputs = std::iter::once(self.log.get_ref()).chain(truth);
        outputs.filter_map(Output::partial_path).map(|path| path.display().to_string()).collect()
    }

    /// Puts the files under their names.
    fn commit(mut self) -> Result<()> {
        let finished = self.log.finish();
        finished.map_err(|error| self.log.get_ref().error(error))?;
        if let Some((truth, _)) = self.truth {
            truth.into_inner().commit()?;
        }
        self.log.into_inner().commit()
    }
}

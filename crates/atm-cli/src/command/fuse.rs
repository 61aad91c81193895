//! `atm fuse`: a log in, echoes out.

use std::{io::Write, sync::Arc};

use atm::{
    core::{ArcCrossing, Echo, Kind, MinAngle, TransversalMedian},
    error::{Error, Result},
    log::{
        csv::{CsvReadings, PoseUse},
        echoes::TableWriter,
        output::{Output, overwrites, same_file},
    },
    pipeline::{self, Defaults, EchoSink, Emit, SensorModel, Settings},
    rig::Rig,
    summary::Summary,
};

use crate::{
    Failure, Outcome,
    args::{self, Format, Fuse},
    command, is_reader_gone, report,
};

/// Share of echoes of kind `near` above which a guessed range resolution deserves a word.
const MANY_NEAR: f64 = 0.2;

/// Runs the command.
pub fn run(args: &Fuse) -> Result<Outcome, Failure> {
    check_outputs(args)?;
    // The log first: whether a rig is needed depends on what it is.
    let input = command::open(&args.input, args.from)?;
    let rig = command::rig(&args.log)?.ok_or_else(no_rig)?;
    let length = input.length;
    let defaults = Defaults { field_of_view: Some(args.log.fov), range_resolution: args.range_resolution };
    let sensors = defaults.complete(&rig)?;
    let settings = settings(args, &sensors)?;
    let poses = command::pose_use(&args.log, PoseUse::Needed);
    let format = command::table_format(Some(&rig));
    let mut source = CsvReadings::new(input, &format, poses, command::empty_cell(&args.log), Arc::clone(&rig))?;
    let mut track = command::track(&args.log, Some(&rig))?.map(|(track, _)| track);
    let mut tables = Tables::create(args, &rig)?;
    let counts = args.summary.as_deref().map(Output::create).transpose()?;

    let bar = report::progress(length, args.quiet);
    let mut progress = |bytes| bar.set_position(bytes);
    let (summary, result) =
        pipeline::fuse(&mut source, track.as_mut(), &sensors, &settings, &mut tables, &mut progress);
    bar.finish_and_clear();

    if !matches!(&result, Err(error) if is_reader_gone(error)) {
        tell(args, &rig, &defaults, &summary);
    }
    let partials = tables.partials();
    let result = result.and_then(|()| tables.commit());
    // Whatever came of the run: what was counted is true.
    let counted = counts.map_or(Ok(()), |output| write_counts(output, &summary));
    result.map_err(|error| unfinished(error, &partials))?;
    counted?;
    Ok(if summary.is_clean() { Outcome::Done } else { Outcome::Partly })
}

fn no_rig() -> Failure {
    Failure::Usage(format!(
        "a table does not say which sensors made it: name the rig with --rig, a built-in one ({}) or a TOML file",
        Rig::BUILTIN.join(", ")
    ))
}

/// Refuses outputs that can't be written, or that would destroy an input or one another.
fn check_outputs(args: &Fuse) -> Result<(), Failure> {
    let usage = |message: String| Err(Failure::Usage(message));
    let to_mcap = args.output.to_ascii_lowercase().ends_with(".mcap") && args.to.is_none();
    if to_mcap || args.to == Some(Format::Mcap) {
        return usage(format!("{}: MCAP is not supported yet; atm reads and writes text tables (CSV)", args.output));
    }
    let outputs: Vec<&str> = [Some(&args.output), args.crossings.as_ref(), args.summary.as_ref()]
        .into_iter()
        .flatten()
        .map(String::as_str)
        .collect();
    let inputs = [Some(&args.input), args.log.poses.as_ref(), args.log.rig.as_ref()];
    for (index, output) in outputs.iter().enumerate() {
        if let Some(input) = inputs.into_iter().flatten().find(|input| overwrites(output, input)) {
            return usage(format!("{output}: writing it would overwrite the input {input}"));
        }
        if outputs.iter().take(index).any(|other| other == output || same_file(other, output)) {
            return usage(format!("{output} is named for two outputs"));
        }
    }
    if args.log.poses.as_deref() == Some("-") && args.input == "-" {
        return usage("standard input can't be both the log and the poses".into());
    }
    Ok(())
}

fn settings(args: &Fuse, sensors: &[SensorModel]) -> Result<Settings, Failure> {
    let usage = |error: atm::core::DomainError| Failure::Usage(error.to_string());
    let min_angle = match (args.min_angle, args.improvement, args.at) {
        (Some(angle), ..) => angle,
        (None, Some(improvement), Some(distance)) => {
            pipeline::min_angle_for(improvement, distance, sensors).map_err(usage)?
        }
        _ => MinAngle::PAPER,
    };
    Ok(Settings {
        emit: match args.emit {
            args::Emit::Settled => Emit::Settled,
            args::Emit::Latest => Emit::Latest,
        },
        history: args.history,
        bounds: args.bounds().map_err(usage)?,
        estimator: TransversalMedian { min_angle, on_none: args.on_none.into(), on_two: args.on_two.into() },
        strict: args.strict,
    })
}

/// Says what was counted, and what deserves a word.
fn tell(args: &Fuse, rig: &Rig, defaults: &Defaults, summary: &Summary) {
    if !args.quiet {
        report::say(format_args!("{}", report::counts(summary)));
    }
    if let Some(unusable) = report::unusable(&summary.dropped) {
        report::say(format_args!("{unusable}"));
    }
    let (near, total) = (summary.echoes.get(Kind::Near), summary.echoes.total());
    if defaults.guesses_resolution(rig) && near as f64 > MANY_NEAR * total as f64 {
        report::say(format_args!(
            "warning: {near} of {total} echoes are near; a range resolution of 1in was assumed, say --range-resolution if \
             the ranges are finer"
        ));
    }
}

/// What is said of a run that did not end well: why, and where what it had written is.
fn unfinished(error: Error, partials: &[String]) -> Failure {
    match Failure::from(error) {
        Failure::Failed(message) if !partials.is_empty() => {
            Failure::Failed(format!("{message}\natm: what was fused until then is in {}", partials.join(" and ")))
        }
        failure => failure,
    }
}

fn write_counts(mut output: Output, summary: &Summary) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(summary).map_err(|error| Failure::Failed(error.to_string()))?;
    writeln!(output, "{text}").map_err(|error| output.error(error))?;
    Ok(output.commit()?)
}

/// The tables that are written.
struct Tables {
    echoes: TableWriter<Output>,
    crossings: Option<TableWriter<Output>>,
    /// Kinds to write; all where it is empty.
    keep: Vec<Kind>,
}

impl Tables {
    fn create(args: &Fuse, rig: &Rig) -> Result<Self> {
        let ids = || rig.sensors().iter().map(|sensor| sensor.id());
        let named = |file: &Arc<str>| {
            let file = Arc::clone(file);
            move |source| Error::Io { file, source }
        };
        let output = Output::create(&args.output)?;
        let file = Arc::clone(output.name());
        let echoes = TableWriter::echoes(output, ids()).map_err(named(&file))?;
        let output = args.crossings.as_deref().map(Output::create).transpose()?;
        let crossings = output.map(|output| {
            let file = Arc::clone(output.name());
            TableWriter::crossings(output, ids()).map_err(named(&file))
        });
        let crossings = crossings.transpose()?;
        Ok(Self { echoes, crossings, keep: args.keep.clone() })
    }

    /// The files that hold what was written until [`Tables::commit`].
    fn partials(&self) -> Vec<String> {
        let outputs = std::iter::once(&self.echoes).chain(&self.crossings).map(TableWriter::get_ref);
        outputs.filter_map(Output::partial_path).map(|path| path.display().to_string()).collect()
    }

    /// Puts the files under their names.
    fn commit(self) -> Result<()> {
        if let Some(crossings) = self.crossings {
            crossings.into_inner().commit()?;
        }
        self.echoes.into_inner().commit()
    }
}

/// Names the table's file in what the system says of it.
fn name<T>(table: &TableWriter<Output>, result: std::io::Result<T>) -> Result<T> {
    result.map_err(|error| table.get_ref().error(error))
}

impl EchoSink for Tables {
    fn echo(&mut self, echo: &Echo<f64>) -> Result<bool> {
        if !self.keep.is_empty() && !self.keep.contains(&echo.kind) {
            return Ok(false);
        }
        let written = self.echoes.echo(echo);
        name(&self.echoes, written).map(|()| true)
    }

    fn wants_crossings(&self) -> bool {
        self.crossings.is_some()
    }

    fn crossings(&mut self, crossings: &[ArcCrossing<f64>]) -> Result<()> {
        if let Some(table) = &mut self.crossings {
            for crossing in crossings {
                let written = table.crossing(crossing);
                name(table, written)?;
            }
        }
        Ok(())
    }

    fn flush(&mut self) -> Result<()> {
        let flushed = self.echoes.flush();
        name(&self.echoes, flushed)?;
        if let Some(table) = &mut self.crossings {
            let flushed = table.flush();
            name(table, flushed)?;
        }
        Ok(())
    }
}

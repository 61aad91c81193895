//! One run from a log to files: opening, fusing, writing.

use std::{cell::RefCell, io, sync::Arc};

use atm::{
    core::{ArcCrossing, Echo, Kind},
    error::{Error, Problem, Result},
    log::{
        Input, Next, Row, Source,
        csv::{CsvReadings, EmptyCell, PoseUse},
        echoes::TableWriter,
        format::Format,
        output::{Output, overwrites, same_file},
        poses::PoseLog,
    },
    pipeline::{self, AnyTrack, EchoSink, SensorModel, Settings},
    rig::Rig,
    summary::Summary,
    track::Track,
};
use pyo3::{exceptions::PyValueError, prelude::*};

use crate::{interrupt::Watch, raise};

/// Records between two looks at signals and progress.
const BATCH: u32 = 256;
/// What is said of MCAP until the library can read it.
const NO_MCAP: &str = "MCAP is not supported yet; atm reads and writes text tables (CSV)";

/// Which files a run reads and writes.
pub struct Files {
    pub input: String,
    pub poses: Option<String>,
    pub rig: Option<String>,
    pub output: Option<String>,
    pub crossings: Option<String>,
    pub summary: Option<String>,
}

impl Files {
    /// Refuses outputs that can't be written, or that would destroy an input or one another.
    pub fn check(&self, to: Option<Format>) -> PyResult<()> {
        let refuse = |message: String| Err(PyValueError::new_err(message));
        if let Some(output) = &self.output {
            let named = if output.to_ascii_lowercase().ends_with(".mcap") { Format::Mcap } else { Format::Csv };
            if to.unwrap_or(named) != Format::Csv {
                return refuse(format!("{output}: {NO_MCAP}"));
            }
        }
        let outputs: Vec<&String> = [&self.output, &self.crossings, &self.summary].into_iter().flatten().collect();
        let inputs = [Some(&self.input), self.poses.as_ref(), self.rig.as_ref()];
        for (index, output) in outputs.iter().enumerate() {
            if let Some(input) = inputs.into_iter().flatten().find(|input| overwrites(output, input)) {
                return refuse(format!("{output}: writing it would overwrite the input {input}"));
            }
            if outputs.iter().take(index).any(|other| other == output || same_file(other, output)) {
                return refuse(format!("{output} is named for two outputs"));
            }
        }
        if self.poses.as_deref() == Some("-") && self.input == "-" {
            return refuse("standard input can't be both the log and the poses".into());
        }
        Ok(())
    }
}

/// The tables that are written, where any are.
struct Tables {
    echoes: Option<TableWriter<Output>>,
    crossings: Option<TableWriter<Output>>,
    keep: Option<Vec<Kind>>,
}

impl Tables {
    fn create(files: &Files, rig: &Rig, keep: Option<Vec<Kind>>) -> Result<Self> {
        let ids = || rig.sensors().iter().map(|sensor| sensor.id());
        let create = |path: &Option<String>| path.as_deref().map(Output::create).transpose();
        let named = |file: &Arc<str>| {
            let file = Arc::clone(file);
            move |source| Error::Io { file, source }
        };
        let echoes = create(&files.output)?.map(|output| {
            let file = Arc::clone(output.name());
            TableWriter::echoes(output, ids()).map_err(named(&file))
        });
        let crossings = create(&files.crossings)?.map(|output| {
            let file = Arc::clone(output.name());
            TableWriter::crossings(output, ids()).map_err(named(&file))
        });
        Ok(Self { echoes: echoes.transpose()?, crossings: crossings.transpose()?, keep })
    }

    /// The files that hold what was written until [`Tables::commit`].
    fn partials(&self) -> Vec<String> {
        let outputs = self.echoes.iter().chain(&self.crossings).map(TableWriter::get_ref);
        outputs.filter_map(Output::partial_path).map(|path| path.display().to_string()).collect()
    }

    /// Puts the files under their names.
    fn commit(self) -> Result<()> {
        let mut tables = self.crossings.into_iter().chain(self.echoes);
        tables.try_for_each(|table| table.into_inner().commit())
    }
}

/// Names the table's file in what the system says of it.
fn name<T>(table: &TableWriter<Output>, result: io::Result<T>) -> Result<T> {
    result.map_err(|error| table.get_ref().error(error))
}

impl EchoSink for Tables {
    fn echo(&mut self, echo: &Echo<f64>) -> Result<bool> {
        let Some(table) = &mut self.echoes else { return Ok(false) };
        if self.keep.as_ref().is_some_and(|keep| !keep.contains(&echo.kind)) {
            return Ok(false);
        }
        let written = table.echo(echo);
        name(table, written).map(|()| true)
    }

    fn wants_crossings(&self) -> bool {
        self.crossings.is_some()
    }

    fn crossings(&mut self, crossings: &[ArcCrossing<f64>]) -> Result<()> {
        let Some(table) = &mut self.crossings else { return Ok(()) };
        for crossing in crossings {
            let written = table.crossing(crossing);
            name(table, written)?;
        }
        Ok(())
    }

    fn flush(&mut self) -> Result<()> {
        for table in self.echoes.iter_mut().chain(&mut self.crossings) {
            let flushed = table.flush();
            name(table, flushed)?;
        }
        Ok(())
    }
}

/// A log that looks at signals and tells its progress on the way.
struct Watched<'a> {
    log: CsvReadings<Arc<Rig>>,
    length: Option<u64>,
    progress: Option<&'a Py<PyAny>>,
    watch: &'a RefCell<Watch>,
    unwatched: u32,
}

/// Tells how many bytes were read.
fn tell(py: Python<'_>, progress: Option<&Py<PyAny>>, position: u64, length: Option<u64>) -> PyResult<()> {
    match progress {
        Some(progress) => progress.call1(py, (position, length)).map(|_| ()),
        None => Ok(()),
    }
}

impl Source for Watched<'_> {
    fn next_row(&mut self, row: &mut Row, problems: &mut dyn FnMut(Problem)) -> Result<Next> {
        self.unwatched += 1;
        if self.unwatched >= BATCH {
            self.unwatched = 0;
            let position = self.log.position();
            if self.watch.borrow_mut().is_over(|py| tell(py, self.progress, position, self.length)) {
                return Err(Error::Settings { message: "interrupted".into() });
            }
        }
        self.log.next_row(row, problems)
    }

    fn drained(&self) -> bool {
        self.log.drained()
    }

    fn position(&self) -> u64 {
        self.log.position()
    }

    fn has_poses(&self) -> bool {
        self.log.has_poses()
    }

    fn ids(&self) -> &[Arc<str>] {
        self.log.ids()
    }
}

/// All that a run needs.
pub struct Job {
    pub files: Files,
    pub rig: Arc<Rig>,
    pub sensors: Vec<SensorModel>,
    pub settings: Settings,
    pub max_gap: u64,
    pub empty: Option<EmptyCell>,
    pub keep: Option<Vec<Kind>>,
    pub from: Option<Format>,
    pub progress: Option<Py<PyAny>>,
}

impl Job {
    /// Opens the log, and refuses what can't be read.
    fn open(&self) -> Result<(CsvReadings<Arc<Rig>>, Option<u64>)> {
        let (found, input) = Input::open(&self.files.input)?.sniff()?;
        if self.from.unwrap_or(found) != Format::Csv {
            return Err(Error::Settings { message: format!("{}: {NO_MCAP}", input.name) });
        }
        let length = input.length;
        let poses = if self.files.poses.is_some() { PoseUse::Ignored } else { PoseUse::Needed };
        let format = self.rig.log().map(|formats| formats.readings.clone()).unwrap_or_default();
        Ok((CsvReadings::new(input, &format, poses, self.empty, Arc::clone(&self.rig))?, length))
    }

    /// The second file's poses, where there is one.
    fn track(&self) -> Result<Option<AnyTrack>> {
        let Some(path) = &self.files.poses else { return Ok(None) };
        let format = self.rig.log().map(|formats| &formats.poses);
        Ok(Some(Track::new(Box::new(PoseLog::new(Input::open(path)?, format)?), self.max_gap)))
    }

    /// Runs it, with the interpreter let go.
    pub fn run(&self) -> PyResult<Summary> {
        let raise = |error: Error| raise::library(&error);
        let (log, length) = self.open().map_err(raise)?;
        let mut track = self.track().map_err(raise)?;
        let mut tables = Tables::create(&self.files, &self.rig, self.keep.clone()).map_err(raise)?;
        let counts = self.files.summary.as_deref().map(Output::create).transpose().map_err(raise)?;
        let watch = RefCell::new(Watch::new());
        let mut log = Watched { log, length, progress: self.progress.as_ref(), watch: &watch, unwatched: 0 };
        let (summary, result) =
            pipeline::fuse(&mut log, track.as_mut(), &self.sensors, &self.settings, &mut tables, &mut |_| {});
        let position = log.position();
        watch.into_inner().into_result()?;
        let partials = tables.partials();
        let result = result.and_then(|()| tables.commit());
        // Whatever came of the run: what was counted is true.
        let counted = counts.map_or(Ok(()), |output| write_counts(output, &summary));
        result.map_err(|error| unfinished(error, &partials))?;
        counted.map_err(raise)?;
        Python::attach(|py| tell(py, self.progress.as_ref(), position, length))?;
        Ok(summary)
    }
}

fn write_counts(mut output: Output, summary: &Summary) -> Result<()> {
    use io::Write as _;
    let failed = |error: serde_json::Error| Error::Settings { message: error.to_string() };
    let text = serde_json::to_string_pretty(summary).map_err(failed)?;
    writeln!(output, "{text}").map_err(|error| output.error(error))?;
    output.commit()
}

/// What is said of a run that did not end well: why, and where what it had written is.
fn unfinished(error: Error, partials: &[String]) -> PyErr {
    if partials.is_empty() {
        return raise::library(&error);
    }
    let partly = format!("\nwhat was fused until then is in {}", partials.join(" and "));
    raise::library(&match error {
        Error::Io { file, source } => {
            let source = io::Error::new(source.kind(), format!("{source}{partly}"));
            Error::Io { file, source }
        }
        error => Error::Settings { message: format!("{error}{partly}") },
    })
}

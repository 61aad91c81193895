//! The files that a run writes: tables, recordings, or one of each.

use std::{io, sync::Arc};

use atm_core::{ArcCrossing, Isometry2, Reading};

use super::FuseJob;
use crate::{
    echo::{AnyEcho, AnyEstimator},
    error::{Error, Result},
    log::{
        Row,
        behind::Behind,
        echoes::{Line, TableWriter},
        format::Format,
        mcap::{
            Tap,
            write::{Contents, Frames, Layout, McapSink, Options, Transforms},
        },
        output::Output,
    },
    pipeline::{EchoSink, Emit, Settings},
    track::Pose,
};

/// One output.
enum Written {
    Echoes(Table<AnyEcho>),
    Crossings(Table<ArcCrossing<f64>>),
    Recording(Box<McapSink<Output>>),
}

impl Written {
    fn flush(&mut self) -> Result<()> {
        match self {
            Self::Echoes(table) => table.with(Behind::flush),
            Self::Crossings(table) => table.with(Behind::flush),
            Self::Recording(recording) => recording.flush(),
        }
    }

    /// The file, with all that goes into it; `None` where its writer has ended already.
    fn into_output(self) -> Result<Option<Output>> {
        match self {
            Self::Echoes(table) => table.into_output(),
            Self::Crossings(table) => table.into_output(),
            Self::Recording(recording) => recording.finish().map(Some),
        }
    }

    /// Puts the file under its name.
    fn commit(self) -> Result<()> {
        self.into_output()?.map_or(Ok(()), Output::commit)
    }

    /// Takes a file back; a pipe is ended as usual.
    fn take_back(self) -> Result<()> {
        match self.into_output()? {
            Some(output) if output.partial_path().is_none() => output.commit(),
            Some(output) => output.discard(),
            None => Ok(()),
        }
    }

    /// Leaves nothing behind, in a pipe neither.
    fn discard(self) -> Result<()> {
        self.into_output()?.map_or(Ok(()), Output::discard)
    }
}

/// A table, with the name of its file for what the system says of it.
struct Table<R> {
    name: Arc<str>,
    rows: Behind<R, Output>,
}

impl<R: Line + Send + 'static> Table<R> {
    fn new(name: Arc<str>, table: io::Result<TableWriter<Output>>) -> Result<Self> {
        let table = table.map_err(|source| Error::Io { file: Arc::clone(&name), source })?;
        Ok(Self { name, rows: Behind::new(table)? })
    }

    fn with<T>(&mut self, work: impl FnOnce(&mut Behind<R, Output>) -> io::Result<T>) -> Result<T> {
        work(&mut self.rows).map_err(|source| Error::Io { file: Arc::clone(&self.name), source })
    }

    fn into_output(self) -> Result<Option<Output>> {
        let table = self.rows.into_table().map_err(|source| Error::Io { file: self.name, source })?;
        Ok(table.map(TableWriter::into_inner))
    }
}

/// What the outputs need to know of the log.
pub(super) struct Input<'a> {
    /// The sensors that are known beforehand, and where they sit.
    pub(super) ids: &'a [Arc<str>],
    pub(super) mounts: Vec<Isometry2<f64>>,
    /// Within which time it is put in order, in nanoseconds, where it is a recording.
    pub(super) window: Option<u64>,
}

/// The files, those that were asked for.
pub(super) struct Outputs {
    echoes: Option<Written>,
    crossings: Option<Written>,
    /// Kinds to write, where not all are.
    keep: Option<Vec<&'static str>>,
    partials: Vec<String>,
    mounts: Vec<Isometry2<f64>>,
    /// The log is copied.
    passes: bool,
    /// The log's own frames were taken over.
    adopted: bool,
    /// Nothing goes out before there is a record: of a recording of which nothing can be used no header is left.
    waits: bool,
}

impl Outputs {
    pub(super) fn create(job: &FuseJob, settings: &Settings, input: &Input<'_>) -> Result<Self> {
        let mut partials = Vec::new();
        let mut create = |path: &str, format, contents| {
            let output = Output::create(path)?;
            partials.extend(output.partial_path().map(|path| path.display().to_string()));
            let file = Arc::clone(output.name());
            if format == Format::Mcap {
                let options = Options {
                    kind: job.schema,
                    layout: layout(settings.emit, &output),
                    contents,
                    consensus: settings.estimator.is_consensus(),
                    frames: Frames { mounts: input.mounts.clone(), ..Frames::default() },
                    history: settings.history.most(),
                    pass_window: input.window.filter(|_| job.passes(contents)),
                };
                return Ok(Written::Recording(Box::new(McapSink::new(output, file, options))));
            }
            let ids = input.ids.iter().map(|id| &**id);
            match contents {
                Contents::Everything => {
                    let table = match settings.estimator {
                        AnyEstimator::Median(_) => TableWriter::echoes(output, ids),
                        AnyEstimator::Consensus(_) => TableWriter::consensus(output, ids),
                    };
                    Table::new(file, table).map(Written::Echoes)
                }
                Contents::Crossings => Table::new(file, TableWriter::crossings(output, ids)).map(Written::Crossings),
            }
        };
        let echoes = job.output.as_deref().map(|path| create(path, job.format(), Contents::Everything));
        let echoes = echoes.transpose()?;
        let crossings = job.crossings.as_deref().map(|path| create(path, Format::of_name(path), Contents::Crossings));
        Ok(Self {
            crossings: crossings.transpose()?,
            echoes,
            keep: job.keep.clone(),
            partials,
            mounts: input.mounts.clone(),
            passes: job.passthrough,
            adopted: false,
            waits: input.window.is_some(),
        })
    }

    /// Takes in what the log holds besides, where that is to be copied.
    pub(super) fn tap(&self) -> Option<Box<dyn Tap>> {
        match &self.echoes {
            Some(Written::Recording(recording)) => Some(Box::new(recording.pass_through())),
            _ => None,
        }
    }

    /// What was copied out of order, in words.
    pub(super) fn late(&self) -> Option<String> {
        let late = match &self.echoes {
            Some(Written::Recording(recording)) => recording.late(),
            _ => 0,
        };
        (late > 0).then(|| {
            format!("copied    {late} messages of the log came later than --reorder allows: they stand out of order")
        })
    }

    /// The files that hold what was written until [`Outputs::commit`].
    pub(super) fn partials(&self) -> Vec<String> {
        self.partials.clone()
    }

    /// Whether nothing of a recording was written.
    pub(super) const fn is_blank(&self) -> bool {
        self.waits
    }

    /// Leaves no file: nothing of the log could be used.
    pub(super) fn discard(self) -> Result<()> {
        self.crossings.into_iter().chain(self.echoes).try_for_each(Written::discard)
    }

    /// Puts the files under their names.
    pub(super) fn commit(self) -> Result<()> {
        self.crossings.into_iter().chain(self.echoes).try_for_each(Written::commit)
    }

    /// Leaves no file: nothing of the log could be used. A pipe is ended as usual.
    pub(super) fn take_back(self) -> Result<()> {
        self.crossings.into_iter().chain(self.echoes).try_for_each(Written::take_back)
    }

    /// Takes over what the log calls its frames, and leaves out the transforms that it has itself where it is copied.
    fn adopt(&mut self, log: &crate::log::Frames) {
        let transforms = match (self.passes, log.has_robot, log.has_mounts) {
            (true, true, true) => Transforms::None,
            (true, false, true) => Transforms::Robot,
            // Where the log says only where the robot is, that is said twice, and no frame has two parents.
            _ => Transforms::All,
        };
        let (fixed, robot, mounts) = (log.fixed.to_string(), log.robot.to_string(), self.mounts.clone());
        let frames = Frames { fixed, robot, mounts, transforms };
        for recording in self.recordings() {
            recording.set_frames(frames.clone());
        }
        self.adopted = true;
    }

    fn all(&mut self) -> impl Iterator<Item = &mut Written> {
        self.echoes.iter_mut().chain(&mut self.crossings)
    }

    fn recordings(&mut self) -> impl Iterator<Item = &mut McapSink<Output>> {
        self.all().filter_map(|written| match written {
            Written::Recording(recording) => Some(&mut **recording),
            _ => None,
        })
    }
}

/// A live robot's echoes go down a pipe as they come; a file is read when it is whole.
fn layout(emit: Emit, output: &Output) -> Layout {
    if emit == Emit::Latest && output.partial_path().is_none() { Layout::Immediate } else { Layout::Chunked }
}

impl EchoSink for Outputs {
    fn sensors(&mut self, ids: &[Arc<str>]) -> Result<()> {
        self.all().try_for_each(|written| match written {
            Written::Echoes(table) => table.with(|rows| rows.set_ids(ids)),
            Written::Crossings(table) => table.with(|rows| rows.set_ids(ids)),
            Written::Recording(recording) => recording.sensors(ids),
        })
    }

    fn record(&mut self, row: &Row, pose: Pose) -> Result<()> {
        self.waits = false;
        if let (Some(frames), false) = (&row.frames, self.adopted) {
            self.adopt(frames);
        }
        self.recordings().try_for_each(|recording| recording.record(row, pose))
    }

    fn reading(&mut self, reading: &Reading<f64>) -> Result<()> {
        self.recordings().try_for_each(|recording| recording.reading(reading))
    }

    fn echo(&mut self, echo: &AnyEcho) -> Result<bool> {
        if self.keep.as_ref().is_some_and(|keep| !keep.contains(&echo.kind())) {
            return Ok(false);
        }
        match &mut self.echoes {
            Some(Written::Echoes(table)) => table.with(|rows| rows.push(*echo)).map(|()| true),
            Some(Written::Recording(recording)) => recording.echo(echo),
            _ => Ok(false),
        }
    }

    fn wants_crossings(&self) -> bool {
        self.crossings.is_some() || matches!(self.echoes, Some(Written::Recording(_)))
    }

    fn crossings(&mut self, crossings: &[ArcCrossing<f64>]) -> Result<()> {
        self.recordings().try_for_each(|recording| recording.crossings(crossings))?;
        match &mut self.crossings {
            Some(Written::Crossings(table)) => {
                table.with(|rows| crossings.iter().try_for_each(|crossing| rows.push(*crossing)))
            }
            _ => Ok(()),
        }
    }

    fn flush(&mut self) -> Result<()> {
        if self.waits {
            return Ok(());
        }
        self.all().try_for_each(Written::flush)
    }
}

//! What `atm fuse` writes: tables, recordings, or one of each.

use std::sync::Arc;

use atm::{
    core::{ArcCrossing, Echo, Kind, Reading},
    error::{Error, Result},
    log::{
        Row,
        echoes::TableWriter,
        mcap::write::{Contents, Frames, Layout, McapSink, Options},
        output::Output,
    },
    pipeline::{EchoSink, SensorModel},
    rig::Rig,
    track::Pose,
};

use crate::args::{Emit, Format, Fuse};

/// One output.
enum Written {
    Table(TableWriter<Output>),
    Recording(Box<McapSink<Output>>),
}

impl Written {
    fn flush(&mut self) -> Result<()> {
        match self {
            Self::Table(table) => {
                let flushed = table.flush();
                name(table, flushed)
            }
            Self::Recording(recording) => recording.flush(),
        }
    }

    /// Puts the file under its name.
    fn commit(self) -> Result<()> {
        match self {
            Self::Table(table) => table.into_inner().commit(),
            Self::Recording(recording) => recording.finish()?.commit(),
        }
    }
}

/// Names the table's file in what the system says of it.
fn name<T>(table: &TableWriter<Output>, result: std::io::Result<T>) -> Result<T> {
    result.map_err(|error| table.get_ref().error(error))
}

/// All outputs.
pub(super) struct Outputs {
    echoes: Written,
    crossings: Option<Written>,
    /// Kinds to write; all where it is empty.
    keep: Vec<Kind>,
    partials: Vec<String>,
}

impl Outputs {
    pub(super) fn create(args: &Fuse, rig: &Rig, sensors: &[SensorModel]) -> Result<Self> {
        let ids = || rig.sensors().iter().map(|sensor| sensor.id());
        let options = |contents, output: &Output| Options {
            kind: args.schema.into(),
            layout: layout(args.emit, output),
            contents,
            frames: Frames { mounts: sensors.iter().map(|sensor| sensor.mount).collect(), ..Frames::default() },
            history: args.history,
            ..Options::default()
        };
        let mut partials = Vec::new();
        let mut create = |path: &str, format, contents| {
            let output = Output::create(path)?;
            partials.extend(output.partial_path().map(|path| path.display().to_string()));
            let name = Arc::clone(output.name());
            if is_recording(path, format) {
                let options = options(contents, &output);
                return Ok(Written::Recording(Box::new(McapSink::new(output, name, options))));
            }
            let table = match contents {
                Contents::Everything => TableWriter::echoes(output, ids()),
                Contents::Crossings => TableWriter::crossings(output, ids()),
            };
            table.map(Written::Table).map_err(|source| Error::Io { file: name, source })
        };
        let echoes = create(&args.output, args.to, Contents::Everything)?;
        let crossings = args.crossings.as_deref().map(|path| create(path, None, Contents::Crossings)).transpose()?;
        Ok(Self { echoes, crossings, keep: args.keep.clone(), partials })
    }

    /// The files that hold what was written until [`Outputs::commit`].
    pub(super) fn partials(&self) -> &[String] {
        &self.partials
    }

    /// Puts the files under their names.
    pub(super) fn commit(self) -> Result<()> {
        if let Some(crossings) = self.crossings {
            crossings.commit()?;
        }
        self.echoes.commit()
    }

    fn all(&mut self) -> impl Iterator<Item = &mut Written> {
        std::iter::once(&mut self.echoes).chain(&mut self.crossings)
    }

    fn recordings(&mut self) -> impl Iterator<Item = &mut McapSink<Output>> {
        self.all().filter_map(|written| match written {
            Written::Recording(recording) => Some(&mut **recording),
            Written::Table(_) => None,
        })
    }
}

/// Whether an output is a recording: by the format asked for, else by its name.
fn is_recording(path: &str, format: Option<Format>) -> bool {
    match format {
        Some(format) => format == Format::Mcap,
        None => path.to_ascii_lowercase().ends_with(".mcap"),
    }
}

/// A live robot's echoes go down a pipe as they come; a file is read when it is whole.
fn layout(emit: Emit, output: &Output) -> Layout {
    if emit == Emit::Latest && output.partial_path().is_none() { Layout::Immediate } else { Layout::Chunked }
}

impl EchoSink for Outputs {
    fn sensors(&mut self, ids: &[Arc<str>]) -> Result<()> {
        self.recordings().try_for_each(|recording| recording.sensors(ids))
    }

    fn record(&mut self, row: &Row, pose: Pose) -> Result<()> {
        self.recordings().try_for_each(|recording| recording.record(row, pose))
    }

    fn reading(&mut self, reading: &Reading<f64>) -> Result<()> {
        self.recordings().try_for_each(|recording| recording.reading(reading))
    }

    fn echo(&mut self, echo: &Echo<f64>) -> Result<bool> {
        if !self.keep.is_empty() && !self.keep.contains(&echo.kind) {
            return Ok(false);
        }
        match &mut self.echoes {
            Written::Table(table) => {
                let written = table.echo(echo);
                name(table, written).map(|()| true)
            }
            Written::Recording(recording) => recording.echo(echo),
        }
    }

    fn wants_crossings(&self) -> bool {
        self.crossings.is_some() || matches!(self.echoes, Written::Recording(_))
    }

    fn crossings(&mut self, crossings: &[ArcCrossing<f64>]) -> Result<()> {
        self.recordings().try_for_each(|recording| recording.crossings(crossings))?;
        if let Some(Written::Table(table)) = &mut self.crossings {
            for crossing in crossings {
                let written = table.crossing(crossing);
                name(table, written)?;
            }
        }
        Ok(())
    }

    fn flush(&mut self) -> Result<()> {
        self.all().try_for_each(Written::flush)
    }
}

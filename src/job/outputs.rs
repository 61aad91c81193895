//! The files that a run writes.

use std::{io, sync::Arc};

use atm_core::{ArcCrossing, Echo, Kind};

use super::FuseJob;
use crate::{
    error::{Error, Result},
    log::{echoes::TableWriter, output::Output},
    pipeline::EchoSink,
};

/// The files, those that were asked for.
pub(super) struct Outputs {
    echoes: Option<TableWriter<Output>>,
    crossings: Option<TableWriter<Output>>,
    /// Kinds to write, where not all are.
    keep: Option<Vec<Kind>>,
}

impl Outputs {
    pub(super) fn create(job: &FuseJob, ids: &[Arc<str>]) -> Result<Self> {
        let ids = || ids.iter().map(|id| &**id);
        let create = |path: &Option<String>| path.as_deref().map(Output::create).transpose();
        let named = |file: &Arc<str>| {
            let file = Arc::clone(file);
            move |source| Error::Io { file, source }
        };
        let echoes = create(&job.output)?.map(|output| {
            let file = Arc::clone(output.name());
            TableWriter::echoes(output, ids()).map_err(named(&file))
        });
        let crossings = create(&job.crossings)?.map(|output| {
            let file = Arc::clone(output.name());
            TableWriter::crossings(output, ids()).map_err(named(&file))
        });
        Ok(Self { echoes: echoes.transpose()?, crossings: crossings.transpose()?, keep: job.keep.clone() })
    }

    /// The files that hold what was written until [`Outputs::commit`].
    pub(super) fn partials(&self) -> Vec<String> {
        let outputs = self.echoes.iter().chain(&self.crossings).map(TableWriter::get_ref);
        outputs.filter_map(Output::partial_path).map(|path| path.display().to_string()).collect()
    }

    /// Puts the files under their names.
    pub(super) fn commit(self) -> Result<()> {
        let mut tables = self.crossings.into_iter().chain(self.echoes);
        tables.try_for_each(|table| table.into_inner().commit())
    }
}

/// Names the table's file in what the system says of it.
fn name<T>(table: &TableWriter<Output>, result: io::Result<T>) -> Result<T> {
    result.map_err(|error| table.get_ref().error(error))
}

impl EchoSink for Outputs {
    fn sensors(&mut self, ids: &[Arc<str>]) -> Result<()> {
        for table in self.echoes.iter_mut().chain(&mut self.crossings) {
            table.set_ids(ids.iter().map(|id| &**id));
        }
        Ok(())
    }

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

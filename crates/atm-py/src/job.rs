//! One run from a log to files, as Python sees it: signals, progress, exceptions.

use std::io;

use atm::{
    error::Error,
    job::{Ended, FuseJob},
    pipeline::Settings,
    summary::Summary,
};
use pyo3::prelude::*;

use crate::{fuse::warn, interrupt::Watch, raise};

/// Tells how many bytes were read.
fn tell(py: Python<'_>, progress: Option<&Py<PyAny>>, position: u64, length: Option<u64>) -> PyResult<()> {
    match progress {
        Some(progress) => progress.call1(py, (position, length)).map(|_| ()),
        None => Ok(()),
    }
}

/// Runs it, with the interpreter let go; what deserves a word of how the log was read is warned of.
pub fn run(py: Python<'_>, job: &FuseJob, settings: &Settings, progress: Option<&Py<PyAny>>) -> PyResult<Summary> {
    let (mut watch, mut last) = (Watch::new(), (0, None));
    let ended = py.detach(|| {
        let mut watched = |position, length| {
            last = (position, length);
            !watch.is_over(|py| tell(py, progress, position, length))
        };
        job.run(settings, &mut watched)
    });
    watch.into_result()?;
    let Ended { summary, notes, result, partials, .. } = ended.map_err(|error| raise::library(&error))?;
    result.map_err(|error| unfinished(error, &partials))?;
    tell(py, progress, last.0, last.1)?;
    for note in &notes {
        warn(py, note)?;
    }
    Ok(summary)
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

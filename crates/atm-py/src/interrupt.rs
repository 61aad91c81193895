//! Ctrl-C in a long call.

use std::time::{Duration, Instant};

use pyo3::prelude::*;

/// How long Python's signals may wait.
const PATIENCE: Duration = Duration::from_millis(50);

/// Looks after Python's signals while the interpreter is let go.
pub struct Watch {
    last: Option<Instant>,
    raised: Option<PyErr>,
}

impl Watch {
    /// A watch that begins now, and looks at once when it is first asked.
    pub fn new() -> Self {
        Self { last: None, raised: None }
    }

    /// Whether the call is to end: a signal's handler raised, as does Ctrl-C's, or `also` did, which is asked as often.
    ///
    /// Rarely enough that taking the interpreter back costs nothing.
    pub fn is_over(&mut self, also: impl FnOnce(Python<'_>) -> PyResult<()>) -> bool {
        if self.raised.is_none() && self.last.is_none_or(|last| last.elapsed() >= PATIENCE) {
            self.raised = Python::attach(|py| py.check_signals().and_then(|()| also(py))).err();
            self.last = Some(Instant::now());
        }
        self.raised.is_some()
    }

    /// What was raised.
    pub fn into_result(self) -> PyResult<()> {
        self.raised.map_or(Ok(()), Err)
    }
}

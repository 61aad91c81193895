//! What Python is told when something is wrong: the library's words, as the exception that fits.

use std::{fmt::Display, io};

use atm::error::Error;
use pyo3::{
    exceptions::{
        PyBrokenPipeError, PyFileExistsError, PyFileNotFoundError, PyIsADirectoryError, PyOSError, PyPermissionError,
        PyTypeError, PyValueError,
    },
    prelude::*,
};

/// The library's error: `OSError` (or one of its kinds) where the system refused, else `ValueError`.
pub fn library(error: &Error) -> PyErr {
    let words = error.to_string();
    let Error::Io { source, .. } = error else {
        return PyValueError::new_err(words);
    };
    match source.kind() {
        io::ErrorKind::NotFound => PyFileNotFoundError::new_err(words),
        io::ErrorKind::PermissionDenied => PyPermissionError::new_err(words),
        io::ErrorKind::IsADirectory => PyIsADirectoryError::new_err(words),
        io::ErrorKind::AlreadyExists => PyFileExistsError::new_err(words),
        io::ErrorKind::BrokenPipe => PyBrokenPipeError::new_err(words),
        _ => PyOSError::new_err(words),
    }
}

/// An argument's value is out of its domain.
pub fn value(argument: &str, message: impl Display) -> PyErr {
    PyValueError::new_err(format!("{argument}: {message}"))
}

/// An argument is of the wrong type.
pub fn kind(argument: &str, message: impl Display) -> PyErr {
    PyTypeError::new_err(format!("{argument}: {message}"))
}

/// The item of an argument that can't be used.
#[derive(Debug)]
pub struct Fault {
    /// The argument.
    pub argument: &'static str,
    /// Its item; `None` where the argument is a single value.
    pub index: Option<usize>,
    /// What is wrong with it.
    pub message: String,
}

impl From<Fault> for PyErr {
    fn from(fault: Fault) -> Self {
        let Fault { argument, index, message } = fault;
        match index {
            Some(index) => PyValueError::new_err(format!("{argument}[{index}]: {message}")),
            None => value(argument, message),
        }
    }
}

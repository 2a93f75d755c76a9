//! Errors as Python's exceptions.

use marraztu_io as io;
use pyo3::exceptions::{PyException, PyKeyboardInterrupt, PyMemoryError, PyOSError};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

pyo3::create_exception!(
    marraztu,
    LoadError,
    PyException,
    "A file cannot be loaded.\n\nAttributes: file (str), line (int or None), reason (str)."
);

/// The reason why a call fails.
#[derive(Debug)]
pub(crate) enum Failure {
    /// An argument is invalid.
    Value(String),
    /// A file cannot be loaded.
    Load { file: String, line: Option<usize>, reason: String, text: String },
    /// A file cannot be written.
    Save(String),
    /// There is not enough memory.
    Memory(String),
    /// A signal has ended the work. Its own exception is raised.
    Interrupted,
    /// The process was forked while another thread was drawing.
    Forked,
    /// The library panicked.
    Panic(String),
}

impl Failure {
    /// Makes an error for an invalid argument.
    pub(crate) fn value(reason: impl ToString) -> Self {
        Self::Value(reason.to_string())
    }
}

impl From<io::LoadError> for Failure {
    fn from(error: io::LoadError) -> Self {
        let text = error.to_string();
        match error {
            io::LoadError::File { file, reason } => Self::Load { file, line: None, reason, text },
            io::LoadError::Line { file, line, reason } => {
                Self::Load { file, line: Some(line as usize), reason, text }
            }
            io::LoadError::Cancelled => Self::Value(text),
        }
    }
}

impl From<io::SceneFileError> for Failure {
    fn from(error: io::SceneFileError) -> Self {
        let text = error.to_string();
        match error {
            io::SceneFileError::File { file, reason } => {
                Self::Load { file, line: None, reason, text }
            }
            io::SceneFileError::Line { file, line, reason, .. } => {
                Self::Load { file, line: Some(line), reason, text }
            }
            io::SceneFileError::Model(error) => error.into(),
        }
    }
}

impl From<io::SaveError> for Failure {
    fn from(error: io::SaveError) -> Self {
        Self::Save(error.to_string())
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        match failure {
            Failure::Value(reason) => PyValueError::new_err(reason),
            Failure::Memory(reason) => PyMemoryError::new_err(reason),
            Failure::Save(reason) => PyOSError::new_err(reason),
            Failure::Load { file, line, reason, text } => Python::attach(|py| {
                let error = LoadError::new_err(text);
                let value = error.value(py);
                let set = value
                    .setattr("file", file)
                    .and_then(|()| value.setattr("line", line))
                    .and_then(|()| value.setattr("reason", reason));
                set.err().unwrap_or(error)
            }),
            Failure::Interrupted => PyKeyboardInterrupt::new_err(()),
            Failure::Forked => PyRuntimeError::new_err(
                "this process was forked while another thread was drawing, so it cannot draw; \
                 start processes with the method \"spawn\": \
                 multiprocessing.get_context(\"spawn\")",
            ),
            Failure::Panic(message) => {
                PyRuntimeError::new_err(format!("the renderer has failed: {message}"))
            }
        }
    }
}

//! Why a command could not do its work, and which exit code says so.

use crate::diagnostics::Diagnostic;
use std::any::Any;
use std::fmt;
use std::path::{Path, PathBuf};

/// The reason why a command stops.
#[derive(Debug)]
pub enum Error {
    /// A mistake in the configuration or a truth file.
    Config(Vec<Diagnostic>),
    /// Nothing to work on, or an argument that makes no sense.
    Usage(String),
    /// A file could not be read or written.
    Io {
        /// What was tried.
        action: &'static str,
        /// On which path.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A stored result does not agree with its digest; its entry has been dropped, and the run starts again.
    Damaged(String),
    /// A defect of the program itself.
    Internal(String),
}

/// Result of anything that can stop a command.
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// Process exit code: 2 usage, configuration, no usable input or a place that cannot be written; 4 internal.
    pub fn exit_code(&self) -> u8 {
        match self {
            Error::Config(_) | Error::Usage(_) | Error::Io { .. } => 2,
            Error::Damaged(_) | Error::Internal(_) => 4,
        }
    }

    /// Wraps a system error with what was tried on which path.
    pub fn io(action: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> Error {
        let path = path.to_path_buf();
        move |source| Error::Io {
            action,
            path,
            source,
        }
    }

    /// A defect of the program: something that its own invariants exclude.
    pub fn internal(error: impl fmt::Display) -> Error {
        Error::Internal(error.to_string())
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::Config(diagnostics) => {
                let lines: Vec<String> = diagnostics.iter().map(ToString::to_string).collect();
                write!(f, "{}", lines.join("\n"))
            }
            Error::Usage(message) => write!(f, "error: {message}"),
            Error::Io {
                action,
                path,
                source,
            } => write!(f, "error: cannot {action} {}: {source}", path.display()),
            Error::Damaged(what) => write!(f, "error: damaged cache: {what}"),
            Error::Internal(message) => write!(
                f,
                "error: internal: {message}; this is a defect of pipeline itself, please report it"
            ),
        }
    }
}

impl std::error::Error for Error {}

/// What a panic said.
pub fn panic_message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(ToString::to_string);
    text.or_else(|| panic.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "a panic without words".to_owned())
}

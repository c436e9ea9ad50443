//! Which reader a file needs, and its call.

use crate::brep::Model;
use std::path::Path;

/// Why a file cannot be imported.
#[derive(Debug, thiserror::Error)]
pub enum ImportError {
    /// It cannot be read.
    #[error("cannot read {path}")]
    Io {
        /// The file.
        path: std::path::PathBuf,
        /// Why.
        #[source]
        source: std::io::Error,
    },
    /// It is of no format we know.
    #[error("{path}: {what}")]
    Unsupported {
        /// The file.
        path: std::path::PathBuf,
        /// What it is, and what to do.
        what: String,
    },
    /// The STEP reader refuses it.
    #[error("{path}: {source}")]
    Step {
        /// The file.
        path: std::path::PathBuf,
        /// Why.
        #[source]
        source: crate::step::StepError,
    },
}

/// Reads a CAD file of any known format.
pub fn import(path: &Path) -> Result<Model, ImportError> {
    todo!()
}

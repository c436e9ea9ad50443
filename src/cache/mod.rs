//! The `.trimray` file: header, section table, page-aligned Pod sections, metadata.

use crate::scene::{Scene, SceneBuffers};
use std::path::Path;

/// Writes `scene` to a temporary file beside `path` and renames it.
pub fn write(path: &Path, scene: &Scene<'_>, source_hash: [u8; 32]) -> Result<(), CacheError> {
    todo!()
}

/// A mapped and validated cache file.
pub struct CacheFile {}

impl CacheFile {
    /// Maps and validates.
    pub fn open(path: &Path) -> Result<Self, CacheError> {
        todo!()
    }
    /// The scene in it.
    pub fn scene(&self) -> Scene<'_> {
        todo!()
    }
}

/// Why a cache file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum CacheError {
    /// Reading or writing failed.
    #[error("{path}: {source}")]
    Io {
        /// The file.
        path: std::path::PathBuf,
        /// Why.
        #[source]
        source: std::io::Error,
    },
    /// It is not a whole, current cache file.
    #[error("{path}: byte {at}: {reason}")]
    Invalid {
        /// The file.
        path: std::path::PathBuf,
        /// Offset.
        at: u64,
        /// What is wrong, and what to do.
        reason: String,
    },
}

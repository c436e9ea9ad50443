//! The `.trimray` file: header, section table, page-aligned Pod sections, metadata.
//!
//! The sections are the arrays of a [`crate::scene::SceneBuffers`] as they stand in memory, so that opening a file is mapping it and checking it,
//! once: what was found sound is noted. A section that a scene does not need is absent. The bytes depend on the scene and its provenance alone.
//! Integers and floats are little-endian; a file from a machine of the other kind is refused by its mark.

mod format;
mod open;
mod program;
mod sound;
mod store;
#[cfg(test)]
mod tests;
mod write;

pub use open::CacheFile;
pub use store::{Key, Store};
pub use write::write;

/// What a scene was baked from, and how.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Provenance {
    /// BLAKE3 of the source file.
    pub source_hash: [u8; 32],
    /// The distortion ρ of leaves.
    pub distortion: f64,
    /// The relative tolerance of trims.
    pub trim_tolerance: f64,
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

//! STEP: ISO 10303-21 exchange structures of AP203, AP214, AP242 and whatever else carries a B-rep.

use crate::brep::Model;

/// Reads a STEP file. Never fails on a broken entity: what is lost is in the model's diagnostics. Fails where there is no exchange
/// structure or no entity in it.
pub fn read(bytes: &[u8]) -> Result<Model, StepError> {
    todo!()
}

/// Why a file is no STEP file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum StepError {
    /// It does not begin as one.
    #[error("not a STEP file: no ISO-10303-21 header")]
    NotStep,
    /// No entity could be read.
    #[error("line {line}: {reason}")]
    Invalid {
        /// From 1.
        line: usize,
        /// What is wrong.
        reason: String,
    },
}

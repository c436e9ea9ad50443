//! STEP: ISO 10303-21 exchange structures of AP203, AP214, AP242 and whatever else carries a B-rep.
//!
//! ```text
//! bytes ─scan→ statement index ─catalog→ starting points ─map_*→ brep::Model
//!                    └─ decode: one entity decoded whenever the mapping reaches it
//! ```
//!
//! The schema's name decides nothing: entities are read by their keywords. A broken statement costs itself; a face that
//! cannot be mapped costs itself. Invariant: faces imported plus faces in the diagnostics are the faces declared.

mod catalog;
mod decode;
mod encoding;
mod explain;
mod external;
mod groups;
mod header;
mod hidden;
mod map_assembly;
mod map_body;
mod map_bounded;
mod map_bspline;
mod map_composite;
mod map_curve;
mod map_edge;
mod map_geometry;
mod map_lifted;
mod map_meridian;
mod map_offset;
mod map_pcurve;
mod map_placement;
mod map_polyhedron;
mod map_replica;
mod map_round;
mod map_solid;
mod map_style;
mod map_surface;
mod map_swept;
mod map_tessellated;
mod map_topology;
mod pages;
mod reach;
mod reader;
mod roots;
mod rows;
mod scan;
mod sweep;
mod tessellated_item;
mod text;
mod units;
mod unreached;
mod value;

#[cfg(test)]
mod assembly_tests;
#[cfg(test)]
mod bounded_tests;
#[cfg(test)]
mod corpus_tests;
#[cfg(test)]
mod curve_tests;
#[cfg(test)]
mod style_tests;
#[cfg(test)]
mod surface_tests;
#[cfg(test)]
mod tessellated_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod topology_tests;

use crate::brep::{Model, Severity};
use reader::{Problem, Reader};

pub use encoding::{is_exchange_structure, utf8};
pub use reach::decode_shape;
pub use scan::Index;

/// Reads a STEP file. Never fails on a broken entity: what is lost is in the model's diagnostics. Fails where there is no exchange
/// structure or no entity in it.
pub fn read(bytes: &[u8]) -> Result<Model, StepError> {
    scan(&utf8(bytes)).map(map)
}

/// The first stage: finds the statements of an exchange structure that is ASCII or UTF-8. Fails where there are none.
pub fn scan(bytes: &[u8]) -> Result<Index<'_>, StepError> {
    if !scan::is_exchange_structure(bytes) {
        return Err(StepError::NotStep);
    }
    let index = scan::index(bytes);
    if index.statements.is_empty() {
        return Err(match index.faults.first() {
            Some(fault) => StepError::Invalid { line: index.line(fault.at), reason: fault.reason.into() },
            None => StepError::Invalid {
                line: index.line(bytes.len()),
                reason: "the file has no entities".into(),
            },
        });
    }
    Ok(index)
}

/// The second stage: maps what the statements say, each decoded when it is reached.
pub fn map(index: Index<'_>) -> Model {
    let mut reader = Reader::new(index);
    reader.model.source = header::source(&reader.index);
    for fault in std::mem::take(&mut reader.index.faults) {
        let reason = format!("line {}: {}", reader.index.line(fault.at), fault.reason);
        reader.report(Severity::Warning, Problem { entity: fault.id, kind: "syntax".into(), reason });
    }
    if reader.index.further_faults > 0 {
        let reason = format!("{} further findings of this kind", reader.index.further_faults);
        reader.report(Severity::Warning, Problem { entity: 0, kind: "syntax".into(), reason });
    }
    let catalog = catalog::read(&reader);
    external::report(&mut reader, &catalog);
    hidden::report_left_out(&mut reader, &catalog);
    reader.model.declared_faces = catalog.faces.len();
    reader.open_faces = catalog.faces.clone();
    let styles = map_style::read(&mut reader, &catalog.styled_items);
    hidden::hide(&mut reader, &catalog);
    map_assembly::map(&mut reader, &catalog, &styles);
    if reader.is_exhausted() {
        let reason = "the file refers to long statements too often; some were not read again".into();
        reader.report(Severity::Warning, Problem { entity: 0, kind: "file".into(), reason });
    }
    explain::explain(&mut reader);
    reader.model
}

/// Scans a file and decodes each of its statements, maps none: how many are sound, and how many faults there are.
pub fn count_statements(bytes: &[u8]) -> (usize, usize) {
    let index = scan::index(bytes);
    let decodes = |statement: &&scan::Statement| {
        decode::decode(index.bytes, statement.id, statement.body.clone()).is_ok()
    };
    let sound = index.statements.iter().filter(decodes).count();
    (sound, index.statements.len() - sound + index.faults.len() + index.further_faults)
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

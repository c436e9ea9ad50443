//! IGES 4.0 to 5.3: trimmed surfaces, boundary representations, and surfaces that stand alone.
//!
//! ```text
//! bytes ─card→ records ─global, directory→ directory ─catalog, assembly→ what stands where ─solid, csg, trimmed→ brep::Model
//!                          └─ value: parameters of one entity, decoded whenever the mapping reaches it
//! ```
//!
//! Entities are named by their directory numbers, kinds by their type numbers. A broken entity costs itself and the faces
//! that need it. Invariant: faces imported plus faces in the diagnostics are the faces declared, and declared is every
//! 144, 143 and 510, every bounded plane, every bounded surface that nothing else uses, and every face of a constructive solid
//! that is read.

mod array;
mod assembly;
mod boundary;
mod card;
mod catalog;
mod compressed;
mod conic;
mod csg;
mod curve;
mod directory;
mod global;
mod level;
mod lifted;
mod offset;
mod placement;
mod reader;
mod rounds;
mod solid;
mod spans;
mod style;
mod surface;
mod swept;
mod trimmed;
mod value;

#[cfg(test)]
mod corpus_tests;
#[cfg(test)]
mod csg_tests;
#[cfg(test)]
mod curve_tests;
#[cfg(test)]
mod record_tests;
#[cfg(test)]
mod structure_tests;
#[cfg(test)]
mod surface_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod trim_tests;

use crate::brep::{Model, Severity};
use directory::{Directory, Problem};
use reader::Reader;

pub use card::plain;

/// Whether the beginning of `bytes` looks like an IGES file.
pub fn looks_like_iges(bytes: &[u8]) -> bool {
    card::looks_like_iges(&card::plain(&bytes[..bytes.len().min(card::HEAD)]))
}

/// The records of a file in order: what its global section says, and its directory.
pub struct Scanned<'a> {
    global: global::Global,
    directory: Directory<'a>,
    remarks: Vec<(Severity, String)>,
}

/// Reads an IGES file. Never fails on a broken entity: what is lost is in the model's diagnostics. Fails where there are no
/// records, no entities, or the binary form.
pub fn read(bytes: &[u8]) -> Result<Model, IgesError> {
    scan(&plain(bytes)).map(map)
}

/// The first stage: sorts the records, which are [`plain`] text, and reads the directory.
pub fn scan(bytes: &[u8]) -> Result<Scanned<'_>, IgesError> {
    if !card::looks_like_iges(bytes) {
        return Err(IgesError::NotIges);
    }
    let cards = card::read(bytes);
    if cards.binary {
        return Err(IgesError::Binary);
    }
    let mut global = global::read(&cards.global);
    let (directory, unpaired) = Directory::new(&cards, global.delimiters);
    if directory.len() == 0 {
        return Err(IgesError::Empty);
    }
    let mut warnings = std::mem::take(&mut global.findings);
    if cards.strange > 0 {
        warnings.push(format!("{} records belong to no section", cards.strange));
    }
    if cards.global.is_empty() {
        warnings.push("the file has no global section".into());
    }
    if unpaired > 0 {
        warnings.push(format!("{unpaired} directory records lack their other half"));
    }
    let mut remarks: Vec<_> = warnings.into_iter().map(|reason| (Severity::Warning, reason)).collect();
    if !cards.terminated {
        // Whether anything is missing shows elsewhere: in pointers that lead nowhere.
        remarks.push((Severity::Repaired, "the file ends without a terminate record".into()));
    }
    Ok(Scanned { global, directory, remarks })
}

/// Decodes the parameters of every entity, each once, and makes nothing of them; returns how many entities there are.
pub fn decode_all(scanned: &Scanned<'_>) -> usize {
    scanned.directory.entities().filter(|(entity, _)| scanned.directory.parameters(*entity).is_ok()).count()
}

/// The second stage: maps the entities, each decoded when it is reached.
pub fn map(scanned: Scanned<'_>) -> Model {
    let Scanned { global, directory, remarks } = scanned;
    let mut reader = Reader::new(directory, global.millimetres, global.resolution);
    reader.model.source = global.source;
    for (severity, reason) in remarks {
        reader.report(severity, Problem { entity: 0, kind: 0, reason });
    }
    let catalog = catalog::catalog(&mut reader);
    reader.model.declared_faces = catalog.faces.len();
    reader.open_faces = catalog.faces.iter().copied().collect();
    reader.plane_holes = catalog.plane_holes.clone();
    assembly::map(&mut reader, &catalog, global.product);
    reader.model
}

/// Why a file is no IGES file that can be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum IgesError {
    /// It does not begin as one.
    #[error("not an IGES file: no start or global section")]
    NotIges,
    /// It is in the binary form, which went out of use in the 1980s.
    #[error("binary IGES is not supported; export the ASCII form")]
    Binary,
    /// There is nothing in it.
    #[error("the file has no entities: it ends before its directory section, or that is empty")]
    Empty,
}

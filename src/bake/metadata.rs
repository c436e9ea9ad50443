//! What the scene tells people about its source.

use crate::brep::{BodyKind, Diagnostic, Model, Occurrence, Severity};
use crate::scene::Metadata;

/// Names, units, counts and diagnostics of the model; parts, faces and instances are the bake's to add.
pub(super) fn of_model(model: &Model, occurrences: &[Occurrence], cut: bool) -> Metadata {
    let mut metadata = Metadata {
        file_name: String::new(),
        format: model.source.format.clone(),
        schema: model.source.schema.clone(),
        originating_system: model.source.originating_system.clone(),
        unit: model.source.unit.name.clone(),
        unit_millimetres: model.source.unit.millimetres,
        declared_faces: model.declared_faces as u64,
        solids: occurrences
            .iter()
            .flat_map(|occurrence| &model.parts[occurrence.part].bodies)
            .filter(|body| body.kind == BodyKind::Solid)
            .count() as u64,
        ..Metadata::default()
    };
    for diagnostic in &model.diagnostics {
        report(&mut metadata, diagnostic.clone());
    }
    if cut {
        let reason = "the tree refers to itself or is too large; what exceeds it is left out";
        report(&mut metadata, Diagnostic::new(Severity::Warning, 0, "PRODUCT", reason));
    }
    metadata
}

/// Appends a finding.
pub(super) fn report(metadata: &mut Metadata, diagnostic: Diagnostic) {
    let severity = match diagnostic.severity {
        Severity::Note => 0,
        Severity::Warning => 1,
        Severity::Dropped => 2,
    };
    metadata.diagnostics.push((
        severity,
        diagnostic.entity,
        diagnostic.kind,
        diagnostic.reason,
        diagnostic.faces,
    ));
}

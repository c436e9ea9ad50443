//! What the scene tells people about its source.

use crate::brep::{BodyKind, Diagnostic, Id, Model, Occurrence, Part, Severity};
use crate::scene::{self, Finding, Metadata};

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
        recognised: model
            .recognised
            .iter()
            .map(|(kind, count)| ((*kind).to_owned(), *count as u64))
            .collect(),
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
    let Diagnostic { severity, entity, kind, reason, faces } = diagnostic;
    let severity = match severity {
        Severity::Note => scene::Severity::Note,
        Severity::Hidden => scene::Severity::Hidden,
        Severity::Repaired => scene::Severity::Repaired,
        Severity::Warning => scene::Severity::Warning,
        Severity::Dropped => scene::Severity::Dropped,
    };
    metadata.findings.push(Finding { severity, entity, kind, reason, faces });
}

/// Reports the parts whose faces are not in the scene because nothing places them; `placed` is sorted.
pub(super) fn report_unplaced(metadata: &mut Metadata, model: &Model, placed: &[Id<Part>]) {
    for id in model.parts.ids().filter(|id| placed.binary_search(id).is_err()) {
        let part = &model.parts[id];
        let faces = part.bodies.iter().map(|body| body.faces.len()).sum::<usize>() as u32;
        if faces > 0 {
            let reason = format!("part '{}' is placed nowhere", part.name);
            report(
                metadata,
                Diagnostic { faces, ..Diagnostic::new(Severity::Dropped, part.entity, "PRODUCT", reason) },
            );
        }
    }
}

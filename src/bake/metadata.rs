//! What the scene tells people about its source.

use crate::brep::{BodyKind, Diagnostic, Diagnostics, Model, Occurrence, Severity};
use crate::scene::Metadata;

/// Names, units, counts of the model; parts, faces, instances and diagnostics are the bake's to add.
pub(super) fn of_model(model: &Model, occurrences: &[Occurrence]) -> Metadata {
    Metadata {
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
    }
}

/// The model's findings, and that its tree was cut where it was.
pub(super) fn findings(model: &Model, cut: bool) -> Diagnostics {
    let mut findings = model.diagnostics.clone();
    if cut {
        let reason = "the tree refers to itself or is too large; what exceeds it is left out";
        findings.push(Diagnostic::new(Severity::Warning, 0, "PRODUCT", reason));
    }
    findings
}

/// The findings as the scene keeps them.
pub(super) fn records(findings: &Diagnostics) -> Vec<(u8, u64, String, String, u32)> {
    let record = |finding: &Diagnostic| {
        let severity = match finding.severity {
            Severity::Note => 0,
            Severity::Warning => 1,
            Severity::Dropped => 2,
        };
        (severity, finding.entity, finding.kind.clone(), finding.reason.clone(), finding.faces)
    };
    findings.iter().map(record).collect()
}

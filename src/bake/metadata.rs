//! What the scene tells people about its source.

use crate::brep::{
    Body, BodyKind, Diagnostic, Diagnostics, Id, Model, Occurrence, Part, Severity, is_closed,
};
use crate::scene::{self, BodyInfo, Finding, Metadata};

/// The bodies of `parts`.
pub(super) fn bodies_of(model: &Model, parts: &[Id<Part>]) -> Vec<BodyInfo> {
    let bodies = parts.iter().flat_map(|&part| &model.parts[part].bodies);
    let body = |body: &Body| {
        let is_closed = body.kind == BodyKind::Solid && is_closed(model, body);
        BodyInfo::new(body.entity, is_closed)
    };
    bodies.map(body).collect()
}

/// Names, units, counts of the model; parts, instances and diagnostics are the bake's to add.
pub(super) fn of_model(model: &Model, occurrences: &[Occurrence]) -> Metadata {
    let solids_of =
        |part: &Part| part.bodies.iter().filter(|body| body.kind == BodyKind::Solid).count() as u64;
    let solids: Vec<u64> = model.parts.iter().map(solids_of).collect();
    Metadata {
        file_name: String::new(),
        format: model.source.format.clone(),
        schema: model.source.schema.clone(),
        originating_system: model.source.originating_system.clone(),
        unit: model.source.unit.name.clone(),
        unit_millimetres: model.source.unit.millimetres,
        declared_faces: model.declared_faces as u64,
        solids: occurrences.iter().map(|occurrence| solids[occurrence.part.index()]).sum(),
        recognised: model
            .recognised
            .iter()
            .map(|(kind, count)| ((*kind).to_owned(), *count as u64))
            .collect(),
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
pub(super) fn records(findings: &Diagnostics) -> Vec<Finding> {
    let record = |Diagnostic { severity, entity, kind, reason, faces }: Diagnostic| {
        let severity = match severity {
            Severity::Note => scene::Severity::Note,
            Severity::Hidden => scene::Severity::Hidden,
            Severity::Repaired => scene::Severity::Repaired,
            Severity::Warning => scene::Severity::Warning,
            Severity::Dropped => scene::Severity::Dropped,
        };
        Finding { severity, entity, kind, reason, faces }
    };
    findings.iter().cloned().map(record).collect()
}

/// Reports the parts whose faces are not in the scene because nothing places them; `placed` is sorted.
pub(super) fn report_unplaced(findings: &mut Diagnostics, model: &Model, placed: &[Id<Part>]) {
    for id in model.parts.ids().filter(|id| placed.binary_search(id).is_err()) {
        let part = &model.parts[id];
        let faces = part.bodies.iter().map(|body| body.faces.len()).sum::<usize>() as u32;
        if faces > 0 {
            let is_hidden = model.hidden_parts.binary_search(&id).is_ok();
            let severity = if is_hidden { Severity::Hidden } else { Severity::Dropped };
            let place = if is_hidden { "invisibly" } else { "nowhere" };
            let reason = format!("part '{}' is placed {place}", part.name);
            findings.push(Diagnostic { faces, ..Diagnostic::new(severity, part.entity, "PRODUCT", reason) });
        }
    }
}

//! What a file holds and a picture of its shape does not: invisible items (ISO 10303-46: invisibility), and items that are no
//! exact shape. Each kind is said once, with its count.

use super::catalog::Catalog;
use super::map_topology::{BODY_KEYWORDS, FACE_KEYWORDS};
use super::reader::{Problem, Reader};
use super::value::Value;
use crate::brep::{Diagnostic, Severity};
use std::collections::HashSet;

/// Whether entities of this kind are left out on purpose: tessellations stand beside or instead of exact shape, the others are
/// drawings in space.
pub fn is_left_out(keyword: &str) -> bool {
    const TESSELLATED: [&str; 5] = [
        "TESSELLATED_SOLID",
        "TESSELLATED_SHELL",
        "TESSELLATED_CURVE_SET",
        "TESSELLATED_POINT_SET",
        "TESSELLATED_WIRE",
    ];
    const DRAWN: [&str; 5] = [
        "GEOMETRIC_CURVE_SET",
        "SHELL_BASED_WIREFRAME_MODEL",
        "EDGE_BASED_WIREFRAME_MODEL",
        "ANNOTATION_PLANE",
        "ANNOTATION_TEXT",
    ];
    TESSELLATED.contains(&keyword)
        || DRAWN.contains(&keyword)
        || (keyword.contains("ANNOTATION_") && keyword.ends_with("OCCURRENCE"))
}

/// Says what is left out: a note for each kind.
pub fn report_left_out(reader: &mut Reader, catalog: &Catalog) {
    for (kind, &(first, count)) in &catalog.left_out {
        let reason = format!("{count} left out: only exact surfaces are read");
        reader.report(Severity::Note, Problem { entity: first, kind: kind.clone(), reason });
    }
}

/// Takes the bodies and faces that the file marks as invisible out of what is to be mapped, with a note.
pub fn hide(reader: &mut Reader, catalog: &Catalog) {
    let mut hidden: Vec<u64> = Vec::new();
    for &id in &catalog.invisibilities {
        let Ok(entity) = reader.entity(id) else { continue };
        let items = entity.records.iter().flat_map(|r| &r.parameters).filter_map(Value::list).flatten();
        for item in items.filter_map(Value::reference) {
            let Ok(entity) = reader.entity(item) else { continue };
            let styled = entity.record("STYLED_ITEM").or(entity.record("OVER_RIDING_STYLED_ITEM"));
            let at = if entity.records.len() > 1 { 1 } else { 2 };
            hidden.push(styled.and_then(|record| record.reference(at)).unwrap_or(item));
        }
    }
    let (mut seen, mut faces) = (HashSet::new(), 0);
    let mut first = None;
    while let Some(id) = hidden.pop() {
        let keyword = reader.keyword(id);
        let is_shell = BODY_KEYWORDS.contains(&&*keyword) || keyword == "ORIENTED_OPEN_SHELL";
        if !seen.insert(id) {
            continue;
        }
        if FACE_KEYWORDS.contains(&&*keyword) && reader.open_faces.remove(&id) {
            faces += 1;
            first.get_or_insert(id);
        } else if is_shell && let Ok(entity) = reader.entity(id) {
            first.get_or_insert(id);
            reader.taken_bodies.insert(id);
            let parameters = entity.records.iter().flat_map(|r| &r.parameters);
            hidden.extend(parameters.flat_map(|p| {
                p.reference().into_iter().chain(p.list().into_iter().flatten().filter_map(Value::reference))
            }));
        }
    }
    if let Some(first) = first {
        let kind = reader.keyword(first).into_owned();
        let reason = format!("left out with all else that the file marks as invisible: {faces} faces");
        let mut diagnostic = Diagnostic::new(Severity::Note, first, kind, reason);
        diagnostic.faces = faces;
        reader.model.diagnostics.push(diagnostic);
    }
}

//! What a file holds and a picture of its shape does not: invisible items (ISO 10303-46: invisibility), and items that are no
//! surface. Each kind is said once, with its count.

use super::catalog::Catalog;
use super::map_style::styled_item;
use super::map_tessellated::is_tessellated;
use super::map_topology::{BODY_KEYWORDS, FACE_KEYWORDS};
use super::reader::{Problem, Reader};
use super::value::Value;
use crate::brep::{Diagnostic, Severity};
use std::collections::HashSet;

/// Whether entities of this kind are left out on purpose: points, curves and texts, most of them product and manufacturing
/// information.
pub fn is_left_out(keyword: &str) -> bool {
    const DRAWN: [&str; 9] = [
        "TESSELLATED_CURVE_SET",
        "TESSELLATED_POINT_SET",
        "TESSELLATED_WIRE",
        "GEOMETRIC_CURVE_SET",
        "SHELL_BASED_WIREFRAME_MODEL",
        "EDGE_BASED_WIREFRAME_MODEL",
        "ANNOTATION_PLANE",
        "ANNOTATION_TEXT",
        "DRAUGHTING_CALLOUT",
    ];
    DRAWN.contains(&keyword) || (keyword.contains("ANNOTATION_") && keyword.ends_with("OCCURRENCE"))
}

/// Says what is left out: a note for each kind.
pub fn report_left_out(reader: &mut Reader, catalog: &Catalog) {
    for (kind, &(first, count)) in &catalog.left_out {
        let reason = format!("{count} left out: only surfaces are read");
        reader.report(Severity::Note, Problem { entity: first, kind: kind.clone(), reason });
    }
}

/// Takes the bodies, faces and placements that the file marks as invisible out of what is to be mapped, with a note.
pub fn hide(reader: &mut Reader, catalog: &Catalog) {
    let mut waiting: Vec<u64> = Vec::new();
    for &id in &catalog.invisibilities {
        let Ok(entity) = reader.entity(id) else { continue };
        let items = entity.records.iter().flat_map(|r| &r.parameters).filter_map(Value::list).flatten();
        waiting.extend(items.filter_map(Value::reference));
    }
    let (mut seen, mut placements) = (HashSet::new(), 0);
    let reason = "the file marks it, or what it belongs to, as invisible";
    while let Some(id) = waiting.pop() {
        if !seen.insert(id) {
            continue;
        }
        let Ok(entity) = reader.entity(id) else { continue };
        if let Some(styled) = styled_item(&entity) {
            match styled.contexts.as_slice() {
                [] => waiting.extend(styled.item),
                // In the context of one occurrence only that one is meant.
                [occurrence] => {
                    reader.hidden_placements.insert(*occurrence);
                    placements += 1;
                }
                _ => {}
            }
            continue;
        }
        match &*reader.keyword(id) {
            "MAPPED_ITEM" => {
                reader.hidden_placements.insert(id);
                placements += 1;
            }
            "PRESENTATION_LAYER_ASSIGNMENT" => waiting.extend(entity.first().references(2)),
            "GEOMETRIC_SET" => waiting.extend(entity.first().references(1)),
            keyword if keyword.ends_with("SHAPE_REPRESENTATION") => {
                waiting.extend(entity.first().references(1));
            }
            keyword if FACE_KEYWORDS.contains(&keyword) => {
                if reader.open_faces.remove(&id) {
                    reader.model.diagnostics.push(Diagnostic::hidden_face(id, keyword, reason));
                }
            }
            keyword if is_tessellated(keyword) => {
                reader.taken_bodies.insert(id);
                reader.model.diagnostics.push(Diagnostic::new(Severity::Hidden, id, keyword, reason));
            }
            keyword if BODY_KEYWORDS.contains(&keyword) || keyword == "ORIENTED_OPEN_SHELL" => {
                reader.taken_bodies.insert(id);
                let parameters = entity.records.iter().flat_map(|r| &r.parameters);
                waiting.extend(parameters.flat_map(|p| {
                    p.reference()
                        .into_iter()
                        .chain(p.list().into_iter().flatten().filter_map(Value::reference))
                }));
            }
            _ => {
                // A surface without topology is no face then.
                reader.loose_surfaces.insert(id);
            }
        }
    }
    if placements > 0 {
        let reason = format!("{placements} placements left out that the file marks as invisible");
        reader.report(Severity::Hidden, Problem { entity: 0, kind: "INVISIBILITY".into(), reason });
    }
}

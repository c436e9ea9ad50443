//! What a file holds in the place of surfaces, where it has none.

use super::decode;
use super::reader::{Problem, Reader};
use crate::brep::Severity;
use std::collections::BTreeMap;

/// Says of a model without a face what there is instead.
pub fn explain(reader: &mut Reader) {
    if reader.model.declared_faces > 0 {
        return;
    }
    let mut counts: BTreeMap<&'static str, usize> = BTreeMap::new();
    for statement in &reader.index.statements {
        let keyword =
            decode::upper_case(decode::leading_keyword(&reader.index.bytes[statement.body.clone()]));
        if let Some(kind) = kind(&keyword) {
            *counts.entry(kind).or_default() += 1;
        }
    }
    let found: Vec<String> = counts.into_iter().map(|(kind, count)| format!("{kind} ({count})")).collect();
    let found = if found.is_empty() { "nothing like it".into() } else { found.join(", ") };
    let count = reader.index.statements.len();
    let reason =
        format!("no solid, shell or face that could be read; among the file's {count} entities: {found}");
    reader.report(Severity::Warning, Problem { entity: 0, kind: "DATA".into(), reason });
}

/// What people call entities that hold something like shape.
fn kind(keyword: &str) -> Option<&'static str> {
    Some(match keyword {
        _ if keyword.ends_with("ELEMENT_REPRESENTATION") => "finite elements",
        "CSG_PRIMITIVE_SOLID_2D" | "CSG_SOLID_2D" => "flat areas",
        "GEOMETRIC_CURVE_SET" | "SHELL_BASED_WIREFRAME_MODEL" | "EDGE_BASED_WIREFRAME_MODEL" => "wireframes",
        _ if keyword.contains("TRIANGULATED") => "tessellated surfaces",
        "POLYLINE" | "COMPOSITE_CURVE" | "TRIMMED_CURVE" | "LINE" | "CIRCLE" | "ELLIPSE" => "curves",
        "CARTESIAN_POINT" => "points",
        _ => return None,
    })
}

//! What a file holds that no picture of its shape can show, said where that is all or where it leaves holes: components in other
//! files, and what stands in the place of surfaces.

use super::decode;
use super::reader::{Problem, Reader};
use crate::brep::Severity;
use std::collections::BTreeMap;

/// How many names a sentence lists.
const NAMES: usize = 5;

/// Names the files that components stand in (ISO 10303-41: document_file), and says of a model without a face what there is
/// instead.
pub fn explain(reader: &mut Reader) {
    let mut counts: BTreeMap<&'static str, usize> = BTreeMap::new();
    let mut files = Vec::new();
    for statement in &reader.index.statements {
        let keyword =
            decode::upper_case(decode::leading_keyword(&reader.index.bytes[statement.body.clone()]));
        if keyword == "DOCUMENT_FILE" {
            let name = reader.entity(statement.id).map(|e| e.first().text(0)).unwrap_or_default();
            let is_shape = [".stp", ".step", ".p21"].iter().any(|end| name.to_lowercase().ends_with(end));
            files.extend(is_shape.then_some((statement.id, name)));
        }
        if let Some(kind) = kind(&keyword) {
            *counts.entry(kind).or_default() += 1;
        }
    }
    if let Some((first, _)) = files.first() {
        let names: Vec<&str> = files.iter().take(NAMES).map(|(_, name)| name.as_str()).collect();
        let more = if files.len() > NAMES { ", …" } else { "" };
        let reason = format!(
            "{} components stand in other files, which are not opened: {}{more}",
            files.len(),
            names.join(", ")
        );
        reader.report(Severity::Warning, Problem { entity: *first, kind: "DOCUMENT_FILE".into(), reason });
    }
    if !reader.model.faces.is_empty() || reader.model.declared_faces > 0 {
        return;
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
        _ if keyword.ends_with("_2D")
            || keyword.ends_with("_AREA")
            || keyword == "PATH_AREA_WITH_PARAMETERS" =>
        {
            "flat areas"
        }
        "GEOMETRIC_CURVE_SET" | "SHELL_BASED_WIREFRAME_MODEL" | "EDGE_BASED_WIREFRAME_MODEL" => "wireframes",
        _ if keyword.contains("TRIANGULATED") => "tessellated surfaces",
        "POLYLINE" | "COMPOSITE_CURVE" | "TRIMMED_CURVE" | "LINE" | "CIRCLE" | "ELLIPSE" => "curves",
        "CARTESIAN_POINT" => "points",
        _ => return None,
    })
}

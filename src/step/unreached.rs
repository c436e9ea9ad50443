//! Bodies and faces that no representation reaches: shown in a part of their own, with a note, unless they only serve to make
//! others or to construct.

use super::catalog::Catalog;
use super::map_assembly::Assembly;
use super::map_style::Styles;
use super::map_topology::{BODY_KEYWORDS, GENERATED};
use super::reader::{Problem, Reader};
use super::value::Value;
use crate::brep::{Diagnostic, Part, Severity};
use std::collections::HashSet;

/// Maps what is left.
pub fn map(assembly: &mut Assembly, reader: &mut Reader, catalog: &Catalog, styles: &Styles) {
    let others = operands(reader, catalog);
    leave_out(reader, &others.construction, "construction geometry");
    let is_empty = reader.model.faces.is_empty();
    let is_left = |reader: &Reader, id: &u64| {
        !reader.taken_bodies.contains(id)
            && !others.operands.contains(id)
            && !others.construction.contains(id)
    };
    let mut bodies: Vec<u64> = catalog.bodies.iter().copied().filter(|id| is_left(reader, id)).collect();
    let made = |reader: &Reader, id: u64| BODY_KEYWORDS[..GENERATED].contains(&&*reader.keyword(id));
    bodies.retain(|&id| {
        made(reader, id) || reader.faces_below(id).iter().any(|f| reader.open_faces.contains(f))
    });
    let nothing_else = is_empty && bodies.is_empty();
    if !nothing_else {
        leave_out(reader, &others.operands, "only serves to make another solid");
    }
    if !bodies.is_empty() || !reader.open_faces.is_empty() {
        map_loose(assembly, reader, bodies, styles);
    }
    let mut left: Vec<u64> = reader.open_faces.iter().copied().collect();
    left.sort_unstable();
    for id in left {
        let kind = reader.keyword(id).into_owned();
        let reason = "it belongs to no body".to_owned();
        reader.drop_face(id, &kind, &Problem { entity: id, kind: kind.clone(), reason });
    }
}

fn map_loose(assembly: &mut Assembly, reader: &mut Reader, mut bodies: Vec<u64>, styles: &Styles) {
    let context = assembly.order.iter().find_map(|r| assembly.representations[r].context);
    assembly.use_units(reader, context);
    if reader.model.faces.is_empty() {
        reader.model.source.unit = reader.units.length_unit();
    }
    // Solids before the shells that they are made of.
    let rank = |reader: &Reader, id: u64| {
        let entity = reader.entity(id);
        BODY_KEYWORDS.iter().position(|k| entity.as_ref().is_ok_and(|e| e.is(k)))
    };
    bodies.sort_by_cached_key(|&id| (rank(reader, id), id));
    let mut part = Part::default();
    for id in bodies {
        match reader.body(id, styles, None) {
            Ok(body) => part.bodies.extend(body),
            Err(problem) => reader.report(Severity::Dropped, problem),
        }
    }
    let mut faces: Vec<u64> = reader.open_faces.iter().copied().collect();
    faces.sort_unstable();
    if let Some(&first) = faces.first() {
        part.bodies.extend(reader.loose_sheet(first, &faces, styles, None));
    }
    if !part.bodies.is_empty() {
        let reason =
            format!("{} bodies stand outside of any product; imported as one part", part.bodies.len());
        reader.report(Severity::Note, Problem { entity: 0, kind: "PRODUCT".into(), reason });
        reader.model.parts.push(part);
    }
}

/// Bodies and faces that others are made from, and those of supplemental geometry.
struct Others {
    operands: HashSet<u64>,
    construction: HashSet<u64>,
}

fn operands(reader: &Reader, catalog: &Catalog) -> Others {
    let mut others = Others { operands: HashSet::new(), construction: HashSet::new() };
    let references = |id: u64| {
        let parameters = reader.entity(id).into_iter().flat_map(|e| e.records).flat_map(|r| r.parameters);
        let in_list = |p: &Value| -> Vec<u64> {
            p.reference()
                .into_iter()
                .chain(p.list().into_iter().flatten().filter_map(Value::reference))
                .collect()
        };
        parameters.flat_map(move |p| in_list(&p)).collect::<Vec<u64>>()
    };
    for &id in catalog.bodies.iter().filter(|&&id| BODY_KEYWORDS[..GENERATED].contains(&&*reader.keyword(id)))
    {
        others.operands.extend(references(id));
    }
    for &id in &catalog.constructions {
        others.construction.extend(references(id));
    }
    others
}

/// Takes the faces that `bodies` lead to out of what is to be mapped.
fn leave_out(reader: &mut Reader, bodies: &HashSet<u64>, why: &str) {
    let mut faces: Vec<u64> = bodies.iter().flat_map(|&id| reader.faces_below(id)).collect();
    faces.sort_unstable();
    for id in faces {
        if reader.open_faces.remove(&id) {
            let kind = reader.keyword(id).into_owned();
            reader.model.diagnostics.push(Diagnostic::hidden_face(id, kind, why));
        }
    }
}

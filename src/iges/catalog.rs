//! What the directory holds: shape, what shape is made of, groups, and what is left out and said.

use super::directory::{Entry, Parameters, Problem};
use super::reader::Reader;
use super::solid::solid_shells;
use super::surface::BOUNDED_KINDS;
use crate::brep::Severity;
use std::collections::{BTreeMap, HashMap, HashSet};

/// Constructive solids that are read: 150 to 168.
pub const PRIMITIVES: [u32; 9] = [150, 152, 154, 156, 158, 160, 162, 164, 168];

/// What holds placed shape: instances of subfigures, arrays, boolean trees of one operand, assemblies and instances of solids.
pub const PLACING: [u32; 7] = [408, 420, 412, 414, 180, 184, 430];

/// Entity types that hold shape which is not understood.
const UNSUPPORTED: [(u32, &str); 2] = [
    (180, "boolean trees of several solids are not evaluated"),
    (182, "selected components of boolean trees are not evaluated"),
];

/// Entity types that hold no surface, by what they are together.
const WITHOUT_SURFACE: [(&[u32], &str); 4] = [
    (&[100, 102, 104, 106, 110, 112, 126, 130, 142], "curves that bound no surface"),
    (&[116], "points"),
    (&[108, 190, 192, 194], "unbounded surfaces that nothing trims"),
    (&[134, 136, 138, 146, 148], "finite elements"),
];

/// Entities by what they are for.
#[derive(Debug, Default)]
pub struct Catalog {
    /// Solids, shells, faces, surfaces that stand alone, and instances, in file order.
    pub shapes: Vec<u32>,
    /// Faces: all 144, 143, 510, bounded planes and bare surfaces.
    pub faces: Vec<u32>,
    /// Subfigure definitions (308) and network subfigure definitions (320).
    pub definitions: Vec<u32>,
    /// Groups (402, forms 1, 7, 14 and 15).
    pub groups: Vec<u32>,
    /// What solids, shells, boolean trees, assemblies, instances and arrays are made of: it stands nowhere by itself.
    pub components: HashSet<u32>,
    /// The holes of bounded planes, by plane.
    pub plane_holes: HashMap<u32, Vec<u32>>,
}

/// Whether the entity is a group whose members are shape.
pub fn is_group(entry: &Entry) -> bool {
    entry.kind == 402 && matches!(entry.form, 1 | 7 | 14 | 15)
}

/// The members of a definition (308, 320) or a group (402); none where it cannot be read.
pub fn members(reader: &Reader, entity: u32) -> Vec<u32> {
    let Ok(parameters) = reader.file.parameters(entity) else { return Vec::new() };
    let at = if parameters.kind == 402 { 1 } else { 3 };
    let count = parameters.count(at, 1).unwrap_or(0);
    parameters.references(at + 1, count)
}

/// The solids that a boolean tree (180) is made of: the negative ones of its parameters.
pub fn tree_operands(parameters: &Parameters) -> Vec<u32> {
    let count = parameters.count(1, 1).unwrap_or(0);
    let operand = |i: usize| parameters.integer(2 + i).ok().filter(|n| *n < 0);
    (0..count).filter_map(operand).filter_map(|n| u32::try_from(-n).ok()).collect()
}

/// Whether an entity is geometry, or geometry within a definition; not annotation, parameter space or construction.
fn is_geometry(entry: &Entry) -> bool {
    matches!(entry.usage, 0 | 2 | 3)
}

/// Looks through the directory, and through the parameters of what uses surfaces and solids.
pub fn catalog(reader: &mut Reader) -> Catalog {
    let mut catalog = Catalog::default();
    // Surfaces of faces and offsets, and surfaces that only curves lie on.
    let (mut used, mut touched) = (HashSet::new(), HashSet::new());
    for (entity, entry) in reader.file.entities() {
        let parameters = || reader.file.parameters(entity);
        let referred = |at: usize| parameters().and_then(|p| p.reference(at)).ok();
        match entry.kind {
            144 | 510 => used.extend(referred(1)),
            140 => used.extend(referred(5)),
            143 => used.extend(referred(2)),
            141 => touched.extend(referred(3)),
            142 => touched.extend(referred(2)),
            308 | 320 => catalog.definitions.push(entity),
            186 => {
                let shells = parameters().and_then(|p| solid_shells(&p)).unwrap_or_default();
                catalog.components.extend(shells.into_iter().map(|(shell, _)| shell));
            }
            514 => {
                let faces = reader.shell_faces(entity).unwrap_or_default();
                catalog.components.extend(faces.into_iter().map(|(face, _)| face));
            }
            180 => catalog.components.extend(parameters().map(|p| tree_operands(&p)).unwrap_or_default()),
            184 => {
                let items = parameters().map(|p| p.references(2, p.count(1, 1).unwrap_or(0)));
                catalog.components.extend(items.unwrap_or_default());
            }
            412 | 414 | 430 => catalog.components.extend(referred(1)),
            402 if is_group(entry) => catalog.groups.push(entity),
            // Single parent: one parent, how many children, the parent, these.
            402 if entry.form == 9 => {
                if let Ok(p) = parameters()
                    && let Ok(parent) = p.reference(3)
                {
                    let holes = p.references(4, p.count(2, 1).unwrap_or(0));
                    catalog.plane_holes.entry(parent).or_default().extend(holes);
                }
            }
            _ => {}
        }
    }
    let listed: HashSet<u32> =
        catalog.definitions.iter().flat_map(|&definition| members(reader, definition)).collect();
    for (entity, entry) in reader.file.entities() {
        let is_face = match entry.kind {
            143 | 144 | 510 => true,
            // A bounded plane that is no hole.
            108 => entry.form == 1 && is_geometry(entry) && !used.contains(&entity),
            kind if BOUNDED_KINDS.contains(&kind) => {
                // A part of something else that nothing refers to would be lost.
                let stands_alone =
                    !entry.physically_dependent || listed.contains(&entity) || !touched.contains(&entity);
                is_geometry(entry) && !used.contains(&entity) && stands_alone
            }
            _ => false,
        };
        if is_face {
            catalog.faces.push(entity);
        }
        let is_shape = matches!(entry.kind, 186 | 514)
            || PRIMITIVES.contains(&entry.kind)
            || PLACING.contains(&entry.kind);
        if is_face || is_shape {
            catalog.shapes.push(entity);
        }
    }
    report_unsupported(reader);
    report_without_surface(reader, &catalog, &used, &touched);
    catalog
}

/// Names what holds shape that cannot be read, each kind once.
fn report_unsupported(reader: &mut Reader) {
    let mut unsupported: BTreeMap<u32, (u32, usize)> = BTreeMap::new();
    let mut problems = Vec::new();
    for (entity, entry) in reader.file.entities() {
        let is_lost = match entry.kind {
            180 => reader.file.parameters(entity).is_ok_and(|p| tree_operands(&p).len() != 1),
            182 => true,
            416 => {
                let file = reader.file.parameters(entity).map(|p| p.text(1).to_owned()).unwrap_or_default();
                let reason = format!("shape in another file is not read: {file}");
                problems.push(Problem { entity, kind: 416, reason });
                false
            }
            _ => false,
        };
        if is_lost {
            unsupported.entry(entry.kind).or_insert((entity, 0)).1 += 1;
        }
    }
    for (kind, (entity, count)) in unsupported {
        let what = UNSUPPORTED.iter().find(|(known, _)| *known == kind).map_or("", |(_, what)| what);
        problems.push(Problem { entity, kind, reason: format!("{what}: {count} left out") });
    }
    for problem in problems {
        reader.report(Severity::Dropped, problem);
    }
}

/// Says what stands alone and has no surface: a note for each sort, a warning where there is nothing else.
fn report_without_surface(
    reader: &mut Reader,
    catalog: &Catalog,
    used: &HashSet<u32>,
    touched: &HashSet<u32>,
) {
    let severity = if catalog.shapes.is_empty() { Severity::Warning } else { Severity::Note };
    for (kinds, what) in WITHOUT_SURFACE {
        let stands_alone = |entity: &u32, entry: &Entry| {
            kinds.contains(&entry.kind)
                && !entry.physically_dependent
                && is_geometry(entry)
                && !used.contains(entity)
                && !touched.contains(entity)
                && (entry.kind != 108 || entry.form == 0)
        };
        let mut found = reader.file.entities().filter(|(entity, entry)| stands_alone(entity, entry));
        if let Some((entity, entry)) = found.next() {
            let kind = entry.kind;
            let reason = format!("{} {what}: only surfaces are shown", 1 + found.count());
            reader.report(severity, Problem { entity, kind, reason });
        }
    }
}

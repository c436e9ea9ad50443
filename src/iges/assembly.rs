//! What stands where: subfigures (308) and their instances (408), groups (402), and everything that stands alone.
//!
//! The whole file is one part; a subfigure definition is another one. Solids with a matrix of their own become placed
//! parts too.

use super::directory::{Mapped, Problem};
use super::placement;
use super::reader::Reader;
use super::solid::solid_shells;
use super::style;
use super::surface::BOUNDED_KINDS;
use crate::brep::{Body, BodyKind, Child, Face, Id, Part, Severity};
use glam::{DAffine3, DVec3};
use std::collections::{BTreeMap, HashMap, HashSet};

/// Subfigures and groups may not be nested deeper than this; deeper ones are cyclic or hostile.
const MAX_DEPTH: usize = 64;

/// Entity types that hold shape which is not understood.
const UNSUPPORTED: [(u32, &str); 20] = [
    (140, "offset surfaces"),
    (150, "CSG blocks"),
    (152, "CSG wedges"),
    (154, "CSG cylinders"),
    (156, "CSG cones"),
    (158, "CSG spheres"),
    (160, "CSG tori"),
    (162, "CSG solids of revolution"),
    (164, "CSG solids of linear extrusion"),
    (168, "CSG ellipsoids"),
    (180, "boolean trees"),
    (182, "selected components"),
    (184, "solid assemblies"),
    (412, "rectangular arrays of subfigures"),
    (414, "circular arrays of subfigures"),
    (416, "external references"),
    (420, "network subfigures"),
    (430, "solid instances"),
    (134, "finite element nodes"),
    (136, "finite elements"),
];

/// Entities by what they are for.
#[derive(Debug, Default)]
pub struct Catalog {
    /// Solids, shells, faces, surfaces that stand alone, and instances, in file order.
    pub shapes: Vec<u32>,
    /// Faces: all 144, 143, 510 and bare surfaces.
    pub faces: Vec<u32>,
    definitions: Vec<u32>,
}

/// Looks through the directory once, and through the parameters of what uses surfaces.
pub fn catalog(reader: &mut Reader) -> Catalog {
    let mut catalog = Catalog::default();
    let mut used: HashSet<u32> = HashSet::new();
    let mut unsupported: BTreeMap<u32, (u32, usize)> = BTreeMap::new();
    for (entity, entry) in reader.file.entities() {
        let surface_at: usize = match entry.kind {
            144 | 510 | 140 => 1,
            141 => 3,
            142 | 143 => 2,
            308 => {
                catalog.definitions.push(entity);
                continue;
            }
            kind => {
                if UNSUPPORTED.iter().any(|(known, _)| *known == kind) {
                    unsupported.entry(kind).or_insert((entity, 0)).1 += 1;
                }
                continue;
            }
        };
        if let Ok(surface) = reader.file.parameters(entity).and_then(|p| p.reference(surface_at)) {
            used.insert(surface);
        }
    }
    for (kind, (entity, count)) in unsupported {
        let what = UNSUPPORTED.iter().find(|(known, _)| *known == kind).map_or("", |(_, what)| what);
        let reason = format!("{what} are not supported: {count} left out");
        reader.report(Severity::Dropped, Problem { entity, kind, reason });
    }
    let listed: HashSet<u32> =
        catalog.definitions.iter().flat_map(|&entity| members(reader, entity, 308)).collect();
    for (entity, entry) in reader.file.entities() {
        let is_face = match entry.kind {
            143 | 144 | 510 => true,
            kind if BOUNDED_KINDS.contains(&kind) => {
                // Geometry, or geometry within a definition; not annotation, parameter space or construction.
                let is_shape = matches!(entry.usage, 0 | 2 | 3)
                    && (!entry.physically_dependent || listed.contains(&entity));
                is_shape && !used.contains(&entity)
            }
            _ => false,
        };
        if is_face {
            catalog.faces.push(entity);
        }
        if is_face || matches!(entry.kind, 186 | 408 | 514) {
            catalog.shapes.push(entity);
        }
    }
    catalog
}

/// The members of a definition (308) or a group (402); none where it cannot be read.
fn members(reader: &Reader, entity: u32, kind: u32) -> Vec<u32> {
    let Ok(parameters) = reader.file.parameters(entity) else { return Vec::new() };
    let at = if kind == 308 { 3 } else { 1 };
    let count = parameters.count(at, 1).unwrap_or(0);
    (0..count).filter_map(|i| parameters.reference(at + 1 + i).ok()).collect()
}

/// Maps everything in `catalog`; `name` is that of the whole file.
pub fn map(reader: &mut Reader, catalog: &Catalog, name: String) {
    let mut tree = Tree {
        parts: HashMap::new(),
        owned: HashSet::new(),
        shapes: catalog.shapes.iter().copied().collect(),
    };
    for &shape in &catalog.shapes {
        hide(reader, shape);
    }
    for &definition in &catalog.definitions {
        if let Err(problem) = tree.definition(reader, definition, 0) {
            reader.report(Severity::Dropped, problem);
        }
    }
    let shapes: Vec<u32> =
        catalog.shapes.iter().copied().filter(|shape| !tree.owned.contains(shape)).collect();
    let mut part = Part { name, ..Part::default() };
    tree.fill(reader, &mut part, &shapes, 0);
    if !(part.bodies.is_empty() && part.children.is_empty()) {
        let root = reader.model.parts.push(part);
        reader.model.roots.push(root);
    }
    let mut left: Vec<u32> = reader.open_faces.iter().copied().collect();
    left.sort_unstable();
    for face in left {
        let reason = "nothing that can be read refers to it".into();
        reader.drop_face(face, &Problem { entity: face, kind: reader.entry(face).kind, reason });
    }
}

/// Takes out what is blanked: a face, or all faces of a shell or a solid.
fn hide(reader: &mut Reader, shape: u32) {
    let entry = reader.entry(shape);
    if !entry.blanked || entry.kind == 408 {
        return;
    }
    let shells: Vec<u32> = match entry.kind {
        514 => vec![shape],
        186 => {
            let shells = reader.file.parameters(shape).and_then(|p| solid_shells(&p)).unwrap_or_default();
            shells.into_iter().map(|(shell, _)| shell).collect()
        }
        _ => {
            reader.hide_face(shape, "blanked");
            return;
        }
    };
    for shell in shells {
        reader.taken_shells.insert(shell);
        for (face, _) in reader.shell_faces(shell).unwrap_or_default() {
            reader.hide_face(face, "blanked with its solid");
        }
    }
}

struct Tree {
    /// Parts by definition; none while a definition is being mapped.
    parts: HashMap<u32, Option<Id<Part>>>,
    /// What belongs to some definition.
    owned: HashSet<u32>,
    shapes: HashSet<u32>,
}

impl Tree {
    /// Entity 308: depth, name, how many members, these.
    fn definition(&mut self, reader: &mut Reader, entity: u32, depth: usize) -> Mapped<Id<Part>> {
        let fail = |reason: &str| Problem { entity, kind: 308, reason: reason.into() };
        match self.parts.get(&entity) {
            Some(Some(known)) => return Ok(*known),
            Some(None) => return Err(fail("subfigures contain each other in a circle")),
            None if depth > MAX_DEPTH => return Err(fail("subfigures are nested too deeply")),
            None => {}
        }
        let parameters = reader.file.parameters(entity)?;
        if parameters.kind != 308 {
            return Err(parameters.problem("this is no subfigure definition"));
        }
        self.parts.insert(entity, None);
        let mut shapes = Vec::new();
        let mut groups = vec![(entity, 308, 0)];
        let mut seen = HashSet::new();
        while let Some((group, kind, level)) = groups.pop() {
            for member in members(reader, group, kind) {
                match reader.entry(member).kind {
                    402 if level < MAX_DEPTH && seen.insert(member) => groups.push((member, 402, level + 1)),
                    // What two definitions share belongs to the first.
                    _ if self.shapes.contains(&member) && self.owned.insert(member) => shapes.push(member),
                    _ => {}
                }
            }
        }
        let mut part = Part { name: parameters.text(2).into(), entity: entity.into(), ..Part::default() };
        self.fill(reader, &mut part, &shapes, depth);
        let id = reader.model.parts.push(part);
        self.parts.insert(entity, Some(id));
        Ok(id)
    }

    /// Puts shapes into a part: solids, then shells, then faces, then instances.
    fn fill(&mut self, reader: &mut Reader, part: &mut Part, shapes: &[u32], depth: usize) {
        let of_kind = |reader: &Reader, wanted: u32| -> Vec<u32> {
            shapes
                .iter()
                .copied()
                .filter(|shape| reader.entry(*shape).kind == wanted && !reader.entry(*shape).blanked)
                .collect()
        };
        for solid in of_kind(reader, 186) {
            let body = reader.solid(solid);
            place_body(reader, part, solid, body);
        }
        for shell in of_kind(reader, 514) {
            if !reader.taken_shells.contains(&shell) {
                let body = reader.sheet_body(shell);
                place_body(reader, part, shell, body);
            }
        }
        let faces = loose_faces(reader, shapes);
        if let Some(first) = faces.first() {
            let entity = reader.model.faces[*first].entity;
            part.bodies.push(Body { kind: BodyKind::Sheet, faces, name: String::new(), entity });
        }
        for instance in of_kind(reader, 408) {
            match self.instance(reader, instance, depth + 1) {
                Ok(child) => part.children.push(child),
                Err(problem) => reader.report(Severity::Dropped, problem),
            }
        }
    }

    /// Entity 408: the definition, a translation, a scale.
    fn instance(&mut self, reader: &mut Reader, entity: u32, depth: usize) -> Mapped<Child> {
        let parameters = reader.file.parameters(entity)?;
        let part = self.definition(reader, parameters.reference(1)?, depth)?;
        let translation = reader.unit.transform_vector3(parameters.point(2)?);
        let scale = match parameters.real(5)? {
            0.0 => 1.0,
            scale => scale,
        };
        let local = DAffine3::from_translation(translation) * DAffine3::from_scale(DVec3::splat(scale));
        let entry = reader.entry(entity);
        Ok(Child {
            part,
            parent_from_child: in_millimetres(reader, entity)? * local,
            name: style::name(&reader.file, &parameters, 6),
            // Under a global hierarchy the instance decides, else its members do.
            color: style::color(&reader.file, entity).filter(|_| entry.is_global),
            entity: entity.into(),
        })
    }
}

/// The matrix of `entity` for lengths in millimetres.
fn in_millimetres(reader: &Reader, entity: u32) -> Mapped<DAffine3> {
    let mut place = placement::of(&reader.file, entity, &DAffine3::IDENTITY)?;
    place.translation = reader.unit.transform_vector3(place.translation);
    Ok(place)
}

fn place_body(reader: &mut Reader, part: &mut Part, entity: u32, body: Mapped<Body>) {
    let placed = body.and_then(|body| in_millimetres(reader, entity).map(|place| (body, place)));
    match placed {
        Ok((body, _)) if body.faces.is_empty() => {}
        Ok((body, place)) if place == DAffine3::IDENTITY => part.bodies.push(body),
        Ok((body, parent_from_child)) => {
            let name = body.name.clone();
            let own = Part { name, bodies: vec![body], children: Vec::new(), entity: entity.into() };
            let id = reader.model.parts.push(own);
            part.children.push(Child {
                part: id,
                parent_from_child,
                name: String::new(),
                color: None,
                entity: entity.into(),
            });
        }
        Err(problem) => reader.report(Severity::Dropped, problem),
    }
}

/// Faces that belong to no shell.
fn loose_faces(reader: &mut Reader, shapes: &[u32]) -> Vec<Id<Face>> {
    let mut faces = Vec::new();
    for &shape in shapes {
        if !reader.open_faces.contains(&shape) {
            continue;
        }
        let face = if reader.entry(shape).kind == 510 {
            reader.face(shape, false, None)
        } else {
            reader.loose_face(shape, None)
        };
        match face {
            Ok(face) => {
                reader.open_faces.remove(&shape);
                faces.push(face);
            }
            Err(problem) => reader.drop_face(shape, &problem),
        }
    }
    faces
}

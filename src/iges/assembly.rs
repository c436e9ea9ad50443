//! What stands where: subfigures (308, 320) and their instances (408, 420), arrays (412, 414), assemblies (184) and instances
//! (430) of solids, groups (402), and everything that stands alone.
//!
//! The whole file is one part; a subfigure definition is another one, and so is a group that has a name, and whatever an
//! instance refers to. Solids with a matrix of their own become placed parts too. What stands alone is sorted by levels where
//! there are several: each is a part.

use super::array;
use super::catalog::{self, Catalog, PLACING, PRIMITIVES, is_group};
use super::directory::{Mapped, Parameters, Problem};
use super::level;
use super::placement;
use super::reader::Reader;
use super::solid::solid_shells;
use super::style;
use crate::brep::{Body, BodyKind, Child, Color, Face, Id, Part, Severity};
use glam::{DAffine3, DVec3};
use std::collections::{HashMap, HashSet};

/// Subfigures, groups and instances may not be nested deeper than this; deeper ones are cyclic or hostile.
const MAX_DEPTH: usize = 64;

/// Maps everything in `catalog`; `name` is that of the whole file.
pub fn map(reader: &mut Reader, catalog: &Catalog, name: String) {
    let shows_blanked = is_all_blanked(reader, catalog);
    if shows_blanked {
        let reason = "everything is blanked; shown all the same".into();
        reader.report(Severity::Warning, Problem { entity: 0, kind: 0, reason });
    } else {
        let blanked = |reader: &Reader, entity: u32| reader.entry(entity).blanked;
        let groups: Vec<u32> =
            catalog.groups.iter().copied().filter(|&group| blanked(reader, group)).collect();
        let in_blanked = reached(reader, &groups);
        for &shape in &catalog.shapes {
            if blanked(reader, shape) {
                hide(reader, shape, "blanked");
            } else if in_blanked.contains(&shape) {
                hide(reader, shape, "its group is blanked");
            }
        }
    }
    let mut tree = Tree {
        parts: HashMap::new(),
        owned: HashSet::new(),
        shapes: catalog.shapes.iter().copied().collect(),
        components: catalog.components.clone(),
        shows_blanked,
    };
    for &definition in &catalog.definitions {
        if let Err(problem) = tree.definition(reader, definition, 0) {
            reader.report(Severity::Dropped, problem);
        }
    }
    let nested: HashSet<u32> =
        catalog.groups.iter().flat_map(|&group| catalog::members(reader, group)).collect();
    let groups: Vec<u32> = catalog.groups.iter().copied().filter(|group| !nested.contains(group)).collect();
    let grouped = reached(reader, &groups);
    let mut members = tree.members(reader, &groups, None, 0);
    let stands_alone = |shape: &u32| {
        !tree.components.contains(shape) && !tree.owned.contains(shape) && !grouped.contains(shape)
    };
    let alone: Vec<u32> = catalog.shapes.iter().copied().filter(stands_alone).collect();
    let (own, levels) = level::sorted(reader, alone);
    let without_color = |entity| Member { entity, color: None };
    members.extend(own.into_iter().map(without_color));
    let mut part = Part { name, ..Part::default() };
    tree.fill(reader, &mut part, &members, 0);
    let names = if levels.is_empty() { HashMap::new() } else { level::names(reader) };
    for (number, members) in levels {
        let name = names.get(&number).cloned().unwrap_or_else(|| format!("level {number}"));
        let mut layer = Part { name, ..Part::default() };
        let members: Vec<Member> = members.into_iter().map(without_color).collect();
        tree.fill(reader, &mut layer, &members, 1);
        if !(layer.bodies.is_empty() && layer.children.is_empty()) {
            let layer = reader.model.parts.push(layer);
            part.children.push(child(layer, DAffine3::IDENTITY, String::new(), 0));
        }
    }
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

/// Everything in the groups, and in the groups in them.
fn reached(reader: &Reader, groups: &[u32]) -> HashSet<u32> {
    let mut reached = HashSet::new();
    let mut open = groups.to_vec();
    while let Some(group) = open.pop() {
        for member in catalog::members(reader, group) {
            if reached.insert(member) && is_group(&reader.entry(member)) {
                open.push(member);
            }
        }
    }
    reached
}

/// Whether nothing would be shown because of blank status alone.
fn is_all_blanked(reader: &Reader, catalog: &Catalog) -> bool {
    let entries = || catalog.shapes.iter().map(|&shape| reader.entry(shape));
    let mut tops = entries().filter(|entry| !entry.physically_dependent).peekable();
    if tops.peek().is_some() {
        tops.all(|entry| entry.blanked)
    } else {
        !catalog.shapes.is_empty() && entries().all(|entry| entry.blanked)
    }
}

/// Takes out what is blanked: a face, or all faces of a shell or a solid.
fn hide(reader: &mut Reader, shape: u32, reason: &str) {
    let entry = reader.entry(shape);
    let shells: Vec<u32> = match entry.kind {
        514 => vec![shape],
        186 => {
            let shells = reader.file.parameters(shape).and_then(|p| solid_shells(&p)).unwrap_or_default();
            shells.into_iter().map(|(shell, _)| shell).collect()
        }
        kind if PLACING.contains(&kind) || PRIMITIVES.contains(&kind) => {
            reader.report(Severity::Hidden, Problem { entity: shape, kind, reason: reason.into() });
            return;
        }
        _ => {
            reader.hide_face(shape, reason);
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

/// A shape or a named group, with the colour that it has where it has none of its own.
#[derive(Debug, Clone, Copy)]
struct Member {
    entity: u32,
    color: Option<Color>,
}

struct Tree {
    /// Parts by what they are made of; none while that is being mapped.
    parts: HashMap<u32, Option<Id<Part>>>,
    /// What belongs to some definition or group.
    owned: HashSet<u32>,
    shapes: HashSet<u32>,
    /// What stands nowhere by itself.
    components: HashSet<u32>,
    shows_blanked: bool,
}

impl Tree {
    /// Entities 308 and 320: depth, name, how many members, these.
    fn definition(&mut self, reader: &mut Reader, entity: u32, depth: usize) -> Mapped<Id<Part>> {
        self.once(reader, entity, depth, |tree, reader| {
            let parameters = reader.file.parameters(entity)?;
            if !matches!(parameters.kind, 308 | 320) {
                return Err(parameters.problem("this is no subfigure definition"));
            }
            let color = style::color(&reader.file, entity);
            let members = catalog::members(reader, entity);
            let members = tree.members(reader, &members, color, depth);
            let mut part = Part { name: parameters.text(2).into(), entity: entity.into(), ..Part::default() };
            tree.fill(reader, &mut part, &members, depth);
            Ok(part)
        })
    }

    /// The part that an instance, an array or an assembly places: a definition, or a part that holds one shape.
    fn placed(&mut self, reader: &mut Reader, entity: u32, depth: usize) -> Mapped<Id<Part>> {
        let entry = reader.entry(entity);
        if matches!(entry.kind, 308 | 320) {
            return self.definition(reader, entity, depth);
        }
        if !(self.shapes.contains(&entity) || is_group(&entry)) {
            let reason = "what it places is no shape that can be read".into();
            return Err(Problem { entity, kind: entry.kind, reason });
        }
        self.once(reader, entity, depth, |tree, reader| {
            let mut part = Part { name: style::label(&reader.file, entity), ..Part::default() };
            part.entity = entity.into();
            tree.fill(reader, &mut part, &[Member { entity, color: None }], depth);
            Ok(part)
        })
    }

    /// The part of `entity`, made by `make` unless it is known.
    fn once(
        &mut self,
        reader: &mut Reader,
        entity: u32,
        depth: usize,
        make: impl FnOnce(&mut Self, &mut Reader) -> Mapped<Part>,
    ) -> Mapped<Id<Part>> {
        let fail = |reason: &str| Problem { entity, kind: reader.entry(entity).kind, reason: reason.into() };
        match self.parts.get(&entity) {
            Some(Some(known)) => return Ok(*known),
            Some(None) => return Err(fail("it contains itself")),
            None if depth > MAX_DEPTH => return Err(fail("it is nested too deeply")),
            None => {}
        }
        self.parts.insert(entity, None);
        let part = make(self, reader)?;
        let id = reader.model.parts.push(part);
        self.parts.insert(entity, Some(id));
        Ok(id)
    }

    /// The shapes and the named groups among `entities`, and the shapes in their groups without names. What two groups or
    /// definitions share belongs to the first.
    fn members(
        &mut self,
        reader: &Reader,
        entities: &[u32],
        color: Option<Color>,
        depth: usize,
    ) -> Vec<Member> {
        let mut members = Vec::new();
        let mut open: Vec<(u32, Option<Color>, usize)> =
            entities.iter().rev().map(|&entity| (entity, color, depth)).collect();
        while let Some((entity, color, level)) = open.pop() {
            let group = is_group(&reader.entry(entity));
            let is_member = group || (self.shapes.contains(&entity) && !self.components.contains(&entity));
            if !is_member || !self.owned.insert(entity) {
                continue;
            }
            if group && group_name(reader, entity).is_empty() && level < MAX_DEPTH {
                let color = style::color(&reader.file, entity).or(color);
                let inner = catalog::members(reader, entity);
                open.extend(inner.into_iter().rev().map(|entity| (entity, color, level + 1)));
            } else {
                members.push(Member { entity, color });
            }
        }
        members
    }

    /// Puts shapes into a part: solids, then shells, then faces, then what places other parts.
    fn fill(&mut self, reader: &mut Reader, part: &mut Part, members: &[Member], depth: usize) {
        let shown: Vec<(Member, u32)> = members
            .iter()
            .map(|member| (*member, reader.entry(member.entity)))
            .filter(|(_, entry)| self.shows_blanked || !entry.blanked)
            .map(|(member, entry)| (member, entry.kind))
            .collect();
        for (Member { entity, color }, kind) in &shown {
            let body = match kind {
                186 => reader.solid(*entity, *color),
                kind if PRIMITIVES.contains(kind) => reader.constructive(*entity, *color),
                _ => continue,
            };
            place_body(reader, part, *entity, body);
        }
        for (Member { entity, color }, kind) in &shown {
            if *kind == 514 && !reader.taken_shells.contains(entity) {
                let body = reader.sheet_body(*entity, *color);
                place_body(reader, part, *entity, body);
            }
        }
        let faces = loose_faces(reader, members);
        if let Some(first) = faces.first() {
            let entity = reader.model.faces[*first].entity;
            part.bodies.push(Body { kind: BodyKind::Sheet, faces, name: String::new(), entity });
        }
        for (Member { entity, color }, kind) in shown {
            let children = match kind {
                402 => self.group(reader, entity, color, depth + 1),
                kind if PLACING.contains(&kind) => self.children(reader, entity, depth + 1),
                _ => continue,
            };
            match children {
                Ok(children) => part.children.extend(children),
                Err(problem) => reader.report(Severity::Dropped, problem),
            }
        }
    }

    /// A group with a name.
    fn group(
        &mut self,
        reader: &mut Reader,
        entity: u32,
        color: Option<Color>,
        depth: usize,
    ) -> Mapped<Vec<Child>> {
        let part = self.once(reader, entity, depth, |tree, reader| {
            let color = style::color(&reader.file, entity).or(color);
            let members = catalog::members(reader, entity);
            let members = tree.members(reader, &members, color, depth);
            let name = group_name(reader, entity);
            let mut part = Part { name, entity: entity.into(), ..Part::default() };
            tree.fill(reader, &mut part, &members, depth);
            Ok(part)
        })?;
        let inner = &reader.model.parts[part];
        let is_empty = inner.bodies.is_empty() && inner.children.is_empty();
        Ok(if is_empty { Vec::new() } else { vec![child(part, DAffine3::IDENTITY, String::new(), entity)] })
    }

    /// What an instance, an array or an assembly places.
    fn children(&mut self, reader: &mut Reader, entity: u32, depth: usize) -> Mapped<Vec<Child>> {
        let parameters = reader.file.parameters(entity)?;
        let own = in_millimetres(reader, entity)?;
        let entry = reader.entry(entity);
        // Under a global hierarchy the instance decides, else its members do.
        let color = style::color(&reader.file, entity).filter(|_| entry.is_global);
        let mut children = match entry.kind {
            184 => self.assembly(reader, &parameters, depth)?,
            180 => match catalog::tree_operands(&parameters).as_slice() {
                [single] => vec![child(
                    self.placed(reader, *single, depth)?,
                    DAffine3::IDENTITY,
                    String::new(),
                    entity,
                )],
                // Said once for all.
                _ => Vec::new(),
            },
            412 | 414 => {
                let part = self.placed(reader, parameters.reference(1)?, depth)?;
                let copies = array::copies(&parameters)?;
                let copy = |place: &DAffine3| child(part, scaled(reader, place), String::new(), entity);
                copies.iter().map(copy).collect()
            }
            430 => {
                let part = self.placed(reader, parameters.reference(1)?, depth)?;
                vec![child(part, DAffine3::IDENTITY, style::name(&reader.file, &parameters, 2), entity)]
            }
            _ => {
                let part = self.definition(reader, parameters.reference(1)?, depth)?;
                let (scale, after) = instance_scale(&parameters)?;
                let place = DAffine3::from_translation(parameters.point(2)?) * DAffine3::from_scale(scale);
                let name = style::name(&reader.file, &parameters, after);
                vec![child(part, scaled(reader, &place), name, entity)]
            }
        };
        for child in &mut children {
            child.parent_from_child = own * child.parent_from_child;
            child.color = color;
        }
        Ok(children)
    }

    /// Entity 184: how many items, these, a matrix or nothing for each.
    fn assembly(&mut self, reader: &mut Reader, parameters: &Parameters, depth: usize) -> Mapped<Vec<Child>> {
        let entity = parameters.entity;
        let count = parameters.count(1, 2)?;
        let part = self.once(reader, entity, depth, |tree, reader| {
            let name = style::name(&reader.file, parameters, 2 + 2 * count);
            let mut part = Part { name, entity: entity.into(), ..Part::default() };
            for i in 0..count {
                let item = parameters.reference(2 + i)?;
                let place = match parameters.pointer(2 + count + i)? {
                    0 => DAffine3::IDENTITY,
                    matrix => placement::chain(&reader.file, matrix)?,
                };
                match tree.placed(reader, item, depth + 1) {
                    Ok(inner) => {
                        let name = String::new();
                        part.children.push(child(inner, scaled(reader, &place), name, item));
                    }
                    Err(problem) => reader.report(Severity::Dropped, problem),
                }
            }
            Ok(part)
        })?;
        Ok(vec![child(part, DAffine3::IDENTITY, String::new(), entity)])
    }
}

/// The name of a group.
fn group_name(reader: &Reader, entity: u32) -> String {
    let Ok(parameters) = reader.file.parameters(entity) else { return String::new() };
    let count = parameters.count(1, 1).unwrap_or(0);
    style::name(&reader.file, &parameters, 2 + count)
}

/// The scale of an instance and where its parameters end: one factor (408), or three, of which the second and third default to
/// the one before, with four more parameters and as many points to connect as the first of them says (420).
fn instance_scale(parameters: &Parameters) -> Mapped<(DVec3, usize)> {
    let or = |value: f64, default: f64| if value == 0.0 { default } else { value };
    let x = or(parameters.real(5)?, 1.0);
    if parameters.kind == 408 {
        return Ok((DVec3::splat(x), 6));
    }
    let y = or(parameters.real(6)?, x);
    let z = or(parameters.real(7)?, y);
    Ok((DVec3::new(x, y, z), 12 + parameters.count(11, 1).unwrap_or(0)))
}

fn child(part: Id<Part>, parent_from_child: DAffine3, name: String, entity: u32) -> Child {
    Child { part, parent_from_child, name, color: None, entity: entity.into() }
}

/// A placement in the file's units, for lengths in millimetres.
fn scaled(reader: &Reader, place: &DAffine3) -> DAffine3 {
    DAffine3 { translation: reader.unit.transform_vector3(place.translation), ..*place }
}

/// The matrix of `entity` for lengths in millimetres.
fn in_millimetres(reader: &Reader, entity: u32) -> Mapped<DAffine3> {
    Ok(scaled(reader, &placement::of(&reader.file, entity, &DAffine3::IDENTITY)?))
}

fn place_body(reader: &mut Reader, part: &mut Part, entity: u32, body: Mapped<Body>) {
    let placed = body.and_then(|body| in_millimetres(reader, entity).map(|place| (body, place)));
    match placed {
        Ok((body, _)) if body.faces.is_empty() => {}
        Ok((body, place)) if place == DAffine3::IDENTITY => part.bodies.push(body),
        Ok((body, place)) => {
            let name = body.name.clone();
            let own = Part { name, bodies: vec![body], children: Vec::new(), entity: entity.into() };
            let id = reader.model.parts.push(own);
            part.children.push(child(id, place, String::new(), entity));
        }
        Err(problem) => reader.report(Severity::Dropped, problem),
    }
}

/// Faces that belong to no shell.
fn loose_faces(reader: &mut Reader, members: &[Member]) -> Vec<Id<Face>> {
    let mut faces = Vec::new();
    for &Member { entity, color } in members {
        if !reader.open_faces.contains(&entity) {
            continue;
        }
        let face = if reader.entry(entity).kind == 510 {
            reader.face(entity, false, color)
        } else {
            reader.loose_face(entity, color)
        };
        match face {
            Ok(face) => {
                reader.open_faces.remove(&entity);
                faces.push(face);
            }
            Err(problem) => reader.drop_face(entity, &problem),
        }
    }
    faces
}

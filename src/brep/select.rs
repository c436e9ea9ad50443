//! Part of a model: what is chosen stays, what is hidden goes, the rest of the tree keeps its names.
//!
//! Parts that are shown whole stay shared. A part of whose placements only some are shown, or shown whole, becomes a part of its own for
//! each of its placements on the way down; copies share the faces.

use super::{Child, Diagnostic, Face, Id, Model, Part};
use std::collections::HashSet;

/// What can be chosen and hidden.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subject<'a> {
    /// A place in the product tree, and all that is below it.
    Place {
        /// Names from the root, joined by `/`.
        path: &'a str,
        /// The last of them.
        name: &'a str,
        /// The file's entity numbers of the part and of its placement; 0 for a root's placement.
        entities: [u64; 2],
    },
    /// A body, by the file's entity number, wherever its part stands.
    Body(u64),
    /// A face, by the file's entity number, wherever its part stands.
    Face(u64),
}

/// Answers whether something is meant.
pub type Test<'t> = &'t dyn Fn(Subject<'_>) -> bool;

/// The walk over places ends after as much: shared subtrees may be exponentially many.
const MOST_PLACES: usize = 4_000_000;

/// A product tree may not be deeper than this.
const MAX_DEPTH: usize = 128;

/// Tells `visit` every place, body and face that [`select`] may ask for, those of parts that stand nowhere left out.
pub fn subjects(model: &Model, visit: &mut dyn FnMut(Subject<'_>)) {
    let mut parts: HashSet<Id<Part>> = HashSet::new();
    let mut left = MOST_PLACES;
    let root =
        |&root: &Id<Part>| (root, model.parts[root].name.clone(), model.parts[root].name.as_str(), 0, 0);
    let mut open: Vec<(Id<Part>, String, &str, usize, u64)> = model.roots.iter().rev().map(root).collect();
    while let Some((id, path, name, depth, placement)) = open.pop() {
        if left == 0 || depth >= MAX_DEPTH {
            continue;
        }
        left -= 1;
        let part = &model.parts[id];
        visit(Subject::Place { path: &path, name, entities: [part.entity, placement] });
        if parts.insert(id) {
            for body in &part.bodies {
                visit(Subject::Body(body.entity));
                body.faces.iter().for_each(|&face| visit(Subject::Face(model.faces[face].entity)));
            }
        }
        for child in part.children.iter().rev() {
            let name = name_of(model, child);
            open.push((child.part, format!("{path}/{name}"), name, depth + 1, child.entity));
        }
    }
}

/// Leaves of `model` what `only` means and `hide` does not; without `only`, what `hide` does not mean.
///
/// Whatever is below a place that is meant is meant too. Where `only` means a face or a body, it stays wherever its part stands, alone unless the part is meant
/// as a whole somewhere. Faces that go are in the diagnostics as hidden.
pub fn select(model: &mut Model, only: Option<Test<'_>>, hide: Test<'_>) {
    let before = reachable(model);
    let has_meant_faces: Vec<bool> =
        model.parts.iter().map(|part| has_meant_faces(model, part, only)).collect();
    let mut walk = Walk {
        model,
        only,
        hide,
        has_meant_faces: &has_meant_faces,
        copies: Vec::new(),
        meant: HashSet::new(),
        left: MOST_PLACES,
    };
    let mut roots = Vec::new();
    for &root in &model.roots {
        let name = model.parts[root].name.clone();
        if let Some(part) = walk.place(root, &name, &name, 0, false, 0) {
            roots.push(part);
        }
    }
    let Walk { copies, meant, .. } = walk;
    model.roots = roots;
    for copy in copies {
        model.declared_faces += copy.bodies.iter().map(|body| body.faces.len()).sum::<usize>();
        model.parts.push(copy);
    }
    hide_faces(model, only, hide, &meant);
    let after = reachable(model);
    model.hidden_parts.extend(before.difference(&after));
    model.hidden_parts.sort_unstable();
    model.hidden_parts.dedup();
}

/// Whether `only` means faces or bodies of a part.
fn has_meant_faces(model: &Model, part: &Part, only: Option<Test<'_>>) -> bool {
    let Some(only) = only else { return false };
    let is_meant = |face: &Id<Face>| only(Subject::Face(model.faces[*face].entity));
    let mut bodies = part.bodies.iter();
    bodies.any(|body| only(Subject::Body(body.entity)) || body.faces.iter().any(is_meant))
}

struct Walk<'m, 't> {
    model: &'m Model,
    only: Option<Test<'t>>,
    hide: Test<'t>,
    /// By part: [`has_meant_faces`].
    has_meant_faces: &'m [bool],
    /// Parts with fewer children or bodies; their ids follow those of the model.
    copies: Vec<Part>,
    /// Parts that are meant as a whole somewhere, copies included.
    meant: HashSet<Id<Part>>,
    left: usize,
}

impl Walk<'_, '_> {
    /// What stands at a place after the choice; nothing where nothing is left.
    fn place(
        &mut self,
        id: Id<Part>,
        path: &str,
        name: &str,
        placement: u64,
        is_meant: bool,
        depth: usize,
    ) -> Option<Id<Part>> {
        // What exceeds the limits stays as it is; the bake cuts it off.
        if self.left == 0 || depth >= MAX_DEPTH {
            return Some(id);
        }
        self.left -= 1;
        let part = &self.model.parts[id];
        let subject = Subject::Place { path, name, entities: [part.entity, placement] };
        if (self.hide)(subject) {
            return None;
        }
        let is_meant = is_meant || self.only.is_none_or(|only| only(subject));
        let keeps_bodies = is_meant || self.has_meant_faces[id.index()];
        let mut is_whole = keeps_bodies || part.bodies.is_empty();
        let mut children: Vec<Child> = Vec::with_capacity(part.children.len());
        for child in &part.children {
            let name = name_of(self.model, child);
            let below =
                self.place(child.part, &format!("{path}/{name}"), name, child.entity, is_meant, depth + 1);
            is_whole &= below == Some(child.part);
            children.extend(below.map(|part| Child { part, name: name.to_owned(), ..child.clone() }));
        }
        let has_bodies = keeps_bodies && !part.bodies.is_empty();
        let kept = if is_whole {
            id
        } else if has_bodies || !children.is_empty() {
            let bodies = if has_bodies { part.bodies.clone() } else { Vec::new() };
            self.copies.push(Part { name: part.name.clone(), bodies, children, entity: part.entity });
            Id::new(self.model.parts.len() + self.copies.len() - 1)
        } else {
            return None;
        };
        if is_meant {
            self.meant.insert(kept);
        }
        Some(kept)
    }
}

fn name_of<'m>(model: &'m Model, child: &'m Child) -> &'m str {
    if child.name.is_empty() { &model.parts[child.part].name } else { &child.name }
}

/// The parts that stand somewhere.
fn reachable(model: &Model) -> HashSet<Id<Part>> {
    let mut found: HashSet<Id<Part>> = HashSet::new();
    let mut open = model.roots.clone();
    while let Some(id) = open.pop() {
        if found.insert(id) {
            open.extend(model.parts[id].children.iter().map(|child| child.part));
        }
    }
    found
}

/// Takes faces out of the parts that stand somewhere.
fn hide_faces(model: &mut Model, only: Option<Test<'_>>, hide: Test<'_>, meant: &HashSet<Id<Part>>) {
    let mut standing: Vec<Id<Part>> = reachable(model).into_iter().collect();
    standing.sort_unstable();
    for id in standing {
        let only = only.filter(|_| !meant.contains(&id));
        for index in 0..model.parts[id].bodies.len() {
            let body = &model.parts[id].bodies[index];
            let is_hidden = hide(Subject::Body(body.entity));
            let body_is_meant = only.is_none_or(|only| only(Subject::Body(body.entity)));
            let stays = |face: &Id<Face>| {
                let subject = Subject::Face(model.faces[*face].entity);
                !is_hidden && (body_is_meant || only.is_none_or(|only| only(subject))) && !hide(subject)
            };
            let (stay, go): (Vec<Id<Face>>, Vec<Id<Face>>) = body.faces.iter().partition(|face| stays(face));
            for face in go {
                let entity = model.faces[face].entity;
                model.diagnostics.push(Diagnostic::hidden_face(entity, "ADVANCED_FACE", "it is not wanted"));
            }
            model.parts[id].bodies[index].faces = stay;
        }
        model.parts[id].bodies.retain(|body| !body.faces.is_empty());
    }
}

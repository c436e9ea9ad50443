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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::{Body, BodyKind, occurrences};
    use crate::geometry::{Frame, Surface};
    use glam::DAffine3;

    fn child(part: Id<Part>, name: &str, entity: u64) -> Child {
        Child { part, parent_from_child: DAffine3::IDENTITY, name: name.into(), color: None, entity }
    }

    /// car ── left, right: wheel ── rim (2 faces: #10, #11), bolt a, bolt b (1 face: #12).
    fn car() -> Model {
        let mut model = Model { declared_faces: 3, ..Model::default() };
        let surface = model.surfaces.push(Surface::Plane { frame: Frame::IDENTITY });
        let mut face = |entity: u64| {
            let loops = Vec::new();
            model.faces.push(Face {
                surface,
                same_sense: true,
                loops,
                color: None,
                name: String::new(),
                entity,
            })
        };
        let [rim, bolt] = [vec![face(10), face(11)], vec![face(12)]].map(|faces| {
            let body = Body { kind: BodyKind::Sheet, faces, name: String::new(), entity: 20 };
            Part { bodies: vec![body], ..Part::default() }
        });
        let rim = model.parts.push(Part { name: "rim".into(), entity: 30, ..rim });
        let bolt = model.parts.push(Part { name: "bolt".into(), entity: 31, ..bolt });
        let children = vec![child(rim, "", 40), child(bolt, "a", 41), child(bolt, "b", 42)];
        let wheel = model.parts.push(Part { name: "wheel".into(), children, entity: 32, ..Part::default() });
        let children = vec![child(wheel, "left", 43), child(wheel, "right", 44)];
        let car = model.parts.push(Part { name: "car".into(), children, entity: 33, ..Part::default() });
        model.roots.push(car);
        model
    }

    fn paths(model: &Model) -> Vec<String> {
        occurrences(model).0.into_iter().map(|occurrence| occurrence.path).collect()
    }

    fn named(wanted: &'static str) -> impl Fn(Subject<'_>) -> bool {
        move |subject| matches!(subject, Subject::Place { path, name, .. } if path == wanted || name == wanted)
    }

    fn entity(wanted: u64) -> impl Fn(Subject<'_>) -> bool {
        move |subject| match subject {
            Subject::Place { entities, .. } => entities.contains(&wanted),
            Subject::Body(entity) | Subject::Face(entity) => entity == wanted,
        }
    }

    const NOTHING: Test<'static> = &|_| false;

    #[test]
    fn one_placement_of_a_shared_part_can_go() {
        let mut model = car();
        select(&mut model, None, &named("car/left/a"));
        assert_eq!(
            paths(&model),
            ["car/left/rim", "car/left/b", "car/right/rim", "car/right/a", "car/right/b"]
        );
        let parts: HashSet<usize> = occurrences(&model).0.iter().map(|o| o.part.index()).collect();
        assert_eq!(parts.len(), 2, "rim and bolt are still shared");
        assert_eq!(model.declared_faces, 3);
        assert!(
            model.hidden_parts.iter().all(|&part| model.parts[part].bodies.is_empty()),
            "no shape is hidden"
        );
    }

    #[test]
    fn only_what_is_meant_and_not_hidden_stays() {
        let mut model = car();
        select(&mut model, Some(&named("right")), &named("rim"));
        assert_eq!(paths(&model), ["car/right/a", "car/right/b"]);
        assert!(model.hidden_parts.contains(&Id::new(0)), "the rim is hidden");
        let mut model = car();
        select(&mut model, Some(&entity(42)), NOTHING);
        assert_eq!(paths(&model), ["car/left/b", "car/right/b"]);
        let mut model = car();
        select(&mut model, None, &entity(33));
        assert_eq!(paths(&model), [""; 0]);
    }

    #[test]
    fn faces_go_and_stay_by_their_numbers() {
        let hidden = |model: &Model| model.diagnostics.iter().map(|d| d.faces).sum::<u32>();
        let mut model = car();
        select(&mut model, None, &entity(10));
        assert_eq!((paths(&model).len(), hidden(&model)), (6, 1));
        assert_eq!(model.parts[Id::new(0)].bodies[0].faces, [Id::new(1)]);
        let mut model = car();
        select(&mut model, Some(&entity(11)), NOTHING);
        assert_eq!(paths(&model), ["car/left/rim", "car/right/rim"]);
        assert_eq!((model.parts[Id::new(0)].bodies[0].faces.len(), hidden(&model)), (1, 1));
        let both = |subject: Subject<'_>| entity(11)(subject) || named("left")(subject);
        let mut model = car();
        select(&mut model, Some(&both), NOTHING);
        assert_eq!(paths(&model), ["car/left/rim", "car/left/a", "car/left/b", "car/right/rim"]);
        assert_eq!(model.parts[Id::new(0)].bodies[0].faces.len(), 2, "meant as a whole on the left");
    }

    #[test]
    fn every_subject_is_told() {
        let mut found = Vec::new();
        subjects(&car(), &mut |subject| {
            found.push(match subject {
                Subject::Place { path, name, .. } => {
                    assert!(path.ends_with(name));
                    path.to_owned()
                }
                Subject::Body(entity) | Subject::Face(entity) => entity.to_string(),
            });
        });
        let expected =
            ["car", "car/left", "car/left/rim", "20", "10", "11", "car/left/a", "20", "12", "car/left/b"];
        assert_eq!(found[..10], expected);
        assert_eq!(found.len(), 14);
    }
}

//! What is chosen of a small product tree.

use super::select::{Subject, Test, select, subjects};
use super::{Child, Face, Id, Model, Part};
use crate::brep::{Body, BodyKind, occurrences};
use crate::geometry::{Frame, Surface};
use glam::DAffine3;
use std::collections::HashSet;

fn child(part: Id<Part>, name: &str, entity: u64) -> Child {
    Child { part, parent_from_child: DAffine3::IDENTITY, name: name.into(), color: None, entity }
}

/// car ── left, right: wheel ── rim (2 faces: #10, #11), bolt a, bolt b (1 face: #12).
fn car() -> Model {
    let mut model = Model { declared_faces: 3, ..Model::default() };
    let surface = model.surfaces.push(Surface::Plane { frame: Frame::IDENTITY });
    let mut face = |entity: u64| {
        let loops = Vec::new();
        model.faces.push(Face { surface, same_sense: true, loops, color: None, name: String::new(), entity })
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
    assert_eq!(paths(&model), ["car/left/rim", "car/left/b", "car/right/rim", "car/right/a", "car/right/b"]);
    let parts: HashSet<usize> = occurrences(&model).0.iter().map(|o| o.part.index()).collect();
    assert_eq!(parts.len(), 2, "rim and bolt are still shared");
    assert_eq!(model.declared_faces, 3);
    assert!(model.hidden_parts.iter().all(|&part| model.parts[part].bodies.is_empty()), "no shape is hidden");
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

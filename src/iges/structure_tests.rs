//! What stands where, and what it is called and coloured: solids, subfigures, arrays, assemblies, groups, status.

use super::tests::*;
use crate::brep::{Severity, occurrences};
use crate::trimming::{TrimOptions, trim_face};
use glam::DVec3;

#[test]
fn a_solid() {
    let mut entities = tetrahedron(top(186, "41,1,0,0,1,45").color(-47));
    entities.push(part(406, "1,5Hpiece").form(15));
    entities.push(top(314, "100,50,0,6Horange").form(0));
    let model = clean(&entities);
    assert_eq!((model.faces.len(), model.edges.len(), model.vertices.len()), (4, 6, 4));
    let body = &model.parts[model.roots[0]].bodies[0];
    assert_eq!((body.name.as_str(), body.kind), ("piece", crate::brep::BodyKind::Solid));
    for (id, face) in model.faces.ids().zip(model.faces.iter()) {
        assert_eq!(face.color.map(|c| c.rgb), Some([1.0, 0.5, 0.0]));
        assert!(trim_face(&model, id, &TrimOptions::default()).is_ok());
    }
}

#[test]
fn subfigures_are_parts() {
    let mut entities = tetrahedron(part(186, "41,1,0"));
    entities.push(part(308, "0,4Hbolt,1,43"));
    entities.push(top(408, "45,10,0,0,2."));
    entities.push(top(408, "45,20,0,0"));
    let model = clean(&entities);
    let (places, _) = occurrences(&model);
    assert_eq!((places.len(), model.faces.len()), (2, 4));
    assert_eq!(places[0].world_from_part.transform_point3(DVec3::X), DVec3::new(12.0, 0.0, 0.0));
    assert_eq!(places[1].world_from_part.transform_point3(DVec3::X), DVec3::new(21.0, 0.0, 0.0));
    assert!(places.iter().all(|place| place.path.ends_with("bolt")));
}

#[test]
fn a_placed_solid_is_a_placed_part() {
    let mut entities = tetrahedron(top(186, "41,1,0").transform(45));
    entities.push(part(124, "1,0,0,0,0,1,0,0,0,0,1,7"));
    let model = clean(&entities);
    let (places, _) = occurrences(&model);
    assert_eq!(places[0].world_from_part.translation, DVec3::new(0.0, 0.0, 7.0));
}

/// Where the parts with bodies stand.
fn places(entities: &[Entity]) -> Vec<DVec3> {
    let (places, _) = occurrences(&clean(entities));
    places.iter().map(|place| place.world_from_part.transform_point3(DVec3::X)).collect()
}

#[test]
fn nested_and_scaled_subfigures() {
    let entities = [
        part(308, "1,5Houter,2,5,7"),
        part(308, "0,5Hinner,1,9"),
        part(408, "3,10,0,0,2."),
        part(408, "3,0,10,0").transform(13),
        part(158, "1"),
        top(408, "1,100,0,0,3."),
        part(124, "0,-1,0,0,1,0,0,0,0,0,1,5"),
    ];
    // X is scaled by 2 and moved to 12, then by 3 to 36 + 100; or moved to (1, 10), turned to (−10, 1, 5), scaled and moved.
    assert_eq!(places(&entities), [DVec3::new(136.0, 0.0, 0.0), DVec3::new(70.0, 3.0, 15.0)]);
}

#[test]
fn network_subfigures() {
    let entities = [part(320, "0,4Hplug,1,3,0,,0,0"), part(158, "1"), top(420, "1,10,0,0,2.,,3.,0,,0,0")];
    assert_eq!(places(&entities), [DVec3::new(12.0, 0.0, 0.0)]);
}

#[test]
fn arrays() {
    let base = || part(158, "1");
    // Two columns and three rows without the third copy, turned by a quarter.
    let turned = std::f64::consts::FRAC_PI_2;
    let entities = [top(412, &format!("3,2.,1,0,0,2,3,10,100,{turned:.17},1,1,3")), base()];
    let found = places(&entities);
    let expected = [[3.0, 0.0], [3.0, 10.0], [-97.0, 10.0], [-197.0, 0.0], [-197.0, 10.0]];
    for (found, [x, y]) in found.iter().zip(expected) {
        assert!(found.distance(DVec3::new(x, y, 0.0)) < 1e-12, "{found}");
    }
    assert_eq!(found.len(), 5);
    // Three of four on a circle of radius 2 around (5, 0, 1).
    let circle = format!("3,4,5,0,1,2,0,{turned:.17},3,0,1,2,3");
    let found = places(&[top(414, &circle), base()]);
    let expected = [[8.0, 0.0], [6.0, 2.0], [4.0, 0.0]];
    for (found, [x, y]) in found.iter().zip(expected) {
        assert!(found.distance(DVec3::new(x, y, 1.0)) < 1e-12, "{found}");
    }
    assert_eq!(found.len(), 3);
    for hostile in ["3,1,0,0,0,100000,100000,1,1,0,0", "3,1,0,0,0,-1,3,1,1,0,0", "99,1,0,0,0,1,1,1,1,0,0"] {
        assert_eq!(model(&[top(412, hostile), base()]).diagnostics.len(), 1, "{hostile}");
    }
}

#[test]
fn external_files_are_named() {
    let model = model(&[top(416, "9Hother.igs,4Hpart")]);
    assert!(model.diagnostics[0].reason.contains("other.igs"));
    assert_eq!(model.diagnostics[0].severity, Severity::Dropped);
}

#[test]
fn levels_sort_what_stands_alone() {
    let face = || top(128, BILINEAR);
    let entities = [
        face().level(3),
        face(),
        face().level(-9),
        face().level(3),
        part(406, "2,7,3").form(1),
        part(406, "2,1,4Hhull").form(3).level(7),
        face().level(-99),
    ];
    let model = clean(&entities);
    let (places, _) = occurrences(&model);
    let found: Vec<(&str, usize)> = places
        .iter()
        .map(|place| {
            (place.path.as_str(), model.parts[place.part].bodies.iter().map(|b| b.faces.len()).sum())
        })
        .collect();
    assert_eq!(found.len(), 3, "{found:?}");
    for (name, faces) in [("level 3", 2), ("hull", 1)] {
        assert!(found.iter().any(|(path, count)| path.ends_with(name) && *count == faces), "{found:?}");
    }
    // On one level alone nothing is to be sorted.
    let (places, _) = occurrences(&clean(&[face().level(3), face().level(3)]));
    assert_eq!(places.len(), 1);
}

#[test]
fn groups_give_names_and_colours() {
    // A named group with a coloured one inside, which has no name; one face has its own colour.
    let entities = [
        top(402, "2,3,5,0,1,13").form(7).color(5),
        top(128, BILINEAR),
        top(402, "2,7,9").form(14).color(2),
        top(128, BILINEAR),
        top(128, BILINEAR).color(4),
        top(128, BILINEAR),
        part(406, "1,6Hbonnet").form(15),
    ];
    let model = clean(&entities);
    let root = &model.parts[model.roots[0]];
    let group = &model.parts[root.children[0].part];
    assert_eq!(
        (group.name.as_str(), group.bodies[0].faces.len(), root.bodies[0].faces.len()),
        ("bonnet", 3, 1)
    );
    let color = |entity: u64| {
        model.faces.iter().find(|face| face.entity == entity).and_then(|face| face.color).map(|c| c.rgb)
    };
    assert_eq!(color(3), Some([1.0, 1.0, 0.0]));
    assert_eq!(color(7), Some([1.0, 0.0, 0.0]));
    assert_eq!(color(9), Some([0.0, 0.0, 1.0]));
    assert_eq!(color(11), None);
}

#[test]
fn labels_are_names() {
    let mut lines = lines(MILLIMETRES, &[top(128, BILINEAR), top(158, "1")]);
    for (line, label) in [("D      2", "PATCH          7"), ("D      4", "BALL            ")] {
        let line = lines.iter_mut().find(|l| l[72..] == *line).expect("a directory record");
        line.replace_range(56..72, label);
    }
    let model = super::read(lines.join("\n").as_bytes()).expect("an IGES file");
    assert_eq!(model.faces.iter().map(|f| f.name.as_str()).collect::<Vec<_>>(), ["", "PATCH(7)"]);
    assert_eq!(model.parts[model.roots[0]].bodies[0].name, "BALL");
}

#[test]
fn what_nothing_uses_is_shown() {
    let patch = |status| entity(128, status, BILINEAR);
    // A part of something that is not there is shown; a part of a curve on it is not, unless it is a surface in its own right.
    assert_eq!(clean(&[patch("00010000")]).faces.len(), 1);
    let on_curve = |status| [patch(status), top(142, "0,1,5,0,1"), entity(110, FLAT, "0,0,0,1,1,0")];
    assert_eq!(model(&on_curve("00010000")).faces.len(), 0);
    assert_eq!(model(&on_curve("00000000")).faces.len(), 1);
    // Annotation and construction are no shape.
    assert_eq!(clean(&[patch("00000100")]).faces.len() + clean(&[patch("00000600")]).faces.len(), 0);
}

#[test]
fn blanked_shape_is_hidden_unless_there_is_nothing_else() {
    let patch = |status| entity(128, status, BILINEAR);
    let hidden = model(&[patch("01000000"), patch("00000000"), entity(158, "01000000", "1")]);
    assert_eq!((hidden.declared_faces, hidden.faces.len()), (2, 1));
    assert!(hidden.diagnostics.iter().all(|d| d.severity == Severity::Hidden));
    let shown = model(&[patch("01000000")]);
    assert_eq!((shown.faces.len(), shown.diagnostics[0].severity), (1, Severity::Warning));
}

#[test]
fn files_without_surfaces_say_what_they_hold() {
    let wires = model(&[top(110, "0,0,0,1,0,0"), top(100, "0,0,0,1,0,1,0"), top(116, "0,0,0")]);
    assert_eq!(wires.declared_faces, 0);
    let reasons: Vec<&str> = wires.diagnostics.iter().map(|d| d.reason.as_str()).collect();
    assert!(reasons[0].starts_with("2 curves") && reasons[1].starts_with("1 points"), "{reasons:?}");
    assert!(wires.diagnostics.iter().all(|d| d.severity == Severity::Warning));
}

#[test]
fn shells_voids_and_instances_of_solids() {
    // The same shell as a void of itself is taken once.
    let mut entities = tetrahedron(part(186, "41,1,1,41,0"));
    entities.push(top(430, "43").transform(47));
    entities.push(part(124, "1,0,0,5,0,1,0,0,0,0,1,0"));
    assert_eq!(places(&entities), [DVec3::new(6.0, 0.0, 0.0)]);
}

#[test]
fn loops_with_vertices_and_parameter_curves() {
    // A sphere whose loop is a pole, and a face of a tetrahedron with parameter curves beside its edges.
    let pole = [
        part(502, "1,0,0,2").form(1),
        part(116, "0,0,0"),
        part(196, "3,2"),
        part(508, "1,1,1,1,1,0").form(1),
        part(510, "5,1,1,7").form(1),
        top(514, "1,9,1").form(1),
    ];
    let model = clean(&pole);
    assert!(trim_face(&model, crate::brep::Id::new(0), &TrimOptions::default()).is_ok());
    let mut entities = tetrahedron(top(186, "41,1,0"));
    entities[12] = part(508, "3,0,3,2,1,1,0,45,0,3,4,0,2,0,45,0,45,0,3,1,0,0").form(1);
    entities.push(entity(110, FLAT, "0,0,0,1,0,0"));
    assert_eq!(clean(&entities).faces.len(), 4);
}

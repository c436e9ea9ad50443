//! Small files with topology that the standard has and few write, and with topology that is broken: each costs only itself.

use super::tests::{PRODUCT, cube, model};
use crate::brep::{BodyKind, Model, Severity, TrimLoop};
use crate::geometry::Curve;
use glam::DVec3;

/// The cube with `from` replaced by `to`, as often as it occurs, which is at least once.
fn changed(changes: &[(&str, &str)]) -> Model {
    let mut text = cube("#900") + PRODUCT;
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    model(&text)
}

fn assert_whole(model: &Model, what: &str) {
    assert_eq!((model.declared_faces, model.faces.len()), (6, 6), "{what}: {:?}", model.diagnostics);
}

#[test]
fn bodies_of_all_kinds() {
    let solid = "#1=MANIFOLD_SOLID_BREP('cube',#3);";
    for (kind, is_solid) in [
        ("#1=FACETED_BREP('',#3);", true),
        ("#1=BREP_WITH_VOIDS('',#3,());", true),
        (
            "#1=(BREP_WITH_VOIDS(()) FACETED_BREP() MANIFOLD_SOLID_BREP(#3) REPRESENTATION_ITEM('') SOLID_MODEL());",
            true,
        ),
        ("#1=FACETED_BREP_AND_BREP_WITH_VOIDS('',#3,());", true),
        ("#1=SHELL_BASED_SURFACE_MODEL('',(#3));", false),
        ("#1=SHELL_BASED_SURFACE_MODEL('',(#8));#8=ORIENTED_OPEN_SHELL('',*,#3,.F.);", false),
        ("#1=FACE_BASED_SURFACE_MODEL('',(#3));", false),
        ("#1=ORIENTED_OPEN_SHELL('',*,#3,.T.);", false),
        ("#1=ORIENTED_CLOSED_SHELL('',*,#8,.F.);#8=ORIENTED_CLOSED_SHELL('',*,#3,.F.);", false),
    ] {
        let model = changed(&[(solid, kind)]);
        assert_whole(&model, kind);
        assert_eq!(model.diagnostics, [], "{kind}");
        let kinds: Vec<BodyKind> = model.parts.iter().flat_map(|p| &p.bodies).map(|b| b.kind).collect();
        assert_eq!(kinds, [if is_solid { BodyKind::Solid } else { BodyKind::Sheet }], "{kind}");
    }
    for kind in ["CONNECTED_FACE_SET('',", "CONNECTED_FACE_SUB_SET('',", "OPEN_SHELL('',"] {
        let whole = format!("#3={kind}");
        assert_whole(&changed(&[("#3=CLOSED_SHELL('',", &whole)]), kind);
        let alone = changed(&[("(#1,#4)", "(#3,#4)"), (solid, ""), ("#3=CLOSED_SHELL('',", &whole)]);
        assert_whole(&alone, kind);
    }
}

#[test]
fn faces_and_edges_refer_to_others() {
    let loops = |model: &Model| -> usize { model.faces.iter().map(|f| f.loops.len()).sum() };
    for (what, changes) in [
        (
            "nested oriented faces",
            &[
                ("(#200,", "(#8,"),
                (PRODUCT, "#8=ORIENTED_FACE('',*,#9,.F.);#9=ORIENTED_FACE('',*,#200,.F.);"),
            ][..],
        ),
        (
            "a subface of a face in no shell",
            &[(
                "#200=ADVANCED_FACE('f200',(#210),#220,.F.)",
                "#200=SUBFACE('',(#210),#8);#8=ORIENTED_FACE('',*,#9,.F.);#9=FACE_SURFACE('',(),#220,.T.)",
            )][..],
        ),
        (
            "nested oriented edges",
            &[(
                "#100=ORIENTED_EDGE('',*,*,#40,.T.)",
                "#100=ORIENTED_EDGE('',*,*,#8,.F.);#8=ORIENTED_EDGE('',*,*,#40,.F.)",
            )][..],
        ),
        (
            "a subedge",
            &[(
                "#100=ORIENTED_EDGE('',*,*,#40,.T.)",
                "#100=ORIENTED_EDGE('',*,*,#8,.T.);#8=SUBEDGE('',#20,#21,#9);#9=SUBEDGE('',#20,#21,#40)",
            )][..],
        ),
        (
            "an edge without orientation",
            &[("#100=ORIENTED_EDGE('',*,*,#40,.T.)", "#100=EDGE_CURVE('',#20,#21,#70,.T.)")][..],
        ),
        ("a loop as a bound", &[("(#210)", "(#230)")][..]),
        ("unset flags", &[(",.T.)", ",$)")][..]),
        (
            "a loop as a path",
            &[(
                "#230=EDGE_LOOP('',(",
                "#230=(EDGE_LOOP() LOOP() PATH((#101,#108,#143,#132)) REPRESENTATION_ITEM('') TOPOLOGICAL_REPRESENTATION_ITEM());#8=EDGE_LOOP('',(",
            )][..],
        ),
    ] {
        let model = changed(changes);
        let expected = if what.starts_with("a subface") { 7 } else { 6 };
        assert_eq!(model.declared_faces, expected, "{what}");
        assert_eq!(loops(&model), 6, "{what}: {:?}", model.diagnostics);
    }
}

#[test]
fn an_edge_without_a_curve_is_a_straight_one() {
    let model = changed(&[("#40=EDGE_CURVE('',#20,#21,#70,.T.)", "#40=EDGE('',#20,#21)")]);
    assert_whole(&model, "EDGE");
    let edge = model.edges.iter().find(|edge| edge.entity == 40).expect("the edge");
    assert!(matches!(edge.curve, Curve::Line { direction, .. } if direction == DVec3::X));
}

#[test]
fn what_cannot_be_read_costs_itself() {
    for (what, changes, faces) in [
        ("an edge that is missing", &[("#40=EDGE_CURVE", "#41000=EDGE_CURVE")][..], 6),
        (
            "an edge in a circle",
            &[("#100=ORIENTED_EDGE('',*,*,#40,.T.)", "#100=ORIENTED_EDGE('',*,*,#100,.T.)")][..],
            6,
        ),
        (
            "an entity of the wrong type",
            &[("#100=ORIENTED_EDGE('',*,*,#40,.T.)", "#100=PLANE('',#240)")][..],
            6,
        ),
        ("an unset edge", &[("=EDGE_LOOP('',(#100,", "=EDGE_LOOP('',($,")][..], 6),
        ("an inner bound", &[("(#210)", "(#210,#8)"), (PRODUCT, "#8=FACE_BOUND('',#9,.T.);")][..], 6),
        ("a face that is missing", &[("(#200,", "(#200,#8,")][..], 6),
        ("a face of the wrong type", &[("(#200,", "(#200,#240,$,")][..], 6),
        (
            "a shell in a circle",
            &[("#3)", "#8)"), (PRODUCT, "#8=ORIENTED_CLOSED_SHELL('',*,#8,.T.);")][..],
            6,
        ),
        (
            "a face in a circle",
            &[("(#200,", "(#200,#8,"), (PRODUCT, "#8=ORIENTED_FACE('',*,#8,.T.);")][..],
            6,
        ),
        (
            "a loop that is missing",
            &[("#210=FACE_OUTER_BOUND('',#230,", "#210=FACE_OUTER_BOUND('',#8,")][..],
            5,
        ),
        ("a surface that is missing", &[("#220=PLANE", "#22000=PLANE")][..], 5),
    ] {
        let model = changed(changes);
        assert_eq!(model.faces.len(), faces, "{what}: {:?}", model.diagnostics);
        assert!(!model.diagnostics.is_empty(), "{what}");
        for face in model.faces.iter() {
            assert!(matches!(&face.loops[..], [TrimLoop::Edges(coedges)] if coedges.len() == 4), "{what}");
        }
    }
}

#[test]
fn bodies_that_nothing_reaches_are_shown() {
    // A second representation without the solid's own: the first is empty, so that the solid stands alone.
    let alone = changed(&[("(#1,#4)", "(#4)")]);
    assert_whole(&alone, "a solid in no representation");
    assert!(alone.diagnostics.iter().any(|d| d.severity == Severity::Note && d.kind == "PRODUCT"));
    let face = "#8=FACE_SURFACE('',(#9),#220,.T.);#9=FACE_BOUND('',#230,.T.);";
    let beside = changed(&[(PRODUCT, &(PRODUCT.to_owned() + face))]);
    assert_eq!((beside.declared_faces, beside.faces.len(), beside.roots.len()), (7, 7, 2));
    for (keeper, word) in [
        ("#99=CONSTRUCTIVE_GEOMETRY_REPRESENTATION('',(#98),#900);#98=OPEN_SHELL('',(#8));", "construction"),
        ("#99=EXTRUDED_FACE_SOLID('',#8,#31,0.);", "other solids"),
        ("#99=INVISIBILITY((#8));", "invisible"),
    ] {
        let model = changed(&[(PRODUCT, &(PRODUCT.to_owned() + face + keeper))]);
        assert_eq!((model.declared_faces, model.faces.len()), (7, 6), "{keeper}: {:?}", model.diagnostics);
        assert!(
            model.diagnostics.iter().any(|d| d.faces == 1 && d.reason.contains(word)),
            "{:?}",
            model.diagnostics
        );
    }
}

#[test]
fn a_file_without_faces_says_what_it_has() {
    for (data, word) in [
        ("#1=GEOMETRIC_CURVE_SET('',(#2));#2=POLYLINE('',());", "wireframes (1)"),
        ("#1=CURVE_3D_ELEMENT_REPRESENTATION('');", "finite elements (1)"),
        ("#1=CSG_PRIMITIVE_SOLID_2D('');", "flat areas (1)"),
        ("#1=PRODUCT('','',$,());", "nothing like it"),
    ] {
        let model = model(data);
        assert!(model.diagnostics.iter().any(|d| d.reason.contains(word)), "{data}: {:?}", model.diagnostics);
    }
}

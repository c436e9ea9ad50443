//! Small files with surfaces that are faces by themselves, composite curves, offsets, and what is left out.

use super::surface_tests::tube;
use super::tests::{PRODUCT, cube, model};
use crate::brep::{Model, Severity, TrimLoop};
use crate::geometry::{Curve, Surface};
use glam::{DVec2, DVec3};

/// A representation with a set of `items`; points #10 to #13 are the corners (0, 0), (4, 0), (4, 2), (0, 2) of a rectangle.
fn set(items: &str, text: &str) -> Model {
    model(
        &("#2=GEOMETRICALLY_BOUNDED_SURFACE_SHAPE_REPRESENTATION('',(#3),#900);#10=CARTESIAN_POINT('',(0.,0.,0.));\
           #11=CARTESIAN_POINT('',(4.,0.,0.));#12=CARTESIAN_POINT('',(4.,2.,0.));#13=CARTESIAN_POINT('',(0.,2.,0.));\
           #20=AXIS2_PLACEMENT_3D('',#10,$,$);#21=PLANE('',#20);#22=DIRECTION('',(0.,0.,1.));#23=AXIS1_PLACEMENT('',#10,#22);\
           #24=DIRECTION('',(1.,0.,0.));#25=VECTOR('',#24,1.);#26=LINE('',#11,#25);"
            .to_owned()
            + &format!("#3=GEOMETRIC_SET('',({items}));")
            + text),
    )
}

/// The ends of the loop's edges in its order.
fn corners(model: &Model, trim: &TrimLoop) -> Vec<DVec3> {
    let TrimLoop::Edges(coedges) = trim else { return Vec::new() };
    let start =
        |edge: &crate::brep::Edge, reversed: bool| edge.curve.point(edge.range[usize::from(reversed)]);
    coedges.iter().map(|c| start(&model.edges[c.edge], c.reversed)).collect()
}

#[test]
fn splines_are_faces_as_they_are_and_planes_are_none() {
    let model = set("#40,#21", "#40=BEZIER_SURFACE('',1,1,((#10,#13),(#11,#12)),.UNSPECIFIED.,.F.,.F.,.F.);");
    assert_eq!((model.declared_faces, model.faces.len(), model.roots.len()), (1, 1, 1));
    assert!(model.faces.iter().all(|face| face.loops.is_empty()));
    assert!(model.diagnostics.iter().any(|d| d.severity == Severity::Note && d.kind == "PLANE"));
}

#[test]
fn trimmed_surfaces_are_bounded_by_their_parameters() {
    let trimmed = |text: &str, u: [f64; 2], v: [f64; 2]| {
        let range = format!("{:?},{:?},{:?},{:?}", u[0], u[1], v[0], v[1]);
        set("#40", &format!("#40=RECTANGULAR_TRIMMED_SURFACE('',#41,{range},.T.,.T.);#41={text};"))
    };
    let loops = |model: &Model| model.faces.iter().next().map(|face| face.loops.clone()).unwrap_or_default();
    let plane = trimmed("PLANE('',#20)", [0.0, 4.0], [0.0, 2.0]);
    let expected = [[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]].map(|p| DVec2::from_array(p).extend(0.0));
    assert_eq!(corners(&plane, &loops(&plane)[0]), expected);
    let full = std::f64::consts::TAU;
    let ring = trimmed("CYLINDRICAL_SURFACE('',#20,2.)", [0.0, full], [1.0, 3.0]);
    assert_eq!(loops(&ring).len(), 2);
    let cap = trimmed("SPHERICAL_SURFACE('',#20,2.)", [0.0, full], [0.0, full / 4.0]);
    assert!(matches!(loops(&cap)[..], [TrimLoop::Edges(_), TrimLoop::Vertex(_)]));
    let quarter = trimmed("SPHERICAL_SURFACE('',#20,2.)", [0.0, 1.0], [0.0, full / 4.0]);
    assert_eq!(corners(&quarter, &loops(&quarter)[0]).len(), 3);
    // From 1 to 2 along the line, from 4 to 5 off the axis and a quarter around.
    let disk = trimmed("SURFACE_OF_REVOLUTION('',#26,#23)", [0.0, full / 4.0], [0.0, 1.0]);
    let face = disk.faces.iter().next().expect("a face");
    let Surface::Bspline(spline) = &disk.surfaces[face.surface] else { panic!("a spline") };
    assert!(spline.point(spline.domain().max).distance(DVec3::Y * 5.0) < 1e-12);
}

#[test]
fn bounded_surfaces_have_loops_of_segments() {
    // The second segment runs against its line, and the third is a composite curve itself.
    let text = "#40=CURVE_BOUNDED_SURFACE('',#21,(#41),.F.);#41=OUTER_BOUNDARY_CURVE('',(#42,#43,#44),.F.);\
        #42=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#45);#43=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.F.,#46);\
        #44=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#47);#45=POLYLINE('',(#10,#11));#46=POLYLINE('',(#12,#11));\
        #47=COMPOSITE_CURVE('',(#48,#49),.F.);#48=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#50);\
        #49=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#51);#50=POLYLINE('',(#12,#13));#51=POLYLINE('',(#13,#10));";
    let model = set("#40", text);
    assert_eq!(model.diagnostics, []);
    let face = model.faces.iter().next().expect("a face");
    assert_eq!(
        corners(&model, &face.loops[0]),
        [[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]].map(|p| DVec2::from_array(p).extend(0.0))
    );
    let open = set("#40", &text.replace("(#42,#43,#44)", "(#42,#43)"));
    assert_eq!((open.declared_faces, open.faces.len()), (1, 0));
    let circular = set("#40", &text.replace("#47=COMPOSITE_CURVE('',(#48", "#47=COMPOSITE_CURVE('',(#44"));
    assert_eq!(circular.faces.len(), 0);
}

#[test]
fn a_composite_curve_may_be_one_edge() {
    let half = |id: u32, from: f64, to: f64| {
        format!(
            "#{id}=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#{0});#{0}=TRIMMED_CURVE('',#17,(PARAMETER_VALUE({from:?})),\
             (PARAMETER_VALUE({to:?})),.T.,.PARAMETER.);",
            id + 1
        )
    };
    let (half_turn, turn) = (std::f64::consts::PI, std::f64::consts::TAU);
    let text = tube("#60=CYLINDRICAL_SURFACE('',#20,2.);").replace("#15,#15,#17,.T.", "#15,#15,#70,.T.")
        + "#70=COMPOSITE_CURVE('',(#71,#73),.F.);"
        + &half(71, 0.0, half_turn)
        + &half(73, half_turn, turn);
    let model = model(&text);
    let edge = model.edges.iter().find(|edge| edge.entity == 13).expect("the edge is used");
    let Curve::Bspline(_) = &edge.curve else { panic!("a spline") };
    for i in 0..=10 {
        let p = edge.curve.point(edge.range[0] + f64::from(i) / 10.0 * (edge.range[1] - edge.range[0]));
        assert!((p.truncate().length() - 2.0).abs() < 1e-12 && (p.z - 3.0).abs() < 1e-12, "{p}");
    }
}

#[test]
fn offsets_of_closed_forms_are_exact() {
    for (basis, flipped) in [
        ("CYLINDRICAL_SURFACE('',#20,1.5)", false),
        ("SURFACE_OF_LINEAR_EXTRUSION('',#62,#33);#62=CIRCLE('',#20,2.5)", true),
    ] {
        let model = model(&tube(&format!("#60=OFFSET_SURFACE('',#61,0.5,.F.);#61={basis};")));
        assert_eq!(model.diagnostics, []);
        let face = model.faces.iter().next().expect("a face");
        let Surface::Cylinder { radius, .. } = model.surfaces[face.surface] else { panic!("a cylinder") };
        assert_eq!((radius, face.same_sense), (2.0, !flipped));
    }
    let gone = model(&tube("#60=OFFSET_SURFACE('',#61,-2.,.F.);#61=CYLINDRICAL_SURFACE('',#20,2.);"));
    assert_eq!(gone.faces.len(), 0);
}

#[test]
fn offsets_of_other_surfaces_say_how_close_they_are() {
    let basis = "#61=SURFACE_OF_LINEAR_EXTRUSION('',#62,#32);#62=ELLIPSE('',#20,1.6,1.4);";
    let model = model(&tube(&format!("#60=OFFSET_SURFACE('',#61,0.5,.F.);{basis}")));
    assert_eq!(model.faces.len(), 1);
    assert!(model.diagnostics.iter().any(|d| d.severity == Severity::Warning && d.reason.contains("within")));
}

#[test]
fn invisible_bodies_and_drawings_are_left_out() {
    let text = cube("#900")
        + PRODUCT
        + "#600=STYLED_ITEM('',(),#1);#601=INVISIBILITY((#600));#602=TESSELLATED_CURVE_SET();";
    let model = model(&text);
    assert_eq!((model.declared_faces, model.faces.len()), (6, 0));
    let kinds: Vec<_> = model.diagnostics.iter().map(|d| (d.kind.as_str(), d.faces, d.severity)).collect();
    assert_eq!(kinds[0], ("TESSELLATED_CURVE_SET", 0, Severity::Note));
    assert_eq!(kinds[1..], [("ADVANCED_FACE", 1, Severity::Hidden); 6]);
}

#[test]
fn patches_of_a_composite_surface_are_faces() {
    let patch = |id: u32, u: &str| {
        format!(
            "#{id}=SURFACE_PATCH(#{0},.CONTINUOUS.,.CONTINUOUS.,.T.,.T.);#{0}=RECTANGULAR_TRIMMED_SURFACE('',#21,{u},0.,2.,.T.,.T.);",
            id + 1
        )
    };
    let text = "#40=RECTANGULAR_COMPOSITE_SURFACE('',((#41),(#43)));".to_owned()
        + &patch(41, "0.,1.")
        + &patch(43, "1.,4.");
    let model = set("#40", &text);
    assert_eq!((model.declared_faces, model.faces.len()), (2, 2));
    let ends: Vec<DVec3> = model.faces.iter().flat_map(|face| corners(&model, &face.loops[0])).collect();
    assert!(ends.contains(&DVec3::new(1.0, 2.0, 0.0)) && ends.contains(&DVec3::new(4.0, 2.0, 0.0)));
}

#[test]
fn what_is_no_face_in_a_set_is_counted() {
    let text = "#40=SURFACE_REPLICA('',#21,#20);#41=SURFACE_OF_REVOLUTION('',#26,#23);#42=SURFACE_OF_REVOLUTION('',#43,#23);\
        #43=TRIMMED_CURVE('',#26,(PARAMETER_VALUE(0.)),(PARAMETER_VALUE(1.)),.T.,.PARAMETER.);";
    let model = set("#40,#41,#42,#26,#10", text);
    assert_eq!((model.declared_faces, model.faces.len()), (1, 1));
    let reasons: Vec<&str> = model.diagnostics.iter().map(|d| d.reason.as_str()).collect();
    assert_eq!(reasons, ["2 surfaces without bounds are left out", "2 curves and points are left out"]);
    let ring = &model.surfaces[model.faces.iter().next().expect("a ring").surface];
    assert!((ring.point(ring.domain().max).length() - 5.0).abs() < 1e-12);
}

#[test]
fn faces_may_leave_their_bounds_to_the_surface() {
    let text = tube(
        "#60=RECTANGULAR_TRIMMED_SURFACE('',#61,0.,1.,0.,3.,.T.,.T.);#61=CYLINDRICAL_SURFACE('',#20,2.);",
    )
    .replace("('',(#6,#7),#60", "('',(),#60");
    let model = model(&text);
    let face = model.faces.iter().next().expect("a face");
    assert_eq!(corners(&model, &face.loops[0]).len(), 4);
}

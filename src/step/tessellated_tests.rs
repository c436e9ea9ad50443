//! Tessellated shape: every kind of item, what stands beside exact shape, and numbers that lead nowhere.

use super::tests::{PRODUCT, cube, model};
use crate::brep::{BodyKind, Color, Model, Severity};
use crate::geometry::Surface;
use glam::DVec3;

/// Four points of a tetrahedron: the origin and one on each axis.
const POINTS: &str = "#1=COORDINATES_LIST('',4,((0.,0.,0.),(1.,0.,0.),(0.,1.,0.),(0.,0.,1.)));";
const SHAPE: &str = "#2=TESSELLATED_SHAPE_REPRESENTATION('r',(#3),#900);";

/// The outward normals of all faces, sorted, and the body's kind.
fn normals(model: &Model) -> Vec<[i32; 3]> {
    let normal = |surface: &Surface, same: bool| {
        let Surface::Plane { frame } = surface else { panic!("a plane") };
        let z = if same { frame.z } else { -frame.z };
        (z * 3.0_f64.sqrt() * 1000.0).round().to_array().map(|x| x as i32 / 10)
    };
    let mut normals: Vec<_> =
        model.faces.iter().map(|face| normal(&model.surfaces[face.surface], face.same_sense)).collect();
    normals.sort();
    normals
}

fn findings(model: &Model, severity: Severity) -> Vec<(u64, u32)> {
    model.diagnostics.iter().filter(|d| d.severity == severity).map(|d| (d.entity, d.faces)).collect()
}

#[test]
fn triangles_strips_and_fans_are_the_same_tetrahedron() {
    // Strips turn every other triangle: (1, 3, 2), then (2, 3, 4) as 3, 4, 2; a fan begins with its common point.
    let shapes = [
        "#4=TRIANGULATED_FACE('',#1,4,(),$,(),((1,3,2),(1,2,4),(1,4,3),(2,3,4)));",
        "#4=TRIANGULATED_SURFACE_SET('',#1,4,((0.,0.,1.)),(4,3,2,1),((4,2,3),(4,3,1),(4,1,2),(3,2,1)));",
        "#4=COMPLEX_TRIANGULATED_FACE('',#1,4,(),$,(1,2,3,4),((1,3,2,4)),((1,2,4,3)));",
        "#4=COMPLEX_TRIANGULATED_SURFACE_SET('',#1,4,(),(),((1,3,2,4,1,3)),());",
        "#4=(REPRESENTATION_ITEM('') TESSELLATED_FACE(#1,4,(),$) TESSELLATED_ITEM() \
            TRIANGULATED_FACE((),((1,3,2),(1,2,4),(1,4,3),(2,3,4))));",
    ];
    let all = [[-173, 0, 0], [0, -173, 0], [0, 0, -173], [100, 100, 100]];
    for shape in shapes {
        let model = model(&format!("{POINTS}{SHAPE}{PRODUCT}{shape}#3=TESSELLATED_SOLID('body',(#4),$);"));
        assert_eq!(normals(&model), all, "{shape}");
        assert_eq!((model.edges.len(), model.vertices.len(), model.declared_faces), (6, 4, 4));
        let body = &model.parts[model.roots[0]].bodies[0];
        assert_eq!((body.kind, body.name.as_str()), (BodyKind::Solid, "body"));
        assert_eq!(findings(&model, Severity::Note), [(4, 0)]);
        assert!(model.diagnostics[0].reason.starts_with("4 triangles of tessellated geometry imported"));
    }
}

#[test]
fn faces_with_lists_of_their_own_share_edges() {
    let text = "#3=TESSELLATED_SHELL('',(#4,#5),$);#4=TRIANGULATED_FACE('',#1,3,(),$,(),((1,2,3)));\
                #5=TRIANGULATED_FACE('',#6,3,(),$,(),((1,3,2)));#6=COORDINATES_LIST('',3,((-0.,0.,0.),(0.,0.,1.),(0.,1.,0.)));";
    let model = model(&format!("{POINTS}{SHAPE}{text}"));
    assert_eq!((model.faces.len(), model.edges.len(), model.vertices.len()), (2, 5, 4));
    assert_eq!(model.parts[model.roots[0]].bodies[0].kind, BodyKind::Sheet);
}

#[test]
fn numbers_that_lead_nowhere_and_flat_triangles_are_counted() {
    let text =
        "#3=TRIANGULATED_FACE('',#1,4,(),$,(),((1,2,3),(0,1,2),(1,2,5),(1,2,1.5),(1,2),(1,2,$),(1,1,2)));";
    let model = model(&format!("{POINTS}{SHAPE}{text}"));
    assert_eq!((model.declared_faces, model.faces.len()), (6, 1));
    assert_eq!(findings(&model, Severity::Dropped), [(3, 5)]);
    assert_eq!(findings(&model, Severity::Note), [(3, 0), (3, 0)]);
}

#[test]
fn a_missing_list_of_points_costs_its_face() {
    let text = "#3=TESSELLATED_SHELL('',(#4,#5,#99,#3),$);#4=TRIANGULATED_FACE('',#98,3,(),$,(),((1,2,3)));\
                #5=TRIANGULATED_FACE('',#1,3,(),$,(),((1,2,3)));";
    let model = model(&format!("{POINTS}{SHAPE}{text}"));
    assert_eq!((model.declared_faces, model.faces.len()), (2, 1));
}

#[test]
fn repositioned_sets_are_moved() {
    let place = "#10=AXIS2_PLACEMENT_3D('',#11,$,$);#11=CARTESIAN_POINT('',(10.,0.,0.));\
                 #4=TRIANGULATED_SURFACE_SET('',#1,4,(),(),((1,2,3)));";
    for set in [
        "#3=REPOSITIONED_TESSELLATED_GEOMETRIC_SET('',(#4,#5),#10);",
        "#3=(GEOMETRIC_REPRESENTATION_ITEM() REPOSITIONED_TESSELLATED_ITEM(#10) REPRESENTATION_ITEM('') \
            TESSELLATED_GEOMETRIC_SET((#4,#5)) TESSELLATED_ITEM());",
    ] {
        // In inches, with a curve beside.
        let text = format!("{POINTS}{SHAPE}{place}{set}#5=TESSELLATED_CURVE_SET('',#1,((1,2)));")
            .replace("#900);#10", "#910);#10");
        let model = model(&text);
        let points: Vec<DVec3> = model.vertices.iter().map(|v| v.point).collect();
        assert_eq!(points, [DVec3::X * 254.0, DVec3::X * 279.4, DVec3::new(254.0, 25.4, 0.0)]);
    }
}

#[test]
fn exact_shape_goes_before_its_tessellation() {
    let mesh =
        format!("{POINTS}#400=TRIANGULATED_FACE('',#401,4,(),$,(),((1,2,3)));").replace("#1=", "#401=");
    let beside = [
        // In the same representation, of the same product by another representation, and linked from anywhere.
        "#402=TESSELLATED_SOLID('',(#400),$);",
        "#402=TESSELLATED_SOLID('',(#400),$);#403=TESSELLATED_SHAPE_REPRESENTATION('',(#402),#900);\
         #404=PROPERTY_DEFINITION_REPRESENTATION(#503,#403);",
        "#402=TESSELLATED_SOLID('',(#400),#1);#403=TESSELLATED_SHAPE_REPRESENTATION('',(#402),#900);",
    ];
    for (at, text) in beside.into_iter().enumerate() {
        let exact = if at == 0 { cube("#900").replace("(#1,#4)", "(#1,#4,#402)") } else { cube("#900") };
        let model = model(&format!("{exact}{PRODUCT}{mesh}{text}"));
        assert_eq!((model.faces.len(), model.declared_faces), (6, 6), "{text}");
        assert_eq!(findings(&model, Severity::Note), [(400, 0)], "{text}");
        assert!(model.diagnostics[0].reason.contains("beside exact shape"));
    }
    // Of a product of its own it is shape.
    let alone = "#402=TESSELLATED_SOLID('',(#400),$);#403=TESSELLATED_SHAPE_REPRESENTATION('',(#402),#900);";
    assert_eq!(model(&format!("{}{PRODUCT}{mesh}{alone}", cube("#900"))).faces.len(), 7);
}

#[test]
fn annotations_are_no_shape() {
    let text = "#3=TESSELLATED_GEOMETRIC_SET('',(#4));#4=TRIANGULATED_SURFACE_SET('',#1,4,(),(),((1,2,3)));\
                #5=TESSELLATED_ANNOTATION_OCCURRENCE('',(),#3);";
    let model = model(&format!("{POINTS}{SHAPE}{text}"));
    assert_eq!((model.faces.len(), model.declared_faces), (0, 0));
    assert_eq!(findings(&model, Severity::Note), [(5, 0), (4, 0)]);
}

#[test]
fn without_a_representation_it_is_a_part_of_its_own() {
    let text = "#3=TESSELLATED_SHELL('',(#4),$);#4=TRIANGULATED_FACE('',#1,3,(),$,(),((1,2,3)));";
    let model = model(&format!("{POINTS}{text}"));
    assert_eq!((model.roots.len(), model.faces.len()), (1, 1));
}

#[test]
fn cubic_triangles_keep_their_corners() {
    // Rows of 4, 3, 2, 1 points, or of 1, 2, 3, 4: the corners are (0, 0), (3, 0), (0, 3) in both.
    let point = |i: usize, j: usize| format!("({i}.,{j}.,0.)");
    let by_rows: Vec<String> = (0..4).flat_map(|j| (0..4 - j).map(move |i| point(i, j))).collect();
    let by_diagonals: Vec<String> = (0..4).flat_map(|d| (0..=d).map(move |j| point(d - j, j))).collect();
    for points in [by_rows, by_diagonals] {
        let text = format!(
            "#1=COORDINATES_LIST('',10,({}));{SHAPE}\
             #3=CUBIC_BEZIER_TRIANGULATED_FACE('',#1,10,(),$,((1,2,3,4,5,6,7,8,9,10)));",
            points.join(",")
        );
        let model = model(&text);
        let sum: DVec3 = model.vertices.iter().map(|v| v.point).sum();
        assert_eq!((model.faces.len(), sum), (1, DVec3::new(3.0, 3.0, 0.0)));
        assert_eq!(findings(&model, Severity::Warning), [(3, 0)]);
    }
}

#[test]
fn colours_come_from_the_face_or_the_solid() {
    let style = "#20=PRESENTATION_STYLE_ASSIGNMENT((#21));#21=SURFACE_STYLE_USAGE(.BOTH.,#22);\
                 #22=SURFACE_SIDE_STYLE('',(#23));#23=SURFACE_STYLE_FILL_AREA(#24);#24=FILL_AREA_STYLE('',(#25));\
                 #25=FILL_AREA_STYLE_COLOUR('',#26);";
    let red = style.to_owned() + "#26=COLOUR_RGB('',1.,0.,0.);#27=STYLED_ITEM('',(#20),#3);";
    let blue = style.replace("#2", "#3")
        + "#36=COLOUR_RGB('',0.,0.,1.);#37=OVER_RIDING_STYLED_ITEM('',(#30),#5,#27);";
    let text = "#3=TESSELLATED_SOLID('',(#4,#5),$);#4=TRIANGULATED_FACE('',#1,4,(),$,(),((1,2,3)));\
                #5=TRIANGULATED_FACE('',#1,4,(),$,(),((1,2,4)));";
    let model = model(&format!("{POINTS}{SHAPE}{text}{red}{blue}"));
    let colors: Vec<_> = model.faces.iter().map(|f| f.color).collect();
    assert_eq!(colors, [Some(Color::opaque(1.0, 0.0, 0.0)), Some(Color::opaque(0.0, 0.0, 1.0))]);
}

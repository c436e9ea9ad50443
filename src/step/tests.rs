//! Small files, each with one quirk that files have.

use super::corpus_tests::check;
use super::read;
use crate::brep::{BodyKind, Model, Severity, TrimLoop};
use crate::geometry::{Curve, Surface};
use glam::DVec3;

pub const MILLIMETRES: &str = "#900=(GEOMETRIC_REPRESENTATION_CONTEXT(3) GLOBAL_UNIT_ASSIGNED_CONTEXT((#901,#902)) \
    REPRESENTATION_CONTEXT('',''));#901=(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.));\
    #902=(NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.));";

const INCHES: &str = "#910=(GEOMETRIC_REPRESENTATION_CONTEXT(3) GLOBAL_UNIT_ASSIGNED_CONTEXT((#911,#902)) \
    REPRESENTATION_CONTEXT('',''));#911=(CONVERSION_BASED_UNIT('INCH',#912) LENGTH_UNIT() NAMED_UNIT(#914));\
    #912=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#901);#914=DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);";

/// Model of a file with these instances.
pub fn model(data: &str) -> Model {
    let text = format!(
        "ISO-10303-21;\nHEADER;\nFILE_NAME('n','',(''),(''),'p','a \\X2\\00FC\\X0\\ system','');\n\
         FILE_SCHEMA(('AUTOMOTIVE_DESIGN {{ 1 0 10303 214 1 1 1 1 }}'));\nENDSEC;\nDATA;\n{MILLIMETRES}{INCHES}\n{data}\n\
         ENDSEC;\nEND-ISO-10303-21;\n"
    );
    let model = read(text.as_bytes()).expect("the file has entities");
    check(&model, data);
    model
}

/// A cube from (0, 0, 0) to (1, 1, 1) with edges, as solid #1 made of ids below 300; its representation #2 is in `context`.
pub fn cube(context: &str) -> String {
    use std::fmt::Write;
    let mut text = format!(
        "#1=MANIFOLD_SOLID_BREP('cube',#3);#2=ADVANCED_BREP_SHAPE_REPRESENTATION('r',(#1,#4),{context});"
    );
    text += "#4=AXIS2_PLACEMENT_3D('',#10,$,$);";
    for i in 0..8 {
        write!(
            text,
            "#{}=CARTESIAN_POINT('',({}.,{}.,{}.));#{}=VERTEX_POINT('',#{});",
            10 + i,
            i & 1,
            i >> 1 & 1,
            i >> 2,
            20 + i,
            10 + i
        )
        .expect("a string takes all");
    }
    for (i, ratios) in ["1.,0.,0.", "0.,1.,0.", "0.,0.,1."].iter().enumerate() {
        write!(text, "#{}=DIRECTION('',({ratios}));#{}=VECTOR('',#{},1.);", 30 + i, 35 + i, 30 + i)
            .expect("a string takes all");
    }
    // Edge from corner `a` along axis `k` has number 40 + 3·a + k.
    for a in 0..8_usize {
        for k in (0..3).filter(|k| a >> k & 1 == 0) {
            let (edge, b) = (3 * a + k, a | 1 << k);
            write!(
                text,
                "#{}=EDGE_CURVE('',#{},#{},#{},.T.);#{}=LINE('',#{},#{});#{}=ORIENTED_EDGE('',*,*,#{},.T.);#{}=ORIENTED_EDGE('',*,*,#{},.F.);",
                40 + edge, 20 + a, 20 + b, 70 + edge, 70 + edge, 10 + a, 35 + k, 100 + edge, 40 + edge, 130 + edge, 40 + edge
            )
            .expect("a string takes all");
        }
    }
    let mut faces = Vec::new();
    for k in 0..3 {
        for side in 0..2 {
            let (u, v) = ((k + 1) % 3, (k + 2) % 3);
            let corner = side << k;
            let edge = |a: usize, k: usize| 3 * a + k;
            // Counter-clockwise about +k: along u, along v, back along u, back along v.
            let loop_edges = [
                100 + edge(corner, u),
                100 + edge(corner | 1 << u, v),
                130 + edge(corner | 1 << v, u),
                130 + edge(corner, v),
            ];
            let face = 200 + 2 * k + side;
            let flag = if side == 1 { ".T." } else { ".F." };
            write!(
                text,
                "#{face}=ADVANCED_FACE('f{face}',(#{}),#{},{flag});#{}=FACE_OUTER_BOUND('',#{},{flag});\
                 #{}=EDGE_LOOP('',({}));#{}=PLANE('',#{});#{}=AXIS2_PLACEMENT_3D('',#{},#{},$);",
                face + 10,
                face + 20,
                face + 10,
                face + 30,
                face + 30,
                loop_edges.map(|e| format!("#{e}")).join(","),
                face + 20,
                face + 40,
                face + 40,
                10 + corner,
                30 + k
            )
            .expect("a string takes all");
            faces.push(format!("#{face}"));
        }
    }
    text + &format!("#3=CLOSED_SHELL('',({}));", faces.join(","))
}

pub const PRODUCT: &str = "#500=PRODUCT('id','W\\X\\FCrfel','',());#501=PRODUCT_DEFINITION_FORMATION('','',#500);\
    #502=PRODUCT_DEFINITION('','',#501,$);#503=PRODUCT_DEFINITION_SHAPE('','',#502);\
    #504=SHAPE_DEFINITION_REPRESENTATION(#503,#2);";

#[test]
fn a_cube() {
    let model = model(&(cube("#900") + PRODUCT));
    assert_eq!(model.diagnostics, []);
    assert_eq!((model.faces.len(), model.edges.len(), model.vertices.len()), (6, 12, 8));
    assert_eq!(
        (model.source.schema.as_str(), model.source.originating_system.as_str()),
        ("AUTOMOTIVE_DESIGN", "a ü system")
    );
    let part = &model.parts[model.roots[0]];
    assert_eq!((part.name.as_str(), part.bodies.len(), part.bodies[0].kind), ("Würfel", 1, BodyKind::Solid));
    for face in model.faces.iter() {
        let TrimLoop::Edges(coedges) = &face.loops[0] else { panic!("an edge loop") };
        let end = |i: usize, at: usize| {
            let coedge = coedges[i];
            let edge = &model.edges[coedge.edge];
            edge.curve.point(edge.range[at ^ usize::from(coedge.reversed)])
        };
        let corners: Vec<DVec3> = (0..4).map(|i| end(i, 0)).collect();
        for i in 0..4 {
            assert!(end(i, 1).distance(corners[(i + 1) % 4]) < 1e-12, "the loop is a chain");
        }
        // The face lies to the left of its loop, and its normal points out of the cube.
        let turning = (corners[1] - corners[0]).cross(corners[2] - corners[1]);
        let Surface::Plane { frame } = &model.surfaces[face.surface] else { panic!("a plane") };
        let normal = if face.same_sense { frame.z } else { -frame.z };
        let outwards = corners.iter().copied().sum::<DVec3>() / 4.0 - DVec3::splat(0.5);
        assert!(turning.dot(normal) > 0.9 && normal.dot(outwards) > 0.4, "{}", face.name);
    }
}

#[test]
fn units_are_those_of_the_representation() {
    let model = model(&(cube("#910") + PRODUCT));
    assert_eq!((model.source.unit.name.as_str(), model.source.unit.millimetres), ("inch", 25.4));
    let far = model.vertices.iter().map(|v| v.point.max_element()).fold(0.0, f64::max);
    assert!((far - 25.4).abs() < 1e-12);
}

#[test]
fn missing_units_are_millimetres_with_a_warning() {
    let model = model(&(cube("#920") + PRODUCT + "#920=REPRESENTATION_CONTEXT('','');"));
    assert_eq!(model.diagnostics.iter().map(|d| d.severity).collect::<Vec<_>>(), [Severity::Warning]);
    assert_eq!(model.faces.len(), 6);
}

#[test]
fn without_products_solids_become_one_part() {
    let text = cube("#900").replace("#2=ADVANCED_BREP_SHAPE_REPRESENTATION('r',(#1,#4),#900);", "");
    let model = model(&text);
    assert_eq!((model.faces.len(), model.roots.len()), (6, 1));
    assert!(model.diagnostics.iter().any(|d| d.severity == Severity::Note));
}

#[test]
fn broken_faces_cost_themselves() {
    let broken = cube("#900")
        .replace("#221=PLANE('',#241);", "#221=RECTANGULAR_COMPOSITE_SURFACE('',((#220)));")
        .replace("#235=EDGE_LOOP", "#235=EDGE_LOPP");
    let model = model(&(broken + PRODUCT + "#600=ADVANCED_FACE('nobody''s',(),#220,.T.);"));
    assert_eq!((model.declared_faces, model.faces.len()), (7, 4));
    assert_eq!(model.diagnostics.iter().map(|d| d.faces).sum::<u32>(), 3);
    assert!(
        model
            .diagnostics
            .iter()
            .any(|d| d.entity == 201 && d.reason.contains("RECTANGULAR_COMPOSITE_SURFACE #221"))
    );
}

#[test]
fn poly_loops_share_edges() {
    let model = model(
        "#1=FACETED_BREP('',#3);#2=FACETED_BREP_SHAPE_REPRESENTATION('',(#1),#900);#3=CLOSED_SHELL('',(#4,#5));\
         #4=FACE_SURFACE('',(#6),#8,.T.);#5=FACE('',(#7));#6=FACE_OUTER_BOUND('',#9,.T.);#7=FACE_OUTER_BOUND('',#10,.T.);\
         #8=PLANE('',#11);#9=POLY_LOOP('',(#12,#13,#14));#10=POLY_LOOP('',(#13,#12,#15));#11=AXIS2_PLACEMENT_3D('',#12,$,$);\
         #12=CARTESIAN_POINT('',(0.,0.,0.));#13=CARTESIAN_POINT('',(1.,0.,0.));#14=CARTESIAN_POINT('',(0.,1.,0.));\
         #15=CARTESIAN_POINT('',(0.,0.,1.));",
    );
    assert_eq!((model.faces.len(), model.edges.len(), model.vertices.len()), (2, 5, 4));
    let Surface::Plane { frame } = model.surfaces[model.faces.iter().nth(1).expect("two faces").surface]
    else {
        panic!("a plane")
    };
    assert!((frame.z.y.abs() - 1.0).abs() < 1e-12);
}

#[test]
fn an_edge_without_a_curve_is_straight() {
    let model = model(&(cube("#900").replace("#70=LINE('',#10,#35);", "") + PRODUCT));
    assert_eq!(model.faces.len(), 6);
    assert!(model.diagnostics.iter().any(|d| d.severity == Severity::Warning && d.entity == 40));
    assert!(model.edges.iter().all(|e| matches!(e.curve, Curve::Line { .. })));
}

#[test]
fn texts_that_editors_and_old_systems_write() {
    let text = format!(
        "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA ('one', ('X'));\n{MILLIMETRES}{}{PRODUCT}ENDSEC;\nEND-ISO-10303-21;\n",
        cube("#900")
    );
    let statement_a_line = text.replace(';', ";\n");
    let variants = [
        ("marks and comments", format!("\u{feff}/* #1=A(; */ \n{text}")),
        ("returns and feeds", statement_a_line.replace('\n', "\r\n")),
        ("returns alone", statement_a_line.replace('\n', "\r")),
        ("blanks", text.replace('=', " =\t\n ").replace("('", " ( '").replace(',', " ,\n")),
        ("zeros for blanks", text.replace(';', ";\0\0")),
        // Directives inside of strings are upper case in all editions.
        ("lower case", text.to_lowercase().replace("w\\x\\fcrfel", "W\\X\\FCrfel")),
        ("no end", text.replace("ENDSEC;\nEND-ISO-10303-21;\n", "")),
        ("garbage behind", text.clone() + "#1=CLOSED_SHELL();\u{1a}\u{1a}<html>#2='"),
        ("two sections", text.replace("#20=", "ENDSEC;DATA;#20=")),
        ("words of their own", text.replace("#30=", "#9001=!MY_WORD('x',(!OTHER(1)),\"0AF\",.u.);#30=")),
        (
            "other sections",
            text.replace("DATA (", "ANCHOR;<a>=#1;<b>=$;ENDSEC;REFERENCE;#77=<#a>;ENDSEC;DATA (")
                + "SIGNATURE;MIIBzQYJ+KoZ/IhvcNAQcCoIIB==\nENDSEC;",
        ),
    ];
    for (name, variant) in variants {
        let model = read(variant.as_bytes()).unwrap_or_else(|error| panic!("{name}: {error}"));
        check(&model, name);
        assert_eq!((model.faces.len(), model.roots.len()), (6, 1), "{name}: {:?}", model.diagnostics);
        assert_eq!(model.diagnostics, [], "{name}");
        assert_eq!(model.parts[model.roots[0]].name.to_lowercase(), "würfel", "{name}");
    }
    // A file that was cut off keeps what came before.
    let model = read(&text.as_bytes()[..text.len() - 150]).expect("entities");
    assert!(model.faces.len() == 6 && !model.diagnostics.is_empty());
}

#[test]
fn no_file_is_an_error_and_no_garbage_a_panic() {
    assert!(matches!(read(b"solid"), Err(super::StepError::NotStep)));
    assert!(matches!(read(b"ISO-10303-21;\nDATA;\nENDSEC;"), Err(super::StepError::Invalid { .. })));
    let text = format!("ISO-10303-21;HEADER;ENDSEC;DATA;{}ENDSEC;", cube("#900") + PRODUCT + MILLIMETRES);
    // Every cut, and every byte of a stretch replaced.
    for at in (0..text.len()).step_by(7) {
        if let Ok(model) = read(&text.as_bytes()[..at]) {
            check(&model, "cut");
        }
        for byte in [b'#', b'\'', b';', b'(', b'$', b'9'] {
            let mut bytes = text.as_bytes().to_vec();
            bytes[at] = byte;
            if let Ok(model) = read(&bytes) {
                check(&model, "changed");
            }
        }
    }
}

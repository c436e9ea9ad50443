//! Small files, each with an edge on one kind of curve, held against the curve's own formula.

use super::corpus_tests::check;
use super::read;
use super::tests::model;
use crate::brep::{Edge, Model};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, TAU};

/// A file with a face on a plane whose one edge #13 runs on curve #60 from point #30 to point #31; `text` has all of those.
fn edge_on(text: &str) -> (Model, Option<Edge>) {
    let model = model(
        &("#2=MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(#1),#900);#1=SHELL_BASED_SURFACE_MODEL('',(#3));#3=OPEN_SHELL('',(#5));\
           #5=ADVANCED_FACE('',(#6),#7,.T.);#6=FACE_BOUND('',#8,.T.);#7=PLANE('',#20);#8=EDGE_LOOP('',(#10));\
           #10=ORIENTED_EDGE('',*,*,#13,.T.);#13=EDGE_CURVE('',#14,#15,#60,.T.);#14=VERTEX_POINT('',#30);\
           #15=VERTEX_POINT('',#31);#20=AXIS2_PLACEMENT_3D('',#21,$,$);#21=CARTESIAN_POINT('',(0.,0.,0.));\
           #22=DIRECTION('',(0.,0.,1.));#23=DIRECTION('',(0.,1.,0.));#24=DIRECTION('',(1.,0.,0.));#25=VECTOR('',#24,1.);\
           #26=CIRCLE('',#20,2.);#27=CARTESIAN_POINT('',(0.,2.,0.));#28=CARTESIAN_POINT('',(2.,0.,0.));\
           #29=LINE('',#21,#25);"
            .to_owned()
            + text),
    );
    let edge = model.edges.iter().find(|edge| edge.entity == 13).cloned();
    (model, edge)
}

/// Points at equal steps of the edge's range.
fn points(edge: &Edge) -> Vec<DVec3> {
    let [a, b] = edge.range;
    (0..=8).map(|i| edge.curve.point(a + (b - a) * f64::from(i) / 8.0)).collect()
}

/// The points of the edge that `text` describes.
fn run(text: &str) -> Vec<DVec3> {
    let (model, edge) = edge_on(text);
    points(&edge.unwrap_or_else(|| panic!("{text}: {:?}", model.diagnostics)))
}

fn assert_on(text: &str, ends: [DVec3; 2], off: impl Fn(DVec3) -> f64) {
    let points = run(text);
    assert!(points[0].distance(ends[0]) < 1e-9 && points[8].distance(ends[1]) < 1e-9, "{text}: {points:?}");
    for p in points {
        assert!(off(p).abs() < 1e-8, "{text}: {p} is {:e} off", off(p));
    }
}

fn ends(from: [f64; 3], to: [f64; 3]) -> String {
    format!("#30=CARTESIAN_POINT('',{from:?});#31=CARTESIAN_POINT('',{to:?});")
        .replace('[', "(")
        .replace(']', ")")
}

#[test]
fn conics() {
    let e = 1.0_f64.exp();
    let (cosh, sinh) = ((e + 1.0 / e) / 2.0, (e - 1.0 / e) / 2.0);
    let (a, b) = ([3.0, 0.0, 0.0], [3.0 * cosh, 2.0 * sinh, 0.0]);
    assert_on(&(ends(a, b) + "#60=HYPERBOLA('',#20,3.,2.);"), [a, b].map(DVec3::from_array), |p| {
        (p.x / 3.0).powi(2) - (p.y / 2.0).powi(2) - 1.0
    });
    let (a, b) = ([2.0, -4.0, 0.0], [8.0, 8.0, 0.0]);
    assert_on(&(ends(a, b) + "#60=PARABOLA('',#20,2.);"), [a, b].map(DVec3::from_array), |p| {
        p.y * p.y - 8.0 * p.x
    });
    let moved = "#60=CURVE_REPLICA('',#61,#62);#61=CIRCLE('',#20,2.);\
        #62=CARTESIAN_TRANSFORMATION_OPERATOR_3D('','',$,#24,#63,#28,2.,#22);#63=DIRECTION('',(0.,-1.,0.));";
    let (a, b) = ([6.0, 0.0, 0.0], [2.0, -4.0, 0.0]);
    assert_on(&(ends(a, b) + moved), [a, b].map(DVec3::from_array), |p| (p - DVec3::X * 2.0).length() - 4.0);
}

#[test]
fn splines_without_knots() {
    let points = "#61=CARTESIAN_POINT('',(0.,0.,0.));#62=CARTESIAN_POINT('',(3.,6.,0.));#63=CARTESIAN_POINT('',(6.,0.,0.));\
        #64=CARTESIAN_POINT('',(9.,6.,0.));";
    let at = |kind: &str, from: [f64; 3], to: [f64; 3]| {
        run(&(ends(from, to) + points + &format!("#60={kind}('',2,(#61,#62,#63),.UNSPECIFIED.,.F.,.F.);")))[4]
    };
    // The single pieces: a Bézier arch, and the middle of a uniform one, which ends half way along its legs.
    let arch = [[0.0, 0.0, 0.0], [6.0, 0.0, 0.0]];
    for kind in ["BEZIER_CURVE", "QUASI_UNIFORM_CURVE", "B_SPLINE_CURVE", "PIECEWISE_BEZIER_CURVE"] {
        assert!(at(kind, arch[0], arch[1]).distance(DVec3::new(3.0, 3.0, 0.0)) < 1e-12, "{kind}");
    }
    let inner = [[1.5, 3.0, 0.0], [4.5, 3.0, 0.0]];
    assert!(at("UNIFORM_CURVE", inner[0], inner[1]).distance(DVec3::new(3.0, 4.5, 0.0)) < 1e-12);
    // Rational, the parts of the complex instance in no order: a quarter of the unit circle.
    let quarter = "#61=CARTESIAN_POINT('',(1.,0.,0.));#62=CARTESIAN_POINT('',(1.,1.,0.));#63=CARTESIAN_POINT('',(0.,1.,0.));\
        #60=(REPRESENTATION_ITEM('') RATIONAL_B_SPLINE_CURVE((-2.,-1.414213562373095,-2.)) GEOMETRIC_REPRESENTATION_ITEM() \
        CURVE() BEZIER_CURVE() B_SPLINE_CURVE(2,(#61,#62,#63),.CIRCULAR_ARC.,.F.,.F.) BOUNDED_CURVE());";
    let (a, b) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    assert_on(&(ends(a, b) + quarter), [a, b].map(DVec3::from_array), |p| p.length() - 1.0);
    let (model, _) = edge_on(&(ends(a, b) + quarter));
    assert!(model.diagnostics.iter().any(|d| d.entity == 60 && d.reason.contains("negative weights")));
}

#[test]
fn knots_are_mended_where_the_intent_is_plain() {
    let spline = |counts: &str, knots: &str| {
        ends([0.0, 0.0, 0.0], [9.0, 0.0, 0.0])
            + "#61=CARTESIAN_POINT('',(0.,0.,0.));#62=CARTESIAN_POINT('',(3.,6.,0.));#63=CARTESIAN_POINT('',(6.,6.,0.));\
               #64=CARTESIAN_POINT('',(9.,0.,0.));"
            + &format!(
                "#60=B_SPLINE_CURVE_WITH_KNOTS('',3,(#61,#62,#63,#64),.U.,.F.,.F.,({counts}),({knots}),.U.);"
            )
    };
    let good = run(&spline("4,4", "0.,1."));
    for (counts, knots, repair) in [
        ("3,3", "0.,1.", "multiplicities of the end knots"),
        ("5,5", "0.,1.", "multiplicities of the end knots"),
        ("1,1", "0.,1.", "multiplicities of the end knots"),
        ("4,4", "2.,2.", "knots without an interval"),
        ("1,3,3,1", "1.E-12,0.,1.,1.", "knots brought into order"),
    ] {
        let text = spline(counts, knots);
        let points = run(&text);
        let off = points.iter().zip(&good).map(|(p, q)| p.distance(*q)).fold(0.0, f64::max);
        assert!(off < 1e-9, "{counts} {knots}: {off:e}");
        let (model, _) = edge_on(&text);
        assert!(
            model.diagnostics.iter().any(|d| d.entity == 60 && d.reason.contains(repair)),
            "{:?}",
            model.diagnostics
        );
    }
    for (counts, knots) in
        [("4,1,4", "0.,0.5,1."), ("4,4", "1.,0."), ("4,999999999,4", "0.,0.5,1."), ("4,4,4", "0.,1.")]
    {
        let (model, edge) = edge_on(&spline(counts, knots));
        let straight = edge.map(|edge| points(&edge)[4]);
        assert_eq!(straight, Some(DVec3::X * 4.5), "{counts}: a straight edge instead");
        assert!(model.diagnostics.iter().any(|d| d.entity == 13));
    }
}

/// The joined curve of a composite with one trimmed segment, from its start to its end.
fn trimmed(trim: &str) -> [DVec3; 3] {
    let text = format!(
        "#60=COMPOSITE_CURVE('',(#61),.F.);#61=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#62);#62=TRIMMED_CURVE('',{trim});"
    );
    let (model, edge) = edge_on(&(ends([2.0, 0.0, 0.0], [0.0, 2.0, 0.0]) + &text));
    let edge = edge.unwrap_or_else(|| panic!("{trim}: {:?}", model.diagnostics));
    let [a, b] = edge.curve.domain();
    [a, 0.5 * (a + b), b].map(|t| edge.curve.point(t))
}

#[test]
fn trims_by_points_and_parameters() {
    let quarter =
        |side: f64| [DVec3::X * 2.0, DVec3::new(1.0, 1.0, 0.0) * 2.0_f64.sqrt() * side, DVec3::Y * 2.0];
    let (near, far) = (quarter(1.0), quarter(-1.0));
    let reversed = |p: [DVec3; 3]| [p[2], p[1], p[0]];
    for (trim, expected) in [
        ("#26,(PARAMETER_VALUE(0.)),(PARAMETER_VALUE(1.5707963267948966)),.T.,.PARAMETER.", near),
        ("#26,(#28),(#27),.T.,.CARTESIAN.", near),
        ("#26,(#28),(#27),.F.,.CARTESIAN.", far),
        ("#26,(#27),(#28),.F.,.CARTESIAN.", reversed(near)),
        ("#26,(#27),(#28),.T.,.CARTESIAN.", reversed(far)),
        // Both are given: the one that the file prefers, unless only the other one can be meant.
        ("#26,(#28,PARAMETER_VALUE(7.)),(#27,PARAMETER_VALUE(8.)),.T.,.CARTESIAN.", near),
        ("#26,(#28,PARAMETER_VALUE(0.)),(PARAMETER_VALUE(90.),#27),.T.,.PARAMETER.", near),
    ] {
        let found = trimmed(trim);
        let off = found.iter().zip(&expected).map(|(p, q)| p.distance(*q)).fold(0.0, f64::max);
        assert!(off < 1e-12, "{trim}: {found:?} instead of {expected:?}");
    }
    // A line against its direction, by its own parameter.
    let line = trimmed("#29,(PARAMETER_VALUE(4.)),(PARAMETER_VALUE(1.)),.F.,.PARAMETER.");
    assert_eq!([line[0], line[2]], [DVec3::X * 4.0, DVec3::X]);
}

#[test]
fn angles_of_trims_are_in_the_unit_of_the_file() {
    let text = "ISO-10303-21;HEADER;ENDSEC;DATA;#1=GEOMETRICALLY_BOUNDED_SURFACE_SHAPE_REPRESENTATION('',(#2),#900);\
        #2=GEOMETRIC_SET('',(#3));#3=SURFACE_OF_REVOLUTION('',#4,#5);#5=AXIS1_PLACEMENT('',#6,$);#6=CARTESIAN_POINT('',(0.,0.,0.));\
        #4=TRIMMED_CURVE('',#7,(PARAMETER_VALUE(0.)),(PARAMETER_VALUE(100.)),.T.,.PARAMETER.);#7=CIRCLE('',#8,1.);\
        #8=AXIS2_PLACEMENT_3D('',#9,#10,$);#9=CARTESIAN_POINT('',(5.,0.,0.));#10=DIRECTION('',(0.,-1.,0.));\
        #900=(GLOBAL_UNIT_ASSIGNED_CONTEXT((#901,#902)));#901=(LENGTH_UNIT() SI_UNIT(.MICRO.,.METRE.));\
        #902=(CONVERSION_BASED_UNIT('GRADIAN',#903) PLANE_ANGLE_UNIT());\
        #903=PLANE_ANGLE_MEASURE_WITH_UNIT(PLANE_ANGLE_MEASURE(0.015707963267948967),#904);\
        #904=(PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.));ENDSEC;END-ISO-10303-21;";
    let model = read(text.as_bytes()).expect("the file has entities");
    check(&model, "gradians");
    let surface = &model.surfaces[model.faces.iter().next().expect("a face").surface];
    let domain = surface.domain();
    assert!((domain.max.y - FRAC_PI_2).abs() < 1e-12, "{domain:?}");
    assert!(surface.point(domain.max).distance(DVec3::new(5e-3, 0.0, 1e-3)) < 1e-15);
}

#[test]
fn curves_at_a_distance() {
    let (a, b) = ([2.5, 0.0, 0.0], [0.0, 2.5, 0.0]);
    assert_on(
        &(ends(a, b) + "#60=OFFSET_CURVE_3D('',#26,-0.5,.F.,#22);"),
        [a, b].map(DVec3::from_array),
        |p| p.length() - 2.5,
    );
    let (a, b) = ([0.0, 1.0, 0.0], [3.0, 1.0, 0.0]);
    assert_on(
        &(ends(a, b) + "#60=OFFSET_CURVE_3D('',#29,1.,.F.,#22);"),
        [a, b].map(DVec3::from_array),
        |p| p.y - 1.0,
    );
    // Inside of an ellipse, along its normals.
    let (a, b) = ([2.5, 0.0, 0.0], [0.0, 1.5, 0.0]);
    let points = run(&(ends(a, b) + "#60=OFFSET_CURVE_3D('',#61,0.5,.F.,#22);#61=ELLIPSE('',#20,3.,2.);"));
    for p in points {
        let nearest = (0..20000).map(|i| {
            let t = f64::from(i) / 20000.0 * TAU;
            DVec3::new(3.0 * t.cos(), 2.0 * t.sin(), 0.0).distance(p)
        });
        assert!((nearest.fold(f64::INFINITY, f64::min) - 0.5).abs() < 1e-6, "{p}");
    }
}

#[test]
fn curves_in_a_parameter_plane_alone() {
    let on = |surface: &str, curve: &str| {
        format!(
            "#60=SURFACE_CURVE('',$,(#61),.PCURVE_S1.);#61=PCURVE('',#62,#63);#62={surface};\
            #63=DEFINITIONAL_REPRESENTATION('',(#64),#900);#64={curve};#65=CARTESIAN_POINT('',(0.,1.));#66=VECTOR('',#67,1.);"
        )
    };
    let line = |direction: &str| format!("LINE('',#65,#66);#67=DIRECTION('',{direction})");
    // A circle about a cylinder, a helix on it, a line on a plane, a parabola of a ruled surface's parameters.
    let (a, b) = ([2.0, 0.0, 1.0], [0.0, 2.0, 1.0]);
    let around = on("CYLINDRICAL_SURFACE('',#20,2.)", &line("(1.,0.)"));
    assert_on(&(ends(a, b) + &around), [a, b].map(DVec3::from_array), |p| {
        (p.truncate().length() - 2.0).abs() + (p.z - 1.0).abs()
    });
    let (a, b) = ([2.0, 0.0, 1.0], [0.0, 2.0, 1.0 + FRAC_PI_2]);
    let helix = on("CYLINDRICAL_SURFACE('',#20,2.)", &line("(1.,1.)"));
    assert_on(&(ends(a, b) + &helix), [a, b].map(DVec3::from_array), |p| {
        let u = p.z - 1.0;
        p.distance(DVec3::new(2.0 * u.cos(), 2.0 * u.sin(), p.z))
    });
    let (a, b) = ([0.0, 1.0, 0.0], [3.0, 4.0, 0.0]);
    assert_on(&(ends(a, b) + &on("PLANE('',#20)", &line("(1.,1.)"))), [a, b].map(DVec3::from_array), |p| {
        p.y - p.x - 1.0
    });
    let (a, b) = ([2.0, 0.0, 1.0], [-2.0, 0.0, 1.0]);
    let ruled = on(
        "SURFACE_OF_LINEAR_EXTRUSION('',#26,#68);#68=VECTOR('',#22,1.)",
        "POLYLINE('',(#65,#69));#69=CARTESIAN_POINT('',(3.141592653589793,1.))",
    );
    assert_on(&(ends(a, b) + &ruled), [a, b].map(DVec3::from_array), |p| {
        (p.truncate().length() - 2.0).abs() + (p.z - 1.0).abs()
    });
}

#[test]
fn vertices_on_curves_and_surfaces() {
    let vertex = "#30=POINT_ON_CURVE('',#26,1.5707963267948966);#31=POINT_ON_SURFACE('',#61,0.,4.);\
        #61=CYLINDRICAL_SURFACE('',#20,2.);#60=LINE('',#27,#62);#62=VECTOR('',#22,1.);";
    let (model, _) = edge_on(vertex);
    let points: Vec<DVec3> = model.vertices.iter().map(|v| v.point).collect();
    assert!(
        points[0].distance(DVec3::Y * 2.0) < 1e-12 && points[1].distance(DVec3::new(2.0, 0.0, 4.0)) < 1e-12
    );
    let moved = "#30=POINT_REPLICA('',#28,#61);#61=CARTESIAN_TRANSFORMATION_OPERATOR_3D('','',$,$,$,#27,3.,$);\
        #31=POINT_ON_SURFACE('',#63,1.5707963267948966,1.);#63=SURFACE_OF_REVOLUTION('',#29,#64);#64=AXIS1_PLACEMENT('',#21,#22);\
        #60=LINE('',#28,#25);";
    let (model, _) = edge_on(moved);
    let points: Vec<DVec3> = model.vertices.iter().map(|v| v.point).collect();
    assert!(
        points[0].distance(DVec3::new(6.0, 2.0, 0.0)) < 1e-12 && points[1].distance(DVec3::Y) < 1e-12,
        "{points:?}"
    );
    let circle = "#30=POINT_REPLICA('',#30,#61);#61=CARTESIAN_TRANSFORMATION_OPERATOR_3D('','',$,$,$,#27,3.,$);#31=$;#60=LINE('',#28,#25);";
    assert_eq!(edge_on(circle).0.faces.len(), 0);
}

#[test]
fn edges_without_vertices_end_with_their_curve() {
    let text = "#60=CIRCLE('',#20,3.);#30=DIRECTION('',(0.,0.,1.));#31=DIRECTION('',(0.,0.,1.));";
    let (model, edge) = edge_on(text);
    let edge = edge.expect("the circle is an edge");
    assert!((edge.range[1] - edge.range[0] - TAU).abs() < 1e-12 && edge.vertices[0] == edge.vertices[1]);
    assert!(model.diagnostics.iter().any(|d| d.entity == 13));
    let (model, edge) = edge_on(&text.replace("CIRCLE('',#20,3.)", "LINE('',#21,#25)"));
    assert!(edge.is_none() && model.faces.is_empty() && model.diagnostics.iter().any(|d| d.faces == 1));
}

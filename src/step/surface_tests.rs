//! Small files, each with a face between two circles on one kind of surface.

use super::read;
use super::tests::{MILLIMETRES, model};
use crate::geometry::{ParameterBox, Surface};
use glam::{DVec2, DVec3};

/// A face on surface #60, bounded by circles of radius 2 about z at heights 0 and 3, in an open shell.
pub fn tube(surface: &str) -> String {
    "#2=MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(#1),#900);#1=SHELL_BASED_SURFACE_MODEL('',(#3));#3=OPEN_SHELL('',(#5));\
     #5=ADVANCED_FACE('',(#6,#7),#60,.T.);#6=FACE_BOUND('',#8,.T.);#7=FACE_BOUND('',#9,.T.);#8=EDGE_LOOP('',(#10));\
     #9=EDGE_LOOP('',(#11));#10=ORIENTED_EDGE('',*,*,#12,.T.);#11=ORIENTED_EDGE('',*,*,#13,.F.);\
     #12=EDGE_CURVE('',#14,#14,#16,.T.);#13=EDGE_CURVE('',#15,#15,#17,.T.);#14=VERTEX_POINT('',#18);\
     #15=VERTEX_POINT('',#19);#16=CIRCLE('',#20,2.);#17=CIRCLE('',#21,2.);#18=CARTESIAN_POINT('',(2.,0.,0.));\
     #19=CARTESIAN_POINT('',(2.,0.,3.));#20=AXIS2_PLACEMENT_3D('',#22,$,$);#21=AXIS2_PLACEMENT_3D('',#23,$,$);\
     #22=CARTESIAN_POINT('',(0.,0.,0.));#23=CARTESIAN_POINT('',(0.,0.,3.));#30=DIRECTION('',(0.,0.,1.));\
     #31=DIRECTION('',(0.,0.,-1.));#32=VECTOR('',#30,1.);#33=VECTOR('',#31,1.);#34=AXIS1_PLACEMENT('',#22,#30);\
     #35=LINE('',#18,#32);#36=LINE('',#18,#33);#37=DIRECTION('',(1.,0.,1.));#38=VECTOR('',#37,1.);\
     #39=LINE('',#18,#38);#40=DIRECTION('',(0.,1.,0.));#41=AXIS2_PLACEMENT_3D('',#22,#40,$);\
     #42=AXIS2_PLACEMENT_3D('',#18,#40,$);"
        .to_owned()
        + surface
}

#[test]
fn swept_surfaces_are_recognised_and_keep_their_sense() {
    let cases = [
        ("#60=CYLINDRICAL_SURFACE('',#20,2.);", "cylinder", true),
        ("#60=SURFACE_OF_LINEAR_EXTRUSION('',#16,#32);", "cylinder", true),
        ("#60=SURFACE_OF_LINEAR_EXTRUSION('',#16,#33);", "cylinder", false),
        ("#60=SURFACE_OF_REVOLUTION('',#35,#34);", "cylinder", true),
        ("#60=SURFACE_OF_REVOLUTION('',#36,#34);", "cylinder", false),
        ("#60=SURFACE_OF_REVOLUTION('',#39,#34);", "cone", true),
        (
            "#60=RECTANGULAR_TRIMMED_SURFACE('',#61,0.,1.,0.,1.,.T.,.F.);#61=CYLINDRICAL_SURFACE('',#20,2.);",
            "cylinder",
            false,
        ),
        ("#60=SURFACE_OF_REVOLUTION('',#61,#34);#61=CIRCLE('',#41,2.);", "sphere", false),
        ("#60=SURFACE_OF_REVOLUTION('',#61,#34);#61=CIRCLE('',#42,0.5);", "torus", false),
        ("#60=TOROIDAL_SURFACE('',#20,2.,0.5);", "torus", true),
        ("#60=DEGENERATE_TOROIDAL_SURFACE('',#20,2.,1.,.T.);", "torus", true),
        ("#60=TOROIDAL_SURFACE('',#20,-2.,0.5);", "torus", false),
        ("#60=TOROIDAL_SURFACE('',#20,2.,-0.5);", "torus", true),
        ("#60=CYLINDRICAL_SURFACE('',#20,-2.);", "cylinder", true),
        ("#60=SPHERICAL_SURFACE('',#20,-4.);", "sphere", false),
        ("#60=CONICAL_SURFACE('',#20,2.,0.);", "cylinder", true),
        ("#60=CONICAL_SURFACE('',#20,2.,-0.3);", "cone", true),
        ("#60=CONICAL_SURFACE('',#20,2.,2.8415926535897933);", "cone", true),
        ("#60=CONICAL_SURFACE('',#20,-1.,0.5);", "cone", true),
        ("#60=SURFACE_OF_LINEAR_EXTRUSION('',#61,#32);#61=ELLIPSE('',#20,3.,2.);", "bspline", true),
        (
            "#60=SURFACE_OF_REVOLUTION('',#61,#34);#61=POLYLINE('',(#18,#62,#19));#62=CARTESIAN_POINT('',(3.,0.,1.));",
            "bspline",
            true,
        ),
    ];
    for (text, kind, same_sense) in cases {
        let model = model(&tube(text));
        let face = model.faces.iter().next().unwrap_or_else(|| panic!("{text}: {:?}", model.diagnostics));
        let surface = &model.surfaces[face.surface];
        assert_eq!((surface.kind(), face.same_sense), (kind, same_sense), "{text}");
    }
}

#[test]
fn a_closed_edge_runs_all_around() {
    let model = model(&tube("#60=CYLINDRICAL_SURFACE('',#20,2.);"));
    for edge in model.edges.iter() {
        assert!((edge.range[1] - edge.range[0] - std::f64::consts::TAU).abs() < 1e-12);
    }
}

#[test]
fn pcurves_are_brought_to_our_parameters() {
    let degrees = "#902=(CONVERSION_BASED_UNIT('DEGREE',#903) NAMED_UNIT($) PLANE_ANGLE_UNIT());\
        #903=PLANE_ANGLE_MEASURE_WITH_UNIT(PLANE_ANGLE_MEASURE(0.0174532925199433),#904);\
        #904=(NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.));";
    let data = tube("#60=CYLINDRICAL_SURFACE('',#20,2.);")
        .replace("#13=EDGE_CURVE('',#15,#15,#17,.T.)", "#13=EDGE_CURVE('',#15,#15,#70,.T.)")
        + "#70=SURFACE_CURVE('',#17,(#71),.PCURVE_S1.);#71=PCURVE('',#60,#72);#72=DEFINITIONAL_REPRESENTATION('',(#73),#900);\
           #73=LINE('',#74,#75);#74=CARTESIAN_POINT('',(90.,3.));#75=VECTOR('',#76,1.);#76=DIRECTION('',(1.,0.));";
    let text =
        format!("ISO-10303-21;HEADER;ENDSEC;DATA;{degrees}{MILLIMETRES}{data}ENDSEC;END-ISO-10303-21;");
    let model = read(text.as_bytes()).expect("the file has entities");
    let edge = model.edges.iter().find(|e| e.entity == 13).expect("the edge is used");
    let point = edge.pcurves[0].curve.point(1.0);
    assert!(point.distance(DVec2::new(std::f64::consts::FRAC_PI_2 + 1.0, 3.0)) < 1e-9, "{point}");
}

#[test]
fn rational_and_knotless_splines() {
    let rational = model(&tube(
        "#60=(BOUNDED_SURFACE() B_SPLINE_SURFACE(1,1,((#18,#19),(#22,#23)),.UNSPECIFIED.,.F.,.F.,.F.) \
         B_SPLINE_SURFACE_WITH_KNOTS((2,2),(2,2),(0.,1.),(0.,2.),.UNSPECIFIED.) GEOMETRIC_REPRESENTATION_ITEM() \
         RATIONAL_B_SPLINE_SURFACE(((1.,0.5),(1.,1.))) REPRESENTATION_ITEM('') SURFACE());",
    ));
    assert_eq!(rational.faces.len(), 1);
    let Surface::Bspline(surface) = &rational.surfaces[rational.faces.iter().next().expect("one").surface]
    else {
        panic!("a spline")
    };
    assert_eq!(surface.points[1].w, 0.5);
    let knotless =
        model(&tube("#60=BEZIER_SURFACE('',1,1,((#18,#19),(#22,#23)),.UNSPECIFIED.,.F.,.F.,.F.);"));
    assert_eq!(knotless.faces.len(), 1);
    let broken = model(&tube(
        "#60=B_SPLINE_SURFACE_WITH_KNOTS('',1,1,((#18,#19),(#22,#23)),.UNSPECIFIED.,.F.,.F.,.F.,(2,999999999,2),(2,2),(0.,0.5,1.),(0.,2.),.U.);",
    ));
    assert_eq!(broken.faces.len(), 0);
}

/// The surface of the tube's face.
fn surface(text: &str) -> Surface {
    let model = model(&tube(text));
    let face = model.faces.iter().next().unwrap_or_else(|| panic!("{text}: {:?}", model.diagnostics));
    model.surfaces[face.surface].clone()
}

/// Points of a surface over a grid of its domain, its ends included.
fn grid(surface: &Surface) -> Vec<DVec3> {
    let ParameterBox { min, max } = surface.domain();
    let at = |i: i32| f64::from(i % 17) / 16.0;
    (0..17 * 17).map(|i| surface.point(min + (max - min) * DVec2::new(at(i), at(i / 17)))).collect()
}

#[test]
fn odd_numbers_give_the_surface_of_the_formula() {
    let Surface::Cone { frame, radius, half_angle } = surface("#60=CONICAL_SURFACE('',#20,-1.,0.5);") else {
        panic!("a cone")
    };
    // frame((−1 + v tan 0.5) cos u, .., v) has radius 2 at v = 3 / tan 0.5.
    let height = 3.0 / 0.5_f64.tan();
    assert!((radius + (height - frame.origin.z) * half_angle.tan() - 2.0).abs() < 1e-12);
    let Surface::Cone { half_angle, .. } = surface("#60=CONICAL_SURFACE('',#20,2.,2.8415926535897933);")
    else {
        panic!("a cone")
    };
    assert!((half_angle + 0.3).abs() < 1e-12);
    for bad in [
        "CONICAL_SURFACE('',#20,2.,1.5707963267948966)",
        "SPHERICAL_SURFACE('',#20,0.)",
        "TOROIDAL_SURFACE('',#20,2.,0.)",
    ] {
        let model = model(&tube(&format!("#60={bad};")));
        assert!(model.faces.is_empty() && model.diagnostics.iter().any(|d| d.faces == 1), "{bad}");
    }
}

#[test]
fn sheets_of_a_spindle_torus() {
    // The circle about (1, 0) of radius 2 crosses the axis at heights ±√3; the sheets are what it has on its two sides.
    for (flag, extreme) in [(".T.", 3.0), (".F.", 1.0)] {
        let sheet = surface(&format!("#60=DEGENERATE_TOROIDAL_SURFACE('',#20,1.,2.,{flag});"));
        let points = grid(&sheet);
        for p in &points {
            let across = p.truncate().length();
            let side = if flag == ".T." { across - 1.0 } else { across + 1.0 };
            assert!((side.hypot(p.z) - 2.0).abs() < 1e-12, "{flag}: {p}");
        }
        let widest = points.iter().map(|p| p.truncate().length()).fold(0.0, f64::max);
        assert!((widest - extreme).abs() < 1e-12, "{flag}: {widest}");
        assert_eq!(sheet.singularities().len(), 2);
    }
}

#[test]
fn profiles_that_meet_the_axis_are_turned_once() {
    // A paraboloid and the half of an ellipse; #43 stands upright in the plane y = 0 with its x axis along z.
    for (profile, off) in [
        (
            "#61=PARABOLA('',#43,0.3333333333333333)",
            (|p: DVec3| p.truncate().length_squared() * 0.75 - p.z) as fn(DVec3) -> f64,
        ),
        ("#61=ELLIPSE('',#43,5.,2.5)", |p| (p.z / 5.0).powi(2) + p.truncate().length_squared() / 6.25 - 1.0),
        ("#61=HYPERBOLA('',#43,1.,0.7071067811865476)", |p| {
            p.z * p.z - p.truncate().length_squared() * 2.0 - 1.0
        }),
    ] {
        let text = format!(
            "#60=SURFACE_OF_REVOLUTION('',#61,#34);{profile};#43=AXIS2_PLACEMENT_3D('',#22,#44,#30);#44=DIRECTION('',(0.,-1.,0.));"
        );
        // One circle around the dome, whose top it does not touch.
        let model = model(&tube(&text).replace("(#6,#7)", "(#7)"));
        let face = model.faces.iter().next().unwrap_or_else(|| panic!("{profile}: {:?}", model.diagnostics));
        let surface = &model.surfaces[face.surface];
        let points = grid(surface);
        assert!(points.iter().all(|p| off(*p).abs() < 1e-9), "{profile}");
        let domain = surface.domain();
        let ends = [domain.min, domain.max].map(|uv| surface.point(uv).truncate().length());
        assert!(ends[0].min(ends[1]) < 1e-7, "{profile} has its top on the axis");
        let side = |v: f64| surface.point(DVec2::new(domain.min.x, v)).x;
        let inner = (1..16).map(|i| side(domain.min.y + (domain.max.y - domain.min.y) * f64::from(i) / 16.0));
        let signs: Vec<bool> = inner.map(|x| x > 0.0).collect();
        assert!(signs.iter().all(|s| *s == signs[0]), "{profile} stays on one side");
    }
}

#[test]
fn replicas_and_offsets_of_all_kinds() {
    let moved = "#60=SURFACE_REPLICA('',#61,#62);#61=OFFSET_SURFACE('',#63,-0.5,.F.);#63=SURFACE_OF_LINEAR_EXTRUSION('',#64,#32);\
        #64=TRIMMED_CURVE('',#65,(PARAMETER_VALUE(0.)),(PARAMETER_VALUE(6.283185307179586)),.T.,.PARAMETER.);#65=CIRCLE('',#20,1.5);\
        #62=CARTESIAN_TRANSFORMATION_OPERATOR_3D('','',$,$,$,#22,2.,$);";
    let Surface::Cylinder { radius, .. } = surface(moved) else { panic!("a cylinder") };
    assert!((radius - 2.0).abs() < 1e-12);
    let circle = model(&tube(
        "#60=SURFACE_REPLICA('',#61,#62);#61=OFFSET_SURFACE('',#60,0.5,.F.);#62=AXIS2_PLACEMENT_3D('',#22,$,$);",
    ));
    assert!(circle.faces.is_empty() && circle.diagnostics.iter().any(|d| d.reason.contains("circle")));
    let through_curves = model(&tube(
        "#60=SURFACE_OF_LINEAR_EXTRUSION('',#61,#32);#61=SURFACE_CURVE('',$,(#62),.PCURVE_S1.);#62=PCURVE('',#63,#64);\
         #63=RECTANGULAR_TRIMMED_SURFACE('',#60,0.,1.,0.,1.,.T.,.T.);#64=DEFINITIONAL_REPRESENTATION('',(#35),#900);",
    ));
    assert!(through_curves.faces.is_empty() && through_curves.diagnostics.iter().any(|d| d.faces == 1));
}

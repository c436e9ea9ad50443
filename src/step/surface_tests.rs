//! Small files, each with a face between two circles on one kind of surface.

use super::read;
use super::tests::{MILLIMETRES, model};
use crate::geometry::Surface;
use glam::DVec2;

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
        ("#60=DEGENERATE_TOROIDAL_SURFACE('',#20,1.,2.,.T.);", "torus", true),
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
        "#60=B_SPLINE_SURFACE_WITH_KNOTS('',1,1,((#18,#19),(#22,#23)),.UNSPECIFIED.,.F.,.F.,.F.,(999999999,2),(2,2),(0.,1.),(0.,2.),.U.);",
    ));
    assert_eq!(broken.faces.len(), 0);
}

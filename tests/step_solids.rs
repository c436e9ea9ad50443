//! Solids whose faces a STEP file does not list, held against their volumes: parallel rays through the baked scene cross each solid
//! an even number of times, in by a face whose normal points against them and out by one that points along.

use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use trimray::bake::{BakeOptions, bake};
use trimray::brep::{BodyKind, Model};
use trimray::geometry::Frame;
use trimray::render::Ray;
use trimray::render::cpu::{Precision, probe};

/// Rays along each side of a square that holds the shape.
const RAYS: usize = 96;

const COMMON: &str = "#2=SHAPE_REPRESENTATION('',(#1),#900);#900=(GEOMETRIC_REPRESENTATION_CONTEXT(3) \
    GLOBAL_UNIT_ASSIGNED_CONTEXT((#901,#902)) REPRESENTATION_CONTEXT('',''));\
    #901=(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.));#902=(NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.));\
    #10=CARTESIAN_POINT('',(1.,2.,3.));#11=DIRECTION('',(0.,0.6,0.8));#12=DIRECTION('',(1.,0.,0.));\
    #13=AXIS2_PLACEMENT_3D('',#10,#11,#12);#14=AXIS1_PLACEMENT('',#10,#11);#15=PLANE('',#20);#20=AXIS2_PLACEMENT_3D('',#21,$,$);\
    #21=CARTESIAN_POINT('',(0.,0.,0.));#22=DIRECTION('',(0.,0.,1.));#23=DIRECTION('',(0.,1.,0.));#24=AXIS1_PLACEMENT('',#21,#23);\
    #25=DIRECTION('',(0.,0.5,1.));#26=CARTESIAN_POINT('',(5.,0.,0.));#27=AXIS2_PLACEMENT_3D('',#26,$,$);";

fn read(data: &str) -> Model {
    let text = format!("ISO-10303-21;HEADER;ENDSEC;DATA;{COMMON}{data}ENDSEC;END-ISO-10303-21;");
    let model = trimray::step::read(text.as_bytes()).expect("the file has entities");
    let lost: usize = model.diagnostics.iter().map(|d| d.faces as usize).sum();
    assert_eq!(model.declared_faces, model.faces.len() + lost, "{data}");
    model
}

/// The volume of what is in the file, by rays.
fn volume(data: &str) -> f64 {
    let model = read(data);
    assert!(model.diagnostics.is_empty(), "{data}: {:?}", model.diagnostics);
    assert!(model.parts.iter().flat_map(|p| &p.bodies).all(|body| body.kind == BodyKind::Solid));
    let baked = bake(&model, &BakeOptions { keep_f64: true, ..BakeOptions::default() }, &|_, _| ());
    let scene = baked.scene();
    assert_eq!(scene.faces.len(), model.faces.len(), "{data}: {:?}", scene.metadata.findings);
    // No direction of any of the shapes, so that no ray runs along a face.
    let frame = Frame::from_axes(DVec3::ZERO, Some(DVec3::new(0.31, 0.52, 0.79)), None);
    let radius = 30.0;
    let step = 2.0 * radius / RAYS as f64;
    let at = |i: usize| (i as f64 + 0.5) * step - radius;
    let rays: Vec<Ray> = (0..RAYS * RAYS)
        .map(|i| Ray {
            origin: frame.point(DVec3::new(at(i % RAYS), at(i / RAYS), -100.0)),
            direction: frame.z,
        })
        .collect();
    let mut inside = 0.0;
    for hits in probe(&scene, &rays, Precision::F64, false) {
        assert!(hits.len() % 2 == 0, "{data}: {} hits on a ray", hits.len());
        for (i, hit) in hits.iter().enumerate() {
            let is_out = i % 2 == 1;
            assert_eq!(
                hit.normal.dot(frame.z) > 0.0,
                is_out,
                "{data}: hit {i} of {}, face {}",
                hits.len(),
                hit.face
            );
            inside += if is_out { hit.t } else { -hit.t };
        }
    }
    inside * step * step
}

fn check(data: &str, expected: f64) {
    let found = volume(data);
    // A hundredth, and half a cubic millimetre that the grid of rays may miss of small solids.
    assert!((found - expected).abs() < 0.01 * expected + 0.5, "{data}: {found} mm³ instead of {expected}");
}

/// A ring of lines through `corners` as composite curve `id`, run as they stand.
fn polyline(id: u32, kind: &str, corners: &[[f64; 2]]) -> String {
    let points: String = (0..)
        .zip(corners)
        .map(|(i, [x, y])| format!("#{}=CARTESIAN_POINT('',({x:?},{y:?},0.));", id + 10 + i))
        .collect();
    let names: Vec<String> =
        (0..=corners.len()).map(|i| format!("#{}", id as usize + 10 + i % corners.len())).collect();
    format!(
        "#{id}={kind}('',(#{a}),.F.);#{a}=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#{b});#{b}=POLYLINE('',({names}));{points}",
        a = id + 1,
        b = id + 2,
        names = names.join(",")
    )
}

#[test]
fn primitives() {
    check("#1=BLOCK('',#13,20.,10.,15.);", 3000.0);
    check("#1=RIGHT_ANGULAR_WEDGE('',#13,20.,10.,15.,8.);", 14.0 * 10.0 * 15.0);
    check("#1=RIGHT_ANGULAR_WEDGE('',#13,20.,10.,15.,0.);", 1500.0);
    check("#1=SPHERE('',12.,#10);", 4.0 / 3.0 * PI * 12.0_f64.powi(3));
    check("#1=RIGHT_CIRCULAR_CYLINDER('',#14,20.,8.);", PI * 64.0 * 20.0);
    check("#1=RIGHT_CIRCULAR_CONE('',#14,15.,0.,0.6);", PI * 15.0_f64.powi(3) * 0.6_f64.tan().powi(2) / 3.0);
    let far = 5.0 + 15.0 * 0.3_f64.tan();
    check("#1=RIGHT_CIRCULAR_CONE('',#14,15.,5.,0.3);", PI * 15.0 * (25.0 + 5.0 * far + far * far) / 3.0);
    check("#1=TORUS('',#14,14.,5.);", 2.0 * PI * PI * 14.0 * 25.0);
    check("#1=RECTANGULAR_PYRAMID('',#13,12.,8.,10.);", 320.0);
    check("#1=TETRAHEDRON('',(#10,#21,#26,#6));#6=CARTESIAN_POINT('',(1.,2.,-9.));", 20.0);
    let top: String = (0..8)
        .map(|i| {
            format!(
                "#{}=CARTESIAN_POINT('',({}.,{}.,{}.));",
                40 + i,
                [0, 10, 10, 0][i % 4],
                [0, 0, 6, 6][i % 4],
                8 * (i / 4)
            )
        })
        .collect();
    check(&("#1=CONVEX_HEXAHEDRON('',(#40,#41,#42,#43,#44,#45,#46,#47));".to_owned() + &top), 480.0);
    check("#1=ELLIPSOID('',#13,12.,8.,10.);", 4.0 / 3.0 * PI * 960.0);
    check("#1=CSG_SOLID('',#3);#3=BLOCK('',#13,20.,10.,15.);", 3000.0);
    check(
        "#1=CSG_SOLID('',#3);#3=BOOLEAN_RESULT('',.UNION.,#4,#5);#4=SPHERE('',4.,#26);#5=SPHERE('',4.,#6);\
           #6=CARTESIAN_POINT('',(-5.,0.,0.));",
        8.0 / 3.0 * PI * 64.0,
    );
}

#[test]
fn extrusions() {
    // A hexagon with a hole, at a slant.
    let hexagon = [[10.0, 0.0], [5.0, 9.0], [-5.0, 9.0], [-10.0, 0.0], [-5.0, -9.0], [5.0, -9.0]];
    let hole = "#60=BOUNDARY_CURVE('',(#61),.F.);#61=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.F.,#62);#62=CIRCLE('',#20,4.);";
    let area = "#3=CURVE_BOUNDED_SURFACE('',#15,(#40,#60),.F.);".to_owned()
        + &polyline(40, "OUTER_BOUNDARY_CURVE", &hexagon)
        + hole;
    let height = 12.0 / (1.25_f64).sqrt();
    check(&("#1=EXTRUDED_AREA_SOLID('',#3,#25,12.);".to_owned() + &area), (270.0 - 16.0 * PI) * height);
    // A face between an ellipse and a line; the face counts as one of the solid's.
    let face = "#3=FACE_SURFACE('',(#4),#15,.T.);#4=FACE_OUTER_BOUND('',#5,.T.);#5=EDGE_LOOP('',(#6,#7));#6=ORIENTED_EDGE('',*,*,#30,.T.);\
        #7=ORIENTED_EDGE('',*,*,#31,.F.);#30=EDGE_CURVE('',#32,#33,#34,.T.);#31=EDGE_CURVE('',#32,#33,#35,.T.);\
        #32=VERTEX_POINT('',#36);#33=VERTEX_POINT('',#37);#34=ELLIPSE('',#20,12.,8.);#35=LINE('',#36,#38);\
        #36=CARTESIAN_POINT('',(12.,0.,0.));#37=CARTESIAN_POINT('',(-12.,0.,0.));#38=VECTOR('',#12,1.);";
    let solid = "#1=EXTRUDED_FACE_SOLID('',#3,#22,10.);".to_owned() + face;
    assert_eq!(read(&solid).diagnostics.len(), 1, "the profile is said to be one");
    let model = read(&solid);
    assert_eq!((model.declared_faces, model.faces.len()), (5, 4));
}

#[test]
fn revolutions() {
    let square = |x: f64| [[x, -3.0], [x + 4.0, -3.0], [x + 4.0, 3.0], [x, 3.0]];
    for (angle, x) in [(TAU, 8.0), (FRAC_PI_2, 8.0), (4.0, 8.0), (-1.0, 8.0), (TAU, 0.0), (2.0, 0.0)] {
        let data = format!(
            "#1=REVOLVED_AREA_SOLID('',#3,#24,{angle:?});#3=CURVE_BOUNDED_SURFACE('',#15,(#40),.F.);"
        ) + &polyline(40, "OUTER_BOUNDARY_CURVE", &square(x));
        // Pappus: the way of the centre times the area.
        check(&data, 24.0 * (x + 2.0) * angle.abs());
    }
    // Slanted sides and a tip on the axis: a cone on a cone.
    let kite = [[0.0, -8.0], [9.0, 0.0], [0.0, 5.0]];
    let data = "#1=REVOLVED_AREA_SOLID('',#3,#24,6.283185307);#3=CURVE_BOUNDED_SURFACE('',#15,(#40),.F.);"
        .to_owned()
        + &polyline(40, "OUTER_BOUNDARY_CURVE", &kite);
    check(&data, PI * 81.0 * 13.0 / 3.0);
    // An ellipse has no closed form about an axis.
    for (angle, count) in [(TAU, 1), (3.0, 3)] {
        let data = format!(
            "#1=REVOLVED_AREA_SOLID('',#3,#24,{angle:?});#3=CURVE_BOUNDED_SURFACE('',#15,(#60),.F.);#60=BOUNDARY_CURVE('',(#61),.F.);\
             #61=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#62);#62=ELLIPSE('',#63,3.,5.);#63=AXIS2_PLACEMENT_3D('',#64,$,$);\
             #64=CARTESIAN_POINT('',(9.,0.,0.));"
        );
        assert_eq!(read(&data).faces.len(), count);
        check(&data, 15.0 * PI * 9.0 * angle);
    }
}

#[test]
fn disks_along_lines_and_arcs() {
    let line = "#40=TRIMMED_CURVE('',#41,(PARAMETER_VALUE(0.)),(PARAMETER_VALUE(1.)),.T.,.PARAMETER.);#41=LINE('',#21,#42);\
        #42=VECTOR('',#11,12.);";
    check(&format!("#1=SWEPT_DISK_SOLID('',#40,4.,2.,0.,1.);{line}"), 12.0 * 12.0 * PI);
    check(&format!("#1=SWEPT_DISK_SOLID('',#40,4.,$,$,$);{line}"), 12.0 * 16.0 * PI);
    check(
        "#1=SWEPT_DISK_SOLID('',#40,3.,1.,0.,6.283185307179586);#40=CIRCLE('',#13,12.);",
        8.0 * PI * 24.0 * PI,
    );
    // A line of length 10, then a quarter of a circle about (0, 8, 0).
    let bend = "#40=COMPOSITE_CURVE('',(#43,#44),.F.);#43=COMPOSITE_CURVE_SEGMENT(.CONT_SAME_GRADIENT.,.T.,#45);\
        #44=COMPOSITE_CURVE_SEGMENT(.DISCONTINUOUS.,.T.,#46);#45=POLYLINE('',(#47,#21));#47=CARTESIAN_POINT('',(-10.,0.,0.));\
        #46=TRIMMED_CURVE('',#48,(#21),(#49),.T.,.CARTESIAN.);#48=CIRCLE('',#50,8.);#49=CARTESIAN_POINT('',(8.,8.,0.));\
        #50=AXIS2_PLACEMENT_3D('',#51,$,$);#51=CARTESIAN_POINT('',(0.,8.,0.));";
    check(&format!("#1=SWEPT_DISK_SOLID('',#40,3.,$,$,$);{bend}"), 9.0 * PI * (10.0 + 4.0 * PI));
}

#[test]
fn replicas_are_copies() {
    // Twice as large, mirrored.
    let replica = "#1=SOLID_REPLICA('',#3,#4);#3=BLOCK('',#13,10.,5.,8.);\
        #4=CARTESIAN_TRANSFORMATION_OPERATOR_3D('','',$,#12,#5,#21,2.,#22);#5=DIRECTION('',(0.,-1.,0.));";
    check(replica, 3200.0);
    let circle = "#1=SOLID_REPLICA('',#3,#4);#3=SOLID_REPLICA('',#1,#4);\
        #4=CARTESIAN_TRANSFORMATION_OPERATOR_3D('','',$,#12,$,#21,1.,#22);";
    assert!(read(circle).diagnostics.iter().any(|d| d.reason.contains("in a circle")));
}

#[test]
fn what_is_not_computed_is_refused() {
    for (data, reason) in [
        ("#1=BOOLEAN_RESULT('',.DIFFERENCE.,#3,#4);#3=SPHERE('',4.,#21);#4=SPHERE('',4.,#26);", "difference"),
        ("#1=BOOLEAN_RESULT('',.UNION.,#3,#4);#3=SPHERE('',4.,#21);#4=SPHERE('',4.,#26);", "may meet"),
        ("#1=CSG_SOLID('',#3);#3=BOOLEAN_RESULT('',.UNION.,#3,#3);", "circle"),
        ("#1=HALF_SPACE_SOLID('',#15,.T.);", "half space"),
        ("#1=SPHERE('',-4.,#21);", "greater than 0"),
        ("#1=TORUS('',#14,4.,5.);", "meets itself"),
        ("#1=SWEPT_DISK_SOLID('',#40,4.,$,$,$);#40=POLYLINE('',(#10,#21,#26));", "corner"),
    ] {
        let model = read(data);
        assert_eq!(model.faces.len(), 0, "{data}");
        assert!(
            model.diagnostics.iter().any(|d| d.reason.contains(reason)),
            "{data}: {:?}",
            model.diagnostics
        );
    }
    // A profile across the axis would go through itself.
    let data = "#1=REVOLVED_AREA_SOLID('',#3,#24,1.);#3=CURVE_BOUNDED_SURFACE('',#15,(#40),.F.);".to_owned()
        + &polyline(40, "OUTER_BOUNDARY_CURVE", &[[-1.0, 0.0], [5.0, 0.0], [5.0, 4.0]]);
    assert!(read(&data).diagnostics.iter().any(|d| d.reason.contains("crosses the profile")));
}

//! Texts of small files.

use std::fmt::Write;

/// A STEP file with these instances, millimetres and radians in context #900.
pub fn step(data: &str) -> String {
    format!(
        "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\n\
         #900=(GEOMETRIC_REPRESENTATION_CONTEXT(3) GLOBAL_UNIT_ASSIGNED_CONTEXT((#901,#902)) REPRESENTATION_CONTEXT('',''));\n\
         #901=(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.));\n\
         #902=(NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.));\n\
         {data}\nENDSEC;\nEND-ISO-10303-21;\n"
    )
}

/// The instances of one square face #10 in the open shell #2 of the surface model #1, held by representation #3.
pub const PLATE: &str = "#1=SHELL_BASED_SURFACE_MODEL('',(#2));\n#2=OPEN_SHELL('',(#10));\n\
    #3=MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(#1),#900);\n\
    #10=ADVANCED_FACE('',(#11),#12,.T.);\n#11=FACE_OUTER_BOUND('',#13,.T.);\n#12=PLANE('',#14);\n\
    #13=EDGE_LOOP('',(#21,#22,#23,#24));\n#14=AXIS2_PLACEMENT_3D('',#31,$,$);\n\
    #21=ORIENTED_EDGE('',*,*,#25,.T.);\n#22=ORIENTED_EDGE('',*,*,#26,.T.);\n#23=ORIENTED_EDGE('',*,*,#27,.T.);\n\
    #24=ORIENTED_EDGE('',*,*,#28,.T.);\n#25=EDGE_CURVE('',#41,#42,#51,.T.);\n#26=EDGE_CURVE('',#42,#43,#52,.T.);\n\
    #27=EDGE_CURVE('',#43,#44,#53,.T.);\n#28=EDGE_CURVE('',#44,#41,#54,.T.);\n\
    #31=CARTESIAN_POINT('',(0.,0.,0.));\n#32=CARTESIAN_POINT('',(1.,0.,0.));\n#33=CARTESIAN_POINT('',(1.,1.,0.));\n\
    #34=CARTESIAN_POINT('',(0.,1.,0.));\n#41=VERTEX_POINT('',#31);\n#42=VERTEX_POINT('',#32);\n#43=VERTEX_POINT('',#33);\n\
    #44=VERTEX_POINT('',#34);\n#51=LINE('',#31,#61);\n#52=LINE('',#32,#62);\n#53=LINE('',#33,#63);\n#54=LINE('',#34,#64);\n\
    #61=VECTOR('',#71,1.);\n#62=VECTOR('',#72,1.);\n#63=VECTOR('',#73,1.);\n#64=VECTOR('',#74,1.);\n\
    #71=DIRECTION('',(1.,0.,0.));\n#72=DIRECTION('',(0.,1.,0.));\n#73=DIRECTION('',(-1.,0.,0.));\n#74=DIRECTION('',(0.,-1.,0.));\n";

/// [`PLATE`] with the instance that begins with `name` replaced, and `more`.
pub fn plate_with(name: &str, replacement: &str, more: &str) -> String {
    let at = PLATE.find(&format!("{name}=")).expect("the plate has the instance");
    let end = at + PLATE[at..].find('\n').expect("a line");
    step(&format!("{}{name}={replacement}{}\n{more}", &PLATE[..at], &PLATE[end..]))
}

/// Bounded surfaces of every kind without topology, in a set #1 held by representation #2, and a boundary of curves of every kind.
pub const SURFACES: &str = "#2=GEOMETRICALLY_BOUNDED_SURFACE_SHAPE_REPRESENTATION('',(#1),#900);\n\
    #1=GEOMETRIC_SET('',(#101,#102,#103,#104,#105,#106,#107,#108,#109,#110));\n\
    #101=RECTANGULAR_TRIMMED_SURFACE('',#201,0.,1.,0.,2.,.T.,.T.);\n#201=PLANE('',#20);\n\
    #102=RECTANGULAR_TRIMMED_SURFACE('',#202,0.5,4.,0.,2.,.T.,.T.);\n#202=CYLINDRICAL_SURFACE('',#20,3.);\n\
    #103=RECTANGULAR_TRIMMED_SURFACE('',#203,0.,6.283185307179586,-1.,2.,.T.,.T.);\n#203=CONICAL_SURFACE('',#20,3.,0.4);\n\
    #104=RECTANGULAR_TRIMMED_SURFACE('',#204,1.,2.,-1.,1.5,.T.,.F.);\n#204=SPHERICAL_SURFACE('',#20,2.5);\n\
    #105=RECTANGULAR_TRIMMED_SURFACE('',#205,5.,1.,0.5,4.,.T.,.T.);\n#205=TOROIDAL_SURFACE('',#20,4.,1.5);\n\
    #106=RECTANGULAR_TRIMMED_SURFACE('',#206,0.,1.,0.,3.,.T.,.T.);\n#206=SURFACE_OF_LINEAR_EXTRUSION('',#30,#40);\n\
    #107=RECTANGULAR_TRIMMED_SURFACE('',#207,0.3,2.,0.,1.,.T.,.T.);\n#207=SURFACE_OF_REVOLUTION('',#30,#50);\n\
    #108=(BOUNDED_SURFACE() B_SPLINE_SURFACE(2,1,((#11,#12),(#13,#14),(#15,#16)),.UNSPECIFIED.,.F.,.F.,.F.) \
    B_SPLINE_SURFACE_WITH_KNOTS((3,3),(2,2),(0.,1.),(0.,1.),.UNSPECIFIED.) GEOMETRIC_REPRESENTATION_ITEM() \
    RATIONAL_B_SPLINE_SURFACE(((1.,1.),(0.7,0.7),(1.,1.))) REPRESENTATION_ITEM('') SURFACE());\n\
    #109=OFFSET_SURFACE('',#108,0.25,.F.);\n#110=CURVE_BOUNDED_SURFACE('',#201,(#60),.F.);\n\
    #11=CARTESIAN_POINT('',(0.,0.,0.));\n#12=CARTESIAN_POINT('',(0.,2.,0.));\n#13=CARTESIAN_POINT('',(1.,0.,1.));\n\
    #14=CARTESIAN_POINT('',(1.,2.,1.5));\n#15=CARTESIAN_POINT('',(2.,0.,0.));\n#16=CARTESIAN_POINT('',(2.,2.,0.2));\n\
    #20=AXIS2_PLACEMENT_3D('',#11,#21,#22);\n#21=DIRECTION('',(0.,0.,1.));\n#22=DIRECTION('',(1.,0.,0.));\n\
    #30=B_SPLINE_CURVE_WITH_KNOTS('',2,(#11,#13,#15),.UNSPECIFIED.,.F.,.F.,(3,3),(0.,1.),.UNSPECIFIED.);\n\
    #40=VECTOR('',#41,2.);\n#41=DIRECTION('',(0.,1.,0.));\n#50=AXIS1_PLACEMENT('',#51,#41);\n#51=CARTESIAN_POINT('',(9.,0.,0.));\n\
    #60=BOUNDARY_CURVE('',(#61,#62,#63,#64,#65),.F.);\n#61=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#71);\n\
    #62=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#72);\n#63=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#73);\n\
    #64=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#74);\n#65=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#75);\n\
    #71=TRIMMED_CURVE('',#81,(PARAMETER_VALUE(0.)),(PARAMETER_VALUE(1.5707963267948966)),.T.,.PARAMETER.);\n#81=CIRCLE('',#20,2.);\n\
    #72=TRIMMED_CURVE('',#82,(PARAMETER_VALUE(1.5707963267948966)),(PARAMETER_VALUE(3.141592653589793)),.T.,.PARAMETER.);\n\
    #82=ELLIPSE('',#20,1.,2.);\n\
    #73=TRIMMED_CURVE('',#83,(PARAMETER_VALUE(-1.)),(PARAMETER_VALUE(0.)),.T.,.PARAMETER.);\n#83=PARABOLA('',#91,0.5);\n\
    #91=AXIS2_PLACEMENT_3D('',#92,#21,#22);\n#92=CARTESIAN_POINT('',(-1.5,1.,0.));\n\
    #74=TRIMMED_CURVE('',#84,(PARAMETER_VALUE(0.)),(PARAMETER_VALUE(1.)),.T.,.PARAMETER.);\n#84=HYPERBOLA('',#93,1.,0.5);\n\
    #93=AXIS2_PLACEMENT_3D('',#94,#21,#22);\n#94=CARTESIAN_POINT('',(-2.5,1.,0.));\n\
    #75=POLYLINE('',(#95,#96,#97));\n#95=CARTESIAN_POINT('',(-0.95,1.58,0.));\n#96=CARTESIAN_POINT('',(0.,-2.,0.));\n\
    #97=CARTESIAN_POINT('',(2.,0.,0.));\n";

/// An IGES file with entities `(type, form, matrix, parameters)`; entity i has the directory number 2 i + 1.
pub fn iges(entities: &[(u32, i32, u32, &str)]) -> String {
    const GLOBAL: &str = "1H,,1H;,4Hpart,8Hpart.igs,4Htest,1H1,32,38,6,308,15,4Hpart,1.,2,2HMM,1,0.1,15H20200101.000000,\
        1E-6,10.,2Hme,4Hhere,11,0;";
    let mut text = String::new();
    let mut cards = |data: &str, width: usize, suffix: &str, letter: char, number: &mut usize| {
        let mut at = 0;
        while at < data.len() {
            let piece = &data[at..data.len().min(at + width)];
            *number += 1;
            writeln!(text, "{piece:<width$}{suffix}{letter}{number:>7}").expect("a string takes all");
            at += width;
        }
    };
    cards("a test", 72, "", 'S', &mut 0);
    cards(GLOBAL, 72, "", 'G', &mut 0);
    let (mut number, mut first) = (0, 1);
    for (kind, form, matrix, parameters) in entities {
        let count = format!("{kind},{parameters};").len().div_ceil(64);
        let line = format!("{kind:>8}{first:>8}{0:>8}{0:>8}{0:>8}{0:>8}{matrix:>8}{0:>8}00000000", 0);
        cards(&line, 72, "", 'D', &mut number);
        cards(&format!("{kind:>8}{0:>8}{0:>8}{count:>8}{form:>8}{:>32}", 0), 72, "", 'D', &mut number);
        first += count;
    }
    number = 0;
    for (i, (kind, _, _, parameters)) in entities.iter().enumerate() {
        let owner = format!("{:>8}", 2 * i + 1);
        cards(&format!("{kind},{parameters};"), 64, &owner, 'P', &mut number);
    }
    writeln!(text, "{:<72}T{:>7}", "S      1G      2", 1).expect("a string takes all");
    text
}

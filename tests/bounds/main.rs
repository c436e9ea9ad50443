//! Hostile files of every kind that is known: each has to end soon, within bounded memory, with a word about what was wrong.
//!
//! `memory.rs` measures the memory of imports; here what matters is that the answer comes, and that it says why.

mod texts;

use glam::DVec3;
use std::fmt::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::channel;
use std::time::Duration;
use texts::{PLATE, SURFACES, iges, plate_with, step, with};
use trimray::bake::{BakeOptions, bake};
use trimray::brep::{Model, occurrences};
use trimray::render::Ray;
use trimray::render::cpu::{Precision, probe};

/// What takes longer hangs.
const PATIENCE: Duration = Duration::from_secs(300);

/// What `work` gives, unless it panics or does not end.
fn ends<T: Send + 'static>(what: &str, work: impl FnOnce() -> T + Send + 'static) -> T {
    let (sender, receiver) = channel();
    std::thread::spawn(move || {
        // A test that gave up waiting no longer listens.
        let _ = sender.send(catch_unwind(AssertUnwindSafe(work)));
    });
    match receiver.recv_timeout(PATIENCE) {
        Ok(Ok(result)) => result,
        Ok(Err(_)) => panic!("{what} panics"),
        Err(_) => panic!("{what} does not end"),
    }
}

fn lost(model: &Model) -> u64 {
    model.diagnostics.iter().map(|d| u64::from(d.faces)).sum()
}

/// The model of a STEP or IGES file; declared faces are imported or lost with a reason.
fn import(text: &str) -> Model {
    let model = match trimray::step::read(text.as_bytes()) {
        Ok(model) => model,
        Err(_) => trimray::iges::read(text.as_bytes()).expect("a file with entities"),
    };
    assert_eq!(
        model.declared_faces as u64,
        model.faces.len() as u64 + lost(&model),
        "{:?}",
        model.diagnostics
    );
    model
}

/// Whether any finding of import or bake says `word`.
fn says(model: &Model, word: &str) -> bool {
    model.diagnostics.iter().any(|d| d.reason.contains(word))
}

/// Bakes and sends rays through the middle; returns the reasons of all findings.
fn bake_and_trace(model: &Model) -> Vec<String> {
    let baked = bake(model, &BakeOptions { keep_f64: true, ..BakeOptions::default() }, &|_, _| {});
    let scene = baked.scene();
    trimray::scene::validate(&scene).expect("a baked scene is valid");
    let around = trimray::render::bounds(&scene);
    let (middle, size) = ((around.min + around.max) * 0.5, around.diagonal());
    for direction in [DVec3::X, DVec3::NEG_Z, DVec3::new(0.3, -0.8, 0.1).normalize()] {
        let ray = Ray { origin: middle - direction * size, direction };
        for precision in [Precision::F32, Precision::F64] {
            probe(&scene, &[ray], precision, false);
        }
    }
    scene.metadata.findings.iter().map(|f| f.reason.clone()).collect()
}

#[test]
fn the_plain_files_are_sound() {
    for (name, text, faces) in [("plate", PLATE, 1), ("surfaces", SURFACES, 10)] {
        let model = import(text);
        assert_eq!(model.faces.len(), faces, "{name}: {:?}", model.diagnostics);
        let findings = bake_and_trace(&model);
        assert!(findings.iter().all(|f| f.contains("approximated")), "{name}: {findings:?}");
    }
}

/// Instances that refer to themselves, in place of a sound one; and what the file is told about it, if not only that the face is lost.
#[test]
fn circles_in_step_files_are_cut() {
    let circles = [
        ("#10", "ADVANCED_FACE('',(#11),#10,.T.);", "", "not supported"),
        ("#11", "FACE_OUTER_BOUND('',#11,.T.);", "", "not supported"),
        ("#13", "EDGE_LOOP('',(#13));", "", "EDGE_LOOP"),
        ("#21", "ORIENTED_EDGE('',*,*,#21,.T.);", "", "circle"),
        ("#25", "SUBEDGE('',#41,#42,#25);", "", "straight edge"),
        ("#25", "EDGE_CURVE('',#41,#42,#25,.T.);", "", "straight edge"),
        ("#41", "VERTEX_POINT('',#41);", "", "CARTESIAN_POINT"),
        ("#14", "AXIS2_PLACEMENT_3D('',#14,#14,#14);", "", "CARTESIAN_POINT"),
        ("#51", "TRIMMED_CURVE('',#51,(#31),(#32),.T.,.CARTESIAN.);", "", "circle"),
        ("#51", "SURFACE_CURVE('',#51,(#51),.CURVE_3D.);", "", "circle"),
        ("#51", "CURVE_REPLICA('',#51,#51);", "", "circle"),
        ("#51", "OFFSET_CURVE_3D('',#51,1.,.F.,#71);", "", "straight edge"),
        (
            "#51",
            "COMPOSITE_CURVE('',(#80,#80),.F.);",
            "#80=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#51);",
            "circle",
        ),
        ("#12", "RECTANGULAR_TRIMMED_SURFACE('',#12,0.,1.,0.,1.,.T.,.T.);", "", "circle"),
        ("#12", "CURVE_BOUNDED_SURFACE('',#12,(),.T.);", "", "circle"),
        ("#12", "OFFSET_SURFACE('',#12,1.,.F.);", "", "circle"),
        ("#12", "SURFACE_REPLICA('',#12,#14);", "", "circle"),
        ("#12", "SURFACE_OF_LINEAR_EXTRUSION('',#12,#61);", "", "not supported"),
        ("#2", "OPEN_SHELL('',(#2));", "", "outside of any product"),
        ("#2", "ORIENTED_OPEN_SHELL('',*,#2,.T.);", "", "outside of any product"),
        ("#1", "SHELL_BASED_SURFACE_MODEL('',(#1));", "", ""),
        (
            "#901",
            "(CONVERSION_BASED_UNIT('a',#80) LENGTH_UNIT() NAMED_UNIT(*));",
            "#80=MEASURE_WITH_UNIT(1.,#901);",
            "circle",
        ),
    ];
    let mut silent = Vec::new();
    for (name, replacement, more, word) in circles {
        let text = plate_with(name, replacement, more);
        let model = ends(replacement, move || {
            let model = import(&text);
            bake_and_trace(&model);
            model
        });
        if !says(&model, word) {
            silent.push(format!("{replacement}: {:?}", model.diagnostics));
        }
    }
    assert!(silent.is_empty(), "{silent:#?}");
}

#[test]
fn circles_of_placements_and_styles_are_cut() {
    let placements = "#4=AXIS2_PLACEMENT_3D('',#31,$,$);\n#80=REPRESENTATION_MAP(#4,#81);\n#82=MAPPED_ITEM('',#80,#4);\n\
        #81=SHAPE_REPRESENTATION('',(#82,#1),#900);\n#83=REPRESENTATION_MAP(#4,#84);\n#85=MAPPED_ITEM('',#83,#4);\n\
        #86=REPRESENTATION_MAP(#4,#87);\n#88=MAPPED_ITEM('',#86,#4);\n#84=SHAPE_REPRESENTATION('',(#88),#900);\n\
        #87=SHAPE_REPRESENTATION('',(#85,#1),#900);\n#90=STYLED_ITEM('',(#91),#10);\n\
        #91=PRESENTATION_STYLE_ASSIGNMENT((#91,#92));\n#92=SURFACE_STYLE_USAGE(.BOTH.,#91);\n\
        #93=OVER_RIDING_STYLED_ITEM('',(#91),#93,#93);\n#95=(REPRESENTATION_RELATIONSHIP('','',#81,#81) \
        REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#96) SHAPE_REPRESENTATION_RELATIONSHIP());\n\
        #96=ITEM_DEFINED_TRANSFORMATION('','',#96,#96);\n";
    let model = ends("circles of placements", move || {
        let model = import(&with(PLATE, placements));
        bake_and_trace(&model);
        model
    });
    assert_eq!(model.faces.len(), 1, "{:?}", model.diagnostics);
    assert!(says(&model, "placed in itself"), "{:?}", model.diagnostics);
}

#[test]
fn circles_in_iges_files_are_cut() {
    let bounded = "0.,0.,0.,0.,1.,0.,0.";
    type Entities<'a> = Vec<(u32, i32, u32, &'a str)>;
    let cases: [(&str, Entities, &str); 9] = [
        ("group", vec![(402, 7, 0, "2,1,3"), (402, 7, 0, "1,1"), (308, 0, 0, "0,1Ha,2,1,3")], ""),
        ("subfigure", vec![(308, 0, 0, "0,1Ha,1,3"), (408, 0, 0, "1,0.,0.,0.,1.")], "itself"),
        (
            "matrix",
            vec![
                (
                    128,
                    0,
                    3,
                    "1,1,1,1,0,0,1,0,0,0.,0.,1.,1.,0.,0.,1.,1.,1.,1.,1.,1.,0.,0.,0.,1.,0.,0.,0.,1.,0.,1.,1.,0.,0.,1.,0.,1.",
                ),
                (124, 0, 3, "1.,0.,0.,0.,0.,1.,0.,0.,0.,0.,1.,0."),
            ],
            "circle",
        ),
        ("composite", vec![(122, 0, 0, "3,1.,1.,1."), (102, 0, 0, "2,3,3")], "circle"),
        ("trimmed", vec![(144, 0, 0, "1,1,0,1")], "no surface"),
        ("bounded", vec![(143, 0, 0, "1,1,1,1")], ""),
        ("offset", vec![(144, 0, 0, "3,0,0,0"), (140, 0, 0, "0.,0.,1.,1.,3")], ""),
        (
            "solid",
            vec![
                (186, 0, 0, "1,1,0"),
                (514, 0, 0, "1,3,1"),
                (510, 0, 0, "5,1,1,5"),
                (508, 0, 0, "1,0,7,1,1,0"),
            ],
            "",
        ),
        ("color", vec![(110, 0, 0, bounded), (314, 0, 0, "1.,1.,1.")], ""),
    ];
    for (name, entities, word) in cases {
        let model = ends(name, move || {
            let model = import(&iges(&entities));
            bake_and_trace(&model);
            model
        });
        assert!(word.is_empty() || says(&model, word), "{name}: {:?}", model.diagnostics);
    }
}

/// Nine levels of ten mapped items each: a billion plates.
#[test]
fn a_billion_instances_are_cut() {
    let mut text = String::from("#80=AXIS2_PLACEMENT_3D('',#31,$,$);\n");
    for level in 0..9 {
        let base = 1000 * (level + 2);
        let mut items = String::new();
        let mapped = if level == 0 { 3 } else { 1000 * (level + 1) };
        writeln!(text, "#{}=REPRESENTATION_MAP(#80,#{mapped});", base + 1).expect("a string takes all");
        for i in 0..10 {
            let at = base + 10 * i + 10;
            write!(items, "{}#{at}", if i == 0 { "" } else { "," }).expect("a string takes all");
            writeln!(
                text,
                "#{at}=MAPPED_ITEM('',#{},#{});\n#{}=AXIS2_PLACEMENT_3D('',#{},$,$);\n#{}=CARTESIAN_POINT('',({i}.,{level}.,0.));",
                base + 1, at + 1, at + 1, at + 2, at + 2
            )
            .expect("a string takes all");
        }
        writeln!(text, "#{base}=SHAPE_REPRESENTATION('',({items}),#900);").expect("a string takes all");
    }
    let (placed, cut) = ends("a billion instances", move || {
        let (placed, cut) = occurrences(&import(&with(PLATE, &text)));
        (placed.len(), cut)
    });
    assert!(cut && placed > 100_000 && placed <= 1_000_000, "{placed} instances");
}

/// Counts, degrees and multiplicities far beyond what the file holds.
#[test]
fn gigantic_counts_are_refused() {
    for huge in ["1000000000", "9223372036854775807", "-1000000000", "1.E300"] {
        let curve = |degree: &str, counts: &str| {
            format!(
                "B_SPLINE_CURVE_WITH_KNOTS('',{degree},(#31,#32),.UNSPECIFIED.,.F.,.F.,({counts}),(0.,1.),.UNSPECIFIED.);"
            )
        };
        for bspline in
            [curve(huge, "2,2"), curve("1", &format!("{huge},2")), curve("1", &format!("{huge},{huge}"))]
        {
            let model = import(&plate_with("#51", &bspline, ""));
            assert_eq!(model.faces.len(), 1, "{bspline}: the edge is straight");
            let is_told = says(&model, "straight edge instead") || says(&model, "corrected");
            assert!(is_told, "{bspline}: {:?}", model.diagnostics);
        }
        let surface =
            format!("B_SPLINE_SURFACE('',{huge},{huge},((#31,#32),(#33,#34)),.UNSPECIFIED.,.F.,.F.,.F.);");
        let model = import(&plate_with("#12", &surface, ""));
        assert!(model.faces.is_empty() && says(&model, "degree"), "{:?}", model.diagnostics);
        // Every kind of entity, with as many of everything as can be said.
        for kind in (100..=196).chain(308..=316).chain(400..=420).chain(502..=514) {
            for form in [0, 1, 12] {
                let parameters = [huge; 20].join(",");
                let entities =
                    [(kind, form, 0, parameters.as_str()), (144, 0, 0, "1,0,0,1"), (122, 0, 0, "1,1.,1.,1.")];
                bake_and_trace(&import(&iges(&entities)));
            }
        }
    }
}

/// Every number of the files above, in turn, replaced by every hostile one; and all of them at once.
#[test]
fn hostile_numbers_do_no_harm() {
    const HOSTILE: [&str; 9] =
        ["0.", "-1.", "1.E300", "-1.E300", "1.E-300", "1.E15", "1.E-12", "NAN", "1.E999"];
    let is_part = |b: u8| b.is_ascii_digit() || b"+-.E".contains(&b);
    let mut files = 0;
    for text in [PLATE, SURFACES] {
        // Numbers with a point: not names of instances, and neither degrees nor multiplicities.
        let mut numbers = Vec::new();
        let bytes = text.as_bytes();
        let mut at = 0;
        while let Some(found) = bytes[at..].iter().position(|&b| b.is_ascii_digit() || b == b'-') {
            let begin = at + found;
            at = begin + bytes[begin..].iter().position(|&b| !is_part(b)).unwrap_or(bytes.len() - begin);
            if bytes[begin - 1] != b'#' && text[begin..at].contains('.') {
                numbers.push(begin..at);
            }
        }
        for hostile in HOSTILE {
            for range in &numbers {
                let broken = format!("{}{hostile}{}", &text[..range.start], &text[range.end..]);
                let what = format!("{hostile} at {}", &text[range.start.saturating_sub(30)..range.end]);
                ends(&what, move || bake_and_trace(&import(&broken)));
                files += 1;
            }
            let all = numbers.iter().rev().fold(text.to_owned(), |mut all, range| {
                all.replace_range(range.clone(), hostile);
                all
            });
            ends("all numbers", move || bake_and_trace(&import(&all)));
        }
    }
    eprintln!("{files} files with one hostile number");
    assert!(files > 1000);
}

/// Patterns of which a reader may make a square of the file's length: some millions of each.
#[test]
fn long_patterns_take_linear_time() {
    const LENGTH: usize = 20 << 20;
    let fill = |pattern: &str| pattern.repeat(LENGTH / pattern.len());
    let bodies = [
        ("a long string", format!("#80=A('{}');", fill("a"))),
        ("apostrophes", format!("#80=A('{}');", fill("''"))),
        ("a string that is not closed", format!("#80=A('{}", fill("a;"))),
        ("comments in a string that is not closed", format!("#80=A('{}", fill("\n#1/*"))),
        ("a comment that is not closed", format!("#80=A(/*{}", fill("/*"))),
        ("comments", format!("#80=A({}1);", fill("/**/"))),
        ("a long list", format!("#80=PLANE('',({}1));#81=ADVANCED_FACE('',(),#80,.T.);", fill("1,"))),
        (
            "nested lists",
            format!("#80=PLANE('',{}{});#81=ADVANCED_FACE('',(),#80,.T.);", fill("("), fill(")")),
        ),
        ("many lists", format!("#80=PLANE('',({}()));#81=ADVANCED_FACE('',(),#80,.T.);", fill("(),"))),
        ("a long keyword", format!("#80={}();#81=ADVANCED_FACE('',(),#80,.T.);", fill("A"))),
        ("a long number", format!("#80=PLANE({});#81=ADVANCED_FACE('',(),#80,.T.);", fill("1"))),
        ("equal signs", format!("#80=A({});", fill("="))),
        ("names before equal signs", format!("#80=A({});", fill("#1 ="))),
        ("ends of statements", fill(";")),
        ("words", fill("A;")),
        ("names", fill("#")),
        ("scopes", fill("&SCOPE ")),
        ("ends of scopes", fill("ENDSCOPE ")),
        ("nested scopes", fill("#1=&SCOPE ")),
        ("ampersands", fill("&")),
        ("sections", fill("DATA;")),
        ("directives", format!("#80=PRODUCT('','{}','',());", fill("\\X2\\"))),
    ];
    for (what, body) in bodies {
        ends(what, move || {
            let text = with(PLATE, &format!("{body}\n#82=PLANE('',#14);"));
            if let Ok(model) = trimray::step::read(text.as_bytes()) {
                assert!(model.diagnostics.len() < 20_000);
                assert_eq!(model.declared_faces as u64, model.faces.len() as u64 + lost(&model));
            }
            let headless = text.replacen("ENDSEC", "", 1);
            trimray::step::count_statements(headless.as_bytes());
        });
    }
    let start = iges(&[(110, 0, 0, "0.,0.,0.,1.,1.,1.")]);
    for (what, pattern) in [
        ("lines", "\na"),
        (
            "records of parameters",
            "\n1,                                                                     1P      1",
        ),
        ("delimiters", ","),
        ("strings", "\n9H1,1H;,1H,"),
        ("flags", "\n                                                                        C      1"),
    ] {
        let text = format!("{start}{}", fill(pattern)).replacen("T      1", "P      3", 1);
        ends(what, move || drop(trimray::iges::read(text.as_bytes())));
    }
}

#[test]
fn hundreds_of_thousands_of_broken_faces_are_counted() {
    let mut text = String::new();
    for i in 0..200_000 {
        writeln!(text, "#{}=ADVANCED_FACE('',(#11),#999,.T.);", 1000 + i).expect("a string takes all");
    }
    let shell = (0..200_000).map(|i| format!(",#{}", 1000 + i)).collect::<String>();
    let text = with(PLATE, &text).replacen("(#10)", &format!("(#10{shell})"), 1);
    let model = ends("broken faces", move || import(&text));
    assert_eq!((model.declared_faces, model.faces.len()), (200_001, 1));
    assert!(model.diagnostics.len() < 20_000 && says(&model, "more findings"), "{}", model.diagnostics.len());
}

/// One long statement that a hundred thousand others refer to, and one surface of many faces.
#[test]
fn what_many_share_is_not_read_for_each() {
    let mut text = format!("#80=CIRCLE('',#14,({}1));\n", "1,".repeat(100_000));
    for i in 0..100_000 {
        writeln!(text, "#{}=ADVANCED_FACE('',(#11),#80,.T.);", 1000 + i).expect("a string takes all");
    }
    let shell = (0..100_000).map(|i| format!(",#{}", 1000 + i)).collect::<String>();
    let text = with(PLATE, &text).replacen("(#10)", &format!("(#10{shell})"), 1);
    let model = ends("a long shared statement", move || import(&text));
    assert!(
        says(&model, "too often") && model.faces.len() == 1,
        "{:?}",
        model.diagnostics.iter().take(5).collect::<Vec<_>>()
    );
}

#[test]
fn a_surface_of_high_degree_and_a_million_points_is_refused() {
    const SIDE: usize = 1000;
    let mut text = String::from(
        "#1=GEOMETRIC_SET('',(#3));\n#2=GEOMETRICALLY_BOUNDED_SURFACE_SHAPE_REPRESENTATION('',(#1),#900);\n",
    );
    for i in 0..100 {
        writeln!(text, "#{}=CARTESIAN_POINT('',({}.,{}.,{}.));", 100 + i, i / 10, i % 10, i % 7)
            .expect("a string takes all");
    }
    let row = |i: usize| {
        let points: Vec<String> =
            (0..SIDE).map(|j| format!("#{}", 100 + i * 10 / SIDE * 10 + j * 10 / SIDE)).collect();
        format!("({})", points.join(","))
    };
    let rows: Vec<String> = (0..SIDE).map(row).collect();
    let inner = SIDE - 26;
    let counts = format!("(26{},26)", ",1".repeat(inner));
    let knots: Vec<String> = (0..inner + 2).map(|i| format!("{i}.")).collect();
    let knots = format!("({})", knots.join(","));
    writeln!(
        text,
        "#3=B_SPLINE_SURFACE_WITH_KNOTS('',25,25,({}),.UNSPECIFIED.,.F.,.F.,.F.,{counts},{counts},{knots},{knots},.UNSPECIFIED.);",
        rows.join(",")
    )
    .expect("a string takes all");
    let text = step(&text);
    let reasons = ends("a million control points", move || {
        let model = import(&text);
        assert_eq!(model.faces.len(), 1, "{:?}", model.diagnostics);
        bake_and_trace(&model)
    });
    assert!(reasons.iter().any(|r| r.contains("too many control points")), "{reasons:?}");
}

/// A million turns around a circle, in a curve and in a surface.
#[test]
fn a_million_turns_are_cut() {
    let text =
        SURFACES.replace("PARAMETER_VALUE(1.5707963267948966)),.T.", "PARAMETER_VALUE(6283185.3)),.T.");
    let text = text.replace(
        "RECTANGULAR_TRIMMED_SURFACE('',#202,0.5,4.",
        "RECTANGULAR_TRIMMED_SURFACE('',#202,-3.E6,4.E6",
    );
    let model = ends("a million turns", move || {
        let model = import(&text);
        bake_and_trace(&model);
        model
    });
    assert!(lost(&model) > 0, "{:?}", model.diagnostics);
    let turns =
        [(120, 0, 0, "3,5,0.,6283185.3"), (110, 0, 0, "0.,0.,0.,0.,0.,1."), (110, 0, 0, "1.,0.,0.,1.,0.,1.")];
    ends("a million turns", move || bake_and_trace(&import(&iges(&turns))));
}

#[test]
fn long_names_are_shared_by_many_instances() {
    let name = "n".repeat(1 << 20);
    let mut items = String::new();
    let mut text = String::from("#80=AXIS2_PLACEMENT_3D('',#31,$,$);\n#81=REPRESENTATION_MAP(#80,#3);\n");
    for i in 0..1000 {
        write!(items, ",#{}", 2000 + 3 * i).expect("a string takes all");
        writeln!(
            text,
            "#{}=MAPPED_ITEM('',#81,#{});\n#{}=AXIS2_PLACEMENT_3D('',#{},$,$);\n#{}=CARTESIAN_POINT('',({i}.,0.,0.));",
            2000 + 3 * i, 2001 + 3 * i, 2001 + 3 * i, 2002 + 3 * i, 2002 + 3 * i
        )
        .expect("a string takes all");
    }
    writeln!(text, "#999=SHAPE_REPRESENTATION('',(#80{items}),#900);").expect("a string takes all");
    let named = format!("MANIFOLD_SURFACE_SHAPE_REPRESENTATION('{name}',(#1),#900);");
    let text = plate_with("#3", &named, &text);
    let bytes = ends("long names", move || {
        let (placed, _) = occurrences(&import(&text));
        placed.iter().map(|occurrence| occurrence.path.len()).sum::<usize>()
    });
    assert!((1 << 20..1 << 29).contains(&bytes), "{bytes} bytes of names");
}

/// A loop that runs a hundred thousand times along one edge of ten thousand spans, on a cylinder.
#[test]
fn long_edges_are_not_followed_for_ever() {
    let mut text = String::new();
    let points: Vec<String> = (0..10_000).map(|i| format!("#{}", 1000 + i)).collect();
    for i in 0..10_000 {
        let angle = 1e-4 * f64::from(i);
        let [x, y, z] = [3.0 * angle.cos(), 3.0 * angle.sin(), f64::from(i % 2)];
        writeln!(text, "#{}=CARTESIAN_POINT('',({x:.9},{y:.9},{z:.9}));", 1000 + i)
            .expect("a string takes all");
    }
    write!(text, "#80=POLYLINE('',({}));\n#81=EDGE_CURVE('',#82,#83,#80,.T.);\n", points.join(","))
        .expect("a string takes all");
    text += "#82=VERTEX_POINT('',#1000);\n#83=VERTEX_POINT('',#10999);\n#84=ORIENTED_EDGE('',*,*,#81,.T.);\n";
    let coedges = "#84,".repeat(100_000);
    let text = plate_with("#13", &format!("EDGE_LOOP('',({coedges}#84));"), &text);
    let text = text.replace("PLANE('',#14)", "CYLINDRICAL_SURFACE('',#14,3.)");
    let reasons = ends("a long edge", move || bake_and_trace(&import(&text)));
    assert!(reasons.iter().any(|r| r.contains("too often")), "{reasons:?}");
}

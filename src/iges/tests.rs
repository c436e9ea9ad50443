//! Small files, one for each kind of entity and each quirk.

use super::{IgesError, read};
use crate::brep::{Model, Severity, TrimLoop, occurrences};
use crate::geometry::{Curve, Surface};
use crate::trimming::{TrimOptions, trim_face};
use glam::DVec3;

/// An entity: what its directory entry and its parameters hold.
struct Entity {
    kind: u32,
    form: i32,
    status: &'static str,
    transform: u32,
    color: i32,
    parameters: String,
}

const DEPENDENT: &str = "00010000";
const FLAT: &str = "00010500";

fn entity(kind: u32, status: &'static str, parameters: &str) -> Entity {
    Entity { kind, form: 0, status, transform: 0, color: 0, parameters: format!("{kind},{parameters};") }
}

fn top(kind: u32, parameters: &str) -> Entity {
    entity(kind, "00000000", parameters)
}

fn part(kind: u32, parameters: &str) -> Entity {
    entity(kind, DEPENDENT, parameters)
}

impl Entity {
    fn form(self, form: i32) -> Self {
        Self { form, ..self }
    }
    fn transform(self, transform: u32) -> Self {
        Self { transform, ..self }
    }
    fn color(self, color: i32) -> Self {
        Self { color, ..self }
    }
}

const MILLIMETRES: &str = "1H,,1H;,4Hpart,8Hpart.igs,4Htest,1H1,32,38,6,308,15,4Hpart,1.,2,2HMM,1,0.1,15H20200101.000000,1E-6,10.,2Hme,4Hhere,11,0;";

fn records(text: &str, width: usize, letter: char, suffix: &str, first: usize) -> Vec<String> {
    let pieces: Vec<&str> = text
        .as_bytes()
        .chunks(width)
        .map(|piece| std::str::from_utf8(piece).expect("test files are ASCII"))
        .collect();
    let line = |(i, piece): (usize, &&str)| format!("{piece:<width$}{suffix}{letter}{:>7}", first + i);
    pieces.iter().enumerate().map(line).collect()
}

/// The records of a file; entity i has the directory number 2 i + 1.
fn lines(global: &str, entities: &[Entity]) -> Vec<String> {
    let mut lines = records("a test", 72, 'S', "", 1);
    lines.extend(records(global, 72, 'G', "", 1));
    let mut parameters: Vec<String> = Vec::new();
    let mut directory = Vec::new();
    for (i, entity) in entities.iter().enumerate() {
        let number = 2 * i + 1;
        let own = records(&entity.parameters, 64, 'P', &format!("{number:>8}"), parameters.len() + 1);
        let Entity { kind, form, status, transform, color, .. } = entity;
        let (first, count) = (parameters.len() + 1, own.len());
        directory.push(format!(
            "{kind:>8}{first:>8}{:>8}{:>8}{:>8}{:>8}{transform:>8}{:>8}{status:>8}D{number:>7}",
            0, 0, 0, 0, 0
        ));
        directory.push(format!(
            "{kind:>8}{:>8}{color:>8}{count:>8}{form:>8}{:>8}{:>8}{:>8}{:>8}D{:>7}",
            0,
            "",
            "",
            "",
            0,
            number + 1
        ));
        parameters.extend(own);
    }
    lines.extend(directory);
    lines.extend(parameters);
    lines.push(format!("{:72}T{:>7}", "S      1G      2", 1));
    lines
}

fn model(entities: &[Entity]) -> Model {
    let model = read(lines(MILLIMETRES, entities).join("\n").as_bytes()).expect("an IGES file");
    let lost: usize = model.diagnostics.iter().map(|d| d.faces as usize).sum();
    assert_eq!(model.faces.len() + lost, model.declared_faces);
    model
}

/// The model of what must be read without any finding.
fn clean(entities: &[Entity]) -> Model {
    let model = model(entities);
    assert!(model.diagnostics.is_empty(), "{:?}", model.diagnostics);
    model
}

/// A surface (entity 1) trimmed by curves that follow: a 144 with one 142 on a composite of `curves`.
fn trimmed(surface: Entity, helpers: Vec<Entity>, curves: Vec<Entity>) -> Vec<Entity> {
    let count = curves.len();
    let first = 3 + 2 * helpers.len();
    let members: Vec<String> = (0..count).map(|i| (first + 2 * i).to_string()).collect();
    let composite = first + 2 * count;
    let mut entities = vec![surface];
    entities.extend(helpers);
    entities.extend(curves);
    entities.push(part(102, &format!("{count},{}", members.join(","))));
    entities.push(part(142, &format!("0,1,0,{composite},2")));
    entities.push(top(144, &format!("1,1,0,{}", composite + 2)));
    entities
}

fn square() -> Vec<Entity> {
    ["0,0,0,2,0,0", "2,0,0,2,2,0", "2,2,0,0,2,0", "0,2,0,0,0,0"].map(|line| part(110, line)).into()
}

/// The area of the rectangle around the first face's parameter region.
fn trims(model: &Model) -> f64 {
    let trim = trim_face(model, crate::brep::Id::new(0), &TrimOptions::default()).expect("a trimmed face");
    let size = trim.window.max - trim.window.min;
    size.x * size.y
}

#[test]
fn a_trimmed_plane() {
    let model = clean(&trimmed(part(108, "0,0,1,0,0,0,0,0,1"), Vec::new(), square()));
    assert_eq!((model.faces.len(), model.edges.len(), model.vertices.len()), (1, 4, 4));
    assert_eq!(model.faces.iter().next().map(|f| f.entity), Some(15));
    assert!((trims(&model) - 4.0).abs() < 1e-12);
    assert_eq!(model.source.schema, "IGES 5.3");
}

#[test]
fn records_in_every_dress() {
    let lines = lines(MILLIMETRES, &trimmed(part(108, "0,0,1,0"), Vec::new(), square()));
    let reference = read(lines.join("\n").as_bytes()).expect("an IGES file");
    let misnumbered: Vec<String> = lines.iter().map(|line| format!("{}      7", &line[..73])).collect();
    let garbage: Vec<String> = lines.iter().map(|line| line.clone() + "   more").collect();
    for text in
        [lines.concat(), lines.join("\r\n"), misnumbered.join("\n"), garbage.join("\n") + "\n\0\0trailing"]
    {
        let model = read(text.as_bytes()).expect("an IGES file");
        assert_eq!((model.faces.len(), model.edges.len()), (reference.faces.len(), reference.edges.len()));
    }
}

#[test]
fn other_delimiters_units_and_scale() {
    let global = MILLIMETRES
        .replace(',', "/")
        .replace("1H//1H;", "1H//1H#")
        .replace(';', "#")
        .replace("/1./2/2HMM", "/0.5/1/4HINCH");
    let entities: Vec<Entity> = trimmed(part(108, "0,0,1,0"), Vec::new(), square())
        .into_iter()
        .map(|e| Entity { parameters: e.parameters.replace(',', "/").replace(';', "#"), ..e })
        .collect();
    let model = read(lines(&global, &entities).join("\n").as_bytes()).expect("an IGES file");
    let far = model.vertices.iter().map(|v| v.point.x).fold(0.0, f64::max);
    assert!((far - 2.0 * 25.4 / 0.5).abs() < 1e-12);
}

#[test]
fn numbers_up_to_column_65() {
    let mut lines = lines(MILLIMETRES, &[top(128, BILINEAR)]);
    let start = lines.iter().position(|line| line.as_bytes()[72] == b'P').expect("parameters");
    let end = lines.len() - 1;
    let numbers: Vec<String> = format!("128,{BILINEAR}").split(',').map(|n| format!("{n:>12}")).collect();
    let text: Vec<String> = numbers.chunks(5).map(|five| five.join(",")).collect();
    let last = text.len() - 1;
    let card = |(i, text): (usize, &String)| {
        let end = if i == last { ";" } else { "," };
        format!("{:<65}{:>7}P{:>7}", format!("{text}{end}"), 1, i + 1)
    };
    lines.splice(start..end, text.iter().enumerate().map(card));
    let model = read(lines.join("\n").as_bytes()).expect("an IGES file");
    assert_eq!(model.faces.len(), 1, "{:?}", model.diagnostics);
}

#[test]
fn compressed_form() {
    let text = [
        format!("{:72}C{:>7}", "", 1),
        records("a test", 72, 'S', "", 1).join("\n"),
        records(MILLIMETRES, 72, 'G', "", 1).join("\n"),
        "D1@1_108@9_00010000;\n108,0.,0.,1.,0.;\nD3@1_100;\n100,0.,0.,0.,1.,0.,1.,0.;\nD5@1_142;\n142,0,1,0,3,2;".into(),
        "D7@1_144@9_00000000;\n144,1,1,0,5;".into(),
        format!("{:72}T{:>7}", "", 1),
    ];
    let model = read(text.join("\n").as_bytes()).expect("an IGES file");
    assert_eq!(model.faces.len(), 1, "{:?}", model.diagnostics);
}

#[test]
fn what_is_no_iges_file() {
    assert_eq!(read(b"").err(), Some(IgesError::NotIges));
    assert_eq!(read(b"ISO-10303-21;").err(), Some(IgesError::NotIges));
    assert_eq!(read(format!("{:72}B{:>7}\n", "", 1).as_bytes()).err(), Some(IgesError::Binary));
    assert_eq!(read(lines(MILLIMETRES, &[]).join("\n").as_bytes()).err(), Some(IgesError::Empty));
}

#[test]
fn circles_and_placements() {
    // A disc in the plane x = 5, made in x-y and turned about y.
    let turn = part(124, "0,0,1,5,0,1,0,0,-1,0,0,0");
    let plane = part(108, "0,0,1,0").transform(3);
    let model = clean(&trimmed(plane, vec![turn], vec![part(100, "0,1,1,2,1,2,1").transform(3)]));
    let edge = model.edges.iter().next().expect("an edge");
    assert!(matches!(&edge.curve, Curve::Circle { radius, .. } if (radius - 1.0).abs() < 1e-15));
    assert!(edge.vertices[0] == edge.vertices[1] && (edge.curve.point(0.0).x - 5.0).abs() < 1e-15);
    assert!((trims(&model) - 4.0).abs() < 1e-9);
}

#[test]
fn a_skewed_circle_is_an_ellipse() {
    let skew = part(124, "2,0,0,0,0,1,0,0,0,0,1,0");
    let model =
        clean(&trimmed(part(108, "0,0,1,0"), vec![skew], vec![part(100, "0,0,0,1,0,1,0").transform(3)]));
    assert!((trims(&model) - 8.0).abs() < 1e-9);
}

/// Half a region above the x axis: closed by a line from (−1, 0) to (1, 0).
fn half_disc(arc: Entity) -> Model {
    clean(&trimmed(part(108, "0,0,1,0"), Vec::new(), vec![part(110, "-1,0,0,1,0,0"), arc]))
}

#[test]
fn curves_of_every_kind() {
    // Half circles as arc, conic, polyline and splines; parabola and hyperbola through the same ends.
    let cases = [
        (part(100, "0,0,0,1,0,-1,0"), 2.0),
        (part(104, "1,0,4,0,0,-1,0,1,0,-1,0").form(1), 1.0),
        (part(104, "1,0,0,0,1,-1,0,1,0,-1,0").form(3), 2.0),
        (part(106, "2,3,1,0,0,0,1,0,-1,0,0").form(12), 2.0),
        (part(106, "1,3,0,1,0,0,1,-1,0").form(11), 2.0),
        (part(112, "3,1,2,1,0,1,1,-2,0,0,0,4,-4,0,0,0,0,0"), 2.0),
        (part(126, "2,2,1,0,1,0,0,0,0,1,1,1,1,1,1,1,0,0,0,2,0,-1,0,0,0,1,0,0,1"), 2.0),
    ];
    for (arc, area) in cases {
        let kind = (arc.kind, arc.form);
        let found = trims(&half_disc(arc));
        assert!((found - area).abs() < 1e-9, "{kind:?}: {found}");
    }
}

#[test]
fn a_hyperbola() {
    // x² − y² = 1 between y = −1 and y = 1.
    let ends = format!("{0},-1,{0},1", 2.0_f64.sqrt());
    let arc = part(104, &format!("1,0,-1,0,0,-1,0,{ends}")).form(2);
    let line = part(110, &format!("{0},1,0,{0},-1,0", 2.0_f64.sqrt()));
    let model = clean(&trimmed(part(108, "0,0,1,0"), Vec::new(), vec![arc, line]));
    assert!((trims(&model) - 2.0 * (2.0_f64.sqrt() - 1.0)).abs() < 1e-9);
}

#[test]
fn turned_and_doubled_edges() {
    // Every second edge is given backwards.
    let curves =
        ["0,0,0,2,0,0", "2,2,0,2,0,0", "2,2,0,0,2,0", "0,0,0,0,2,0"].map(|line| part(110, line)).into();
    let model = clean(&trimmed(part(108, "0,0,1,0"), Vec::new(), curves));
    assert_eq!(model.vertices.len(), 4);
    assert!((trims(&model) - 4.0).abs() < 1e-12);
}

#[test]
fn revolved_surfaces_and_seams() {
    // A cylinder of radius 1 and height 2: bottom circle, seam, top circle, seam again.
    let axis = part(110, "0,0,0,0,0,1");
    let profile = part(110, "1,0,0,1,0,2");
    let curves = vec![
        part(100, "0,0,0,1,0,1,0"),
        part(110, "1,0,0,1,0,2"),
        // Arcs run counter-clockwise: the upper one is seen from below.
        part(100, "-2,0,0,1,0,1,0").transform(7),
        part(110, "1,0,2,1,0,0"),
    ];
    let below = part(124, "1,0,0,0,0,-1,0,0,0,0,-1,0");
    let model = clean(&trimmed(part(120, "3,5,0,6.28318"), vec![axis, profile, below], curves));
    assert!(matches!(model.surfaces.iter().next(), Some(Surface::Cylinder { .. })));
    let loops = &model.faces.iter().next().expect("a face").loops;
    let [TrimLoop::Edges(coedges)] = loops.as_slice() else { panic!("one loop") };
    assert_eq!(coedges[1].edge, coedges[3].edge, "the seam is one edge");
    assert!((trims(&model) - 2.0 * std::f64::consts::TAU).abs() < 1e-6);
}

/// The surface of a file that holds one, standing alone.
fn alone(surface: Entity, helpers: Vec<Entity>) -> Surface {
    let mut entities = vec![surface];
    entities.extend(helpers);
    let model = clean(&entities);
    assert_eq!(model.faces.len(), 1);
    model.surfaces[model.faces.iter().next().expect("a face").surface].clone()
}

fn corners(surface: &Surface) -> [DVec3; 4] {
    let d = surface.domain();
    [d.min, glam::DVec2::new(d.max.x, d.min.y), glam::DVec2::new(d.min.x, d.max.y), d.max]
        .map(|uv| surface.point(uv))
}

fn assert_corners(surface: &Surface, expected: [[f64; 3]; 4]) {
    for (found, expected) in corners(surface).into_iter().zip(expected) {
        assert!(found.distance(DVec3::from_array(expected)) < 1e-12, "{found} instead of {expected:?}");
    }
}

#[test]
fn surfaces_that_stand_alone() {
    let ruled = alone(top(118, "3,5,0,0").form(1), vec![part(110, "0,0,0,1,0,0"), part(110, "0,1,1,1,1,1")]);
    assert_corners(&ruled, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 1.0], [1.0; 3]]);
    let turned = alone(top(118, "3,5,1,0").form(1), vec![part(110, "0,0,0,1,0,0"), part(110, "0,1,1,1,1,1")]);
    assert_corners(&turned, [[0.0; 3], [1.0, 0.0, 0.0], [1.0; 3], [0.0, 1.0, 1.0]]);
    let mixed = alone(top(118, "3,5,0,0"), vec![part(100, "0,0,0,1,0,-1,0"), part(110, "1,0,3,-1,0,3")]);
    assert_corners(&mixed, [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [1.0, 0.0, 3.0], [-1.0, 0.0, 3.0]]);
    let tabulated = alone(top(122, "3,0,0,5"), vec![part(110, "0,0,0,1,0,0")]);
    assert_corners(&tabulated, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 5.0], [1.0, 0.0, 5.0]]);
    let quarter = std::f64::consts::FRAC_PI_2;
    let revolved = alone(
        top(120, &format!("3,5,0,{quarter}")),
        vec![part(110, "0,0,0,0,0,1"), part(110, "1,0,0,2,0,0")],
    );
    assert_corners(&revolved, [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 2.0, 0.0]]);
    let spline = alone(
        top(128, "1,1,1,1,0,0,1,0,0,0,0,1,1,0,0,1,1,1,1,1,1,0,0,0,2,0,0,0,2,0,2,2,1,0,1,0,1"),
        Vec::new(),
    );
    assert_corners(&spline, [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [2.0, 2.0, 1.0]]);
}

#[test]
fn parametric_spline_surface() {
    // One patch x = 2u, y = 3v, z = u v, followed by the strips that mean nothing.
    let mut patch = [0.0; 48];
    (patch[1], patch[16 + 4], patch[32 + 5]) = (2.0, 3.0, 1.0);
    let numbers: Vec<String> = patch.iter().chain([0.0; 3 * 48].iter()).map(f64::to_string).collect();
    let surface = alone(top(114, &format!("3,1,1,1,0,1,0,1,{}", numbers.join(","))), Vec::new());
    assert_corners(&surface, [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [2.0, 3.0, 1.0]]);
}

const BILINEAR: &str = "1,1,1,1,0,0,1,0,0,0,0,1,1,0,0,1,1,1,1,1,1,0,0,0,20,0,0,0,20,0,20,20,5,0,1,0,1";

#[test]
fn parameter_curves_are_lifted() {
    let line = |text: &str| entity(110, FLAT, text);
    let entities = vec![
        part(128, BILINEAR),
        line("0.2,0.2,0,0.8,0.2,0"),
        line("0.8,0.2,0,0.8,0.8,0"),
        line("0.8,0.8,0,0.2,0.8,0"),
        line("0.2,0.8,0,0.2,0.2,0"),
        entity(102, FLAT, "4,3,5,7,9"),
        part(142, "0,1,11,0,1"),
        top(144, "1,1,0,13"),
    ];
    let model = clean(&entities);
    let area = trims(&model);
    assert!((area - 0.36).abs() < 1e-6, "{area}");
    let edge = model.edges.iter().next().expect("an edge");
    let [pcurve] = edge.pcurves.as_slice() else { panic!("a parameter curve") };
    for i in 0..=10 {
        let t = edge.range[0] + (edge.range[1] - edge.range[0]) * f64::from(i) / 10.0;
        let lifted = model.surfaces[pcurve.surface].point(pcurve.curve.point(t));
        assert!(lifted.distance(edge.curve.point(t)) < 1e-12);
    }
}

#[test]
fn a_dummy_in_space_is_not_believed() {
    let mut entities = vec![part(128, BILINEAR)];
    entities.push(entity(106, FLAT, "1,5,0,0.2,0.2,0.8,0.2,0.8,0.8,0.2,0.8,0.2,0.2").form(63));
    entities.push(part(106, "1,5,500,0,0,1,0,1,1,0,1,0,0").form(63));
    entities.push(part(142, "0,1,3,5,1"));
    entities.push(top(144, "1,1,0,7"));
    let model = model(&entities);
    assert!((trims(&model) - 0.36).abs() < 1e-6);
    assert_eq!(model.diagnostics.len(), 1);
}

#[test]
fn a_hole_in_natural_bounds() {
    let mut entities = vec![part(128, BILINEAR)];
    entities.push(entity(106, FLAT, "1,5,0,0.2,0.2,0.8,0.2,0.8,0.8,0.2,0.8,0.2,0.2").form(63));
    entities.push(part(142, "0,1,3,0,1"));
    entities.push(top(144, "1,0,1,0,5"));
    let model = clean(&entities);
    assert_eq!(model.faces.iter().next().map(|f| f.loops.len()), Some(2));
    assert!((trims(&model) - 1.0).abs() < 1e-6);
}

#[test]
fn bounded_surfaces() {
    let mut entities = vec![part(108, "0,0,1,0")];
    entities.extend(square());
    // The third curve is given against its sense.
    entities[3] = part(110, "0,2,0,2,2,0");
    entities.push(part(141, "0,0,1,4,3,1,0,5,1,0,7,2,0,9,1,0"));
    entities.push(top(143, "0,1,1,11").color(3));
    let model = clean(&entities);
    assert!((trims(&model) - 4.0).abs() < 1e-12);
    assert_eq!(model.faces.iter().next().and_then(|f| f.color).map(|c| c.rgb), Some([0.0, 1.0, 0.0]));
}

/// A tetrahedron with corners at the origin and at 1 on the axes.
fn tetrahedron(solid: Entity) -> Vec<Entity> {
    let mut entities = vec![
        part(502, "4,0,0,0,1,0,0,0,1,0,0,0,1").form(1),
        part(504, "6,5,1,1,1,2,7,1,1,1,3,9,1,1,1,4,11,1,2,1,3,13,1,3,1,4,15,1,4,1,2").form(1),
    ];
    let lines = ["0,0,0,1,0,0", "0,0,0,0,1,0", "0,0,0,0,0,1", "1,0,0,0,1,0", "0,1,0,0,0,1", "0,0,1,1,0,0"];
    entities.extend(lines.map(|line| part(110, line)));
    // Planes 17 to 23, loops 25 to 31, faces 33 to 39, shell 41, solid 43.
    entities.extend(["0,0,-1,0", "0,-1,0,0", "-1,0,0,0", "1,1,1,1"].map(|plane| part(108, plane)));
    let uses = |edges: [(u32, u32); 3]| {
        let list: Vec<String> = edges.iter().map(|(edge, sense)| format!("0,3,{edge},{sense},0")).collect();
        part(508, &format!("3,{}", list.join(","))).form(1)
    };
    entities.push(uses([(2, 1), (4, 0), (1, 0)]));
    entities.push(uses([(1, 1), (6, 0), (3, 0)]));
    entities.push(uses([(3, 1), (5, 0), (2, 0)]));
    entities.push(uses([(4, 1), (5, 1), (6, 1)]));
    for i in 0..4 {
        entities.push(part(510, &format!("{},1,1,{}", 17 + 2 * i, 25 + 2 * i)).form(1));
    }
    entities.push(part(514, "4,33,1,35,1,37,1,39,1").form(1));
    entities.push(solid);
    entities
}

#[test]
fn a_solid() {
    let mut entities = tetrahedron(top(186, "41,1,0,0,1,45").color(-47));
    entities.push(part(406, "1,5Hpiece").form(15));
    entities.push(top(314, "100,50,0,6Horange").form(0));
    let model = clean(&entities);
    assert_eq!((model.faces.len(), model.edges.len(), model.vertices.len()), (4, 6, 4));
    let body = &model.parts[model.roots[0]].bodies[0];
    assert_eq!((body.name.as_str(), body.kind), ("piece", crate::brep::BodyKind::Solid));
    for (id, face) in model.faces.ids().zip(model.faces.iter()) {
        assert_eq!(face.color.map(|c| c.rgb), Some([1.0, 0.5, 0.0]));
        assert!(trim_face(&model, id, &TrimOptions::default()).is_ok());
    }
}

#[test]
fn subfigures_are_parts() {
    let mut entities = tetrahedron(part(186, "41,1,0"));
    entities.push(part(308, "0,4Hbolt,1,43"));
    entities.push(top(408, "45,10,0,0,2."));
    entities.push(top(408, "45,20,0,0"));
    let model = clean(&entities);
    let (places, _) = occurrences(&model);
    assert_eq!((places.len(), model.faces.len()), (2, 4));
    assert_eq!(places[0].world_from_part.transform_point3(DVec3::X), DVec3::new(12.0, 0.0, 0.0));
    assert_eq!(places[1].world_from_part.transform_point3(DVec3::X), DVec3::new(21.0, 0.0, 0.0));
    assert!(places.iter().all(|place| place.path.ends_with("bolt")));
}

#[test]
fn a_placed_solid_is_a_placed_part() {
    let mut entities = tetrahedron(top(186, "41,1,0").transform(45));
    entities.push(part(124, "1,0,0,0,0,1,0,0,0,0,1,7"));
    let model = clean(&entities);
    let (places, _) = occurrences(&model);
    assert_eq!(places[0].world_from_part.translation, DVec3::new(0.0, 0.0, 7.0));
}

#[test]
fn elementary_surfaces_with_poles() {
    let sphere = clean(&[top(196, "3,2.5"), part(116, "1,2,3")]);
    let face = sphere.faces.iter().next().expect("a face");
    assert!(matches!(&sphere.surfaces[face.surface], Surface::Sphere { radius, .. } if *radius == 2.5));
    let torus = clean(&[top(198, "3,5,4,1"), part(116, "0,0,0"), part(123, "0,0,1")]);
    assert_eq!(torus.surfaces.iter().next().map(Surface::kind), Some("torus"));
    let wedge = "3,5,1,30";
    let curves = vec![part(100, "0,0,0,1,0,1,0")];
    let cone = clean(&trimmed(part(194, wedge), vec![part(116, "0,0,0"), part(123, "0,0,-1")], curves));
    assert!(
        matches!(cone.surfaces.iter().next(), Some(Surface::Cone { half_angle, .. }) if (half_angle - 30_f64.to_radians()).abs() < 1e-15)
    );
}

#[test]
fn what_is_hidden_dependent_or_unknown() {
    let patch = |status| entity(128, status, BILINEAR);
    let hidden = model(&[patch("01000000")]);
    assert_eq!(
        (hidden.declared_faces, hidden.faces.len(), hidden.diagnostics[0].severity),
        (1, 0, Severity::Hidden)
    );
    assert_eq!(clean(&[patch("00010000")]).declared_faces, 0);
    assert_eq!(clean(&[patch("00020000")]).faces.len(), 1);
    assert_eq!(clean(&[patch("   ")]).faces.len(), 1);
    assert_eq!(model(&[top(150, "1,1,1")]).diagnostics[0].severity, Severity::Dropped);
}

#[test]
fn broken_entities_cost_themselves() {
    for broken in [
        "1,1,0,99",
        "1,1,0,-5",
        "99,1,0,13",
        "1,1,0,15",
        "1,1,1000000,13",
        "1.5,1,0,13",
        "5Hhello,1,0,13",
        "",
    ] {
        let mut entities = trimmed(part(108, "0,0,1,0"), Vec::new(), square());
        entities.push(top(144, broken));
        let model = model(&entities);
        assert_eq!((model.declared_faces, model.faces.len()), (2, 1), "{broken}");
        assert_eq!(
            model.diagnostics.iter().filter(|d| d.entity == 17 && d.kind == "144").count(),
            1,
            "{broken}"
        );
    }
}

#[test]
fn cycles_end() {
    let curve = model(&trimmed(part(108, "0,0,1,0"), Vec::new(), vec![part(102, "1,3")]));
    assert_eq!(curve.faces.len(), 0);
    let matrix = model(&trimmed(
        part(108, "0,0,1,0").transform(3),
        vec![part(124, "1,0,0,0,0,1,0,0,0,0,1,0").transform(3)],
        square(),
    ));
    assert_eq!(matrix.faces.len(), 0);
    let figures = model(&[part(308, "0,1Ha,1,3"), part(408, "1,0,0,0"), top(408, "1,0,0,0")]);
    assert!(!figures.diagnostics.is_empty());
}

#[test]
fn cut_short_anywhere_and_bitten() {
    let text = lines(MILLIMETRES, &tetrahedron(top(186, "41,1,0"))).join("\n");
    for end in (0..text.len()).step_by(41) {
        let _ = read(&text.as_bytes()[..end]);
    }
    let mut seed = 0x2545_f491_4f6c_dd1d_u64;
    for _ in 0..400 {
        let mut bytes = text.clone().into_bytes();
        for _ in 0..8 {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let at = (seed >> 33) as usize % bytes.len();
            bytes[at] = b"0123456789,;.-H D\n"[(seed >> 20) as usize % 18];
        }
        if let Ok(model) = read(&bytes) {
            let lost: usize = model.diagnostics.iter().map(|d| d.faces as usize).sum();
            assert_eq!(model.faces.len() + lost, model.declared_faces);
        }
    }
}

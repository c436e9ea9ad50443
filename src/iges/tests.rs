//! Helpers to write small files, and what no file may do: cost more than what is broken in it, run in circles, panic.

use super::read;
use crate::brep::Model;
use crate::trimming::{TrimOptions, trim_face};

/// An entity: what its directory entry and its parameters hold.
pub(super) struct Entity {
    pub(super) kind: u32,
    pub(super) form: i32,
    pub(super) level: i32,
    pub(super) status: &'static str,
    pub(super) transform: u32,
    pub(super) color: i32,
    pub(super) parameters: String,
}

pub(super) const DEPENDENT: &str = "00010000";
pub(super) const FLAT: &str = "00010500";

pub(super) fn entity(kind: u32, status: &'static str, parameters: &str) -> Entity {
    Entity {
        kind,
        form: 0,
        level: 0,
        status,
        transform: 0,
        color: 0,
        parameters: format!("{kind},{parameters};"),
    }
}

pub(super) fn top(kind: u32, parameters: &str) -> Entity {
    entity(kind, "00000000", parameters)
}

pub(super) fn part(kind: u32, parameters: &str) -> Entity {
    entity(kind, DEPENDENT, parameters)
}

impl Entity {
    pub(super) fn form(self, form: i32) -> Self {
        Self { form, ..self }
    }
    pub(super) fn level(self, level: i32) -> Self {
        Self { level, ..self }
    }
    pub(super) fn transform(self, transform: u32) -> Self {
        Self { transform, ..self }
    }
    pub(super) fn color(self, color: i32) -> Self {
        Self { color, ..self }
    }
}

pub(super) const MILLIMETRES: &str = "1H,,1H;,4Hpart,8Hpart.igs,4Htest,1H1,32,38,6,308,15,4Hpart,1.,2,2HMM,1,0.1,15H20200101.000000,1E-6,10.,2Hme,4Hhere,11,0;";

pub(super) fn records(text: &str, width: usize, letter: char, suffix: &str, first: usize) -> Vec<String> {
    let pieces: Vec<&str> = text
        .as_bytes()
        .chunks(width)
        .map(|piece| std::str::from_utf8(piece).expect("test files are ASCII"))
        .collect();
    let line = |(i, piece): (usize, &&str)| format!("{piece:<width$}{suffix}{letter}{:>7}", first + i);
    pieces.iter().enumerate().map(line).collect()
}

/// The records of a file; entity i has the directory number 2 i + 1.
pub(super) fn lines(global: &str, entities: &[Entity]) -> Vec<String> {
    let mut lines = records("a test", 72, 'S', "", 1);
    lines.extend(records(global, 72, 'G', "", 1));
    let mut parameters: Vec<String> = Vec::new();
    let mut directory = Vec::new();
    for (i, entity) in entities.iter().enumerate() {
        let number = 2 * i + 1;
        let own = records(&entity.parameters, 64, 'P', &format!("{number:>8}"), parameters.len() + 1);
        let Entity { kind, form, level, status, transform, color, .. } = entity;
        let (first, count) = (parameters.len() + 1, own.len());
        directory.push(format!(
            "{kind:>8}{first:>8}{:>8}{:>8}{level:>8}{:>8}{transform:>8}{:>8}{status:>8}D{number:>7}",
            0, 0, 0, 0
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

pub(super) fn model(entities: &[Entity]) -> Model {
    let model = read(lines(MILLIMETRES, entities).join("\n").as_bytes()).expect("an IGES file");
    let lost: usize = model.diagnostics.iter().map(|d| d.faces as usize).sum();
    assert_eq!(model.faces.len() + lost, model.declared_faces);
    model
}

/// The model of what must be read without any finding.
pub(super) fn clean(entities: &[Entity]) -> Model {
    let model = model(entities);
    assert!(model.diagnostics.is_empty(), "{:?}", model.diagnostics);
    model
}

/// A surface (entity 1) trimmed by curves that follow: a 144 with one 142 on a composite of `curves`.
pub(super) fn trimmed(surface: Entity, helpers: Vec<Entity>, curves: Vec<Entity>) -> Vec<Entity> {
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

pub(super) fn square() -> Vec<Entity> {
    ["0,0,0,2,0,0", "2,0,0,2,2,0", "2,2,0,0,2,0", "0,2,0,0,0,0"].map(|line| part(110, line)).into()
}

/// The area of the rectangle around the first face's parameter region.
pub(super) fn trims(model: &Model) -> f64 {
    let trim = trim_face(model, crate::brep::Id::new(0), &TrimOptions::default()).expect("a trimmed face");
    let size = trim.window.max - trim.window.min;
    size.x * size.y
}

pub(super) const BILINEAR: &str =
    "1,1,1,1,0,0,1,0,0,0,0,1,1,0,0,1,1,1,1,1,1,0,0,0,20,0,0,0,20,0,20,20,5,0,1,0,1";

/// A tetrahedron with corners at the origin and at 1 on the axes.
pub(super) fn tetrahedron(solid: Entity) -> Vec<Entity> {
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

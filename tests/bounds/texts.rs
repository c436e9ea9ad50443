//! Texts of small files.

use std::fmt::Write;

/// A file of one square face #10 in the open shell #2 of the surface model #1, held by representation #3 in context #900:
/// millimetres and radians.
pub const PLATE: &str = include_str!("plate.step");

/// Bounded surfaces of every kind without topology, in a set #1 held by representation #2, and a boundary of curves of every kind.
pub const SURFACES: &str = include_str!("surfaces.step");

/// A file with `more` instances.
pub fn with(file: &str, more: &str) -> String {
    let (instances, end) = file.rsplit_once("ENDSEC;").expect("a data section");
    format!("{instances}{more}\nENDSEC;{end}")
}

/// A file of these instances and units alone.
pub fn step(data: &str) -> String {
    let at = PLATE.find("#1=").expect("the plate's first instance");
    format!("{}{data}\nENDSEC;\nEND-ISO-10303-21;\n", &PLATE[..at])
}

/// [`PLATE`] with the instance `name` replaced, and `more`.
pub fn plate_with(name: &str, replacement: &str, more: &str) -> String {
    let at = PLATE.find(&format!("\n{name}=")).expect("the plate has the instance") + 1;
    let end = at + PLATE[at..].find('\n').expect("a line");
    with(&format!("{}{name}={replacement}{}", &PLATE[..at], &PLATE[end..]), more)
}

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

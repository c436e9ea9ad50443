//! The global section (IGES 5.3, clause 2.2.4.3): delimiters, units, scale, resolution, and where the file comes from.

use super::value::{Delimiters, Value, values};
use crate::brep::{LengthUnit, Source};

/// What the reader needs of the global section.
#[derive(Debug, Clone)]
pub struct Global {
    /// Between parameters and at the end of records.
    pub delimiters: Delimiters,
    /// For people.
    pub source: Source,
    /// The product's name as the sending system gives it, else the file's.
    pub product: String,
    /// Millimetres in one unit of the file's coordinates, the model's scale included.
    pub millimetres: f64,
    /// The least distance that the sending system tells apart, in millimetres.
    pub resolution: f64,
    /// What was odd.
    pub findings: Vec<String>,
}

/// Units by their flags 1 to 11, with their names. Flag 3 leaves the unit to the name.
const UNITS: [(&str, f64); 11] = [
    ("inch", 25.4),
    ("mm", 1.0),
    ("", 0.0),
    ("ft", 304.8),
    ("mi", 1_609_344.0),
    ("m", 1000.0),
    ("km", 1e6),
    ("mil", 0.0254),
    ("um", 1e-3),
    ("cm", 10.0),
    ("uin", 25.4e-6),
];

/// The names that clause 2.2.4.3.15 and common systems give to the units, by index in [`UNITS`].
const UNIT_NAMES: [(&str, usize); 17] = [
    ("IN", 0),
    ("INCH", 0),
    ("INCHES", 0),
    ("MM", 1),
    ("MILLIMETER", 1),
    ("MILLIMETERS", 1),
    ("FT", 3),
    ("FOOT", 3),
    ("FEET", 3),
    ("MI", 4),
    ("M", 5),
    ("METER", 5),
    ("KM", 6),
    ("MIL", 7),
    ("UM", 8),
    ("CM", 9),
    ("UIN", 10),
];

/// Reads the records of the section; defaults stand in for what is missing.
pub fn read(cards: &[&[u8]]) -> Global {
    let mut text = Vec::with_capacity(72 * cards.len());
    for card in cards {
        text.extend_from_slice(card);
        text.resize(text.len() + 72usize.saturating_sub(card.len()), b' ');
    }
    let delimiters = delimiters(&text);
    let (values, _) = values(&text, delimiters);
    let string = |at: usize| match values.get(at - 1) {
        Some(Value::Text(text)) => text.trim().to_owned(),
        _ => String::new(),
    };
    let number = |at: usize| match values.get(at - 1) {
        Some(Value::Number(number)) => Some(*number),
        _ => None,
    };
    let mut findings = Vec::new();
    let unit = unit(number(14), &string(15), &mut findings);
    let scale = match number(13) {
        Some(scale) if scale > 0.0 => scale,
        None => 1.0,
        Some(scale) => {
            findings.push(format!("the model space scale is {scale}; taken as 1"));
            1.0
        }
    };
    if scale != 1.0 {
        findings.push(format!("the model space scale is {scale}: coordinates are divided by it"));
    }
    let millimetres = unit.millimetres / scale;
    let resolution = number(19).filter(|r| *r > 0.0).unwrap_or(0.0) * millimetres;
    let version = [
        "",
        "1.0",
        "ANSI Y14.26M-1981",
        "2.0",
        "3.0",
        "ANSI Y14.26M-1987",
        "4.0",
        "ASME Y14.26M-1989",
        "5.0",
    ];
    let version = match number(23) {
        Some(flag @ 1.0..=8.0) => version[flag as usize],
        Some(9.0) => "5.1",
        Some(10.0) => "5.2",
        Some(11.0..) => "5.3",
        _ => "",
    };
    Global {
        delimiters,
        source: Source {
            format: "IGES".into(),
            schema: if version.is_empty() { "IGES".into() } else { format!("IGES {version}") },
            originating_system: Some(string(5)).filter(|s| !s.is_empty()).unwrap_or_else(|| string(6)),
            unit,
        },
        product: product(&string(3), &string(4), [&string(5), &string(6)]),
        millimetres,
        resolution,
        findings,
    }
}

/// The product's name, unless it is that of the system or of its translator, as several write it; else the file's, without its
/// folder and extension.
fn product(name: &str, file: &str, systems: [&str; 2]) -> String {
    if !name.is_empty() && !systems.contains(&name) {
        return name.to_owned();
    }
    let file = file.rsplit(['/', '\\', ']', ':']).next().unwrap_or_default();
    let stem = file.rsplit_once('.').map_or(file, |(stem, _)| stem);
    if stem.is_empty() { name.to_owned() } else { stem.to_owned() }
}

/// The first two parameters: `1Ha` each, or nothing for the default.
fn delimiters(text: &[u8]) -> Delimiters {
    let mut found = Delimiters::default();
    let text = text.trim_ascii_start();
    let rest = match text {
        [b'1', b'H', character, rest @ ..] if is_delimiter(*character) => {
            found.parameter = *character;
            rest
        }
        _ => text,
    };
    // After the delimiter stands the second string, or the delimiter of an empty one.
    let rest = rest.strip_prefix(&[found.parameter]).unwrap_or(rest).trim_ascii_start();
    if let [b'1', b'H', character, ..] = rest
        && is_delimiter(*character)
        && *character != found.parameter
    {
        found.record = *character;
    }
    found
}

/// Characters that numbers and strings need, and control characters, delimit nothing.
fn is_delimiter(character: u8) -> bool {
    character.is_ascii_graphic()
        && !character.is_ascii_digit()
        && !matches!(character, b'+' | b'-' | b'.' | b'D' | b'E' | b'H')
}

fn unit(flag: Option<f64>, name: &str, findings: &mut Vec<String>) -> LengthUnit {
    let unit = |index: usize| LengthUnit { name: UNITS[index].0.into(), millimetres: UNITS[index].1 };
    let by_name = || {
        let upper = name.to_ascii_uppercase();
        UNIT_NAMES.iter().find(|(known, _)| *known == upper).map(|(_, index)| unit(*index))
    };
    match flag {
        Some(flag) if flag.fract() == 0.0 && (1.0..=11.0).contains(&flag) && flag != 3.0 => {
            let by_flag = unit(flag as usize - 1);
            if let Some(by_name) = by_name()
                && by_name.millimetres != by_flag.millimetres
            {
                let finding =
                    format!("the unit's flag says {}, its name {name}: the flag counts", by_flag.name);
                findings.push(finding);
            }
            by_flag
        }
        _ => by_name().unwrap_or_else(|| {
            findings
                .push("the file names no known unit; taken as inches, the default of the standard".into());
            unit(0)
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn global(text: &str) -> Global {
        let cards: Vec<&[u8]> = text.as_bytes().chunks(72).collect();
        read(&cards)
    }

    #[test]
    fn a_usual_section() {
        let text = "1H,,1H;,4Hpart,8Hpart.igs,6Hsystem,3H1.0,32,38,6,308,15,4Hpart,0.5,6,1HM,1,1.0,15H20200101.000000,1E-6,\
                    1000.,2Hme,4Hhere,11,0;";
        let global = global(text);
        assert_eq!(global.delimiters, Delimiters::default());
        assert_eq!((global.millimetres, global.resolution), (2000.0, 2e-3));
        assert_eq!(
            (global.source.originating_system.as_str(), global.source.schema.as_str()),
            ("system", "IGES 5.3")
        );
        assert_eq!(global.source.unit.name, "m");
    }

    #[test]
    fn product_names() {
        assert_eq!(product("bolt", "a.igs", ["system", "1.0"]), "bolt");
        assert_eq!(product("", "C:\\parts\\bolt.v2.igs", ["system", "1.0"]), "bolt.v2");
        assert_eq!(product("translator 1", "/home/bolt", ["system", "translator 1"]), "bolt");
        assert_eq!(product("system", "", ["system", "1.0"]), "system");
    }

    #[test]
    fn delimiters_of_all_kinds() {
        assert_eq!(global(",,4Hpart,,").delimiters, Delimiters::default());
        let other = Delimiters { parameter: b'/', record: b'#' };
        assert_eq!(global("1H//1H#/4Hpart/").delimiters, other);
        assert_eq!(global("1H//1H#/1Ha/1Hb/1Hc/1Hd/1/1/1/1/1/1Ha/1./2#").millimetres, 1.0);
        assert_eq!(global(",1H#,4Hpart,").delimiters, Delimiters { parameter: b',', record: b'#' });
        assert_eq!(global("").delimiters, Delimiters::default());
    }

    #[test]
    fn units_by_flag_and_by_name() {
        let with = |unit: &str| global(&format!(",,,,,,,,,,,,1.,{unit},1,0.1,,1e-3;"));
        assert_eq!(with("2,2HMM").millimetres, 1.0);
        assert_eq!(with("1,").millimetres, 25.4);
        assert_eq!(with("3,4Hinch").millimetres, 25.4);
        assert_eq!(with("3,2HCM").millimetres, 10.0);
        assert_eq!(with("9,").millimetres, 1e-3);
        // The flag counts, but what contradicts it is said.
        let contradiction = with("2,2HIN");
        assert_eq!((contradiction.millimetres, contradiction.findings.len()), (1.0, 1));
        assert_eq!(with("2,").findings.len() + with("3,6Hinches").findings.len(), 0);
        let unknown = with("0,");
        assert_eq!((unknown.millimetres, unknown.findings.len()), (25.4, 1));
    }
}

//! Records and their dress: line ends, delimiters, units, the compressed form, and what is missing or wrong in them.

use super::tests::*;
use super::{IgesError, read};

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

/// A square in a plane, and how many faces it has in the end.
fn square_faces(change: impl Fn(Vec<String>) -> String) -> (usize, usize) {
    let lines = lines(MILLIMETRES, &trimmed(part(108, "0,0,1,0"), Vec::new(), square()));
    let text = change(lines);
    let model = read(text.as_bytes()).unwrap_or_else(|error| panic!("{error}: {text}"));
    (model.faces.len(), model.edges.len())
}

#[test]
fn records_that_other_systems_write() {
    // Blanks before every eighth column as tabs, the way an editor saves them.
    let tabbed = |line: &String| -> String {
        let (data, rest) = line.split_at(72);
        let field = |f: &[u8]| {
            let field = std::str::from_utf8(f).expect("ASCII");
            let text = field.trim_end();
            if text.len() < field.len() { format!("{text}\t") } else { text.to_owned() }
        };
        data.as_bytes().chunks(8).map(field).collect::<String>() + rest
    };
    let dresses: Vec<Box<dyn Fn(Vec<String>) -> String>> = vec![
        Box::new(|lines| format!("\u{feff}{}\r\n\u{1a}", lines.join("\r\n"))),
        Box::new(|lines| lines.join("\r")),
        // Letters in lower case, with and without numbers.
        Box::new(|lines| {
            let lower = |l: &String| format!("{}{}{}", &l[..72], l[72..73].to_lowercase(), &l[73..]);
            lines.iter().map(lower).collect::<Vec<_>>().join("\n")
        }),
        Box::new(|lines| lines.iter().map(|l| l[..73].to_owned()).collect::<Vec<_>>().join("\n")),
        Box::new(move |lines| lines.iter().map(tabbed).collect::<Vec<_>>().join("\n")),
        // No terminate record, no start section, no end of line after the last record.
        Box::new(|lines| lines[1..lines.len() - 1].join("\n")),
        // Pointers to parameters that are all wrong, and counts of one record: what points back counts.
        Box::new(|lines| {
            let wrong = |l: &String| match l.as_bytes()[72] {
                b'D' if l[73..].trim().parse::<u32>().is_ok_and(|n| n % 2 == 1) => {
                    format!("{}{:>8}{}", &l[..8], 3, &l[16..])
                }
                _ => l.clone(),
            };
            lines.iter().map(wrong).collect::<Vec<_>>().join("\n")
        }),
        // Nothing points back.
        Box::new(|lines| {
            let blank = |l: &String| {
                if l.as_bytes()[72] == b'P' { format!("{:<72}{}", &l[..64], &l[72..]) } else { l.clone() }
            };
            lines.iter().map(blank).collect::<Vec<_>>().join("\n")
        }),
    ];
    for (i, dress) in dresses.iter().enumerate() {
        assert_eq!(square_faces(dress), (1, 4), "dress {i}");
    }
}

#[test]
fn a_lost_directory_record_costs_its_entity() {
    let entities = [top(128, BILINEAR), top(196, "5,1.0"), part(116, "0,0,0"), top(128, BILINEAR)];
    let mut lines = lines(MILLIMETRES, &entities);
    let second = lines.iter().position(|line| line[72..] == *"D      3").expect("the second entity");
    lines.remove(second);
    let model = read(lines.join("\n").as_bytes()).expect("an IGES file");
    assert_eq!(model.faces.iter().map(|face| face.entity).collect::<Vec<_>>(), [1, 7]);
    assert!(model.diagnostics.iter().any(|d| d.reason.contains("other half")));
}

#[test]
fn missing_sections() {
    let lines = lines(MILLIMETRES, &[top(128, BILINEAR)]);
    let without = |letter: u8| {
        let kept: Vec<&String> = lines.iter().filter(|line| line.as_bytes()[72] != letter).collect();
        kept.iter().map(|line| line.as_str()).collect::<Vec<_>>().join("\n")
    };
    let model = read(without(b'G').as_bytes()).expect("an IGES file");
    assert_eq!((model.faces.len(), model.source.unit.name.as_str()), (1, "inch"));
    assert_eq!(model.diagnostics.len(), 2);
    assert_eq!(read(without(b'D').as_bytes()).err(), Some(IgesError::Empty));
    let model = read(without(b'P').as_bytes()).expect("an IGES file");
    assert_eq!((model.faces.len(), model.declared_faces), (0, 1));
}

#[test]
fn strings_across_records() {
    let name = "a name that is longer than one record, with commas, and semicolons; and so on to the end";
    let mut entities = vec![top(402, "1,3,0,1,5").form(7), top(128, BILINEAR)];
    entities.push(part(406, &format!("1,{}H{name}", name.len())).form(15));
    let model = clean(&entities);
    assert_eq!(model.parts[model.parts[model.roots[0]].children[0].part].name, name);
}

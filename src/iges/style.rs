//! Colours (field 13 of the directory, entity 314) and names (entity 406, form 15; else the entity's label).

use super::directory::{Directory, Parameters};
use super::value::Value;
use crate::brep::Color;

/// The standard's colours 1 to 8 (IGES 5.3, clause 2.2.4.4.13): black, red, green, blue, yellow, magenta, cyan, white.
const COLORS: [Color; 8] = [
    Color::opaque(0.0, 0.0, 0.0),
    Color::opaque(1.0, 0.0, 0.0),
    Color::opaque(0.0, 1.0, 0.0),
    Color::opaque(0.0, 0.0, 1.0),
    Color::opaque(1.0, 1.0, 0.0),
    Color::opaque(1.0, 0.0, 1.0),
    Color::opaque(0.0, 1.0, 1.0),
    Color::opaque(1.0, 1.0, 1.0),
];

/// The colour that `entity` itself has.
pub fn color(file: &Directory, entity: u32) -> Option<Color> {
    let number = file.entry(entity).ok()?.color;
    if number >= 0 {
        return COLORS.get((number as usize).checked_sub(1)?).copied();
    }
    let definition = file.parameters(number.unsigned_abs()).ok().filter(|p| p.kind == 314)?;
    let part = |at: usize| definition.real(at).ok().map(|percent| (percent / 100.0).clamp(0.0, 1.0) as f32);
    Some(Color::opaque(part(1)?, part(2)?, part(3)?))
}

/// The name that a property gives to an entity whose own parameters end before index `after`: then come a count of
/// associativities, these, a count of properties, and these. Else its label.
pub fn name(file: &Directory, parameters: &Parameters, after: usize) -> String {
    let count = |at: usize| parameters.count(at, 1).unwrap_or(0);
    let properties = after + 1 + count(after);
    for i in 0..count(properties) {
        let Ok(property) = parameters.reference(properties + 1 + i) else { continue };
        let is_name = file.entry(property).is_ok_and(|entry| entry.kind == 406 && entry.form == 15);
        if let (true, Ok(property)) = (is_name, file.parameters(property))
            && let Some(Value::Text(text)) = property.values.get(2)
        {
            return text.trim().to_owned();
        }
    }
    label(file, parameters.entity)
}

/// The label of an entity, with its subscript in parentheses; empty where it has none.
pub fn label(file: &Directory, entity: u32) -> String {
    let Ok(entry) = file.entry(entity) else { return String::new() };
    let label = String::from_utf8_lossy(entry.label.trim_ascii()).into_owned();
    match entry.subscript {
        _ if label.is_empty() => label,
        0 => label,
        subscript => format!("{label}({subscript})"),
    }
}

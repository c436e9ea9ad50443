//! Colours (ISO 10303-46): from a styled item down to a colour, kept by the item's entity number.
//!
//! The nearest colour counts: of the face, else of its shell, solid, representation. One that a style gives in the context of an
//! occurrence colours that occurrence; a mapped item is an occurrence by itself. A style that overrides another counts before
//! it, and one that overrides that before both.

use super::map_topology::FACE_KEYWORDS;
use super::reader::{MAX_CHAIN, Problem, Reader};
use super::value::{Entity, Record, Value};
use crate::brep::{Color, Severity};
use std::collections::HashMap;

/// A style may not have more parts than this; real ones have a dozen, a hostile one grows exponentially with its depth.
const MAX_STYLE_PARTS: usize = 256;

/// The colours that items have of their own.
#[derive(Debug, Default)]
pub struct Styles {
    items: HashMap<u64, Color>,
    /// By context-dependent shape representation, relationship or mapped item: the colour of one occurrence.
    occurrences: HashMap<u64, Color>,
}

impl Styles {
    /// The colour of item `id`.
    pub fn of(&self, id: u64) -> Option<Color> {
        self.items.get(&id).copied()
    }

    /// The colour of the occurrence that `id` places: a context-dependent shape representation, a relationship between
    /// representations, or a mapped item.
    pub fn of_occurrence(&self, id: u64) -> Option<Color> {
        self.occurrences.get(&id).copied()
    }
}

/// The parameters of a styled item of any kind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StyledItem {
    /// Presentation styles.
    pub styles: Vec<u64>,
    /// What is styled.
    pub item: Option<u64>,
    /// The styled item that this one overrides.
    overridden: Option<u64>,
    /// The occurrences that it is about, from outside in; empty where it is about all.
    pub contexts: Vec<u64>,
}

/// Reads styled item `entity`; `None` where it is something else.
pub fn styled_item(entity: &Entity) -> Option<StyledItem> {
    let is_one = |record: &&Record| record.keyword.ends_with("STYLED_ITEM");
    if entity.records.len() == 1 {
        let record = Some(entity.first()).filter(is_one)?;
        let contexts = if record.keyword.starts_with("CONTEXT") { record.references(4) } else { Vec::new() };
        let (item, overridden) = (record.reference(2), record.reference(3));
        return Some(StyledItem { styles: record.references(1), item, overridden, contexts });
    }
    // Each partial record has its own parameters alone.
    let record = entity.record("STYLED_ITEM")?;
    let overriding = entity.record("OVER_RIDING_STYLED_ITEM");
    let context = entity.record("CONTEXT_DEPENDENT_OVER_RIDING_STYLED_ITEM");
    Some(StyledItem {
        styles: record.references(0),
        item: record.reference(1),
        overridden: overriding.and_then(|record| record.reference(0)),
        contexts: context.map(|record| record.references(0)).unwrap_or_default(),
    })
}

/// Reads the styled items `ids`.
pub fn read(reader: &mut Reader, ids: &[u64]) -> Styles {
    let mut styles = Styles::default();
    let mut assignments: HashMap<u64, Finding> = HashMap::new();
    // By how many others each overrides, item, colour.
    let mut found: Vec<(usize, u64, Color)> = Vec::new();
    let (mut astray, mut partial) = (Vec::new(), Vec::new());
    for &id in ids {
        let Some(styled) = reader.entity(id).ok().and_then(|entity| styled_item(&entity)) else { continue };
        let mut finding = Finding::default();
        for &style in &styled.styles {
            let known = assignments.entry(style).or_insert_with(|| {
                let mut finding = Finding::default();
                look_into(reader, style, 0, &mut { MAX_STYLE_PARTS }, &mut finding);
                finding
            });
            finding.add(*known);
        }
        let Some(color) = finding.color() else { continue };
        let Some(item) = styled.item.filter(|&item| reader.index.find(item).is_some()) else {
            astray.push(id);
            continue;
        };
        match styled.contexts.as_slice() {
            [] => found.push((rank(reader, styled.overridden), item, color)),
            [occurrence] if !FACE_KEYWORDS.contains(&&*reader.keyword(item)) => {
                styles.occurrences.insert(*occurrence, color);
            }
            _ => partial.push(id),
        }
    }
    found.sort_by_key(|&(rank, ..)| rank);
    styles.items = found.into_iter().map(|(_, item, color)| (item, color)).collect();
    report(reader, &astray, "styles of items that the file does not have");
    report(
        reader,
        &partial,
        "colours not used: of single faces of one occurrence, or of occurrences in occurrences",
    );
    styles
}

/// How many styled items `overridden` and what it overrides are.
fn rank(reader: &Reader, mut overridden: Option<u64>) -> usize {
    let mut rank = 0;
    while let Some(id) = overridden.filter(|_| rank < MAX_CHAIN) {
        rank += 1;
        overridden =
            reader.entity(id).ok().and_then(|e| styled_item(&e)).and_then(|styled| styled.overridden);
    }
    rank
}

fn report(reader: &mut Reader, ids: &[u64], what: &str) {
    if let Some(&entity) = ids.first() {
        let kind = "STYLED_ITEM".into();
        reader.report(Severity::Note, Problem { entity, kind, reason: format!("{} {what}", ids.len()) });
    }
}

/// What was found on the way down from a style.
#[derive(Debug, Default, Clone, Copy)]
struct Finding {
    rgb: Option<[f32; 3]>,
    transparency: Option<f32>,
    /// The colour of the side that looks inward, for want of another.
    inner: Option<Color>,
}

impl Finding {
    fn add(&mut self, other: Self) {
        self.rgb = self.rgb.or(other.rgb);
        self.transparency = self.transparency.or(other.transparency);
        self.inner = self.inner.or(other.inner);
    }

    fn color(self) -> Option<Color> {
        let opacity = 1.0 - self.transparency.unwrap_or(0.0);
        self.rgb.map(|rgb| Color { rgb, opacity }).or(self.inner)
    }
}

/// Goes down from `id`: presentation style, surface side, fill area, colour. Curve and point styles colour no face.
fn look_into(reader: &Reader, id: u64, depth: usize, budget: &mut usize, finding: &mut Finding) {
    if depth > MAX_CHAIN || *budget == 0 {
        return;
    }
    *budget -= 1;
    let Ok(entity) = reader.entity(id) else { return };
    for record in &entity.records {
        match &*record.keyword {
            "COLOUR_RGB" => {
                let component = |at| record.real(at).map(|c| c.clamp(0.0, 1.0) as f32);
                if let (Some(red), Some(green), Some(blue)) = (component(1), component(2), component(3)) {
                    finding.add(Finding { rgb: Some([red, green, blue]), ..Finding::default() });
                }
            }
            "DRAUGHTING_PRE_DEFINED_COLOUR" | "PRE_DEFINED_COLOUR" => {
                let rgb = pre_defined(&record.text(0).to_lowercase());
                finding.add(Finding { rgb, ..Finding::default() });
            }
            "SURFACE_STYLE_TRANSPARENT" => {
                let transparency = record.real(0).map(|t| t.clamp(0.0, 1.0) as f32);
                finding.add(Finding { transparency, ..Finding::default() });
            }
            "PRESENTATION_STYLE_ASSIGNMENT"
            | "PRESENTATION_STYLE_BY_CONTEXT"
            | "SURFACE_SIDE_STYLE"
            | "SURFACE_STYLE_FILL_AREA"
            | "FILL_AREA_STYLE"
            | "FILL_AREA_STYLE_COLOUR"
            | "SURFACE_STYLE_RENDERING"
            | "SURFACE_STYLE_RENDERING_WITH_PROPERTIES" => {
                look_below(reader, record, depth, budget, finding);
            }
            "SURFACE_STYLE_USAGE" if record.get(0).enumeration().as_deref() == Some("NEGATIVE") => {
                let mut inner = Finding::default();
                look_below(reader, record, depth, budget, &mut inner);
                finding.inner = finding.inner.or(inner.color());
            }
            "SURFACE_STYLE_USAGE" => look_below(reader, record, depth, budget, finding),
            _ => {}
        }
    }
}

/// Looks into all that `record` refers to.
fn look_below(reader: &Reader, record: &Record, depth: usize, budget: &mut usize, finding: &mut Finding) {
    for parameter in &record.parameters {
        let inner = parameter.list().unwrap_or(std::slice::from_ref(parameter));
        for reference in inner.iter().filter_map(Value::reference) {
            look_into(reader, reference, depth + 1, budget, finding);
        }
    }
}

/// ISO 10303-46, draughting_pre_defined_colour.
fn pre_defined(name: &str) -> Option<[f32; 3]> {
    Some(match name {
        "red" => [1.0, 0.0, 0.0],
        "green" => [0.0, 1.0, 0.0],
        "blue" => [0.0, 0.0, 1.0],
        "yellow" => [1.0, 1.0, 0.0],
        "magenta" => [1.0, 0.0, 1.0],
        "cyan" => [0.0, 1.0, 1.0],
        "black" => [0.0, 0.0, 0.0],
        "white" => [1.0, 1.0, 1.0],
        _ => return None,
    })
}

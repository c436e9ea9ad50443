//! Colours (ISO 10303-46): from a styled item down to a colour, kept by the item's entity number.

use super::reader::{MAX_CHAIN, Reader};
use super::value::Value;
use crate::brep::Color;
use std::collections::HashMap;

/// A style may not have more parts than this; real ones have a dozen, a hostile one grows exponentially with its depth.
const MAX_STYLE_PARTS: usize = 256;

/// The colours that items have of their own.
#[derive(Debug, Default)]
pub struct Styles {
    items: HashMap<u64, Color>,
    /// By context-dependent shape representation: the colour of one occurrence.
    occurrences: HashMap<u64, Color>,
}

impl Styles {
    /// The colour of item `id`.
    pub fn of(&self, id: u64) -> Option<Color> {
        self.items.get(&id).copied()
    }

    /// The colour of the occurrence that CONTEXT_DEPENDENT_SHAPE_REPRESENTATION `id` places.
    pub fn of_occurrence(&self, id: u64) -> Option<Color> {
        self.occurrences.get(&id).copied()
    }
}

/// Reads the styled items `ids`: those that override come last.
pub fn read(reader: &Reader, ids: &[u64]) -> Styles {
    let mut styles = Styles::default();
    let mut assignments: HashMap<u64, Option<Finding>> = HashMap::new();
    let mut overriding = Vec::new();
    for &id in ids {
        let Ok(entity) = reader.entity(id) else { continue };
        let record = entity.record("STYLED_ITEM").filter(|_| entity.records.len() > 1);
        let (record, at) = match record {
            Some(record) => (record, 0),
            None => (entity.first(), 1),
        };
        let mut finding = Finding::default();
        for style in record.references(at) {
            let known = assignments.entry(style).or_insert_with(|| {
                let mut finding = Finding::default();
                look_into(reader, style, 0, &mut { MAX_STYLE_PARTS }, &mut finding);
                finding.rgb.is_some().then_some(finding)
            });
            finding.add(known.unwrap_or_default());
        }
        let (Some(color), Some(item)) = (finding.color(), record.reference(at + 1)) else { continue };
        if let Some(contexts) = entity.record("CONTEXT_DEPENDENT_OVER_RIDING_STYLED_ITEM") {
            if let [context] = contexts.parameters.last().and_then(Value::list).unwrap_or_default() {
                styles.occurrences.extend(context.reference().map(|id| (id, color)));
            }
        } else if entity.is("OVER_RIDING_STYLED_ITEM") {
            overriding.push((item, color));
        } else {
            styles.items.insert(item, color);
        }
    }
    styles.items.extend(overriding);
    styles
}

/// What was found on the way down from a style.
#[derive(Debug, Default, Clone, Copy)]
struct Finding {
    rgb: Option<[f32; 3]>,
    transparency: Option<f32>,
}

impl Finding {
    fn add(&mut self, other: Self) {
        self.rgb = self.rgb.or(other.rgb);
        self.transparency = self.transparency.or(other.transparency);
    }

    fn color(self) -> Option<Color> {
        let opacity = 1.0 - self.transparency.unwrap_or(0.0);
        self.rgb.map(|rgb| Color { rgb, opacity })
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
                    finding.add(Finding { rgb: Some([red, green, blue]), transparency: None });
                }
            }
            "DRAUGHTING_PRE_DEFINED_COLOUR" | "PRE_DEFINED_COLOUR" => {
                let rgb = pre_defined(&record.text(0).to_lowercase());
                finding.add(Finding { rgb, transparency: None });
            }
            "SURFACE_STYLE_TRANSPARENT" => {
                let transparency = record.real(0).map(|t| t.clamp(0.0, 1.0) as f32);
                finding.add(Finding { rgb: None, transparency });
            }
            "PRESENTATION_STYLE_ASSIGNMENT"
            | "PRESENTATION_STYLE_BY_CONTEXT"
            | "SURFACE_STYLE_USAGE"
            | "SURFACE_SIDE_STYLE"
            | "SURFACE_STYLE_FILL_AREA"
            | "FILL_AREA_STYLE"
            | "FILL_AREA_STYLE_COLOUR"
            | "SURFACE_STYLE_RENDERING"
            | "SURFACE_STYLE_RENDERING_WITH_PROPERTIES" => {
                for parameter in &record.parameters {
                    let inner = parameter.list().unwrap_or(std::slice::from_ref(parameter));
                    for reference in inner.iter().filter_map(Value::reference) {
                        look_into(reader, reference, depth + 1, budget, finding);
                    }
                }
            }
            _ => {}
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

//! One pass over all statements that finds those from which the mapping starts.

use super::decode;
use super::hidden::is_left_out;
use super::map_tessellated::is_tessellated;
use super::map_topology::{BODY_KEYWORDS, FACE_KEYWORDS};
use super::reader::Reader;
use std::collections::{BTreeMap, HashSet};

/// Entity numbers by what they are, in ascending order.
#[derive(Debug, Default)]
pub struct Catalog {
    /// Declared faces.
    pub faces: HashSet<u64>,
    /// Solids, surface models, shells.
    pub bodies: Vec<u64>,
    /// Styled items of all kinds.
    pub styled_items: Vec<u64>,
    /// Shape representations of all kinds.
    pub representations: Vec<u64>,
    /// SHAPE_DEFINITION_REPRESENTATION.
    pub definitions: Vec<u64>,
    /// Relationships between representations.
    pub relationships: Vec<u64>,
    /// CONTEXT_DEPENDENT_SHAPE_REPRESENTATION.
    pub placements: Vec<u64>,
    /// CONSTRUCTIVE_GEOMETRY_REPRESENTATION: what its items lead to is no shape of the product.
    pub constructions: Vec<u64>,
    /// Occurrences of products in assemblies.
    pub usages: Vec<u64>,
    /// INVISIBILITY.
    pub invisibilities: Vec<u64>,
    /// Tessellated surfaces: items with triangles, and what holds them.
    pub tessellated: Vec<u64>,
    /// Annotations that are drawn by tessellated items.
    pub tessellated_annotations: Vec<u64>,
    /// PROPERTY_DEFINITION_REPRESENTATION, which may give a product its shape as well.
    pub properties: Vec<u64>,
    /// Documents that may hold shape in other files.
    pub documents: Vec<u64>,
    /// Kinds of items that are no surface: the first of each and how many there are.
    pub left_out: BTreeMap<String, (u64, usize)>,
}

/// Sorts all statements.
pub fn read(reader: &Reader) -> Catalog {
    let mut catalog = Catalog::default();
    for statement in &reader.index.statements {
        let body = &reader.index.bytes[statement.body.clone()];
        let keyword = decode::leading_keyword(body);
        if keyword.is_empty() {
            let records = reader.raw_records(statement.id);
            // A complex instance is what its most specific part says; the parts stand in alphabetical order.
            let is_part = |keyword: &&str| records.iter().any(|r| r.keyword == *keyword);
            let mut known = FACE_KEYWORDS.iter().chain(&BODY_KEYWORDS).chain(&COMPLEX_KEYWORDS).copied();
            let tessellated = || records.iter().map(|r| &*r.keyword).find(|k| is_tessellated(k));
            if let Some(known) = known.find(is_part).or_else(tessellated) {
                catalog.add(known, statement.id);
            }
        } else {
            catalog.add(&decode::upper_case(keyword), statement.id);
        }
    }
    catalog
}

/// Further keywords that complex instances are known by.
const COMPLEX_KEYWORDS: [&str; 6] = [
    "STYLED_ITEM",
    "REPRESENTATION_RELATIONSHIP",
    "SHAPE_DEFINITION_REPRESENTATION",
    "SHAPE_REPRESENTATION",
    "NEXT_ASSEMBLY_USAGE_OCCURRENCE",
    "QUANTIFIED_ASSEMBLY_COMPONENT_USAGE",
];

impl Catalog {
    fn add(&mut self, keyword: &str, id: u64) {
        match keyword {
            _ if FACE_KEYWORDS.contains(&keyword) => {
                self.faces.insert(id);
            }
            "CONSTRUCTIVE_GEOMETRY_REPRESENTATION" => self.constructions.push(id),
            "TESSELLATED_ANNOTATION_OCCURRENCE" => {
                self.tessellated_annotations.push(id);
                self.leave_out(keyword, id);
            }
            "INVISIBILITY" => self.invisibilities.push(id),
            _ if is_left_out(keyword) => self.leave_out(keyword, id),
            _ if is_tessellated(keyword) => self.tessellated.push(id),
            _ if BODY_KEYWORDS.contains(&keyword) => self.bodies.push(id),
            "CONTEXT_DEPENDENT_SHAPE_REPRESENTATION" => self.placements.push(id),
            "NEXT_ASSEMBLY_USAGE_OCCURRENCE"
            | "QUANTIFIED_ASSEMBLY_COMPONENT_USAGE"
            | "PROMISSORY_USAGE_OCCURRENCE" => self.usages.push(id),
            "SHAPE_DEFINITION_REPRESENTATION" => self.definitions.push(id),
            "DOCUMENT_FILE" | "APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT" => self.documents.push(id),
            "PROPERTY_DEFINITION_REPRESENTATION" => self.properties.push(id),
            _ if keyword.ends_with("STYLED_ITEM") => self.styled_items.push(id),
            _ if keyword.contains("REPRESENTATION_RELATIONSHIP") => self.relationships.push(id),
            _ if keyword.ends_with("SHAPE_REPRESENTATION")
                || keyword == "TESSELLATED_SHAPE_REPRESENTATION_WITH_ACCURACY_PARAMETERS" =>
            {
                self.representations.push(id)
            }
            _ => {}
        }
    }

    fn leave_out(&mut self, keyword: &str, id: u64) {
        self.left_out.entry(keyword.to_owned()).or_insert((id, 0)).1 += 1;
    }
}

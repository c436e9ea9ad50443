//! The product tree (ISO 10303-41, -43, -44): which representation belongs to which product, and what is placed where.
//!
//! Representations that a plain SHAPE_REPRESENTATION_RELATIONSHIP joins describe the same thing, so they form one group; a
//! group becomes a part. Parts are placed by NEXT_ASSEMBLY_USAGE_OCCURRENCEs through context-dependent representations, or by
//! mapped items. Exporters disagree on which side of a relationship is the child: the occurrence's products decide, and
//! the order of the standard (the child first) only where they do not.

use super::catalog::Catalog;
use super::groups::Groups;
use super::hidden::is_left_out;
use super::map_bounded::is_loose_surface;
use super::map_placement::{mapped_representation, related, transformation};
use super::map_style::Styles;
use super::map_tessellated::{self, is_tessellated};
use super::map_topology::{BODY_KEYWORDS, FACE_KEYWORDS};
use super::reader::{MAX_CHAIN, Problem, Reader};
use super::roots;
use super::units::{self, Units};
use super::unreached;
use crate::brep::{Id, Part, Severity};
use std::collections::{HashMap, HashSet};

/// A representation: `(name, items, context)`.
#[derive(Debug, Clone, Default)]
pub struct Representation {
    pub name: String,
    pub items: Vec<u64>,
    pub context: Option<u64>,
}

/// Keywords of items that hold shape in a form that is not read, by what they contain.
const OTHER_SHAPES: [&str; 13] = [
    "SOLID",
    "SURFACE",
    "BREP",
    "CSG",
    "BOOLEAN",
    "BLOCK",
    "WEDGE",
    "SPHERE",
    "CYLINDER",
    "CONE",
    "TORUS",
    "SHELL",
    "TRIANGULATED",
];

/// Maps everything that the file's product structure reaches, then everything else.
pub fn map(reader: &mut Reader, catalog: &Catalog, styles: &Styles) {
    let mut assembly = Assembly::gather(reader, catalog);
    assembly.map_bodies(reader, styles);
    map_tessellated::map(reader, &mut assembly, catalog, styles);
    assembly.place_mapped_items(reader, styles);
    for &id in &catalog.placements {
        if let Err(problem) = assembly.place_occurrence(reader, id, styles) {
            reader.report(Severity::Dropped, problem);
        }
    }
    assembly.place_related(reader);
    assembly.place_usages(reader, &catalog.usages);
    unreached::map(&mut assembly, reader, catalog, styles);
    roots::find(reader, &assembly.hidden);
}

pub struct Assembly {
    /// In the order of mapping: those of products and those joined to them first.
    pub order: Vec<u64>,
    pub representations: HashMap<u64, Representation>,
    pub groups: Groups,
    /// Which items each representation has.
    pub items: HashSet<(u64, u64)>,
    /// Product definition by representation.
    products: HashMap<u64, u64>,
    /// The representations of each group, in the order of mapping.
    members: HashMap<u64, Vec<u64>>,
    /// Which product definitions each group describes.
    pub described: HashSet<(u64, u64)>,
    /// Relationships that place something without an occurrence.
    pub placing: Vec<u64>,
    parts: HashMap<u64, Id<Part>>,
    units: HashMap<Option<u64>, Units>,
    /// Occurrences that a context-dependent representation places.
    pub placed_usages: HashSet<u64>,
    /// Parts that are placed invisibly.
    pub hidden: HashSet<Id<Part>>,
    /// Placements made, so that one that is given twice (as occurrence and as mapped item) is made once.
    pub placed: HashSet<(Id<Part>, Id<Part>, [i64; 12])>,
}

impl Assembly {
    fn gather(reader: &Reader, catalog: &Catalog) -> Self {
        let mut assembly = Self {
            order: Vec::new(),
            representations: HashMap::new(),
            groups: Groups::default(),
            items: HashSet::new(),
            products: HashMap::new(),
            members: HashMap::new(),
            described: HashSet::new(),
            placing: Vec::new(),
            parts: HashMap::new(),
            units: HashMap::new(),
            placed_usages: HashSet::new(),
            hidden: HashSet::new(),
            placed: HashSet::new(),
        };
        let mut first_of_product = HashMap::new();
        let is_of_product = |id: &&u64| {
            let definition = reader.entity(**id).ok().and_then(|e| e.first().reference(0));
            definition.is_some_and(|definition| reader.keyword(definition) == "PRODUCT_DEFINITION_SHAPE")
        };
        let properties = catalog.properties.iter().filter(is_of_product);
        for &id in catalog.definitions.iter().chain(properties) {
            let Some((product, representation)) = defined_product(reader, id) else { continue };
            assembly.include(reader, representation);
            assembly.products.entry(representation).or_insert(product);
            let first = *first_of_product.entry(product).or_insert(representation);
            assembly.groups.join(first, representation);
        }
        for &id in &catalog.representations {
            assembly.include(reader, id);
        }
        assembly.relate(reader, catalog);
        assembly.put_products_first();
        for &id in &assembly.order {
            let group = assembly.groups.find(id);
            assembly.members.entry(group).or_default().push(id);
            assembly.described.extend(assembly.products.get(&id).map(|&product| (group, product)));
        }
        assembly
    }

    /// Adds representation `id` and those that it maps, and so on.
    pub fn include(&mut self, reader: &Reader, id: u64) {
        let mut waiting = vec![id];
        while let Some(id) = waiting.pop() {
            if self.representations.contains_key(&id) {
                continue;
            }
            let Ok(entity) = reader.entity(id) else { continue };
            let record = entity.record("REPRESENTATION").unwrap_or(entity.first());
            let representation = Representation {
                name: record.text(0),
                items: record.references(1),
                context: record.reference(2),
            };
            for &item in &representation.items {
                if reader.keyword(item) == "MAPPED_ITEM" {
                    waiting.extend(mapped_representation(reader, item).ok().map(|(_, mapped, _)| mapped));
                }
            }
            self.order.push(id);
            self.items.extend(representation.items.iter().map(|&item| (id, item)));
            self.representations.insert(id, representation);
        }
    }

    /// Joins what plain relationships relate and collects those that place.
    fn relate(&mut self, reader: &Reader, catalog: &Catalog) {
        let of_occurrences: HashSet<u64> = catalog
            .placements
            .iter()
            .filter_map(|&id| reader.entity(id).ok()?.first().reference(0))
            .collect();
        for &id in catalog.relationships.iter().filter(|id| !of_occurrences.contains(id)) {
            let Ok(entity) = reader.entity(id) else { continue };
            let Some([first, second]) = related(&entity) else { continue };
            let both_known =
                self.representations.contains_key(&first) && self.representations.contains_key(&second);
            let products = [first, second].map(|r| self.products.get(&r));
            let of_two_products =
                products[0].is_some() && products[1].is_some() && products[0] != products[1];
            if transformation(&entity).is_some() || (of_two_products && both_known) {
                self.placing.push(id);
            } else if both_known {
                self.groups.join(first, second);
            }
        }
    }

    /// A body that several representations share goes to the product that is joined to one of them, not to a shape aspect for which some exporters
    /// state properties of the body once more.
    fn put_products_first(&mut self) {
        let described: HashSet<u64> = self.products.keys().map(|&id| self.groups.find(id)).collect();
        let groups = &mut self.groups;
        self.order.sort_by_key(|&id| !described.contains(&groups.find(id)));
    }

    /// The part of a representation's group, where it was made.
    pub fn known_part(&mut self, representation: u64) -> Option<Id<Part>> {
        let group = self.groups.find(representation);
        self.parts.get(&group).copied()
    }

    /// The part of a representation's group, made when first needed.
    pub fn part(&mut self, reader: &mut Reader, representation: u64) -> Id<Part> {
        let group = self.groups.find(representation);
        if let Some(&part) = self.parts.get(&group) {
            return part;
        }
        let (mut name, mut entity) = (String::new(), representation);
        let members = self.members.get(&group).map_or(&[][..], Vec::as_slice);
        let of_product = members.iter().find_map(|r| self.products.get(r));
        if let Some(&product) = of_product {
            name = product_name(reader, product).unwrap_or_default();
            entity = product;
        }
        if name.is_empty() {
            name = members
                .iter()
                .map(|r| &self.representations[r].name)
                .find(|n| !n.is_empty())
                .cloned()
                .unwrap_or_default();
        }
        let part = reader.model.parts.push(Part { name, entity, ..Part::default() });
        self.parts.insert(group, part);
        part
    }

    pub fn use_units(&mut self, reader: &mut Reader, context: Option<u64>) {
        let units = match self.units.get(&context) {
            Some(units) => units.clone(),
            None => {
                let units = units::of_context(reader, context);
                self.units.insert(context, units.clone());
                units
            }
        };
        reader.set_units(units);
    }

    fn map_bodies(&mut self, reader: &mut Reader, styles: &Styles) {
        let mut unit_is_known = false;
        for at in 0..self.order.len() {
            let id = self.order[at];
            let Representation { items, context, .. } = self.representations[&id].clone();
            let (bodies, others): (Vec<u64>, Vec<u64>) =
                items.into_iter().partition(|&item| is_body(reader, item));
            let (loose, others): (Vec<u64>, Vec<u64>) =
                others.into_iter().partition(|&item| is_loose(reader, item));
            for item in others {
                report_other_shape(reader, item);
            }
            if bodies.is_empty() && loose.is_empty() {
                continue;
            }
            self.use_units(reader, context);
            if !unit_is_known {
                reader.model.source.unit = reader.units.length_unit();
                unit_is_known = true;
            }
            for item in bodies {
                match reader.body(item, styles, styles.of(id)) {
                    Ok(Some(body)) => {
                        let part = self.part(reader, id);
                        reader.model.parts[part].bodies.push(body);
                    }
                    Ok(None) => {}
                    Err(problem) => reader.report(Severity::Dropped, problem),
                }
            }
            let color = styles.of(id);
            let (sets, single): (Vec<u64>, Vec<u64>) =
                loose.into_iter().partition(|&item| reader.keyword(item) == "GEOMETRIC_SET");
            let mut sheets = vec![reader.loose_sheet(id, &single, styles, color)];
            for set in sets {
                let items = reader.entity(set).map(|e| e.first().references(1)).unwrap_or_default();
                sheets.push(reader.loose_sheet(set, &items, styles, styles.of(set).or(color)));
            }
            for sheet in sheets.into_iter().flatten() {
                let part = self.part(reader, id);
                reader.model.parts[part].bodies.push(sheet);
            }
        }
    }
}

fn is_body(reader: &Reader, id: u64) -> bool {
    let keyword = reader.keyword(id);
    if keyword.is_empty() {
        return reader.entity(id).is_ok_and(|e| BODY_KEYWORDS.iter().any(|k| e.is(k)));
    }
    BODY_KEYWORDS.contains(&&*keyword)
}

/// Whether an item is a face or surface outside of any shell, or a set of such.
fn is_loose(reader: &Reader, id: u64) -> bool {
    let keyword = reader.keyword(id);
    keyword == "GEOMETRIC_SET" || FACE_KEYWORDS.contains(&&*keyword) || is_loose_surface(reader, id)
}

fn report_other_shape(reader: &mut Reader, id: u64) {
    let kind = reader.keyword(id).into_owned();
    if !is_left_out(&kind) && !is_tessellated(&kind) && OTHER_SHAPES.iter().any(|word| kind.contains(word)) {
        reader.report(
            Severity::Dropped,
            Problem { entity: id, kind, reason: "this kind of shape is not read".into() },
        );
    }
}

/// SHAPE_DEFINITION_REPRESENTATION(definition, representation): the product definition behind it, and the representation.
fn defined_product(reader: &Reader, id: u64) -> Option<(u64, u64)> {
    let entity = reader.entity(id).ok()?;
    let shape = reader.entity(entity.first().reference(0)?).ok()?;
    let product = shape.first().reference(2)?;
    let representation = entity.first().reference(1)?;
    reader.keyword(product).starts_with("PRODUCT_DEFINITION").then_some((product, representation))
}

/// PRODUCT_DEFINITION → formation → PRODUCT: its name, else its id.
fn product_name(reader: &Reader, definition: u64) -> Option<String> {
    let mut entity = reader.entity(definition).ok()?;
    for _ in 0..MAX_CHAIN {
        let record = entity.record("PRODUCT").unwrap_or(entity.first());
        if record.keyword == "PRODUCT" {
            return [1, 0].map(|at| record.text(at)).into_iter().find(|name| !name.is_empty());
        }
        entity = reader.entity(record.reference(2)?).ok()?;
    }
    None
}

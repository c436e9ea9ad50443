//! The product tree (ISO 10303-41, -43, -44): which representation belongs to which product, and what is placed where.
//!
//! Representations that a plain SHAPE_REPRESENTATION_RELATIONSHIP joins describe the same thing, so they form one group; a
//! group becomes a part. Parts are placed by NEXT_ASSEMBLY_USAGE_OCCURRENCEs through context-dependent representations, or by
//! mapped items. Exporters disagree on which side of a relationship is the child: the occurrence's products decide, and
//! the order of the standard (the child first) only where they do not.

use super::catalog::Catalog;
use super::groups::Groups;
use super::map_style::Styles;
use super::map_topology::BODY_KEYWORDS;
use super::reader::{MAX_CHAIN, Mapped, Problem, Reader, problem, reference};
use super::units::{self, Units};
use super::value::Entity;
use crate::brep::{Child, Color, Id, Part, Severity};
use glam::DAffine3;
use std::collections::{HashMap, HashSet};

/// A representation: `(name, items, context)`.
#[derive(Debug, Clone, Default)]
struct Representation {
    name: String,
    items: Vec<u64>,
    context: Option<u64>,
}

/// Keywords of items that hold shape in a form that is not read, by what they contain.
const OTHER_SHAPES: [&str; 14] = [
    "TESSELLATED",
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
    assembly.place_mapped_items(reader, styles);
    for &id in &catalog.placements {
        if let Err(problem) = assembly.place_occurrence(reader, id, styles) {
            reader.report(Severity::Warning, problem);
        }
    }
    assembly.place_related(reader);
    assembly.map_unreached(reader, catalog, styles);
    find_roots(reader);
}

struct Assembly {
    /// In the order of mapping: those of products first.
    order: Vec<u64>,
    representations: HashMap<u64, Representation>,
    groups: Groups,
    /// Which items each representation has.
    items: HashSet<(u64, u64)>,
    /// Product definition by representation.
    products: HashMap<u64, u64>,
    /// The representations of each group, in the order of mapping.
    members: HashMap<u64, Vec<u64>>,
    /// Which product definitions each group describes.
    described: HashSet<(u64, u64)>,
    /// Relationships that place something without an occurrence.
    placing: Vec<u64>,
    parts: HashMap<u64, Id<Part>>,
    units: HashMap<Option<u64>, Units>,
    /// Placements made, so that one that is given twice (as occurrence and as mapped item) is made once.
    placed: HashSet<(Id<Part>, Id<Part>, [i64; 12])>,
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
            placed: HashSet::new(),
        };
        let mut first_of_product = HashMap::new();
        for &id in &catalog.definitions {
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
        for &id in &assembly.order {
            let group = assembly.groups.find(id);
            assembly.members.entry(group).or_default().push(id);
            assembly.described.extend(assembly.products.get(&id).map(|&product| (group, product)));
        }
        assembly
    }

    /// Adds representation `id` and those that it maps, and so on.
    fn include(&mut self, reader: &Reader, id: u64) {
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

    /// The part of a representation's group, made when first needed.
    fn part(&mut self, reader: &mut Reader, representation: u64) -> Id<Part> {
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

    fn use_units(&mut self, reader: &mut Reader, context: Option<u64>) {
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
            for item in others {
                report_other_shape(reader, item);
            }
            if bodies.is_empty() {
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
        }
    }

    fn place_mapped_items(&mut self, reader: &mut Reader, styles: &Styles) {
        for at in 0..self.order.len() {
            let id = self.order[at];
            let Representation { items, context, .. } = self.representations[&id].clone();
            for item in items {
                if reader.keyword(item) == "MAPPED_ITEM"
                    && let Err(problem) = self.place_mapped_item(reader, id, context, item, styles)
                {
                    reader.report(Severity::Warning, problem);
                }
            }
        }
    }

    fn place_mapped_item(
        &mut self,
        reader: &mut Reader,
        parent: u64,
        context: Option<u64>,
        item: u64,
        styles: &Styles,
    ) -> Mapped<()> {
        let (origin, mapped, target) = mapped_representation(reader, item)?;
        let mapped_context = self.representations.get(&mapped).and_then(|r| r.context);
        self.use_units(reader, context);
        let parent_from_target = reader.transform(target)?;
        self.use_units(reader, mapped_context);
        let child_from_origin = reader.transform(origin)?;
        let entity = reader.entity(item)?;
        let placement = Placement {
            parent,
            child: mapped,
            parent_from_child: parent_from_target * child_from_origin.inverse(),
            name: entity.first().text(0),
            color: styles.of(item),
            entity: item,
        };
        self.place(reader, placement)
    }

    /// CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(relationship, product definition shape of an occurrence).
    fn place_occurrence(&mut self, reader: &mut Reader, id: u64, styles: &Styles) -> Mapped<()> {
        let entity = reader.entity(id)?;
        let relationship = reader.referred(id, entity.first(), 0)?;
        let shape = reader.referred(id, entity.first(), 1)?;
        let occurrence = reader.referred(shape.id, shape.first(), 2)?;
        let usage = occurrence.first();
        let (parent_product, child_product) = (usage.reference(3), usage.reference(4));
        let [first, second] = related(&relationship)
            .ok_or_else(|| problem(&relationship, "two representations are not related"))?;
        let of = |assembly: &mut Self, representation: u64, product: Option<u64>| {
            product.is_some_and(|product| assembly.belongs(representation, product))
        };
        let first_is_child = if of(self, first, child_product) && of(self, second, parent_product) {
            true
        } else if of(self, second, child_product) && of(self, first, parent_product) {
            false
        } else {
            of(self, first, child_product) || !of(self, second, child_product)
        };
        let name = [1, 0].map(|at| usage.text(at)).into_iter().find(|name| is_name(name)).unwrap_or_default();
        let color = styles.of_occurrence(id);
        self.place_by_relationship(reader, &relationship, [first, second], first_is_child, name, color)
    }

    /// Relationships with a transformation that no occurrence uses.
    fn place_related(&mut self, reader: &mut Reader) {
        for id in std::mem::take(&mut self.placing) {
            let placed = reader.entity(id).and_then(|entity| match related(&entity) {
                Some(pair) => {
                    let first_is_child = transformation(&entity).is_some();
                    self.place_by_relationship(reader, &entity, pair, first_is_child, String::new(), None)
                }
                None => Ok(()),
            });
            if let Err(problem) = placed {
                reader.report(Severity::Warning, problem);
            }
        }
    }

    fn place_by_relationship(
        &mut self,
        reader: &mut Reader,
        relationship: &Entity,
        [first, second]: [u64; 2],
        first_is_child: bool,
        name: String,
        color: Option<Color>,
    ) -> Mapped<()> {
        let (child, parent) = if first_is_child { (first, second) } else { (second, first) };
        let parent_from_child = match transformation(relationship) {
            None => DAffine3::IDENTITY,
            Some(id) => self.relative_placement(reader, id, child, parent, first_is_child)?,
        };
        self.place(
            reader,
            Placement { parent, child, parent_from_child, name, color, entity: relationship.id },
        )
    }

    /// The matrix of an ITEM_DEFINED_TRANSFORMATION or an operator.
    fn relative_placement(
        &mut self,
        reader: &mut Reader,
        id: u64,
        child: u64,
        parent: u64,
        first_is_child: bool,
    ) -> Mapped<DAffine3> {
        let context = |assembly: &Self, r: u64| assembly.representations.get(&r).and_then(|r| r.context);
        let (child_context, parent_context) = (context(self, child), context(self, parent));
        let entity = reader.entity(id)?;
        let Some(record) = entity.record("ITEM_DEFINED_TRANSFORMATION") else {
            self.use_units(reader, parent_context);
            let second_from_first = reader.transform(id)?;
            return Ok(if first_is_child { second_from_first } else { second_from_first.inverse() });
        };
        let items = [reference(id, record, 2)?, reference(id, record, 3)?];
        let (mut in_child, mut in_parent) =
            if first_is_child { (items[0], items[1]) } else { (items[1], items[0]) };
        // The items belong to their representations; where they are given the other way round, they say so themselves.
        let holds = |representation: u64, item: u64| self.items.contains(&(representation, item));
        let as_given = holds(child, in_child) && holds(parent, in_parent);
        if !as_given && holds(child, in_parent) && holds(parent, in_child) {
            std::mem::swap(&mut in_child, &mut in_parent);
        }
        self.use_units(reader, child_context);
        let child_from_item = reader.transform(in_child)?;
        self.use_units(reader, parent_context);
        let parent_from_item = reader.transform(in_parent)?;
        Ok(parent_from_item * child_from_item.inverse())
    }

    fn place(&mut self, reader: &mut Reader, placement: Placement) -> Mapped<()> {
        let Placement { parent, child, parent_from_child, name, color, entity } = placement;
        let wrong = |reason: &str| Problem { entity, kind: "placement".into(), reason: reason.into() };
        if !parent_from_child.is_finite() || parent_from_child.matrix3.determinant() == 0.0 {
            return Err(wrong("the placement has no finite inverse; the component is left out"));
        }
        for representation in [parent, child] {
            if !self.representations.contains_key(&representation) {
                self.include(reader, representation);
            }
        }
        if self.groups.find(parent) == self.groups.find(child) {
            return Err(wrong("a part is placed in itself; the component is left out"));
        }
        let (parent, part) = (self.part(reader, parent), self.part(reader, child));
        let key = parent_from_child.to_cols_array().map(|value| (value * 1e6).round() as i64);
        if self.placed.insert((parent, part, key)) {
            let name = if is_name(&name) { name } else { String::new() };
            reader.model.parts[parent].children.push(Child { part, parent_from_child, name, color, entity });
        }
        Ok(())
    }

    /// Whether a representation's group describes product definition `product`.
    fn belongs(&mut self, representation: u64, product: u64) -> bool {
        self.described.contains(&(self.groups.find(representation), product))
    }

    /// Bodies that no representation of a product reached: a part of their own where nothing else was found, else a finding.
    fn map_unreached(&mut self, reader: &mut Reader, catalog: &Catalog, styles: &Styles) {
        let nothing_found = reader.model.faces.is_empty();
        if nothing_found && !reader.open_faces.is_empty() {
            self.map_loose_bodies(reader, catalog, styles);
        }
        let left = reader.open_faces.len();
        if left > 0 {
            let first = reader.open_faces.iter().copied().min().unwrap_or(0);
            let reason = format!("{left} faces belong to no body of a product, such as #{first}");
            let kind = reader.keyword(first).into_owned();
            reader.report(Severity::Dropped, Problem { entity: first, kind, reason });
            if let Some(diagnostic) = reader.model.diagnostics.last_mut() {
                diagnostic.faces = u32::try_from(left).unwrap_or(u32::MAX);
            }
            reader.open_faces.clear();
        }
    }

    fn map_loose_bodies(&mut self, reader: &mut Reader, catalog: &Catalog, styles: &Styles) {
        let context = self.order.iter().find_map(|r| self.representations[r].context);
        self.use_units(reader, context);
        reader.model.source.unit = reader.units.length_unit();
        let mut part = Part::default();
        // Solids before the shells that they are made of.
        let mut bodies = catalog.bodies.clone();
        bodies.sort_by_key(|&id| {
            let keyword = reader.keyword(id);
            BODY_KEYWORDS
                .iter()
                .position(|k| *k == keyword)
                .map_or(0, |rank| usize::from(rank > 2) + usize::from(rank > 4))
        });
        for id in bodies {
            match reader.body(id, styles, None) {
                Ok(body) => part.bodies.extend(body),
                Err(problem) => reader.report(Severity::Dropped, problem),
            }
        }
        if !part.bodies.is_empty() {
            let reason =
                format!("{} bodies stand outside of any product; imported as one part", part.bodies.len());
            reader.report(Severity::Note, Problem { entity: 0, kind: "PRODUCT".into(), reason });
            reader.model.parts.push(part);
        }
    }
}

struct Placement {
    parent: u64,
    child: u64,
    parent_from_child: DAffine3,
    name: String,
    color: Option<Color>,
    entity: u64,
}

/// Labels of Open CASCADE's document, such as `=>[0:1:1:2]`, are no names.
fn is_name(name: &str) -> bool {
    !name.is_empty() && !name.starts_with("=>[")
}

fn is_body(reader: &Reader, id: u64) -> bool {
    let keyword = reader.keyword(id);
    if keyword.is_empty() {
        return reader.entity(id).is_ok_and(|e| BODY_KEYWORDS.iter().any(|k| e.is(k)));
    }
    BODY_KEYWORDS.contains(&&*keyword)
}

fn report_other_shape(reader: &mut Reader, id: u64) {
    let kind = reader.keyword(id).into_owned();
    if kind == "GEOMETRIC_SET" {
        let reason = "surfaces and curves without topology are left out".into();
        reader.report(Severity::Note, Problem { entity: id, kind, reason });
    } else if OTHER_SHAPES.iter().any(|word| kind.contains(word)) {
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

/// MAPPED_ITEM(name, map, target) and REPRESENTATION_MAP(origin, representation): origin, representation, target.
fn mapped_representation(reader: &Reader, item: u64) -> Mapped<(u64, u64, u64)> {
    let entity = reader.entity(item)?;
    let map = reader.referred(item, entity.first(), 1)?;
    let target = reference(item, entity.first(), 2)?;
    Ok((reference(map.id, map.first(), 0)?, reference(map.id, map.first(), 1)?, target))
}

/// The two representations of a relationship.
fn related(entity: &Entity) -> Option<[u64; 2]> {
    let record = entity.record("REPRESENTATION_RELATIONSHIP").unwrap_or(entity.first());
    Some([record.reference(2)?, record.reference(3)?])
}

/// The transformation of a relationship that has one.
fn transformation(entity: &Entity) -> Option<u64> {
    let record = entity
        .records
        .iter()
        .find(|r| r.keyword.ends_with("REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION"))?;
    let last = record.parameters.last()?;
    last.reference().or_else(|| last.list()?.first()?.reference())
}

/// The parts that no other part places; and, of circles that nothing else reaches, one part each. Trees without any body are
/// left out.
fn find_roots(reader: &mut Reader) {
    let model = &mut reader.model;
    let mut parents: HashMap<Id<Part>, Vec<Id<Part>>> = HashMap::new();
    for id in model.parts.ids() {
        for child in &model.parts[id].children {
            parents.entry(child.part).or_default().push(id);
        }
    }
    let with_bodies = |id: &Id<Part>| !model.parts[*id].bodies.is_empty();
    let mut shaped = HashSet::new();
    let above = |id: Id<Part>| parents.get(&id).cloned().unwrap_or_default();
    reach(&mut shaped, model.parts.ids().filter(with_bodies).collect(), above);
    let mut reached = HashSet::new();
    for circles in [false, true] {
        for id in model.parts.ids().filter(|id| shaped.contains(id)) {
            let is_root = if circles { with_bodies(&id) } else { !parents.contains_key(&id) };
            if is_root && !reached.contains(&id) {
                model.roots.push(id);
                let below = |id: Id<Part>| model.parts[id].children.iter().map(|c| c.part).collect();
                reach(&mut reached, vec![id], below);
            }
        }
    }
}

/// Adds to `reached` all that `next` leads to from `waiting`, itself included.
fn reach(
    reached: &mut HashSet<Id<Part>>,
    mut waiting: Vec<Id<Part>>,
    next: impl Fn(Id<Part>) -> Vec<Id<Part>>,
) {
    while let Some(id) = waiting.pop() {
        if reached.insert(id) {
            waiting.extend(next(id));
        }
    }
}

//! What is placed where: mapped items, occurrences, and relationships with a transformation.

use super::map_assembly::{Assembly, Representation};
use super::map_style::Styles;
use super::reader::{Mapped, Problem, Reader, problem, reference};
use super::value::{Entity, Record};
use crate::brep::{Child, Color, Id, Part, Severity};
use glam::DAffine3;
use std::collections::{HashMap, HashSet};

impl Assembly {
    pub fn place_mapped_items(&mut self, reader: &mut Reader, styles: &Styles) {
        for at in 0..self.order.len() {
            let id = self.order[at];
            let Representation { items, context, .. } = self.representations[&id].clone();
            for item in items {
                if reader.keyword(item) == "MAPPED_ITEM"
                    && let Err(problem) = self.place_mapped_item(reader, id, context, item, styles)
                {
                    reader.report(Severity::Dropped, problem);
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
            occurrence: Occurrence {
                name: entity.first().text(0),
                color: styles.of(item).or(styles.of_occurrence(item)),
                is_hidden: reader.hidden_placements.contains(&item),
            },
            entity: item,
        };
        self.place(reader, placement)
    }

    /// CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(relationship, product definition shape of an occurrence).
    pub fn place_occurrence(&mut self, reader: &mut Reader, id: u64, styles: &Styles) -> Mapped<()> {
        let entity = reader.entity(id)?;
        let relationship = reader.referred(id, entity.first(), 0)?;
        let shape = reader.referred(id, entity.first(), 1)?;
        let occurrence = reader.referred(shape.id, shape.first(), 2)?;
        if occurrence.is("SPECIFIED_HIGHER_USAGE_OCCURRENCE") {
            // It names a component of a component, which the occurrences on the way to it place.
            return Ok(());
        }
        self.placed_usages.insert(occurrence.id);
        let usage = usage(&occurrence);
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
        let is_hidden = [id, relationship.id].iter().any(|id| reader.hidden_placements.contains(id));
        let color = styles.of_occurrence(id).or(styles.of_occurrence(relationship.id));
        let occurrence = Occurrence { name: usage_name(usage), color, is_hidden };
        self.place_by_relationship(reader, &relationship, [first, second], first_is_child, occurrence)
    }

    /// Occurrences that nothing places, of parts that have shape: they stand at their assembly's origin, as they were designed.
    pub fn place_usages(&mut self, reader: &mut Reader, usages: &[u64]) {
        let mut groups_of: HashMap<u64, u64> = HashMap::new();
        for &(group, product) in &self.described {
            groups_of.entry(product).and_modify(|known| *known = group.min(*known)).or_insert(group);
        }
        let children =
            |id: Id<Part>| reader.model.parts[id].children.iter().map(move |child| (id, child.part));
        let placed: HashSet<_> = reader.model.parts.ids().flat_map(children).collect();
        let (mut first, mut count) = (0, 0);
        for &id in usages.iter().filter(|&id| !self.placed_usages.contains(id)).collect::<Vec<_>>() {
            let Ok(entity) = reader.entity(id) else { continue };
            if entity.is("SPECIFIED_HIGHER_USAGE_OCCURRENCE") {
                continue;
            }
            let usage = usage(&entity);
            let group = |at| usage.reference(at).and_then(|product| groups_of.get(&product).copied());
            let (Some(parent), Some(child)) = (group(3), group(4)) else { continue };
            // A part without bodies and children has nothing to show; one that a mapped item places is there already.
            let Some(part) = self.known_part(child) else { continue };
            let is_placed = |parent: Id<Part>| placed.contains(&(parent, part));
            if self.hidden.contains(&part) || self.known_part(parent).is_some_and(is_placed) {
                continue;
            }
            let occurrence = Occurrence { name: usage_name(usage), color: None, is_hidden: false };
            let parent_from_child = DAffine3::IDENTITY;
            if self
                .place(reader, Placement { parent, child, parent_from_child, occurrence, entity: id })
                .is_ok()
            {
                first = if count == 0 { id } else { first };
                count += 1;
            }
        }
        if count > 0 {
            let reason =
                format!("{count} occurrences without a placement stand at the origin of their assembly");
            let kind = "NEXT_ASSEMBLY_USAGE_OCCURRENCE".into();
            reader.report(Severity::Warning, Problem { entity: first, kind, reason });
        }
    }

    /// Relationships with a transformation that no occurrence uses.
    pub fn place_related(&mut self, reader: &mut Reader) {
        for id in std::mem::take(&mut self.placing) {
            let placed = reader.entity(id).and_then(|entity| match related(&entity) {
                Some(pair) => {
                    let first_is_child = transformation(&entity).is_some();
                    let is_hidden = reader.hidden_placements.contains(&id);
                    let occurrence = Occurrence { is_hidden, ..Occurrence::default() };
                    self.place_by_relationship(reader, &entity, pair, first_is_child, occurrence)
                }
                None => Ok(()),
            });
            if let Err(problem) = placed {
                reader.report(Severity::Dropped, problem);
            }
        }
    }

    fn place_by_relationship(
        &mut self,
        reader: &mut Reader,
        relationship: &Entity,
        [first, second]: [u64; 2],
        first_is_child: bool,
        occurrence: Occurrence,
    ) -> Mapped<()> {
        let (child, parent) = if first_is_child { (first, second) } else { (second, first) };
        let parent_from_child = match transformation(relationship) {
            None => DAffine3::IDENTITY,
            Some(id) => self.relative_placement(reader, id, child, parent, first_is_child)?,
        };
        self.place(
            reader,
            Placement { parent, child, parent_from_child, occurrence, entity: relationship.id },
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
        let Placement { parent, child, parent_from_child, occurrence, entity } = placement;
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
        if occurrence.is_hidden {
            self.hidden.insert(part);
            return Ok(());
        }
        let Occurrence { name, color, .. } = occurrence;
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
}

struct Placement {
    parent: u64,
    child: u64,
    parent_from_child: DAffine3,
    occurrence: Occurrence,
    entity: u64,
}

/// What a file says of an occurrence beside its place.
#[derive(Debug, Default)]
struct Occurrence {
    name: String,
    color: Option<Color>,
    is_hidden: bool,
}

/// The record of an occurrence that names what is used where: id, name, description, assembly, component.
fn usage<'e>(entity: &'e Entity) -> &'e Record<'e> {
    entity.record("PRODUCT_DEFINITION_RELATIONSHIP").unwrap_or(entity.first())
}

fn usage_name(usage: &Record) -> String {
    [1, 0].map(|at| usage.text(at)).into_iter().find(|name| is_name(name)).unwrap_or_default()
}

/// Labels of Open CASCADE's document, such as `=>[0:1:1:2]`, are no names.
fn is_name(name: &str) -> bool {
    !name.is_empty() && !name.starts_with("=>[")
}

/// MAPPED_ITEM(name, map, target) and REPRESENTATION_MAP(origin, representation): origin, representation, target.
pub fn mapped_representation(reader: &Reader, item: u64) -> Mapped<(u64, u64, u64)> {
    let entity = reader.entity(item)?;
    let map = reader.referred(item, entity.first(), 1)?;
    let target = reference(item, entity.first(), 2)?;
    Ok((reference(map.id, map.first(), 0)?, reference(map.id, map.first(), 1)?, target))
}

/// The two representations of a relationship.
pub fn related(entity: &Entity) -> Option<[u64; 2]> {
    let record = entity.record("REPRESENTATION_RELATIONSHIP").unwrap_or(entity.first());
    Some([record.reference(2)?, record.reference(3)?])
}

/// The transformation of a relationship that has one.
pub fn transformation(entity: &Entity) -> Option<u64> {
    let record = entity
        .records
        .iter()
        .find(|r| r.keyword.ends_with("REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION"))?;
    let last = record.parameters.last()?;
    last.reference().or_else(|| last.list()?.first()?.reference())
}

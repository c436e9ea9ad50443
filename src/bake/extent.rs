//! How far a model reaches, without baking it.

use super::{BakeOptions, boxes_of_parts, narrow, trim};
use crate::brep::{Id, Model, Occurrence, Part};
use crate::numeric::Aabb;

/// The box around all faces of all occurrences, model space; empty where nothing can be baked. Takes the time of [`trim`].
pub fn extent(model: &Model, options: &BakeOptions) -> Aabb {
    let trimmed = trim(model, options, &|_, _| {});
    let part_boxes = boxes_of_parts(&trimmed.drafts, trimmed.parts.len());
    box_of_occurrences(&trimmed.occurrences, &trimmed.parts, &part_boxes)
}

/// The box around all occurrences that can be placed; `parts` are sorted, `part_boxes` theirs.
pub(super) fn box_of_occurrences(
    occurrences: &[Occurrence],
    parts: &[Id<Part>],
    part_boxes: &[Aabb],
) -> Aabb {
    let bounds_of = |occurrence: &Occurrence| {
        let slot = parts.binary_search(&occurrence.part).ok()?;
        let world = part_boxes[slot].transformed(occurrence.world_from_part);
        (!world.is_empty() && narrow::is_within_reach(&world)).then_some(world)
    };
    occurrences.iter().filter_map(bounds_of).fold(Aabb::EMPTY, Aabb::union)
}

//! How far a model reaches, without baking it, and copies of it side by side.

use super::{BakeOptions, boxes_of_parts, narrow, trim};
use crate::brep::{Id, Model, Occurrence, Part, ReplicateError, replicate};
use crate::numeric::Aabb;
use glam::DVec3;

/// A model `counts` times along x, y and z, as far apart as its faces reach. Takes the time of [`trim`].
///
/// # Errors
///
/// Those of [`replicate`].
pub fn replicate_side_by_side(
    model: Model,
    counts: [u32; 3],
    options: &BakeOptions,
) -> Result<Model, ReplicateError> {
    let bounds = extent(&model, options);
    let size = if bounds.is_empty() { DVec3::ZERO } else { bounds.max - bounds.min };
    replicate(model, counts, size)
}

/// The box around all faces of all occurrences, model space; empty where nothing can be baked.
fn extent(model: &Model, options: &BakeOptions) -> Aabb {
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

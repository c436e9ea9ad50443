//! The product tree, walked: every place where a part with bodies stands in the world.

use super::{Child, Color, Id, Model, Part};
use glam::DAffine3;

/// One placement of a part that has bodies of its own.
#[derive(Debug, Clone)]
pub struct Occurrence {
    /// What stands there.
    pub part: Id<Part>,
    /// Where.
    pub world_from_part: DAffine3,
    /// Names from the root to the occurrence, joined by `/`.
    pub path: String,
    /// The outermost colour given to an occurrence on the path.
    pub color: Option<Color>,
}

/// A product tree may not be deeper than this; deeper ones are cyclic or hostile.
const MAX_DEPTH: usize = 128;

/// A model may not place more parts than this.
pub(super) const MAX_OCCURRENCES: usize = 1_000_000;

/// Nor may the walk take more memory for paths than this, with [`STEP_COST`] for each step: shared subtrees without any body can
/// make it exponential, and so can long names.
const MAX_WALK: usize = 1 << 28;
const STEP_COST: usize = 64;

/// All occurrences of parts with bodies, in tree order.
///
/// Cyclic references are cut where a part would contain itself. Returns whether the limits cut anything as well.
pub fn occurrences(model: &Model) -> (Vec<Occurrence>, bool) {
    let mut walk = Walk { model, found: Vec::new(), ancestors: Vec::new(), left: MAX_WALK, cut: false };
    for &root in &model.roots {
        walk.visit(root, DAffine3::IDENTITY, &model.parts[root].name, None);
    }
    (walk.found, walk.cut)
}

struct Walk<'a> {
    model: &'a Model,
    found: Vec<Occurrence>,
    ancestors: Vec<Id<Part>>,
    /// Of [`MAX_WALK`].
    left: usize,
    cut: bool,
}

impl Walk<'_> {
    fn visit(&mut self, id: Id<Part>, world_from_part: DAffine3, path: &str, color: Option<Color>) {
        let cost = path.len() + STEP_COST;
        if self.ancestors.contains(&id)
            || self.ancestors.len() >= MAX_DEPTH
            || self.found.len() >= MAX_OCCURRENCES
            || self.left < cost
        {
            self.cut = true;
            return;
        }
        self.left -= cost;
        let part = &self.model.parts[id];
        if !part.bodies.is_empty() {
            self.found.push(Occurrence { part: id, world_from_part, path: path.to_owned(), color });
        }
        self.ancestors.push(id);
        for child in &part.children {
            let child_path = format!("{path}/{}", self.name_of(child));
            self.visit(
                child.part,
                world_from_part * child.parent_from_child,
                &child_path,
                color.or(child.color),
            );
        }
        self.ancestors.pop();
    }

    fn name_of<'m>(&'m self, child: &'m Child) -> &'m str {
        if child.name.is_empty() { &self.model.parts[child.part].name } else { &child.name }
    }
}

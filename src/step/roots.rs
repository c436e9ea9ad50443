//! Where the product tree begins.

use super::reader::Reader;
use crate::brep::{Id, Part};
use std::collections::{HashMap, HashSet};

/// The parts that no other part places; and, of circles that nothing else reaches, one part each. Trees without any body are
/// left out, and those that only `hidden` parts lead to: what is placed invisibly is nowhere.
pub fn find(reader: &mut Reader, hidden: &HashSet<Id<Part>>) {
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
    let below = |id: Id<Part>| model.parts[id].children.iter().map(|c| c.part).collect::<Vec<_>>();
    reach(&mut reached, hidden.iter().copied().collect(), below);
    let mut hidden_parts: Vec<_> = reached.iter().copied().collect();
    hidden_parts.sort();
    model.hidden_parts = hidden_parts;
    for circles in [false, true] {
        for id in model.parts.ids().filter(|id| shaped.contains(id)) {
            let is_root = if circles { with_bodies(&id) } else { !parents.contains_key(&id) };
            if is_root && !reached.contains(&id) {
                model.roots.push(id);
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

//! 8-wide compressed BVHs, built by obvhs: PLOC, parallel reinsertion, then the optimal 8-wide collapse of Ylitie, Karras and Laine (2017).
//!
//! One primitive per leaf slot: testing a trimmed surface costs far more than one more box. obvhs is deterministic whatever the thread count.
//! It asks for finite, non-empty boxes; `narrow::outward` makes no others.

use crate::scene::{BvhNode, MAX_TREE_DEPTH};
use glam::Vec3A;
use obvhs::aabb::Aabb as Bounds;
use obvhs::cwbvh::builder::build_cwbvh;
use obvhs::{Boundable, BvhBuildParams};
use std::time::Duration;

/// Lower and upper corner, finite.
pub(super) type NarrowBox = [[f32; 3]; 2];

/// Boxes reach no farther than this, millimetres: costs are areas times numbers of boxes in f32, and obvhs cannot go on once they overflow.
/// 1e28 times 2³¹ boxes stays below the greatest f32; a hundred million kilometres are enough for any model.
pub(super) const FARTHEST: f32 = 1e14;

/// A tree over boxes.
#[derive(Debug, Default)]
pub(super) struct Tree {
    /// Root first; children after their parents.
    pub nodes: Vec<BvhNode>,
    /// The order in which the nodes refer to the boxes.
    pub order: Vec<u32>,
}

struct Item(NarrowBox);

impl Boundable for Item {
    fn aabb(&self) -> Bounds {
        Bounds::new(Vec3A::from_array(self.0[0]), Vec3A::from_array(self.0[1]))
    }
}

/// The tree over `boxes`; empty without boxes.
///
/// Fails where the tree is deeper than the kernels' stacks, which takes boxes nested at many scales, or where boxes are too large.
pub(super) fn build(boxes: &[NarrowBox]) -> Result<Tree, &'static str> {
    if boxes.is_empty() {
        return Ok(Tree::default());
    }
    if boxes.iter().flatten().flatten().any(|x| x.abs() > FARTHEST) {
        return Err("its boxes are too large for a BVH");
    }
    let items: Vec<Item> = boxes.iter().map(|&corners| Item(corners)).collect();
    let presets = [BvhBuildParams::medium_build(), BvhBuildParams::fastest_build()];
    for preset in presets {
        let parameters = BvhBuildParams { pre_split: false, max_prims_per_leaf: 1, ..preset };
        let built = build_cwbvh(&items, parameters, &mut Duration::default());
        let nodes: Vec<BvhNode> = built.nodes.iter().map(|node| bytemuck::cast(*node)).collect();
        if depth(&nodes) <= MAX_TREE_DEPTH {
            return Ok(Tree { nodes, order: built.primitive_indices });
        }
    }
    Err("the boxes of its faces nest too deeply for a BVH")
}

/// Levels of the tree.
fn depth(nodes: &[BvhNode]) -> usize {
    let mut level = vec![1; nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        for child in 0..node.imask.count_ones() as usize {
            level[node.child_base as usize + child] = level[index] + 1;
        }
    }
    level.into_iter().max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn leaves_of(tree: &Tree) -> Vec<u32> {
        let mut found = Vec::new();
        for node in &tree.nodes {
            for meta in node.child_meta {
                if meta != 0 && meta & 0b1_1000 != 0b1_1000 {
                    assert_eq!(meta >> 5, 1, "one primitive a leaf");
                    found.push(tree.order[(node.primitive_base + u32::from(meta & 31)) as usize]);
                }
            }
        }
        found.sort_unstable();
        found
    }

    fn boxes(count: usize) -> Vec<NarrowBox> {
        let mut state = 12345u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        (0..count)
            .map(|_| {
                let low = [random() * 100.0, random() * 100.0, random() * 100.0];
                [low, low.map(|x| x + random() * random() * 10.0)]
            })
            .collect()
    }

    #[test]
    fn every_box_is_in_the_tree_once() {
        for count in [0, 1, 2, 3, 8, 9, 100, 5000] {
            let tree = build(&boxes(count)).expect("not deep");
            assert_eq!(leaves_of(&tree), (0..count as u32).collect::<Vec<_>>());
        }
        let same = vec![[[1.0; 3], [2.0; 3]]; 77];
        assert_eq!(leaves_of(&build(&same).expect("not deep")).len(), 77);
        let point = vec![[[1.0; 3], [1.0; 3]]; 9];
        assert_eq!(leaves_of(&build(&point).expect("not deep")).len(), 9);
    }

    #[test]
    fn boxes_hold_their_children() {
        let items = boxes(3000);
        let tree = build(&items).expect("not deep");
        for node in &tree.nodes {
            for slot in 0..8 {
                let meta = node.child_meta[slot];
                if meta == 0 || meta & 0b1_1000 == 0b1_1000 {
                    continue;
                }
                let item = items[tree.order[(node.primitive_base + u32::from(meta & 31)) as usize] as usize];
                let low = [node.child_min_x[slot], node.child_min_y[slot], node.child_min_z[slot]];
                let high = [node.child_max_x[slot], node.child_max_y[slot], node.child_max_z[slot]];
                for k in 0..3 {
                    let unit = f32::from_bits(u32::from(node.e[k]) << 23);
                    assert!(node.p[k] + f32::from(low[k]) * unit <= item[0][k] + 1e-4);
                    assert!(node.p[k] + f32::from(high[k]) * unit >= item[1][k] - 1e-4);
                }
            }
        }
    }

    #[test]
    fn boxes_too_large_are_refused() {
        let scaled = |by: f32| boxes(50_000).iter().map(|b| b.map(|p| p.map(|x| x * by))).collect::<Vec<_>>();
        assert!(build(&scaled(1e16)).is_err());
        assert!(build(&scaled(FARTHEST / 110.0)).is_ok());
    }

    #[test]
    fn boxes_at_many_scales_do_not_fail_silently() {
        let nested: Vec<NarrowBox> = (0..120).map(|i| [[0.0; 3], [2f32.powi(i - 60); 3]]).collect();
        match build(&nested) {
            Ok(tree) => assert_eq!(leaves_of(&tree).len(), 120),
            Err(reason) => assert!(!reason.is_empty()),
        }
    }
}

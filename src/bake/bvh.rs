//! 8-wide compressed BVHs: a binary tree from the top down, then obvhs's parallel reinsertion and its optimal 8-wide collapse of Ylitie, Karras and
//! Laine (2017).
//!
//! One primitive per leaf slot: testing a trimmed surface costs far more than one more box. obvhs is deterministic whatever the thread count.
//! It asks for non-empty boxes whose areas do not overflow; `narrow::outward` makes no others.

use super::binary_tree;
use crate::scene::{BvhNode, MAX_TREE_DEPTH};
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh;

/// Lower and upper corner, finite.
pub(super) type NarrowBox = [[f32; 3]; 2];

/// A tree over boxes.
#[derive(Debug, Default)]
pub(super) struct Tree {
    /// Root first; children after their parents.
    pub nodes: Vec<BvhNode>,
    /// The order in which the nodes refer to the boxes.
    pub order: Vec<u32>,
}

/// Share of the nodes that the first round of reinsertion moves; sixteen rounds of fewer and fewer follow.
const REINSERTED: f32 = 0.05;

/// The tree over `boxes`; empty without boxes.
///
/// Fails where the tree is deeper than the kernels' stacks, which a balanced one would have to be.
pub(super) fn build(boxes: &[NarrowBox]) -> Result<Tree, &'static str> {
    if boxes.is_empty() {
        return Ok(Tree::default());
    }
    for (balanced, reinserted) in [(false, REINSERTED), (false, 0.0), (true, 0.0)] {
        let mut binary = binary_tree::build(boxes, balanced);
        ReinsertionOptimizer::default().run(&mut binary, reinserted, None);
        let built = bvh2_to_cwbvh(&binary, 1, true, false);
        let nodes: Vec<BvhNode> = built.nodes.iter().map(|node| bytemuck::cast(*node)).collect();
        if depth(&nodes) <= MAX_TREE_DEPTH {
            return Ok(Tree { nodes, order: built.primitive_indices });
        }
    }
    Err("there are too many boxes in it for a BVH")
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
    use super::super::narrow::FARTHEST;
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
    fn the_largest_boxes_are_no_trouble() {
        let scaled = boxes(50_000)
            .iter()
            .map(|b| b.map(|p| p.map(|x| x * (FARTHEST as f32 / 110.0))))
            .collect::<Vec<_>>();
        assert_eq!(leaves_of(&build(&scaled).expect("not deep")).len(), 50_000);
    }

    #[test]
    fn rows_and_nests_and_copies_are_trees_too() {
        type Row = fn(usize) -> NarrowBox;
        let rows: [(&str, Row); 5] = [
            ("nested at many scales", |i| [[0.0; 3], [2f32.powi(i as i32 % 80 - 40); 3]]),
            ("concentric", |i| [[-1.0 - i as f32; 3], [1.0 + i as f32; 3]]),
            ("copies", |_| [[1.0; 3], [2.0; 3]]),
            ("in a row", |i| [[i as f32, 0.0, 0.0], [i as f32 + 1.0, 1.0, 1.0]]),
            ("from one point", |i| [[0.0; 3], [1.0 + i as f32, 1.0, 0.0]]),
        ];
        for (name, row) in rows {
            // Enough of them that a chain would be refused, or take minutes.
            let boxes: Vec<NarrowBox> = (0..40_000).map(row).collect();
            let tree = build(&boxes).unwrap_or_else(|reason| panic!("{name}: {reason}"));
            assert_eq!(leaves_of(&tree), (0..40_000).collect::<Vec<_>>(), "{name}");
        }
    }
}

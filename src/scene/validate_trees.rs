//! The BVHs of a scene: every node belongs to one tree, is reached once and comes after its parent.

use super::validate::{Check, require};
use super::{BvhNode, MAX_TREE_DEPTH, Scene};

/// A BVH's ranges.
struct Tree {
    first_node: usize,
    nodes: usize,
    first_primitive: usize,
    primitives: usize,
}

/// Checks the BVH over instances and those of the parts.
pub(super) fn bvh(scene: &Scene<'_>) -> Check {
    let header = scene.header;
    let top = Tree {
        first_node: 0,
        nodes: header.node_count as usize,
        first_primitive: 0,
        primitives: scene.instances.len(),
    };
    require(top.nodes > 0 || scene.instances.is_empty(), "header", 0, "instances without a BVH")?;
    tree(scene, &top, "header", 0)?;
    for (index, &word) in scene.primitives.iter().take(top.primitives).enumerate() {
        require((word as usize) < scene.instances.len(), "primitives", index, "no such instance")?;
    }
    // Trees that share nodes would make this take as long as parts times nodes.
    let mut nodes = top.nodes;
    for (index, part) in scene.parts.iter().enumerate() {
        let own = Tree {
            first_node: part.first_node as usize,
            nodes: part.node_count as usize,
            first_primitive: part.first_primitive as usize,
            primitives: part.primitive_count as usize,
        };
        let starts_after = own.first_node >= top.nodes && own.first_primitive >= top.primitives;
        require(starts_after, "parts", index, "its BVH overlaps that over instances")?;
        nodes += own.nodes;
        require(nodes <= scene.bvh_nodes.len(), "parts", index, "its BVH shares nodes with another")?;
        tree(scene, &own, "parts", index)?;
    }
    Ok(())
}

fn tree(scene: &Scene<'_>, tree: &Tree, array: &'static str, index: usize) -> Check {
    let range = |first: usize, count: usize, length: usize| first <= length && count <= length - first;
    require(range(tree.first_node, tree.nodes, scene.bvh_nodes.len()), array, index, "no such nodes")?;
    require(
        range(tree.first_primitive, tree.primitives, scene.primitives.len()),
        array,
        index,
        "no such primitives",
    )?;
    let nodes = &scene.bvh_nodes[tree.first_node..tree.first_node + tree.nodes];
    // Depth of each node; 0 until a parent reaches it.
    let mut depth = vec![0usize; nodes.len()];
    if let Some(root) = depth.first_mut() {
        *root = 1;
    }
    for (at, node) in nodes.iter().enumerate() {
        let check = |condition, reason| require(condition, "bvh_nodes", tree.first_node + at, reason);
        check((1..=MAX_TREE_DEPTH).contains(&depth[at]), "it is not reached once, or lies too deep")?;
        check(node.p.iter().all(|x| x.is_finite()) && !node.e.contains(&255), "its box is not finite")?;
        check(slots_are_consistent(node), "its slots and its mask disagree")?;
        let children = node.imask.count_ones() as usize;
        let first = node.child_base as usize;
        check(children == 0 || first > at && first + children <= nodes.len(), "no such children")?;
        for child in first..first + children {
            check(depth[child] == 0, "it shares a child")?;
            depth[child] = depth[at] + 1;
        }
        for meta in node.child_meta {
            if meta != 0 && !is_inner(meta) {
                let end = node.primitive_base as usize + (meta & 31) as usize + primitives_of(meta);
                check(end <= tree.primitives, "no such primitives")?;
            }
        }
    }
    Ok(())
}

fn is_inner(meta: u8) -> bool {
    meta & 0b1_1000 == 0b1_1000
}

/// Primitives of a leaf slot: a unary count in the high bits.
fn primitives_of(meta: u8) -> usize {
    (meta >> 5).count_ones() as usize
}

fn slots_are_consistent(node: &BvhNode) -> bool {
    (0..8).all(|slot| {
        let meta = node.child_meta[slot];
        if node.imask >> slot & 1 == 1 {
            meta == 0b10_0000 | (24 + slot as u8)
        } else {
            meta == 0 || !is_inner(meta) && matches!(meta >> 5, 0b001 | 0b011 | 0b111)
        }
    })
}

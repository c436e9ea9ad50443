//! The trees of a scene: every node belongs to one tree, is reached once and comes after its parent.

use super::trim_node::{self, TrimNode};
use super::validate::{Check, require};
use super::validate_study::structures;
use super::{BvhNode, MAX_TREE_DEPTH, Scene, TRIM_INSIDE, TrimMethod};

/// Levels of a trim tree at most.
const MAX_TRIM_DEPTH: u32 = 25;

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

/// Checks the trim trees of faces and leaves.
pub(super) fn trim_trees(scene: &Scene<'_>) -> Check {
    let method = TrimMethod::from_number(scene.header.trim_method);
    let mut visited = vec![false; scene.trim_nodes.len()];
    match method {
        None => require(false, "header", 0, "no such trim method")?,
        Some(TrimMethod::PACKED) => packed(scene, &mut visited)?,
        Some(method) => structures(scene, method)?,
    }
    for (index, leaf) in scene.net_leaves.iter().enumerate() {
        let face = &scene.faces[scene.nets[leaf.net as usize].face as usize];
        let valid = leaf.trim == TRIM_INSIDE || leaf.trim == face.trim_root;
        require(valid, "net_leaves", index, "its trim tree is not its face's")?;
    }
    Ok(())
}

/// Checks the trees of the default method.
fn packed(scene: &Scene<'_>, visited: &mut [bool]) -> Check {
    for (index, face) in scene.faces.iter().enumerate() {
        if face.trim_root != TRIM_INSIDE {
            require(trim_tree(scene, face.trim_root as usize, visited), "faces", index, "no such trim tree")?;
        }
    }
    Ok(())
}

/// Whether a whole tree, none of it seen before, hangs from `root`.
fn trim_tree(scene: &Scene<'_>, root: usize, visited: &mut [bool]) -> bool {
    let words = scene.trim_nodes;
    if root == 0 || root >= words.len() || std::mem::replace(&mut visited[root - 1], true) {
        return false;
    }
    let base = words[root - 1] as usize;
    let mut open = vec![(root, 1)];
    while let Some((at, depth)) = open.pop() {
        if at >= words.len() || depth > MAX_TRIM_DEPTH || std::mem::replace(&mut visited[at], true) {
            return false;
        }
        let mut extra = || {
            let seen = visited.get_mut(at + 1)?;
            (!std::mem::replace(seen, true)).then(|| words[at + 1] as usize)
        };
        match trim_node::unpack(words[at]) {
            TrimNode::Inner { right, .. } => {
                let is_far = right == trim_node::FAR;
                let Some(distance) = (if is_far { extra() } else { Some(right as usize) }) else {
                    return false;
                };
                let left = at + if is_far { 2 } else { 1 };
                let right = at + distance;
                if right <= left {
                    return false;
                }
                open.push((right, depth + 1));
                open.push((left, depth + 1));
            }
            TrimNode::Leaf { count, first, .. } => {
                let Some(count) = (if count == trim_node::MANY { extra() } else { Some(count as usize) })
                else {
                    return false;
                };
                if base + first as usize + count > scene.trim_segments.len() {
                    return false;
                }
            }
        }
    }
    true
}

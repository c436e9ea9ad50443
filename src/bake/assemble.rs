//! Puts the arrays of faces, parts and instances together.

use super::bvh::{self, NarrowBox, Tree};
use super::faces::{BakedFace, PartSpace};
use super::narrow;
use super::trim_tree::TrimTree;
use crate::brep::Occurrence;
use crate::numeric::Aabb;
use crate::scene::primitive::{Primitive, pack};
use crate::scene::{Instance, InstanceF64, NO_MATERIAL, Part, SceneBuffers, TRIM_INSIDE};
use glam::{DAffine3, DMat3, DVec3};
use rayon::prelude::*;

/// Boxes of primitives grow by this share of the part's size: more than what f32 records and kernels are off by.
const PADDING: f64 = 1.0 / (1 << 20) as f64;

/// Indices of all arrays stay below this, so that a primitive word can hold any of them.
const MAX_INDEX: usize = 1 << 31;

/// A part of the scene under construction.
#[derive(Debug)]
pub(super) struct PartDraft {
    /// Holds all faces, in part space, padded.
    pub bounds: Aabb,
    boxes: Vec<NarrowBox>,
    words: Vec<u32>,
}

impl PartDraft {
    /// A part whose faces lie in `bounds` (part space).
    pub(super) fn new(bounds: Aabb) -> Self {
        let padded = bounds.grown(bounds.diagonal() * PADDING);
        Self { bounds: padded, boxes: Vec::new(), words: Vec::new() }
    }
}

/// Appends a face to the scene and to its part.
pub(super) fn add_face(
    scene: &mut SceneBuffers,
    draft: &mut PartDraft,
    baked: BakedFace,
    part: u32,
    body: u32,
    material: u32,
    keep_f64: bool,
) -> Result<(), &'static str> {
    let padding = draft.bounds.diagonal() * PADDING;
    let boxes: Option<Vec<NarrowBox>> = baked.boxes.iter().map(|b| narrow::outward(*b, padding)).collect();
    let boxes = boxes.ok_or("its box is beyond single precision")?;
    let lengths = [
        scene.net_points.len() + baked.nets.points.len(),
        scene.net_leaves.len() + baked.nets.leaves.len(),
        scene.trim_nodes.len() + baked.trim.words.len(),
        scene.trim_segments.len() + baked.trim.segments.len(),
    ];
    if lengths.into_iter().any(|length| length >= MAX_INDEX) {
        return Err("the scene has more records than indices");
    }

    let face = scene.faces.len() as u32;
    let mut record = baked.face;
    record.part = part;
    record.body = body;
    record.material = material;
    if record.trim_root != TRIM_INSIDE {
        record.trim_root = add_trim(scene, &baked.trim);
    }
    scene.header.feature_mask |= 1 << record.kind;

    draft.bounds = baked.boxes.iter().fold(draft.bounds, |all, one| all.union(one.grown(padding)));
    draft.boxes.extend(boxes);
    if baked.nets.nets.is_empty() {
        draft.words.push(pack(Primitive::Face(face)));
    }
    let first_leaf = scene.net_leaves.len() as u32;
    let first_net = scene.nets.len() as u32;
    let first_point = scene.net_points.len() as u32;
    for (offset, leaf) in baked.nets.leaves.iter().enumerate() {
        let trim = if leaf.trim == TRIM_INSIDE { TRIM_INSIDE } else { record.trim_root };
        scene.net_leaves.push(crate::scene::NetLeaf { net: leaf.net + first_net, trim, ..*leaf });
        draft.words.push(pack(Primitive::NetLeaf(first_leaf + offset as u32)));
    }
    for net in &baked.nets.nets {
        scene.header.max_net_degree =
            scene.header.max_net_degree.max(net.degrees & 0xff).max(net.degrees >> 8 & 0xff);
        scene.nets.push(crate::scene::Net { first_point: net.first_point + first_point, face, ..*net });
    }
    scene.net_points.extend(baked.nets.points.iter().map(|p| narrow::homogeneous(*p)));
    if keep_f64 {
        scene.net_points_f64.extend(baked.nets.points.iter().map(|p| p.to_array()));
        scene.faces_f64.push(baked.face_f64);
    }
    scene.faces.push(record);
    scene.face_infos.push(baked.info);
    Ok(())
}

/// Appends a face's trims; returns the index of their root.
pub(super) fn add_trim(scene: &mut SceneBuffers, trim: &TrimTree) -> u32 {
    let root = scene.trim_nodes.len() as u32;
    scene.trim_nodes.extend_from_slice(&trim.words);
    scene.trim_nodes[root as usize + 1] = scene.trim_segments.len() as u32;
    scene.trim_segments.extend_from_slice(&trim.segments);
    scene.header.max_trim_degree = scene.header.max_trim_degree.max(trim.max_degree);
    root
}

/// Builds the trees of all parts, appends them, and returns each part's result.
pub(super) fn add_parts(scene: &mut SceneBuffers, drafts: &[PartDraft]) -> Vec<Result<(), &'static str>> {
    let trees: Vec<Result<Tree, &'static str>> =
        drafts.par_iter().map(|draft| bvh::build(&draft.boxes)).collect();
    let mut results = Vec::with_capacity(drafts.len());
    for (draft, tree) in drafts.iter().zip(trees) {
        let (tree, result) = match tree {
            Ok(tree) => (tree, Ok(())),
            Err(reason) => (Tree::default(), Err(reason)),
        };
        scene.parts.push(Part {
            first_node: scene.bvh_nodes.len() as u32,
            node_count: tree.nodes.len() as u32,
            first_primitive: scene.primitives.len() as u32,
            primitive_count: tree.order.len() as u32,
        });
        scene.bvh_nodes.extend(tree.nodes);
        scene.primitives.extend(tree.order.iter().map(|&item| draft.words[item as usize]));
        results.push(result);
    }
    results
}

/// The records of an occurrence and its world box; fails with the reason where it cannot be placed.
pub(super) fn place(
    occurrence: &Occurrence,
    part: u32,
    part_bounds: Aabb,
    space: &PartSpace,
    anchor: DVec3,
    material: Option<u32>,
) -> Result<(Instance, InstanceF64, NarrowBox), &'static str> {
    let linear: DMat3 = occurrence.world_from_part.matrix3;
    let inverse = linear.inverse();
    if linear.determinant() == 0.0 || !inverse.is_finite() {
        return Err("its placement has no inverse");
    }
    let origin = occurrence.world_from_part.transform_point3(space.center) - anchor;
    let at = narrow::grid_point(origin, space.grid_step).ok_or("its placement lies too far out")?;
    let rows = narrow::rows(&inverse);
    let world_from_part = DAffine3::from_mat3_translation(linear, origin);
    let world = part_bounds.transformed(world_from_part);
    let corners =
        narrow::outward(world, world.diagonal() * PADDING).ok_or("its box is beyond single precision")?;
    if !rows.iter().flatten().all(|x| x.is_finite()) {
        return Err("its placement is beyond single precision");
    }
    let farthest = part_bounds.corners().map(|c| c.length()).into_iter().fold(0.0, f64::max);
    let instance = Instance {
        part_from_world_0: rows[0],
        part,
        part_from_world_1: rows[1],
        material: material.unwrap_or(NO_MATERIAL),
        part_from_world_2: rows[2],
        is_translation: u32::from(linear == DMat3::IDENTITY),
        grid: at.grid,
        flags: 0,
        fraction: at.fraction,
        radius: narrow::above(farthest),
        material_shift: 0,
        reserved_1: 0,
        reserved_2: [0; 2],
    };
    let exact = InstanceF64 {
        part_from_world: [0, 1, 2].map(|i| inverse.row(i).to_array()),
        origin: origin.to_array(),
    };
    Ok((instance, exact, corners))
}

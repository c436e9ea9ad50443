//! Part of a scene that is baked already: instances and faces that are left out, without another bake.
//!
//! A face goes by emptying the leaf slots of its part's BVH that refer to it; instances go with their entries, and the BVH over instances is built
//! anew, as is the scene's box, so that what is left is framed and lit as if nothing else had been there. Nets, trims and faces stay where they are
//! and are shared with the whole scene.

use super::{bvh, narrow};
use crate::numeric::Aabb;
use crate::scene::primitive::{Primitive, unpack};
use crate::scene::{
    BvhNode, EdgePiece, Face, Finding, Header, Instance, InstanceF64, InstanceInfo, Metadata, Part, Scene,
    Severity,
};
use glam::{DAffine3, DMat3, DVec3};

/// Share of an instance's diagonal by which its box grows: instances are read back from f32.
const PADDING: f64 = 1.0 / (1 << 18) as f64;

/// The arrays of a scene that change.
#[derive(Debug)]
pub struct KeptScene {
    metadata: Metadata,
    header: Header,
    bvh_nodes: Vec<BvhNode>,
    primitives: Vec<u32>,
    instances: Vec<Instance>,
    instances_f64: Vec<InstanceF64>,
    parts: Vec<Part>,
    faces: Vec<Face>,
    edge_pieces: Vec<EdgePiece>,
}

impl KeptScene {
    /// The scene, with the arrays that have not changed from the one that it is part of.
    pub fn of<'a>(&'a self, whole: &Scene<'a>) -> Scene<'a> {
        Scene {
            metadata: &self.metadata,
            header: &self.header,
            bvh_nodes: &self.bvh_nodes,
            primitives: &self.primitives,
            instances: &self.instances,
            instances_f64: &self.instances_f64,
            parts: &self.parts,
            faces: &self.faces,
            edge_pieces: &self.edge_pieces,
            ..*whole
        }
    }
}

/// The part of a validated scene that has the instances and faces for which `instances` and `faces`, one for each, say true.
///
/// # Errors
///
/// The reason why the boxes of what is left cannot be put into a BVH.
pub fn keep(scene: &Scene<'_>, instances: &[bool], faces: &[bool]) -> Result<KeptScene, &'static str> {
    let mut bvh_nodes = scene.bvh_nodes.to_vec();
    let part_boxes: Vec<Aabb> =
        scene.parts.iter().map(|part| keep_faces(scene, part, &mut bvh_nodes, faces)).collect();
    let is_kept =
        |index: &usize| instances[*index] && !part_boxes[scene.instances[*index].part as usize].is_empty();
    let kept: Vec<usize> = (0..scene.instances.len()).filter(is_kept).collect();
    let step = scene.header.grid_step;
    let world_boxes: Vec<Aabb> = kept
        .iter()
        .map(|&index| {
            world_box(&scene.instances[index], part_boxes[scene.instances[index].part as usize], step)
        })
        .collect();
    let world = world_boxes.iter().copied().fold(Aabb::EMPTY, Aabb::union);
    let moved = if world.is_empty() { DVec3::ZERO } else { narrow::snap(world.center(), step) };
    let steps = (moved / step).as_ivec3();

    let mut kept_instances = Vec::with_capacity(kept.len());
    let mut boxes = Vec::with_capacity(kept.len());
    for (&index, world) in kept.iter().zip(&world_boxes) {
        let mut instance = scene.instances[index];
        for (at, by) in instance.grid.iter_mut().zip(steps.to_array()) {
            *at = at.checked_sub(by).ok_or("its placement lies too far out")?;
        }
        let own = Aabb { min: world.min - moved, max: world.max - moved };
        boxes.push(narrow::outward(own, 0.0).ok_or("its box is beyond single precision")?);
        kept_instances.push(instance);
    }
    let top = bvh::build(&boxes)?;
    let half =
        if world.is_empty() { DVec3::ZERO } else { (world.max - moved).abs().max((world.min - moved).abs()) };
    let header = Header {
        world_anchor: (DVec3::from_array(scene.header.world_anchor) + moved).to_array(),
        half_size: half.to_array().map(narrow::above),
        node_count: top.nodes.len() as u32,
        ..*scene.header
    };
    let (old_nodes, old_primitives) = (scene.header.node_count, scene.instances.len() as u32);
    let parts = scene.parts.iter().map(|part| Part {
        first_node: part.first_node - old_nodes + top.nodes.len() as u32,
        first_primitive: part.first_primitive - old_primitives + top.order.len() as u32,
        ..*part
    });
    let exact = kept.iter().filter_map(|&index| scene.instances_f64.get(index));
    let moved_exact = exact
        .map(|exact| InstanceF64 { origin: (DVec3::from_array(exact.origin) - moved).to_array(), ..*exact });
    bvh_nodes.splice(..old_nodes as usize, top.nodes.iter().copied());
    let metadata = metadata(scene, &kept, faces);
    let is_closed = |face: &Face| metadata.bodies.get(face.body as usize).is_some_and(|body| body.is_closed);
    let opened = |face: &Face| match is_closed(face) {
        true => *face,
        false => Face { flags: face.flags & !Face::CLOSED, ..*face },
    };
    Ok(KeptScene {
        faces: scene.faces.iter().map(opened).collect(),
        metadata,
        header,
        primitives: top.order.iter().chain(&scene.primitives[old_primitives as usize..]).copied().collect(),
        bvh_nodes,
        instances: kept_instances,
        instances_f64: moved_exact.collect(),
        parts: parts.collect(),
        edge_pieces: scene.edge_pieces.iter().copied().filter(|piece| bounds_kept(piece, faces)).collect(),
    })
}

/// Whether an edge is one of a face that stays, or of none at all.
fn bounds_kept(piece: &EdgePiece, faces: &[bool]) -> bool {
    let [first, second] = piece.faces.map(|face| faces.get(face as usize));
    (first, second) == (None, None) || first == Some(&true) || second == Some(&true)
}

/// Empties the leaf slots of faces that go; returns the box around those that stay, part space.
fn keep_faces(scene: &Scene<'_>, part: &Part, nodes: &mut [BvhNode], faces: &[bool]) -> Aabb {
    let first = part.first_node as usize;
    let mut bounds = Aabb::EMPTY;
    for node in &mut nodes[first..first + part.node_count as usize] {
        for slot in 0..8 {
            let meta = node.child_meta[slot];
            if meta == 0 || node.imask >> slot & 1 == 1 {
                continue;
            }
            let primitives = part.first_primitive + node.primitive_base + u32::from(meta & 31);
            let count = (meta >> 5).count_ones();
            let stays = (primitives..primitives + count)
                .any(|index| faces[face_of(scene, scene.primitives[index as usize])]);
            if stays {
                bounds = bounds.union(slot_box(node, slot));
            } else {
                node.child_meta[slot] = 0;
            }
        }
    }
    bounds
}

fn face_of(scene: &Scene<'_>, word: u32) -> usize {
    match unpack(word) {
        Primitive::Face(face) => face as usize,
        Primitive::NetLeaf(leaf) => scene.nets[scene.net_leaves[leaf as usize].net as usize].face as usize,
    }
}

fn slot_box(node: &BvhNode, slot: usize) -> Aabb {
    let corner = |planes: [u8; 3]| {
        let plane = |k: usize| {
            f64::from(node.p[k])
                + f64::from(planes[k]) * f64::from(f32::from_bits(u32::from(node.e[k]) << 23))
        };
        DVec3::new(plane(0), plane(1), plane(2))
    };
    Aabb {
        min: corner([node.child_min_x[slot], node.child_min_y[slot], node.child_min_z[slot]]),
        max: corner([node.child_max_x[slot], node.child_max_y[slot], node.child_max_z[slot]]),
    }
}

/// The box of an instance in world space.
fn world_box(instance: &Instance, part: Aabb, step: f64) -> Aabb {
    let rows = [instance.part_from_world_0, instance.part_from_world_1, instance.part_from_world_2];
    let [x, y, z] = rows.map(|row| DVec3::from_array(row.map(f64::from)));
    let world_from_part = DMat3::from_cols(x, y, z).transpose().inverse();
    let origin = DVec3::from_array(instance.grid.map(f64::from)) * step
        + DVec3::from_array(instance.fraction.map(f64::from));
    let world = part.transformed(DAffine3::from_mat3_translation(world_from_part, origin));
    world.grown(world.diagonal() * PADDING)
}

fn metadata(scene: &Scene<'_>, kept: &[usize], faces: &[bool]) -> Metadata {
    let mut metadata = scene.metadata.clone();
    metadata.instances =
        kept.iter().map(|&index| InstanceInfo { path: metadata.instances[index].path.clone() }).collect();
    for (face, _) in scene.faces.iter().zip(faces).filter(|(_, stays)| !**stays) {
        if let Some(body) = metadata.bodies.get_mut(face.body as usize) {
            body.is_closed = false;
        }
    }
    let mut is_placed = vec![false; scene.parts.len()];
    kept.iter().for_each(|&index| is_placed[scene.instances[index].part as usize] = true);
    let mut was_placed = vec![false; scene.parts.len()];
    scene.instances.iter().for_each(|instance| was_placed[instance.part as usize] = true);
    let goes = |(index, face): (usize, &crate::scene::Face)| {
        let part = face.part as usize;
        was_placed[part] && !(is_placed[part] && faces[index])
    };
    let hidden = scene.faces.iter().enumerate().filter(|&face| goes(face)).count() as u32;
    if hidden > 0 {
        metadata.findings.push(Finding {
            severity: Severity::Hidden,
            entity: 0,
            kind: String::new(),
            reason: "they are not wanted".to_owned(),
            faces: hidden,
        });
    }
    metadata
}

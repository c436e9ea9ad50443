//! Part of a scene that is baked already: instances and faces that are left out, without another bake.
//!
//! A face goes by emptying the leaf slots of its part's BVH that refer to it; instances go with their entries (`rearrange`), so that what is left is framed and lit
//! as if nothing else had been there. Nets, trims and faces stay where they are and are shared with the whole scene.

use super::rearrange::{Rearranged, Standing, rearrange, slot_box, world_box};
use crate::numeric::Aabb;
use crate::scene::primitive::{Primitive, unpack};
use crate::scene::{
    BodyInfo, BvhNode, EdgePiece, Face, Finding, InstanceInfo, Metadata, Part, Scene, Severity,
};
use glam::DVec3;

/// The arrays of a scene that change.
#[derive(Debug)]
pub struct KeptScene {
    metadata: Metadata,
    rearranged: Rearranged,
    faces: Vec<Face>,
    body_infos: Vec<BodyInfo>,
    edge_pieces: Vec<EdgePiece>,
}

impl KeptScene {
    /// The scene, with the arrays that have not changed from the one that it is part of.
    pub fn of<'a>(&'a self, whole: &Scene<'a>) -> Scene<'a> {
        Scene {
            metadata: &self.metadata,
            faces: &self.faces,
            body_infos: &self.body_infos,
            edge_pieces: &self.edge_pieces,
            ..self.rearranged.of(whole)
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
    let standing: Vec<Standing> = kept
        .iter()
        .map(|&index| {
            let instance = &scene.instances[index];
            let bounds = world_box(instance, part_boxes[instance.part as usize], scene.header.grid_step);
            Standing { index, bounds, shift: DVec3::ZERO }
        })
        .collect();
    let rearranged = rearrange(scene, bvh_nodes, &standing)?;
    let metadata = metadata(scene, &kept, faces);
    let body_infos = bodies(scene, faces);
    let opened = |face: &Face| match body_infos[face.body as usize].is_closed() {
        true => *face,
        false => Face { flags: face.flags & !Face::CLOSED, ..*face },
    };
    Ok(KeptScene {
        faces: scene.faces.iter().map(opened).collect(),
        body_infos,
        metadata,
        rearranged,
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

/// Those of the scene; bodies that have lost a face are open.
fn bodies(scene: &Scene<'_>, faces: &[bool]) -> Vec<BodyInfo> {
    let mut bodies = scene.body_infos.to_vec();
    for (face, _) in scene.faces.iter().zip(faces).filter(|(_, stays)| !**stays) {
        bodies[face.body as usize].is_closed = 0;
    }
    bodies
}

fn metadata(scene: &Scene<'_>, kept: &[usize], faces: &[bool]) -> Metadata {
    let mut metadata = scene.metadata.clone();
    metadata.instances =
        kept.iter().map(|&index| InstanceInfo { path: metadata.instances[index].path.clone() }).collect();
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

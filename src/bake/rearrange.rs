//! Instances of a baked scene that go or stand elsewhere, without another bake: the BVH over instances is built anew, as is the scene's box, so
//! that what is there is framed and lit as if it had always stood so. Parts and all that they are made of stay.

use super::{bvh, narrow};
use crate::numeric::Aabb;
use crate::scene::{BvhNode, Header, Instance, InstanceF64, Part, Scene};
use glam::{DAffine3, DMat3, DVec3};

/// Share of an instance's diagonal by which its box grows: instances are read back from f32.
const PADDING: f64 = 1.0 / (1 << 18) as f64;

/// The arrays of a scene that change.
#[derive(Debug)]
pub(super) struct Rearranged {
    header: Header,
    bvh_nodes: Vec<BvhNode>,
    primitives: Vec<u32>,
    instances: Vec<Instance>,
    instances_f64: Vec<InstanceF64>,
    parts: Vec<Part>,
}

impl Rearranged {
    /// The scene with them.
    pub(super) fn of<'a>(&'a self, whole: &Scene<'a>) -> Scene<'a> {
        Scene {
            header: &self.header,
            bvh_nodes: &self.bvh_nodes,
            primitives: &self.primitives,
            instances: &self.instances,
            instances_f64: &self.instances_f64,
            parts: &self.parts,
            ..*whole
        }
    }
}

/// An instance that stays.
#[derive(Debug, Clone, Copy)]
pub(super) struct Standing {
    /// Its index in the scene as it was.
    pub(super) index: usize,
    /// The box around it where it was.
    pub(super) bounds: Aabb,
    /// By how much it moves: multiples of the grid step.
    pub(super) shift: DVec3,
}

/// Rearranges a scene whose nodes are `bvh_nodes`, those of the instances still first.
///
/// # Errors
///
/// The reason why the instances cannot stand so.
pub(super) fn rearrange(
    scene: &Scene<'_>,
    mut bvh_nodes: Vec<BvhNode>,
    standing: &[Standing],
) -> Result<Rearranged, &'static str> {
    let step = scene.header.grid_step;
    let stands = |one: &Standing| Aabb { min: one.bounds.min + one.shift, max: one.bounds.max + one.shift };
    let world = standing.iter().map(stands).fold(Aabb::EMPTY, Aabb::union);
    let center = if world.is_empty() { DVec3::ZERO } else { narrow::snap(world.center(), step) };
    let mut instances = Vec::with_capacity(standing.len());
    let mut boxes = Vec::with_capacity(standing.len());
    for one in standing {
        let mut instance = scene.instances[one.index];
        let steps = ((one.shift - center) / step).as_ivec3();
        for (at, by) in instance.grid.iter_mut().zip(steps.to_array()) {
            let is_near = |at: &i32| f64::from(at.unsigned_abs()) <= narrow::MAX_STEPS;
            *at = at.checked_add(by).filter(is_near).ok_or("its placement lies too far out")?;
        }
        let bounds = stands(one);
        let own = Aabb { min: bounds.min - center, max: bounds.max - center };
        boxes.push(narrow::outward(own, 0.0).ok_or("its box is beyond single precision")?);
        instances.push(instance);
    }
    let top = bvh::build(&boxes)?;
    let half = if world.is_empty() {
        DVec3::ZERO
    } else {
        (world.max - center).abs().max((world.min - center).abs())
    };
    let header = Header {
        world_anchor: (DVec3::from_array(scene.header.world_anchor) + center).to_array(),
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
    let exact = standing.iter().filter_map(|one| {
        let exact = scene.instances_f64.get(one.index)?;
        let origin = DVec3::from_array(exact.origin) + (one.shift - center);
        Some(InstanceF64 { origin: origin.to_array(), ..*exact })
    });
    bvh_nodes.splice(..old_nodes as usize, top.nodes.iter().copied());
    Ok(Rearranged {
        header,
        primitives: top.order.iter().chain(&scene.primitives[old_primitives as usize..]).copied().collect(),
        bvh_nodes,
        instances,
        instances_f64: exact.collect(),
        parts: parts.collect(),
    })
}

/// The box of what is in a leaf's or a child's slot of a node, in the space of the node's tree.
pub(super) fn slot_box(node: &BvhNode, slot: usize) -> Aabb {
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

/// The box of an instance in world space, from that of its part in part space.
pub(super) fn world_box(instance: &Instance, part: Aabb, step: f64) -> Aabb {
    let rows = [instance.part_from_world_0, instance.part_from_world_1, instance.part_from_world_2];
    let [x, y, z] = rows.map(|row| DVec3::from_array(row.map(f64::from)));
    let world_from_part = DMat3::from_cols(x, y, z).transpose().inverse();
    let origin = DVec3::from_array(instance.grid.map(f64::from)) * step
        + DVec3::from_array(instance.fraction.map(f64::from));
    let world = part.transformed(DAffine3::from_mat3_translation(world_from_part, origin));
    world.grown(world.diagonal() * PADDING)
}

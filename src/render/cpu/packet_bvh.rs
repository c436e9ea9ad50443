//! A BVH walked by eight rays together.
//!
//! A node is read once for all of them, and a child entered if one ray meets its box. Children come in the order in which the first ray that meets them does;
//! rays that look the same way agree on it but for a few.

use super::bvh::{AxisRay, STACK_SIZE, axis_rays, axis_terms};
use super::lanes::Octet;
use super::vector::Vector3;
use crate::numeric::{Eight, Mask, Mask8, Number};
use crate::scene::{BvhNode, Scene};
use arrayvec::ArrayVec;

/// A walk in progress.
pub struct PacketWalk {
    rays: [AxisRay<Eight>; 3],
    first_node: u32,
    first_primitive: u32,
    /// The child that is visited, less those of its primitives that have been.
    visited: Child,
    /// Of the children of one node the nearest is the last.
    waiting: ArrayVec<Child, STACK_SIZE>,
}

/// A child whose box some ray meets.
#[derive(Clone, Copy)]
struct Child {
    /// Where on the rays its box begins.
    enter: Eight,
    /// Where on the rays it ends.
    leave: Eight,
    /// The rays that meet it.
    rays: Mask8,
    /// Of the tree: the node, or the first primitive.
    index: u32,
    /// Primitives; 0 is a node.
    count: u32,
}

/// A primitive whose box some ray meets.
pub struct PacketMet {
    /// See [`crate::scene::primitive`].
    pub word: u32,
    /// The rays that meet the box, or met it before they came to their ends.
    pub rays: Mask8,
    /// Where on the rays the box begins and ends, counted from their origins.
    pub span: [Eight; 2],
}

impl PacketWalk {
    /// Over a tree of `node_count` nodes, by those of eight rays that are `asked`, which meet it from `begin` on.
    #[inline(always)]
    pub fn new(
        [first_node, node_count, first_primitive]: [u32; 3],
        origin: Vector3<Eight>,
        direction: Vector3<Eight>,
        asked: Mask8,
        begin: Eight,
    ) -> Self {
        let root = Child { enter: begin, leave: Eight::INFINITY, rays: asked, index: 0, count: 0 };
        let mut waiting = ArrayVec::new();
        if node_count > 0 {
            waiting.push(root);
        }
        Self { rays: axis_rays(origin, direction), first_node, first_primitive, visited: root, waiting }
    }

    /// The next primitive whose box some rays meet between `near` and `far` (both counted from the rays' origins).
    pub fn next(&mut self, scene: &Scene<'_>, near: Eight, far: Eight) -> Option<PacketMet> {
        loop {
            let Child { enter, leave, rays, index, count } = &mut self.visited;
            if *count > 0 {
                let word = scene.primitives[(self.first_primitive + *index) as usize];
                (*index, *count) = (*index + 1, *count - 1);
                return Some(PacketMet { word, rays: *rays, span: [*enter, *leave] });
            }
            let mut child = self.waiting.pop()?;
            child.rays = child.rays & child.enter.is_at_most(far);
            if !child.rays.any() {
                continue;
            }
            if child.count > 0 {
                self.visited = child;
                continue;
            }
            let node = &scene.bvh_nodes[(self.first_node + child.index) as usize];
            // As in `bvh`: no child begins before its parent, and where it ends does not depend on `far`.
            let span = [Number::max(near, child.enter), child.leave];
            intersect_node(node, &self.rays, span, far, child.rays, &mut self.waiting);
        }
    }
}

/// Adds the children met, the nearest last.
#[inline(always)]
fn intersect_node(
    node: &BvhNode,
    rays: &[AxisRay<Eight>; 3],
    [begin, end]: [Eight; 2],
    far: Eight,
    asked: Mask8,
    waiting: &mut ArrayVec<Child, STACK_SIZE>,
) {
    let planes = |bytes: &[u8; 8]| <Eight as Octet<f32>>::of_bytes(bytes).to_array();
    let low = [&node.child_min_x, &node.child_min_y, &node.child_min_z].map(planes);
    let high = [&node.child_max_x, &node.child_max_y, &node.child_max_z].map(planes);
    let terms: [[Eight; 3]; 3] =
        std::array::from_fn(|axis| axis_terms(node.p[axis], node.e[axis], &rays[axis]));
    let mut met: ArrayVec<(f32, Child), 8> = ArrayVec::new();
    let mut rank = 0;
    for slot in 0..8 {
        let (index, count) = if node.imask >> slot & 1 == 1 {
            rank += 1;
            (node.child_base + rank - 1, 0)
        } else {
            let meta = u32::from(node.child_meta[slot]);
            if meta == 0 {
                continue;
            }
            (node.primitive_base + (meta & 31), (meta >> 5).count_ones())
        };
        let (mut enter, mut leave) = (begin, end);
        for axis in 0..3 {
            let [to_near, to_far, scale] = terms[axis];
            let (a, b) = (Eight::splat(low[axis][slot]) * scale, Eight::splat(high[axis][slot]) * scale);
            enter = (Number::min(a, b) + to_near).greater(enter);
            leave = (Number::max(a, b) + to_far).lesser(leave);
        }
        let rays = asked & enter.is_at_most(leave.lesser(far));
        if rays.any() {
            let first = enter.to_array()[rays.bits().trailing_zeros() as usize & 7];
            met.push((first, Child { enter, leave, rays, index, count }));
        }
    }
    let mut order: ArrayVec<u8, 8> = (0..met.len() as u8).collect();
    for k in 1..order.len() {
        let mut place = k;
        while place > 0 && met[order[place - 1] as usize].0 < met[order[place] as usize].0 {
            order.swap(place - 1, place);
            place -= 1;
        }
    }
    waiting.extend(order.into_iter().map(|k| met[k as usize].1));
}

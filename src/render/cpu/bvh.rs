//! Walks the 8-wide compressed BVH (Ylitie, Karras and Laine 2017), children in the order in which the ray comes to their boxes.
//!
//! The node test is conservative: the slabs are widened by the rounding error of their own computation, so flat boxes, rays in a box's
//! plane and rays along an axis lose nothing. What waits is as many children as [`STACK_SIZE`] at most: `scene::validate` bounds the depth.
//!
//! A GPU's threads have no room for the distances of what waits, and visit children in the order of the ray's octant instead (`bvh.wgsl`); here a hit
//! spares all that is entered behind it, faces of the same node too.

use super::Kernel;
use super::lanes::Octet;
use super::tally::{Step, Tally};
use super::vector::{Vector3, number};
use crate::numeric::{Number, Real};
use crate::scene::{BvhNode, MAX_TREE_DEPTH, Scene};
use arrayvec::ArrayVec;

/// Children that wait at most: of each level of a validated tree all but the one that is visited, and all of the last.
pub const STACK_SIZE: usize = 7 * MAX_TREE_DEPTH + 1;

/// A ray as the node test wants it.
#[derive(Debug, Clone, Copy)]
pub struct BvhRay<T> {
    /// Along x, y and z.
    axes: [AxisRay<T>; 3],
    /// A bit per axis (x: 4, y: 2, z: 1), set where the ray does not run backwards.
    octant: u32,
}

/// A ray along one axis.
#[derive(Debug, Clone, Copy)]
pub struct AxisRay<T> {
    origin: T,
    /// 1 / direction, ±1e18 where the direction is 0.
    inverse: T,
    /// How far a plane's position on the ray may be off, by millimetre of the terms that it is computed from; see [`axis_terms`] …
    rounding: T,
    /// … and what the origin has of it.
    origin_rounding: T,
}

/// A walk in progress.
#[derive(Debug, Clone)]
pub struct Walk<T> {
    /// First node of the tree.
    first_node: u32,
    /// First primitive word of the tree.
    first_primitive: u32,
    /// The child that is visited, less those of its primitives that have been.
    visited: Child<T>,
    /// Of the children of one node the nearest is the last.
    waiting: ArrayVec<Child<T>, STACK_SIZE>,
}

/// A child whose box the ray meets.
#[derive(Debug, Clone, Copy)]
struct Child<T> {
    /// Where on the ray its box begins and ends.
    span: [T; 2],
    /// Of the tree: the node, or the first primitive.
    index: u32,
    /// Primitives; 0 is a node.
    count: u32,
}

/// A primitive whose box the ray meets.
#[derive(Debug, Clone, Copy)]
pub struct Met<T> {
    /// See [`crate::scene::primitive`].
    pub word: u32,
    /// Where on the ray the box begins and ends, counted from the ray's origin: it holds the primitive, but for what its slack may add.
    pub span: [T; 2],
}

/// Prepares a ray.
#[inline]
pub fn bvh_ray<T: Real>(origin: Vector3<T>, direction: Vector3<T>) -> BvhRay<T> {
    let bit = |component: T, bit: u32| if component < T::ZERO { 0 } else { bit };
    BvhRay {
        axes: axis_rays(origin, direction),
        octant: bit(direction.x, 4) | bit(direction.y, 2) | bit(direction.z, 1),
    }
}

/// A ray along the three axes.
#[inline(always)]
pub fn axis_rays<T: Number>(origin: Vector3<T>, direction: Vector3<T>) -> [AxisRay<T>; 3] {
    let axis = |origin: T, direction: T| {
        let inverse = inverse(direction);
        let rounding = inverse.abs() * (number::<T>(8.0) * T::EPSILON);
        AxisRay { origin, inverse, rounding, origin_rounding: origin.abs() * rounding }
    };
    [axis(origin.x, direction.x), axis(origin.y, direction.y), axis(origin.z, direction.z)]
}

/// 1 / x; ±1e18 near 0, so that products with millimetres stay finite in f32. The sign agrees with the octant, for −0 too.
#[inline(always)]
fn inverse<T: Number>(x: T) -> T {
    let is_large = number::<T>(1e-18).is_at_most(x.abs());
    let most = T::choose(x.is_less(T::ZERO), number(-1e18), number(1e18));
    T::choose(is_large, T::ONE / x, most)
}

/// Starts a walk over a tree of `node_count` nodes that the ray meets from `begin` on.
#[inline]
pub fn start_walk<T: Real>(first_node: u32, node_count: u32, first_primitive: u32, begin: T) -> Walk<T> {
    let root = Child { span: [begin, T::INFINITY], index: 0, count: 0 };
    let mut waiting = ArrayVec::new();
    if node_count > 0 {
        waiting.push(root);
    }
    Walk { first_node, first_primitive, visited: root, waiting }
}

/// The next primitive whose box the ray meets between `near` and `far` (both counted from the ray's origin).
pub fn next_primitive<T: Kernel>(
    walk: &mut Walk<T>,
    scene: &Scene<'_>,
    ray: &BvhRay<T>,
    near: T,
    far: T,
    tally: &mut impl Tally,
) -> Option<Met<T>> {
    loop {
        let Child { span, index, count } = &mut walk.visited;
        if *count > 0 {
            let word = scene.primitives[(walk.first_primitive + *index) as usize];
            (*index, *count) = (*index + 1, *count - 1);
            return Some(Met { word, span: *span });
        }
        let child = walk.waiting.pop()?;
        if child.span[0] > far {
            continue;
        }
        if child.count > 0 {
            walk.visited = child;
            continue;
        }
        tally.count(Step::Node);
        let node = &scene.bvh_nodes[(walk.first_node + child.index) as usize];
        // No child begins before its parent, whatever its bytes are rounded to. Where it ends does not depend on `far`: what is looked for in it shall not either.
        let span = [near.max(child.span[0]), child.span[1]];
        intersect_node(node, ray, span, far, &mut walk.waiting);
    }
}

/// Adds the children met, the nearest last.
#[inline(always)]
fn intersect_node<T: Kernel>(
    node: &BvhNode,
    ray: &BvhRay<T>,
    [begin, end]: [T; 2],
    far: T,
    waiting: &mut ArrayVec<Child<T>, STACK_SIZE>,
) {
    let (mut met, spans) = children_met(node, ray, begin, end);
    met &= spans[0].at_most(T::Octet::all(far));
    let spans = spans.map(Octet::halves);
    let first = waiting.len();
    while met != 0 {
        let slot = met.trailing_zeros();
        met &= met - 1;
        let span = spans.map(|halves| halves[slot as usize >> 2][slot as usize & 3]);
        let child = if node.imask >> slot & 1 == 1 {
            let rank = (u32::from(node.imask) & !(u32::MAX << slot)).count_ones();
            Child { span, index: node.child_base + rank, count: 0 }
        } else {
            let meta = u32::from(node.child_meta[slot as usize]);
            if meta == 0 {
                continue;
            }
            Child { span, index: node.primitive_base + (meta & 31), count: (meta >> 5).count_ones() }
        };
        waiting.push(child);
        let mut place = waiting.len() - 1;
        while place > first && waiting[place - 1].span[0] < span[0] {
            waiting.swap(place - 1, place);
            place -= 1;
        }
    }
}

/// A bit for each of the children whose box the ray meets between `near` and `far`, and where it enters and leaves them, all eight at once. Products are
/// numbers in nodes of up to 10²⁰ mm.
#[inline(always)]
fn children_met<T: Kernel>(node: &BvhNode, ray: &BvhRay<T>, near: T, far: T) -> (u32, [T::Octet; 2]) {
    let [x, y, z] = &ray.axes;
    let x = axis_terms(node.p[0], node.e[0], x);
    let y = axis_terms(node.p[1], node.e[1], y);
    let z = axis_terms(node.p[2], node.e[2], z);
    let mut span = [T::Octet::all(near), T::Octet::all(far)];
    narrow::<T>(&mut span, order(ray.octant & 4 != 0, &node.child_min_x, &node.child_max_x), x);
    narrow::<T>(&mut span, order(ray.octant & 2 != 0, &node.child_min_y, &node.child_max_y), y);
    narrow::<T>(&mut span, order(ray.octant & 1 != 0, &node.child_min_z, &node.child_max_z), z);
    (span[0].at_most(span[1]), span)
}

/// Cuts the spans of eight children along one axis.
#[inline(always)]
fn narrow<T: Kernel>(
    [enter, leave]: &mut [T::Octet; 2],
    (low, high): (&[u8; 8], &[u8; 8]),
    [to_near, to_far, scale]: [T; 3],
) {
    let at = |planes, from| T::Octet::of_bytes(planes) * T::Octet::all(scale) + T::Octet::all(from);
    *enter = at(low, to_near).greater(*enter);
    *leave = at(high, to_far).lesser(*leave);
}

/// Along one axis: where on the ray plane 0 lies, early and late, and how far apart planes lie.
///
/// A plane's position takes five roundings of terms no greater than `|origin| + |p − origin| + 255 · spacing`: early and late differ from
/// the rounded value by 8 ε of that sum.
#[inline(always)]
pub fn axis_terms<T: Number>(p: f32, exponent: u8, ray: &AxisRay<T>) -> [T; 3] {
    let spacing = T::from_f32(f32::from_bits(u32::from(exponent) << 23));
    let start = T::from_f32(p) - ray.origin;
    let slack = (start.abs() + spacing * number(255.0)) * ray.rounding + ray.origin_rounding;
    let at = start * ray.inverse;
    [at - slack, at + slack, spacing * ray.inverse]
}

#[inline(always)]
fn order<'a>(forward: bool, min: &'a [u8; 8], max: &'a [u8; 8]) -> (&'a [u8; 8], &'a [u8; 8]) {
    if forward { (min, max) } else { (max, min) }
}

#[cfg(test)]
mod tests {
    use super::super::vector::vec3;
    use super::*;
    use crate::scene::SceneBuffers;

    /// What [`children_met`] says, child by child.
    fn children_met_in_turn<T: Real>(node: &BvhNode, ray: &BvhRay<T>, near: T, far: T) -> u32 {
        let planes = [
            order(ray.octant & 4 != 0, &node.child_min_x, &node.child_max_x),
            order(ray.octant & 2 != 0, &node.child_min_y, &node.child_max_y),
            order(ray.octant & 1 != 0, &node.child_min_z, &node.child_max_z),
        ];
        let is_met = |child: usize| {
            let (mut enter, mut leave) = (near, far);
            for axis in 0..3 {
                let [to_near, to_far, scale] = axis_terms(node.p[axis], node.e[axis], &ray.axes[axis]);
                let at = |plane: u8, from: T| T::from_f32(f32::from(plane)) * scale + from;
                let (low, high) = planes[axis];
                (enter, leave) = (enter.max(at(low[child], to_near)), leave.min(at(high[child], to_far)));
            }
            enter <= leave
        };
        (0..8).filter(|&child| is_met(child)).fold(0, |met, child| met | 1 << child)
    }

    /// Nodes and rays from a generator, rays along axes and from within boxes among them.
    fn eight_at_once_are_those_in_turn<T: Kernel>() {
        let mut state = 1_u32;
        let mut next = move || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            state >> 8
        };
        let mut met = [0; 9];
        for _ in 0..20_000 {
            let mut boxes = || -> ([u8; 8], [u8; 8]) {
                let low: [u8; 8] = std::array::from_fn(|_| (next() % 100) as u8);
                (low, std::array::from_fn(|i| low[i] + (next() % 156) as u8))
            };
            let [x, y, z] = [boxes(), boxes(), boxes()];
            let node = BvhNode {
                p: [-1.0, -2.0, 0.5],
                e: [120, 121, 119],
                imask: 0,
                child_base: 0,
                primitive_base: 0,
                child_meta: [0; 8],
                child_min_x: x.0,
                child_max_x: x.1,
                child_min_y: y.0,
                child_max_y: y.1,
                child_min_z: z.0,
                child_max_z: z.1,
            };
            let mut number = || number::<T>(f64::from(next() % 4001) / 1000.0 - 2.0);
            let (a, b) = (vec3(number(), number(), number()), vec3(number(), number(), number()));
            let mut direction = a - b;
            if next() % 4 == 0 {
                direction.y = -T::ZERO;
            }
            let ray = bvh_ray(b, direction);
            let near = if next() % 2 == 0 { T::ZERO } else { -T::ONE };
            let far = if next() % 2 == 0 { T::ONE } else { T::INFINITY };
            let (found, _) = children_met(&node, &ray, near, far);
            assert_eq!(found, children_met_in_turn(&node, &ray, near, far), "{node:?} {ray:?}");
            met[found.count_ones() as usize] += 1;
        }
        assert!(met[0] > 100 && met[1] > 100 && met[2] > 100, "{met:?}");
    }

    /// A node of eight faces behind each other, in the slots by `place`, and no others.
    fn row(place: impl Fn(usize) -> u8) -> BvhNode {
        let low: [u8; 8] = std::array::from_fn(|slot| 20 * place(slot));
        let high = low.map(|x| x + 10);
        BvhNode {
            p: [0.0; 3],
            e: [127; 3],
            imask: 0,
            child_base: 0,
            primitive_base: 0,
            child_meta: std::array::from_fn(|slot| 1 << 5 | slot as u8),
            child_min_x: low,
            child_max_x: high,
            child_min_y: [0; 8],
            child_max_y: [10; 8],
            child_min_z: [0; 8],
            child_max_z: [10; 8],
        }
    }

    #[test]
    fn primitives_come_by_distance_and_not_beyond_the_far_end() {
        let place = |slot: usize| (slot * 5 % 8) as u8;
        let buffers = SceneBuffers {
            bvh_nodes: vec![row(place)],
            primitives: (0..8).map(|slot| u32::from(place(slot))).collect(),
            ..SceneBuffers::default()
        };
        let scene = buffers.scene();
        for (direction, order) in [(1.0, [0, 1, 2, 3, 4, 5, 6, 7]), (-1.0, [7, 6, 5, 4, 3, 2, 1, 0])] {
            let origin = vec3(80.0 - 200.0 * direction, 5.0, 5.0);
            let ray = bvh_ray::<f32>(origin, vec3(direction, 0.0, 0.0));
            let mut walk = start_walk(0, 1, 0, f32::NEG_INFINITY);
            let mut far = f32::INFINITY;
            for expected in &order[..5] {
                let met = next_primitive(&mut walk, &scene, &ray, 0.0, far, &mut ()).expect("a face");
                assert_eq!(met.word, *expected);
                let begin = 200.0
                    + if direction > 0.0 {
                        20.0 * *expected as f32 - 80.0
                    } else {
                        70.0 - 20.0 * *expected as f32
                    };
                assert!(
                    (met.span[0] - begin).abs() < 1e-3 && (met.span[1] - begin - 10.0).abs() < 1e-3,
                    "{met:?}"
                );
                far = begin + 95.0 - 20.0 * met.word.abs_diff(order[0]) as f32;
            }
            assert!(next_primitive(&mut walk, &scene, &ray, 0.0, far, &mut ()).is_none());
        }
    }

    #[test]
    fn spans_end_with_boxes_wherever_hits_end_to_matter() {
        let buffers = SceneBuffers {
            bvh_nodes: vec![row(|slot| slot as u8)],
            primitives: (0..8).collect(),
            ..SceneBuffers::default()
        };
        let ray = bvh_ray::<f32>(vec3(-20.0, 5.0, 5.0), vec3(1.0, 0.0, 0.0));
        let mut walk = start_walk(0, 1, 0, f32::NEG_INFINITY);
        let met = next_primitive(&mut walk, &buffers.scene(), &ray, 0.0, 22.0, &mut ()).expect("a face");
        assert!((met.span[1] - 30.0).abs() < 1e-3, "{met:?}");
        assert!(next_primitive(&mut walk, &buffers.scene(), &ray, 0.0, 22.0, &mut ()).is_none());
    }

    /// Two inner nodes, three primitives in one slot, one in another, and four slots with nothing in them.
    #[test]
    fn walks_find_all_that_is_in_slots_and_nothing_in_empty_ones() {
        let everywhere = |imask: u8, child_meta: [u8; 8], primitive_base: u32| BvhNode {
            imask,
            child_base: 1,
            primitive_base,
            child_meta,
            child_min_x: [0; 8],
            child_max_x: [255; 8],
            ..row(|_| 0)
        };
        let inner = |slot: u8| 1 << 5 | (24 + slot);
        let of = |count: u8, first: u8| ((1 << count) - 1) << 5 | first;
        let root = [of(3, 0), 0, inner(2), 0, 0, inner(5), 0, of(1, 3)];
        let first = [0, 0, 0, 0, 0, 0, of(2, 0), 0];
        let second = [of(1, 0), 0, 0, 0, 0, 0, 0, 0];
        let buffers = SceneBuffers {
            bvh_nodes: vec![
                everywhere(0b10_0100, root, 0),
                everywhere(0, first, 4),
                everywhere(0, second, 6),
            ],
            primitives: (10..17).collect(),
            ..SceneBuffers::default()
        };
        let scene = buffers.scene();
        let ray = bvh_ray::<f64>(vec3(-10.0, 5.0, 5.0), vec3(1.0, 0.0, 0.0));
        let mut walk = start_walk(0, 3, 0, f64::NEG_INFINITY);
        let next = || next_primitive(&mut walk, &scene, &ray, 0.0, f64::INFINITY, &mut ());
        let mut found: Vec<u32> = std::iter::from_fn(next).map(|met| met.word).collect();
        found.sort_unstable();
        assert_eq!(found, [10, 11, 12, 13, 14, 15, 16]);
    }

    #[test]
    fn children_met_at_once_are_those_met_in_turn() {
        eight_at_once_are_those_in_turn::<f32>();
        eight_at_once_are_those_in_turn::<f64>();
    }
}

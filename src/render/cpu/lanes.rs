//! Several numbers at a time, in the processor's vectors.
//!
//! The compiler finds vectors in plain loops now and then, and loses them with the next change; `wide` says which there are, and is as many of them as the
//! processor has that the program is built for. Every lane rounds as a number of its own does.

use super::bvh::BvhRay;
use crate::numeric::Real;
use crate::scene::BvhNode;
use std::ops::{AddAssign, Mul, Sub};
use wide::{f32x8, f64x8, i16x8, i32x8, u8x16};

/// Eight numbers.
pub trait Octet<T>: Copy + AddAssign + Sub<Output = Self> + Mul<Output = Self> {
    /// Four, then another four.
    fn of(first: [T; 4], last: [T; 4]) -> Self;
    /// The same eight times.
    fn all(number: T) -> Self;
    /// The first four and the last.
    fn halves(self) -> [[T; 4]; 2];
}

macro_rules! impl_octet {
    ($octet:ident, $t:ident) => {
        impl Octet<$t> for $octet {
            #[inline(always)]
            fn of([a, b, c, d]: [$t; 4], [e, f, g, h]: [$t; 4]) -> Self {
                Self::new([a, b, c, d, e, f, g, h])
            }
            #[inline(always)]
            fn all(number: $t) -> Self {
                Self::splat(number)
            }
            #[inline(always)]
            fn halves(self) -> [[$t; 4]; 2] {
                let [a, b, c, d, e, f, g, h] = self.to_array();
                [[a, b, c, d], [e, f, g, h]]
            }
        }
    };
}

impl_octet!(f32x8, f32);
impl_octet!(f64x8, f64);

/// Along one axis of a node: where on the ray plane 0 lies, early and late, and how far apart planes lie.
pub type AxisTerms<T> = [T; 3];

/// The lower and upper planes of a node's children along x, y and z, those that the ray meets first before the others.
#[inline(always)]
fn planes<'a, T>(node: &'a BvhNode, ray: &BvhRay<T>) -> [[&'a [u8; 8]; 2]; 3] {
    let order = |bit: u32, low, high| if ray.octant & bit != 0 { [low, high] } else { [high, low] };
    [
        order(4, &node.child_min_x, &node.child_max_x),
        order(2, &node.child_min_y, &node.child_max_y),
        order(1, &node.child_min_z, &node.child_max_z),
    ]
}

/// A bit for each of a node's children whose box a ray meets between `near` and `far`: the eight in two or one vectors. Where a product is not a number
/// it cuts nothing.
#[inline(always)]
pub fn children_met(
    node: &BvhNode,
    ray: &BvhRay<f32>,
    terms: [AxisTerms<f32>; 3],
    near: f32,
    far: f32,
) -> u32 {
    let (mut enter, mut leave) = (f32x8::splat(near), f32x8::splat(far));
    for ([first, last], [to_near, to_far, scale]) in planes(node, ray).into_iter().zip(terms) {
        // The first operand is given up where one of them is not a number.
        enter = (numbers(first) * f32x8::splat(scale) + f32x8::splat(to_near)).fast_max(enter);
        leave = (numbers(last) * f32x8::splat(scale) + f32x8::splat(to_far)).fast_min(leave);
    }
    enter.simd_le(leave).to_bitmask()
}

/// Eight bytes as numbers.
#[inline(always)]
fn numbers(bytes: &[u8; 8]) -> f32x8 {
    let low = u8x16::from(u128::from(u64::from_le_bytes(*bytes)).to_le_bytes());
    f32x8::from_i32x8(i32x8::from_i16x8(i16x8::from_u8x16_low(low)))
}

/// [`children_met`] one after the other, for numbers of any type.
pub fn children_met_in_turn<T: Real>(
    node: &BvhNode,
    ray: &BvhRay<T>,
    terms: [AxisTerms<T>; 3],
    near: T,
    far: T,
) -> u32 {
    let planes = planes(node, ray);
    let is_met = |child: usize| {
        let (mut enter, mut leave) = (near, far);
        for ([first, last], [to_near, to_far, scale]) in planes.into_iter().zip(terms) {
            let at = |plane: u8, from: T| T::from_f32(f32::from(plane)) * scale + from;
            let (first, last) = (at(first[child], to_near), at(last[child], to_far));
            enter = if first > enter { first } else { enter };
            leave = if last < leave { last } else { leave };
        }
        enter <= leave
    };
    (0..8).filter(|&child| is_met(child)).fold(0, |met, child| met | 1 << child)
}

#[cfg(test)]
mod tests {
    use super::super::bvh::{axes_terms, bvh_ray};
    use super::super::vector::Vector3;
    use super::*;

    /// Nodes and rays from a generator, those along axes, with infinite slopes and from within boxes among them.
    #[test]
    fn lanes_find_what_is_found_in_turn() {
        let mut state = 1_u32;
        let mut next = move || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            state >> 8
        };
        let mut met = [0; 9];
        for _ in 0..20_000 {
            let mut bytes = || std::array::from_fn(|_| (next() & 0xff) as u8);
            let [a, b, c, d, e, f]: [[u8; 8]; 6] = std::array::from_fn(|_| bytes());
            let lesser = |x: [u8; 8], y: [u8; 8]| std::array::from_fn(|i| x[i].min(y[i]));
            let greater = |x: [u8; 8], y: [u8; 8]| std::array::from_fn(|i| x[i].max(y[i]));
            let node = BvhNode {
                p: [-1.0, -2.0, 0.5],
                e: [120, 119, 121],
                imask: 0,
                child_base: 0,
                primitive_base: 0,
                child_meta: [0; 8],
                child_min_x: lesser(a, b),
                child_max_x: greater(a, b),
                child_min_y: lesser(c, d),
                child_max_y: greater(c, d),
                child_min_z: lesser(e, f),
                child_max_z: greater(e, f),
            };
            let mut number = || (next() % 4001) as f32 / 1000.0 - 2.0;
            let mut vector = || Vector3::from_f32(std::array::from_fn(|_| number()));
            let (origin, mut direction) = (vector(), vector());
            if next() % 4 == 0 {
                direction.y = -0.0;
            }
            let ray = bvh_ray(origin, direction);
            let far = if next() % 2 == 0 { 1.0 } else { f32::INFINITY };
            let terms = axes_terms(&node, &ray);
            let found = children_met(&node, &ray, terms, 0.0, far);
            assert_eq!(found, children_met_in_turn(&node, &ray, terms, 0.0, far), "{node:?} {ray:?}");
            met[found.count_ones() as usize] += 1;
        }
        assert!(met[1] > 100 && met[2] > 100 && met[4] > 10, "{met:?}");
    }
}

//! A ray at a leaf of a net: what the searches for roots start from, and what they find.

use super::footprint::Footprint;
use super::planes::RayPlanes;
use super::ray_space::PrimitiveRay;
use super::vector::Vector3;
use crate::numeric::{Number, Real};
use crate::scene::{Net, NetLeaf, bend_bound, point_side};

/// A point where the ray meets the net.
#[derive(Debug, Clone, Copy, Default)]
pub struct NetRoot<T: Number> {
    /// Local parameters of the net.
    pub uv: [T; 2],
    /// Distance from the ray's origin, in units of the direction.
    pub t: T,
    /// In local parameters.
    pub footprint: Footprint<T>,
}

/// A leaf's sub-domain in local parameters.
#[derive(Debug, Clone, Copy)]
pub struct Domain<T> {
    /// Least u and v.
    pub low: [T; 2],
    /// Extents.
    pub size: [T; 2],
}

/// A ray at a leaf.
#[derive(Debug, Clone, Copy)]
pub struct LeafRay<'a, T> {
    /// The leaf.
    pub leaf: &'a NetLeaf,
    /// Its net.
    pub net: &'a Net,
    /// The leaf's own.
    pub domain: Domain<T>,
    /// In face space.
    pub ray: PrimitiveRay<T>,
    /// The ray's.
    pub planes: RayPlanes<T>,
    /// The face's.
    pub slack: T,
    /// The leaf's.
    pub pole: Pole,
    /// See [`crate::render::NetSearch::newton_stop`].
    pub newton_stop: T,
}

/// Unpacks a leaf's domain.
#[inline(always)]
pub fn leaf_domain<T: Number>(leaf: &NetLeaf) -> Domain<T> {
    let axis = |bits: u32| {
        let size = 1.0 / (1_u32 << (bits >> 12 & 15)) as f32;
        (T::from_f32((bits & 0xfff) as f32 * size), T::from_f32(size))
    };
    let (u, u_size) = axis(leaf.domain);
    let (v, v_size) = axis(leaf.domain >> 16);
    Domain { low: [u, v], size: [u_size, v_size] }
}

/// The side of a leaf that is one point.
#[derive(Debug, Clone, Copy)]
pub struct Pole {
    /// The parameter that leads away from it; 0 where there is no pole.
    pub axis: usize,
    /// Whether there is one.
    pub exists: bool,
    /// Whether it is at the parameter's greatest value.
    pub is_high: bool,
}

/// The pole of a net that a leaf reaches; the first where there are more.
pub fn leaf_pole<T: Real>(net: &Net, domain: &Domain<T>) -> Pole {
    for axis in 0..2 {
        let is_at_end = [domain.low[axis] == T::ZERO, domain.low[axis] + domain.size[axis] == T::ONE];
        for (end, is_high) in [(0, false), (1, true)] {
            if is_at_end[end] && net.degrees & point_side(axis, end) != 0 {
                return Pole { axis, exists: true, is_high };
            }
        }
    }
    Pole { axis: 0, exists: false, is_high: false }
}

/// The leaf's bound of `|S_ss| + 2 |S_st| + |S_tt|` in millimetres.
#[inline(always)]
pub fn leaf_bend<T: Number>(leaf: &NetLeaf) -> T {
    let length = |tangent: [f32; 3]| Vector3::<T>::from_f32(tangent).length();
    T::from_f32(bend_bound(leaf.certificate >> 24)) * length(leaf.tangent_u).min(length(leaf.tangent_v))
}

/// Whether that bound is one.
#[inline(always)]
pub fn has_bend_bound(leaf: &NetLeaf) -> bool {
    leaf.certificate >> 24 != 255
}

//! Rays against the skew slab around a leaf of a net.
//!
//! With the dual rows D = [a b n]⁻¹ of the leaf's mean tangents a, b and n = a × b, the leaf lies in three slabs; cutting the ray with them
//! rejects most rays, and gives the range of t in which the roots lie.
//!
//! Projected along the ray onto the leaf's plane, the surface is `(α − (d₀/d₂) γ, β − (d₁/d₂) γ)` with (d₀, d₁, d₂) = D d. With the leaf's bounds
//! on how far α, β, γ deviate from linear, `(1 − E_α) |d₂| > E_γ |d₀|` and `(1 − E_β) |d₂| > E_γ |d₁|` make it a contraction away from the
//! identity: at most one root lies in the leaf and Newton's method, started at the ray's crossing of the leaf's plane, finds it.

use super::ray_space::PrimitiveRay;
use super::vector::{Vector3, number, vec3};
use crate::numeric::{Mask, Number};
use crate::scene::NetLeaf;

/// |a × b|² over |a|² |b|² below which the tangents span no plane. The bake gives no such frames: those that it makes have a sine of 1/64, or are
/// at right angles. It is for files that it did not write.
const FLAT: f64 = 1e-6;

/// What the contraction is to have left: some thousand roundings of f32, for the products that it is computed from.
const CERTIFICATE_ROUNDING: f64 = 1.0 / 1024.0;

/// Below this a direction's component is 0, so that its reciprocal stays finite in f32 also times distances of up to 10¹⁸ mm.
const PARALLEL: f64 = 1e-18;

/// For the roundings of a sphere's radius, a sum of products and roots.
const SPHERE_ROUNDING: f64 = 1.001;

/// What the slab test finds.
#[derive(Debug, Clone, Copy)]
pub struct SlabHit<T: Number> {
    /// Leaf coordinates (−½ to ½) of the ray at t = 0, and their change along it.
    pub at: Vector3<T>,
    pub along: Vector3<T>,
    /// Where the ray is inside, whatever part of it is asked for: so a root is the same to the last bit, whatever was found before.
    pub enter: T,
    pub leave: T,
    /// Whether at most one root is there.
    pub unique: T::Mask,
    /// Whether the leaf has no plane (a pole): `at` and `along` say nothing.
    pub flat: bool,
}

/// Cuts the ray with the leaf's skew slab; whether it is inside somewhere between `near` and `far`.
#[inline(always)]
pub fn intersect_slab<T: Number>(
    leaf: &NetLeaf,
    ray: &PrimitiveRay<T>,
    near: T,
    far: T,
) -> (T::Mask, SlabHit<T>) {
    let a = Vector3::<T>::from_f32(leaf.tangent_u);
    let b = Vector3::<T>::from_f32(leaf.tangent_v);
    let center = Vector3::<T>::from_f32(leaf.center);
    let extent_n = T::from_f32(leaf.extent_n);
    let n = a.cross(b);
    let (aa, bb, nn) = (a.dot(a), b.dot(b), n.dot(n));
    let r = ray.origin - center;
    let spans_plane = (number::<T>(FLAT) * aa * bb).is_less(nn) & T::ZERO.is_less(aa) & T::ZERO.is_less(bb);
    if !spans_plane.any() {
        return flat_slab(leaf, aa.sqrt(), bb.sqrt(), extent_n, r, ray.direction, near, far);
    }
    let scale = T::ONE / nn;
    let length = nn.sqrt();
    let (row_u, row_v, row_n) = (b.cross(n) * scale, n.cross(a) * scale, n * (T::ONE / length));
    let at = vec3(row_u.dot(r), row_v.dot(r), row_n.dot(r));
    let along = vec3(row_u.dot(ray.direction), row_v.dot(ray.direction), row_n.dot(ray.direction));
    // Positions carry roundings of the size of the coordinates they were computed from.
    let rounding = (center.greatest() + ray.origin.greatest() + r.greatest()) * number::<T>(8.0) * T::EPSILON;
    let half = number::<T>(0.5);
    let reach_u = half + T::from_f32(leaf.extent_u) + rounding * row_u.greatest();
    let reach_v = half + T::from_f32(leaf.extent_v) + rounding * row_v.greatest();
    let (mut enter, mut leave) = (-T::INFINITY, T::INFINITY);
    cut(at.x, along.x, reach_u, &mut enter, &mut leave);
    cut(at.y, along.y, reach_v, &mut enter, &mut leave);
    cut(at.z, along.z, extent_n + rounding, &mut enter, &mut leave);
    let [e_alpha, e_beta, e_gamma] = certificate::<T>(leaf);
    // γ and E_γ in millimetres: bytes are in units of the shorter tangent.
    let gamma = e_gamma * aa.min(bb).sqrt();
    let across = along.z.abs() * number(1.0 - CERTIFICATE_ROUNDING);
    let unique = (gamma * along.x.abs()).is_less((T::ONE - e_alpha) * across)
        & (gamma * along.y.abs()).is_less((T::ONE - e_beta) * across);
    let meets = enter.max(near).is_at_most(leave.min(far));
    (meets, SlabHit { at, along, enter, leave, unique, flat: false })
}

/// A sphere instead of a slab, for leaves whose tangents span no plane.
#[inline(never)]
fn flat_slab<T: Number>(
    leaf: &NetLeaf,
    a: T,
    b: T,
    extent_n: T,
    r: Vector3<T>,
    direction: Vector3<T>,
    near: T,
    far: T,
) -> (T::Mask, SlabHit<T>) {
    let half = number::<T>(0.5);
    let radius = a * (half + T::from_f32(leaf.extent_u)) + b * (half + T::from_f32(leaf.extent_v)) + extent_n;
    let dd = direction.dot(direction);
    let middle = -r.dot(direction) / dd;
    let closest = r + direction * middle;
    let reach = radius * number(SPHERE_ROUNDING) + r.greatest() * number::<T>(8.0) * T::EPSILON;
    let under_root = reach * reach - closest.dot(closest);
    let chord = (under_root / dd).sqrt();
    let (enter, leave) = (middle - chord, middle + chord);
    let meets = T::ZERO.is_at_most(under_root) & enter.max(near).is_at_most(leave.min(far));
    let (zero, unique) = (Vector3::default(), T::Mask::everywhere(false));
    (meets, SlabHit { at: zero, along: zero, enter, leave, unique, flat: true })
}

/// Narrows `[enter, leave]` to where `|at + t · along| <= reach`.
#[inline(always)]
fn cut<T: Number>(at: T, along: T, reach: T, enter: &mut T, leave: &mut T) {
    let is_parallel = along.abs().is_less(number(PARALLEL));
    let inverse = T::ONE / along;
    let (first, second) = ((-reach - at) * inverse, (reach - at) * inverse);
    let beside = T::choose(reach.is_less(at.abs()), -T::INFINITY, *leave);
    *enter = T::choose(is_parallel, *enter, first.min(second).max(*enter));
    *leave = T::choose(is_parallel, beside, first.max(second).min(*leave));
}

/// E_α, E_β, E_γ; infinite where there is no bound.
#[inline(always)]
fn certificate<T: Number>(leaf: &NetLeaf) -> [T; 3] {
    let bound = |shift: u32| {
        let byte = leaf.certificate >> shift & 0xff;
        if byte == 255 { T::INFINITY } else { T::from_f32(byte as f32 / 64.0) }
    };
    [bound(0), bound(8), bound(16)]
}

//! Rays against a leaf of a rational Bézier net: Newton's method on the two planes of the ray, put to the homogeneous numerators, which are
//! polynomials also where the net is rational.
//!
//! Where the leaf's slab says that there is one root at most, one search finds it. Elsewhere the leaf's bound on second derivatives drives a quadtree
//! over its domain; leaves without any bound get several starts. Where less exactness is asked for, all pairs without the certificate
//! get one start or two.

use super::Kernel;
use super::bernstein::{NetJet, net_jet};
use super::footprint::{Footprint, footprint, sides};
use super::isolate::{Cell, MAX_ISOLATION_CELLS, Verdict, examine};
use super::planes::{RayPlanes, plane_values, ray_planes};
use super::ray_space::PrimitiveRay;
use super::slab::{SlabHit, intersect_slab};
use super::vector::{Vector3, number, vec3};
use crate::numeric::Real;
use crate::render::Exactness;
use crate::scene::{Net, NetLeaf, Scene, bend_bound};
use std::ops::Range;

/// Roots kept per leaf.
pub const MAX_ROOTS: usize = 6;

/// Accepted excess of (u, v) over [0, 1]: twice the worst that f32 was seen to need so that no ray slips between two nets.
const OVERLAP: f64 = 1.0 / 1_048_576.0;

/// A point where the ray meets the net.
#[derive(Debug, Clone, Copy, Default)]
pub struct NetRoot<T> {
    /// Local parameters of the net.
    pub uv: [T; 2],
    /// Distance from the ray's origin, in units of the direction.
    pub t: T,
    /// In local parameters.
    pub footprint: Footprint<T>,
}

/// The roots found in a leaf, in no order.
#[derive(Debug, Clone, Copy)]
pub struct NetRoots<T> {
    /// How many.
    pub count: usize,
    /// The roots.
    pub root: [NetRoot<T>; MAX_ROOTS],
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
}

/// Unpacks a leaf's domain.
#[inline]
pub fn leaf_domain<T: Real>(leaf: &NetLeaf) -> Domain<T> {
    let axis = |bits: u32| {
        let size = 1.0 / (1_u32 << (bits >> 12 & 15)) as f32;
        (T::from_f32((bits & 0xfff) as f32 * size), T::from_f32(size))
    };
    let (u, u_size) = axis(leaf.domain);
    let (v, v_size) = axis(leaf.domain >> 16);
    Domain { low: [u, v], size: [u_size, v_size] }
}

/// The roots of the ray in a leaf (and, at times, just beside it).
pub fn leaf_roots<T: Kernel>(
    scene: &Scene<'_>,
    leaf: &NetLeaf,
    net: &Net,
    ray: &PrimitiveRay<T>,
    near: T,
    far: T,
    exactness: Exactness,
    slack: T,
) -> NetRoots<T> {
    let mut roots = NetRoots { count: 0, root: [NetRoot::default(); MAX_ROOTS] };
    let Some(hit) = intersect_slab(leaf, ray, near, far) else {
        return roots;
    };
    let at = LeafRay { leaf, net, domain: leaf_domain(leaf), ray: *ray, planes: ray_planes(ray), slack };
    let has_bound = leaf.certificate >> 24 != 255;
    if exactness == Exactness::Exact && !hit.unique && has_bound {
        isolate(scene, &at, &mut roots);
        return roots;
    }
    for k in fixed_starts(&hit, exactness) {
        search(scene, &at, fixed_start(&hit, k, &at.domain), hit.unique, &mut roots);
    }
    roots
}

/// Searches the leaf cell by cell.
fn isolate<T: Kernel>(scene: &Scene<'_>, at: &LeafRay<'_, T>, roots: &mut NetRoots<T>) {
    let mut cell = Cell::default();
    for _ in 0..MAX_ISOLATION_CELLS {
        let jet = net_jet(scene, at.net, at.ray.origin, cell.cell_center(at));
        match examine(&jet, at, cell) {
            Verdict::Split => {
                cell = cell.first_quarter();
                continue;
            }
            Verdict::Search { start, unique } => search(scene, at, start, unique, roots),
            Verdict::Empty => {}
        }
        match cell.next_cell() {
            Some(next) => cell = next,
            None => return,
        }
    }
}

/// The starts that a leaf gets where it is not searched cell by cell, as numbers for [`fixed_start`]. A flat leaf has no plane to start on.
#[inline]
fn fixed_starts<T: Real>(hit: &SlabHit<T>, exactness: Exactness) -> Range<u32> {
    match (exactness, hit.flat) {
        _ if hit.unique => 0..1,
        (Exactness::Fast, false) => 0..1,
        (Exactness::Fast, true) => 4..5,
        (Exactness::Balanced, false) => 1..3,
        (Exactness::Balanced, true) => 5..7,
        (Exactness::Exact, false) => 1..9,
        (Exactness::Exact, true) => 4..9,
    }
}

/// Start `k`: where the ray crosses the leaf's plane, enters, leaves, and is half way between; then the leaf's middle and near its corners.
#[inline]
fn fixed_start<T: Real>(hit: &SlabHit<T>, k: u32, domain: &Domain<T>) -> [T; 2] {
    let place = match k {
        0 => return slab_start(hit, (-hit.at.z / hit.along.z).max(hit.enter).min(hit.leave), domain),
        1 => return slab_start(hit, hit.enter, domain),
        2 => return slab_start(hit, hit.leave, domain),
        3 => return slab_start(hit, (hit.enter + hit.leave) * number(0.5), domain),
        4 => [0.5, 0.5],
        5 => [0.1, 0.1],
        6 => [0.9, 0.9],
        7 => [0.9, 0.1],
        _ => [0.1, 0.9],
    };
    [0, 1].map(|axis| domain.low[axis] + domain.size[axis] * number(place[axis]))
}

/// The leaf point at which the ray stands at `t`, projected onto the leaf's plane and clamped to the leaf.
#[inline]
fn slab_start<T: Real>(hit: &SlabHit<T>, t: T, domain: &Domain<T>) -> [T; 2] {
    let half = number::<T>(0.5);
    let clamp = |x: T| x.max(-half).min(half) + half;
    let (s, r) = (clamp(hit.at.x + hit.along.x * t), clamp(hit.at.y + hit.along.y * t));
    [domain.low[0] + domain.size[0] * s, domain.low[1] + domain.size[1] * r]
}

/// One Newton search; adds the root it ends at, if it is one of the leaf's and new.
fn search<T: Kernel>(
    scene: &Scene<'_>,
    at: &LeafRay<'_, T>,
    start: [T; 2],
    unique: bool,
    roots: &mut NetRoots<T>,
) {
    let LeafRay { leaf, net, domain, ray, planes, slack } = at;
    let mut uv = start;
    // Quadratic convergence: a step this small leaves its square. Near tangents steps halve, so they have to be smaller and may be as many as there
    // are bits, half of which a double root has.
    let small = if unique { T::EPSILON.sqrt() } else { T::EPSILON.sqrt() * number(1.0 / 64.0) };
    let limit = if unique { 10 } else { T::TANGENT_STEPS };
    let mut converged = false;
    for _ in 0..limit {
        let jet = net_jet(scene, net, ray.origin, uv);
        let [f, f_u, f_v] = [jet.value, jet.by_u, jet.by_v].map(|p| plane_values(planes, p));
        let determinant = f_u[0] * f_v[1] - f_u[1] * f_v[0];
        let du = (f[0] * f_v[1] - f[1] * f_v[0]) / determinant;
        let dv = (f_u[0] * f[1] - f_u[1] * f[0]) / determinant;
        if !(du.is_finite() && dv.is_finite()) {
            return;
        }
        // A step across more than the leaf is a leap of faith; it is cut to one leaf.
        let (step_u, step_v) = (du / domain.size[0], dv / domain.size[1]);
        let longest = step_u.abs().max(step_v.abs());
        let shorten = if longest > T::ONE { T::ONE / longest } else { T::ONE };
        uv = [uv[0] - du * shorten, uv[1] - dv * shorten];
        if !(is_within(uv, domain, T::ONE)) {
            return;
        }
        if longest <= small {
            converged = true;
            break;
        }
    }
    if !is_within(uv, domain, number(0.5)) {
        return;
    }
    let jet = net_jet(scene, net, ray.origin, uv);
    let (from_origin, tangents) = point_and_tangents(&jet);
    let [s_u, s_v] = tangents.map(|tangent| tangent * (T::ONE / jet.value[3]));
    let mut footprint =
        footprint(ray.direction, sides(ray.direction), s_u, s_v, leaf_curvature(leaf), *slack);
    footprint.is_grazing |= !converged;
    let margin = if unique { number(1.0 / 64.0) } else { number::<T>(0.5) };
    let extent = footprint.extent();
    let is_own = |k: usize| {
        let on_net = extent[k].max(number(OVERLAP));
        let on_leaf = extent[k].max(margin * domain.size[k]);
        let beyond = uv[k] - domain.low[k];
        uv[k] >= -on_net
            && uv[k] <= T::ONE + on_net
            && beyond >= -on_leaf
            && beyond - domain.size[k] <= on_leaf
    };
    if !(is_own(0) && is_own(1)) {
        return;
    }
    let t = from_origin.dot(ray.direction) / ray.direction.dot(ray.direction);
    let miss = (from_origin - ray.direction * t).greatest();
    let size =
        Vector3::<T>::from_f32(leaf.tangent_u).greatest() + Vector3::<T>::from_f32(leaf.tangent_v).greatest();
    // A last step leaves its square, and what a net that is larger than its surface rounds, of which the slack knows. What does not converge within
    // the limit is a near tangent or at a pole, and counts as far as roundings and the slack leave it open.
    let rounding = (size + (from_origin + ray.origin).greatest()) * T::EPSILON;
    let (steps, slacks) = if converged { (256.0, 4.0) } else { (16.0, 0.5) };
    let tolerance = (rounding * number(steps)).max(*slack * number(slacks));
    if !(miss <= tolerance) {
        return;
    }
    add_root(roots, NetRoot { uv, t, footprint }, domain);
}

/// A bound of the leaf's normal curvatures: that of its second derivatives over the square of the shorter tangent. Where there is no bound, the
/// greatest that a byte can hold.
fn leaf_curvature<T: Real>(leaf: &NetLeaf) -> T {
    let a = Vector3::<T>::from_f32(leaf.tangent_u).length();
    let b = Vector3::<T>::from_f32(leaf.tangent_v).length();
    T::from_f32(bend_bound(leaf.certificate >> 24)) / a.min(b)
}

#[inline]
fn is_within<T: Real>(uv: [T; 2], domain: &Domain<T>, margin: T) -> bool {
    let inside = |x: T, low: T, size: T| x >= low - margin * size && x <= low + (T::ONE + margin) * size;
    inside(uv[0], domain.low[0], domain.size[0]) && inside(uv[1], domain.low[1], domain.size[1])
}

fn add_root<T: Real>(roots: &mut NetRoots<T>, root: NetRoot<T>, domain: &Domain<T>) {
    let near = T::EPSILON.sqrt() * number(0.25);
    for known in &roots.root[..roots.count] {
        if (known.uv[0] - root.uv[0]).abs() <= near * domain.size[0]
            && (known.uv[1] - root.uv[1]).abs() <= near * domain.size[1]
        {
            return;
        }
    }
    if roots.count < MAX_ROOTS {
        roots.root[roots.count] = root;
        roots.count += 1;
    }
}

/// The unit normal `S_u × S_v` of the net, face space; where it vanishes (a pole), that of a point a little inside.
pub fn net_normal<T: Kernel>(scene: &Scene<'_>, net: &Net, uv: [T; 2]) -> Vector3<T> {
    let half = number::<T>(0.5);
    let mut at = uv;
    for _ in 0..4 {
        let [s_u, s_v] = net_tangents(scene, net, at);
        let n = s_u.cross(s_v);
        let (length, least) = (n.length(), s_u.length() * s_v.length());
        if length > number::<T>(32.0) * T::EPSILON * least && length > number(1e-30) {
            return n * (T::ONE / length);
        }
        let inwards = number::<T>(16.0) * T::EPSILON.sqrt();
        at = [at[0] + (half - at[0]) * inwards, at[1] + (half - at[1]) * inwards];
    }
    vec3(T::ZERO, T::ZERO, T::ONE)
}

/// S_u and S_v of the net, each times the weight.
fn net_tangents<T: Kernel>(scene: &Scene<'_>, net: &Net, uv: [T; 2]) -> [Vector3<T>; 2] {
    point_and_tangents(&net_jet(scene, net, Vector3::default(), uv)).1
}

/// The point of a jet and, by the quotient rule, S_u and S_v, each times the weight.
#[inline]
fn point_and_tangents<T: Real>(jet: &NetJet<T>) -> (Vector3<T>, [Vector3<T>; 2]) {
    let point = vec3(jet.value[0], jet.value[1], jet.value[2]) * (T::ONE / jet.value[3]);
    (point, [jet.by_u, jet.by_v].map(|d| vec3(d[0], d[1], d[2]) - point * d[3]))
}

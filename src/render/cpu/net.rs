//! Rays against a leaf of a rational Bézier net: skew slab, uniqueness certificate, Newton's method on two planes through the ray.
//!
//! **Slab.** With the dual rows D = [a b n]⁻¹ of the leaf's mean tangents a, b and n = a × b, the leaf lies in three slabs; cutting the ray with them
//! rejects most rays, and gives the range of t in which the roots lie.
//!
//! **Certificate.** Projected along the ray onto the leaf's plane, the surface is `(α − (d₀/d₂) γ, β − (d₁/d₂) γ)` with (d₀, d₁, d₂) = D d. With the leaf's bounds
//! on how far α, β, γ deviate from linear, `(1 − E_α) |d₂| > E_γ |d₀|` and `(1 − E_β) |d₂| > E_γ |d₁|` make it a contraction away from the
//! identity: at most one root lies in the leaf and Newton's method, started at the ray's crossing of the leaf's plane, finds it.
//!
//! **Isolation.** Without the certificate the leaf's bound on second derivatives drives a quadtree over its domain (Kantorovich's test, after
//! Srijuntongsiri and Vavasis 2007): cells that cannot hold a root are dropped, those where Newton's method cannot fail are searched, others are quartered.
//! Leaves without any bound get several starts. Where less exactness is asked for, all pairs without the certificate get one start or two.
//!
//! **Newton.** Two planes contain the ray (Kajiya 1982), sheared along the direction's greatest component (Woop, Benthin and Wald 2013); their
//! equations are put to the homogeneous numerators, which are polynomials also where the net is rational.

use super::Kernel;
use super::bernstein::{NetJet, net_jet};
use super::footprint::{Footprint, footprint, sides};
use super::ray_space::PrimitiveRay;
use super::vector::{Vector3, number, vec3};
use crate::numeric::Real;
use crate::render::Exactness;
use crate::scene::{Net, NetLeaf, Scene};
use std::ops::Range;

/// Roots kept per leaf.
pub const MAX_ROOTS: usize = 6;

/// Quarterings of a leaf, and cells looked at in one: near tangents would go on for ever.
const MAX_ISOLATION_LEVEL: u32 = 8;
const MAX_ISOLATION_CELLS: u32 = 1024;

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

/// What the slab test finds.
#[derive(Debug, Clone, Copy)]
struct SlabHit<T> {
    /// Leaf coordinates (−½ to ½) of the ray at t = 0, and their change along it.
    at: Vector3<T>,
    along: Vector3<T>,
    /// Where the ray is inside.
    enter: T,
    leave: T,
    /// Whether at most one root is there.
    unique: bool,
    /// Whether the leaf has no plane (a pole): `at` and `along` say nothing.
    flat: bool,
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
    let domain = leaf_domain(leaf);
    let planes = ray_planes(ray);
    let has_bound = leaf.certificate >> 24 != 255;
    if exactness == Exactness::Exact && !hit.unique && has_bound {
        isolate(scene, leaf, net, ray, &planes, &domain, slack, &mut roots);
        return roots;
    }
    for k in fixed_starts(&hit, exactness) {
        let start = fixed_start(&hit, k, &domain);
        search(scene, leaf, net, ray, &planes, &domain, start, hit.unique, slack, &mut roots);
    }
    roots
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

/// Cuts the ray with the leaf's skew slab.
#[inline]
fn intersect_slab<T: Real>(leaf: &NetLeaf, ray: &PrimitiveRay<T>, near: T, far: T) -> Option<SlabHit<T>> {
    let a = Vector3::<T>::from_f32(leaf.tangent_u);
    let b = Vector3::<T>::from_f32(leaf.tangent_v);
    let center = Vector3::<T>::from_f32(leaf.center);
    let extent_n = T::from_f32(leaf.extent_n);
    let n = a.cross(b);
    let (aa, bb, nn) = (a.dot(a), b.dot(b), n.dot(n));
    let r = ray.origin - center;
    let flat = !(nn > number::<T>(1e-6) * aa * bb && aa > T::ZERO && bb > T::ZERO);
    if flat {
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
    let (mut enter, mut leave) = (near, far);
    cut(at.x, along.x, reach_u, &mut enter, &mut leave);
    cut(at.y, along.y, reach_v, &mut enter, &mut leave);
    cut(at.z, along.z, extent_n + rounding, &mut enter, &mut leave);
    if !(enter <= leave) {
        return None;
    }
    let [e_alpha, e_beta, e_gamma] = certificate::<T>(leaf);
    // γ and E_γ in millimetres: bytes are in units of the shorter tangent.
    let gamma = e_gamma * aa.min(bb).sqrt();
    let across = along.z.abs() * number(1.0 - 1.0 / 1024.0);
    let unique = (T::ONE - e_alpha) * across > gamma * along.x.abs()
        && (T::ONE - e_beta) * across > gamma * along.y.abs();
    Some(SlabHit { at, along, enter, leave, unique, flat: false })
}

/// A sphere instead of a slab, for leaves whose tangents span no plane.
fn flat_slab<T: Real>(
    leaf: &NetLeaf,
    a: T,
    b: T,
    extent_n: T,
    r: Vector3<T>,
    direction: Vector3<T>,
    near: T,
    far: T,
) -> Option<SlabHit<T>> {
    let half = number::<T>(0.5);
    let radius = a * (half + T::from_f32(leaf.extent_u)) + b * (half + T::from_f32(leaf.extent_v)) + extent_n;
    let dd = direction.dot(direction);
    let middle = -r.dot(direction) / dd;
    let closest = r + direction * middle;
    let reach = radius * number(1.001) + r.greatest() * number::<T>(8.0) * T::EPSILON;
    let under_root = reach * reach - closest.dot(closest);
    if !(under_root >= T::ZERO) {
        return None;
    }
    let chord = (under_root / dd).sqrt();
    let (enter, leave) = (near.max(middle - chord), far.min(middle + chord));
    let zero = Vector3::default();
    (enter <= leave).then_some(SlabHit { at: zero, along: zero, enter, leave, unique: false, flat: true })
}

/// Narrows `[enter, leave]` to where `|at + t · along| <= reach`.
#[inline(always)]
fn cut<T: Real>(at: T, along: T, reach: T, enter: &mut T, leave: &mut T) {
    if along.abs() < number(1e-18) {
        if at.abs() > reach {
            *leave = -T::INFINITY;
        }
        return;
    }
    let inverse = T::ONE / along;
    let (first, second) = ((-reach - at) * inverse, (reach - at) * inverse);
    *enter = enter.max(first.min(second));
    *leave = leave.min(first.max(second));
}

/// E_α, E_β, E_γ; infinite where there is no bound.
#[inline]
fn certificate<T: Real>(leaf: &NetLeaf) -> [T; 3] {
    let bound = |shift: u32| {
        let byte = leaf.certificate >> shift & 0xff;
        if byte == 255 { T::INFINITY } else { T::from_f32(byte as f32 / 64.0) }
    };
    [bound(0), bound(8), bound(16)]
}

/// The two planes through a ray: about its origin, `p − along·slope` in the two minor axes is 0 on it.
#[derive(Debug, Clone, Copy)]
struct RayPlanes<T> {
    /// The greatest component of the direction.
    major: usize,
    minor: [usize; 2],
    /// At most 1.
    slope: [T; 2],
}

#[inline]
fn ray_planes<T: Real>(ray: &PrimitiveRay<T>) -> RayPlanes<T> {
    let d = ray.direction.to_array();
    let major = if d[0].abs() >= d[1].abs() && d[0].abs() >= d[2].abs() {
        0
    } else if d[1].abs() >= d[2].abs() {
        1
    } else {
        2
    };
    let minor = [(major + 1) % 3, (major + 2) % 3];
    let slope = [d[minor[0]] / d[major], d[minor[1]] / d[major]];
    RayPlanes { major, minor, slope }
}

/// Searches the leaf cell by cell, from the whole one down.
///
/// In a cell of half width r about a point with plane values F and derivatives J (by the leaf's own parameters), S is linear up to
/// `½ B r²` with B a bound of `|S_ss| + 2 |S_st| + |S_tt|`. A combination `w · F` of the planes is `n · S` with `n = (w, −w · slope)`, so a root
/// needs `|w · F| <= |w · J| r + |n| ½ B r²` for every w: for both planes, and for both rows of J⁻¹, the Newton step.
///
/// Let `K = B max |n|` over the rows of J⁻¹, and η the step. J⁻¹ J is off the identity by at most K r in the cell, so `K r < 1` leaves room for one root,
/// at a distance e from the middle of r at most. `K η < ½` is Kantorovich's condition, under which Newton's method does not fail:
/// after the first step `½ K e² <= ½ e` is left, and the derivative's inverse has at most doubled. Both are asked for with a tenth to spare.
fn isolate<T: Kernel>(
    scene: &Scene<'_>,
    leaf: &NetLeaf,
    net: &Net,
    ray: &PrimitiveRay<T>,
    planes: &RayPlanes<T>,
    domain: &Domain<T>,
    slack: T,
    roots: &mut NetRoots<T>,
) {
    let a = Vector3::<T>::from_f32(leaf.tangent_u);
    let b = Vector3::<T>::from_f32(leaf.tangent_v);
    let bend = T::from_f32((leaf.certificate >> 24) as f32 * (1.0 / 64.0)) * a.length().min(b.length());
    let norm = |w: [T; 2]| {
        let along = w[0] * planes.slope[0] + w[1] * planes.slope[1];
        (w[0] * w[0] + w[1] * w[1] + along * along).sqrt()
    };
    let plane_norms = [norm([T::ONE, T::ZERO]), norm([T::ZERO, T::ONE])];
    let center = Vector3::<T>::from_f32(leaf.center);
    let rounding = (center.greatest() + ray.origin.greatest() + a.greatest() + b.greatest())
        * number::<T>(32.0)
        * T::EPSILON;
    let half = number::<T>(0.5);
    let (mut level, mut cell) = (0_u32, [0_u32; 2]);
    for _ in 0..MAX_ISOLATION_CELLS {
        let radius = half / T::from_f32((1_u32 << level) as f32);
        let middle =
            |k: usize| domain.low[k] + domain.size[k] * (T::from_f32((2 * cell[k] + 1) as f32) * radius);
        let uv = [middle(0), middle(1)];
        let NetJet { value, by_u, by_v } = net_jet(scene, net, ray.origin, uv);
        let scale = T::ONE / value[3];
        let f = plane_values(planes, value).map(|x| x * scale);
        let slopes = |derivative: [T; 4], size: T| {
            let d = plane_values(planes, derivative);
            [0, 1].map(|k| (d[k] - f[k] * derivative[3]) * scale * size)
        };
        let (f_s, f_t) = (slopes(by_u, domain.size[0]), slopes(by_v, domain.size[1]));
        // A little more than the cell, so that roots on its edges are in it.
        let reach = radius * number(1.0 + 1.0 / 64.0);
        let remainder = bend * half * reach * reach + rounding + slack;
        let determinant = f_s[0] * f_t[1] - f_s[1] * f_t[0];
        let ds = f[0] * f_t[1] - f[1] * f_t[0];
        let dt = f_s[0] * f[1] - f_s[1] * f[0];
        let rows = [norm([f_t[1], -f_t[0]]), norm([-f_s[1], f_s[0]])];
        let room = reach * determinant.abs();
        let misses = f[0].abs() > (f_s[0].abs() + f_t[0].abs()) * reach + plane_norms[0] * remainder
            || f[1].abs() > (f_s[1].abs() + f_t[1].abs()) * reach + plane_norms[1] * remainder
            || ds.abs() > room + rows[0] * remainder
            || dt.abs() > room + rows[1] * remainder;
        if !misses {
            let curving = rows[0].max(rows[1]) * bend;
            let is_regular = curving * reach < number::<T>(0.9) * determinant.abs()
                && curving * (ds.abs().max(dt.abs()) / determinant.abs())
                    < number::<T>(0.45) * determinant.abs();
            if is_regular {
                let step = |k: usize, d: T| uv[k] - d / determinant * domain.size[k];
                search(scene, leaf, net, ray, planes, domain, [step(0, ds), step(1, dt)], level <= 2, slack, roots);
            } else if level < MAX_ISOLATION_LEVEL {
                level += 1;
                cell = [2 * cell[0], 2 * cell[1]];
                continue;
            } else {
                search(scene, leaf, net, ray, planes, domain, uv, false, slack, roots);
            }
        }
        // The next of four, or of the parent's four.
        while level > 0 && cell[0] & cell[1] & 1 == 1 {
            level -= 1;
            cell = [cell[0] >> 1, cell[1] >> 1];
        }
        if level == 0 {
            return;
        }
        cell = if cell[0] & 1 == 0 { [cell[0] + 1, cell[1]] } else { [cell[0] - 1, cell[1] + 1] };
    }
}

/// One Newton search; adds the root it ends at, if it is one of the leaf's and new.
fn search<T: Kernel>(
    scene: &Scene<'_>,
    leaf: &NetLeaf,
    net: &Net,
    ray: &PrimitiveRay<T>,
    planes: &RayPlanes<T>,
    domain: &Domain<T>,
    start: [T; 2],
    unique: bool,
    slack: T,
    roots: &mut NetRoots<T>,
) {
    let mut uv = start;
    // Quadratic convergence: a step this small leaves its square. Near tangents it is slower, so steps have to be smaller.
    let small = if unique { T::EPSILON.sqrt() } else { T::EPSILON.sqrt() * number(1.0 / 64.0) };
    let limit = if unique { 10 } else { 16 };
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
    let NetJet { value, by_u, by_v } = net_jet(scene, net, ray.origin, uv);
    let scale = T::ONE / value[3];
    let from_origin = vec3(value[0], value[1], value[2]) * scale;
    let tangent = |d: [T; 4]| (vec3(d[0], d[1], d[2]) - from_origin * d[3]) * scale;
    let footprint = footprint(ray.direction, sides(ray.direction), tangent(by_u), tangent(by_v), slack);
    let margin = if unique { number(1.0 / 64.0) } else { number::<T>(0.5) };
    let extent = footprint.extent();
    let is_own = |k: usize| {
        let on_net = extent[k].max(number(OVERLAP));
        let on_leaf = extent[k].max(margin * domain.size[k]);
        let beyond = uv[k] - domain.low[k];
        uv[k] >= -on_net && uv[k] <= T::ONE + on_net && beyond >= -on_leaf && beyond - domain.size[k] <= on_leaf
    };
    if !(is_own(0) && is_own(1)) {
        return;
    }
    let t = from_origin.dot(ray.direction) / ray.direction.dot(ray.direction);
    let miss = (from_origin - ray.direction * t).greatest();
    let size =
        Vector3::<T>::from_f32(leaf.tangent_u).greatest() + Vector3::<T>::from_f32(leaf.tangent_v).greatest();
    // What does not converge within the limit is a near tangent: it counts where the ray comes as close as the roundings let us tell.
    let rounding = (size + (from_origin + ray.origin).greatest()) * T::EPSILON;
    let tolerance = rounding * if converged { number::<T>(4096.0) } else { number::<T>(64.0) };
    if !(miss <= tolerance) {
        return;
    }
    add_root(roots, NetRoot { uv, t, footprint }, domain);
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

/// The two plane equations of a homogeneous vector about the ray's origin.
#[inline(always)]
fn plane_values<T: Real>(planes: &RayPlanes<T>, p: [T; 4]) -> [T; 2] {
    let [first, second] = planes.minor;
    [p[first] - planes.slope[0] * p[planes.major], p[second] - planes.slope[1] * p[planes.major]]
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

/// S_u and S_v of the net by the quotient rule, each times the weight.
fn net_tangents<T: Kernel>(scene: &Scene<'_>, net: &Net, uv: [T; 2]) -> [Vector3<T>; 2] {
    let NetJet { value, by_u, by_v } = net_jet(scene, net, Vector3::default(), uv);
    let point = vec3(value[0], value[1], value[2]) * (T::ONE / value[3]);
    let tangent = |d: [T; 4]| vec3(d[0], d[1], d[2]) - point * d[3];
    [tangent(by_u), tangent(by_v)]
}

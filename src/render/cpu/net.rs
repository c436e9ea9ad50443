//! Rays against a leaf of a rational Bézier net: skew slab, uniqueness certificate, Newton's method on two planes through the ray.
//!
//! **Slab.** With the dual rows D = [a b n]⁻¹ of the leaf's mean tangents a, b and n = a × b, the leaf lies in three slabs; cutting the ray with them
//! rejects most rays, and gives the range of t in which the roots lie.
//!
//! **Certificate.** Projected along the ray onto the leaf's plane, the surface is `(α − (d₀/d₂) γ, β − (d₁/d₂) γ)` with (d₀, d₁, d₂) = D d. With the leaf's bounds
//! on how far α, β, γ deviate from linear, `(1 − E_α) |d₂| > E_γ |d₀|` and `(1 − E_β) |d₂| > E_γ |d₁|` make it a contraction away from the
//! identity: at most one root lies in the leaf and Newton's method, started at the ray's crossing of the leaf's plane, finds it. Without the certificate
//! several starts look for several roots.
//!
//! **Newton.** Two planes contain the ray (Kajiya 1982), sheared along the direction's greatest component (Woop, Benthin and Wald 2013); their
//! equations are put to the homogeneous numerators, which are polynomials also where the net is rational.

use super::bernstein::MAX_ORDER;
use super::ray_space::PrimitiveRay;
use super::vector::{Vector3, number, vec3};
use super::{Kernel, bernstein};
use crate::numeric::Real;
use crate::scene::{Net, NetLeaf, Scene};

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
) -> NetRoots<T> {
    let mut roots = NetRoots { count: 0, root: [NetRoot::default(); MAX_ROOTS] };
    let Some(hit) = intersect_slab(leaf, ray, near, far) else {
        return roots;
    };
    let domain = leaf_domain(leaf);
    let planes = ray_planes(ray);
    let half = number::<T>(0.5);
    if hit.unique {
        let middle = (-hit.at.z / hit.along.z).max(hit.enter).min(hit.leave);
        let start = slab_start(&hit, middle, &domain);
        search(scene, leaf, net, ray, &planes, &domain, start, true, &mut roots);
        return roots;
    }
    if !hit.flat {
        let middle = (hit.enter + hit.leave) * half;
        for t in [hit.enter, hit.leave, middle] {
            let start = slab_start(&hit, t, &domain);
            search(scene, leaf, net, ray, &planes, &domain, start, false, &mut roots);
        }
    }
    for (u, v) in [(0.5, 0.5), (0.1, 0.1), (0.9, 0.1), (0.1, 0.9), (0.9, 0.9)] {
        let start = [domain.low[0] + domain.size[0] * number(u), domain.low[1] + domain.size[1] * number(v)];
        search(scene, leaf, net, ray, &planes, &domain, start, false, &mut roots);
    }
    roots
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

/// The two planes through a ray: `p − along·slope` in the two minor axes is constant on it.
#[derive(Debug, Clone, Copy)]
struct RayPlanes<T> {
    /// The greatest component of the direction.
    major: usize,
    minor: [usize; 2],
    slope: [T; 2],
    /// The constants.
    at: [T; 2],
}

#[inline]
fn ray_planes<T: Real>(ray: &PrimitiveRay<T>) -> RayPlanes<T> {
    let (d, o) = (ray.direction.to_array(), ray.origin.to_array());
    let major = if d[0].abs() >= d[1].abs() && d[0].abs() >= d[2].abs() {
        0
    } else if d[1].abs() >= d[2].abs() {
        1
    } else {
        2
    };
    let minor = [(major + 1) % 3, (major + 2) % 3];
    let slope = [d[minor[0]] / d[major], d[minor[1]] / d[major]];
    let at = [o[minor[0]] - slope[0] * o[major], o[minor[1]] - slope[1] * o[major]];
    RayPlanes { major, minor, slope, at }
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
    roots: &mut NetRoots<T>,
) {
    let mut uv = start;
    // Quadratic convergence: a step this small leaves its square. Near tangents it is slower, so steps have to be smaller.
    let small = if unique { T::EPSILON.sqrt() } else { T::EPSILON.sqrt() * number(1.0 / 64.0) };
    let limit = if unique { 10 } else { 16 };
    let mut converged = false;
    for _ in 0..limit {
        let [f, f_u, f_v] = plane_values(scene, net, planes, uv);
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
    let margin = if unique { number(1.0 / 64.0) } else { number::<T>(0.5) };
    let overlap = number::<T>(OVERLAP);
    let on_net = |x: T| x >= -overlap && x <= T::ONE + overlap;
    if !(on_net(uv[0]) && on_net(uv[1]) && is_within(uv, domain, margin)) {
        return;
    }
    let point = net_position(scene, net, uv);
    let from_origin = point - ray.origin;
    let t = from_origin.dot(ray.direction) / ray.direction.dot(ray.direction);
    let miss = (from_origin - ray.direction * t).greatest();
    let size =
        Vector3::<T>::from_f32(leaf.tangent_u).greatest() + Vector3::<T>::from_f32(leaf.tangent_v).greatest();
    // What does not converge within the limit is a near tangent: it counts where the ray comes as close as the roundings let us tell.
    let rounding = (size + point.greatest()) * T::EPSILON;
    let tolerance = rounding * if converged { number::<T>(4096.0) } else { number::<T>(64.0) };
    if !(miss <= tolerance) {
        return;
    }
    add_root(roots, NetRoot { uv, t }, domain);
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

/// The two plane equations at (u, v) and their derivatives by u and v, times the weight.
#[inline]
fn plane_values<T: Kernel>(scene: &Scene<'_>, net: &Net, planes: &RayPlanes<T>, uv: [T; 2]) -> [[T; 2]; 3] {
    let (degree_u, degree_v) = net_degrees(net);
    match degree_u.max(degree_v) {
        0..=3 => plane_values_within::<T, 4>(scene, net, planes, uv),
        4..=7 => plane_values_within::<T, 8>(scene, net, planes, uv),
        _ => plane_values_within::<T, MAX_ORDER>(scene, net, planes, uv),
    }
}

/// [`plane_values`] of a net whose degrees are below `ORDER`.
#[inline(always)]
fn plane_values_within<T: Kernel, const ORDER: usize>(
    scene: &Scene<'_>,
    net: &Net,
    planes: &RayPlanes<T>,
    uv: [T; 2],
) -> [[T; 2]; 3] {
    let (degree_u, degree_v) = net_degrees(net);
    let (basis_u, slope_u) = bernstein::basis_and_slopes::<T, ORDER>(degree_u, uv[0]);
    let (basis_v, slope_v) = bernstein::basis_and_slopes::<T, ORDER>(degree_v, uv[1]);
    let [first, second] = planes.minor;
    let zero = T::ZERO;
    let (mut f, mut f_u, mut f_v) = ([zero; 2], [zero; 2], [zero; 2]);
    let mut index = net.first_point as usize;
    for i in 0..=degree_u {
        let (mut row, mut row_v) = ([zero; 2], [zero; 2]);
        for j in 0..=degree_v {
            let p = T::net_point(scene, index);
            index += 1;
            let x = p[first] - planes.slope[0] * p[planes.major] - planes.at[0] * p[3];
            let y = p[second] - planes.slope[1] * p[planes.major] - planes.at[1] * p[3];
            row = [row[0] + x * basis_v[j], row[1] + y * basis_v[j]];
            row_v = [row_v[0] + x * slope_v[j], row_v[1] + y * slope_v[j]];
        }
        f = [f[0] + row[0] * basis_u[i], f[1] + row[1] * basis_u[i]];
        f_u = [f_u[0] + row[0] * slope_u[i], f_u[1] + row[1] * slope_u[i]];
        f_v = [f_v[0] + row_v[0] * basis_u[i], f_v[1] + row_v[1] * basis_u[i]];
    }
    [f, f_u, f_v]
}

/// Degrees along u and v.
#[inline(always)]
pub fn net_degrees(net: &Net) -> (usize, usize) {
    ((net.degrees & 0xff) as usize, (net.degrees >> 8 & 0xff) as usize)
}

/// The point of the net, face space.
#[inline]
pub fn net_position<T: Kernel>(scene: &Scene<'_>, net: &Net, uv: [T; 2]) -> Vector3<T> {
    let (degree_u, degree_v) = net_degrees(net);
    let (basis_u, _) = bernstein::basis_and_slopes::<T, MAX_ORDER>(degree_u, uv[0]);
    let (basis_v, _) = bernstein::basis_and_slopes::<T, MAX_ORDER>(degree_v, uv[1]);
    let mut sum = [T::ZERO; 4];
    let mut index = net.first_point as usize;
    for i in 0..=degree_u {
        let mut row = [T::ZERO; 4];
        for j in 0..=degree_v {
            let p = T::net_point(scene, index);
            index += 1;
            for k in 0..4 {
                row[k] += p[k] * basis_v[j];
            }
        }
        for k in 0..4 {
            sum[k] += row[k] * basis_u[i];
        }
    }
    let scale = T::ONE / sum[3];
    vec3(sum[0] * scale, sum[1] * scale, sum[2] * scale)
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
    let (degree_u, degree_v) = net_degrees(net);
    let (basis_u, slope_u) = bernstein::basis_and_slopes::<T, MAX_ORDER>(degree_u, uv[0]);
    let (basis_v, slope_v) = bernstein::basis_and_slopes::<T, MAX_ORDER>(degree_v, uv[1]);
    let (mut sum, mut sum_u, mut sum_v) = ([T::ZERO; 4], [T::ZERO; 4], [T::ZERO; 4]);
    let mut index = net.first_point as usize;
    for i in 0..=degree_u {
        for j in 0..=degree_v {
            let p = T::net_point(scene, index);
            index += 1;
            for k in 0..4 {
                sum[k] += p[k] * (basis_u[i] * basis_v[j]);
                sum_u[k] += p[k] * (slope_u[i] * basis_v[j]);
                sum_v[k] += p[k] * (basis_u[i] * slope_v[j]);
            }
        }
    }
    let point = vec3(sum[0], sum[1], sum[2]) * (T::ONE / sum[3]);
    let tangent = |d: [T; 4]| vec3(d[0], d[1], d[2]) - point * d[3];
    [tangent(sum_u), tangent(sum_v)]
}

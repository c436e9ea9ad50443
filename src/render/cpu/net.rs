//! Rays against a leaf of a rational Bézier net: Newton's method on the two planes of the ray. Derivatives are those of the surface, by the quotient
//! rule: what the leaf's bounds promise, they promise of the surface and not of its homogeneous numerators.
//!
//! Where the leaf's slab says that there is one root at most, one search finds it. Elsewhere the leaf's bound on second derivatives drives a quadtree
//! over its domain; leaves without any bound get several starts. Where less exactness is asked for, all pairs without the certificate
//! get one start or two.

use super::Kernel;
use super::bernstein::{NetJet, net_jet};
use super::footprint::same_place;
use super::isolate::{Cell, MAX_ISOLATION_CELLS, SearchKind, Verdict, bend_at_pole, examine, leaf_bounds};
use super::leaf::{Domain, LeafRay, NetRoot, has_bend_bound, leaf_bend, leaf_domain, leaf_pole};
use super::newton::{
    Landing, is_within, newton_fraction, newton_step, point_and_tangents, root_at, unique_root,
};
use super::planes::{plane_jet, ray_planes};
use super::ray_space::PrimitiveRay;
use super::slab::{SlabHit, intersect_slab};
use super::tally::{Step, Tally};
use super::vector::{Vector3, number, vec3};
use crate::numeric::{Number, Real};
use crate::render::{Exactness, NetSearch};
use crate::scene::{Net, NetLeaf, Scene, point_side};
use std::ops::Range;

/// Roots kept per leaf.
pub const MAX_ROOTS: usize = 6;

/// By how much damping falls with a step that goes down, and grows with one that does not. The first step has an eighth of what would make it go down
/// whatever the surface does within its bounds, which are some times what they bound.
const DAMPING_FACTOR: f64 = 8.0;

/// The roots found in a leaf, in no order.
#[derive(Debug, Clone, Copy)]
pub struct NetRoots<T: Number> {
    /// How many.
    pub count: usize,
    /// The roots.
    pub root: [NetRoot<T>; MAX_ROOTS],
    /// Where the ray enters the leaf's slab, but for what it is found beside it.
    pub begin: T,
    /// Whether there may be more: the search ended before its end, or found more than it keeps.
    pub is_cut: bool,
}

/// The roots of the ray in a leaf (and, at times, just beside it).
pub fn leaf_roots<T: Kernel>(
    scene: &Scene<'_>,
    leaf: &NetLeaf,
    net: &Net,
    ray: &PrimitiveRay<T>,
    near: T,
    far: T,
    NetSearch { exactness, newton_stop }: NetSearch,
    slack: T,
    tally: &mut impl Tally,
) -> NetRoots<T> {
    let (meets, hit) = intersect_slab(leaf, ray, near, far);
    let mut roots =
        NetRoots { count: 0, root: [NetRoot::default(); MAX_ROOTS], begin: hit.enter, is_cut: false };
    if !meets {
        return roots;
    }
    let domain = leaf_domain(leaf);
    let pole = leaf_pole(net, &domain);
    let newton_stop = T::from_f32(newton_stop);
    let at = LeafRay { leaf, net, domain, ray: *ray, planes: ray_planes(ray), slack, pole, newton_stop };
    if hit.unique {
        let start = unique_start(&hit, &at.domain);
        search(scene, &at, start, SearchKind::Unique, T::ONE, &mut roots, tally);
        return roots;
    }
    if exactness == Exactness::Exact && has_bend_bound(leaf) {
        isolate(scene, &at, &mut roots, tally);
        return roots;
    }
    for k in fixed_starts(&hit, exactness) {
        search(scene, &at, fixed_start(&hit, k, &at.domain), SearchKind::Open, T::ONE, &mut roots, tally);
    }
    roots
}

/// Searches the leaf cell by cell.
fn isolate<T: Kernel>(
    scene: &Scene<'_>,
    at: &LeafRay<'_, T>,
    roots: &mut NetRoots<T>,
    tally: &mut impl Tally,
) {
    tally.count(Step::DividedLeaf);
    let bounds = leaf_bounds(at);
    let mut cell = Cell::default();
    for _ in 0..MAX_ISOLATION_CELLS {
        tally.count(Step::Cell);
        let jet = net_jet(scene, at.net, at.ray.origin, cell.cell_center(at));
        match examine(&jet, at, &bounds, cell) {
            Verdict::Split(quarters) => {
                cell = cell.first_part(at.pole, quarters);
                continue;
            }
            Verdict::Search { start, kind, across } => search(scene, at, start, kind, across, roots, tally),
            Verdict::Empty => {}
        }
        match cell.next_cell(at.pole) {
            Some(next) => cell = next,
            None => return,
        }
    }
    roots.is_cut = true;
}

/// The starts that a leaf gets where it is not searched cell by cell, as numbers for [`fixed_start`]. A flat leaf has no plane to start on.
#[inline]
fn fixed_starts<T: Real>(hit: &SlabHit<T>, exactness: Exactness) -> Range<u32> {
    match (exactness, hit.flat) {
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
        0 => return unique_start(hit, domain),
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

/// Where the ray crosses the leaf's plane.
#[inline(always)]
pub fn unique_start<T: Number>(hit: &SlabHit<T>, domain: &Domain<T>) -> [T; 2] {
    slab_start(hit, (-hit.at.z / hit.along.z).max(hit.enter).min(hit.leave), domain)
}

/// The leaf point at which the ray stands at `t`, projected onto the leaf's plane and clamped to the leaf.
#[inline(always)]
fn slab_start<T: Number>(hit: &SlabHit<T>, t: T, domain: &Domain<T>) -> [T; 2] {
    let half = number::<T>(0.5);
    let clamp = |x: T| x.max(-half).min(half) + half;
    let (s, r) = (clamp(hit.at.x + hit.along.x * t), clamp(hit.at.y + hit.along.y * t));
    [domain.low[0] + domain.size[0] * s, domain.low[1] + domain.size[1] * r]
}

/// One Newton search; adds the root it ends at, if it is one of the leaf's and new.
///
/// `across` is how far from a pole the start's cell reaches, or 1. Where nothing is known of the start steps are damped (Levenberg 1944, Marquardt 1963),
/// `(JᵀJ + λ)⁻¹ Jᵀ F`, with λ in proportion to |F| and to the bound of second derivatives (Yamashita and Fukushima 2001), less after each step that goes
/// down and more after one that does not, which is taken back. Near a root that is Newton's step, where J is singular it is the shortest
/// one, and where the ray passes by it ends near the place closest to it.
fn search<T: Kernel>(
    scene: &Scene<'_>,
    at: &LeafRay<'_, T>,
    start: [T; 2],
    kind: SearchKind,
    across: T,
    roots: &mut NetRoots<T>,
    tally: &mut impl Tally,
) {
    if kind == SearchKind::Unique {
        let (exists, root) = unique_root(scene, at, start, true, tally);
        if exists {
            add_root(roots, root, at);
        }
        return;
    }
    tally.count(Step::Search);
    let LeafRay { leaf, net, domain, ray, planes, .. } = at;
    let bend = leaf_bend(leaf);
    let is_open = kind == SearchKind::Open;
    // Steps are in sides of the leaf; at a pole, away from it, in sides of the cell: so the surface is as regular as elsewhere.
    let mut unit = domain.size;
    unit[at.pole.axis] *= across;
    let bend_here = if across < T::ONE { bend * bend_at_pole(at, across) } else { bend };
    let damping = if is_open && has_bend_bound(leaf) { bend_here } else { T::ZERO };
    let mut uv = start;
    // Near tangents steps halve, so they have to be smaller and may be as many as there are bits, half of which a double root has.
    let small = T::EPSILON.sqrt() * at.newton_stop * number(1.0 / 64.0);
    // What the net has where the last step was taken from, once steps are small.
    let mut landed: Option<NetJet<T>> = None;
    // The lowest point so far, what the planes have there, and the share of the damping.
    let (mut base, mut low, mut share) = (uv, [[T::ZERO; 2]; 3], T::ONE);
    for turn in 0..T::TANGENT_STEPS {
        tally.count(Step::NewtonStep);
        let jet = net_jet(scene, net, ray.origin, uv);
        let here = plane_jet(planes, &jet, unit);
        if turn == 0 || !is_open || height(here) <= height(low) {
            (base, low, share) = (uv, here, share * number(1.0 / DAMPING_FACTOR));
        } else {
            share *= number(DAMPING_FACTOR);
        }
        let step = damped_step(low, damping * share);
        // A singular point: what is left is whether the ray passes through it.
        if !(step[0].is_finite() && step[1].is_finite()) {
            break;
        }
        // A step across more than the unit is a leap of faith; it is cut to one.
        let longest = step[0].abs().max(step[1].abs());
        let shorten = if longest > T::ONE { T::ONE / longest } else { T::ONE };
        uv = [0, 1].map(|k| base[k] - step[k] * (shorten * unit[k]));
        if !(is_within(uv, domain, T::ONE)) {
            return;
        }
        if longest <= small {
            landed = Some(jet);
            break;
        }
    }
    let converged = landed.is_some();
    if is_open && !converged {
        uv = base;
    }
    if !is_within(uv, domain, number(0.5)) {
        return;
    }
    // A certain search's last step is so small that the surface is flat under it: by √ε of the leaf at most, it leaves ε. A step that may be larger does not.
    let last = landed.filter(|_| !is_open && at.newton_stop <= T::ONE);
    let moved = if last.is_some() { [uv[0] - base[0], uv[1] - base[1]] } else { [T::ZERO; 2] };
    let jet = last.unwrap_or_else(|| net_jet(scene, net, ray.origin, uv));
    let landing = Landing { uv, jet, moved, is_sure: converged && !is_open, has_converged: converged };
    let (exists, root) = root_at(at, &landing, number(0.5));
    if exists {
        add_root(roots, root, at);
    }
}

/// The step from values and derivatives of the two planes: Newton's where `damping` is 0.
///
/// With the derivatives J divided by their norm, `(JᵀJ + λ)⁻¹ Jᵀ F` is `(det J adj J F + λ Jᵀ F) / (det² J + λ (1 + λ))`, without a difference of large
/// terms.
#[inline(always)]
fn damped_step<T: Real>(jet: [[T; 2]; 3], damping: T) -> [T; 2] {
    if !(damping > T::ZERO) {
        return newton_step(jet);
    }
    let (determinant, newton) = newton_fraction(jet);
    let [f, f_s, f_t] = jet;
    let square = f_s[0] * f_s[0] + f_s[1] * f_s[1] + f_t[0] * f_t[0] + f_t[1] * f_t[1];
    let inverse = T::ONE / square;
    let lambda = damping * (f[0].abs() + f[1].abs()) * inverse;
    let determinant = determinant * inverse;
    let downhill = [f_s[0] * f[0] + f_s[1] * f[1], f_t[0] * f[0] + f_t[1] * f[1]];
    let scale = inverse / (determinant * determinant + lambda * (T::ONE + lambda));
    [0, 1].map(|k| (newton[k] * determinant + downhill[k] * lambda) * scale)
}

/// How far from both planes.
#[inline(always)]
fn height<T: Real>([f, ..]: [[T; 2]; 3]) -> T {
    f[0] * f[0] + f[1] * f[1]
}

/// Adds a root that is not known yet; of two at one place the one that is not grazing stays. Roots that are not grazing are told apart by their
/// parameters; others, of which a ray that runs along the net or through a pole has many, by where they lie in space and by the side that is hit.
fn add_root<T: Real>(roots: &mut NetRoots<T>, root: NetRoot<T>, at: &LeafRay<'_, T>) {
    let near = T::EPSILON.sqrt() * number(0.25);
    for known in &mut roots.root[..roots.count] {
        let is_near = |k: usize| (known.uv[k] - root.uv[k]).abs() <= near * at.domain.size[k];
        let is_any_grazing = known.footprint.is_grazing || root.footprint.is_grazing;
        let apart = (known.t - root.t).abs() * at.ray.direction.length();
        let is_same_place = || same_place(apart, known.footprint.cosine, root.footprint.cosine, at.slack);
        if is_near(0) && is_near(1) || is_any_grazing && is_same_place() {
            if known.footprint.is_grazing && !root.footprint.is_grazing {
                *known = root;
            }
            return;
        }
    }
    if roots.count < MAX_ROOTS {
        roots.root[roots.count] = root;
        roots.count += 1;
    } else {
        roots.is_cut = true;
    }
}

/// The unit normal `S_u × S_v` of the net, face space.
///
/// Beside a side that is one point, where one tangent is as short as roundings, it is continued from farther inside: linearly, so that a step of h
/// errs by h² of the bend and by the share EPSILON / h of roundings, and h = ∛EPSILON is best. Where it vanishes otherwise, it is that of a point a
/// little inside.
pub fn net_normal<T: Kernel>(scene: &Scene<'_>, net: &Net, uv: [T; 2]) -> Vector3<T> {
    let h = T::EPSILON.cbrt();
    for (axis, end) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        let off = if end == 0 { uv[axis] } else { T::ONE - uv[axis] };
        if net.degrees & point_side(axis, end) == 0 || !(off < h) {
            continue;
        }
        let inside = |by: T| {
            let mut at = uv;
            at[axis] = if end == 0 { by } else { T::ONE - by };
            regular_normal(scene, net, at)
        };
        let (near, far) = (inside(h), inside(h + h));
        let n = near + (near - far) * ((h - off) / h);
        return n * (T::ONE / n.length().max(number(1e-30)));
    }
    regular_normal(scene, net, uv)
}

fn regular_normal<T: Kernel>(scene: &Scene<'_>, net: &Net, uv: [T; 2]) -> Vector3<T> {
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

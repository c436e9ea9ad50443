//! From where Newton's method has ended to a root of a leaf, and the search that cannot fail.
//!
//! Where a leaf's slab says that there is one root at most, all rays take the same steps but for their number: eight of them are searched side by side.

use super::bernstein::{NetJet, NetNumber};
use super::footprint::{Footprint, footprint, pole_footprint, sides};
use super::leaf::{Domain, LeafRay, NetRoot, leaf_bend};
use super::planes::plane_jet;
use super::tally::{Step, Tally};
use super::vector::{Vector3, number, vec3};
use crate::numeric::{Mask, Number};
use crate::scene::Scene;

/// Steps of a search that cannot fail: the certificate's contraction by less than 1 makes some, then digits double.
const MAX_UNIQUE_STEPS: u32 = 10;

/// How far from the ray a root may lie, in roundings of its coordinates and in slacks. Where Newton's method has converged the root is there whatever f32 makes
/// of the net's value, of which a sum over up to 26² points of both signs leaves 2⁸ roundings: what is farther away is no number; elsewhere it has to lie where
/// the face, as wide as its slack, meets the ray, and half of that is for the search's own errors.
const CONVERGED_MISS: [f64; 2] = [256.0, 4.0];
const OPEN_MISS: [f64; 2] = [16.0, 0.5];

/// Accepted excess of (u, v) over [0, 1]: twice the worst that f32 was seen to need so that no ray slips between two nets.
const OVERLAP: f64 = 1.0 / 1_048_576.0;

/// Where a search has ended.
#[derive(Debug, Clone, Copy)]
pub struct Landing<T: Number> {
    /// Local parameters of the net.
    pub uv: [T; 2],
    /// What the net has at `uv − moved`.
    pub jet: NetJet<T>,
    /// The last step, where that was so small that the surface is flat under it.
    pub moved: [T; 2],
    /// Whether the search had to find a root, and did.
    pub is_sure: T::Mask,
    /// Whether steps became small.
    pub has_converged: T::Mask,
}

/// The one root of a leaf whose slab says that there is no more than one, from `start`, for rays that are `asked` for; whether there is one.
///
/// Quadratic convergence: a step as small as √ε leaves ε.
#[inline(always)]
pub fn unique_root<T: NetNumber>(
    scene: &Scene<'_>,
    at: &LeafRay<'_, T>,
    start: [T; 2],
    asked: T::Mask,
    tally: &mut impl Tally,
) -> (T::Mask, NetRoot<T>) {
    tally.count(Step::Search);
    let LeafRay { net, domain, ray, planes, .. } = at;
    let unit = domain.size;
    let small = T::EPSILON.sqrt() * at.newton_stop;
    let (mut uv, mut base, mut jet) = (start, start, NetJet::default());
    let (mut runs, mut is_lost, mut has_landed) = (asked, !asked, T::Mask::everywhere(false));
    for _ in 0..MAX_UNIQUE_STEPS {
        tally.count(Step::NewtonStep);
        let here = T::net_jet(scene, net, ray.origin, uv);
        let step = newton_step(plane_jet(planes, &here, unit));
        // A singular point: what is left is whether the ray passes through it.
        runs = runs & step[0].is_finite() & step[1].is_finite();
        if !runs.any() {
            break;
        }
        // A step across more than the unit is a leap of faith; it is cut to one.
        let longest = step[0].abs().max(step[1].abs());
        let shorten = T::choose(T::ONE.is_less(longest), T::ONE / longest, T::ONE);
        let next = [0, 1].map(|k| uv[k] - step[k] * (shorten * unit[k]));
        base = choose(runs, uv, base);
        jet = choose_jet(runs, here, jet);
        uv = choose(runs, next, uv);
        let is_inside = is_within(uv, domain, T::ONE);
        let lands = runs & is_inside & longest.is_at_most(small);
        is_lost = is_lost | runs & !is_inside;
        has_landed = has_landed | lands;
        runs = runs & is_inside & !lands;
        if !runs.any() {
            break;
        }
    }
    let is_found = !is_lost & is_within(uv, domain, number(0.5));
    if !is_found.any() {
        return (is_found, NetRoot::default());
    }
    let is_flat = has_landed & at.newton_stop.is_at_most(T::ONE);
    let moved = choose(is_flat, [uv[0] - base[0], uv[1] - base[1]], [T::ZERO; 2]);
    if (is_found & !is_flat).any() {
        jet = choose_jet(is_flat, jet, T::net_jet(scene, net, ray.origin, uv));
    }
    let landing = Landing { uv, jet, moved, is_sure: has_landed, has_converged: has_landed };
    let (exists, root) = root_at(at, &landing, number(1.0 / 64.0));
    (is_found & exists, root)
}

/// The root where a search has ended; whether it is one of the leaf's, which reaches `margin` of its sides beyond them.
#[inline(always)]
pub fn root_at<T: Number>(at: &LeafRay<'_, T>, landing: &Landing<T>, margin: T) -> (T::Mask, NetRoot<T>) {
    let LeafRay { leaf, domain, ray, slack, .. } = at;
    let &Landing { uv, jet, moved, is_sure, has_converged } = landing;
    let (point, tangents) = point_and_tangents(&jet);
    let [s_u, s_v] = tangents.map(|tangent| tangent * (T::ONE / jet.value[3]));
    let from_origin = point + s_u * moved[0] + s_v * moved[1];
    let curvature = root_curvature(s_u * domain.size[0], s_v * domain.size[1], leaf_bend(leaf));
    let mut footprint = footprint(ray.direction, s_u, s_v, curvature, *slack);
    if at.pole.exists {
        let axis = at.pole.axis;
        let is_at_pole = [s_v, s_u][axis].length().is_at_most(*slack * number(4.0));
        let of_pole = pole_footprint(axis, sides(ray.direction), [s_u, s_v][axis], *slack);
        footprint = Footprint::choose(is_at_pole, of_pole, footprint);
    }
    footprint.is_grazing = footprint.is_grazing | !has_converged;
    let extent = footprint.extent();
    let [is_own_u, is_own_v] = [0, 1].map(|k| {
        let on_net = extent[k].max(number(OVERLAP));
        let on_leaf = extent[k].max(margin * domain.size[k]);
        let beyond = uv[k] - domain.low[k];
        (-on_net).is_at_most(uv[k])
            & uv[k].is_at_most(T::ONE + on_net)
            & (-on_leaf).is_at_most(beyond)
            & (beyond - domain.size[k]).is_at_most(on_leaf)
    });
    let t = from_origin.dot(ray.direction) / ray.direction.dot(ray.direction);
    let miss = (from_origin - ray.direction * t).greatest();
    let size = [leaf.tangent_u, leaf.tangent_v].map(|tangent| Vector3::<T>::from_f32(tangent).greatest());
    // What a net that is larger than its surface rounds the slack knows. What does not converge within
    // the limit, or converges to the place nearest to the ray, is near a tangent or at a pole, and counts as far as roundings and the slack leave it open.
    let rounding = (size[0] + size[1] + (from_origin + ray.origin).greatest()) * T::EPSILON;
    let [roundings, slacks] =
        [0, 1].map(|k| T::choose(is_sure, number(CONVERGED_MISS[k]), number(OPEN_MISS[k])));
    let tolerance = (rounding * roundings).max(*slack * slacks);
    (is_own_u & is_own_v & miss.is_at_most(tolerance), NetRoot { uv, t, footprint })
}

/// Newton's step from values and derivatives of the two planes.
#[inline(always)]
pub fn newton_step<T: Number>(jet: [[T; 2]; 3]) -> [T; 2] {
    let (determinant, newton) = newton_fraction(jet);
    newton.map(|x| x / determinant)
}

/// That step times the determinant of the derivatives, and the determinant.
#[inline(always)]
pub fn newton_fraction<T: Number>([f, f_s, f_t]: [[T; 2]; 3]) -> (T, [T; 2]) {
    let determinant = f_s[0] * f_t[1] - f_s[1] * f_t[0];
    (determinant, [f[0] * f_t[1] - f[1] * f_t[0], f_s[0] * f[1] - f_s[1] * f[0]])
}

/// A bound of the normal curvatures at a point with the tangents `s` and `t` where second derivatives are at most `bend`: along (x, y) with max(|x|, |y|) = 1
/// they make `bend` at most, over the square of `|s x + t y|`, which is at least the shorter tangent's distance from the other one's line,
/// `|s × t| / max(|s|, |t|)`.
#[inline(always)]
fn root_curvature<T: Number>(s: Vector3<T>, t: Vector3<T>, bend: T) -> T {
    let normal = s.cross(t);
    bend * s.dot(s).max(t.dot(t)) / normal.dot(normal)
}

/// Whether a place is in the domain, or at most `margin` of its sides beyond them.
#[inline(always)]
pub fn is_within<T: Number>(uv: [T; 2], domain: &Domain<T>, margin: T) -> T::Mask {
    let inside = |x: T, low: T, size: T| {
        (low - margin * size).is_at_most(x) & x.is_at_most(low + (T::ONE + margin) * size)
    };
    inside(uv[0], domain.low[0], domain.size[0]) & inside(uv[1], domain.low[1], domain.size[1])
}

/// The point of a jet and, by the quotient rule, S_u and S_v, each times the weight.
#[inline(always)]
pub fn point_and_tangents<T: Number>(jet: &NetJet<T>) -> (Vector3<T>, [Vector3<T>; 2]) {
    let point = vec3(jet.value[0], jet.value[1], jet.value[2]) * (T::ONE / jet.value[3]);
    (point, [jet.by_u, jet.by_v].map(|d| vec3(d[0], d[1], d[2]) - point * d[3]))
}

#[inline(always)]
fn choose<T: Number, const N: usize>(mask: T::Mask, yes: [T; N], no: [T; N]) -> [T; N] {
    std::array::from_fn(|k| T::choose(mask, yes[k], no[k]))
}

#[inline(always)]
fn choose_jet<T: Number>(mask: T::Mask, yes: NetJet<T>, no: NetJet<T>) -> NetJet<T> {
    NetJet {
        value: choose(mask, yes.value, no.value),
        by_u: choose(mask, yes.by_u, no.by_u),
        by_v: choose(mask, yes.by_v, no.by_v),
    }
}

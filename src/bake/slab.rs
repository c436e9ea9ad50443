//! The skew slab around a Bézier patch: its frame, its distortion, its extents and its derivative bounds.
//!
//! The frame is the mean tangents a, b over the patch and their normal. Weights are positive, so the patch lies in the hull of its Cartesian control
//! points, and extents are theirs. The distortion ρ is how far control points lie from the bilinear net of the frame, in units of the frame; it
//! decides where patches are split. Bounds of derivatives come from control differences (polynomial nets) or from Bernstein
//! coefficients of the numerators `X_u w − X w_u` over `w²` (rational nets), so they hold everywhere, not only at samples.

use super::narrow;
use super::tensor::{Tensor, Value};
use crate::geometry::{BezierPatch, Homogeneous};
use crate::numeric::Aabb;
use crate::scene::{NetLeaf, bend_byte, point_side};
use glam::{DMat3, DVec3, DVec4};

/// Tangents shorter than this share of the patch's size, or nearly parallel ones (sine), span no usable frame.
const MIN_TANGENT: f64 = 1.0 / 4096.0;
const MIN_SINE: f64 = 1.0 / 64.0;

/// Tangents whose sine is below this are parallel.
const PARALLEL: f64 = 1e-12;

/// A side this much shorter than the opposite one is a pole: splitting does not make the patch more regular.
const POLE_RATIO: f64 = 1.0 / 64.0;

/// A side this much shorter than the opposite one leaves few rays whose root is certified to be the only one: the tangents differ too much. Halves of a patch
/// that ends in a point are wider than this, but for the one at the point.
const TAPER: f64 = 1.0 / 3.0;

/// Weights in one leaf may differ by this factor.
const MAX_WEIGHT_RATIO: f64 = 4.0;

/// Derivatives of rational patches with more control points are bounded term by term: the products cost the square of this.
const MAX_PRODUCT_POINTS: usize = 100;

/// Control points of one side that lie within this share of the patch's coordinates are one point: single precision makes no other difference.
const ONE_POINT: f64 = 1.0 / 4_194_304.0;

/// How a patch fits its frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fit {
    tangents: [DVec3; 2],
    /// Whether the frame is that of the mean tangents, not a stand-in.
    is_skew: bool,
    /// ρ; large where the patch has to be split for another reason.
    pub distortion: f64,
    /// The axis whose halving helps most.
    pub split_axis: usize,
    /// Whether, along u and along v, one side is shorter than [`TAPER`] of the one across from it.
    pub tapers: [bool; 2],
    /// Diagonal of the control points' box.
    pub size: f64,
}

/// The Cartesian control points.
fn points(patch: &BezierPatch) -> Vec<DVec3> {
    patch.points.iter().map(|p| p.point()).collect()
}

/// A box around the patch.
pub(super) fn bounds(patch: &BezierPatch) -> Aabb {
    Aabb::around(patch.points.iter().map(|p| p.point()))
}

/// The sides that are one point, as [`point_side`]s.
pub(super) fn point_sides(patch: &BezierPatch) -> u32 {
    let [p, q] = patch.degrees;
    let cartesian = points(patch);
    let farthest = cartesian.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let is_point = |axis: usize, end: usize| {
        let fixed = end * patch.degrees[axis];
        let at = |k: usize| cartesian[if axis == 0 { fixed * (q + 1) + k } else { k * (q + 1) + fixed }];
        (1..=patch.degrees[1 - axis]).all(|k| at(k).distance(at(0)) <= farthest * ONE_POINT)
    };
    debug_assert_eq!(cartesian.len(), (p + 1) * (q + 1));
    [(0, 0), (0, 1), (1, 0), (1, 1)]
        .into_iter()
        .filter(|&(axis, end)| is_point(axis, end))
        .fold(0, |sides, (axis, end)| sides | point_side(axis, end))
}

/// Fits the frame of mean tangents.
pub(super) fn fit(patch: &BezierPatch) -> Fit {
    let [p, q] = patch.degrees;
    let cartesian = points(patch);
    let at = |i: usize, j: usize| cartesian[i * (q + 1) + j];
    let size = bounds(patch).diagonal();
    let mean_u = (0..=q).map(|j| at(p, j) - at(0, j)).sum::<DVec3>() / (q + 1) as f64;
    let mean_v = (0..=p).map(|i| at(i, q) - at(i, 0)).sum::<DVec3>() / (p + 1) as f64;
    let (length_u, length_v) = (mean_u.length(), mean_v.length());

    let second = |along: usize| {
        let (di, dj) = if along == 0 { (1, 0) } else { (0, 1) };
        let mut most = 0.0f64;
        for i in 0..=p - (2 * di).min(p) {
            for j in 0..=q - (2 * dj).min(q) {
                if i + 2 * di <= p && j + 2 * dj <= q {
                    let bend = at(i + 2 * di, j + 2 * dj) - at(i + di, j + dj) * 2.0 + at(i, j);
                    most = most.max(bend.length());
                }
            }
        }
        let degree = patch.degrees[along] as f64;
        most * degree * (degree - 1.0) * 0.125
    };
    let (bend_u, bend_v) = (second(0), second(1));
    let twist = (0..p)
        .flat_map(|i| (0..q).map(move |j| (i, j)))
        .map(|(i, j)| (at(i + 1, j + 1) - at(i + 1, j) - at(i, j + 1) + at(i, j)).length())
        .fold(0.0, f64::max)
        * (p * q) as f64
        * 0.25;
    let mut split_axis = usize::from(bend_v > bend_u);
    let sides = side_lengths(patch, &cartesian);
    let narrows = |axis: usize, ratio: f64| {
        let [first, last] = sides[axis];
        first.min(last) <= ratio * first.max(last)
    };
    let pole = (0..2).find(|&axis| narrows(axis, POLE_RATIO));
    let tapers = [0, 1].map(|axis| narrows(axis, TAPER));
    let longer = || usize::from(polygon_length(patch, &cartesian, 1) > polygon_length(patch, &cartesian, 0));
    if pole.is_none() && twist > bend_u.max(bend_v) {
        split_axis = longer();
    }

    let sine = mean_u.cross(mean_v).length();
    let is_skew =
        length_u.min(length_v) > size * MIN_TANGENT && sine > MIN_SINE * length_u * length_v && size > 0.0;
    let tangents = if is_skew { [mean_u, mean_v] } else { stand_in(mean_u, mean_v, size) };
    let mut distortion = 1.0;
    if is_skew {
        let dual = dual_rows(tangents);
        let middle = (at(0, 0) + at(p, 0) + at(0, q) + at(p, q)) * 0.25;
        let mut worst = [0.0f64; 3];
        for i in 0..=p {
            for j in 0..=q {
                let local = dual * (at(i, j) - middle);
                let expected = [i as f64 / p as f64 - 0.5, j as f64 / q as f64 - 0.5, 0.0];
                for k in 0..3 {
                    worst[k] = worst[k].max((local[k] - expected[k]).abs());
                }
            }
        }
        if let Some(axis) = pole {
            // A triangle's width falls from 1½ to 0 in units of its mean; that part never changes.
            worst[1 - axis] = (worst[1 - axis] - 0.5).max(0.0);
        }
        distortion = worst[0].max(worst[1]).max(worst[2] / length_u.min(length_v));
    } else if pole.is_none() {
        // Slender, or closed in itself: the mean tangent of a closed direction vanishes, but its polygon does not.
        split_axis = longer();
    }
    if let Some(axis) = weight_axis(patch) {
        (distortion, split_axis) = (distortion.max(1.0), axis);
    }
    Fit { tangents, is_skew, distortion, split_axis, tapers, size }
}

/// The length of the control polygons along an axis, all together, for comparing one axis with the other: divided by their number.
fn polygon_length(patch: &BezierPatch, cartesian: &[DVec3], axis: usize) -> f64 {
    let [p, q] = patch.degrees;
    let step = if axis == 0 { q + 1 } else { 1 };
    let continues = |index: usize| if axis == 0 { index / (q + 1) < p } else { index % (q + 1) < q };
    let total: f64 = (0..cartesian.len())
        .filter(|&index| continues(index))
        .map(|index| cartesian[index].distance(cartesian[index + step]))
        .sum();
    total / (patch.degrees[1 - axis] + 1) as f64
}

/// The lengths of the control polygons at both ends of u and of v.
fn side_lengths(patch: &BezierPatch, cartesian: &[DVec3]) -> [[f64; 2]; 2] {
    let [p, q] = patch.degrees;
    let side = |axis: usize, end: usize| {
        let fixed = end * patch.degrees[axis];
        let along = patch.degrees[1 - axis];
        let at = |k: usize| {
            if axis == 0 { cartesian[fixed * (q + 1) + k] } else { cartesian[k * (q + 1) + fixed] }
        };
        (1..=along).map(|k| at(k).distance(at(k - 1))).sum::<f64>()
    };
    debug_assert_eq!(cartesian.len(), (p + 1) * (q + 1));
    [0, 1].map(|axis| [0, 1].map(|end| side(axis, end)))
}

/// The axis along whose rows weights differ most, where they differ too much. Ends alone do not tell: the weights of an arc of nearly half a turn are equal
/// there, and near 0 between them.
fn weight_axis(patch: &BezierPatch) -> Option<usize> {
    let [p, q] = patch.degrees;
    let ratio = |weights: &mut dyn Iterator<Item = f64>| {
        let (least, most) = weights.fold((f64::INFINITY, 0.0f64), |(a, b), w| (a.min(w), b.max(w)));
        most / least
    };
    let at = |i: usize, j: usize| patch.points[i * (q + 1) + j].w;
    if ratio(&mut patch.points.iter().map(|point| point.w)) <= MAX_WEIGHT_RATIO {
        return None;
    }
    let along_u = (0..=q).map(|j| ratio(&mut (0..=p).map(|i| at(i, j)))).fold(1.0, f64::max);
    let along_v = (0..=p).map(|i| ratio(&mut (0..=q).map(|j| at(i, j)))).fold(1.0, f64::max);
    Some(usize::from(along_v > along_u))
}

/// Orthogonal tangents of the patch's size where its own span no plane.
fn stand_in(mean_u: DVec3, mean_v: DVec3, size: f64) -> [DVec3; 2] {
    let longest = if mean_u.length() >= mean_v.length() { mean_u } else { mean_v };
    let other = if mean_u.length() >= mean_v.length() { mean_v } else { mean_u };
    let first = longest.try_normalize().unwrap_or(DVec3::X);
    let across = other - first * other.dot(first);
    // What roundings leave of parallel tangents has any direction, along the first too.
    let spans = across.length() > other.length() * PARALLEL;
    let second = across.try_normalize().filter(|_| spans).unwrap_or_else(|| first.any_orthonormal_vector());
    // A patch that is a point still needs a frame that single precision can invert.
    let length = size.max(1e-9);
    [first * length, second * length]
}

/// Rows that give α, β and γ (along the unit normal) of a vector.
fn dual_rows([a, b]: [DVec3; 2]) -> DMat3 {
    let n = a.cross(b);
    let square = n.length_squared();
    DMat3::from_cols(b.cross(n) / square, n.cross(a) / square, n / square.sqrt()).transpose()
}

/// The leaf record of a patch in face space; net, domain and trim are left 0.
pub(super) fn leaf(patch: &BezierPatch, fit: &Fit) -> NetLeaf {
    let narrow_tangents = fit.tangents.map(narrow::vector);
    let tangents = narrow_tangents.map(|v| DVec3::from_array(v.map(f64::from)));
    let dual = dual_rows(tangents);
    let cartesian = points(patch);
    let local = Aabb::around(cartesian.iter().map(|&p| dual * p));
    let normal = tangents[0].cross(tangents[1]).normalize_or_zero();
    let middle = local.center();
    let center = narrow::vector(tangents[0] * middle.x + tangents[1] * middle.y + normal * middle.z);
    let exact_center = dual * DVec3::from_array(center.map(f64::from));
    let reach = (local.max - exact_center).max(exact_center - local.min);
    // Control points and centre are rounded by 2⁻²⁴ of their coordinates each, per axis; twice that for the sum, √3 < 2 for the axes.
    let farthest = cartesian.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let rounding = farthest * 2f64.powi(-22);
    let slack = |row: usize, relative: f64| dual.row(row).length() * rounding + relative;
    let shortest = tangents[0].length().min(tangents[1].length());
    NetLeaf {
        center,
        extent_n: narrow::above(reach.z + rounding + shortest * 2f64.powi(-20)),
        tangent_u: narrow_tangents[0],
        extent_u: narrow::above(reach.x - 0.5 + slack(0, 2f64.powi(-20))),
        tangent_v: narrow_tangents[1],
        extent_v: narrow::above(reach.y - 0.5 + slack(1, 2f64.powi(-20))),
        certificate: certificate(patch, fit, &dual, tangents),
        domain: 0,
        net: 0,
        trim: 0,
    }
}

/// Makes the slab hold what lies within `slack` of it, millimetres.
pub(super) fn grow(leaf: &mut NetLeaf, slack: f64) {
    let tangents = [leaf.tangent_u, leaf.tangent_v].map(|v| DVec3::from_array(v.map(f64::from)));
    let dual = dual_rows(tangents);
    let grown = |extent: f32, by: f64| narrow::above(f64::from(extent) + by);
    leaf.extent_u = grown(leaf.extent_u, slack * dual.row(0).length());
    leaf.extent_v = grown(leaf.extent_v, slack * dual.row(1).length());
    leaf.extent_n = grown(leaf.extent_n, slack);
}

/// The bytes E_α, E_β, E_γ and M.
fn certificate(patch: &BezierPatch, fit: &Fit, dual: &DMat3, tangents: [DVec3; 2]) -> u32 {
    // For the roundings of the record's own numbers, as in the extents.
    const SLACK: f64 = 1.0 / 4096.0;
    let shortest = tangents[0].length().min(tangents[1].length());
    let second = second_derivatives(patch) / shortest;
    // The frame of a stand-in says nothing of the tangents.
    let first = if fit.is_skew { deviations(patch, dual, shortest) } else { [f64::INFINITY; 3] };
    let contraction = first
        .into_iter()
        .enumerate()
        .fold(0, |word, (byte, bound)| word | narrow::bound_byte(bound + SLACK) << (8 * byte));
    contraction | bend_byte(narrow::above(second + SLACK)) << 24
}

/// Bounds of E_α, E_β and E_γ.
fn deviations(patch: &BezierPatch, dual: &DMat3, shortest: f64) -> [f64; 3] {
    let is_rational = patch.points.iter().any(|p| p.w != patch.points[0].w);
    let has_products = is_rational && patch.points.len() <= MAX_PRODUCT_POINTS;
    // About the middle, so that numerators are small where the patch is far from the origin.
    let middle = bounds(patch).center();
    let weight = Tensor::new(patch.degrees, patch.points.iter().map(|p| p.w).collect());
    let least = least_weight(patch);
    // α, β and γ times the weight.
    let numerator_of = |p: &DVec4| (*dual * (p.truncate() - middle * p.w)).extend(0.0);
    let numerators = Tensor::new(patch.degrees, patch.points.iter().map(numerator_of).collect());
    let reach = || patch.points.iter().map(|p| numerator_of(p) / p.w).fold(DVec4::ZERO, Value::greatest);
    let square = has_products.then(|| weight.times(&weight));
    // max |∂x − target| of each coordinate.
    let deviation = |along: usize| {
        let target = DVec4::AXES[along];
        let slopes = numerators.derivative(along);
        if !is_rational {
            return slopes.farthest_from(target * least) / least;
        }
        let weight_slope = weight.derivative(along);
        let Some(square) = &square else {
            // x_s − target = (X_s − target w − x w_s) / w, each term bounded by itself.
            let off = slopes.minus(weight.scaled_by(target)).farthest_from(DVec4::ZERO);
            return (off + reach() * weight_slope.farthest_from(0.0)) / least;
        };
        let quotients = slopes.times(&weight).minus(numerators.times(&weight_slope));
        quotients.minus(square.scaled_by(target)).farthest_from(DVec4::ZERO) / (least * least)
    };
    let sum = deviation(0) + deviation(1);
    [sum.x, sum.y, sum.z / shortest]
}

/// The least of a patch's weights, below which the weight never falls.
fn least_weight(patch: &BezierPatch) -> f64 {
    patch.points.iter().map(|p| p.w).fold(f64::INFINITY, f64::min)
}

/// A bound of `|S_ss| + 2 |S_st| + |S_tt|`.
///
/// With `S = X / w` about some point: `S_st = (X_st − w_s S_t − w_t S_s − w_st S) / w`, `S_s = (X_s − w_s S) / w`, each term bounded by itself. That point is the
/// middle, or a side that is one point: all terms of S_ss along it then fall to 0 towards it as `render::cpu::isolate` says, where S itself is bounded by
/// its numerator too.
fn second_derivatives(patch: &BezierPatch) -> f64 {
    let pole = pole(patch);
    let about = pole.unwrap_or_else(|| bounds(patch).center());
    // S times the weight, and the weight.
    let numerator_of = |p: &DVec4| (p.truncate() - about * p.w).extend(p.w);
    let numerators = Tensor::new(patch.degrees, patch.points.iter().map(numerator_of).collect());
    let least = least_weight(patch);
    let size = |p: &DVec4| {
        let distance = p.point().distance(about);
        if pole.is_some() { distance * (p.w / least) } else { distance }
    };
    let radius = patch.points.iter().map(size).fold(0.0, f64::max);
    let slopes = [0, 1].map(|along| numerators.derivative(along));
    let greatest = slopes.clone().map(|slopes| slopes.farthest_from(DVec4::ZERO));
    let first = greatest.map(|x| (x.truncate().length() + x.w * radius) / least);
    let second = |a: usize, b: usize| {
        let x = slopes[a].derivative(b).farthest_from(DVec4::ZERO);
        (x.truncate().length() + greatest[a].w * first[b] + greatest[b].w * first[a] + x.w * radius) / least
    };
    second(0, 0) + 2.0 * second(0, 1) + second(1, 1)
}

/// The first of the sides that are one point, in the order of `render::cpu::isolate::leaf_pole`.
fn pole(patch: &BezierPatch) -> Option<DVec3> {
    let sides = point_sides(patch);
    let corner = |axis: usize, end: usize| {
        if axis == 0 { end * patch.degrees[0] * (patch.degrees[1] + 1) } else { end * patch.degrees[1] }
    };
    [(0, 0), (0, 1), (1, 0), (1, 1)]
        .into_iter()
        .find(|&(axis, end)| sides & point_side(axis, end) != 0)
        .map(|(axis, end)| patch.points[corner(axis, end)].point())
}

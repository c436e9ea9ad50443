//! Parallel boxing (Sloup and Havran 2021, section 3.2): a slab along the diagonal of a curve's box that holds the curve.
//!
//! The extrema of the distance are not rounded roots of its derivative but certified bounds: on a part of a curve with positive weights the distance is a
//! convex combination of those of the control points. Parts are halved until the bound is met within a small share of a step.

use crate::geometry::Homogeneous2;
use crate::numeric::bernstein::{Coefficients, split};
use crate::scene::trim_study::{SLAB_MASK, SLAB_STEPS, pack_slab};

/// Bounds are this close, in steps.
const TOLERANCE: f64 = 0.125;

/// More for what f32 rounds in a query: the distance is a difference of two products of numbers up to the longer side, each with three roundings,
/// 2⁻²¹ of its square together, a sixty-fourth of a step.
const ROUNDING: f64 = 1.0 / 16.0;

/// Halvings of a curve: a distance that is not flat meets its bound in ten.
const MAX_HALVINGS: usize = 40;

/// The slab of the curves from `low` to `high`, which are monotone in u and v.
pub(super) fn slab_word(low: [f32; 2], high: [f32; 2], curves: &[&[Homogeneous2]]) -> u32 {
    let [u, v] = low.map(f64::from);
    let (du, dv) = (f64::from(high[0]) - u, f64::from(high[1]) - v);
    let longer = du.abs().max(dv);
    if !(longer > 0.0) {
        return 0;
    }
    let step = longer * longer / f64::from(SLAB_STEPS);
    let distances: Vec<Part> = curves
        .iter()
        .map(|points| Part {
            distance: points.iter().map(|p| ((p.x - u * p.z) * dv - (p.y - v * p.z) * du) / step).collect(),
            weight: points.iter().map(|p| p.z).collect(),
        })
        .collect();
    let [left, right] = [-1.0, 1.0].map(|sign| {
        let bound = greatest(&distances, sign);
        ((bound + ROUNDING).floor() as u32 + 1).min(SLAB_MASK)
    });
    pack_slab(left, right)
}

/// Distance times weight, and weight, of a part of a curve.
struct Part {
    distance: Coefficients,
    weight: Coefficients,
}

impl Part {
    fn at_end(&self, end: usize, sign: f64) -> f64 {
        sign * self.distance[end] / self.weight[end]
    }

    fn bound(&self, sign: f64) -> f64 {
        (0..self.weight.len()).map(|i| self.at_end(i, sign)).fold(f64::NEG_INFINITY, f64::max)
    }
}

/// An upper bound of `sign` times the distance, 0 at least: the ends lie on the diagonal.
fn greatest(curves: &[Part], sign: f64) -> f64 {
    let mut met = 0.0_f64;
    let mut certain = 0.0_f64;
    let mut open: Vec<(Part, usize)> = Vec::new();
    for curve in curves {
        open.push((Part { distance: curve.distance.clone(), weight: curve.weight.clone() }, 0));
    }
    while let Some((part, halvings)) = open.pop() {
        met = met.max(part.at_end(0, sign)).max(part.at_end(part.weight.len() - 1, sign));
        let bound = part.bound(sign);
        if bound <= met + TOLERANCE || halvings == MAX_HALVINGS {
            certain = certain.max(bound.min(2.0 * f64::from(SLAB_STEPS)));
            continue;
        }
        let [d0, d1] = split(&part.distance, 0.5);
        let [w0, w1] = split(&part.weight, 0.5);
        open.push((Part { distance: d0, weight: w0 }, halvings + 1));
        open.push((Part { distance: d1, weight: w1 }, halvings + 1));
    }
    certain.max(met)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::trim_study::unpack_slab;
    use glam::DVec3;

    #[test]
    fn slabs_are_tight_and_hold_the_curve() {
        // A quarter of the unit circle, falling from (0, 1): its middle is (√2 − 1) / √2 right of the chord.
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let points = [DVec3::new(1.0, 0.0, 1.0), DVec3::new(half, half, half), DVec3::new(0.0, 1.0, 1.0)];
        let [left, right] = unpack_slab(slab_word([1.0, 0.0], [0.0, 1.0], &[&points]));
        let expected = (std::f64::consts::SQRT_2 - 1.0) * f64::from(SLAB_STEPS);
        assert_eq!(left, 1);
        assert!((0.0..2.0).contains(&(f64::from(right) - expected)), "{right} {expected}");
        let line = [DVec3::new(0.0, 0.0, 1.0), DVec3::new(1.0, 0.001, 1.0)];
        assert_eq!(slab_word([0.0, 0.0], [1.0, 0.001], &[&line]), pack_slab(1, 1));
    }
}

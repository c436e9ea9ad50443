//! From f64 to f32: the only file of the bake that narrows.
//!
//! Positions become a whole number of grid steps (i32, exact) and a fraction. With a step g, a power of two, and `|x| <= 2^30 g`, the pair
//! stands for `x` within `2⁻²⁵ g` per axis: `x / g` is exact, the fraction `x − round(x / g) · g` is exact in f64 (Sterbenz, both are multiples of one
//! ulp and close) and at most `g / 2`, so that rounding it to f32 costs at most half an ulp of `g / 2`, which is `2⁻²⁵ g`.
//! Control points relative to a face's origin are off by at most `2⁻²⁴` of their distance from it per axis. Boxes round outward, so that
//! a box in f32 holds every point of the box in f64.

use crate::numeric::Aabb;
use glam::{DMat3, DVec2, DVec3, DVec4};

/// Grid coordinates have at most this many steps: sums and differences of two fit into an i32.
pub(super) const MAX_STEPS: f64 = (1u32 << 30) as f64;

/// A position in grid steps and a rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct GridPoint {
    /// Steps.
    pub grid: [i32; 3],
    /// Millimetres, at most half a step.
    pub fraction: [f32; 3],
}

/// The grid step of a scene of the given size (millimetres): a power of two near 2⁻¹⁶ of it.
pub(super) fn grid_step(scene_size: f64) -> f64 {
    // Sizes outside of 2^±80 mm are held there, so that squares of steps are normal f32 numbers.
    let exponent = if scene_size > 0.0 { scene_size.log2().ceil().clamp(-40.0, 80.0) } else { 0.0 };
    (exponent - 16.0).exp2()
}

/// `point` moved to the nearest grid point.
pub(super) fn snap(point: DVec3, step: f64) -> DVec3 {
    (point / step).round() * step
}

/// `point` as grid steps and a fraction; nothing where it is too far out.
pub(super) fn grid_point(point: DVec3, step: f64) -> Option<GridPoint> {
    let steps = (point / step).round();
    if !(steps.abs().max_element() <= MAX_STEPS) {
        return None;
    }
    Some(GridPoint { grid: steps.as_ivec3().to_array(), fraction: vector(point - steps * step) })
}

/// The nearest f32 vector.
pub(super) fn vector(v: DVec3) -> [f32; 3] {
    v.as_vec3().to_array()
}

/// The nearest f32 pair.
pub(super) fn pair(v: DVec2) -> [f32; 2] {
    v.as_vec2().to_array()
}

/// The nearest f32 homogeneous point.
pub(super) fn homogeneous(v: DVec4) -> [f32; 4] {
    v.as_vec4().to_array()
}

/// The rows of a matrix.
pub(super) fn rows(matrix: &DMat3) -> [[f32; 3]; 3] {
    [0, 1, 2].map(|i| vector(matrix.row(i)))
}

/// The nearest f32.
pub(super) fn number(x: f64) -> f32 {
    x as f32
}

/// The greatest f32 not above `x`.
pub(super) fn below(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) > x { near.next_down() } else { near }
}

/// The least f32 not below `x`.
pub(super) fn above(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) < x { near.next_up() } else { near }
}

/// Coordinates reach no farther than this, millimetres: a BVH's costs are areas times numbers of boxes in f32, and obvhs cannot go on once they
/// overflow. 1e28 times 2³¹ boxes stays below the greatest f32; a hundred million kilometres are enough for any model.
pub(super) const FARTHEST: f64 = 1e14;

/// Whether all of a box is within [`FARTHEST`].
pub(super) fn is_within_reach(bounds: &Aabb) -> bool {
    bounds.min.abs().max(bounds.max.abs()).max_element() <= FARTHEST
}

/// Lower and upper corner of a box that holds `bounds` grown by `margin`; nothing where that is empty or beyond [`FARTHEST`].
pub(super) fn outward(bounds: Aabb, margin: f64) -> Option<[[f32; 3]; 2]> {
    if bounds.is_empty() {
        return None;
    }
    let grown = bounds.grown(margin);
    is_within_reach(&grown).then(|| [grown.min.to_array().map(below), grown.max.to_array().map(above)])
}

/// The least multiple of 1/64 in 0..=254 that is not below `bound`, in units of 1/64; 255 where there is none.
pub(super) fn bound_byte(bound: f64) -> u32 {
    let units = (bound * 64.0).ceil();
    if (0.0..=254.0).contains(&units) { units as u32 } else { 255 }
}

#[cfg(test)]
mod tests {
    use super::super::trim_tests::Random;
    use super::*;

    #[test]
    fn grid_points_stand_for_the_point_within_the_stated_bound() {
        let mut random = Random(1);
        for _ in 0..10_000 {
            let size = 10f64.powf(12.0 * random.next() - 6.0);
            let step = grid_step(size);
            assert!(step >= size / 65536.0 && step <= size / 32768.0, "{size} {step}");
            let mut coordinate = || (random.next() * 2.0 - 1.0) * size * 8.0;
            let p = DVec3::new(coordinate(), coordinate(), coordinate());
            let g = grid_point(p, step).expect("within the grid");
            for k in 0..3 {
                let back = f64::from(g.grid[k]) * step + f64::from(g.fraction[k]);
                assert!((back - p[k]).abs() <= step * 2f64.powi(-25));
                assert!(f64::from(g.fraction[k].abs()) <= step * 0.5);
            }
        }
    }

    #[test]
    fn far_and_odd_points_have_no_grid_point() {
        assert!(grid_point(DVec3::splat(f64::NAN), 1.0).is_none());
        assert!(grid_point(DVec3::X * 1e300, 1.0).is_none());
        assert!(grid_point(DVec3::X * 2e9, 1.0).is_none());
    }

    #[test]
    fn boxes_round_outward() {
        let mut random = Random(2);
        for _ in 0..10_000 {
            let x = (random.next() * 2.0 - 1.0) * 1e9;
            let size = random.next() * 1e9;
            let bounds = Aabb { min: DVec3::splat(x), max: DVec3::splat(x + size) };
            let [low, high] = outward(bounds, 0.0).expect("finite");
            assert!(f64::from(low[0]) <= x && f64::from(high[2]) >= x + size);
            assert!(f64::from(low[0].next_up()) > x && f64::from(high[2].next_down()) < x + size);
        }
        assert!(outward(Aabb::EMPTY, 1.0).is_none());
        assert!(outward(Aabb { min: DVec3::ZERO, max: DVec3::splat(1e39) }, 1.0).is_none());
        assert!(outward(Aabb { min: DVec3::NAN, max: DVec3::NAN }, 1.0).is_none());
    }

    #[test]
    fn bytes_round_up() {
        assert_eq!(bound_byte(0.0), 0);
        assert_eq!(bound_byte(1e-9), 1);
        assert_eq!(bound_byte(254.0 / 64.0), 254);
        assert_eq!(bound_byte(4.0), 255);
        assert_eq!(bound_byte(f64::NAN), 255);
    }
}

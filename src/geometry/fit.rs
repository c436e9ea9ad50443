//! Surfaces that have no exact form, as B-splines: polynomial pieces of degree 6 on a grid of cells.
//!
//! Each cell interpolates at the products of Chebyshev–Lobatto points, whose error is near that of the best polynomial and
//! falls by 2⁷ with each halving where the function is smooth. The points include the ends of a cell, so neighbours
//! share their boundary row of points and with it the boundary curve.

use super::bezier::{Homogeneous, Homogeneous3};
use super::bspline::BsplineSurface;
use super::knots::KnotVector;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

pub(super) const DEGREE: usize = 6;
pub(super) const WIDTH: usize = DEGREE + 1;
/// A cell has 49 control points of 32 bytes: at most 6 MB a surface.
const MAX_CELLS: usize = 4096;

/// A fitted surface and how far it is from what it stands for.
#[derive(Debug, Clone)]
pub struct Fit {
    /// Over the same parameters.
    pub surface: BsplineSurface,
    /// The greatest distance at the check points, the middles between interpolated ones.
    pub deviation: f64,
}

/// The function `point` of (u, v) over the cells between `u_breaks` and `v_breaks` (ascending, inside of which it is smooth),
/// halved until all check points are closer than `tolerance`, or the cells are too many: then the deviation is larger.
/// `None` where the function is, or the breaks are too many.
pub fn fit_surface(
    u_breaks: &[f64],
    v_breaks: &[f64],
    point: impl Fn(DVec2) -> Option<DVec3>,
    tolerance: f64,
) -> Option<Fit> {
    let interpolation = Interpolation::new();
    let mut breaks = [u_breaks.to_vec(), v_breaks.to_vec()];
    let mut best: Option<Fit> = None;
    while (breaks[0].len() - 1) * (breaks[1].len() - 1) <= MAX_CELLS {
        let (fit, errors) = fit_cells(&interpolation, &breaks, &point)?;
        let done = fit.deviation <= tolerance;
        if best.as_ref().is_none_or(|best| fit.deviation < best.deviation) {
            best = Some(fit);
        }
        if done {
            break;
        }
        // The axis along which the fit is worse; both where they are much alike.
        for axis in [0, 1] {
            if errors[axis] > 0.25 * errors[1 - axis] {
                breaks[axis] = halved(&breaks[axis]);
            }
        }
    }
    best
}

fn halved(breaks: &[f64]) -> Vec<f64> {
    let between = breaks.windows(2).flat_map(|w| [w[0], 0.5 * (w[0] + w[1])]);
    between.chain(breaks.last().copied()).collect()
}

/// The fit on given cells, and the greatest errors between points that lie on one line along u, and along v.
fn fit_cells(
    interpolation: &Interpolation,
    breaks: &[Vec<f64>; 2],
    point: &impl Fn(DVec2) -> Option<DVec3>,
) -> Option<(Fit, [f64; 2])> {
    let cells = [breaks[0].len() - 1, breaks[1].len() - 1];
    let count_v = cells[1] * DEGREE + 1;
    let mut points = vec![Homogeneous3::ZERO; (cells[0] * DEGREE + 1) * count_v];
    for a in 0..cells[0] {
        for b in 0..cells[1] {
            let at = |s: f64, t: f64| {
                let mix = |breaks: &[f64], i: usize, s: f64| breaks[i] * (1.0 - s) + breaks[i + 1] * s;
                DVec2::new(mix(&breaks[0], a, s), mix(&breaks[1], b, t))
            };
            let mut values = [[DVec3::ZERO; WIDTH]; WIDTH];
            for (i, row) in values.iter_mut().enumerate() {
                for (j, value) in row.iter_mut().enumerate() {
                    *value = point(at(interpolation.nodes[i], interpolation.nodes[j]))?;
                }
            }
            let control = interpolation.control_points(&values);
            for (i, row) in control.iter().enumerate() {
                for (j, p) in row.iter().enumerate() {
                    points[(a * DEGREE + i) * count_v + b * DEGREE + j] = Homogeneous::new(*p, 1.0);
                }
            }
        }
    }
    let knots = [0, 1].map(|axis| knots_of(&breaks[axis]));
    let surface = BsplineSurface::new([DEGREE; 2], knots, points).ok()?;
    let mut errors = [0.0_f64; 2];
    let mut deviation = 0.0_f64;
    let between = |breaks: &[f64]| -> Vec<f64> {
        let middle = |w: &[f64]| {
            let w = [w[0], w[1]];
            let nodes = interpolation.nodes;
            (0..DEGREE).map(move |i| w[0] + (w[1] - w[0]) * 0.5 * (nodes[i] + nodes[i + 1]))
        };
        breaks.windows(2).flat_map(middle).collect()
    };
    let (us, vs) = (between(&breaks[0]), between(&breaks[1]));
    for &u in &us {
        for &v in &vs {
            let uv = DVec2::new(u, v);
            deviation = deviation.max(surface.point(uv).distance(point(uv)?));
        }
        for &v in &breaks[1] {
            let uv = DVec2::new(u, v);
            errors[0] = errors[0].max(surface.point(uv).distance(point(uv)?));
        }
    }
    for &v in &vs {
        for &u in &breaks[0] {
            let uv = DVec2::new(u, v);
            errors[1] = errors[1].max(surface.point(uv).distance(point(uv)?));
        }
    }
    deviation = deviation.max(errors[0]).max(errors[1]);
    deviation.is_finite().then_some((Fit { surface, deviation }, errors))
}

pub(super) fn knots_of(breaks: &[f64]) -> Vec<f64> {
    let last = breaks.len() - 1;
    let times = |i: usize| if i == 0 || i == last { DEGREE + 1 } else { DEGREE };
    breaks.iter().enumerate().flat_map(|(i, knot)| std::iter::repeat_n(*knot, times(i))).collect()
}

/// The breaks of a fit: the distinct knots.
pub fn breaks_of(knots: &KnotVector) -> Vec<f64> {
    let [first, last] = knots.domain();
    [first].into_iter().chain(knots.inner_knots().map(|(knot, _)| knot)).chain([last]).collect()
}

pub(super) struct Interpolation {
    /// Chebyshev–Lobatto points of [0, 1].
    pub(super) nodes: [f64; WIDTH],
    /// From values at the nodes to Bézier points: the inverse of the Bernstein polynomials there.
    inverse: [[f64; WIDTH]; WIDTH],
}

impl Interpolation {
    pub(super) fn new() -> Self {
        const BINOMIALS: [f64; WIDTH] = [1.0, 6.0, 15.0, 20.0, 15.0, 6.0, 1.0];
        let nodes: [f64; WIDTH] = std::array::from_fn(|i| 0.5 - 0.5 * (PI * i as f64 / DEGREE as f64).cos());
        let bernstein = |t: f64| -> [f64; WIDTH] {
            std::array::from_fn(|i| BINOMIALS[i] * t.powi(i as i32) * (1.0 - t).powi((DEGREE - i) as i32))
        };
        let mut matrix = nodes.map(bernstein);
        let mut inverse: [[f64; WIDTH]; WIDTH] =
            std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
        // Gauss–Jordan without pivots: the matrix is totally positive.
        for i in 0..WIDTH {
            let pivot = matrix[i][i];
            matrix[i] = matrix[i].map(|value| value / pivot);
            inverse[i] = inverse[i].map(|value| value / pivot);
            let (pivot_row, pivot_inverse) = (matrix[i], inverse[i]);
            for row in (0..WIDTH).filter(|row| *row != i) {
                let factor = matrix[row][i];
                for k in 0..WIDTH {
                    matrix[row][k] -= factor * pivot_row[k];
                    inverse[row][k] -= factor * pivot_inverse[k];
                }
            }
        }
        Self { nodes, inverse }
    }

    fn control_points(&self, values: &[[DVec3; WIDTH]; WIDTH]) -> [[DVec3; WIDTH]; WIDTH] {
        let rows: [[DVec3; WIDTH]; WIDTH] = std::array::from_fn(|i| self.row(values[i]));
        let columns: [[DVec3; WIDTH]; WIDTH] =
            std::array::from_fn(|j| self.row(std::array::from_fn(|i| rows[i][j])));
        std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i]))
    }

    pub(super) fn row(&self, values: [DVec3; WIDTH]) -> [DVec3; WIDTH] {
        let mut points: [DVec3; WIDTH] = std::array::from_fn(|i| {
            values.iter().zip(self.inverse[i]).map(|(value, share)| *value * share).sum()
        });
        // Neighbouring cells meet exactly.
        (points[0], points[DEGREE]) = (values[0], values[DEGREE]);
        points
    }
}

//! Polar forms: the one tool behind clamping, sub-ranges and Bézier decomposition.
//!
//! The blossom `f(x_1, …, x_p)` of a polynomial piece of degree p is symmetric, affine in each argument and equal to the
//! piece on its diagonal. Every control point of every B-spline or Bézier form of that piece is a value of it: for knots
//! `u`, point i is `f(u_{i+1}, …, u_{i+p})` (Ramshaw 1987). De Boor's triangle for the parameter x replaces one argument
//! a row by x, and its two outer edges are the control points of the piece clamped at x (that is what Boehm's and
//! Oslo knot insertion, The NURBS Book A5.1 to A5.6, come to). All its steps are convex combinations where x lies in the
//! span, so positive weights stay positive.

use super::bezier::Homogeneous;
use super::knots::{KnotError, KnotVector};

const MAX_POINTS: usize = KnotVector::MAX_DEGREE + 1;

/// Control points of one span and the `2 · degree` knots around it, copied out of a curve.
struct Span<P> {
    degree: usize,
    points: [P; MAX_POINTS],
    knots: [f64; 2 * KnotVector::MAX_DEGREE],
}

impl<P: Homogeneous> Span<P> {
    /// The non-empty span `k`.
    fn new(degree: usize, knots: &[f64], points: &[P], k: usize) -> Self {
        let mut span =
            Self { degree, points: [P::default(); MAX_POINTS], knots: [0.0; 2 * KnotVector::MAX_DEGREE] };
        span.points[..=degree].copy_from_slice(&points[k - degree..=k]);
        span.knots[..2 * degree].copy_from_slice(&knots[k + 1 - degree..=k + degree]);
        span
    }

    /// Row `r` of de Boor's triangle for the parameter `x`, in place.
    fn step(&mut self, r: usize, x: f64) {
        for j in 0..self.degree - r {
            let (low, high) = (self.knots[r + j], self.knots[self.degree + j]);
            let share = (x - low) / (high - low);
            self.points[j] = self.points[j] * (1.0 - share) + self.points[j + 1] * share;
        }
    }

    /// Clamps the start at `x`: the right edge of the triangle, which its rows leave in place.
    fn clamp_start(&mut self, x: f64) {
        for r in 0..self.degree {
            self.step(r, x);
        }
        self.knots[..self.degree].fill(x);
    }

    /// Clamps the end at `x`: the left edge of the triangle.
    fn clamp_end(&mut self, x: f64) {
        let mut edge = self.points;
        for r in 0..self.degree {
            self.step(r, x);
            edge[r + 1] = self.points[0];
        }
        self.points = edge;
        self.knots[self.degree..2 * self.degree].fill(x);
    }
}

/// The Bézier points of the piece on the non-empty span `k`, into `out` (`degree + 1` long).
pub(super) fn bezier_points<P: Homogeneous>(
    degree: usize,
    knots: &[f64],
    points: &[P],
    k: usize,
    out: &mut [P],
) {
    let mut span = Span::new(degree, knots, points, k);
    if knots[k - degree..=k].iter().any(|knot| *knot != knots[k]) {
        span.clamp_start(knots[k]);
    }
    if knots[k + 1..=k + 1 + degree].iter().any(|knot| *knot != knots[k + 1]) {
        span.clamp_end(knots[k + 1]);
    }
    out.copy_from_slice(&span.points[..=degree]);
}

/// The same curve from `start` on, clamped there; `start` inside the domain and below its end.
pub(super) fn clamp_start<P: Homogeneous>(
    degree: usize,
    knots: &[f64],
    points: &[P],
    start: f64,
) -> (Vec<f64>, Vec<P>) {
    let above = knots.partition_point(|knot| *knot <= start);
    let k = above.saturating_sub(1).clamp(degree, points.len() - 1);
    if knots[k - degree..=k].iter().all(|knot| *knot == start) {
        return (knots[k - degree..].to_vec(), points[k - degree..].to_vec());
    }
    let mut span = Span::new(degree, knots, points, k);
    span.clamp_start(start);
    let new_knots = std::iter::repeat_n(start, degree + 1).chain(knots[k + 1..].iter().copied()).collect();
    let new_points = span.points[..degree].iter().chain(&points[k..]).copied().collect();
    (new_knots, new_points)
}

/// The same curve up to `end`, clamped there; `end` inside the domain and above its start.
pub(super) fn clamp_end<P: Homogeneous>(
    degree: usize,
    knots: &[f64],
    points: &[P],
    end: f64,
) -> (Vec<f64>, Vec<P>) {
    let (knots, points) = reversed(knots, points);
    let (knots, points) = clamp_start(degree, &knots, &points, -end);
    reversed(&knots, &points)
}

/// The curve run backwards, over the negated parameter.
pub(super) fn reversed<P: Copy>(knots: &[f64], points: &[P]) -> (Vec<f64>, Vec<P>) {
    (knots.iter().rev().map(|knot| -knot).collect(), points.iter().rev().copied().collect())
}

/// Knots and points that obey the invariants of [`KnotVector`], for the same curve; checked input.
///
/// Inner knots of multiplicity above the degree separate two pieces that meet only because the file says so: one of the
/// coinciding control points is dropped, or an error given where they are more than `tolerance` apart.
pub(super) fn clamped<P: Homogeneous>(
    degree: usize,
    knots: &[f64],
    points: &[P],
    tolerance: f64,
) -> Result<(Vec<f64>, Vec<P>), KnotError> {
    let (start, end) = (knots[degree], knots[points.len()]);
    let (knots, points) = clamp_start(degree, knots, points, start);
    let (knots, points) = clamp_end(degree, &knots, &points, end);
    let mut kept_knots: Vec<f64> = Vec::with_capacity(knots.len());
    let mut kept_points = Vec::with_capacity(points.len());
    for (i, point) in points.iter().enumerate() {
        // The start has exactly degree + 1 equal knots by now, so any other such run is an inner one.
        if i > 0 && knots[i] == knots[i + degree] {
            if points[i - 1].separation(*point) > tolerance {
                return Err(KnotError::Discontinuous(i));
            }
            continue;
        }
        kept_knots.push(knots[i]);
        kept_points.push(*point);
    }
    kept_knots.extend_from_slice(&knots[points.len()..]);
    Ok((kept_knots, kept_points))
}

//! Closest points of curves by search.

use super::super::curve::{Curve, CurveDerivatives};
use super::{finished, unwrapped};
use glam::DVec3;

/// Newton's method converges in 3 to 6 steps; kinks and far points take some more.
const MAX_STEPS: usize = 40;
/// A step that still makes the distance grow after this many halvings is below rounding.
const MAX_HALVINGS: usize = 12;
/// Growth of a squared distance that may be rounding: far from the curve the last Newton steps do not show in it.
const ROUNDING: f64 = 1.0 + 4.0 * f64::EPSILON;
/// Polished candidates of a global search.
const MAX_CANDIDATES: usize = 8;
/// Samples of a global search; beyond it, spans are sampled more coarsely.
const MAX_SAMPLES: usize = 20_000;

/// A closed curve: the parameter runs on beyond the domain.
pub(super) fn closed(curve: &Curve, point: DVec3, seed: Option<f64>) -> f64 {
    let domain = curve.domain();
    unwrapped(search(curve, point, seed, None), domain, seed)
}

/// A curve with ends: the parameter is clamped to the domain.
pub(super) fn open(curve: &Curve, point: DVec3, seed: Option<f64>) -> f64 {
    search(curve, point, seed, Some(curve.domain()))
}

fn search(curve: &Curve, point: DVec3, seed: Option<f64>, limits: Option<[f64; 2]>) -> f64 {
    if let Some(seed) = seed.filter(|seed| seed.is_finite()) {
        return polish(curve, point, seed, limits).0;
    }
    let parameters = samples(curve);
    let distances: Vec<f64> = parameters.iter().map(|t| curve.point(*t).distance_squared(point)).collect();
    let last = parameters.len() - 1;
    let lowest = |i: &usize| {
        let (before, after) = match limits {
            Some(_) => (i.saturating_sub(1), (i + 1).min(last)),
            None => ((i + last) % (last + 1), (i + 1) % (last + 1)),
        };
        distances[*i] <= distances[before] && distances[*i] <= distances[after]
    };
    let mut candidates: Vec<usize> = (0..=last).filter(lowest).collect();
    candidates.sort_by(|a, b| distances[*a].total_cmp(&distances[*b]));
    candidates
        .into_iter()
        .take(MAX_CANDIDATES)
        .map(|i| polish(curve, point, parameters[i], limits))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map_or(parameters[0], |(t, _)| t)
}

/// Parameters over the domain, dense enough that each local minimum of the distance shows for points near the curve.
fn samples(curve: &Curve) -> Vec<f64> {
    let even =
        |[a, b]: [f64; 2], count: usize| (0..count).map(move |i| a + (b - a) * (i as f64 / count as f64));
    match curve {
        Curve::Bspline(spline) => {
            let knots = spline.knots.as_slice();
            let spans: Vec<_> = spline.knots.spans().map(|k| [knots[k], knots[k + 1]]).collect();
            let each = (4 * spline.knots.degree()).min(MAX_SAMPLES / spans.len()).max(1);
            let inner = spans.into_iter().flat_map(|span| even(span, each));
            inner.chain([spline.domain()[1]]).collect()
        }
        _ => even(curve.domain(), 32).collect(),
    }
}

/// The parameter of a local minimum of the distance, and its square.
fn polish(curve: &Curve, point: DVec3, start: f64, limits: Option<[f64; 2]>) -> (f64, f64) {
    let domain = curve.domain();
    let limit = |t: f64| limits.map_or(t, |[a, b]| t.clamp(a, b));
    let longest = 0.25 * (domain[1] - domain[0]);
    let mut t = limit(start);
    let mut here = curve.derivatives(t);
    let mut squared = here.point.distance_squared(point);
    let mut moved_before = f64::INFINITY;
    for _ in 0..MAX_STEPS {
        let mut step = newton_step(&here, point).clamp(-longest, longest);
        let mut halvings = 0;
        let advanced = loop {
            let next_t = limit(t + step);
            let next = curve.derivatives(next_t);
            let next_squared = next.point.distance_squared(point);
            if next_squared <= squared * ROUNDING {
                break Some((next_t, next, next_squared));
            }
            halvings += 1;
            if halvings > MAX_HALVINGS {
                break None;
            }
            step *= 0.5;
        };
        let Some((next_t, next, next_squared)) = advanced else { break };
        let moved = (next_t - t).abs() * here.first.length();
        (t, here, squared) = (next_t, next, next_squared);
        if finished(moved, moved_before, here.point.length()) {
            break;
        }
        moved_before = moved;
    }
    (t, squared)
}

/// The step to the stationary point of `|C − P|²`: full Newton where it goes downhill, else Gauss-Newton.
fn newton_step(here: &CurveDerivatives, point: DVec3) -> f64 {
    let off = here.point - point;
    let (slope, square) = (off.dot(here.first), here.first.length_squared());
    let curvature = square + off.dot(here.second);
    let step = -slope / if curvature > 1e-3 * square { curvature } else { square };
    if step.is_finite() { step } else { 0.0 }
}

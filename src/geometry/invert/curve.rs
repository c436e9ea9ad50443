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
    // Each smooth piece is searched by itself: a kink between two minima is no obstacle then.
    let mut candidates: Vec<(f64, f64, [f64; 2])> = Vec::new();
    let pieces = smooth_pieces(curve);
    let most = MAX_SAMPLES / pieces.len();
    for piece in pieces {
        let samples: Vec<_> = samples(curve, piece, most)
            .into_iter()
            .map(|t| (curve.point(t).distance_squared(point), t))
            .collect();
        let last = samples.len() - 1;
        let lowest = |i: &usize| {
            let here = samples[*i].0;
            here <= samples[i.saturating_sub(1)].0 && here <= samples[(i + 1).min(last)].0
        };
        candidates.extend((0..=last).filter(lowest).map(|i| (samples[i].0, samples[i].1, piece)));
    }
    candidates.sort_by(|a, b| a.0.total_cmp(&b.0));
    candidates
        .into_iter()
        .take(MAX_CANDIDATES)
        .map(|(_, t, piece)| polish(curve, point, t, Some(piece)))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map_or(curve.domain()[0], |(t, _)| t)
}

/// The domain, cut where the curve may have kinks.
fn smooth_pieces(curve: &Curve) -> Vec<[f64; 2]> {
    let domain = curve.domain();
    let mut ends = curve.breaks(domain);
    ends.insert(0, domain[0]);
    ends.push(domain[1]);
    ends.windows(2).map(|pair| [pair[0], pair[1]]).collect()
}

/// At most about `most` parameters from end to end of a smooth piece, dense enough that each local minimum of the
/// distance shows for points near the curve.
fn samples(curve: &Curve, piece: [f64; 2], most: usize) -> Vec<f64> {
    let even =
        |[a, b]: [f64; 2], count: usize| (0..count).map(move |i| a + (b - a) * (i as f64 / count as f64));
    let mut samples: Vec<f64> = match curve {
        Curve::Bspline(spline) => {
            let knots = spline.knots.as_slice();
            let (first, last) = (spline.knots.find_span(piece[0]), knots.partition_point(|k| *k < piece[1]));
            let spans: Vec<_> =
                (first..last).map(|k| [knots[k], knots[k + 1]]).filter(|[a, b]| a < b).collect();
            let each = (4 * spline.knots.degree()).min(most / spans.len().max(1)).max(1);
            spans.into_iter().flat_map(|span| even(span, each)).collect()
        }
        _ => even(piece, 32).collect(),
    };
    // Just before the end: at a knot itself the derivatives are those of the next piece.
    samples.push(piece[1] - 1e-6 * (piece[1] - piece[0]));
    samples
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

//! Marching projection and certified Hermite fitting.
//!
//! The image of a curve piece is sampled along the curve's parameter; each point is projected with the one before as
//! seed, because independent projections jump between branches. Between samples the image is the cubic Hermite
//! interpolant with the exact tangents, `[S_u S_v] (u', v')ᵀ = C'` in least squares; its error falls with h⁴ (de Boor:
//! `h⁴ max|p⁗| / 384`). A span is bisected until `|S(p(t)) − C(t)|` at interior nodes is below the tolerance. Where the
//! edge itself lies off the surface, the fit is held to the projection instead, and the distance is reported.
//!
//! At a pole one parameter is undefined: there the limit from the inside of the piece is taken by extrapolation.
//!
//! How far image and edge are apart is known at nodes. Between two of them, `h` apart, their difference `f` leaves the
//! chord of its two values by `h² max|f″| / 8` at most; `f″` is taken from second differences of the values over the whole
//! span, and twice that: `f` is close to the error of the interpolation, `16 E s² (1 − s)²` with a slowly varying `E`,
//! whose second differences over these nodes are within a factor of 2 of `f″` wherever that matters for the maximum.

use super::TrimError;
use super::pcurve::Piece;
use super::pole::Pole;
use super::segment::{Segment, cubic, point_at};
use super::target::{OFF_SURFACE, Target};
use crate::geometry::{Curve, SurfaceDerivatives};
use glam::{DVec2, DVec3};

/// Spans of one image; beyond it the best fit so far is taken.
const MAX_SPANS: usize = 1024;

/// Bisections of one marching step.
const MAX_DEPTH: u32 = 22;

/// So many radii around a pole, edges have no image of their own.
const HOLE: f64 = 4.0;

/// Three steps of this share of the way from a pole to the first node stay inside of it.
const LARGEST_STEP: f64 = 0.3;

/// Where the fit is compared with the edge.
const CHECKS: [f64; 5] = [0.12, 0.3, 0.5, 0.7, 0.88];

/// The second differences of the checks, times this, bound the second derivative between them.
const BETWEEN_CHECKS: f64 = 2.0;

/// Consecutive segments and a bound of their distance from the edge, at equal parameters.
pub(super) struct Fit {
    pub(super) segments: Vec<Segment>,
    pub(super) deviation: f64,
}

#[derive(Clone, Copy)]
struct Node {
    t: f64,
    uv: DVec2,
    /// d(u, v) / dt.
    rate: DVec2,
    distance: f64,
    /// The point of the surface less that of the edge.
    off: DVec3,
}

/// Fits the image of `piece`, starting near `seed`.
pub(super) fn fit(target: &Target, piece: &Piece, seed: Option<DVec2>) -> Result<Fit, TrimError> {
    let fitter = Fitter { target, piece };
    let nodes = fitter.march(seed)?;
    let mut state = Refinement { segments: Vec::new(), deviation: 0.0, budget: MAX_SPANS };
    for pair in nodes.windows(2) {
        fitter.refine(&pair[0], &pair[1], MAX_DEPTH, &mut state)?;
    }
    Ok(Fit { segments: state.segments, deviation: state.deviation })
}

struct Refinement {
    segments: Vec<Segment>,
    deviation: f64,
    budget: usize,
}

struct Fitter<'a> {
    target: &'a Target<'a>,
    piece: &'a Piece<'a>,
}

impl Fitter<'_> {
    /// Marching steps: an eighth of a turn of a conic, some per knot span of a B-spline.
    fn steps(&self) -> usize {
        let [a, b] = self.piece.range;
        match self.piece.curve {
            Curve::Line { .. } => 4,
            Curve::Circle { .. } | Curve::Ellipse { .. } => {
                ((b - a).abs() / std::f64::consts::FRAC_PI_4).ceil().clamp(2.0, 512.0) as usize
            }
            Curve::Parabola { .. } | Curve::Hyperbola { .. } => 8,
            Curve::Bspline(spline) => {
                let (low, high) = (a.min(b), a.max(b));
                let knots = spline.knots.as_slice();
                let from = knots.partition_point(|knot| *knot <= low).saturating_sub(1);
                let to = knots.partition_point(|knot| *knot < high);
                let inside = knots[from..].windows(2).take(to - from.min(to)).filter(|w| w[0] < w[1]).count();
                (inside.max(1) * spline.knots.degree().clamp(2, 4)).clamp(4, 512)
            }
        }
    }

    fn at(&self, t: f64, seed: Option<DVec2>, expected: f64) -> Result<(Node, bool), TrimError> {
        let [a, b] = self.piece.range;
        let point = self.piece.curve.point(t);
        let (foot, lost) = self.target.foot(point, seed, expected, self.piece.entity)?;
        // Tangents at the ends are those of the inside, as the curve may have a corner there.
        let inside = t + 1e-9 * (0.5 * (a + b) - t);
        let d = self.target.surface.derivatives(foot.uv);
        let rate = rate(&d, self.piece.curve.derivatives(inside).first);
        Ok((Node { t, uv: foot.uv, rate, distance: foot.distance, off: d.point - point }, lost))
    }

    /// The better of the candidates as seed for the point at `t`; the file's own image, where it is good, before all.
    fn best_seed(&self, t: f64, candidates: &[DVec2]) -> Option<DVec2> {
        if let Some(hint) = self.piece.hint {
            let uv = hint.point(t);
            return Some(candidates.first().map_or(uv, |near| uv + self.target.nearest_shift(uv, *near)));
        }
        let point = self.piece.curve.point(t);
        let miss = |uv: &DVec2| self.target.surface.point(*uv).distance_squared(point);
        candidates.iter().filter(|uv| uv.is_finite()).copied().min_by(|a, b| miss(a).total_cmp(&miss(b)))
    }

    /// From `from` to parameter `t`; in smaller steps where a periodic parameter would run too far to be unwrapped.
    fn advance(&self, from: &Node, t: f64, depth: u32, out: &mut Vec<Node>) -> Result<bool, TrimError> {
        let predicted = from.uv + from.rate * (t - from.t);
        let seed = self.best_seed(t, &[from.uv, predicted]);
        let (node, mut lost) = self.at(t, seed, from.distance)?;
        let far = (0..2).any(|axis| {
            self.target.periods[axis].is_some_and(|p| (node.uv[axis] - from.uv[axis]).abs() > 0.2 * p)
        });
        if far && depth > 0 {
            let middle = 0.5 * (from.t + t);
            lost |= self.advance(from, middle, depth - 1, out)?;
            let last = *out.last().expect("advance appends a node");
            lost |= self.advance(&last, t, depth - 1, out)?;
        } else {
            out.push(node);
        }
        Ok(lost)
    }

    /// Nodes from one end to the other.
    fn march(&self, seed: Option<DVec2>) -> Result<Vec<Node>, TrimError> {
        let [a, b] = self.piece.range;
        let steps = self.steps().max(if self.piece.poles.iter().any(Option::is_some) { 4 } else { 1 });
        let times: Vec<f64> =
            (0..=steps).map(|i| if i == steps { b } else { a + (b - a) * i as f64 / steps as f64 }).collect();
        let first = usize::from(self.piece.poles[0].is_some());
        let last = steps - usize::from(self.piece.poles[1].is_some());
        // With a seed from the edge before, start there; without, the middle tells best on which side of a seam we are.
        let (mut origin, mut seed) = match seed {
            Some(near) => (first, self.best_seed(times[first], &[near])),
            None => ((first + last) / 2, self.best_seed(times[(first + last) / 2], &[])),
        };
        let mut nodes = Vec::new();
        // The second round starts where the first found that the seed led astray.
        for round in 0..2 {
            let (node, _) = self.at(times[origin], seed, 0.0)?;
            let mut before = vec![node];
            for i in (first..origin).rev() {
                let from = *before.last().expect("not empty");
                self.advance(&from, times[i], 4, &mut before)?;
            }
            before.reverse();
            nodes = before;
            let mut restart = None;
            for (i, &t) in times.iter().enumerate().take(last + 1).skip(origin + 1) {
                let from = *nodes.last().expect("not empty");
                if self.advance(&from, t, 4, &mut nodes)? && restart.is_none() {
                    restart = Some((i, nodes.last().map(|n| n.uv)));
                }
            }
            match restart {
                Some((i, uv)) if round == 0 => (origin, seed) = (i, uv),
                _ => break,
            }
        }
        for (which, pole) in self.piece.poles.iter().enumerate() {
            let Some(pole) = *pole else { continue };
            let (t, inner) = if which == 0 { (a, nodes[0]) } else { (b, *nodes.last().expect("not empty")) };
            let limit = self.limit(t, &inner, pole)?;
            if which == 0 { nodes.insert(0, limit) } else { nodes.push(limit) }
        }
        Ok(nodes)
    }

    /// The image at parameter `t`, where the piece meets a pole: quadratic extrapolation from three points at 3, 2 and
    /// 1 hundredths of the way to the first node, or so far that they are outside of a pole with a radius.
    fn limit(&self, t: f64, inner: &Node, pole: usize) -> Result<Node, TrimError> {
        let (axis, Pole { point, radius, .. }) = (self.target.poles[pole].axis, self.target.poles[pole]);
        let (fixed, free) = (axis, 1 - axis);
        let mut share = 0.01;
        let is_inside =
            |share: f64| self.piece.curve.point(t + share * (inner.t - t)).distance(point) < HOLE * radius;
        while share < LARGEST_STEP && is_inside(share) {
            share *= 2.0;
        }
        let h = share * (inner.t - t);
        // In steps that shrink, so that each seed is near.
        let mut from = *inner;
        let mut samples = [inner.uv; 5];
        let steps = [30.0, 10.0, 3.0, 2.0, 1.0].map(|part: f64| part.min(0.9 / share));
        for (sample, part) in samples.iter_mut().zip(steps) {
            let mut passed = Vec::new();
            self.advance(&from, t + part * h, 4, &mut passed)?;
            from = *passed.last().expect("advance appends a node");
            *sample = from.uv;
        }
        let [_, _, third, second, first] = samples;
        let mut uv = DVec2::ZERO;
        let mut rate = DVec2::ZERO;
        uv[free] = 3.0 * first[free] - 3.0 * second[free] + third[free];
        rate[free] = (-2.5 * first[free] + 4.0 * second[free] - 1.5 * third[free]) / h;
        let value = self.target.pole_value(pole, first[fixed]);
        uv[fixed] = value;
        rate[fixed] = (-1.5 * value + 2.0 * first[fixed] - 0.5 * second[fixed]) / h;
        let off = self.target.surface.point(uv) - self.piece.curve.point(t);
        Ok(Node { t, uv, rate, distance: off.length(), off })
    }

    fn hermite(&self, a: &Node, b: &Node) -> Segment {
        let third = (b.t - a.t) / 3.0;
        let points = [a.uv, a.uv + a.rate * third, b.uv - b.rate * third, b.uv];
        cubic(points.map(|p| self.target.clamped(p)))
    }

    /// Whether `point` is in the hole of a pole with a radius, where its projection has no meaning. The image ends on
    /// the rim then and is as far away as the hole is wide.
    fn is_in_hole(&self, point: DVec3) -> bool {
        self.piece.poles.into_iter().flatten().any(|pole| {
            let Pole { point: center, radius, .. } = self.target.poles[pole];
            point.distance(center) < HOLE * radius
        })
    }

    /// Whether the fit holds over the span, and a bound of the distance over all of it; that seen so far where not.
    fn check(&self, segment: &Segment, a: &Node, b: &Node) -> Result<(bool, f64), TrimError> {
        let tolerance = self.target.tolerance;
        let mut offs = [a.off; CHECKS.len() + 2];
        offs[CHECKS.len() + 1] = b.off;
        let mut worst: f64 = a.distance.max(b.distance);
        for (i, s) in CHECKS.into_iter().enumerate() {
            let point = self.piece.curve.point(a.t + s * (b.t - a.t));
            let uv = point_at(segment, s);
            let image = self.target.surface.point(uv);
            offs[i + 1] = image - point;
            let distance = offs[i + 1].length();
            worst = worst.max(distance);
            if distance <= tolerance {
                continue;
            }
            if self.is_in_hole(point) {
                continue;
            }
            // An edge off the surface: compare with its projection.
            let near = 2.0 * a.distance.max(b.distance);
            if near <= 0.5 * tolerance {
                return Ok((false, worst));
            }
            if self.distance_to_foot(uv, point)? > tolerance.max(0.02 * distance.max(near)) {
                return Ok((false, worst));
            }
        }
        Ok((true, bound(&offs)))
    }

    /// A bound of the distance over all of a span that does not hold.
    fn bound_of(&self, segment: &Segment, a: &Node, b: &Node) -> f64 {
        let mut offs = [a.off; CHECKS.len() + 2];
        offs[CHECKS.len() + 1] = b.off;
        for (off, s) in offs[1..].iter_mut().zip(CHECKS) {
            *off = self.target.surface.point(point_at(segment, s))
                - self.piece.curve.point(a.t + s * (b.t - a.t));
        }
        bound(&offs)
    }

    /// How far the surface point at `uv` is from the foot of `point`, which is near it: the length of the Gauss-Newton step, which ends at the
    /// border where the surface does; by projection where there is no such step.
    fn distance_to_foot(&self, uv: DVec2, point: DVec3) -> Result<f64, TrimError> {
        let d = self.target.surface.derivatives(uv);
        let way = point - d.point;
        let mut step = rate(&d, way);
        if step == DVec2::ZERO {
            let (foot, _) = self.target.foot(point, Some(uv), way.length(), self.piece.entity)?;
            return Ok(self.target.surface.point(foot.uv).distance(d.point));
        }
        let tangents = [d.du, d.dv];
        let within = |step: DVec2| self.target.clamped(uv + step);
        let held = within(step);
        if let Some(axis) = (0..2).find(|&axis| held[axis] != uv[axis] + step[axis]) {
            // One parameter stands at the border: the other one is the best beside it.
            let (along, other) = (tangents[axis] * (held[axis] - uv[axis]), 1 - axis);
            step[axis] = held[axis] - uv[axis];
            step[other] = (way - along).dot(tangents[other]) / tangents[other].length_squared();
            step[other] = within(step)[other] - uv[other];
        }
        Ok((d.du * step.x + d.dv * step.y).length())
    }

    fn refine(&self, a: &Node, b: &Node, depth: u32, state: &mut Refinement) -> Result<(), TrimError> {
        let segment = self.hermite(a, b);
        let (good, worst) = self.check(&segment, a, b)?;
        if good || depth == 0 || state.budget == 0 {
            let limit = OFF_SURFACE * self.target.size;
            if !good && (worst > limit || !worst.is_finite()) {
                return Err(TrimError::Numeric(format!(
                    "the image of edge #{} does not converge ({worst:.1e} mm off)",
                    self.piece.entity
                )));
            }
            let bound = if good { worst } else { self.bound_of(&segment, a, b) };
            state.deviation = state.deviation.max(bound);
            state.segments.push(segment);
            return Ok(());
        }
        state.budget -= 1;
        let t = 0.5 * (a.t + b.t);
        let seed = self.best_seed(t, &[point_at(&segment, 0.5), 0.5 * (a.uv + b.uv), a.uv, b.uv]);
        let (middle, _) = self.at(t, seed, a.distance.max(b.distance))?;
        self.refine(a, &middle, depth - 1, state)?;
        self.refine(&middle, b, depth - 1, state)
    }
}

/// Least-squares solution of `S_u u' + S_v v' = tangent`; zero where the surface is singular.
fn rate(d: &SurfaceDerivatives, tangent: DVec3) -> DVec2 {
    let (uu, mixed, vv) = (d.du.dot(d.du), d.du.dot(d.dv), d.dv.dot(d.dv));
    let determinant = uu * vv - mixed * mixed;
    let (a, b) = (d.du.dot(tangent), d.dv.dot(tangent));
    let rate = DVec2::new(a * vv - b * mixed, b * uu - a * mixed) / determinant;
    if determinant > 1e-20 * uu * vv && rate.is_finite() { rate } else { DVec2::ZERO }
}

/// The greatest length over a whole span of what is `offs` at its ends and at the checks.
fn bound(offs: &[DVec3; CHECKS.len() + 2]) -> f64 {
    let at = |i: usize| if i == 0 { 0.0 } else { CHECKS.get(i - 1).copied().unwrap_or(1.0) };
    let slope = |i: usize| (offs[i + 1] - offs[i]) / (at(i + 1) - at(i));
    let bend = (1..offs.len() - 1)
        .map(|i| 2.0 * (slope(i) - slope(i - 1)).length() / (at(i + 1) - at(i - 1)))
        .fold(0.0, f64::max);
    (0..offs.len() - 1)
        .map(|i| {
            let h = at(i + 1) - at(i);
            offs[i].length().max(offs[i + 1].length()) + h * h / 8.0 * BETWEEN_CHECKS * bend
        })
        .fold(0.0, f64::max)
}

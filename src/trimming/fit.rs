//! Marching projection and certified Hermite fitting.
//!
//! The image of a curve piece is sampled along the curve's parameter; each point is projected with the one before as
//! seed, because independent projections jump between branches. Between samples the image is the cubic Hermite
//! interpolant with the exact tangents, `[S_u S_v] (u', v')ᵀ = C'` in least squares; its error falls with h⁴ (de Boor:
//! `h⁴ max|p⁗| / 384`). A span is bisected until `|S(p(t)) − C(t)|` at interior nodes is below the tolerance. Where the
//! edge itself lies off the surface, the fit is held to the projection instead, and the distance is reported.
//!
//! At a pole one parameter is undefined: there the limit from the inside of the piece is taken by extrapolation.

use super::TrimError;
use super::segment::{Segment, cubic, end, point_at, start, straight};
use super::target::{Foot, OFF_SURFACE, Target};
use crate::geometry::{Curve, Homogeneous};
use glam::{DVec2, DVec3};

/// Spans of one image; beyond it the best fit so far is taken.
const MAX_SPANS: usize = 4096;

/// Bisections of one marching step.
const MAX_DEPTH: u32 = 22;

/// Where the fit is compared with the edge.
const CHECKS: [f64; 5] = [0.12, 0.3, 0.5, 0.7, 0.88];

/// A piece of an edge, smooth and without a pole inside.
pub(super) struct Piece<'a> {
    pub(super) curve: &'a Curve,
    /// First and last parameter, in the direction of the loop.
    pub(super) range: [f64; 2],
    /// Poles at its ends.
    pub(super) poles: [Option<usize>; 2],
    /// For messages.
    pub(super) entity: u64,
}

/// Consecutive segments and their greatest distance from the edge.
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
}

/// Fits the image of `piece`, starting near `seed`.
pub(super) fn fit(target: &Target, piece: &Piece, seed: Option<DVec2>) -> Result<Fit, TrimError> {
    let fitter = Fitter { target, piece };
    let nodes = fitter.march(seed)?;
    let mut state = Refinement { segments: Vec::new(), deviation: 0.0, budget: MAX_SPANS };
    for pair in nodes.windows(2) {
        fitter.refine(&pair[0], &pair[1], MAX_DEPTH, &mut state)?;
    }
    let segments = fitter.straightened(state.segments);
    Ok(Fit { segments, deviation: state.deviation })
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
        let (foot, lost) = self.target.foot(self.piece.curve.point(t), seed, expected, self.piece.entity)?;
        // Tangents at the ends are those of the inside, as the curve may have a corner there.
        let inside = t + 1e-9 * (0.5 * (a + b) - t);
        let rate = self.rate(foot.uv, self.piece.curve.derivatives(inside).first);
        Ok((Node { t, uv: foot.uv, rate, distance: foot.distance }, lost))
    }

    /// Least-squares solution of `S_u u' + S_v v' = tangent`; zero where the surface is singular.
    fn rate(&self, uv: DVec2, tangent: DVec3) -> DVec2 {
        let d = self.target.surface.derivatives(uv);
        let (uu, mixed, vv) = (d.du.dot(d.du), d.du.dot(d.dv), d.dv.dot(d.dv));
        let determinant = uu * vv - mixed * mixed;
        let (a, b) = (d.du.dot(tangent), d.dv.dot(tangent));
        let rate = DVec2::new(a * vv - b * mixed, b * uu - a * mixed) / determinant;
        if determinant > 1e-20 * uu * vv && rate.is_finite() { rate } else { DVec2::ZERO }
    }

    /// The better of the candidates as seed for the point at `t`.
    fn best_seed(&self, t: f64, candidates: &[DVec2]) -> Option<DVec2> {
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
            Some(_) => (first, seed),
            None => ((first + last) / 2, None),
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
    /// 1 hundredths of the way to the first node.
    fn limit(&self, t: f64, inner: &Node, pole: usize) -> Result<Node, TrimError> {
        let singularity = &self.target.singularities[pole];
        let (fixed, free) = (singularity.axis, 1 - singularity.axis);
        let h = 0.01 * (inner.t - t);
        // In steps that shrink, so that each seed is near.
        let mut from = *inner;
        let mut samples = [inner.uv; 5];
        for (sample, part) in samples.iter_mut().zip([30.0, 10.0, 3.0, 2.0, 1.0]) {
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
        uv[fixed] = singularity.value;
        rate[fixed] = (-1.5 * singularity.value + 2.0 * first[fixed] - 0.5 * second[fixed]) / h;
        let distance = self.piece.curve.point(t).distance(singularity.point);
        Ok(Node { t, uv, rate, distance })
    }

    fn hermite(&self, a: &Node, b: &Node) -> Segment {
        let third = (b.t - a.t) / 3.0;
        let points = [a.uv, a.uv + a.rate * third, b.uv - b.rate * third, b.uv];
        cubic(points.map(|p| self.target.clamped(p)))
    }

    /// Whether the fit holds over the span, and the greatest distance seen.
    fn check(&self, segment: &Segment, a: &Node, b: &Node) -> Result<(bool, f64), TrimError> {
        let tolerance = self.target.tolerance;
        let mut worst: f64 = a.distance.max(b.distance);
        let mut good = true;
        for s in CHECKS {
            let point = self.piece.curve.point(a.t + s * (b.t - a.t));
            let uv = point_at(segment, s);
            let image = self.target.surface.point(uv);
            let distance = image.distance(point);
            worst = worst.max(distance);
            if distance <= tolerance {
                continue;
            }
            // An edge off the surface: compare with its projection.
            let near = 2.0 * a.distance.max(b.distance);
            if near <= 0.5 * tolerance {
                return Ok((false, worst));
            }
            let (Foot { uv, distance: off }, _) =
                self.target.foot(point, Some(uv), near, self.piece.entity)?;
            good &= self.target.surface.point(uv).distance(image) <= tolerance.max(0.02 * off.max(near));
            if !good {
                break;
            }
        }
        Ok((good, worst))
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
            state.deviation = state.deviation.max(worst);
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

    /// One straight segment where the whole image is straight within the tolerance; parallel to an axis where it is
    /// that within the tolerance, so that the sides of rectangles become exact.
    fn straightened(&self, segments: Vec<Segment>) -> Vec<Segment> {
        let (Some(first), Some(last)) = (segments.first(), segments.last()) else { return segments };
        let (a, b) = (start(first), end(last));
        let metrics: Vec<DVec2> = segments
            .iter()
            .map(|s| [0.0, 0.5, 1.0].map(|t| self.target.metric(point_at(s, t))))
            .map(|[m0, m1, m2]| m0.max(m1).max(m2))
            .collect();
        let tolerance = self.target.tolerance;
        let within = |off: &dyn Fn(DVec2) -> DVec2| {
            segments
                .iter()
                .zip(&metrics)
                .all(|(s, m)| s.points.iter().all(|p| (off(p.point()) * *m).length() <= tolerance))
        };
        // Back and forth on one line is not a straight image.
        let advances = |direction: DVec2| {
            segments.iter().all(|s| (end(s) - start(s)).dot(direction) >= -1e-9 * direction.length_squared())
        };
        for axis in 0..2 {
            let strongest = (0..segments.len())
                .max_by(|&i, &j| metrics[i][axis].total_cmp(&metrics[j][axis]))
                .expect("there are segments");
            let value = point_at(&segments[strongest], 0.5)[axis];
            let off = |p: DVec2| {
                let mut d = DVec2::ZERO;
                d[axis] = p[axis] - value;
                d
            };
            let (mut a, mut b) = (a, b);
            (a[axis], b[axis]) = (value, value);
            if within(&off) && advances(b - a) {
                return vec![straight(a, b)];
            }
        }
        let chord = b - a;
        let off = |p: DVec2| (p - a).reject_from_normalized(chord.normalize_or(DVec2::X));
        if chord.length() > 0.0 && within(&off) && advances(chord) {
            return vec![straight(a, b)];
        }
        segments
    }
}

//! B-splines into Bézier pieces by knot insertion (what The NURBS Book's A5.6 and A5.7 do, span by span).

use super::bezier::{Bezier, BezierPatch, Homogeneous, Homogeneous3};
use super::blossom::bezier_points;
use super::bspline::{BsplineCurve, BsplineSurface, transposed};
use super::knots::KnotVector;

/// One Bézier piece and the parameter range it covers.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveSpan<P> {
    /// First and last parameter.
    pub range: [f64; 2],
    /// The piece.
    pub bezier: Bezier<P>,
}

/// One Bézier patch and the parameter rectangle it covers.
#[derive(Debug, Clone, PartialEq)]
pub struct PatchSpan {
    /// First and last u.
    pub u: [f64; 2],
    /// First and last v.
    pub v: [f64; 2],
    /// The patch.
    pub patch: BezierPatch,
}

/// The non-empty spans in order; neighbours share end points bit for bit.
pub fn decompose_curve<P: Homogeneous>(curve: &BsplineCurve<P>) -> Vec<CurveSpan<P>> {
    let knots = curve.knots.as_slice();
    let width = curve.knots.degree() + 1;
    let pieces = decompose_row(&curve.knots, &curve.points);
    let spans = curve.knots.spans().zip(pieces.chunks_exact(width));
    spans
        .map(|(k, piece)| CurveSpan {
            range: [knots[k], knots[k + 1]],
            bezier: Bezier { points: piece.to_vec() },
        })
        .collect()
}

/// How many control points all patches of a surface have together: up to `(p + 1)(q + 1)` times those of the surface.
pub fn patch_points(surface: &BsplineSurface) -> usize {
    let along = |knots: &KnotVector| knots.spans().count() * (knots.degree() + 1);
    along(&surface.u_knots).saturating_mul(along(&surface.v_knots))
}

/// The non-empty spans, v fastest; neighbours share boundary rows bit for bit.
pub fn decompose_surface(surface: &BsplineSurface) -> impl Iterator<Item = PatchSpan> + '_ {
    let (u_knots, v_knots) = (&surface.u_knots, &surface.v_knots);
    let degrees = [u_knots.degree(), v_knots.degree()];
    let [p1, q1] = degrees.map(|degree| degree + 1);
    // All rows are cut along v, then all columns of the result along u. Equal input rows give equal output bits, so rows
    // that neighbours share after the first pass stay shared after the second one.
    let rows: Vec<_> = surface
        .points
        .chunks_exact(v_knots.point_count())
        .flat_map(|row| decompose_row(v_knots, row))
        .collect();
    let width = rows.len() / u_knots.point_count();
    let columns = transposed(&rows, width);
    let mut last_row: Option<Vec<Homogeneous3>> = None;
    u_knots.spans().flat_map(move |u| {
        // Column by column, as many points each as one patch has along u.
        let mut strip = vec![Homogeneous3::default(); width * p1];
        for (column, out) in columns.chunks_exact(u_knots.point_count()).zip(strip.chunks_exact_mut(p1)) {
            bezier_points(degrees[0], u_knots.as_slice(), column, u, out);
        }
        if let Some(shared) = &last_row {
            strip.iter_mut().step_by(p1).zip(shared).for_each(|(point, shared)| *point = *shared);
        }
        last_row = Some(strip.iter().skip(p1 - 1).step_by(p1).copied().collect());
        v_knots.spans().enumerate().map(move |(b, v)| {
            let points = (0..p1).flat_map(|i| (0..q1).map(move |j| (i, j)));
            let points = points.map(|(i, j)| strip[(b * q1 + j) * p1 + i]).collect();
            let range = |knots: &KnotVector, k: usize| [knots.as_slice()[k], knots.as_slice()[k + 1]];
            PatchSpan { u: range(u_knots, u), v: range(v_knots, v), patch: BezierPatch { degrees, points } }
        })
    })
}

/// The Bézier points of all non-empty spans one after the other, `degree + 1` each.
fn decompose_row<P: Homogeneous>(knots: &KnotVector, points: &[P]) -> Vec<P> {
    let degree = knots.degree();
    let mut pieces: Vec<P> = Vec::new();
    for k in knots.spans() {
        let start = pieces.len();
        pieces.resize(start + degree + 1, P::default());
        bezier_points(degree, knots.as_slice(), points, k, &mut pieces[start..]);
        if start > 0 {
            pieces[start] = pieces[start - 1];
        }
    }
    pieces
}

//! B-splines into Bézier pieces by knot insertion (what The NURBS Book's A5.6 and A5.7 do, span by span).

use super::bezier::{Bezier, BezierPatch, Homogeneous};
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

/// The non-empty spans, v fastest; neighbours share boundary rows bit for bit.
pub fn decompose_surface(surface: &BsplineSurface) -> Vec<PatchSpan> {
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
    let columns: Vec<_> = transposed(&rows, width)
        .chunks_exact(u_knots.point_count())
        .flat_map(|column| decompose_row(u_knots, column))
        .collect();
    let height = columns.len() / width;
    let mut patches = Vec::new();
    for (a, u) in u_knots.spans().enumerate() {
        for (b, v) in v_knots.spans().enumerate() {
            let at = |i: usize, j: usize| columns[(b * q1 + j) * height + a * p1 + i];
            let points = (0..p1).flat_map(|i| (0..q1).map(move |j| at(i, j))).collect();
            let range = |knots: &KnotVector, k: usize| [knots.as_slice()[k], knots.as_slice()[k + 1]];
            patches.push(PatchSpan {
                u: range(u_knots, u),
                v: range(v_knots, v),
                patch: BezierPatch { degrees, points },
            });
        }
    }
    patches
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

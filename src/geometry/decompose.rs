//! B-splines into Bézier pieces by knot insertion (The NURBS Book, A5.6 and A5.7).

use super::bezier::{Bezier, BezierPatch, Homogeneous};
use super::bspline::{BsplineCurve, BsplineSurface};

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
    todo!()
}

/// The non-empty spans, v fastest; neighbours share boundary rows bit for bit.
pub fn decompose_surface(surface: &BsplineSurface) -> Vec<PatchSpan> {
    todo!()
}

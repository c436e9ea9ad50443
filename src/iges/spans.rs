//! Curves as runs of rational Bézier spans: the common form from which swept surfaces and composite profiles are made.
//! Exact: conics become rational quadratics (The NURBS Book, §7.3), power-basis cubics become Bézier cubics.

use crate::geometry::{
    BsplineCurve, Curve, Homogeneous, Homogeneous3, KnotError, decompose_curve, join_spans,
};
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

/// One Bézier span over a parameter interval.
#[derive(Debug, Clone)]
pub struct Span {
    /// First and last parameter.
    pub range: [f64; 2],
    /// Control points, at least two.
    pub points: Vec<Homogeneous3>,
    /// Half the angle of an elliptic arc: the file's parameter is then the angle, not the span's own parameter.
    pub half_angle: Option<f64>,
}

/// The most spans of one curve: more turns than this are no edge of a model.
const MOST_ARCS: f64 = 64.0;

/// `curve` over `range` (in either direction), parameters of the spans running linearly over `own`.
pub fn of_curve(curve: &Curve, range: [f64; 2], own: [f64; 2]) -> Vec<Span> {
    let [a, b] = range;
    let outer = |t: f64| own[0] + (t - a) / (b - a) * (own[1] - own[0]);
    match curve {
        Curve::Line { .. } => {
            let points = range.map(|t| <Homogeneous3 as Homogeneous>::new(curve.point(t), 1.0)).to_vec();
            vec![Span { range: own, points, half_angle: None }]
        }
        Curve::Bspline(spline) => {
            let Some(piece) = spline.piece(a, b) else { return Vec::new() };
            // A piece run backwards has the negated parameters.
            let sign = if a > b { -1.0 } else { 1.0 };
            let span = |span: crate::geometry::CurveSpan<Homogeneous3>| Span {
                range: span.range.map(|t| outer(sign * t)),
                points: span.bezier.points,
                half_angle: None,
            };
            decompose_curve(&piece).into_iter().map(span).collect()
        }
        Curve::Circle { frame, .. } | Curve::Ellipse { frame, .. } => {
            let count = ((b - a).abs() / FRAC_PI_2 - 1e-9).ceil().clamp(1.0, MOST_ARCS);
            conic_spans(curve, frame.origin, range, count, &outer, f64::cos, true)
        }
        Curve::Hyperbola { frame, .. } => {
            conic_spans(curve, frame.origin, range, 1.0, &outer, f64::cosh, false)
        }
        Curve::Parabola { .. } => {
            let [start, end] = range.map(|t| curve.derivatives(t));
            let middle = start.point + start.first * (0.5 * (b - a));
            let points = [start.point, middle, end.point];
            let points = points.map(|p| <Homogeneous3 as Homogeneous>::new(p, 1.0)).to_vec();
            vec![Span { range: own, points, half_angle: None }]
        }
    }
}

/// Arcs of a conic with a centre: the middle control point lies on the ray from the centre through the middle of the
/// arc, farther by the factor 1 / w, where w is the cosine (circular or hyperbolic) of half the arc's parameter length.
fn conic_spans(
    curve: &Curve,
    center: DVec3,
    [a, b]: [f64; 2],
    count: f64,
    outer: &impl Fn(f64) -> f64,
    cosine: fn(f64) -> f64,
    is_angle: bool,
) -> Vec<Span> {
    let at = |i: f64| if i == count { b } else { a + (b - a) * i / count };
    let half = 0.5 * (b - a) / count;
    let weight = cosine(half);
    let span = |i: u32| {
        let (start, end) = (at(f64::from(i)), at(f64::from(i) + 1.0));
        let middle = center + (curve.point(0.5 * (start + end)) - center) / weight;
        let points = vec![
            <Homogeneous3 as Homogeneous>::new(curve.point(start), 1.0),
            <Homogeneous3 as Homogeneous>::new(middle, weight),
            <Homogeneous3 as Homogeneous>::new(curve.point(end), 1.0),
        ];
        Span { range: [outer(start), outer(end)], points, half_angle: is_angle.then_some(half.abs()) }
    };
    (0..count as u32).map(span).collect()
}

/// One B-spline from spans that follow each other; joints that do not meet are closed. Spans without length are left out.
pub fn joined(spans: &[Span]) -> Result<BsplineCurve<Homogeneous3>, KnotError> {
    let total = spans.iter().map(|s| s.range[1] - s.range[0]).sum::<f64>();
    let has_length = |span: &&Span| span.range[1] - span.range[0] > 1e-12 * total;
    join_spans(spans.iter().filter(has_length).map(|span| (span.range, span.points.clone())).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Frame;

    #[test]
    fn conics_become_exact_splines() {
        let frame = Frame::from_axes(DVec3::new(1.0, 2.0, 3.0), Some(DVec3::new(1.0, 1.0, 1.0)), None);
        let ellipse = Curve::Ellipse { frame, radii: [3.0, 1.0] };
        let spline = joined(&of_curve(&ellipse, [1.0, -4.5], [0.0, 2.0])).expect("a spline");
        assert_eq!(spline.domain(), [0.0, 2.0]);
        for i in 0..=20 {
            let local = frame.local_point(Homogeneous::point(spline.eval(f64::from(i) / 10.0)));
            assert!(((local.x / 3.0).powi(2) + local.y.powi(2) - 1.0).abs() < 1e-14 && local.z.abs() < 1e-14);
        }
        for curve in [Curve::Parabola { frame, focal: 0.5 }, Curve::Hyperbola { frame, radii: [2.0, 1.0] }] {
            let spline = joined(&of_curve(&curve, [-1.0, 2.0], [0.0, 1.0])).expect("a spline");
            for i in 0..=10 {
                let local = frame.local_point(Homogeneous::point(spline.eval(f64::from(i) / 10.0)));
                let residual = match curve {
                    Curve::Parabola { .. } => local.y * local.y - 2.0 * local.x,
                    _ => (local.x / 2.0).powi(2) - local.y * local.y - 1.0,
                };
                assert!(residual.abs() < 1e-12, "{residual}");
            }
        }
    }

    #[test]
    fn joints_are_closed_and_degrees_raised() {
        let line = Curve::Line { origin: DVec3::ZERO, direction: DVec3::X };
        let frame = Frame::from_axes(DVec3::new(1.0, 1.0, 0.0), None, Some(-DVec3::Y));
        let arc = Curve::Circle { frame, radius: 1.0 };
        let mut spans = of_curve(&line, [0.0, 1.0], [0.0, 1.0]);
        spans.extend(of_curve(&arc, [0.0, FRAC_PI_2], [1.0, 2.0]));
        let spline = joined(&spans).expect("a spline");
        assert_eq!((spline.knots.degree(), spline.points.len()), (2, 5));
        assert!(Homogeneous::point(spline.eval(0.25)).distance(DVec3::X * 0.25) < 1e-15);
        assert!((Homogeneous::point(spline.eval(1.3)).distance(frame.origin) - 1.0).abs() < 1e-15);
        assert!(joined(&[]).is_err());
    }
}

//! Several B-splines as one.

use super::bezier::{Homogeneous, Homogeneous3};
use super::bspline::BsplineCurve;
use super::decompose::decompose_curve;
use super::knots::KnotError;

/// One B-spline through `curves` in order, each keeping its parameter up to a shift; the first keeps it as it is. The image is
/// exact but for gaps at the joints, which the later curve's first control point closes: check before that the ends meet.
pub fn join_curves(curves: &[BsplineCurve<Homogeneous3>]) -> Result<BsplineCurve<Homogeneous3>, KnotError> {
    let mut spans = Vec::new();
    let mut end = None;
    for curve in curves {
        let start = curve.domain()[0];
        let shift = end.unwrap_or(start) - start;
        for span in decompose_curve(curve) {
            let range = span.range.map(|t| t + shift);
            end = Some(range[1]);
            spans.push((range, span.bezier.points));
        }
    }
    join_spans(spans)
}

/// One B-spline from Bézier spans, each given by its range and its control points, whose ranges follow each other. Degrees are
/// raised to the highest, and weights scaled to agree at the joints, which changes no point.
pub fn join_spans(
    spans: Vec<([f64; 2], Vec<Homogeneous3>)>,
) -> Result<BsplineCurve<Homogeneous3>, KnotError> {
    let degree = spans.iter().map(|(_, points)| points.len() - 1).max().unwrap_or(0);
    let mut points: Vec<Homogeneous3> = Vec::new();
    let mut knots: Vec<f64> = Vec::new();
    for (range, span) in spans {
        let raised = elevated(span, degree);
        if let Some(last) = points.last() {
            let factor = last.w / raised[0].w;
            points.extend(raised[1..].iter().map(|p| *p * factor));
        } else {
            knots = vec![range[0]; degree + 1];
            points = raised;
        }
        knots.extend(std::iter::repeat_n(range[1], degree));
    }
    knots.extend(knots.last().copied());
    BsplineCurve::new(degree, knots, points)
}

/// Bézier points of a higher degree (The NURBS Book, equation 5.36).
pub fn elevated<P: Homogeneous>(mut points: Vec<P>, degree: usize) -> Vec<P> {
    while points.len() <= degree {
        let n = points.len();
        let share = |i: usize| i as f64 / n as f64;
        let inner = (1..n).map(|i| points[i - 1] * share(i) + points[i] * (1.0 - share(i)));
        points = [points[0]].into_iter().chain(inner).chain([points[n - 1]]).collect();
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Curve, Frame, Homogeneous, to_bspline::curve_to_bspline};
    use glam::DVec3;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn a_line_and_an_arc() {
        let line = Curve::Line { origin: DVec3::ZERO, direction: DVec3::X };
        let frame = Frame::from_axes(DVec3::new(1.0, 1.0, 0.0), None, Some(-DVec3::Y));
        let arc = Curve::Circle { frame, radius: 1.0 };
        let parts = [curve_to_bspline(&line, [0.0, 1.0]), curve_to_bspline(&arc, [0.0, FRAC_PI_2])];
        let joined = join_curves(&parts).expect("the parts meet");
        assert_eq!((joined.knots.degree(), joined.domain()), (2, [0.0, 1.0 + FRAC_PI_2]));
        assert!(Homogeneous::point(joined.eval(0.25)).distance(DVec3::X * 0.25) < 1e-15);
        for t in [1.1, 1.7, 2.5] {
            assert!((Homogeneous::point(joined.eval(t)).distance(frame.origin) - 1.0).abs() < 1e-15);
        }
        assert!(join_curves(&[]).is_err());
    }
}

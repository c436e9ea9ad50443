//! Small tools for rational Bézier segments in the parameter plane.
//!
//! Invariant of every segment in this module: the weights of its two end points are exactly 1. So an end point is
//! stored, shifted and compared without the rounding of a division, and neighbours can share it bit for bit. Any
//! rational Bézier curve can be brought to this form: multiplying weight i by `λ · μ^i` changes only its parameter
//! (The NURBS Book, §6.4).

use crate::geometry::{Bezier, Homogeneous, Homogeneous2};
use glam::DVec2;

/// A curve segment in the parameter plane.
pub(super) type Segment = Bezier<Homogeneous2>;

/// The control point with Cartesian coordinates `point`.
pub(super) fn control(point: DVec2, weight: f64) -> Homogeneous2 {
    <Homogeneous2 as Homogeneous>::new(point, weight)
}

/// The line segment from `a` to `b`.
pub(super) fn straight(a: DVec2, b: DVec2) -> Segment {
    Bezier { points: vec![control(a, 1.0), control(b, 1.0)] }
}

/// The polynomial cubic with these control points.
pub(super) fn cubic(points: [DVec2; 4]) -> Segment {
    Bezier { points: points.iter().map(|&p| control(p, 1.0)).collect() }
}

/// The first point.
pub(super) fn start(segment: &Segment) -> DVec2 {
    segment.points[0].point()
}

/// The last point.
pub(super) fn end(segment: &Segment) -> DVec2 {
    segment.points[segment.points.len() - 1].point()
}

/// Moves the first point.
pub(super) fn set_start(segment: &mut Segment, point: DVec2) {
    segment.points[0] = control(point, 1.0);
}

/// Moves the last point.
pub(super) fn set_end(segment: &mut Segment, point: DVec2) {
    let last = segment.points.len() - 1;
    segment.points[last] = control(point, 1.0);
}

/// The point at `t`.
pub(super) fn point_at(segment: &Segment, t: f64) -> DVec2 {
    segment.eval(t).point()
}

/// Moves the whole segment.
pub(super) fn shift(segment: &mut Segment, offset: DVec2) {
    for point in &mut segment.points {
        *point = control(point.point() + offset, point.weight());
    }
}

/// The segment run backwards.
pub(super) fn reversed(mut segment: Segment) -> Segment {
    segment.points.reverse();
    segment
}

/// Whether no control point leaves the line `axis = value of the start`.
pub(super) fn is_constant(segment: &Segment, axis: usize) -> bool {
    let value = start(segment)[axis];
    segment.points.iter().all(|p| p.point()[axis] == value)
}

/// The same curve with end weights of exactly 1. `None` where a weight is not positive and finite.
pub(super) fn with_unit_ends(mut segment: Segment) -> Option<Segment> {
    let last = segment.points.len() - 1;
    let usable = |p: &Homogeneous2| p.is_finite() && p.weight() > 0.0;
    if !segment.points.iter().all(usable) {
        return None;
    }
    let first_weight = segment.points[0].weight();
    let ratio = (first_weight / segment.points[last].weight()).powf(1.0 / last as f64);
    let mut factor = 1.0 / first_weight;
    for (i, point) in segment.points.iter_mut().enumerate() {
        let weight = if i == 0 || i == last { 1.0 } else { point.weight() * factor };
        // Rounding must not turn a polynomial into a rational curve.
        let weight = if (weight - 1.0).abs() < 1e-13 { 1.0 } else { weight };
        *point = control(point.point(), weight);
        factor *= ratio;
    }
    segment.points.iter().all(usable).then_some(segment)
}

/// Points along the segment, its start included and its end not: enough for areas and means.
pub(super) fn samples(segment: &Segment) -> impl Iterator<Item = DVec2> + '_ {
    let count = if segment.points.len() == 2 { 1 } else { 8 };
    (0..count).map(move |i| point_at(segment, f64::from(i) / f64::from(count)))
}

/// The signed area of a closed chain, positive where it runs counter-clockwise; curves are sampled.
pub(super) fn signed_area(chain: &[Segment]) -> f64 {
    let points: Vec<DVec2> = chain.iter().flat_map(samples).collect();
    let Some(&origin) = points.first() else { return 0.0 };
    (0..points.len())
        .map(|i| (points[i] - origin).perp_dot(points[(i + 1) % points.len()] - origin))
        .sum::<f64>()
        * 0.5
}

/// The least and greatest end points.
pub(super) fn extent<'a>(segments: impl IntoIterator<Item = &'a Segment>) -> [DVec2; 2] {
    segments.into_iter().fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[low, high], segment| {
        let (a, b) = (start(segment), end(segment));
        [low.min(a).min(b), high.max(a).max(b)]
    })
}

/// `point` with its coordinate `axis` replaced.
pub(super) fn with_axis(mut point: DVec2, axis: usize, value: f64) -> DVec2 {
    point[axis] = value;
    point
}

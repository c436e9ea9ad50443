//! Exact conversions to rational B-spline form.
//!
//! A conic arc is one rational quadratic: with `m` and `h` the middle and the half of its angle, the homogeneous control
//! points of the unit circle are `(cos a, sin a, 1)`, `(cos m, sin m, cos h)`, `(cos b, sin b, 1)` (The NURBS Book, §7.3),
//! and those of the hyperbola the same with cosh and sinh. Arcs are cut so short that the middle weights stay near 1.

use super::bezier::{Homogeneous, Homogeneous3};
use super::blossom::reversed;
use super::bspline::{BsplineCurve, BsplineSurface, transposed};
use super::curve::Curve;
use super::frame::Frame;
use super::knots::KnotVector;
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, TAU};

/// The longest arc of a circle or ellipse in one piece; a little more than a quarter, so that a full turn has four.
const LONGEST_ARC: f64 = FRAC_PI_2 * (1.0 + 1e-9);
/// The longest arc of a hyperbola in one piece: middle weights up to cosh 1/2 = 1.13.
const LONGEST_HYPERBOLA: f64 = 1.0;
/// Nobody's edge has more pieces; parameters without sense would ask for memory without end.
const MAX_PIECES: f64 = 1024.0;

/// `curve` over `range` as a rational B-spline; the image is exact. Where the range descends, the result runs from its
/// first to its second value too, and its parameter is the negated one. The parameter is kept (or negated) for lines,
/// parabolas and B-splines; on other conics it agrees at the ends of pieces. Closed B-splines may be run through more
/// than once; open ones are clamped to their domain. A range of nothing, or one that is not finite, gives a single point.
pub fn curve_to_bspline(curve: &Curve, range: [f64; 2]) -> BsplineCurve<Homogeneous3> {
    let (low, high) = (range[0].min(range[1]), range[0].max(range[1]));
    let converted = if low < high && (high - low).is_finite() { ascending(curve, [low, high]) } else { None };
    match converted {
        None => single_point(curve.point(if range[0].is_finite() { range[0] } else { 0.0 })),
        Some(converted) if range[0] <= range[1] => converted,
        Some(converted) => {
            let degree = converted.knots.degree();
            let (knots, points) = reversed(converted.knots.as_slice(), &converted.points);
            build(degree, knots, points).unwrap_or(converted)
        }
    }
}

fn ascending(curve: &Curve, range: [f64; 2]) -> Option<BsplineCurve<Homogeneous3>> {
    let [a, b] = range;
    let plain = |p: DVec3| <Homogeneous3 as Homogeneous>::new(p, 1.0);
    match curve {
        Curve::Line { .. } => build(1, vec![a, a, b, b], vec![plain(curve.point(a)), plain(curve.point(b))]),
        Curve::Circle { frame, radius } => arcs(frame, [*radius; 2], range, circle_point, LONGEST_ARC),
        Curve::Ellipse { frame, radii } => arcs(frame, *radii, range, circle_point, LONGEST_ARC),
        Curve::Hyperbola { frame, radii } => arcs(frame, *radii, range, hyperbola_point, LONGEST_HYPERBOLA),
        Curve::Parabola { frame, focal } => {
            // The blossom of (f t², 2 f t).
            let at = |s: f64, t: f64| plain(frame.point(DVec3::new(focal * s * t, focal * (s + t), 0.0)));
            build(2, vec![a, a, a, b, b, b], vec![at(a, a), at(a, b), at(b, b)])
        }
        Curve::Bspline(spline)
            if (a < spline.domain()[0] || b > spline.domain()[1]) && spline.is_closed() =>
        {
            unrolled(spline, range)
        }
        Curve::Bspline(spline) => spline.piece(a, b),
    }
}

fn build(degree: usize, knots: Vec<f64>, points: Vec<Homogeneous3>) -> Option<BsplineCurve<Homogeneous3>> {
    let knots = KnotVector::new(degree, knots, points.len()).ok()?;
    Some(BsplineCurve { knots, points })
}

/// A curve without length.
fn single_point(point: DVec3) -> BsplineCurve<Homogeneous3> {
    let point = <Homogeneous3 as Homogeneous>::new(point, 1.0);
    build(1, vec![0.0, 0.0, 1.0, 1.0], vec![point; 2]).expect("the knots are good")
}

/// The point at the middle of an arc and the weight that makes it the arc's middle control point.
fn circle_point(middle: f64, half: f64) -> (DVec2, f64) {
    (DVec2::from_angle(middle), half.cos())
}

fn hyperbola_point(middle: f64, half: f64) -> (DVec2, f64) {
    (DVec2::new(middle.cosh(), middle.sinh()), half.cosh())
}

fn arcs(
    frame: &Frame,
    radii: [f64; 2],
    [a, b]: [f64; 2],
    point: impl Fn(f64, f64) -> (DVec2, f64),
    longest: f64,
) -> Option<BsplineCurve<Homogeneous3>> {
    let count = ((b - a) / longest).ceil().clamp(1.0, MAX_PIECES);
    let at = |i: usize| if i as f64 == count { b } else { a + (b - a) * (i as f64 / count) };
    let control = |middle: f64, half: f64| {
        let (unit, weight) = point(middle, half);
        let local = (unit * DVec2::from_array(radii)).extend(0.0);
        (frame.vector(local) + frame.origin * weight).extend(weight)
    };
    let mut knots = vec![a];
    let mut points = Vec::new();
    for i in 0..count as usize {
        let (start, end) = (at(i), at(i + 1));
        knots.extend([start; 2]);
        points.extend([control(start, 0.0), control(0.5 * (start + end), 0.5 * (end - start))]);
    }
    knots.extend([b; 3]);
    points.push(control(b, 0.0));
    build(2, knots, points)
}

/// A closed B-spline over a range that leaves its domain: whole and partial rounds one after the other.
fn unrolled(spline: &BsplineCurve<Homogeneous3>, [a, b]: [f64; 2]) -> Option<BsplineCurve<Homogeneous3>> {
    let degree = spline.knots.degree();
    let [first, last] = spline.domain();
    let length = last - first;
    let rounds = [a, b].map(|t| ((t - first) / length).floor());
    if rounds.iter().any(|round| !round.is_finite()) || rounds[1] - rounds[0] >= MAX_PIECES {
        return None;
    }
    let mut knots: Vec<f64> = Vec::new();
    let mut points: Vec<Homogeneous3> = Vec::new();
    // Counted in whole numbers: beyond 2⁵³ a round and the next are the same.
    for i in 0..=(rounds[1] - rounds[0]) as u32 {
        let shift = (rounds[0] + f64::from(i)) * length;
        // Slivers at the seam come from rounding.
        let (low, high) = ((a - shift).max(first), (b - shift).min(last));
        if high - low <= 1e-12 * length {
            continue;
        }
        let Some(piece) = spline.piece(low, high) else { continue };
        let shifted = piece.knots.as_slice().iter().map(|knot| knot + shift);
        if points.is_empty() {
            knots.extend(shifted);
            points.extend(piece.points);
            continue;
        }
        // Joined C⁰: the shared knot stays `degree` times, and weights are scaled to agree at the shared point.
        let scale = points[points.len() - 1].w / piece.points[0].w;
        knots.truncate(knots.len() - 1);
        knots.extend(shifted.skip(degree + 1));
        points.extend(piece.points.iter().skip(1).map(|point| *point * scale));
    }
    // The seam's knot may differ from the next round's start by rounding; order is what matters.
    for i in 1..knots.len() {
        knots[i] = knots[i].max(knots[i - 1]);
    }
    build(degree, knots, points)
}

/// The ruled surface `profile(u) + v · direction`, v in `v_range` (in either order; of length 1 where it has none).
pub fn extrude(profile: &BsplineCurve<Homogeneous3>, direction: DVec3, v_range: [f64; 2]) -> BsplineSurface {
    let (low, high) = (v_range[0].min(v_range[1]), v_range[0].max(v_range[1]));
    let high = if low < high { high } else { low + 1.0 };
    let v_knots = KnotVector::new(1, vec![low, low, high, high], 2).unwrap_or_else(|_| unit_knots());
    let [low, high] = v_knots.domain();
    let moved = |point: &Homogeneous3, v: f64| *point + (direction * (v * point.w)).extend(0.0);
    let points = profile.points.iter().flat_map(|p| [moved(p, low), moved(p, high)]).collect();
    BsplineSurface::from_parts(profile.knots.clone(), v_knots, points)
}

fn unit_knots() -> KnotVector {
    KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0], 2).expect("the knots are good")
}

/// The full revolution of `profile` about the z axis of `axis`: u the angle's rational parameter, in [0, 2π] and equal to the
/// angle at quarter turns, closed; v the profile's parameter.
pub fn revolve(profile: &BsplineCurve<Homogeneous3>, axis: &Frame) -> BsplineSurface {
    const D: f64 = FRAC_1_SQRT_2;
    /// `(cos, sin, weight)`; the last equals the first bit for bit.
    const CIRCLE: [[f64; 3]; 9] = [
        [1.0, 0.0, 1.0],
        [D, D, D],
        [0.0, 1.0, 1.0],
        [-D, D, D],
        [-1.0, 0.0, 1.0],
        [-D, -D, D],
        [0.0, -1.0, 1.0],
        [D, -D, D],
        [1.0, 0.0, 1.0],
    ];
    let quarters = [0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4];
    let u_knots = quarters.map(|quarter| f64::from(quarter) * TAU / 4.0).to_vec();
    let u_knots = KnotVector::new(2, u_knots, CIRCLE.len()).expect("the knots are good");
    let turned = |point: &Homogeneous3| {
        let local = axis.local_vector(point.truncate() - axis.origin * point.w);
        CIRCLE.map(|[cos, sin, weight]| {
            let (x, y) = (local.x * cos - local.y * sin, local.x * sin + local.y * cos);
            let weight_here = weight * point.w;
            (axis.vector(DVec3::new(x, y, local.z * weight)) + axis.origin * weight_here).extend(weight_here)
        })
    };
    let columns: Vec<_> = profile.points.iter().flat_map(turned).collect();
    BsplineSurface::from_parts(u_knots, profile.knots.clone(), transposed(&columns, CIRCLE.len()))
}

/// The revolution of `profile` about the z axis of `axis` from angle `range[0]` to a greater `range[1]`: u agrees with the
/// angle at the ends and at equal parts of the range, v is the profile's parameter.
pub fn revolve_between(
    profile: &BsplineCurve<Homogeneous3>,
    axis: &Frame,
    range: [f64; 2],
) -> BsplineSurface {
    let circle = curve_to_bspline(&Curve::Circle { frame: Frame::IDENTITY, radius: 1.0 }, range);
    let turned = |on_circle: &Homogeneous3, point: &Homogeneous3| {
        let local = axis.local_vector(point.truncate() - axis.origin * point.w);
        let [cos, sin, _, weight] = on_circle.to_array();
        let (x, y) = (local.x * cos - local.y * sin, local.x * sin + local.y * cos);
        let weight_here = weight * point.w;
        (axis.vector(DVec3::new(x, y, local.z * weight)) + axis.origin * weight_here).extend(weight_here)
    };
    let points =
        circle.points.iter().flat_map(|c| profile.points.iter().map(move |p| turned(c, p))).collect();
    BsplineSurface::from_parts(circle.knots, profile.knots.clone(), points)
}

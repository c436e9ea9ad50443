//! Boxes around pieces of surfaces.
//!
//! On elementary surfaces each world coordinate is a trigonometric sum that is linear, or a single cosine, in each
//! parameter with the other one fixed; its range over a rectangle is exact. On B-splines the control points bound the
//! piece (convex hull), and patches are cut until their hulls add little to the box of surface points known so far.

use super::bezier::{BezierPatch, Homogeneous};
use super::bspline::BsplineSurface;
use super::decompose::{decompose_surface, patch_points};
use super::frame::Frame;
use super::surface::{ParameterBox, Surface};
use crate::numeric::Aabb;
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Rounding of a point of a surface, as a share of the magnitude of what is added up: some ten operations.
const ROUNDING: f64 = 32.0 * f64::EPSILON;
/// Hulls may stand out of the box of surface points by this share of its diagonal.
const SLACK: f64 = 0.01;
/// Cuts of one surface; what is left then is bounded by its control points.
const MAX_CUTS: usize = 2000;
/// Pieces whose patches have more control points than this are bounded by their own.
const MAX_PATCH_POINTS: usize = 1 << 22;

/// A box around the piece of `surface` over `range`; unlimited where the range is.
pub(super) fn surface_bounds(surface: &Surface, range: ParameterBox) -> Aabb {
    if let Surface::Bspline(spline) = surface {
        return bspline(spline, range);
    }
    if !(range.min.is_finite() && range.max.is_finite()) {
        return Aabb { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };
    }
    let (u, v) = ([range.min.x, range.max.x], [range.min.y, range.max.y]);
    match surface {
        Surface::Plane { frame } => {
            let corners = u.into_iter().flat_map(|u| v.map(|v| DVec3::new(u, v, 0.0)));
            around_points(frame, corners)
        }
        Surface::Cylinder { frame, radius } => {
            v.map(|v| circle(frame, *radius, v, u)).into_iter().fold(Aabb::EMPTY, Aabb::union)
        }
        // Between two parallels a cone is ruled, so the boxes of the two hold everything between them too.
        Surface::Cone { frame, radius, half_angle } => v
            .map(|v| circle(frame, radius + v * half_angle.tan(), v, u))
            .into_iter()
            .fold(Aabb::EMPTY, Aabb::union),
        Surface::Sphere { frame, radius } => torus(frame, 0.0, *radius, u, v),
        Surface::Torus { frame, major, minor } => torus(frame, *major, *minor, u, v),
        Surface::Bspline(_) => Aabb::EMPTY,
    }
}

fn around_points(frame: &Frame, points: impl Iterator<Item = DVec3>) -> Aabb {
    points.fold(Aabb::EMPTY, |bounds, local| {
        let margin = ROUNDING * (frame.origin.length() + local.length());
        bounds.union(Aabb::around([frame.point(local)]).grown(margin))
    })
}

/// Least and greatest `cos(t − phase)` for t in `range`.
fn cosine_range(range: [f64; 2], phase: f64) -> [f64; 2] {
    let [a, b] = [range[0] - phase, range[1] - phase];
    // Whether `offset + 2πk` lies in the range for some k; a little wider, so that rounding does not lose an extremum.
    let contains = |offset: f64| {
        let margin = 1e-12 * (1.0 + a.abs().max(b.abs()));
        ((a - margin - offset) / TAU).ceil() * TAU + offset <= b + margin
    };
    let (first, last) = (a.cos(), b.cos());
    [if contains(PI) { -1.0 } else { first.min(last) }, if contains(0.0) { 1.0 } else { first.max(last) }]
}

/// `radius` may be negative: the far nappe of a cone.
fn circle(frame: &Frame, radius: f64, height: f64, u: [f64; 2]) -> Aabb {
    let mut bounds = Aabb::EMPTY;
    for axis in 0..3 {
        let (x, y, z) = (frame.x[axis], frame.y[axis], frame.z[axis]);
        let center = frame.origin[axis] + z * height;
        let amplitude = radius * x.hypot(y);
        let ends = cosine_range(u, y.atan2(x)).map(|cosine| amplitude * cosine);
        let margin = ROUNDING * (frame.origin[axis].abs() + height.abs() + radius.abs());
        bounds.min[axis] = center + ends[0].min(ends[1]) - margin;
        bounds.max[axis] = center + ends[0].max(ends[1]) + margin;
    }
    bounds
}

fn torus(frame: &Frame, major: f64, minor: f64, u: [f64; 2], v: [f64; 2]) -> Aabb {
    let mut bounds = Aabb::EMPTY;
    for axis in 0..3 {
        let (x, y, z) = (frame.x[axis], frame.y[axis], frame.z[axis]);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        // With c = A cos(u − φ) the coordinate is R c + r (c cos v + z sin v): linear in c, a single cosine in v.
        for cosine in cosine_range(u, y.atan2(x)) {
            let c = x.hypot(y) * cosine;
            let [least, greatest] = cosine_range(v, z.atan2(c)).map(|cosine| minor * c.hypot(z) * cosine);
            low = low.min(major * c + least);
            high = high.max(major * c + greatest);
        }
        let margin = ROUNDING * (frame.origin[axis].abs() + major + minor);
        bounds.min[axis] = frame.origin[axis] + low - margin;
        bounds.max[axis] = frame.origin[axis] + high + margin;
    }
    bounds
}

fn bspline(surface: &BsplineSurface, range: ParameterBox) -> Aabb {
    let domain = surface.domain();
    let ranges = |axis: usize| {
        let limits = [domain.min[axis], domain.max[axis]];
        inside([range.min[axis], range.max[axis]], limits, surface.closed[axis])
    };
    let v_ranges = ranges(1);
    let boxes = ranges(0).into_iter().flat_map(|u| v_ranges.iter().map(move |v| (u, *v)));
    let mut bounds = boxes.fold(Aabb::EMPTY, |bounds, (u, v)| bounds.union(piece_bounds(surface, u, v)));
    let reach = bounds.min.abs().max(bounds.max.abs()).max_element();
    bounds = bounds.grown(ROUNDING * reach);
    bounds
}

/// The parts of a domain that `range` covers, wrapped where it is closed, else clamped; each of some width.
fn inside(range: [f64; 2], [first, last]: [f64; 2], closed: bool) -> Vec<[f64; 2]> {
    let length = last - first;
    let [low, high] = range;
    if !(low.is_finite() && high.is_finite()) || (closed && high - low >= length) {
        return vec![[first, last]];
    }
    let wide = |[a, b]: [f64; 2]| {
        let (a, b) = (a.clamp(first, last), b.clamp(first, last));
        // A range without width gets some: no piece of a B-spline is narrower than a rounding error.
        let widening = if b - a < 1e-9 * length { 1e-9 * length } else { 0.0 };
        [(a - widening).max(first), (b + widening).min(last)]
    };
    if !closed || (first <= low && high <= last) {
        return vec![wide([low, high])];
    }
    let start = super::curve::wrap(low, [first, last]);
    let end = start + (high - low);
    if end <= last {
        vec![wide([start, end])]
    } else {
        vec![wide([start, last]), wide([first, end - length])]
    }
}

fn piece_bounds(surface: &BsplineSurface, u: [f64; 2], v: [f64; 2]) -> Aabb {
    let Some(piece) = surface.piece(u, v) else { return around(&surface.points) };
    let mut inner =
        Aabb::around(u.into_iter().flat_map(|u| v.map(|v| DVec2::new(u, v))).map(|uv| surface.point(uv)));
    let fits = |hull: Aabb, inner: Aabb| {
        let grown = inner.grown(SLACK * inner.diagonal());
        grown.min.cmple(hull.min).all() && hull.max.cmple(grown.max).all()
    };
    let whole = around(&piece.points);
    if fits(whole, inner) || patch_points(&piece) > MAX_PATCH_POINTS {
        return whole;
    }
    let mut patches: Vec<BezierPatch> = decompose_surface(&piece).map(|span| span.patch).collect();
    let corners = |patch: &BezierPatch| {
        let [p, q] = patch.degrees;
        Aabb::around([(0, 0), (p, 0), (0, q), (p, q)].map(|(i, j)| Homogeneous::point(patch.point(i, j))))
    };
    inner = patches.iter().map(corners).fold(inner, Aabb::union);
    let mut outer = inner;
    let mut cuts = 0;
    while let Some(patch) = patches.pop() {
        let hull = around(&patch.points);
        if fits(hull, inner) || cuts >= MAX_CUTS {
            outer = outer.union(hull);
            continue;
        }
        cuts += 1;
        for (u, v) in [
            ([0.0, 0.5], [0.0, 0.5]),
            ([0.0, 0.5], [0.5, 1.0]),
            ([0.5, 1.0], [0.0, 0.5]),
            ([0.5, 1.0], [0.5, 1.0]),
        ] {
            let quarter = patch.piece(u, v);
            inner = inner.union(corners(&quarter));
            patches.push(quarter);
        }
    }
    outer
}

fn around(points: &[super::Homogeneous3]) -> Aabb {
    Aabb::around(points.iter().map(|p| Homogeneous::point(*p)))
}

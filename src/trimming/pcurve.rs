//! The image of a 3-D edge in the parameter plane of a surface.
//!
//! On a plane the image is exact: the affine image of the edge's rational B-spline form. On every other surface it is
//! marched and fitted (see `fit`), piece by piece between the edge's corners and the surface's poles. Images run in the
//! direction of the loop and live in the universal cover of a periodic surface: each starts near where the last ended.
//!
//! The file's own pcurves often lie: they belong to another surface, are shifted by a period, or are approximate. One that
//! lies on the edge tells where to look for each point, which matters where a surface comes near itself; the point
//! itself is found by projection all the same.

use super::TrimError;
use super::fit::fit;
use super::segment::{Segment, control, end, reversed, set_start, start, straight, with_unit_ends};
use super::straighten::straightened;
use super::target::Target;
use crate::brep::{Coedge, Edge, Id, Model};
use crate::geometry::to_bspline::curve_to_bspline;
use crate::geometry::{Bezier, Curve, Curve2, Frame, Homogeneous, Surface, decompose_curve, invert_curve};
use glam::{DVec2, DVec3};

/// The file's pcurve is believed where it is nowhere farther from the edge than this share of the face.
const BELIEVED: f64 = 1e-3;

/// A piece of an edge, smooth and without a pole inside.
pub(super) struct Piece<'a> {
    pub(super) curve: &'a Curve,
    /// First and last parameter, in the direction of the loop.
    pub(super) range: [f64; 2],
    /// Poles at its ends.
    pub(super) poles: [Option<usize>; 2],
    /// The file's own image, where it is believed.
    pub(super) hint: Option<&'a Curve2>,
    /// For messages.
    pub(super) entity: u64,
}

/// The image of an edge, or of the part of one between two poles.
pub(super) struct EdgeImage {
    pub(super) edge: Id<Edge>,
    /// At least one.
    pub(super) segments: Vec<Segment>,
    /// Poles of the surface at start and end.
    pub(super) poles: [Option<usize>; 2],
    /// A bound of the distance between image and edge, millimetres.
    pub(super) deviation: f64,
}

/// An edge in the direction of its loop.
#[derive(Clone, Copy)]
pub(super) struct DirectedEdge<'a> {
    pub(super) id: Id<Edge>,
    pub(super) edge: &'a Edge,
    /// Curve parameters at start and end in the loop's direction.
    pub(super) range: [f64; 2],
    /// Position in space of start and end.
    pub(super) ends: [DVec3; 2],
}

impl<'a> DirectedEdge<'a> {
    pub(super) fn new(model: &'a Model, coedge: Coedge) -> Result<Self, TrimError> {
        let edge = &model.edges[coedge.edge];
        let is_reversed = coedge.reversed;
        let range = if is_reversed { [edge.range[1], edge.range[0]] } else { edge.range };
        let failed = || TrimError::Numeric(format!("edge #{} has no finite range or points", edge.entity));
        if !range.iter().all(|t| t.is_finite()) {
            return Err(failed());
        }
        let ends = range.map(|t| edge.curve.point(t));
        ends.iter()
            .all(|p| p.is_finite())
            .then_some(Self { id: coedge.edge, edge, range, ends })
            .ok_or_else(failed)
    }

    pub(super) fn flipped(self) -> Self {
        let ([a, b], [p, q]) = (self.range, self.ends);
        Self { range: [b, a], ends: [q, p], ..self }
    }

    /// Points along the edge, ends included.
    pub(super) fn samples(&self) -> impl Iterator<Item = DVec3> + '_ {
        let [a, b] = self.range;
        (0..=8).map(move |i| self.edge.curve.point(a + (b - a) * f64::from(i) / 8.0))
    }
}

/// The images of `edge` between poles, in order; none where the edge has no length.
pub(super) fn edge_images(
    target: &Target,
    edge: &DirectedEdge,
    seed: Option<DVec2>,
) -> Result<Vec<EdgeImage>, TrimError> {
    let reach = edge.samples().map(|p| p.distance(edge.ends[0])).fold(0.0, f64::max);
    if reach <= target.tolerance {
        return Ok(Vec::new());
    }
    if let Surface::Plane { frame } = target.surface {
        return image_on_plane(target, frame, edge).map(|image| vec![image]);
    }
    let mut times = vec![edge.range[0]];
    times.extend(pole_crossings(target, edge));
    times.push(edge.range[1]);
    let hint = believed(target, edge);
    let mut images = Vec::new();
    let mut seed = seed;
    for range in times.windows(2) {
        let image = image_between(target, edge, [range[0], range[1]], hint, seed)?;
        seed = image.segments.last().map(end);
        images.push(image);
    }
    Ok(images)
}

/// The image over `range`, which has no pole inside.
fn image_between(
    target: &Target,
    edge: &DirectedEdge,
    range: [f64; 2],
    hint: Option<&Curve2>,
    mut seed: Option<DVec2>,
) -> Result<EdgeImage, TrimError> {
    let curve = &edge.edge.curve;
    let poles = range.map(|t| target.pole_at(curve.point(t)));
    let mut times = vec![range[0]];
    times.extend(curve.breaks(range).into_iter().filter(|t| {
        let s = (t - range[0]) / (range[1] - range[0]);
        s > 1e-9 && s < 1.0 - 1e-9
    }));
    times.push(range[1]);
    let mut image = EdgeImage { edge: edge.id, segments: Vec::new(), poles, deviation: 0.0 };
    let last = times.len() - 2;
    for (i, part) in times.windows(2).enumerate() {
        let part_poles = [poles[0].filter(|_| i == 0), poles[1].filter(|_| i == last)];
        let entity = edge.edge.entity;
        let piece = Piece { curve, range: [part[0], part[1]], poles: part_poles, hint, entity };
        // A pole has no parameters to start from.
        let fitted = fit(target, &piece, seed.filter(|_| part_poles[0].is_none()))?;
        let mut segments = fitted.segments;
        if let (Some(before), Some(first)) = (image.segments.last(), segments.first_mut()) {
            let joint = end(before);
            if start(first).distance(joint) <= 1e-3 * (end(first).distance(start(first))) {
                set_start(first, joint);
            } else if start(first) != joint {
                segments.insert(0, straight(joint, start(&segments[0])));
            }
        }
        image.segments.append(&mut segments);
        image.deviation = image.deviation.max(fitted.deviation);
        seed = image.segments.last().map(end);
    }
    if let Some((segment, moved)) = straightened(target, &image.segments) {
        image.segments = vec![segment];
        image.deviation += moved;
    }
    Ok(image)
}

/// The file's own image of the edge on this surface, where it lies on the edge.
fn believed<'a>(target: &Target, edge: &DirectedEdge<'a>) -> Option<&'a Curve2> {
    let [a, b] = edge.range;
    let limit = BELIEVED * target.size + target.tolerance;
    let lies_on_edge = |curve: &Curve2| {
        (0..=8).all(|i| {
            let t = a + (b - a) * f64::from(i) / 8.0;
            let uv = curve.point(t);
            uv.is_finite() && target.surface.point(uv).distance(edge.edge.curve.point(t)) <= limit
        })
    };
    let own = edge.edge.pcurves.iter().filter(|pcurve| pcurve.surface == target.id);
    own.map(|pcurve| &pcurve.curve).find(|curve| lies_on_edge(curve))
}

/// Parameters strictly inside the edge where it runs through a pole, in its direction.
fn pole_crossings(target: &Target, edge: &DirectedEdge) -> Vec<f64> {
    let [a, b] = edge.range;
    let curve = &edge.edge.curve;
    let mut crossings: Vec<f64> = target
        .poles
        .iter()
        .filter_map(|pole| {
            let mut t = invert_curve(curve, pole.point, None);
            if let Some(period) = curve.period() {
                t += ((a.min(b) - t) / period).ceil() * period;
            }
            let share = (t - a) / (b - a);
            let inside = share > 1e-6 && share < 1.0 - 1e-6;
            let point = curve.point(t);
            let near = target.pole_tolerance() + pole.radius;
            let is_end = edge.ends.iter().any(|p| p.distance(point) <= target.pole_tolerance() + 2.0 * near);
            (inside && !is_end && point.distance(pole.point) <= near).then_some(t)
        })
        .collect();
    crossings.sort_by(|x, y| if a <= b { x.total_cmp(y) } else { y.total_cmp(x) });
    // The poles of an almost horned torus are one.
    crossings.dedup_by(|x, y| curve.point(*x).distance(curve.point(*y)) <= 2.0 * target.pole_tolerance());
    crossings
}

/// Exact but for the distance of the edge from the plane.
fn image_on_plane(target: &Target, frame: &Frame, edge: &DirectedEdge) -> Result<EdgeImage, TrimError> {
    let [a, b] = edge.range;
    let flat = |p: DVec3| frame.local_point(p).truncate();
    let height = |p: DVec3| frame.local_point(p).z.abs();
    target.check_distance(edge.samples().map(height).fold(0.0, f64::max), edge.edge.entity)?;
    // The curve lies in the hull of its control points, and height is linear.
    let mut deviation = edge.ends.map(height).into_iter().fold(0.0, f64::max);
    let mut segments = Vec::new();
    if let Curve::Line { .. } = edge.edge.curve {
        segments.push(straight(flat(edge.ends[0]), flat(edge.ends[1])));
    } else {
        for span in decompose_curve(&curve_to_bspline(&edge.edge.curve, [a.min(b), a.max(b)])) {
            deviation = span.bezier.points.iter().map(|p| height(p.point())).fold(deviation, f64::max);
            let points = span.bezier.points.iter().map(|p| control(flat(p.point()), p.weight())).collect();
            let segment = with_unit_ends(Bezier { points }).ok_or_else(|| {
                TrimError::Numeric(format!("edge #{} has points that are not finite", edge.edge.entity))
            })?;
            segments.push(segment);
        }
        if a > b {
            segments.reverse();
            segments = segments.into_iter().map(reversed).collect();
        }
    }
    if segments.is_empty() {
        return Err(TrimError::Numeric(format!("edge #{} has no pieces", edge.edge.entity)));
    }
    Ok(EdgeImage { edge: edge.id, segments, poles: [None; 2], deviation })
}

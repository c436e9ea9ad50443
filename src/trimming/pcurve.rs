//! The image of a 3-D edge in the parameter plane of a surface.
//!
//! On a plane the image is exact: the affine image of the edge's rational B-spline form. On every other surface it is
//! marched and fitted (see `fit`), piece by piece between the edge's corners and the surface's poles. Images run in the
//! direction of the loop and live in the universal cover of a periodic surface: each starts near where the last ended.

use super::TrimError;
use super::fit::{Piece, fit};
use super::segment::{Segment, control, end, reversed, start, straight, with_unit_ends};
use super::target::Target;
use crate::brep::Edge;
use crate::geometry::to_bspline::curve_to_bspline;
use crate::geometry::{Bezier, Curve, Frame, Homogeneous, Surface, decompose_curve, invert_curve};
use glam::{DVec2, DVec3};

/// The image of an edge, or of the part of one between two poles.
pub(super) struct EdgeImage {
    /// At least one.
    pub(super) segments: Vec<Segment>,
    /// Poles of the surface at start and end.
    pub(super) poles: [Option<usize>; 2],
    /// The greatest distance between image and edge, millimetres.
    pub(super) deviation: f64,
}

/// An edge in the direction of its loop.
#[derive(Clone, Copy)]
pub(super) struct DirectedEdge<'a> {
    pub(super) edge: &'a Edge,
    /// Curve parameters at start and end in the loop's direction.
    pub(super) range: [f64; 2],
    /// Position in space of start and end.
    pub(super) ends: [DVec3; 2],
}

impl<'a> DirectedEdge<'a> {
    pub(super) fn new(edge: &'a Edge, is_reversed: bool) -> Result<Self, TrimError> {
        let range = if is_reversed { [edge.range[1], edge.range[0]] } else { edge.range };
        let failed = || TrimError::Numeric(format!("edge #{} has no finite range or points", edge.entity));
        if !range.iter().all(|t| t.is_finite()) {
            return Err(failed());
        }
        let ends = range.map(|t| edge.curve.point(t));
        ends.iter().all(|p| p.is_finite()).then_some(Self { edge, range, ends }).ok_or_else(failed)
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
    let mut images = Vec::new();
    let mut seed = seed;
    for range in times.windows(2) {
        let image = image_between(target, edge, [range[0], range[1]], seed)?;
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
    let mut image = EdgeImage { segments: Vec::new(), poles, deviation: 0.0 };
    let last = times.len() - 2;
    for (i, part) in times.windows(2).enumerate() {
        let part_poles = [poles[0].filter(|_| i == 0), poles[1].filter(|_| i == last)];
        let piece = Piece { curve, range: [part[0], part[1]], poles: part_poles, entity: edge.edge.entity };
        // A pole has no parameters to start from.
        let fitted = fit(target, &piece, seed.filter(|_| part_poles[0].is_none()))?;
        let mut segments = fitted.segments;
        if let (Some(before), Some(first)) = (image.segments.last(), segments.first_mut()) {
            let joint = end(before);
            if start(first).distance(joint) <= 1e-3 * (end(first).distance(start(first))) {
                super::segment::set_start(first, joint);
            } else if start(first) != joint {
                segments.insert(0, straight(joint, start(&segments[0])));
            }
        }
        image.segments.append(&mut segments);
        image.deviation = image.deviation.max(fitted.deviation);
        seed = image.segments.last().map(end);
    }
    Ok(image)
}

/// Parameters strictly inside the edge where it runs through a pole, in its direction.
fn pole_crossings(target: &Target, edge: &DirectedEdge) -> Vec<f64> {
    let [a, b] = edge.range;
    let curve = &edge.edge.curve;
    let mut crossings: Vec<f64> = target
        .singularities
        .iter()
        .filter_map(|singularity| {
            let mut t = invert_curve(curve, singularity.point, None);
            if let Some(period) = curve.period() {
                t += ((a.min(b) - t) / period).ceil() * period;
            }
            let share = (t - a) / (b - a);
            let inside = share > 1e-6 && share < 1.0 - 1e-6;
            let meets = curve.point(t).distance(singularity.point) <= target.pole_tolerance();
            (inside && meets).then_some(t)
        })
        .collect();
    crossings.sort_by(|x, y| if a <= b { x.total_cmp(y) } else { y.total_cmp(x) });
    crossings.dedup();
    crossings
}

/// Exact but for the distance of the edge from the plane.
fn image_on_plane(target: &Target, frame: &Frame, edge: &DirectedEdge) -> Result<EdgeImage, TrimError> {
    let [a, b] = edge.range;
    let flat = |p: DVec3| frame.local_point(p).truncate();
    let mut deviation: f64 = 0.0;
    let mut segments = Vec::new();
    if let Curve::Line { .. } = edge.edge.curve {
        segments.push(straight(flat(edge.ends[0]), flat(edge.ends[1])));
    } else {
        for span in decompose_curve(&curve_to_bspline(&edge.edge.curve, [a.min(b), a.max(b)])) {
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
    for point in edge.samples() {
        deviation = deviation.max(frame.local_point(point).z.abs());
    }
    target.check_distance(deviation, edge.edge.entity)?;
    if segments.is_empty() {
        return Err(TrimError::Numeric(format!("edge #{} has no pieces", edge.edge.entity)));
    }
    Ok(EdgeImage { segments, poles: [None; 2], deviation })
}

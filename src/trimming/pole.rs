//! Iso-lines that are points: poles, apexes, collapsed sides; and those that edges take for points.
//!
//! Files hold cones as surfaces of revolution whose generator misses the axis by a little, so that there is a small hole
//! where the apex should be, and edges that end in the middle of it. No projection has a direction there: one parameter
//! swings by half a period within the width of the hole. Such a hole is a pole with a radius.

use super::pcurve::DirectedEdge;
use super::target::Target;
use crate::geometry::{Homogeneous, Surface};
use glam::DVec3;
use std::f64::consts::PI;

/// A hole around a missing apex is at most this share of the size of the face.
const LARGEST_HOLE: f64 = 1e-2;

/// An iso-line that is a point, or almost one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pole {
    /// The parameter that is constant on it: 0 for u, 1 for v.
    pub(super) axis: usize,
    /// Its value.
    pub(super) value: f64,
    /// The point in space.
    pub(super) point: DVec3,
    /// The greatest distance of the iso-line from `point`, millimetres.
    pub(super) radius: f64,
}

/// The iso-lines of `surface` that are points.
pub(super) fn poles(surface: &Surface) -> Vec<Pole> {
    let exact = surface.singularities().into_iter();
    exact.map(|s| Pole { axis: s.axis, value: s.value, point: s.point, radius: 0.0 }).collect()
}

impl Target<'_> {
    /// Adds the closed iso-lines that the edges take for a point: some edge ends on it coming from far away, and none runs
    /// along it.
    pub(super) fn add_holes(&mut self, edges: &[&[DirectedEdge]]) {
        for hole in holes(self.surface) {
            let is_known = self.poles.iter().any(|pole| pole.axis == hole.axis && pole.value == hole.value);
            if is_known || hole.radius > LARGEST_HOLE * self.size {
                continue;
            }
            let near = 2.0 * hole.radius + self.tolerance;
            let distance = |p: &DVec3| p.distance(hole.point);
            let reach = |edge: &DirectedEdge| edge.samples().map(|p| distance(&p)).fold(0.0, f64::max);
            let all = || edges.iter().copied().flatten();
            let is_met = |edge: &DirectedEdge| {
                edge.ends.iter().any(|p| distance(p) <= near) && reach(edge) > 4.0 * near
            };
            if all().any(is_met) && all().all(|edge| reach(edge) > near) {
                self.poles.push(hole);
            }
        }
    }
}

/// The closed iso-lines that may be narrow: sides of B-splines, the inner equator of a torus.
fn holes(surface: &Surface) -> Vec<Pole> {
    match surface {
        Surface::Torus { frame, major, minor } if major > minor => {
            vec![Pole { axis: 1, value: PI, point: frame.origin, radius: major - minor }]
        }
        Surface::Bspline(spline) => {
            let domain = spline.domain();
            let sides = [(0, false), (0, true), (1, false), (1, true)].into_iter();
            let closed = sides.filter(|&(axis, _)| spline.closed[1 - axis] && !spline.closed[axis]);
            let hole = |(axis, last)| {
                let side = || spline.side(axis, last).map(Homogeneous::point);
                let point = side().sum::<DVec3>() / side().count() as f64;
                let radius = side().map(|p| p.distance(point)).fold(0.0, f64::max);
                Pole { axis, value: if last { domain.max[axis] } else { domain.min[axis] }, point, radius }
            };
            closed.map(hole).collect()
        }
        _ => Vec::new(),
    }
}

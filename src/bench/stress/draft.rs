//! Models made in code: bodies of faces, loops of edges, nets from functions.

use crate::brep::{Body, BodyKind, Coedge, Edge, Face, Id, Model, Part, TrimLoop, Vertex, primitive};
use crate::geometry::{BsplineSurface, Curve, Frame, Homogeneous, Homogeneous3, Surface, to_bspline};
use glam::{DVec2, DVec3};

/// A model on its way: one part with one body after the other.
#[derive(Default)]
pub(super) struct Draft {
    pub(super) model: Model,
    bodies: Vec<Body>,
}

impl Draft {
    /// Adds faces that enclose a volume; nothing where there are none.
    pub(super) fn solid(&mut self, faces: Option<Vec<Id<Face>>>) {
        self.body(BodyKind::Solid, faces.unwrap_or_default());
    }

    /// Adds a face that is a body of its own, bounded by `loops` or by the surface's own sides.
    pub(super) fn sheet(&mut self, surface: Surface, loops: Vec<TrimLoop>) {
        let face = self.face(surface, loops);
        self.body(BodyKind::Sheet, vec![face]);
    }

    pub(super) fn face(&mut self, surface: Surface, loops: Vec<TrimLoop>) -> Id<Face> {
        let surface = self.model.surfaces.push(surface);
        let entity = self.model.faces.len() as u64 + 1;
        let face = Face { surface, same_sense: true, loops, color: None, name: String::new(), entity };
        self.model.faces.push(face)
    }

    /// A closed loop of pieces of curves, each of which starts where the one before ends.
    pub(super) fn chain(&mut self, pieces: Vec<(Curve, [f64; 2])>) -> TrimLoop {
        let point = |(curve, range): &(Curve, [f64; 2])| curve.point(range[0]);
        let vertices: Vec<Id<Vertex>> = pieces
            .iter()
            .map(|piece| self.model.vertices.push(Vertex { point: point(piece), entity: 0 }))
            .collect();
        let count = vertices.len();
        let coedges = pieces.into_iter().enumerate().map(|(i, (curve, range))| {
            let ends = [vertices[i], vertices[(i + 1) % count]];
            let edge = Edge { curve, range, vertices: ends, pcurves: Vec::new(), entity: 0 };
            Coedge { edge: self.model.edges.push(edge), reversed: false }
        });
        TrimLoop::Edges(coedges.collect())
    }

    /// A loop of straight edges.
    pub(super) fn polygon(&mut self, points: &[DVec3]) -> TrimLoop {
        let next = points.iter().cycle().skip(1);
        self.chain(points.iter().zip(next).map(|(&from, &to)| (line(from, to), [0.0, 1.0])).collect())
    }

    pub(super) fn finished(mut self) -> Model {
        let part = Part { name: "stress".into(), bodies: self.bodies, children: vec![], entity: 1 };
        let root = self.model.parts.push(part);
        self.model.roots.push(root);
        self.model.declared_faces = self.model.faces.len();
        self.model
    }

    fn body(&mut self, kind: BodyKind, faces: Vec<Id<Face>>) {
        let entity = self.bodies.len() as u64 + 1;
        self.bodies.push(Body { kind, faces, name: String::new(), entity });
    }
}

pub(super) fn line(from: DVec3, to: DVec3) -> Curve {
    Curve::Line { origin: from, direction: to - from }
}

/// The frame of world coordinates, moved.
pub(super) fn frame_at(x: f64, y: f64, z: f64) -> Frame {
    Frame { origin: DVec3::new(x, y, z), ..Frame::IDENTITY }
}

/// Clamped knots over [0, 1].
pub(super) fn knots(degree: usize, inner: &[f64]) -> Vec<f64> {
    let end = |value: f64| std::iter::repeat_n(value, degree + 1);
    end(0.0).chain(inner.iter().copied()).chain(end(1.0)).collect()
}

/// A rational B-spline whose control point (i, j) of m × n is `point(i / (m − 1), j / (n − 1))` with the weight `weight(i, j)`.
pub(super) fn net(
    degrees: [usize; 2],
    knots: [Vec<f64>; 2],
    point: impl Fn(f64, f64) -> DVec3,
    weight: impl Fn(usize, usize) -> f64,
) -> BsplineSurface {
    let [m, n] = [0, 1].map(|k| knots[k].len() - degrees[k] - 1);
    let share = |i: usize, count: usize| i as f64 / (count - 1) as f64;
    let place = |i: usize, j: usize| Homogeneous::new(point(share(i, m), share(j, n)), weight(i, j));
    let points: Vec<Homogeneous3> =
        (0..m).flat_map(|i| (0..n).map(move |j| (i, j))).map(|(i, j)| place(i, j)).collect();
    BsplineSurface::new(degrees, knots, points).expect("proper knots and points")
}

/// A sheet of 10 × 10 mm with waves of about 1 mm around `height`: bicubic, 4 × 4 spans, of mildly different weights.
pub(super) fn wavy(height: f64) -> BsplineSurface {
    let inner = [0.25, 0.5, 0.75];
    let point = |s: f64, t: f64| {
        DVec3::new(10.0 * s, 10.0 * t, height + 2.0 * (9.0 * s).sin() * (7.0 * t + 0.5).cos())
    };
    net([3, 3], [knots(3, &inner), knots(3, &inner)], point, |i, j| 1.0 + 0.25 * ((i + 2 * j) % 3) as f64)
}

/// A rational cubic turned around z, a closed B-spline with two poles.
pub(super) fn egg() -> BsplineSurface {
    let profile = [[0.0, -4.0], [5.0, -5.0], [3.0, 4.0], [0.0, 5.0]];
    let points = profile.map(|[x, z]| Homogeneous::new(DVec3::new(x, 0.0, z), 1.0)).to_vec();
    let profile = crate::geometry::BsplineCurve::new(3, knots(3, &[]), points).expect("proper knots");
    to_bspline::revolve(&profile, &Frame::IDENTITY)
}

/// A block, a cylinder, a cone, a sphere and a torus beside each other, 1 to 8 mm large; block corners have whole coordinates.
pub(super) fn analytic_solids() -> Model {
    let mut draft = Draft::default();
    let model = &mut draft.model;
    let block = primitive::block(model, &frame_at(0.0, 0.0, 0.0), DVec3::new(6.0, 4.0, 2.0), 1);
    let cylinder = primitive::frustum(model, &frame_at(9.0, 2.0, 0.0), [2.0, 2.0], 5.0, 2);
    let cone = primitive::frustum(model, &frame_at(3.0, 8.0, 0.0), [2.0, 0.0], 4.0, 3);
    let sphere = primitive::sphere(model, &frame_at(9.0, 8.0, 3.0), 2.0, 4);
    let torus = primitive::torus(model, &frame_at(6.0, 5.0, 8.0), [3.0, 1.0], 5);
    [block, cylinder, cone, sphere, torus].into_iter().for_each(|faces| draft.solid(faces));
    draft.finished()
}

/// The [`egg`] as a solid.
pub(super) fn egg_solid() -> Model {
    let mut draft = Draft::default();
    let face = draft.face(Surface::Bspline(egg()), vec![]);
    draft.solid(Some(vec![face]));
    draft.finished()
}

/// A model of one sheet without trims.
pub(super) fn sheet_model(surface: BsplineSurface) -> Model {
    let mut draft = Draft::default();
    draft.sheet(Surface::Bspline(surface), vec![]);
    draft.finished()
}

/// Points of `lines + 1` iso-lines in either direction of a bounded surface, `per_side + 1` of each.
pub(super) fn iso_points(surface: &Surface, lines: usize, per_side: usize) -> Vec<DVec3> {
    let domain = surface.domain();
    let share = |i: usize, count: usize| i as f64 / count as f64;
    let at = |s: f64, t: f64| surface.point(domain.min + (domain.max - domain.min) * DVec2::new(s, t));
    let pairs = (0..=lines).flat_map(|i| (0..=per_side).map(move |j| (i, j)));
    pairs
        .flat_map(|(i, j)| {
            let (s, t) = (share(i, lines), share(j, per_side));
            [at(s, t), at(t, s)]
        })
        .collect()
}

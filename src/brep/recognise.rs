//! B-spline surfaces that are elementary, in a whole model.
//!
//! Some systems write all surfaces as B-splines, and planes and cylinders among them are most of every part: as what they
//! are they have closed forms everywhere. This is done to the model, after the reading of any format, because the faces on a
//! surface and the pcurves in its parameters have to follow. Faces without edges keep their B-spline, whose sides bound them.

use super::{Id, Model, TrimLoop};
use crate::geometry::{RECOGNITION_TOLERANCE, Surface, recognise};
use rayon::prelude::*;

/// Replaces B-spline surfaces by the elementary ones that they are within [`RECOGNITION_TOLERANCE`], and counts them in
/// `model.recognised`.
pub fn recognise_surfaces(model: &mut Model) {
    let mut candidates = vec![false; model.surfaces.len()];
    let mut bounded = vec![true; model.surfaces.len()];
    for face in model.faces.iter() {
        let has_edges =
            |trim_loop: &TrimLoop| matches!(trim_loop, TrimLoop::Edges(edges) if !edges.is_empty());
        let index = face.surface.index();
        candidates[index] = true;
        bounded[index] &= face.loops.iter().any(has_edges);
    }
    let ids: Vec<Id<Surface>> =
        model.surfaces.ids().filter(|id| candidates[id.index()] && bounded[id.index()]).collect();
    let surfaces = &model.surfaces;
    let found: Vec<(Id<Surface>, Surface, bool)> = ids
        .into_par_iter()
        .filter_map(|id| {
            let Surface::Bspline(spline) = &surfaces[id] else { return None };
            let (surface, flipped) = recognise(spline, RECOGNITION_TOLERANCE * spline.size())?;
            Some((id, surface, flipped))
        })
        .collect();
    if found.is_empty() {
        return;
    }
    let mut is_flipped: Vec<Option<bool>> = vec![None; model.surfaces.len()];
    for (id, surface, flipped) in found {
        *model.recognised.entry(surface.kind()).or_default() += 1;
        model.surfaces[id] = surface;
        is_flipped[id.index()] = Some(flipped);
    }
    for id in model.faces.ids() {
        let face = &mut model.faces[id];
        face.same_sense ^= is_flipped[face.surface.index()] == Some(true);
    }
    for id in model.edges.ids() {
        model.edges[id].pcurves.retain(|pcurve| is_flipped[pcurve.surface.index()].is_none());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::{Coedge, Edge, Face, Pcurve, Vertex};
    use crate::geometry::{BsplineSurface, Curve, Curve2, Homogeneous, Homogeneous3};
    use glam::{DVec2, DVec3};

    /// A bilinear net over the unit square whose normal is −z, and its diagonal as an edge.
    fn model(height: f64, with_edge: bool) -> Model {
        let mut model = Model::default();
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, height]];
        let points: Vec<Homogeneous3> =
            corners.iter().map(|&p| Homogeneous::new(DVec3::from_array(p), 1.0)).collect();
        let knots = || vec![0.0, 0.0, 1.0, 1.0];
        let net = BsplineSurface::new([1, 1], [knots(), knots()], points).expect("proper");
        let surface = model.surfaces.push(Surface::Bspline(net));
        let ends = [DVec3::ZERO, DVec3::ONE].map(|point| model.vertices.push(Vertex { point, entity: 0 }));
        let image = Curve2::Line { origin: DVec2::ZERO, direction: DVec2::ONE };
        let edge = model.edges.push(Edge {
            curve: Curve::Line { origin: DVec3::ZERO, direction: DVec3::ONE },
            range: [0.0, 1.0],
            vertices: ends,
            pcurves: vec![Pcurve { surface, curve: image }],
            entity: 0,
        });
        let loops = if with_edge {
            vec![TrimLoop::Edges(vec![Coedge { edge, reversed: false }])]
        } else {
            Vec::new()
        };
        let (color, name) = (None, String::new());
        model.faces.push(Face { surface, same_sense: true, loops, color, name, entity: 0 });
        model
    }

    #[test]
    fn faces_and_pcurves_follow_their_surface() {
        let mut flat = model(0.0, true);
        let outward = |model: &Model| {
            let face = &model.faces[Id::new(0)];
            let d = model.surfaces[face.surface].derivatives(DVec2::splat(0.25));
            d.du.cross(d.dv).normalize() * if face.same_sense { 1.0 } else { -1.0 }
        };
        let before = outward(&flat);
        recognise_surfaces(&mut flat);
        assert_eq!(flat.recognised.get("plane"), Some(&1));
        assert!(outward(&flat).distance(before) < 1e-12);
        assert!(flat.edges[Id::new(0)].pcurves.is_empty());
    }

    #[test]
    fn others_stay() {
        for mut model in [model(0.1, true), model(0.0, false)] {
            recognise_surfaces(&mut model);
            assert!(model.recognised.is_empty());
            assert_eq!(model.surfaces[Id::new(0)].kind(), "bspline");
            assert_eq!(model.edges[Id::new(0)].pcurves.len(), 1);
        }
    }
}

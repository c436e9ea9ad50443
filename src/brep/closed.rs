//! Whether faces close up.

use super::{Body, Coedge, Face, Id, Model, TrimLoop};
use crate::geometry::Surface;

/// Whether the body's faces meet in all of their edges, as those around a volume do: each edge is used an even number of times, and faces without
/// edges close up by themselves.
pub fn is_closed(model: &Model, body: &Body) -> bool {
    let has_edges = |&face: &Id<Face>| {
        let loops = &model.faces[face].loops;
        loops.iter().any(|trim_loop| matches!(trim_loop, TrimLoop::Edges(coedges) if !coedges.is_empty()))
    };
    let closes = |face: &Id<Face>| has_edges(face) || closes_up(&model.surfaces[model.faces[*face].surface]);
    if body.faces.is_empty() || !body.faces.iter().all(closes) {
        return false;
    }
    let loops = body.faces.iter().flat_map(|&face| &model.faces[face].loops);
    let coedges = loops.flat_map(|trim_loop| match trim_loop {
        TrimLoop::Edges(coedges) => coedges.as_slice(),
        TrimLoop::Vertex(_) => &[],
    });
    let mut edges: Vec<usize> = coedges.map(|coedge: &Coedge| coedge.edge.index()).collect();
    edges.sort_unstable();
    edges.chunk_by(|a, b| a == b).all(|uses| uses.len() % 2 == 0)
}

/// Whether the whole surface encloses a volume: along both parameters it comes back to where it began, or begins and ends in a point.
fn closes_up(surface: &Surface) -> bool {
    let (periods, domain, points) = (surface.periods(), surface.domain(), surface.singularities());
    let is_point = |axis: usize, value: f64| points.iter().any(|p| p.axis == axis && p.value == value);
    (0..2).all(|k| periods[k].is_some() || is_point(k, domain.min[k]) && is_point(k, domain.max[k]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::{BodyKind, primitive};
    use crate::geometry::Frame;
    use glam::DVec3;

    fn is_closed_with(model: &Model, faces: Vec<Id<Face>>) -> bool {
        is_closed(model, &Body { kind: BodyKind::Solid, faces, name: String::new(), entity: 1 })
    }

    fn without_edges(surface: Surface) -> bool {
        let mut model = Model::default();
        let surface = model.surfaces.push(surface);
        let face =
            Face { surface, same_sense: true, loops: vec![], color: None, name: String::new(), entity: 1 };
        let face = model.faces.push(face);
        is_closed_with(&model, vec![face])
    }

    #[test]
    fn edges_have_to_meet() {
        let mut model = Model::default();
        let faces = primitive::block(&mut model, &Frame::IDENTITY, DVec3::ONE, 1).expect("a block");
        assert!(is_closed_with(&model, faces.clone()));
        assert!(!is_closed_with(&model, faces[1..].to_vec()));
        assert!(!is_closed_with(&model, vec![]));
    }

    #[test]
    fn a_face_without_edges_has_to_close_up() {
        let frame = Frame::IDENTITY;
        assert!(without_edges(Surface::Sphere { frame, radius: 1.0 }));
        assert!(without_edges(Surface::Torus { frame, major: 2.0, minor: 1.0 }));
        assert!(!without_edges(Surface::Plane { frame }));
        assert!(!without_edges(Surface::Cylinder { frame, radius: 1.0 }));
        assert!(!without_edges(Surface::Cone { frame, radius: 1.0, half_angle: 0.5 }));
    }
}

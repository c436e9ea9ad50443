//! Elementary solids as faces: blocks and other polyhedra, cylinders, cones, spheres and tori.
//!
//! Formats that have constructive solids (IGES 150 to 160, ISO 10303-42: csg_primitive) place them by a frame and sizes. The faces
//! are exact, share their edges, and their normals point outwards. Lengths are millimetres.

use super::{Coedge, Edge, Face, Id, Model, TrimLoop, Vertex};
use crate::geometry::{Curve, Frame, Surface};
use glam::DVec3;
use std::collections::HashMap;
use std::f64::consts::TAU;

/// The faces of a polyhedron: each face lists its corners by their place in `points`, counter-clockwise seen from outside, three or
/// more in one plane. `None` where three neighbouring corners of a face are on a line.
pub fn polyhedron(
    model: &mut Model,
    points: &[DVec3],
    faces: &[&[usize]],
    entity: u64,
) -> Option<Vec<Id<Face>>> {
    let frame = |corners: &[usize]| {
        let [a, b, c] = [points[corners[0]], points[corners[1]], points[corners[2]]];
        let normal = (b - a).cross(c - b);
        let flat = normal.length() > 1e-12 * (b - a).length() * (c - b).length();
        (flat && normal.is_finite()).then(|| Frame::from_axes(a, Some(normal), Some(b - a)))
    };
    let frames: Vec<Frame> = faces.iter().map(|corners| frame(corners)).collect::<Option<_>>()?;
    let vertices: Vec<Id<Vertex>> =
        points.iter().map(|&point| model.vertices.push(Vertex { point, entity })).collect();
    let mut edges: HashMap<[usize; 2], Id<Edge>> = HashMap::new();
    let mut made = Vec::with_capacity(faces.len());
    for (corners, frame) in faces.iter().zip(frames) {
        let mut coedges = Vec::with_capacity(corners.len());
        for (i, &start) in corners.iter().enumerate() {
            let end = corners[(i + 1) % corners.len()];
            let key = [start.min(end), start.max(end)];
            let edge = *edges.entry(key).or_insert_with(|| {
                let [origin, to] = key.map(|corner| points[corner]);
                let curve = Curve::Line { origin, direction: to - origin };
                let vertices = key.map(|corner| vertices[corner]);
                model.edges.push(Edge { curve, range: [0.0, 1.0], vertices, pcurves: Vec::new(), entity })
            });
            coedges.push(Coedge { edge, reversed: start > end });
        }
        made.push(face(model, Surface::Plane { frame }, vec![TrimLoop::Edges(coedges)], entity));
    }
    Some(made)
}

/// The faces of a block with a corner at the frame's origin and sides along its axes.
pub fn block(model: &mut Model, frame: &Frame, size: DVec3, entity: u64) -> Option<Vec<Id<Face>>> {
    prism(model, frame, &[[0.0, 0.0], [size.x, 0.0], [size.x, size.y], [0.0, size.y]], size.z, entity)
}

/// The faces of a prism: a polygon in the frame's x and y, counter-clockwise and without any three corners on a line, moved along z.
pub fn prism(
    model: &mut Model,
    frame: &Frame,
    polygon: &[[f64; 2]],
    height: f64,
    entity: u64,
) -> Option<Vec<Id<Face>>> {
    let at = |height: f64| polygon.iter().map(move |[x, y]| frame.point(DVec3::new(*x, *y, height)));
    let points: Vec<DVec3> = at(0.0).chain(at(height)).collect();
    let count = polygon.len();
    let bottom: Vec<usize> = (0..count).rev().collect();
    let top: Vec<usize> = (count..2 * count).collect();
    let sides: Vec<[usize; 4]> = (0..count)
        .map(|i| {
            let next = (i + 1) % count;
            [i, next, next + count, i + count]
        })
        .collect();
    let faces: Vec<&[usize]> =
        [&bottom[..], &top[..]].into_iter().chain(sides.iter().map(|side| &side[..])).collect();
    polyhedron(model, &points, &faces, entity)
}

/// The faces of a cylinder or a truncated cone: `radii[0]` at the frame's origin, `radii[1]` at `height` along its axis, one of which
/// may be 0: then an apex is there. `None` where a size is not positive.
pub fn frustum(
    model: &mut Model,
    frame: &Frame,
    radii: [f64; 2],
    height: f64,
    entity: u64,
) -> Option<Vec<Id<Face>>> {
    let possible =
        height > 0.0 && radii.iter().all(|r| *r >= 0.0 && r.is_finite()) && radii[0] + radii[1] > 0.0;
    if !possible || !height.is_finite() {
        return None;
    }
    let end = |along: f64| Frame { origin: frame.origin + frame.z * along, ..*frame };
    let ends = [end(0.0), end(height)];
    let [bottom, top] = [0, 1].map(|i| ring(model, &ends[i], radii[i], entity));
    let surface = if radii[0] == radii[1] {
        Surface::Cylinder { frame: *frame, radius: radii[0] }
    } else {
        // From the smaller end, along which the cone opens.
        let half_angle = ((radii[1] - radii[0]).abs() / height).atan();
        let (small, axis) = if radii[0] < radii[1] { (0, frame.z) } else { (1, -frame.z) };
        let frame = Frame::from_axes(ends[small].origin, Some(axis), Some(frame.x));
        Surface::Cone { frame, radius: radii[small], half_angle }
    };
    let along = |ring: &Ring, reversed: bool| match *ring {
        Ring::Edge(edge) => TrimLoop::Edges(vec![Coedge { edge, reversed }]),
        Ring::Apex(vertex) => TrimLoop::Vertex(vertex),
    };
    let side = vec![along(&bottom, false), along(&top, true)];
    let mut faces = vec![face(model, surface, side, entity)];
    if let Ring::Edge(_) = bottom {
        let frame = Frame::from_axes(frame.origin, Some(-frame.z), Some(frame.x));
        faces.push(face(model, Surface::Plane { frame }, vec![along(&bottom, true)], entity));
    }
    if let Ring::Edge(_) = top {
        faces.push(face(model, Surface::Plane { frame: ends[1] }, vec![along(&top, false)], entity));
    }
    Some(faces)
}

/// The end of a cone.
enum Ring {
    Edge(Id<Edge>),
    Apex(Id<Vertex>),
}

fn ring(model: &mut Model, frame: &Frame, radius: f64, entity: u64) -> Ring {
    let point = frame.origin + frame.x * radius;
    let vertex = model.vertices.push(Vertex { point, entity });
    if radius == 0.0 {
        return Ring::Apex(vertex);
    }
    let curve = Curve::Circle { frame: *frame, radius };
    let edge = Edge { curve, range: [0.0, TAU], vertices: [vertex; 2], pcurves: Vec::new(), entity };
    Ring::Edge(model.edges.push(edge))
}

/// The face of a sphere around the frame's origin. `None` where the radius is not positive.
pub fn sphere(model: &mut Model, frame: &Frame, radius: f64, entity: u64) -> Option<Vec<Id<Face>>> {
    let possible = radius > 0.0 && radius.is_finite();
    possible.then(|| vec![face(model, Surface::Sphere { frame: *frame, radius }, Vec::new(), entity)])
}

/// The face of a torus around the frame's axis. `None` where the radii make none.
pub fn torus(
    model: &mut Model,
    frame: &Frame,
    [major, minor]: [f64; 2],
    entity: u64,
) -> Option<Vec<Id<Face>>> {
    let possible = minor > 0.0 && major >= minor && major.is_finite();
    possible.then(|| vec![face(model, Surface::Torus { frame: *frame, major, minor }, Vec::new(), entity)])
}

fn face(model: &mut Model, surface: Surface, loops: Vec<TrimLoop>, entity: u64) -> Id<Face> {
    let surface = model.surfaces.push(surface);
    model.faces.push(Face { surface, same_sense: true, loops, color: None, name: String::new(), entity })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How often each edge is used forwards and backwards.
    fn uses(model: &Model) -> Vec<[usize; 2]> {
        let mut uses = vec![[0; 2]; model.edges.len()];
        for face in model.faces.iter() {
            for trim in &face.loops {
                if let TrimLoop::Edges(coedges) = trim {
                    coedges.iter().for_each(|c| uses[c.edge.index()][usize::from(c.reversed)] += 1);
                }
            }
        }
        uses
    }

    #[test]
    fn every_edge_is_used_once_each_way() {
        let frame = Frame::from_axes(DVec3::new(1.0, 2.0, 3.0), Some(DVec3::ONE), Some(DVec3::X));
        let build = |make: &dyn Fn(&mut Model) -> Option<Vec<Id<Face>>>| {
            let mut model = Model::default();
            let faces = make(&mut model).expect("a solid").len();
            assert_eq!(faces, model.faces.len());
            assert!(uses(&model).iter().all(|uses| *uses == [1, 1]), "{:?}", uses(&model));
            model
        };
        let block = build(&|model| block(model, &frame, DVec3::new(1.0, 2.0, 3.0), 1));
        assert_eq!((block.faces.len(), block.edges.len(), block.vertices.len()), (6, 12, 8));
        // Seen from the middle, all normals point away.
        let middle = frame.point(DVec3::new(0.5, 1.0, 1.5));
        for face in block.faces.iter() {
            let Surface::Plane { frame } = &block.surfaces[face.surface] else { panic!("a plane") };
            assert!(frame.z.dot(frame.origin - middle) > 0.0);
        }
        let wedge = build(&|model| prism(model, &frame, &[[0.0, 0.0], [2.0, 0.0], [0.0, 1.0]], 1.0, 1));
        assert_eq!((wedge.faces.len(), wedge.edges.len()), (5, 9));
        assert_eq!(build(&|model| frustum(model, &frame, [1.0, 1.0], 2.0, 1)).faces.len(), 3);
        assert_eq!(build(&|model| frustum(model, &frame, [1.0, 0.0], 2.0, 1)).faces.len(), 2);
        assert_eq!(build(&|model| frustum(model, &frame, [0.5, 1.0], 2.0, 1)).faces.len(), 3);
    }

    #[test]
    fn edges_lie_on_both_surfaces() {
        let frame = Frame::from_axes(DVec3::new(1.0, 2.0, 3.0), Some(DVec3::new(1.0, -2.0, 0.5)), None);
        for radii in [[2.0, 2.0], [2.0, 0.5], [0.5, 2.0], [2.0, 0.0]] {
            let mut model = Model::default();
            frustum(&mut model, &frame, radii, 3.0, 1).expect("a solid");
            for face in model.faces.iter() {
                let surface = &model.surfaces[face.surface];
                for trim in &face.loops {
                    let points: Vec<DVec3> = match trim {
                        TrimLoop::Vertex(vertex) => vec![model.vertices[*vertex].point],
                        TrimLoop::Edges(coedges) => {
                            let curve = &model.edges[coedges[0].edge].curve;
                            (0..8).map(|i| curve.point(f64::from(i))).collect()
                        }
                    };
                    for point in points {
                        let found = crate::geometry::invert_surface(surface, point, None);
                        assert!(found.distance < 1e-12, "{} {}", surface.kind(), found.distance);
                    }
                }
            }
        }
    }

    #[test]
    fn impossible_sizes() {
        let mut model = Model::default();
        let frame = Frame::IDENTITY;
        assert!(frustum(&mut model, &frame, [0.0, 0.0], 1.0, 1).is_none());
        assert!(frustum(&mut model, &frame, [1.0, 1.0], f64::NAN, 1).is_none());
        assert!(sphere(&mut model, &frame, -1.0, 1).is_none());
        assert!(torus(&mut model, &frame, [1.0, 2.0], 1).is_none());
        assert!(block(&mut model, &frame, DVec3::new(1.0, 0.0, 1.0), 1).is_none());
        assert!(model.faces.is_empty());
    }
}

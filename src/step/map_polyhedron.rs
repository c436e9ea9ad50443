//! Solids with flat faces between given corners (ISO 10303-42: rectangular_pyramid, tetrahedron, convex_hexahedron).

use super::map_geometry::positive_length;
use super::reader::{Mapped, Reader, problem, reference};
use super::value::Entity;
use crate::brep::{Coedge, Face, TrimLoop, Vertex};
use crate::geometry::{Frame, Surface};
use glam::DVec3;

/// Corners farther from the plane of their face than this share of the solid's size make it no plane: files keep seven digits.
const FLAT: f64 = 1e-6;

impl Reader<'_> {
    /// `RECTANGULAR_PYRAMID(name, position, x, y, height)`: a corner of the base at the origin, the apex above its middle.
    pub fn pyramid(&mut self, entity: &Entity) -> Mapped<Vec<Face>> {
        let record = entity.first();
        let frame = self.placement(reference(entity.id, record, 1)?)?;
        let [x, y, z] = [2, 3, 4].map(|at| positive_length(self, entity, record, at));
        let (x, y, z) = (x?, y?, z?);
        let corners = [[0.0, 0.0, 0.0], [x, 0.0, 0.0], [x, y, 0.0], [0.0, y, 0.0], [0.5 * x, 0.5 * y, z]];
        let corners = corners.map(|p| frame.point(DVec3::from_array(p)));
        self.polyhedron(entity, &corners, &[&[0, 1, 2, 3], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]])
    }

    /// `TETRAHEDRON(name, points)` and `CONVEX_HEXAHEDRON(name, points)`: of the eight, four go around one side and four, in the
    /// same order, around the opposite one.
    pub fn faceted_primitive(&mut self, entity: &Entity) -> Mapped<Vec<Face>> {
        let ids = entity.first().references(1);
        let corners: Vec<DVec3> = ids.iter().map(|&id| self.point(id)).collect::<Mapped<_>>()?;
        match corners.len() {
            4 => self.polyhedron(entity, &corners, &[&[0, 1, 2], &[0, 1, 3], &[1, 2, 3], &[2, 0, 3]]),
            8 => {
                let sides: [&[usize]; 6] = [
                    &[0, 1, 2, 3],
                    &[4, 5, 6, 7],
                    &[0, 1, 5, 4],
                    &[1, 2, 6, 5],
                    &[2, 3, 7, 6],
                    &[3, 0, 4, 7],
                ];
                self.polyhedron(entity, &corners, &sides)
            }
            _ => Err(problem(entity, "expected four or eight corners")),
        }
    }

    fn polyhedron(&mut self, entity: &Entity, corners: &[DVec3], sides: &[&[usize]]) -> Mapped<Vec<Face>> {
        let centre = corners.iter().copied().sum::<DVec3>() / corners.len() as f64;
        let size = corners.iter().map(|p| p.distance(centre)).fold(0.0, f64::max);
        let vertices: Vec<_> = corners
            .iter()
            .map(|&point| self.model.vertices.push(Vertex { point, entity: entity.id }))
            .collect();
        let mut faces = Vec::with_capacity(sides.len());
        for side in sides {
            let mut side = side.to_vec();
            let origin = corners[side[0]];
            let next = side.iter().cycle().skip(1);
            // Newell's method.
            let normal: DVec3 =
                side.iter().zip(next).map(|(&a, &b)| (corners[a] - origin).cross(corners[b] - origin)).sum();
            let inwards = normal.dot(origin - centre) < 0.0;
            let normal = if inwards { -normal } else { normal }.normalize_or_zero();
            let is_flat = side.iter().all(|&i| (corners[i] - origin).dot(normal).abs() <= FLAT * size);
            if normal == DVec3::ZERO || !is_flat {
                return Err(problem(entity, "the corners of a side span no plane"));
            }
            if inwards {
                side.reverse();
            }
            let mut coedges = Vec::with_capacity(side.len());
            for (i, &corner) in side.iter().enumerate() {
                let end = side[(i + 1) % side.len()];
                let (edge, reversed) = self.poly_edge(vertices[corner], vertices[end], entity.id);
                coedges.push(Coedge { edge, reversed });
            }
            let frame = Frame::from_axes(origin, Some(normal), None);
            let surface = self.model.surfaces.push(Surface::Plane { frame });
            let (loops, name) = (vec![TrimLoop::Edges(coedges)], String::new());
            faces.push(Face { surface, same_sense: true, loops, color: None, name, entity: entity.id });
        }
        Ok(faces)
    }
}

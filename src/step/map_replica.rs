//! Copies of solids (ISO 10303-42: solid_replica): the parent is mapped once more and moved. Its faces count once more as declared.

use super::map_style::Styles;
use super::map_topology::{FACE_KEYWORDS, reverse};
use super::reader::{MAX_CHAIN, Mapped, Reader, problem, reference};
use super::value::{Entity, Value};
use crate::brep::{Body, Color};
use std::collections::HashSet;

impl Reader<'_> {
    /// `SOLID_REPLICA(name, parent, transformation)`.
    pub fn replica(
        &mut self,
        entity: &Entity,
        styles: &Styles,
        color: Option<Color>,
        depth: usize,
    ) -> Mapped<Body> {
        let parent = reference(entity.id, entity.first(), 1)?;
        let transform = self.transform(reference(entity.id, entity.first(), 2)?)?;
        if !transform.is_finite() || transform.matrix3.determinant() == 0.0 {
            return Err(problem(entity, "the transformation has no finite inverse"));
        }
        let faces = self.faces_below(parent);
        self.charge(entity, faces.len())?;
        // Mapped as if it were a file of its own, so that the new pieces are its own.
        let (vertices, edges) = (std::mem::take(&mut self.vertices), std::mem::take(&mut self.edges));
        let (poly_edges, surfaces) =
            (std::mem::take(&mut self.poly_edges), std::mem::take(&mut self.surfaces));
        let taken = std::mem::take(&mut self.taken_bodies);
        let count = faces.len();
        let open = std::mem::replace(&mut self.open_faces, faces);
        let starts = [
            self.model.vertices.len(),
            self.model.edges.len(),
            self.model.surfaces.len(),
            self.model.faces.len(),
        ];
        let body = self.body_in_chain(parent, styles, color, depth + 1);
        self.model.declared_faces += count - self.open_faces.len();
        (self.vertices, self.edges, self.poly_edges, self.surfaces) = (vertices, edges, poly_edges, surfaces);
        (self.taken_bodies, self.open_faces) = (taken, open);
        let [first_vertex, first_edge, first_surface, first_face] = starts;
        for id in self.model.vertices.ids().skip(first_vertex) {
            let vertex = &mut self.model.vertices[id];
            vertex.point = transform.transform_point3(vertex.point);
        }
        for id in self.model.edges.ids().skip(first_edge) {
            let edge = &mut self.model.edges[id];
            edge.curve = edge.curve.transformed(&transform);
            // Lengths among the parameters scale, and a mirror turns angles round.
            edge.pcurves.clear();
        }
        let mut turned = HashSet::new();
        for id in self.model.surfaces.ids().skip(first_surface) {
            let (surface, is_turned) = self.model.surfaces[id].transformed(&transform);
            self.model.surfaces[id] = surface;
            if is_turned {
                turned.insert(id);
            }
        }
        let mirrors = transform.matrix3.determinant() < 0.0;
        for id in self.model.faces.ids().skip(first_face) {
            let face = &mut self.model.faces[id];
            face.same_sense ^= turned.contains(&face.surface);
            if mirrors {
                face.loops.iter_mut().for_each(reverse);
            }
        }
        let body = body?.ok_or_else(|| problem(entity, "nothing of its parent could be read"))?;
        Ok(Body { entity: entity.id, ..body })
    }

    /// The declared faces that body `id` leads to.
    pub fn faces_below(&self, id: u64) -> HashSet<u64> {
        let mut faces = HashSet::new();
        let mut seen = HashSet::new();
        let mut waiting = vec![(id, 0)];
        while let Some((id, depth)) = waiting.pop() {
            if depth > MAX_CHAIN || !seen.insert(id) {
                continue;
            }
            let keyword = self.keyword(id);
            let is_part = ["SOLID", "BREP", "SHELL", "SURFACE_MODEL", "FACE", "BOOLEAN_RESULT"]
                .iter()
                .any(|word| keyword.contains(word));
            if !is_part && !keyword.is_empty() {
                continue;
            }
            let Ok(entity) = self.entity(id) else { continue };
            if FACE_KEYWORDS.iter().any(|keyword| entity.is(keyword)) {
                faces.insert(id);
                continue;
            }
            let parameters = entity.records.iter().flat_map(|r| &r.parameters);
            waiting.extend(parameters.flat_map(|p| {
                let in_list = p.list().into_iter().flatten().filter_map(Value::reference);
                p.reference().into_iter().chain(in_list).map(|id| (id, depth + 1))
            }));
        }
        faces
    }
}

//! Loops, faces, shells and solids (ISO 10303-42, clause 5 and 6).

use super::map_style::Styles;
use super::map_surface::RESHAPED;
use super::reader::{MAX_CHAIN, Mapped, Problem, Reader, SurfaceUse, problem, reference};
use super::value::Entity;
use crate::brep::{Body, BodyKind, Coedge, Color, Face, Id, Severity, TrimLoop};
use crate::geometry::{Frame, Surface};
use glam::DVec3;

/// Samples on each edge from which a swept surface learns how far it has to reach, ends included.
const SAMPLES_PER_EDGE: usize = 9;

/// Edges shorter than this (in millimetres) are left out of loops; they mark poles and apexes.
const LEAST_EDGE: f64 = 1e-7;

/// Keywords of faces: what a file declares and the model or the diagnostics must hold.
pub const FACE_KEYWORDS: [&str; 3] = ["ADVANCED_FACE", "FACE_SURFACE", "FACE"];

/// Keywords of bodies, solids first.
pub const BODY_KEYWORDS: [&str; 9] = [
    "MANIFOLD_SOLID_BREP",
    "BREP_WITH_VOIDS",
    "FACETED_BREP",
    "SHELL_BASED_SURFACE_MODEL",
    "FACE_BASED_SURFACE_MODEL",
    "CLOSED_SHELL",
    "OPEN_SHELL",
    "ORIENTED_CLOSED_SHELL",
    "CONNECTED_FACE_SET",
];

impl Reader<'_> {
    /// The solid, surface model or shell `id` with every face that could be mapped; `None` where it was mapped before.
    pub fn body(&mut self, id: u64, styles: &Styles, inherited: Option<Color>) -> Mapped<Option<Body>> {
        let entity = self.entity(id)?;
        if self.taken_bodies.contains(&id) {
            return Ok(None);
        }
        let color = styles.of(id).or(inherited);
        let record = BODY_KEYWORDS.iter().find_map(|keyword| entity.record(keyword));
        let record = record.ok_or_else(|| problem(&entity, "this kind of body is not supported"))?;
        let is_solid =
            ["MANIFOLD_SOLID_BREP", "BREP_WITH_VOIDS", "FACETED_BREP"].iter().any(|k| entity.is(k));
        let is_model = entity.is("SHELL_BASED_SURFACE_MODEL") || entity.is("FACE_BASED_SURFACE_MODEL");
        let shells: Vec<u64> = if is_solid || is_model {
            self.taken_bodies.insert(id);
            let all = entity.records.iter().flat_map(|r| &r.parameters);
            all.flat_map(|p| {
                p.reference().into_iter().chain(p.list().into_iter().flatten().filter_map(|v| v.reference()))
            })
            .collect()
        } else {
            vec![id]
        };
        let mut faces = Vec::new();
        for shell in shells {
            if let Err(problem) = self.shell(shell, styles, color, &mut faces) {
                self.report(Severity::Dropped, problem);
            }
        }
        let name = record.text(0);
        let kind = if is_solid { BodyKind::Solid } else { BodyKind::Sheet };
        Ok((!faces.is_empty()).then_some(Body { kind, faces, name, entity: id }))
    }

    fn shell(
        &mut self,
        id: u64,
        styles: &Styles,
        inherited: Option<Color>,
        faces: &mut Vec<Id<Face>>,
    ) -> Mapped<()> {
        let (mut id, mut reversed, mut color) = (id, false, inherited);
        for _ in 0..MAX_CHAIN {
            let entity = self.entity(id)?;
            if !self.taken_bodies.insert(id) {
                return Ok(());
            }
            color = styles.of(id).or(color);
            let record = entity.first();
            if matches!(&*record.keyword, "ORIENTED_CLOSED_SHELL" | "ORIENTED_OPEN_SHELL") {
                reversed ^= record.logical(3) == Some(false);
                id = reference(id, record, 2)?;
                continue;
            }
            let list = entity.records.iter().find_map(|r| r.parameters.iter().find_map(|p| p.list()));
            let list = list.ok_or_else(|| problem(&entity, "the shell has no list of faces"))?;
            for face in list.iter().filter_map(|v| v.reference()) {
                self.face_or_report(face, reversed, styles, color, faces);
            }
            return Ok(());
        }
        Err(Problem {
            entity: id,
            kind: "ORIENTED_CLOSED_SHELL".into(),
            reason: "shells refer to each other in a circle".into(),
        })
    }

    /// Adds face `id`, or reports it.
    pub fn face_or_report(
        &mut self,
        id: u64,
        reversed: bool,
        styles: &Styles,
        color: Option<Color>,
        faces: &mut Vec<Id<Face>>,
    ) {
        let (mut face_id, mut reversed) = (id, reversed);
        for _ in 0..MAX_CHAIN {
            let entity = match self.entity(face_id) {
                Ok(entity) => entity,
                Err(problem) if self.open_faces.contains(&face_id) => {
                    return self.drop_face(face_id, &problem.kind.clone(), &problem);
                }
                Err(problem) => return self.report(Severity::Dropped, problem),
            };
            if let Some(oriented) = entity.record("ORIENTED_FACE") {
                reversed ^= oriented.logical(3) == Some(false);
                let Some(element) = oriented.reference(2) else {
                    return self.report(Severity::Dropped, problem(&entity, "the face has no element"));
                };
                face_id = element;
                continue;
            }
            if !self.open_faces.contains(&face_id) {
                if !FACE_KEYWORDS.iter().any(|keyword| entity.is(keyword)) {
                    self.report(Severity::Dropped, problem(&entity, "this kind of face is not supported"));
                }
                return;
            }
            match self.face(&entity, reversed) {
                Ok(mut face) => {
                    face.color = styles.of(face_id).or(color);
                    self.open_faces.remove(&face_id);
                    faces.push(self.model.faces.push(face));
                }
                Err(problem) => self.drop_face(face_id, &entity.kind(), &problem),
            }
            return;
        }
    }

    fn face(&mut self, entity: &Entity, reversed: bool) -> Mapped<Face> {
        let complex = entity.records.len() > 1;
        let record = FACE_KEYWORDS.iter().find_map(|k| entity.record(k)).unwrap_or(entity.first());
        let bounds =
            if complex { entity.record("FACE").map_or(&[][..], |r| r.list(0)) } else { record.list(1) };
        let mut loops = Vec::with_capacity(bounds.len());
        for bound in bounds {
            let bound = bound.reference().ok_or_else(|| problem(entity, "a bound is no reference"))?;
            if let Some(mut trim) = self.bound(bound)? {
                if reversed {
                    reverse(&mut trim);
                }
                loops.push(trim);
            }
        }
        let (surface, same_sense) = match entity.record("FACE_SURFACE").or(entity.record("ADVANCED_FACE")) {
            Some(record) => {
                let at = if complex { 0 } else { 2 };
                let surface = reference(entity.id, record, at)?;
                let is_reshaped = RESHAPED.contains(&&*self.keyword(surface));
                let samples = if is_reshaped { self.samples(&loops) } else { Vec::new() };
                let used = self.surface(surface, &samples)?;
                (used, record.logical(at + 1) != Some(false))
            }
            None => (self.plane_of(entity, &loops, reversed)?, true),
        };
        let unbounded = matches!(
            self.model.surfaces[surface.id],
            Surface::Plane { .. } | Surface::Cylinder { .. } | Surface::Cone { .. }
        );
        if loops.is_empty() && unbounded {
            return Err(problem(entity, "an unbounded surface without bounds"));
        }
        Ok(Face {
            surface: surface.id,
            same_sense: same_sense ^ surface.flipped ^ reversed,
            loops,
            color: None,
            name: if complex { String::new() } else { record.text(0) },
            entity: entity.id,
        })
    }

    /// A FACE_BOUND; `None` where nothing is left of its loop.
    fn bound(&mut self, id: u64) -> Mapped<Option<TrimLoop>> {
        let entity = self.entity(id)?;
        let record = entity.first();
        let trim = self.trim_loop(reference(id, record, 1)?)?;
        Ok(trim.map(|mut trim| {
            if record.logical(2) == Some(false) {
                reverse(&mut trim);
            }
            trim
        }))
    }

    fn trim_loop(&mut self, id: u64) -> Mapped<Option<TrimLoop>> {
        let entity = self.entity(id)?;
        let record = entity.first();
        match &*record.keyword {
            "VERTEX_LOOP" => Ok(Some(TrimLoop::Vertex(self.vertex(reference(id, record, 1)?)?))),
            "POLY_LOOP" => self.poly_loop(&entity),
            "EDGE_LOOP" => {
                self.charge(&entity, record.list(1).len())?;
                let mut coedges = Vec::with_capacity(record.list(1).len());
                let mut collapsed = None;
                for item in record.list(1) {
                    let item = item.reference().ok_or_else(|| problem(&entity, "an edge is no reference"))?;
                    let (edge, reversed) = self.oriented_edge(item)?;
                    if self.is_collapsed(edge) {
                        collapsed = Some(self.model.edges[edge].vertices[0]);
                    } else {
                        coedges.push(Coedge { edge, reversed });
                    }
                }
                Ok(match (coedges.is_empty(), collapsed) {
                    (false, _) => Some(TrimLoop::Edges(coedges)),
                    (true, Some(vertex)) => Some(TrimLoop::Vertex(vertex)),
                    (true, None) => return Err(problem(&entity, "the loop has no edges")),
                })
            }
            _ => Err(problem(&entity, "this kind of loop is not supported")),
        }
    }

    /// Whether an edge is a single point.
    fn is_collapsed(&self, edge: Id<crate::brep::Edge>) -> bool {
        let edge = &self.model.edges[edge];
        let [start, end] = edge.vertices.map(|v| self.model.vertices[v].point);
        start.distance(end) < LEAST_EDGE && {
            let middle = edge.curve.point(0.5 * (edge.range[0] + edge.range[1]));
            let quarter = edge.curve.point(0.75 * edge.range[0] + 0.25 * edge.range[1]);
            middle.distance(start) < LEAST_EDGE && quarter.distance(start) < LEAST_EDGE
        }
    }

    fn poly_loop(&mut self, entity: &Entity) -> Mapped<Option<TrimLoop>> {
        self.charge(entity, entity.first().list(1).len())?;
        let mut vertices = Vec::new();
        for id in entity.first().references(1) {
            let vertex = self.point_vertex(id)?;
            if vertices.last() != Some(&vertex) {
                vertices.push(vertex);
            }
        }
        if vertices.len() > 1 && vertices.first() == vertices.last() {
            vertices.pop();
        }
        if vertices.len() < 3 {
            return Err(problem(entity, "the loop has fewer than three different points"));
        }
        let mut coedges = Vec::with_capacity(vertices.len());
        for (i, &start) in vertices.iter().enumerate() {
            let end = vertices[(i + 1) % vertices.len()];
            let (edge, reversed) = self.poly_edge(start, end, entity.id);
            coedges.push(Coedge { edge, reversed });
        }
        Ok(Some(TrimLoop::Edges(coedges)))
    }

    /// The plane of a face without a surface: its normal by Newell's method over the first loop.
    fn plane_of(&mut self, entity: &Entity, loops: &[TrimLoop], reversed: bool) -> Mapped<SurfaceUse> {
        let corners: Vec<DVec3> = match loops.first() {
            Some(TrimLoop::Edges(coedges)) => coedges
                .iter()
                .map(|c| {
                    let vertices = self.model.edges[c.edge].vertices;
                    self.model.vertices[vertices[usize::from(c.reversed)]].point
                })
                .collect(),
            _ => Vec::new(),
        };
        let origin = corners.first().copied().unwrap_or_default();
        let next = corners.iter().cycle().skip(1);
        let normal: DVec3 = corners.iter().zip(next).map(|(a, b)| (*a - origin).cross(*b - origin)).sum();
        // The loops were turned with the face; its surface is not.
        let normal = if reversed { -normal } else { normal };
        if normal.length_squared() == 0.0 || !normal.is_finite() {
            return Err(problem(entity, "a face without a surface whose loop spans no plane"));
        }
        let frame = Frame::from_axes(origin, Some(normal), None);
        let id = self.model.surfaces.push(Surface::Plane { frame });
        Ok(SurfaceUse { id, flipped: false, keeps_parameters: true })
    }

    /// Points along the edges of `loops`.
    pub fn samples(&self, loops: &[TrimLoop]) -> Vec<DVec3> {
        let mut samples = Vec::new();
        for trim in loops {
            match trim {
                TrimLoop::Vertex(vertex) => samples.push(self.model.vertices[*vertex].point),
                TrimLoop::Edges(coedges) => {
                    for coedge in coedges {
                        let edge = &self.model.edges[coedge.edge];
                        samples.extend((0..SAMPLES_PER_EDGE).map(|i| {
                            let s = i as f64 / (SAMPLES_PER_EDGE - 1) as f64;
                            edge.curve.point(edge.range[0] + s * (edge.range[1] - edge.range[0]))
                        }));
                    }
                }
            }
        }
        samples
    }
}

/// The loop run the other way.
pub fn reverse(trim: &mut TrimLoop) {
    if let TrimLoop::Edges(coedges) = trim {
        coedges.reverse();
        for coedge in coedges {
            coedge.reversed = !coedge.reversed;
        }
    }
}

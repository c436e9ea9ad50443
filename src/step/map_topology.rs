//! Faces and loops (ISO 10303-42, clause 5). What they make up is in [`super::map_body`].

use super::map_surface::RESHAPED;
use super::reader::{MAX_CHAIN, Mapped, Problem, Reader, SurfaceUse, problem, reference};
use super::value::{Entity, Value};
use crate::brep::{Coedge, Edge, Face, Id, Severity, TrimLoop};
use crate::geometry::{Frame, Surface};
use glam::DVec3;

/// Samples on each edge from which a swept surface learns how far it has to reach, ends included.
const SAMPLES_PER_EDGE: usize = 9;

/// Edges shorter than this (in millimetres) are left out of loops; they mark poles and apexes.
const LEAST_EDGE: f64 = 1e-7;

/// Keywords of faces: what a file declares and the model or the diagnostics must hold.
pub const FACE_KEYWORDS: [&str; 4] = ["ADVANCED_FACE", "FACE_SURFACE", "SUBFACE", "FACE"];

/// Keywords of bodies: what is made of others stands before those. The first [`GENERATED`] list no faces.
pub const BODY_KEYWORDS: [&str; 34] = [
    "SOLID_REPLICA",
    "CSG_SOLID",
    "BOOLEAN_RESULT",
    "EXTRUDED_AREA_SOLID",
    "REVOLVED_AREA_SOLID",
    "EXTRUDED_FACE_SOLID",
    "REVOLVED_FACE_SOLID",
    "SWEPT_DISK_SOLID",
    "BLOCK",
    "RIGHT_ANGULAR_WEDGE",
    "SPHERE",
    "ELLIPSOID",
    "RIGHT_CIRCULAR_CYLINDER",
    "RIGHT_CIRCULAR_CONE",
    "TORUS",
    "RECTANGULAR_PYRAMID",
    "TETRAHEDRON",
    "CONVEX_HEXAHEDRON",
    "HALF_SPACE_SOLID",
    "BOXED_HALF_SPACE",
    "SURFACE_CURVE_SWEPT_AREA_SOLID",
    "MANIFOLD_SOLID_BREP",
    "BREP_WITH_VOIDS",
    "FACETED_BREP",
    "FACETED_BREP_AND_BREP_WITH_VOIDS",
    "SHELL_BASED_SURFACE_MODEL",
    "FACE_BASED_SURFACE_MODEL",
    "ORIENTED_CLOSED_SHELL",
    "ORIENTED_OPEN_SHELL",
    "CLOSED_SHELL",
    "OPEN_SHELL",
    "SURFACED_OPEN_SHELL",
    "CONNECTED_FACE_SUB_SET",
    "CONNECTED_FACE_SET",
];

/// How many of the body keywords are of solids whose faces are made.
pub const GENERATED: usize = 21;

impl Reader<'_> {
    /// The face `entity`; a bound other than the outer one that cannot be read costs itself.
    pub fn face(&mut self, entity: &Entity, reversed: bool) -> Mapped<Face> {
        let complex = entity.records.len() > 1;
        let record = FACE_KEYWORDS.iter().find_map(|k| entity.record(k)).unwrap_or(entity.first());
        let bounds =
            if complex { entity.record("FACE").map_or(&[][..], |r| r.list(0)) } else { record.list(1) };
        let mut loops = Vec::with_capacity(bounds.len());
        let (mut kept, mut lost) = (Vec::with_capacity(bounds.len()), Vec::new());
        for bound in bounds {
            let id = bound.reference().ok_or_else(|| problem(entity, "a bound is no reference"));
            match id.and_then(|id| self.bound(id).map(|trim| (id, trim))) {
                Ok((id, trim)) => {
                    kept.extend(trim.is_some().then_some(id));
                    loops.extend(trim);
                }
                Err(problem) => lost.push(problem),
            }
        }
        for reason in lost {
            if !kept.iter().any(|&id| self.keyword(id) == "FACE_OUTER_BOUND") {
                return Err(reason);
            }
            let Problem { entity: at, kind, reason } = reason;
            let reason = format!("without a bound that cannot be read: {kind} #{at}: {reason}");
            self.report(Severity::Warning, problem(entity, reason));
        }
        if reversed {
            loops.iter_mut().for_each(reverse);
        }
        let (surface, same_sense) = match self.face_surface(entity)? {
            Some((id, same_sense)) => {
                let used = if loops.is_empty() {
                    let carrier = self.entity(id)?;
                    let (used, own) = self.self_bounded(&carrier)?;
                    loops = own;
                    used
                } else {
                    let is_reshaped = RESHAPED.contains(&&*self.keyword(id));
                    let samples = if is_reshaped { self.samples(&loops) } else { Vec::new() };
                    self.surface(id, &samples)?
                };
                (used, same_sense)
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

    /// The surface of a face and whether the face has its sense; that of its parent for a SUBFACE. `None` for a FACE.
    fn face_surface(&self, entity: &Entity) -> Mapped<Option<(u64, bool)>> {
        let mut parent = None;
        let mut reversed = false;
        for _ in 0..MAX_CHAIN {
            let owned = parent.map(|id| self.entity(id)).transpose()?;
            let face = owned.as_ref().unwrap_or(entity);
            let at = if face.records.len() > 1 { 0 } else { 2 };
            if let Some(record) = face.record("FACE_SURFACE").or(face.record("ADVANCED_FACE")) {
                let same_sense = record.logical(at + 1) != Some(false);
                return Ok(Some((reference(face.id, record, at)?, same_sense ^ reversed)));
            }
            if let Some(record) = face.record("ORIENTED_FACE") {
                reversed ^= record.logical(at + 1) == Some(false);
                parent = Some(reference(face.id, record, at)?);
            } else if let Some(record) = face.record("SUBFACE") {
                parent = Some(reference(face.id, record, at)?);
            } else {
                return Ok(None);
            }
        }
        Err(problem(entity, "faces refer to each other in a circle"))
    }

    /// A FACE_BOUND, or a loop itself; `None` where nothing is left of it.
    fn bound(&mut self, id: u64) -> Mapped<Option<TrimLoop>> {
        let entity = self.entity(id)?;
        let record = entity.first();
        if ["EDGE_LOOP", "POLY_LOOP", "VERTEX_LOOP"].iter().any(|keyword| entity.is(keyword)) {
            return self.trim_loop(id);
        }
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
            _ if entity.is("EDGE_LOOP") => {
                let path = entity.record("PATH").filter(|_| entity.records.len() > 1);
                match path {
                    Some(path) => self.edge_loop(&entity, path.list(0)),
                    None => self.edge_loop(&entity, record.list(1)),
                }
            }
            _ => Err(problem(&entity, "this kind of loop is not supported")),
        }
    }

    /// A loop of oriented edges. One that cannot be read is replaced by a straight one where its neighbours say how it runs.
    fn edge_loop(&mut self, entity: &Entity, items: &[Value]) -> Mapped<Option<TrimLoop>> {
        self.charge(entity, items.len())?;
        let mut edges = Vec::with_capacity(items.len());
        for item in items {
            let id = item.reference().ok_or_else(|| problem(entity, "an edge is no reference"));
            edges.push(id.and_then(|id| self.oriented_edge(id)));
        }
        let lost: Vec<usize> = (0..edges.len()).filter(|&i| edges[i].is_err()).collect();
        if let [at] = lost[..]
            && edges.len() > 2
        {
            let neighbours = [(at + edges.len() - 1) % edges.len(), (at + 1) % edges.len()];
            let [before, after] = neighbours.map(|i| edges[i].clone().ok());
            if let (Some(before), Some(after), Err(reason)) = (before, after, edges[at].clone()) {
                let end = |(edge, reversed): (Id<Edge>, bool), last: bool| {
                    self.model.edges[edge].vertices[usize::from(last ^ reversed)]
                };
                let edge = self.straight_edge([end(before, true), end(after, false)], entity.id);
                let Problem { entity: lost, kind, reason } = reason;
                let reason = format!("{kind} #{lost}: {reason}; a straight edge instead");
                self.report(Severity::Warning, problem(entity, reason));
                edges[at] = Ok((edge, false));
            }
        }
        let mut coedges = Vec::with_capacity(edges.len());
        let mut collapsed = None;
        for edge in edges {
            let (edge, reversed) = edge?;
            if self.is_collapsed(edge) {
                collapsed = Some(self.model.edges[edge].vertices[0]);
            } else {
                coedges.push(Coedge { edge, reversed });
            }
        }
        Ok(match (coedges.is_empty(), collapsed) {
            (false, _) => Some(TrimLoop::Edges(coedges)),
            (true, Some(vertex)) => Some(TrimLoop::Vertex(vertex)),
            (true, None) => return Err(problem(entity, "the loop has no edges")),
        })
    }

    /// Whether an edge is a single point.
    fn is_collapsed(&self, edge: Id<Edge>) -> bool {
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

    /// The plane of a face without a surface: its normal by Newell's method over the loop that spans most.
    fn plane_of(&mut self, entity: &Entity, loops: &[TrimLoop], reversed: bool) -> Mapped<SurfaceUse> {
        let corners = |trim: &TrimLoop| -> Vec<DVec3> {
            let TrimLoop::Edges(coedges) = trim else { return Vec::new() };
            let start = |c: &Coedge| self.model.edges[c.edge].vertices[usize::from(c.reversed)];
            coedges.iter().map(|c| self.model.vertices[start(c)].point).collect()
        };
        let (origin, normal) = loops
            .iter()
            .map(|trim| {
                let corners = corners(trim);
                let origin = corners.first().copied().unwrap_or_default();
                let next = corners.iter().cycle().skip(1);
                let normal = corners.iter().zip(next).map(|(a, b)| (*a - origin).cross(*b - origin));
                (origin, normal.sum::<DVec3>())
            })
            .max_by(|a, b| a.1.length_squared().total_cmp(&b.1.length_squared()))
            .unwrap_or_default();
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

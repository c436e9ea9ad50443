//! Boundary representations: solids (186), shells (514), faces (510), loops (508), edges (504), vertices (502).

use super::boundary::{Bound, trim_loop};
use super::curve::{self, Piece};
use super::directory::{Mapped, Parameters, Problem};
use super::reader::{Form, Reader};
use super::style;
use crate::brep::{Body, BodyKind, Coedge, Color, Edge, Face, Id, Severity, TrimLoop, Vertex};
use crate::geometry::invert_curve;
use std::rc::Rc;

/// The end of a curve counts as the vertex where it is nearer than this share of the curve's size, or than the file's
/// resolution; else the curve is cut at the vertex.
const AT_END: f64 = 1e-4;

impl Reader<'_> {
    /// Entity 186: a shell and its sense, how many voids, for each its shell and sense. With every face that can be mapped.
    pub fn solid(&mut self, entity: u32, inherited: Option<Color>) -> Mapped<Body> {
        let parameters = self.file.parameters(entity)?;
        let color = style::color(&self.file, entity).or(inherited);
        let shells = solid_shells(&parameters)?;
        let voids = shells.len() - 1;
        let mut faces = Vec::new();
        for (shell, reversed) in shells {
            if let Err(problem) = self.shell(shell, reversed, color, &mut faces) {
                self.report(Severity::Dropped, problem);
            }
        }
        let name = style::name(&self.file, &parameters, 4 + 2 * voids);
        Ok(Body { kind: BodyKind::Solid, faces, name, entity: entity.into() })
    }

    /// A shell that no solid uses.
    pub fn sheet_body(&mut self, entity: u32, inherited: Option<Color>) -> Mapped<Body> {
        let mut faces = Vec::new();
        self.shell(entity, false, inherited, &mut faces)?;
        let parameters = self.file.parameters(entity)?;
        let name = style::name(&self.file, &parameters, 2 + 2 * parameters.count(1, 2)?);
        Ok(Body { kind: BodyKind::Sheet, faces, name, entity: entity.into() })
    }

    /// The faces of a shell with their senses.
    pub fn shell_faces(&self, entity: u32) -> Mapped<Vec<(u32, bool)>> {
        let parameters = self.file.parameters(entity)?;
        if parameters.kind != 514 {
            return Err(parameters.problem("this is no shell"));
        }
        let count = parameters.count(1, 2)?;
        (0..count)
            .map(|i| Ok((parameters.reference(2 + 2 * i)?, parameters.integer(3 + 2 * i)? == 0)))
            .collect()
    }

    /// Entity 514: how many faces; for each the face and its sense.
    fn shell(
        &mut self,
        entity: u32,
        reversed: bool,
        inherited: Option<Color>,
        faces: &mut Vec<Id<Face>>,
    ) -> Mapped<()> {
        let members = self.shell_faces(entity)?;
        self.taken_shells.insert(entity);
        let color = style::color(&self.file, entity).or(inherited);
        for (face, against) in members {
            if !self.open_faces.contains(&face) {
                continue;
            }
            match self.face(face, reversed ^ against, color) {
                Ok(id) => faces.push(id),
                Err(problem) => self.drop_face(face, &problem),
            }
        }
        Ok(())
    }

    /// Entity 510: surface, how many loops, whether the first one is the outer one, the loops.
    pub fn face(&mut self, entity: u32, reversed: bool, inherited: Option<Color>) -> Mapped<Id<Face>> {
        let parameters = self.file.parameters(entity)?;
        let count = parameters.count(2, 1)?;
        let unit = self.unit;
        let form = if count == 0 { Form::Bounded } else { Form::Recognised };
        let used = self.surface(parameters.reference(1)?, &unit, form)?;
        let mut loops = Vec::with_capacity(count);
        for i in 0..count {
            let mut trim = self.edge_loop(parameters.reference(4 + i)?)?;
            if let (TrimLoop::Edges(coedges), true) = (&mut trim, reversed) {
                coedges.reverse();
                coedges.iter_mut().for_each(|coedge| coedge.reversed ^= true);
            }
            loops.push(trim);
        }
        let domain = self.model.surfaces[used.id].domain();
        if loops.is_empty() && !(domain.min.is_finite() && domain.max.is_finite()) {
            return Err(parameters.problem("an unbounded surface without bounds"));
        }
        let face = Face {
            surface: used.id,
            same_sense: !(used.flipped ^ reversed),
            loops,
            color: style::color(&self.file, entity).or(inherited),
            name: style::name(&self.file, &parameters, 4 + count),
            entity: entity.into(),
        };
        self.open_faces.remove(&entity);
        Ok(self.model.faces.push(face))
    }

    /// Entity 508: how many uses; for each whether it is a vertex, the list, the index in it, the sense, how many
    /// parameter curves, and for each of those a flag and the curve.
    fn edge_loop(&mut self, entity: u32) -> Mapped<TrimLoop> {
        let parameters = self.file.parameters(entity)?;
        if parameters.kind != 508 {
            return Err(parameters.problem("this is no loop"));
        }
        let mut coedges = Vec::new();
        let mut pole = None;
        let mut at = 2;
        for _ in 0..parameters.count(1, 5)? {
            let list = parameters.reference(at + 1)?;
            let index = parameters.reference(at + 2)?;
            let reversed = parameters.integer(at + 3)? == 0;
            if parameters.integer(at)? == 1 {
                pole = Some(self.vertex(list, index)?);
            } else {
                let edges = self.edges_at(list, index)?;
                let uses = edges.iter().map(|&edge| Coedge { edge, reversed });
                if reversed { coedges.extend(uses.rev()) } else { coedges.extend(uses) }
            }
            at += 5 + 2 * parameters.count(at + 4, 2)?;
        }
        match (coedges.is_empty(), pole) {
            (false, _) => Ok(TrimLoop::Edges(coedges)),
            (true, Some(vertex)) => Ok(TrimLoop::Vertex(vertex)),
            (true, None) => Err(parameters.problem("the loop has no edges")),
        }
    }

    /// Vertex `index` (from 1) of list `list`, an entity 502.
    fn vertex(&mut self, list: u32, index: u32) -> Mapped<Id<Vertex>> {
        if let Some(&known) = self.vertices.get(&(list, index)) {
            return Ok(known);
        }
        let points = self.list(list, 502)?;
        if index as usize > points.count(1, 3)? {
            return Err(points.problem(format!("there is no vertex {index}")));
        }
        let point = self.unit.transform_point3(points.point(3 * index as usize - 1)?);
        let vertex = self.model.vertices.push(Vertex { point, entity: list.into() });
        self.vertices.insert((list, index), vertex);
        Ok(vertex)
    }

    /// Edge `index` (from 1) of list `list`, an entity 504: its curve, then list and index of start and end vertex.
    fn edges_at(&mut self, list: u32, index: u32) -> Mapped<Rc<[Id<Edge>]>> {
        if let Some(known) = self.edges.get(&(list, index)) {
            return Ok(known.clone());
        }
        let entries = self.list(list, 504)?;
        if index as usize > entries.count(1, 5)? {
            return Err(entries.problem(format!("there is no edge {index}")));
        }
        let at = 5 * index as usize - 3;
        let start = self.vertex(entries.reference(at + 1)?, entries.reference(at + 2)?)?;
        let end = self.vertex(entries.reference(at + 3)?, entries.reference(at + 4)?)?;
        let curve = entries.reference(at)?;
        let pieces = curve::pieces(&self.file, curve, &self.unit)?;
        let edges: Rc<[Id<Edge>]> = match pieces.as_slice() {
            [] => {
                let reason = "the edge's curve is empty".into();
                return Err(Problem { entity: curve, kind: self.entry(curve).kind, reason });
            }
            [piece] => Rc::new([self.edge(piece, [start, end])]),
            _ => self.composite(pieces, [start, end]),
        };
        self.edges.insert((list, index), edges.clone());
        Ok(edges)
    }

    /// The edge on one curve between two vertices.
    fn edge(&mut self, piece: &Piece, vertices: [Id<Vertex>; 2]) -> Id<Edge> {
        let [start, end] = vertices.map(|v| self.model.vertices[v].point);
        let [first, last] = piece.ends();
        let apart = |a: glam::DVec3, b: glam::DVec3| a.distance(start).max(b.distance(end));
        let piece =
            if apart(last, first) < apart(first, last) { piece.clone().reversed() } else { piece.clone() };
        let mut range = piece.range;
        let near = self.resolution.max(AT_END * piece.reach());
        if vertices[0] != vertices[1] {
            for (t, point) in range.iter_mut().zip([start, end]) {
                if piece.curve.point(*t).distance(point) > near {
                    let foot = invert_curve(&piece.curve, point, Some(*t));
                    let [low, high] =
                        [piece.range[0].min(piece.range[1]), piece.range[0].max(piece.range[1])];
                    *t = foot.clamp(low, high);
                }
            }
        }
        let range = if range[0] == range[1] { piece.range } else { range };
        let entity = piece.entity.into();
        self.model.edges.push(Edge { curve: piece.curve, range, vertices, pcurves: Vec::new(), entity })
    }

    /// The edges on a composite curve between two vertices.
    fn composite(&mut self, mut pieces: Vec<Piece>, vertices: [Id<Vertex>; 2]) -> Rc<[Id<Edge>]> {
        let [start, end] = vertices.map(|v| self.model.vertices[v].point);
        let ends = [pieces[0].ends()[0], pieces[pieces.len() - 1].ends()[1]];
        let apart = |a: glam::DVec3, b: glam::DVec3| a.distance(start).max(b.distance(end));
        if apart(ends[1], ends[0]) < apart(ends[0], ends[1]) {
            pieces = pieces.into_iter().rev().map(Piece::reversed).collect();
        }
        let bounds = pieces.into_iter().map(Bound::from).collect();
        let Some(TrimLoop::Edges(coedges)) = trim_loop(&mut self.model, bounds, self.resolution) else {
            return Rc::new([]);
        };
        let edges: Rc<[Id<Edge>]> = coedges.iter().map(|coedge| coedge.edge).collect();
        if let (Some(&first), Some(&last)) = (edges.first(), edges.last()) {
            self.model.edges[first].vertices[0] = vertices[0];
            self.model.edges[last].vertices[1] = vertices[1];
        }
        edges
    }
}

/// The shells of a solid with their senses (whether against), the outer one first.
pub fn solid_shells(parameters: &Parameters) -> Mapped<Vec<(u32, bool)>> {
    let voids = parameters.count(3, 2).unwrap_or(0);
    (0..=voids)
        .map(|i| match i {
            0 => Ok((parameters.reference(1)?, parameters.integer(2)? == 0)),
            _ => Ok((parameters.reference(2 + 2 * i)?, parameters.integer(3 + 2 * i)? == 0)),
        })
        .collect()
}

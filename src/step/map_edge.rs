//! Vertices and edges (ISO 10303-42, clause 5): where each edge runs on its curve.

use super::map_curve::MappedCurve;
use super::reader::{MAX_CHAIN, Mapped, Problem, Reader, problem, reference};
use super::value::Entity;
use crate::brep::{Edge, Id, Severity, Vertex};
use crate::geometry::{Curve, invert_curve};
use glam::DVec3;

/// Vertices closer than this (in millimetres; on a conic see [`ROUNDING`]) are one: an edge between them on a closed curve runs all around.
const SAME_POINT: f64 = 1e-6;

/// Two vertices of a conic are one where no more than this share of their coordinates is between them: what is farther apart the file means, and an
/// arc that short too, where loops were split beside a vertex.
const ROUNDING: f64 = 1e-10;

/// An end of a B-spline counts as the vertex where it is nearer than this part of the curve's extent. Files keep some seven
/// digits; inverting the vertex instead would cut a sliver off the curve's end.
const END_TOLERANCE: f64 = 1e-5;

impl Reader<'_> {
    /// The vertex `id`.
    pub fn vertex(&mut self, id: u64) -> Mapped<Id<Vertex>> {
        if let Some(&known) = self.vertices.get(&id) {
            return Ok(known);
        }
        let entity = self.entity(id)?;
        let record =
            entity.record("VERTEX_POINT").ok_or_else(|| problem(&entity, "expected a VERTEX_POINT"))?;
        let at = if entity.records.len() > 1 { 0 } else { 1 };
        let point = self.vertex_point(reference(id, record, at)?, 0)?;
        let vertex = self.model.vertices.push(Vertex { point, entity: id });
        self.vertices.insert(id, vertex);
        Ok(vertex)
    }

    /// The vertex of a poly loop at point `id`.
    pub fn point_vertex(&mut self, id: u64) -> Mapped<Id<Vertex>> {
        if let Some(&known) = self.vertices.get(&id) {
            return Ok(known);
        }
        let point = self.point(id)?;
        let vertex = self.model.vertices.push(Vertex { point, entity: id });
        self.vertices.insert(id, vertex);
        Ok(vertex)
    }

    /// The edge `id`, and whether it is used against its own direction.
    pub fn oriented_edge(&mut self, id: u64) -> Mapped<(Id<Edge>, bool)> {
        let (mut id, mut reversed) = (id, false);
        for _ in 0..MAX_CHAIN {
            let entity = self.entity(id)?;
            let Some(record) = entity.record("ORIENTED_EDGE") else {
                return Ok((self.edge(id, &entity)?, reversed));
            };
            // Name, start, end, element, orientation; a partial record has the last two alone.
            let at = if entity.records.len() > 1 { 0 } else { 3 };
            reversed ^= record.logical(at + 1) == Some(false);
            id = reference(id, record, at)?;
        }
        Err(Problem {
            entity: id,
            kind: "ORIENTED_EDGE".into(),
            reason: "edges refer to each other in a circle".into(),
        })
    }

    fn edge(&mut self, id: u64, entity: &Entity) -> Mapped<Id<Edge>> {
        if let Some(&known) = self.edges.get(&id) {
            return Ok(known);
        }
        let complex = entity.records.len() > 1;
        let ends = entity.record("EDGE").filter(|_| complex).unwrap_or(entity.first());
        let at = if complex { 0 } else { 1 };
        let ends = [at, at + 1].map(|at| reference(id, ends, at));
        let [start, end] = ends.map(|vertex| vertex.and_then(|vertex| self.vertex(vertex)));
        let (curve, same_sense) = self.edge_geometry(entity, 0);
        let carrier = curve.clone().and_then(|id| self.curve(id));
        let (start, end) = match (start, end) {
            (Ok(start), Ok(end)) => (start, end),
            given => self.ends_of(entity, given.into(), carrier.as_ref().ok(), same_sense)?,
        };
        let points = [start, end].map(|v| self.model.vertices[v].point);
        let carrier = match carrier {
            Err(reason) => self.lifted_edge(curve, points).ok_or(reason),
            carrier => carrier,
        };
        let edge = match carrier {
            Ok(mapped) => {
                let closed = start == end || are_one(&mapped.curve, points);
                let range = edge_range(&mapped.curve, points, closed, same_sense);
                let pcurves = self.pcurves(&mapped.pcurves, &mapped.curve);
                for repair in mapped.repairs {
                    self.report(Severity::Repaired, repair);
                }
                Edge { curve: mapped.curve, range, vertices: [start, end], pcurves, entity: id }
            }
            Err(reason) if points[0].distance(points[1]) > SAME_POINT => {
                let reason =
                    format!("{} #{}: {}; a straight edge instead", reason.kind, reason.entity, reason.reason);
                self.report(Severity::Warning, problem(entity, reason));
                line_edge(start, end, points, id)
            }
            Err(reason) => return Err(reason),
        };
        let edge = self.model.edges.push(edge);
        self.edges.insert(id, edge);
        Ok(edge)
    }

    /// The vertices of an edge that lacks one: those that are `given`, and the ends of its curve where that has ends.
    fn ends_of(
        &mut self,
        entity: &Entity,
        given: [Mapped<Id<Vertex>>; 2],
        carrier: Option<&MappedCurve>,
        same_sense: bool,
    ) -> Mapped<(Id<Vertex>, Id<Vertex>)> {
        let reason = given.iter().find_map(|vertex| vertex.clone().err());
        let reason = reason.unwrap_or_else(|| problem(entity, "the edge has no vertices"));
        let Some(carrier) = carrier.filter(|c| c.range().iter().all(|t| t.is_finite())) else {
            return Err(reason);
        };
        let mut range = carrier.range();
        if !same_sense {
            range.reverse();
        }
        let points = range.map(|t| carrier.curve.point(t));
        let is_closed = points[0].distance(points[1]) <= SAME_POINT;
        let Problem { entity: at, kind, reason } = reason;
        let reason = format!("{kind} #{at}: {reason}; the edge ends where its curve does");
        self.report(Severity::Repaired, problem(entity, reason));
        let mut end = |i: usize| {
            let vertex = || Vertex { point: points[i], entity: entity.id };
            given[i].clone().unwrap_or_else(|_| self.model.vertices.push(vertex()))
        };
        let start = end(0);
        Ok((start, if is_closed { start } else { end(1) }))
    }

    /// The curve of an edge that has one in a parameter plane alone.
    fn lifted_edge(&self, curve: Mapped<u64>, points: [DVec3; 2]) -> Option<MappedCurve> {
        let id = curve.ok()?;
        let entity = self.entity(id).ok()?;
        if entity.is("PCURVE") {
            return self.lifted(id, Some(points), 0).ok();
        }
        let record = entity.record("SURFACE_CURVE").unwrap_or(entity.first());
        let pcurves = record.references(if entity.records.len() > 1 { 1 } else { 2 });
        pcurves.into_iter().find_map(|pcurve| self.lifted(pcurve, Some(points), 0).ok())
    }

    /// The curve of an edge and whether the edge runs in its sense; that of its parent for a SUBEDGE.
    fn edge_geometry(&self, entity: &Entity, depth: usize) -> (Mapped<u64>, bool) {
        if let Some(record) = entity.record("EDGE_CURVE") {
            let at = if entity.records.len() > 1 { 0 } else { 3 };
            return (reference(entity.id, record, at), record.logical(at + 1) != Some(false));
        }
        let parent = entity.record("SUBEDGE").and_then(|r| r.parameters.last()).and_then(|p| p.reference());
        match parent.and_then(|id| self.entity(id).ok()) {
            Some(parent) if depth < MAX_CHAIN => {
                if let Some(oriented) = parent.record("ORIENTED_EDGE") {
                    let element = oriented.reference(3).and_then(|id| self.entity(id).ok());
                    if let Some(element) = element {
                        let (curve, same_sense) = self.edge_geometry(&element, depth + 1);
                        return (curve, same_sense ^ (oriented.logical(4) == Some(false)));
                    }
                }
                self.edge_geometry(&parent, depth + 1)
            }
            _ => (Err(problem(entity, "the edge has no curve")), true),
        }
    }

    /// A straight edge between two vertices.
    pub fn straight_edge(&mut self, [start, end]: [Id<Vertex>; 2], entity: u64) -> Id<Edge> {
        let points = [start, end].map(|v| self.model.vertices[v].point);
        self.model.edges.push(line_edge(start, end, points, entity))
    }

    /// The straight edge between two vertices of a poly loop, and whether it was made the other way round.
    pub fn poly_edge(&mut self, start: Id<Vertex>, end: Id<Vertex>, entity: u64) -> (Id<Edge>, bool) {
        let key = [start.min(end), start.max(end)];
        if let Some(&known) = self.poly_edges.get(&key) {
            return (known, self.model.edges[known].vertices[0] != start);
        }
        let edge = self.straight_edge([start, end], entity);
        self.poly_edges.insert(key, edge);
        (edge, false)
    }
}

fn line_edge(start: Id<Vertex>, end: Id<Vertex>, points: [DVec3; 2], entity: u64) -> Edge {
    let curve = Curve::Line { origin: points[0], direction: points[1] - points[0] };
    Edge { curve, range: [0.0, 1.0], vertices: [start, end], pcurves: Vec::new(), entity }
}

/// Whether different vertices at these points are one place on the curve.
fn are_one(curve: &Curve, points: [DVec3; 2]) -> bool {
    let apart = points[0].distance(points[1]);
    let is_conic = matches!(curve, Curve::Circle { .. } | Curve::Ellipse { .. });
    if !is_conic {
        return apart <= SAME_POINT;
    }
    let size = points[0].abs().max_element().max(extent(curve, curve.domain()));
    apart <= (size * ROUNDING).min(SAME_POINT)
}

/// The parameters of an edge's ends, in the order in which the edge runs.
fn edge_range(curve: &Curve, points: [DVec3; 2], closed: bool, same_sense: bool) -> [f64; 2] {
    let domain = curve.domain();
    let ends = match curve {
        Curve::Bspline(_) => {
            let tolerance = END_TOLERANCE * extent(curve, domain);
            let [low, high] = domain.map(|t| curve.point(t));
            let parameter = |point: DVec3, first: bool| {
                let (near, far) = if first == same_sense { (0, 1) } else { (1, 0) };
                let distances = [low.distance(point), high.distance(point)];
                // The end where the sense wants it; the other one where only that fits.
                [near, far].into_iter().find(|&i| distances[i] <= tolerance).map(|i| domain[i])
            };
            [parameter(points[0], true), parameter(points[1], false)]
        }
        _ => [None, None],
    };
    let start = ends[0].unwrap_or_else(|| invert_curve(curve, points[0], None));
    if closed && let Some(period) = curve.period() {
        return [start, if same_sense { start + period } else { start - period }];
    }
    let end = ends[1].unwrap_or_else(|| invert_curve(curve, points[1], None));
    let Some(period) = curve.period() else { return [start, end] };
    // A periodic curve is left in its sense: less than one turn, more than none.
    let turn = if same_sense { end - start } else { start - end };
    let turn = turn.rem_euclid(period);
    let turn = if turn == 0.0 { period } else { turn };
    [start, if same_sense { start + turn } else { start - turn }]
}

/// A rough size of a curve: the longest distance from its start to a sample.
fn extent(curve: &Curve, domain: [f64; 2]) -> f64 {
    let start = curve.point(domain[0]);
    (1..=8)
        .map(|i| curve.point(domain[0] + (domain[1] - domain[0]) * f64::from(i) / 8.0).distance(start))
        .fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Frame;
    use std::f64::consts::{FRAC_PI_2, PI, TAU};

    #[test]
    fn arcs_run_in_their_sense() {
        let circle = Curve::Circle { frame: Frame::IDENTITY, radius: 2.0 };
        let close = |a: [f64; 2], b: [f64; 2]| {
            let turns = ((a[0] - b[0]) / TAU).round() * TAU;
            assert!(
                (a[0] - b[0] - turns).abs() < 1e-12 && (a[1] - b[1] - turns).abs() < 1e-12,
                "{a:?} {b:?}"
            );
        };
        let (x, y) = (DVec3::X * 2.0, DVec3::Y * 2.0);
        close(edge_range(&circle, [x, y], false, true), [0.0, FRAC_PI_2]);
        close(edge_range(&circle, [x, y], false, false), [0.0, -1.5 * PI]);
        close(edge_range(&circle, [y, x], false, true), [FRAC_PI_2, TAU]);
        close(edge_range(&circle, [x, x], true, true), [0.0, TAU]);
        close(edge_range(&circle, [x, x], true, false), [0.0, -TAU]);
    }

    #[test]
    fn short_arcs_are_no_circles() {
        let circle = Curve::Circle { frame: Frame::IDENTITY, radius: 2.0 };
        let at = |angle: f64| circle.point(angle);
        assert!(are_one(&circle, [at(0.0), at(TAU)]));
        let beside = [at(1.0), at(1.0 + 5e-9)];
        assert!(!are_one(&circle, beside));
        let [start, end] = edge_range(&circle, beside, false, true);
        assert!((end - start - 5e-9).abs() < 1e-12);
        let [start, end] = edge_range(&circle, beside, false, false);
        assert!((start - end - TAU).abs() < 1e-8);
    }

    #[test]
    fn lines_need_no_sense() {
        let line = Curve::Line { origin: DVec3::ZERO, direction: DVec3::X * 2.0 };
        assert_eq!(edge_range(&line, [DVec3::X * 4.0, DVec3::X], false, true), [2.0, 0.5]);
    }
}

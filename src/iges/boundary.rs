//! Loops of edges from curves in the order of the file.
//!
//! Directions are checked, not trusted: a curve whose end, not its start, lies at the end of the one before is turned
//! round. Curves that coincide and run against each other are the two uses of a seam and become one edge.

use super::curve::Piece;
use crate::brep::{Coedge, Edge, Id, Model, Pcurve, TrimLoop, Vertex};
use crate::geometry::invert_curve;
use crate::numeric::Aabb;

/// Curves shorter than this share of their loop are points: they mark poles.
const NO_LENGTH: f64 = 1e-8;

/// Ends meet where they are closer than the file's resolution, within these shares of the loop's size: resolutions are
/// often mere defaults.
const MEETING: [f64; 2] = [1e-6, 1e-3];

/// Seams are looked for in loops of at most this many edges: every pair is compared.
const MOST_FOR_SEAMS: usize = 512;

/// A curve of a boundary.
#[derive(Debug, Clone)]
pub struct Bound {
    /// The curve in space.
    pub piece: Piece,
    /// The parameter-space curve that it was made from.
    pub pcurve: Option<Pcurve>,
}

impl From<Piece> for Bound {
    fn from(piece: Piece) -> Self {
        Self { piece, pcurve: None }
    }
}

/// The loop of `bounds`; a vertex where nothing has a length, nothing where there are no curves.
pub fn trim_loop(model: &mut Model, bounds: Vec<Bound>, resolution: f64) -> Option<TrimLoop> {
    let size = size(&bounds);
    let first = bounds.first()?.piece.clone();
    let mut bounds: Vec<Bound> = bounds.into_iter().filter(|b| b.piece.reach() > NO_LENGTH * size).collect();
    if bounds.is_empty() {
        let vertex = Vertex { point: first.at(0.0), entity: first.entity.into() };
        return Some(TrimLoop::Vertex(model.vertices.push(vertex)));
    }
    let meeting = meeting(&bounds, resolution);
    turn(&mut bounds, meeting);
    let partners = seams(&bounds, meeting);
    let vertices = vertices(model, &bounds, meeting);
    let mut coedges: Vec<Coedge> = Vec::with_capacity(bounds.len());
    for (i, bound) in bounds.into_iter().enumerate() {
        if let Some(partner) = partners[i] {
            coedges.push(Coedge { edge: coedges[partner].edge, reversed: true });
            continue;
        }
        let Piece { curve, range, entity, .. } = bound.piece;
        let pcurves = bound.pcurve.into_iter().collect();
        let edge = Edge { curve, range, vertices: vertices[i], pcurves, entity: entity.into() };
        coedges.push(Coedge { edge: model.edges.push(edge), reversed: false });
    }
    Some(TrimLoop::Edges(coedges))
}

fn size(bounds: &[Bound]) -> f64 {
    Aabb::around(bounds.iter().flat_map(|b| (0..=4).map(|i| b.piece.at(f64::from(i) / 4.0)))).diagonal()
}

/// How near two ends are that meet.
pub fn meeting(bounds: &[Bound], resolution: f64) -> f64 {
    let size = size(bounds);
    resolution.clamp(MEETING[0] * size, MEETING[1] * size)
}

/// Turns curves so that each starts where the one before ends.
fn turn(bounds: &mut [Bound], meeting: f64) {
    let flip = |bound: &mut Bound| bound.piece = bound.piece.clone().reversed();
    if let [first, second, ..] = bounds {
        let near = |end: usize| {
            let point = first.piece.ends()[end];
            second.piece.ends().into_iter().map(|p| p.distance(point)).fold(f64::INFINITY, f64::min)
        };
        if near(0) + meeting < near(1) {
            flip(first);
        }
    }
    for i in 1..bounds.len() {
        let tail = bounds[i - 1].piece.ends()[1];
        let [start, end] = bounds[i].piece.ends().map(|p| p.distance(tail));
        if end + meeting < start {
            flip(&mut bounds[i]);
        }
    }
}

/// For each curve the earlier one that it runs back along.
fn seams(bounds: &[Bound], meeting: f64) -> Vec<Option<usize>> {
    let mut partners = vec![None; bounds.len()];
    if bounds.len() > MOST_FOR_SEAMS {
        return partners;
    }
    let ends: Vec<_> = bounds.iter().map(|b| b.piece.ends()).collect();
    let mut taken = vec![false; bounds.len()];
    for i in 1..bounds.len() {
        let runs_back = |j: &usize| {
            let opposite =
                ends[i][0].distance(ends[*j][1]) <= meeting && ends[i][1].distance(ends[*j][0]) <= meeting;
            let follows = |s: f64| {
                let point = bounds[i].piece.at(s);
                let curve = &bounds[*j].piece.curve;
                let other = curve.point(invert_curve(curve, point, None));
                other.distance(point) <= meeting
            };
            // Arcs over and under the same chord part at their middles; closed curves may run the same way.
            let [one, other] = [&bounds[i].piece, &bounds[*j].piece];
            let middle = one.at(0.5).distance(other.at(0.5));
            let quarter = one.at(0.25).distance(other.at(0.75));
            let length = ends[i][0].distance(ends[i][1]).max(ends[i][0].distance(one.at(0.5)));
            opposite
                && middle.max(quarter) <= 0.5 * length + meeting
                && [0.25, 0.5, 0.75].into_iter().all(follows)
        };
        partners[i] = (0..i).find(|j| !taken[*j] && partners[*j].is_none() && runs_back(j));
        if let Some(partner) = partners[i] {
            taken[partner] = true;
        }
    }
    partners
}

/// The vertices of each curve; neighbours share one where they meet.
fn vertices(model: &mut Model, bounds: &[Bound], meeting: f64) -> Vec<[Id<Vertex>; 2]> {
    let mut new = |point, entity: u32| model.vertices.push(Vertex { point, entity: entity.into() });
    let mut vertices: Vec<[Id<Vertex>; 2]> = Vec::with_capacity(bounds.len());
    let first_start = bounds[0].piece.ends()[0];
    for (i, bound) in bounds.iter().enumerate() {
        let [start, end] = bound.piece.ends();
        let start_vertex = match vertices.last() {
            Some(&[_, last]) if bounds[i - 1].piece.ends()[1].distance(start) <= meeting => last,
            _ => new(start, bound.piece.entity),
        };
        let closes = i + 1 == bounds.len() && end.distance(first_start) <= meeting;
        let end_vertex = match vertices.first() {
            Some(&[first, _]) if closes => first,
            None if closes => start_vertex,
            _ => new(end, bound.piece.entity),
        };
        vertices.push([start_vertex, end_vertex]);
    }
    vertices
}

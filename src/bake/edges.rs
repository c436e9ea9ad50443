//! Edges for lines in pictures: exact curves as rational Bézier pieces, with what each edge is to its faces.
//!
//! An edge that faces share is told from their uses of it. Files without topology, such as most of IGES, give each face edges of its own: two
//! of one use each that run along each other are one edge.

use super::edge_kind::{kind, runs_along};
use super::faces::PartSpace;
use super::narrow;
use crate::brep::{Edge, Face, Id, Model, TrimLoop};
use crate::geometry::to_bspline::curve_to_bspline;
use crate::geometry::{Homogeneous, Homogeneous3, decompose_curve};
use crate::numeric::Aabb;
use crate::scene::{EdgePiece, MAX_DEGREE, NO_FACE, SceneBuffers};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::HashMap;

/// Two edges are one where they are nowhere farther apart than this share of the part's diagonal …
const APART: f64 = 1e-4;
/// … and of their own length.
const APART_OF_EDGE: f64 = 0.02;

/// An edge and the faces that use it.
struct Used {
    edge: Id<Edge>,
    /// Index of the scene's part.
    part: u32,
    /// Indices of the scene's faces, as often as each uses the edge.
    faces: Vec<u32>,
}

/// A piece on its way: its record without indices, and its points.
type Draft = (EdgePiece, Vec<[f32; 4]>);

/// Adds the edges of all faces of the scene; `added` are the scene's faces in the model, `slots` and `spaces` what the bake knows of each part.
pub(super) fn add(
    model: &Model,
    scene: &mut SceneBuffers,
    added: &[Id<Face>],
    slots: &[Option<(u32, Aabb)>],
    spaces: &[PartSpace],
) {
    scene.metadata.has_edges = true;
    let mut parts: Vec<Option<(PartSpace, f64)>> = vec![None; scene.parts.len()];
    for (slot, space) in slots.iter().zip(spaces) {
        if let Some((part, bounds)) = slot {
            parts[*part as usize] = Some((*space, bounds.diagonal()));
        }
    }
    let used = sewn(model, uses(model, scene, added), &parts);
    let drafts: Vec<Vec<Draft>> = used
        .par_iter()
        .map(|used| match parts[used.part as usize] {
            Some((space, _)) => pieces(model, used, added, &space),
            None => Vec::new(),
        })
        .collect();
    for (number, draft) in (0..).zip(drafts.into_iter().filter(|draft| !draft.is_empty())) {
        for (piece, points) in draft {
            let first_point = scene.edge_points.len() as u32;
            scene.edge_pieces.push(EdgePiece { first_point, edge: number, ..piece });
            scene.edge_points.extend(points);
        }
    }
}

/// Each edge once, in the model's order, with its uses.
fn uses(model: &Model, scene: &SceneBuffers, added: &[Id<Face>]) -> Vec<Used> {
    let mut uses: Vec<(Id<Edge>, u32, u32)> = Vec::new();
    for (index, &id) in (0_u32..).zip(added) {
        for trim_loop in &model.faces[id].loops {
            let TrimLoop::Edges(coedges) = trim_loop else { continue };
            let part = scene.faces[index as usize].part;
            uses.extend(coedges.iter().map(|coedge| (coedge.edge, part, index)));
        }
    }
    uses.sort_unstable();
    let groups = uses.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1));
    groups
        .map(|group| Used { edge: group[0].0, part: group[0].1, faces: group.iter().map(|u| u.2).collect() })
        .collect()
}

/// Joins edges of one use that run along each other.
fn sewn(model: &Model, mut used: Vec<Used>, parts: &[Option<(PartSpace, f64)>]) -> Vec<Used> {
    let mut waiting: HashMap<(u32, [i64; 3]), Vec<usize>> = HashMap::new();
    let mut joined = vec![false; used.len()];
    for index in 0..used.len() {
        let Used { edge, part, ref faces } = used[index];
        let (Some((_, size)), [face]) = (parts[part as usize], faces.as_slice()) else { continue };
        let (face, edge) = (*face, &model.edges[edge]);
        let ends = edge.range.map(|t| edge.curve.point(t));
        let tolerance = APART * size;
        // Twice the tolerance: what is within it is in the same cell or a neighbour.
        let cell = ((ends[0] + ends[1]) / (4.0 * tolerance)).floor();
        if !(tolerance > 0.0 && cell.abs().max_element() < 1e15) {
            continue;
        }
        let cell = cell.as_i64vec3().to_array();
        let neighbours =
            (0..27_i64).map(|n| [cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1]);
        let found =
            neighbours.filter_map(|cell| waiting.get(&(part, cell))).flatten().copied().find(|&other| {
                let apart = tolerance.min(APART_OF_EDGE * length(edge));
                !joined[other] && runs_along(edge, &model.edges[used[other].edge], apart)
            });
        match found {
            Some(other) => {
                used[other].faces.push(face);
                joined[other] = true;
                used[index].faces.clear();
            }
            None => waiting.entry((part, cell)).or_default().push(index),
        }
    }
    used.retain(|used| !used.faces.is_empty());
    used
}

/// About the length of an edge, millimetres.
fn length(edge: &Edge) -> f64 {
    const STEPS: u32 = 8;
    let at = |i: u32| {
        let s = f64::from(i) / f64::from(STEPS);
        edge.curve.point(edge.range[0] * (1.0 - s) + edge.range[1] * s)
    };
    (0..STEPS).map(|i| at(i).distance(at(i + 1))).sum()
}

/// The pieces of an edge; none where it has no length, or numbers that single precision cannot hold.
fn pieces(model: &Model, used: &Used, added: &[Id<Face>], space: &PartSpace) -> Vec<Draft> {
    let edge = &model.edges[used.edge];
    if !edge.range.iter().all(|t| t.is_finite()) {
        return Vec::new();
    }
    let faces: Vec<Id<Face>> = used.faces.iter().map(|&face| added[face as usize]).collect();
    let kind = kind(model, edge, &faces) as u32;
    let second = used.faces.iter().copied().find(|&face| face != used.faces[0]);
    let spans = decompose_curve(&curve_to_bspline(&edge.curve, edge.range));
    let draft = |points: &[Homogeneous3]| {
        let center = points[0].point() - space.center;
        let anchor = narrow::grid_point(center, space.grid_step)?;
        let origin = space.center + DVec3::from_array(anchor.grid.map(f64::from)) * space.grid_step;
        let local = |p: &Homogeneous3| <Homogeneous3 as Homogeneous>::new(p.point() - origin, p.weight());
        let points: Vec<[f32; 4]> = points.iter().map(|p| narrow::homogeneous(local(p))).collect();
        let piece = EdgePiece {
            grid: anchor.grid,
            part: used.part,
            faces: [used.faces[0], second.unwrap_or(NO_FACE)],
            first_point: 0,
            degree: points.len() as u32 - 1,
            kind,
            edge: 0,
            reserved: [0; 2],
        };
        let is_sound = |p: &[f32; 4]| p.iter().all(|x| x.is_finite()) && p[3] > 0.0;
        let has_length = points.iter().any(|p| *p != points[0]);
        let fits = (1..=MAX_DEGREE).contains(&piece.degree);
        (fits && has_length && points.iter().all(is_sound)).then_some((piece, points))
    };
    spans.iter().filter_map(|span| draft(&span.bezier.points)).collect()
}

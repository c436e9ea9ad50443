//! Which faces can be afforded: work and memory stay within a multiple of the model, however often its faces share surfaces and edges.
//!
//! A surface is cut into patches for each of its faces and an edge is followed for each of its uses. Real models use an edge twice and a surface a few
//! times; a hostile one makes thousands of faces of one large surface, or a loop that runs along one long edge thousands of times. Faces are
//! counted in the model's order, so that the answer depends on the model alone.

use crate::brep::{Edge, Face, Id, Model, TrimLoop};
use crate::geometry::{Curve, Surface, patch_points};

/// Control points that the patches of all faces may have together: this many times those of the model's surfaces (degree 3 alone makes 16 of 1), or
/// the lesser number where a model is small.
const PATCH_POINTS: usize = 256;
const FREE_PATCH_POINTS: usize = 1 << 24;

/// Spans of edges that may be followed: this many times those of the model's edges, or the lesser number where a model is small.
const EDGE_SPANS: usize = 16;
const FREE_EDGE_SPANS: usize = 1 << 18;

/// What the faces of a scene may cost.
pub(super) struct Budget {
    /// Why a face, in the order asked for, cannot be afforded.
    pub refusals: Vec<Option<&'static str>>,
    /// Control points that the patches of all others have together.
    pub patch_points: usize,
}

/// Counts `faces` of `model`.
pub(super) fn budget(model: &Model, faces: impl Iterator<Item = Id<Face>>) -> Budget {
    let control_points = model.surfaces.iter().map(|surface| match surface {
        Surface::Bspline(bspline) => bspline.points.len(),
        _ => 0,
    });
    let mut points_left = control_points.sum::<usize>().saturating_mul(PATCH_POINTS).max(FREE_PATCH_POINTS);
    let mut spans_left =
        model.edges.iter().map(spans).sum::<usize>().saturating_mul(EDGE_SPANS).max(FREE_EDGE_SPANS);
    let mut budget = Budget { refusals: Vec::new(), patch_points: 0 };
    for id in faces {
        let face = &model.faces[id];
        let points = match &model.surfaces[face.surface] {
            Surface::Bspline(bspline) => patch_points(bspline),
            _ => 0,
        };
        let coedges = face.loops.iter().flat_map(|trim| match trim {
            TrimLoop::Edges(coedges) => coedges.as_slice(),
            TrimLoop::Vertex(_) => &[],
        });
        let edge_spans = coedges.map(|coedge| spans(&model.edges[coedge.edge])).sum::<usize>();
        let refusal = if points > points_left {
            Some("the patches of all surfaces have too many control points together")
        } else if edge_spans > spans_left {
            Some("faces share long edges too often")
        } else {
            points_left -= points;
            spans_left -= edge_spans;
            budget.patch_points += points;
            None
        };
        budget.refusals.push(refusal);
    }
    budget
}

/// How many pieces following an edge takes, about.
fn spans(edge: &Edge) -> usize {
    match &edge.curve {
        Curve::Bspline(spline) => spline.points.len(),
        _ => 4,
    }
}

//! The order of a loop's edges where it runs along several seams.
//!
//! Some systems list the curves of such a boundary so that each starts where the one before ends, but at a corner where seams
//! cross there are several that do, and they take any. The loop that they mean has its face on the left all the way: at each
//! corner the next edge is the first one clockwise from the edge just run along, seen against the surface's normal.

use crate::brep::{Coedge, Model, TrimLoop};
use crate::geometry::{Surface, invert_surface};
use glam::DVec3;
use std::f64::consts::TAU;

/// Edges that leave a corner within this angle of the way back go back.
const WAY_BACK: f64 = 1e-6;

/// An edge in the direction of its loop.
struct Run {
    coedge: Coedge,
    points: [DVec3; 2],
    /// Directions at start and end, along the run.
    directions: [DVec3; 2],
}

impl Run {
    fn new(model: &Model, coedge: Coedge) -> Self {
        let edge = &model.edges[coedge.edge];
        let mut range = edge.range;
        if coedge.reversed {
            range.reverse();
        }
        let sign = (range[1] - range[0]).signum();
        let ends = range.map(|t| edge.curve.derivatives(t));
        Self {
            coedge,
            points: ends.map(|end| end.point),
            directions: ends.map(|end| (end.first * sign).normalize_or_zero()),
        }
    }
}

/// `trim` in the order in which its face lies on the left, as one loop or several, where two or more edges are seams; else as it is.
/// Ends that are nearer to each other than `meeting` are one corner.
pub fn around(
    model: &Model,
    trim: TrimLoop,
    surface: &Surface,
    flipped: bool,
    meeting: f64,
) -> Vec<TrimLoop> {
    let TrimLoop::Edges(coedges) = &trim else { return vec![trim] };
    let seams = coedges.iter().filter(|coedge| coedge.reversed).count();
    let is_seam = |coedge: &Coedge| coedges.iter().filter(|other| other.edge == coedge.edge).count() == 2;
    if seams < 2 {
        return vec![trim];
    }
    let runs: Vec<Run> = coedges.iter().map(|coedge| Run::new(model, *coedge)).collect();
    if coedges.iter().all(is_seam) {
        // Closed seams alone, as on a torus: all meet in one corner, in any order, and bound the whole surface.
        let are_closed = runs.iter().all(|run| run.points[0].distance(run.points[1]) <= meeting);
        return if are_closed { Vec::new() } else { vec![trim] };
    }
    let normal = |point: DVec3| {
        let d = surface.derivatives(invert_surface(surface, point, None).uv);
        let normal = d.du.cross(d.dv).normalize_or_zero();
        if flipped { -normal } else { normal }
    };
    rounds(runs, normal, meeting)
        .map_or_else(|| vec![trim], |loops| loops.into_iter().map(TrimLoop::Edges).collect())
}

/// The closed loops that `runs` make; `None` where one does not close.
fn rounds(runs: Vec<Run>, normal: impl Fn(DVec3) -> DVec3, meeting: f64) -> Option<Vec<Vec<Coedge>>> {
    let mut is_used = vec![false; runs.len()];
    let mut loops = Vec::new();
    while let Some(first) = is_used.iter().position(|used| !used) {
        let mut coedges = Vec::new();
        let mut at = first;
        loop {
            is_used[at] = true;
            coedges.push(runs[at].coedge);
            let corner = runs[at].points[1];
            let (up, back) = (normal(corner), -runs[at].directions[1]);
            let clockwise = |run: &Run| {
                let out = run.directions[0];
                let angle = (-up.dot(back.cross(out))).atan2(back.dot(out)).rem_euclid(TAU);
                if angle < WAY_BACK { TAU } else { angle }
            };
            let next = (0..runs.len())
                .filter(|i| (!is_used[*i] || *i == first) && runs[*i].points[0].distance(corner) <= meeting)
                .min_by(|a, b| clockwise(&runs[*a]).total_cmp(&clockwise(&runs[*b])))?;
            if next == first {
                break;
            }
            at = next;
        }
        loops.push(coedges);
    }
    Some(loops)
}

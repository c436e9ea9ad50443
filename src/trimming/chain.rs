//! The edges of a loop in walking order.
//!
//! Files give loops in order; some give them shuffled, or with edges the wrong way round. Order and direction are
//! checked in space and repaired greedily: next comes the edge that starts (or, turned round, ends) where the last ended.

use super::TrimError;
use super::pcurve::DirectedEdge;
use crate::brep::{Coedge, Model};

/// Loops with more edges are taken as they are: repair is quadratic.
const MAX_REORDERED: usize = 2048;

/// Ends closer than this share of the face meet.
const MEETING: f64 = 1e-4;

/// The edges of a loop as the file gives them.
pub(super) fn directed<'a>(model: &'a Model, coedges: &[Coedge]) -> Result<Vec<DirectedEdge<'a>>, TrimError> {
    coedges.iter().map(|&coedge| DirectedEdge::new(model, coedge)).collect()
}

/// The edges of a loop in walking order; what had to be repaired is appended to `repairs`.
pub(super) fn chained<'a>(
    given: Vec<DirectedEdge<'a>>,
    size: f64,
    repairs: &mut Vec<String>,
) -> Vec<DirectedEdge<'a>> {
    let limit = MEETING * size;
    let meets = |a: &DirectedEdge, b: &DirectedEdge| a.ends[1].distance(b.ends[0]) <= limit;
    let count = given.len();
    let in_order = (0..count).all(|i| meets(&given[i], &given[(i + 1) % count]));
    if in_order || count > MAX_REORDERED {
        return given;
    }
    let first = first_edge(&given, limit);
    let mut left: Vec<DirectedEdge> = given[1..].to_vec();
    let mut chain = vec![first];
    let mut moved = usize::from(first.range != given[0].range);
    while !left.is_empty() {
        let tail = chain[chain.len() - 1].ends[1];
        let (position, turned) = next_edge(&left, tail, limit);
        let edge = left.remove(position);
        moved += usize::from(position != 0 || turned);
        chain.push(if turned { edge.flipped() } else { edge });
    }
    if moved > 0 {
        repairs.push(format!("{moved} edges of a loop brought into order"));
    }
    chain
}

/// The first edge, turned where only its start meets the second edge.
fn first_edge<'a>(given: &[DirectedEdge<'a>], limit: f64) -> DirectedEdge<'a> {
    let first = given[0];
    let touched = |end: usize| {
        given.get(1).is_some_and(|next| next.ends.iter().any(|p| p.distance(first.ends[end]) <= limit))
    };
    if touched(0) && !touched(1) { first.flipped() } else { first }
}

/// The edge that continues at `tail`: the next one where it fits, else the nearest, and whether it must be turned.
fn next_edge(left: &[DirectedEdge], tail: glam::DVec3, limit: f64) -> (usize, bool) {
    if left[0].ends[0].distance(tail) <= limit {
        return (0, false);
    }
    let best = |end: usize| {
        (0..left.len())
            .map(|i| (i, left[i].ends[end].distance(tail)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .expect("some edges are left")
    };
    let (forward, backward) = (best(0), best(1));
    // Where nothing fits, the file's own order stands and the gap is closed.
    if forward.1 <= limit {
        (forward.0, false)
    } else if backward.1 <= limit {
        (backward.0, true)
    } else {
        (0, false)
    }
}

//! Whether faces close up.

use super::{Body, Coedge, Model, TrimLoop};

/// Whether the body's faces meet in all of their edges, as those around a volume do: each edge is used an even number of times.
pub fn is_closed(model: &Model, body: &Body) -> bool {
    let loops = body.faces.iter().flat_map(|&face| &model.faces[face].loops);
    let coedges = loops.flat_map(|trim_loop| match trim_loop {
        TrimLoop::Edges(coedges) => coedges.as_slice(),
        TrimLoop::Vertex(_) => &[],
    });
    let mut edges: Vec<usize> = coedges.map(|coedge: &Coedge| coedge.edge.index()).collect();
    edges.sort_unstable();
    edges.chunk_by(|a, b| a == b).all(|uses| uses.len() % 2 == 0)
}

//! The trimmed region of a face: loops, one by one, then together.

use super::chain::chained;
use super::outline::{Outline, outline};
use super::pcurve::DirectedEdge;
use super::region::{Report, region, whole_surface};
use super::segment::{end, set_end, set_start, start, with_axis};
use super::target::Target;
use super::{FaceTrim, TrimError, TrimOptions};
use crate::brep::{Coedge, Face, Id, Model, TrimLoop};
use crate::numeric::Aabb;

/// The trimmed region of `face`.
///
/// # Errors
/// See [`TrimError`]; no input makes it panic or run without end.
pub fn trim_face(model: &Model, face: Id<Face>, options: &TrimOptions) -> Result<FaceTrim, TrimError> {
    let face = &model.faces[face];
    let surface = &model.surfaces[face.surface];
    let loops: Vec<&[Coedge]> = face
        .loops
        .iter()
        .filter_map(|trim_loop| match trim_loop {
            TrimLoop::Edges(coedges) if !coedges.is_empty() => Some(coedges.as_slice()),
            _ => None,
        })
        .collect();
    let bounds = edge_bounds(model, &loops)?;
    if loops.is_empty() {
        return whole_surface(surface);
    }
    let size = bounds.diagonal();
    let magnitude = bounds.min.abs().max(bounds.max.abs()).max_element();
    let target = Target::new(surface, options.relative_tolerance, size, magnitude);
    let mut used: Vec<_> = loops.iter().copied().flatten().map(|coedge| coedge.edge).collect();
    used.sort_unstable();
    let seams = used.windows(2).any(|pair| pair[0] == pair[1]);
    let mut report = Report::default();
    let mut outlines = Vec::new();
    for coedges in loops {
        let edges = chained(model, coedges, size, &mut report.repairs)?;
        outlines.extend(outline(&target, &edges, face.same_sense)?);
    }
    if outlines.is_empty() {
        return whole_surface(surface);
    }
    for image in outlines.iter().flat_map(|outline| &outline.images) {
        report.deviation = report.deviation.max(image.deviation);
    }
    (0..2).for_each(|axis| align_constants(&mut outlines, &target, axis));
    let chains = outlines.into_iter().map(|outline| outline.welded(&target, &mut report.repairs)).collect();
    region(&target, chains, face.same_sense, seams, report)
}

/// The box around the edges, sampled.
fn edge_bounds(model: &Model, loops: &[&[Coedge]]) -> Result<Aabb, TrimError> {
    let mut bounds = Aabb::EMPTY;
    for coedge in loops.iter().copied().flatten() {
        let edge = DirectedEdge::new(&model.edges[coedge.edge], false)?;
        bounds = edge.samples().fold(bounds, Aabb::including);
    }
    if loops.is_empty() || bounds.is_finite() {
        Ok(bounds)
    } else {
        Err(TrimError::Numeric("the edges are not finite".into()))
    }
}

/// Gives straight images of constant `axis` that differ by less than the tolerance, whole periods apart, one value: the
/// sides of rectangles become exact, and so do the two sides of a seam and the edges of a B-spline's domain.
fn align_constants(outlines: &mut [Outline], target: &Target, axis: usize) {
    let period = target.periods[axis];
    let images = || outlines.iter().enumerate().flat_map(|(i, o)| (0..o.images.len()).map(move |j| (i, j)));
    let mut entries: Vec<Entry> = Vec::new();
    for (i, j) in images() {
        let segments = &outlines[i].images[j].segments;
        if let [segment] = segments.as_slice()
            && start(segment)[axis] == end(segment)[axis]
        {
            let value = start(segment)[axis];
            let middle = 0.5 * (start(segment) + end(segment));
            let width = target.tolerance / target.metric(middle)[axis].max(1e-300);
            entries.push(Entry { value, width, image: Some((i, j)), turns: 0.0 });
        }
    }
    if entries.is_empty() {
        return;
    }
    let anchors = [target.domain.min[axis], target.domain.max[axis]];
    for value in
        anchors.into_iter().filter(|value| value.is_finite()).take(if period.is_some() { 1 } else { 2 })
    {
        entries.push(Entry { value, width: f64::INFINITY, image: None, turns: 0.0 });
    }
    if let Some(period) = period {
        // Half a period below the anchor, so that values around the anchor stay together.
        let base = target.domain.min[axis] - 0.5 * period;
        for entry in &mut entries {
            entry.turns = ((entry.value - base) / period).floor();
            entry.value -= entry.turns * period;
        }
    }
    entries.sort_by(|a, b| a.value.total_cmp(&b.value));
    let mut begin = 0;
    for i in 1..=entries.len() {
        let together = i < entries.len()
            && entries[i].value - entries[i - 1].value <= 2.0 * entries[i].width.min(entries[i - 1].width);
        if together {
            continue;
        }
        let cluster = &entries[begin..i];
        begin = i;
        let leader = cluster.iter().find(|e| e.image.is_none()).unwrap_or(&cluster[0]).value;
        for entry in cluster {
            let Some((outline, image)) = entry.image else { continue };
            let value = leader + entry.turns * period.unwrap_or(0.0);
            let segment = &mut outlines[outline].images[image].segments[0];
            let (a, b) = (start(segment), end(segment));
            set_start(segment, with_axis(a, axis, value));
            set_end(segment, with_axis(b, axis, value));
        }
    }
}

struct Entry {
    value: f64,
    /// How far the value may move.
    width: f64,
    image: Option<(usize, usize)>,
    turns: f64,
}

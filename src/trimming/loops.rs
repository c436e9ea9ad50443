//! The trimmed region of a face: loops, one by one, then together.

use super::align::align_constants;
use super::chain::{chained, directed};
use super::outline::{Outline, outline};
use super::pcurve::DirectedEdge;
use super::region::{Report, Sides, region, whole_surface};
use super::target::Target;
use super::{FaceTrim, TrimError, TrimOptions};
use crate::brep::{Face, Id, Model, TrimLoop};
use crate::numeric::Aabb;

/// The trimmed region of `face`. A loop that cannot be taken is left out where it is a hole; an outer one costs the face.
///
/// # Errors
/// See [`TrimError`]; no input makes it panic or run without end.
pub fn trim_face(model: &Model, face: Id<Face>, options: &TrimOptions) -> Result<FaceTrim, TrimError> {
    let face = &model.faces[face];
    let surface = &model.surfaces[face.surface];
    let mut loops: Vec<Bounded> = Vec::new();
    let mut broken = Broken::default();
    for trim_loop in &face.loops {
        let TrimLoop::Edges(coedges) = trim_loop else { continue };
        if coedges.is_empty() {
            continue;
        }
        match directed(model, coedges) {
            Ok(edges) => loops.push(Bounded::new(edges)),
            // Nobody knows how large it is, so it may be the outer one.
            Err(error) => broken.add(error, f64::INFINITY),
        }
    }
    let bounds = loops.iter().fold(Aabb::EMPTY, |bounds, one| bounds.union(one.bounds));
    if loops.is_empty() {
        return broken.first.map_or_else(|| whole_surface(surface), Err);
    }
    if !bounds.is_finite() {
        return Err(TrimError::Numeric("the edges are not finite".into()));
    }
    let size = bounds.diagonal();
    let magnitude = bounds.min.abs().max(bounds.max.abs()).max_element();
    let mut target = Target::new(face.surface, surface, options.relative_tolerance, size, magnitude);
    target.add_holes(&loops.iter().map(|one| one.edges.as_slice()).collect::<Vec<_>>());
    let mut report = Report { size, ..Report::default() };
    let mut used: Vec<_> = loops.iter().flat_map(|one| &one.edges).map(|edge| edge.id).collect();
    used.sort_unstable();
    let seams = used.windows(2).any(|pair| pair[0] == pair[1]);
    let mut outlines: Vec<Outline> = Vec::new();
    let mut largest = 0.0;
    for Bounded { edges, bounds } in loops {
        let edges = chained(edges, size, &mut report.repairs);
        match outline(&target, &edges, face.same_sense) {
            Ok(Some(found)) if found.is_finite() => {
                outlines.push(found);
                largest = bounds.diagonal().max(largest);
            }
            Ok(Some(_)) => {
                let reason = "a loop has parameters that are not finite";
                broken.add(TrimError::Numeric(reason.into()), bounds.diagonal());
            }
            Ok(None) => {}
            Err(error) => broken.add(error, bounds.diagonal()),
        }
    }
    if let Some(error) = broken.first {
        // What goes round the surface has a counterpart, so that none of its loops is a mere hole.
        let goes_round = outlines.iter().any(Outline::goes_round);
        if outlines.is_empty() || goes_round || broken.largest >= largest {
            return Err(error);
        }
        report.losses.push(match broken.count {
            1 => format!("a hole is lost: {error}"),
            count => format!("{count} holes are lost: {error}"),
        });
    }
    if outlines.is_empty() {
        return whole_surface(surface);
    }
    (0..2).for_each(|axis| align_constants(&mut outlines, &target, axis));
    let mut chains = Vec::with_capacity(outlines.len());
    for outline in &mut outlines {
        chains.push(outline.welded(&target, &mut report.repairs));
        report.edges.extend(outline.images.iter().map(|image| (image.edge, image.deviation)));
    }
    let vertices = face.loops.iter().filter_map(|one| match one {
        TrimLoop::Vertex(vertex) => Some(model.vertices[*vertex].point),
        TrimLoop::Edges(_) => None,
    });
    let sides = Sides { left: face.same_sense, seams, vertices: vertices.collect() };
    region(&target, chains, &sides, report)
}

/// A loop and the box around samples of it.
struct Bounded<'a> {
    edges: Vec<DirectedEdge<'a>>,
    bounds: Aabb,
}

impl<'a> Bounded<'a> {
    fn new(edges: Vec<DirectedEdge<'a>>) -> Self {
        let bounds = edges.iter().flat_map(DirectedEdge::samples).fold(Aabb::EMPTY, Aabb::including);
        Self { edges, bounds }
    }
}

/// Loops that cannot be taken.
#[derive(Default)]
struct Broken {
    first: Option<TrimError>,
    count: usize,
    /// The greatest diagonal.
    largest: f64,
}

impl Broken {
    fn add(&mut self, error: TrimError, size: f64) {
        self.first.get_or_insert(error);
        self.count += 1;
        self.largest = self.largest.max(size);
    }
}

//! What a scene's trims are made of: the columns of Table 1 of Sloup and Havran 2021, as far as they are the scene's own.

use crate::bake::TrimRegions;
use crate::brep::{Model, TrimLoop};
use crate::scene::SceneBuffers;
use std::collections::BTreeMap;

/// Counts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TrimStatistics {
    /// Faces in the scene (N).
    pub surfaces: usize,
    /// Of these, faces with trim curves.
    pub trimmed: usize,
    /// Bézier nets of free-form faces (N_B); the other faces stay analytic.
    pub nets: usize,
    /// Sub-domains of nets.
    pub leaves: usize,
    /// Loops of the model's faces (N_TH).
    pub loops: usize,
    /// Uses of edges by these loops: trim curves as the file has them (N_NC).
    pub curves: usize,
    /// Rational Bézier curves after fitting and splitting to monotone ones (N_BC).
    pub bezier_curves: usize,
    /// How many of these have each degree (N_BCD); straight ones have degree 1.
    pub degrees: BTreeMap<usize, usize>,
}

/// Counts a model and what was baked of it.
pub fn statistics(model: &Model, scene: &SceneBuffers, regions: &TrimRegions) -> TrimStatistics {
    let loops = || model.faces.iter().flat_map(|face| &face.loops);
    let edges_of = |trim_loop: &TrimLoop| match trim_loop {
        TrimLoop::Edges(coedges) => coedges.len(),
        TrimLoop::Vertex(_) => 0,
    };
    let degrees = regions.degrees();
    TrimStatistics {
        surfaces: scene.faces.len(),
        trimmed: (0..regions.len()).filter(|&face| regions.is_trimmed(face)).count(),
        nets: scene.nets.len(),
        leaves: scene.net_leaves.len(),
        loops: loops().count(),
        curves: loops().map(edges_of).sum(),
        bezier_curves: degrees.values().sum(),
        degrees,
    }
}

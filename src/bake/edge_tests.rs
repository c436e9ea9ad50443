//! Edges of fixtures: what kinds there are, and that files without topology are sewn.

use super::{BakeOptions, bake};
use crate::scene::EdgeKind;
use std::path::Path;

/// Edges of each kind.
fn kinds(file: &str) -> [usize; 4] {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(file);
    let model = crate::import::import(&path).expect("a fixture");
    let scene = bake(&model, &BakeOptions { edges: true, ..BakeOptions::default() }, &|_, _| {});
    let edges: Vec<_> = scene.edge_pieces.chunk_by(|a, b| a.edge == b.edge).map(|pieces| pieces[0]).collect();
    [EdgeKind::Sharp, EdgeKind::Boundary, EdgeKind::Smooth, EdgeKind::Seam]
        .map(|kind| edges.iter().filter(|edge| edge.kind == kind as u32).count())
}

#[test]
fn a_solid_has_edges_between_faces_and_seams_and_no_borders() {
    let [sharp, boundary, smooth, seam] = kinds("bearing/model.step");
    assert!(sharp > 20 && boundary == 0 && smooth > 0 && seam > 4, "{sharp} {boundary} {smooth} {seam}");
    let [sharp, boundary, smooth, _] = kinds("bracket/model.step");
    assert!(sharp > 40 && boundary == 0 && smooth > 4, "{sharp} {boundary} {smooth}");
}

#[test]
fn edges_of_faces_without_topology_are_sewn() {
    assert_eq!(kinds("bracket/model.igs"), kinds("bracket/model.step"));
}

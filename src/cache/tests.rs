//! Round trips, and files that were cut or changed.

use super::{CacheError, CacheFile, Provenance, write};
use crate::bake::{BakeOptions, bake};
use crate::brep::{Body, BodyKind, Coedge, Edge, Face, Model, Part, TrimLoop, Vertex};
use crate::geometry::{Curve, Frame, Surface};
use crate::scene::SceneBuffers;
use glam::DVec3;

/// A unit square with a quarter cut off along a diagonal: one planar face with a trim tree.
pub(super) fn buffers() -> SceneBuffers {
    let mut model = Model::default();
    let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.7), (0.6, 1.0), (0.0, 1.0)];
    let points = corners.map(|(x, y)| DVec3::new(x, y, 0.0));
    let vertices = points.map(|point| model.vertices.push(Vertex { point, entity: 0 }));
    let coedges = (0..points.len())
        .map(|i| {
            let next = (i + 1) % points.len();
            let curve = Curve::Line { origin: points[i], direction: points[next] - points[i] };
            let ends = [vertices[i], vertices[next]];
            let edge = Edge { curve, range: [0.0, 1.0], vertices: ends, pcurves: vec![], entity: 1 };
            Coedge { edge: model.edges.push(edge), reversed: false }
        })
        .collect();
    let surface = model.surfaces.push(Surface::Plane { frame: Frame::IDENTITY });
    let face = model.faces.push(Face {
        surface,
        same_sense: true,
        loops: vec![TrimLoop::Edges(coedges)],
        color: None,
        name: String::new(),
        entity: 7,
    });
    let body = Body { kind: BodyKind::Sheet, faces: vec![face], name: String::new(), entity: 8 };
    let part =
        model.parts.push(Part { name: "plate".into(), bodies: vec![body], children: vec![], entity: 9 });
    model.roots.push(part);
    model.declared_faces = 1;
    let options = BakeOptions { keep_f64: true, edges: true, ..BakeOptions::default() };
    bake(&model, &options, &|_, _| {})
}

pub(super) fn provenance() -> Provenance {
    Provenance { source_hash: [3; 32], distortion: 0.125, trim_tolerance: 1e-7 }
}

#[test]
fn what_is_written_is_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.trimray");
    let buffers = buffers();
    assert_eq!(buffers.faces.len(), 1, "{:?}", buffers.metadata.findings);
    assert!(!buffers.trim_segments.is_empty());
    write(&path, &buffers.scene(), &provenance()).expect("written");
    let file = CacheFile::open(&path).expect("valid");
    let (a, b) = (buffers.scene(), file.scene());
    assert_eq!(a.metadata, b.metadata);
    assert_eq!(a.header, b.header);
    assert_eq!(a.bvh_nodes, b.bvh_nodes);
    assert_eq!(a.primitives, b.primitives);
    assert_eq!((a.instances, a.parts, a.faces), (b.instances, b.parts, b.faces));
    assert_eq!((a.trim_nodes, a.trim_segments), (b.trim_nodes, b.trim_segments));
    assert_eq!((a.faces_f64, a.instances_f64), (b.faces_f64, b.instances_f64));
    assert_eq!((a.edge_pieces.len(), a.edge_points.len()), (5, 10));
    assert_eq!((a.edge_pieces, a.edge_points), (b.edge_pieces, b.edge_points));
    assert_eq!(file.provenance(), &provenance());

    let again = folder.path().join("b.trimray");
    write(&again, &b, &provenance()).expect("written");
    assert_eq!(std::fs::read(&path).expect("read"), std::fs::read(&again).expect("read"));
    assert_eq!(std::fs::read_dir(folder.path()).expect("read").count(), 2, "no temporary file is left");
}

#[test]
fn cut_files_are_invalid() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.trimray");
    write(&path, &buffers().scene(), &provenance()).expect("written");
    let bytes = std::fs::read(&path).expect("read");
    let cut = folder.path().join("cut.trimray");
    for length in (0..bytes.len()).step_by(397).chain([1, 87, 88, 89, 4095, 4096, bytes.len() - 1]) {
        std::fs::write(&cut, &bytes[..length]).expect("written");
        match CacheFile::open(&cut) {
            Err(CacheError::Invalid { .. }) => {}
            // Some systems cannot map an empty file.
            Err(CacheError::Io { .. }) if length == 0 => {}
            other => panic!("{length}: {other:?}"),
        }
    }
    assert!(matches!(CacheFile::open(&folder.path().join("none")), Err(CacheError::Io { .. })));
}

#[test]
fn changed_files_are_invalid_or_sound() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.trimray");
    write(&path, &buffers().scene(), &provenance()).expect("written");
    let bytes = std::fs::read(&path).expect("read");
    let changed = folder.path().join("changed.trimray");
    let mut refused = 0;
    let interesting: Vec<usize> =
        (0..bytes.len()).filter(|&at| at < 512 || bytes[at] != 0 && at % 3 == 0).collect();
    for &at in &interesting {
        for value in [bytes[at] ^ 0x80, bytes[at] ^ 1, 0xff] {
            let mut copy = bytes.clone();
            copy[at] = value;
            std::fs::write(&changed, &copy).expect("written");
            match CacheFile::open(&changed) {
                Err(CacheError::Invalid { .. }) => refused += 1,
                Err(error) => panic!("{at}: {error}"),
                Ok(_) => {}
            }
        }
    }
    assert!(refused > 300, "{refused}");
}

//! Whole bakes: hand-made models, and real files where they are at hand.

use super::{BakeOptions, bake};
use crate::brep::{Body, BodyKind, Child, Color, Face, Model, Part};
use crate::geometry::{BsplineSurface, Frame, Homogeneous, Surface};
use crate::scene::{FaceKind, Finding, Metadata, SceneBuffers, Severity, TRIM_INSIDE, validate};
use glam::{DAffine3, DVec3};
use std::path::{Path, PathBuf};

fn untrimmed(surface: Surface, model: &mut Model) -> crate::brep::Id<Face> {
    let surface = model.surfaces.push(surface);
    let entity = 100 + model.faces.len() as u64;
    let color = None;
    model.faces.push(Face { surface, same_sense: true, loops: vec![], color, name: String::new(), entity })
}

fn bumpy() -> BsplineSurface {
    let knots = || (0..9).map(|i: i32| f64::from(i.clamp(3, 5) - 3)).collect::<Vec<_>>();
    let points = (0..25).map(|k| {
        let (i, j) = (f64::from(k / 5), f64::from(k % 5));
        Homogeneous::new(DVec3::new(i, j, (i * 2.0).sin() * j.cos()), 1.0 + 0.2 * (i - j).cos())
    });
    BsplineSurface::new([3, 3], [knots(), knots()], points.collect()).expect("valid knots")
}

/// A sphere, a torus and a B-spline in one part, placed three times: moved, turned and blue, mirrored.
fn model() -> Model {
    let mut model = Model::default();
    let frame = Frame { origin: DVec3::new(1e4, 0.0, 5.0), ..Frame::IDENTITY };
    let faces = vec![
        untrimmed(Surface::Sphere { frame, radius: 2.0 }, &mut model),
        untrimmed(Surface::Torus { frame, major: 5.0, minor: 1.0 }, &mut model),
        untrimmed(Surface::Bspline(bumpy()), &mut model),
        untrimmed(Surface::Plane { frame }, &mut model),
    ];
    model.declared_faces = faces.len();
    let body = Body { kind: BodyKind::Solid, faces, name: String::new(), entity: 1 };
    let leaf =
        model.parts.push(Part { name: "leaf".into(), bodies: vec![body], children: vec![], entity: 2 });
    let child = |matrix: DAffine3, color: Option<Color>| Child {
        part: leaf,
        parent_from_child: matrix,
        name: String::new(),
        color,
        entity: 3,
    };
    let children = vec![
        child(DAffine3::from_translation(DVec3::new(1e5, 2.0, 3.0)), None),
        child(DAffine3::from_rotation_z(1.0), Some(Color::opaque(0.0, 0.0, 1.0))),
        child(DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0)), None),
        child(DAffine3::from_scale(DVec3::ZERO), None),
    ];
    let root = Part { name: "root".into(), bodies: vec![], children, entity: 4 };
    let root = model.parts.push(root);
    model.roots.push(root);
    model
}

fn baked(model: &Model, threads: usize) -> SceneBuffers {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
    let options = BakeOptions { keep_f64: true, ..BakeOptions::default() };
    pool.install(|| bake(model, &options, &|_, _| {}))
}

fn dropped(metadata: &Metadata) -> impl Iterator<Item = &Finding> {
    metadata.findings.iter().filter(|finding| finding.severity == Severity::Dropped)
}

fn bytes(buffers: &SceneBuffers) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.trimray");
    crate::cache::write(&path, &buffers.scene(), &crate::cache::Provenance::default()).expect("written");
    std::fs::read(&path).expect("read")
}

#[test]
fn instances_share_a_part_and_losses_are_reported() {
    let scene = baked(&model(), 2);
    validate(&scene.scene()).expect("sound");
    assert_eq!((scene.parts.len(), scene.instances.len()), (1, 3));
    let kinds: Vec<u32> = scene.faces.iter().map(|face| face.kind).collect();
    assert_eq!(kinds, [FaceKind::Sphere, FaceKind::Torus, FaceKind::Nets].map(|kind| kind as u32));
    assert!(scene.faces.iter().all(|face| face.trim_root == TRIM_INSIDE));
    let dropped: Vec<u64> = dropped(&scene.metadata).map(|f| f.entity).collect();
    assert_eq!(dropped, [103, 2], "the unbounded plane, the placement without volume");
    assert_eq!(scene.instances[0].is_translation, 1);
    assert_eq!(scene.instances[1].is_translation, 0);
    assert_eq!(scene.materials[scene.instances[1].material as usize].rgb, [0.0, 0.0, 1.0]);
    assert_eq!(scene.metadata.solids, 4);
    // Grid and fraction give back where the sphere stands, through the first instance.
    let (face, instance, header) = (&scene.faces[0], &scene.instances[0], &scene.header);
    let step = header.grid_step;
    for k in 0..3 {
        let in_part = f64::from(face.grid[k]) * step + f64::from(face.offset[k]);
        let part = f64::from(instance.grid[k]) * step + f64::from(instance.fraction[k]);
        let world = in_part + part + header.world_anchor[k];
        let expected = [1.1e5, 2.0, 8.0][k];
        assert!((world - expected).abs() < step * 1e-6, "{world} {expected}");
    }
}

#[test]
fn threads_do_not_change_a_byte() {
    let one = bytes(&baked(&model(), 1));
    assert!(one == bytes(&baked(&model(), 4)));
    assert!(one == bytes(&baked(&model(), 1)));
}

#[test]
fn empty_models_bake_to_empty_scenes() {
    let scene = baked(&Model::default(), 1);
    validate(&scene.scene()).expect("sound");
    assert!(scene.faces.is_empty() && scene.bvh_nodes.is_empty());
}

fn step_files(folder: &Path, found: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let path = entry.path();
        let extension = path.extension().map(|e| e.to_ascii_lowercase());
        if path.is_dir() {
            step_files(&path, found);
        } else if extension.is_some_and(|e| e == "step" || e == "stp" || e == "p21") {
            found.push(path);
        }
    }
}

/// Real files: sound scenes, all faces accounted for, the same bytes whatever the threads.
#[test]
fn corpus_files_bake_to_sound_scenes() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let places = ["../shared/corpus", "../../shared/corpus"].map(|place| root.join(place));
    let folder = places.iter().find(|place| place.is_dir()).unwrap_or(&places[0]);
    let mut files = Vec::new();
    step_files(folder, &mut files);
    if files.is_empty() {
        eprintln!("skipped: no files in {}", folder.display());
        return;
    }
    let size = |path: &PathBuf| std::fs::metadata(path).map_or(u64::MAX, |m| m.len());
    files.retain(|path| size(path) < 400_000);
    files.sort();
    let mut baked_files = 0;
    for (index, path) in files.iter().enumerate() {
        let Ok(model) = crate::import::import(path) else { continue };
        let start = std::time::Instant::now();
        let scene = baked(&model, 2);
        let name = path.display();
        validate(&scene.scene()).unwrap_or_else(|flaw| panic!("{name}: {flaw}"));
        let dropped = dropped(&scene.metadata).filter(|f| f.faces > 0).count();
        eprintln!(
            "{:7.2} s {:6} faces {:5} dropped {:7} nets {:8} leaves {:8} segments {name}",
            start.elapsed().as_secs_f64(),
            scene.faces.len(),
            dropped,
            scene.nets.len(),
            scene.net_leaves.len(),
            scene.trim_segments.len(),
        );
        if index % 8 == 0 {
            assert!(bytes(&scene) == bytes(&baked(&model, 1)), "{name}: threads change it");
        }
        baked_files += 1;
    }
    assert!(baked_files > 0);
}

/// Two blocks of a millimetre, 1000 mm apart, each a part of its own.
fn two_blocks() -> SceneBuffers {
    let mut model = Model::default();
    for (index, x) in [0.0, 1000.0].into_iter().enumerate() {
        let frame = Frame { origin: DVec3::new(x, 0.0, 0.0), ..Frame::IDENTITY };
        let faces = crate::brep::primitive::block(&mut model, &frame, DVec3::ONE, 10).expect("a block");
        model.declared_faces += faces.len();
        let body = Body { kind: BodyKind::Solid, faces, name: String::new(), entity: 1 };
        let part = Part { name: format!("block {index}"), bodies: vec![body], children: vec![], entity: 2 };
        let part = model.parts.push(part);
        model.roots.push(part);
    }
    bake(&model, &BakeOptions { keep_f64: true, ..BakeOptions::default() }, &|_, _| {})
}

#[test]
fn part_of_a_scene_is_a_scene_of_its_own() {
    let whole = two_blocks();
    let whole = whole.scene();
    assert!(whole.body_infos.iter().all(|body| body.is_closed()));
    let faces = vec![true; whole.faces.len()];
    let kept = super::keep(&whole, &[false, true], &faces).expect("kept");
    let scene = kept.of(&whole);
    validate(&scene).expect("a valid scene");
    assert_eq!((scene.instances.len(), scene.metadata.instances.len()), (1, 1));
    assert_eq!(scene.metadata.instances[0].path, "block 1");
    assert!((scene.header.world_anchor[0] - 1000.5).abs() < 0.1, "{:?}", scene.header.world_anchor);
    assert!(scene.header.half_size.iter().all(|&half| (0.5..0.6).contains(&half)));
    assert_eq!(scene.metadata.missing_faces(Severity::Hidden), 6);
    assert!(scene.body_infos[1].is_closed() && scene.has_f64());

    let mut faces = faces;
    faces[0] = false;
    let kept = super::keep(&whole, &[true, true], &faces).expect("kept");
    let scene = kept.of(&whole);
    validate(&scene).expect("a valid scene");
    let part = scene.faces[0].part as usize;
    assert!(!scene.body_infos[scene.faces[0].body as usize].is_closed(), "a body without a face is open");
    let is_closed = |face: &crate::scene::Face| face.flags & crate::scene::Face::CLOSED != 0;
    assert!(
        whole.faces.iter().all(is_closed) && scene.faces.iter().filter(|face| is_closed(face)).count() == 6
    );
    assert_eq!((scene.instances.len(), scene.metadata.missing_faces(Severity::Hidden)), (2, 1));
    let slots = |scene: &crate::scene::Scene<'_>| {
        let part = scene.parts[part];
        let nodes = &scene.bvh_nodes[part.first_node as usize..][..part.node_count as usize];
        nodes.iter().flat_map(|node| node.child_meta).filter(|&meta| meta != 0).count()
    };
    assert_eq!(slots(&scene) + 1, slots(&whole));

    let nothing = super::keep(&whole, &[false, false], &faces).expect("kept");
    validate(&nothing.of(&whole)).expect("a valid scene");
}

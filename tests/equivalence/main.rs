//! The GPU answers as the CPU does, in hits and in pictures; and the comparison notices a kernel that is wrong.
//!
//! Needs an adapter, lavapipe at least. Without one the tests say so and pass, unless `REQUIRE_GPU=1` asks for one.
#![cfg(feature = "gpu")]

mod compare;
mod held;
mod layers;
mod lines;
mod paths;
mod sections;
mod synthetic;
mod trims;

use compare::{compare_hits, compare_pictures};
use glam::DVec3;
use std::path::{Path, PathBuf};
use trimray::bake::BakeOptions;
use trimray::bench::{aimed, chord, edge_points};
use trimray::image::Layers;
use trimray::render::cpu::{self, Precision};
use trimray::render::gpu::{AdapterChoice, Gpu, GpuError};
use trimray::render::section::Section;
use trimray::render::{Background, Camera, Exactness, Ray, RenderOptions, Sampling};
use trimray::scene::{FaceKind, Scene, SceneBuffers};

/// Share of rays that have to agree. What is left are near ties: silhouettes, trim borders, coincident faces.
const LEAST_AGREEMENT: f64 = 0.999;

/// Rays for each fixture.
const FIXTURE_RAYS: u64 = 2_000;

fn gpu() -> Option<Gpu> {
    match Gpu::new(AdapterChoice::Any) {
        Ok(gpu) => Some(gpu),
        Err(error) if std::env::var_os("REQUIRE_GPU").is_some_and(|value| value == "1") => {
            panic!("REQUIRE_GPU=1, but {error}")
        }
        Err(error) => {
            eprintln!("skipped: {error}");
            None
        }
    }
}

fn radius(scene: &Scene<'_>) -> f64 {
    DVec3::from_array(scene.header.half_size.map(f64::from)).length()
}

/// Chords of the scene's bounding sphere.
fn chords(scene: &Scene<'_>, count: u64) -> Vec<Ray> {
    (0..count).map(|index| chord(scene, index)).collect()
}

fn camera(scene: &Scene<'_>, orthographic: bool) -> Camera {
    let forward = DVec3::new(-1.0, 1.5, -0.9).normalize();
    let right = forward.cross(DVec3::Z).normalize();
    let distance = 3.0 * radius(scene);
    Camera {
        position: DVec3::from_array(scene.header.world_anchor) - forward * distance,
        forward,
        right,
        up: right.cross(forward),
        half_height: if orthographic { radius(scene) } else { 0.2 },
        orthographic,
    }
}

fn options(ambient_occlusion: bool) -> RenderOptions {
    RenderOptions {
        resolution: [160, 110],
        samples: 4,
        sampling: Sampling::Adaptive,
        background: Background::Transparent,
        ambient_occlusion,
        exactness: Exactness::Exact,
        layers: Layers::PLAIN,
        window: None,
        section: Section::default(),
    }
}

/// Whether the comparison was possible: a software device may give up, and says so.
fn assert_hits_agree(name: &str, gpu: &Gpu, scene: &Scene<'_>, rays: u64) -> bool {
    let rays = chords(scene, rays);
    let on_gpu = gpu.upload(scene).unwrap();
    let expected = cpu::probe(scene, &rays, Precision::F32, false);
    for first_only in [false, true] {
        let found = match gpu.probe(&on_gpu, &rays, first_only) {
            Ok(found) => found,
            Err(GpuError::Incomplete) if gpu.is_software() => {
                eprintln!("{name}, {}: {}", gpu.name(), GpuError::Incomplete);
                return false;
            }
            Err(error) => panic!("{name}: {error}"),
        };
        let difference = compare_hits(&rays, &expected, &found, radius(scene), first_only);
        eprintln!("{name}, {}: first only {first_only}, {difference:?}", gpu.name());
        assert!(difference.hits > 0, "{name}: no ray hits");
        assert!(difference.agreement() >= LEAST_AGREEMENT, "{name}: {difference:?}");
    }
    true
}

fn assert_pictures_agree(name: &str, gpu: &Gpu, scene: &Scene<'_>, camera: &Camera, options: &RenderOptions) {
    let expected = cpu::render(scene, camera, options, &|_, _| {});
    let found = gpu.render(&gpu.upload(scene).unwrap(), camera, options, &|_, _| {}).unwrap();
    let difference = compare_pictures(&expected, &found, radius(scene));
    eprintln!("{name}, {}: {difference:?}", gpu.name());
    assert!(difference.covered > difference.pixels / 50, "{name}: {difference:?}");
    // Borders of faces are near ties; an occlusion ray that flips moves a pixel's colour visibly.
    assert!(difference.color <= difference.covered / 100 + 2, "{name}: {difference:?}");
    assert!(difference.center <= difference.covered / 200 + 2, "{name}: {difference:?}");
}

#[test]
fn hits_agree() {
    let Some(gpu) = gpu() else { return };
    let buffers = synthetic::every_kind();
    assert!(assert_hits_agree("every kind", &gpu, &buffers.scene(), 6_000));
}

/// `hits_agree` compares the exact mode, which is the default.
#[test]
fn hits_agree_with_less_exactness() {
    let Some(gpu) = gpu() else { return };
    let buffers = synthetic::every_kind();
    let scene = buffers.scene();
    let rays = chords(&scene, 6_000);
    let on_gpu = gpu.upload(&scene).unwrap();
    for exactness in [Exactness::Fast, Exactness::Balanced] {
        let expected = cpu::probe_with(&scene, &rays, Precision::F32, false, exactness);
        let found = gpu.probe_with(&on_gpu, &rays, false, exactness).unwrap();
        let difference = compare_hits(&rays, &expected, &found, radius(&scene), false);
        eprintln!("{exactness:?}, {}: {difference:?}", gpu.name());
        assert!(difference.hits > 0, "{exactness:?}: no ray hits");
        assert!(difference.agreement() >= LEAST_AGREEMENT, "{exactness:?}: {difference:?}");
    }
}

#[test]
fn pictures_agree() {
    let Some(gpu) = gpu() else { return };
    let buffers = synthetic::every_kind();
    let scene = buffers.scene();
    assert_pictures_agree("perspective", &gpu, &scene, &camera(&scene, false), &options(true));
    assert_pictures_agree("orthographic", &gpu, &scene, &camera(&scene, true), &options(false));
}

/// All fixtures, as the importer and the bake make them.
#[test]
fn fixtures_agree() {
    let Some(gpu) = gpu() else { return };
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .map(|entries| entries.flatten().map(|entry| entry.path().join("model.step")).collect())
        .unwrap_or_default();
    files.retain(|file| file.exists());
    files.sort();
    // For a quick look: `FIXTURE=mug`.
    if let Ok(name) = std::env::var("FIXTURE") {
        files.retain(|file| file.to_string_lossy().contains(&name));
    }
    let mut compared = 0;
    for file in &files {
        let name = file.parent().and_then(Path::file_name).unwrap_or_default().to_string_lossy().into_owned();
        let model = trimray::import::import(file).unwrap();
        let buffers = trimray::bake::bake(&model, &BakeOptions::default(), &|_, _| {});
        compared += usize::from(assert_hits_agree(&name, &gpu, &buffers.scene(), FIXTURE_RAYS));
    }
    eprintln!("{compared} of {} fixtures compared", files.len());
    assert_eq!(compared, files.len(), "fixtures compared");
}

/// Rays aimed at edges meet an even number of walls of closed solids on the GPU too.
#[test]
fn closed_fixtures_do_not_leak() {
    let Some(gpu) = gpu() else { return };
    let mut rays = 0;
    for name in ["bracket", "flask", "knob", "chain"] {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name).join("model.step");
        let model = trimray::import::import(&file).unwrap();
        let buffers = trimray::bake::bake(&model, &BakeOptions::default(), &|_, _| {});
        let scene = buffers.scene();
        let points = edge_points(&model);
        let aimed: Vec<Ray> = (0..FIXTURE_RAYS).map(|index| aimed(&scene, &points, index)).collect();
        let found = gpu.probe_alone(&gpu.upload(&scene).unwrap(), &aimed).unwrap();
        let odd: Vec<&Ray> =
            aimed.iter().zip(&found).filter(|(_, hits)| hits.len() % 2 == 1).map(|x| x.0).collect();
        assert!(odd.is_empty(), "{name}: {odd:?}");
        assert!(found.iter().any(|hits| !hits.is_empty()), "{name}: no ray hits");
        rays += aimed.len();
    }
    eprintln!("{rays} rays aimed at edges, {}", gpu.name());
}

/// Rays through the poles of a net, which take longest, and rays beside them in the same workgroup, which must not lose hits by that.
#[test]
fn poles_agree() {
    let Some(gpu) = gpu() else { return };
    let buffers = synthetic::ellipsoid();
    let scene = buffers.scene();
    let mut rays = chords(&scene, 600);
    for (index, ray) in rays.iter_mut().enumerate().filter(|(index, _)| index % 3 == 0) {
        let pole = DVec3::Z * if index % 2 == 0 { 2.0 } else { -2.0 };
        let beside = DVec3::X * if index % 4 == 0 { 0.0 } else { 1e-3 };
        ray.origin = pole + beside - ray.direction * 20.0;
    }
    let on_gpu = gpu.upload(&scene).unwrap();
    let expected = cpu::probe_alone(&scene, &rays, Precision::F32, Exactness::default());
    let found = gpu.probe_alone(&on_gpu, &rays).unwrap();
    for ((ray, on_cpu), on_gpu) in rays.iter().zip(&expected).zip(&found) {
        let is_through_pole = ray.origin.length() > 18.0;
        assert!(!is_through_pole || on_gpu.len() == 2, "{ray:?}: {on_gpu:?}");
        assert!(on_gpu.len() % 2 == 0 && on_cpu.len() % 2 == 0, "{ray:?}: {on_cpu:?} {on_gpu:?}");
    }
    let difference = compare_hits(&rays, &expected, &found, radius(&scene), false);
    eprintln!("poles, {}: {difference:?}", gpu.name());
    assert!(difference.agreement() >= LEAST_AGREEMENT, "{difference:?}");
}

/// Changes on the GPU's side alone, each of which the comparison has to notice.
#[test]
fn canaries_are_noticed() {
    let Some(gpu) = gpu() else { return };
    let buffers = synthetic::every_kind();
    type Change = fn(&mut SceneBuffers);
    let wrong: [(&str, Change); 4] = [
        ("a kernel without nets", |scene| scene.header.feature_mask &= !(1 << FaceKind::Nets as u32)),
        ("a cylinder too wide by a hundredth", |scene| scene.faces[1].radius_0 *= 1.01),
        ("trims moved by a tenth", |scene| {
            for segment in &mut scene.trim_segments {
                segment.low[0] += 0.1;
                segment.high[0] += 0.1;
            }
        }),
        ("a net point moved by a hundredth", |scene| scene.net_points[5][2] += 0.01),
    ];
    let rays = chords(&buffers.scene(), 6_000);
    let expected = cpu::probe_alone(&buffers.scene(), &rays, Precision::F32, Exactness::default());
    for (name, change) in wrong {
        let mut changed = synthetic::every_kind();
        change(&mut changed);
        let scene = changed.scene();
        let found = gpu.probe_alone(&gpu.upload(&scene).unwrap(), &rays).unwrap();
        let difference = compare_hits(&rays, &expected, &found, radius(&scene), false);
        eprintln!("{name}: {difference:?}");
        assert!(difference.agreement() < LEAST_AGREEMENT, "{name} is not noticed: {difference:?}");
    }
}

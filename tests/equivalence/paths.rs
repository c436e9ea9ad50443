//! Path-traced pictures are the same on both devices, but for paths that go another way after a near tie.

use super::{camera, gpu, options, synthetic};
use glam::DVec3;
use trimray::image::{Film, Window};
use trimray::render::gpu::Gpu;
use trimray::render::section::{Section, SectionPlane};
use trimray::render::{Camera, Environment, Ground, PathOptions, RenderOptions, cpu, lowest};
use trimray::scene::Scene;

fn paths(scene: &Scene<'_>) -> PathOptions {
    let height = lowest(scene, &Section::default(), DVec3::Z);
    PathOptions {
        samples: 16,
        max_depth: 4,
        seed: 7,
        noise: None,
        ground: Some(Ground { up: DVec3::Z, height }),
        environment: Environment::studio(),
        axes: None,
        shows_surroundings: false,
    }
}

fn assert_paths_agree(
    name: &str,
    gpu: &Gpu,
    scene: &Scene<'_>,
    camera: &Camera,
    options: &RenderOptions,
    paths: &PathOptions,
) -> Film {
    let expected = cpu::render_paths(scene, camera, options, paths, &|_, _| {});
    let found = gpu.render_paths(&gpu.upload(scene).unwrap(), camera, options, paths, &|_, _| {}).unwrap();
    let mut other = 0;
    let (mut of_cpu, mut of_gpu) = (0.0, 0.0);
    for (a, b) in expected.color.iter().zip(&found.color) {
        let apart = (0..4).map(|k| (a[k] - b[k]).abs()).fold(0.0, f32::max);
        other += usize::from(apart.is_nan() || apart > 2.0 / 255.0);
        of_cpu += a.iter().map(|&c| f64::from(c)).sum::<f64>();
        of_gpu += b.iter().map(|&c| f64::from(c)).sum::<f64>();
    }
    // Roundings differ, or the GPU has left all to the CPU.
    let same = expected.color.iter().zip(&found.color).filter(|(a, b)| a == b && a[3] > 0.0).count();
    let covered = expected.color.iter().filter(|color| color[3] > 0.0).count();
    eprintln!(
        "{name}, {}: {other} of {covered} pixels differ, {same} do to no bit, mean {of_cpu} {of_gpu}",
        gpu.name()
    );
    assert!(same < covered / 2, "{name}: {same} of {covered} are the same to the bit");
    assert!(covered > expected.color.len() / 20, "{name}: {covered}");
    // Where one of a pixel's sixteen paths goes another way, the pixel differs.
    assert!(other <= covered / 12, "{name}: {other} of {covered}");
    assert!((of_cpu / of_gpu - 1.0).abs() < 2e-3, "{name}: {of_cpu} {of_gpu}");
    found
}

#[test]
fn paths_agree() {
    let Some(gpu) = gpu() else { return };
    let buffers = synthetic::every_kind();
    let scene = buffers.scene();
    let options = RenderOptions { resolution: [96, 66], ..options(false) };
    let paths = paths(&scene);
    let camera = camera(&scene, false);
    let whole = assert_paths_agree("on a ground", &gpu, &scene, &camera, &options, &paths);
    let window = Window { left: 30, top: 20, width: 41, height: 33 };
    let part = RenderOptions { window: Some(window), ..options };
    let part = gpu.render_paths(&gpu.upload(&scene).unwrap(), &camera, &part, &paths, &|_, _| {}).unwrap();
    let mut pasted = whole.clone();
    pasted.paste(&part, window.left, window.top);
    assert!(pasted == whole, "a part is what the whole shows there");
}

#[test]
fn paths_agree_in_a_map_and_a_section() {
    let Some(gpu) = gpu() else { return };
    let buffers = synthetic::every_kind();
    let scene = buffers.scene();
    let light: Vec<[f32; 3]> =
        (0..32 * 16)
            .map(|texel| {
                if texel == 32 * 4 + 20 { [60.0, 50.0, 40.0] } else { [0.2, 0.3, (texel % 32) as f32 / 32.0] }
            })
            .collect();
    let plane =
        SectionPlane { normal: DVec3::new(0.6, 0.0, 0.8), offset: scene.header.world_anchor[2] + 1.0 };
    let section = Section::new(&[plane], true).unwrap();
    let paths = PathOptions {
        environment: Environment::from_map([32, 16], &light).unwrap(),
        axes: Some([DVec3::Y, DVec3::Z, DVec3::X]),
        shows_surroundings: true,
        noise: Some(0.02),
        samples: 32,
        ..paths(&scene)
    };
    let options = RenderOptions { resolution: [96, 66], section, ..options(false) };
    assert_paths_agree("in a map", &gpu, &scene, &camera(&scene, true), &options, &paths);
}

//! Path-traced pictures are the same on both devices, but for paths that go another way after a near tie.

use super::{camera, gpu, options, synthetic};
use glam::DVec3;
use trimray::image::{Film, Window};
use trimray::render::gpu::Gpu;
use trimray::render::section::{Section, SectionMode, SectionPlane};
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

/// Pixels of which any channel differs by more than two of 255 steps, and the sums of all channels.
fn apart(a: &Film, b: &Film) -> (usize, [f64; 2]) {
    let differ = |(a, b): &(&[f32; 4], &[f32; 4])| {
        let apart = (0..4).map(|k| (a[k] - b[k]).abs()).fold(0.0, f32::max);
        apart.is_nan() || apart > 2.0 / 255.0
    };
    let sum = |film: &Film| film.color.iter().flatten().map(|&c| f64::from(c)).sum::<f64>();
    (a.color.iter().zip(&b.color).filter(differ).count(), [sum(a), sum(b)])
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
    let (other, means) = apart(&expected, &found);
    let covered = expected.color.iter().filter(|color| color[3] > 0.0).count();
    eprintln!("{name}, {}: {other} of {covered} pixels differ, mean {means:?}", gpu.name());
    assert!(covered > expected.color.len() / 20, "{name}: {covered}");
    // Where one of a pixel's paths goes another way, the pixel differs.
    assert!(other <= covered / 50, "{name}: {other} of {covered}");
    assert!((means[0] / means[1] - 1.0).abs() < 1e-3, "{name}: {means:?}");
    // Other noise is noticed.
    let reseeded = PathOptions { seed: paths.seed + 1, ..paths.clone() };
    let (other, _) = apart(&cpu::render_paths(scene, camera, options, &reseeded, &|_, _| {}), &found);
    assert!(other > covered / 50, "{name}: {other} of {covered}");
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
    let section = Section::new(&[plane], SectionMode::Each, true).unwrap();
    let paths = PathOptions {
        environment: Environment::from_map([32, 16], &light).unwrap(),
        axes: Some([DVec3::Y, DVec3::Z, DVec3::X]),
        shows_surroundings: true,
        noise: Some(0.02),
        samples: 32,
        ..paths(&scene)
    };
    let options = RenderOptions { resolution: [96, 66], section, ..options(false) };
    assert_paths_agree("in a map", &gpu, &scene, &camera(&scene, false), &options, &paths);
}

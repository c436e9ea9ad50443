//! The layers of a film, and parts of a picture, are the same on both devices.

use super::{camera, gpu, options, radius, synthetic};
use trimray::image::{Film, Layers, Window};
use trimray::render::{RenderOptions, cpu};

/// Pixels of which any layer differs.
fn different(a: &Film, b: &Film, size: f64) -> usize {
    let near =
        |a: &[f32], b: &[f32], most: f64| a.iter().zip(b).all(|(a, b)| f64::from((a - b).abs()) <= most);
    let is_same = |pixel: usize| {
        let shares = |film: &Film| film.matte[pixel].map(|share| share.part);
        near(&a.position[pixel], &b.position[pixel], 1e-3 * size)
            && near(&a.uv[pixel], &b.uv[pixel], 1e-2 * size)
            && near(&a.curvature[pixel], &b.curvature[pixel], 1e-2)
            && near(&a.albedo[pixel], &b.albedo[pixel], 1e-3)
            && shares(a) == shares(b)
            && a.face[pixel] == b.face[pixel]
    };
    (0..a.color.len()).filter(|&pixel| !is_same(pixel)).count()
}

#[test]
fn layers_agree_in_the_whole_and_in_a_window() {
    let Some(gpu) = gpu() else { return };
    let buffers = synthetic::every_kind();
    let scene = buffers.scene();
    let uploaded = gpu.upload(&scene).unwrap();
    for orthographic in [false, true] {
        let camera = camera(&scene, orthographic);
        let whole = RenderOptions { layers: Layers::ALL, ..options(false) };
        let expected = cpu::render(&scene, &camera, &whole, &|_, _| {});
        let found = gpu.render(&uploaded, &camera, &whole, &|_, _| {}).unwrap();
        let hits = expected.face.iter().filter(|&&face| face != 0).count();
        let apart = different(&expected, &found, radius(&scene));
        eprintln!("{}: {apart} of {hits} pixels differ", gpu.name());
        assert!(hits > 300 && apart <= hits / 100 + 2, "{apart} of {hits}");
        let window = Window { left: 41, top: 23, width: 67, height: 50 };
        let part = RenderOptions { window: Some(window), ..whole };
        let mut pasted = found.clone();
        let part = gpu.render(&uploaded, &camera, &part, &|_, _| {}).unwrap();
        assert_eq!((part.width, part.height, part.corner), (67, 50, [41, 23]));
        pasted.paste(&part, window.left, window.top);
        assert!(pasted == found, "a part is what the whole shows there");
    }
}

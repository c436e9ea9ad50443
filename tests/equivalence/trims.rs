//! Trim queries alone: the kernels of every method answer as the CPU does.

use super::gpu;
use std::path::Path;
use trimray::bake::{BakeOptions, bake_with_regions, retrim};
use trimray::render::cpu::trim_inside;
use trimray::render::gpu::TrimQuery;
use trimray::scene::{Scene, TRIM_INSIDE, TrimMethod};

/// Answers may differ this close to a curve.
const BAND: f32 = 2e-6;

/// A linear congruential generator; numbers in 0..1.
fn next(state: &mut u64) -> f32 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 40) as f32 / (1 << 24) as f32
}

/// Random points of all trimmed faces, every second one drawn to where the answer changes.
fn queries(scene: &Scene<'_>, per_face: usize) -> Vec<TrimQuery> {
    let mut state = 11;
    let mut queries = Vec::new();
    for root in scene.faces.iter().map(|face| face.trim_root).filter(|&root| root != TRIM_INSIDE) {
        let mut before = [0.5; 2];
        for i in 0..per_face {
            let mut uv = [next(&mut state), next(&mut state)];
            if i % 2 == 1 {
                let is_inside = trim_inside(scene, root, uv);
                for _ in 0..14 {
                    let middle = [0, 1].map(|k| 0.5 * (uv[k] + before[k]));
                    if trim_inside(scene, root, middle) == is_inside { uv = middle } else { before = middle }
                }
            }
            before = uv;
            queries.push(TrimQuery { uv, root, reserved: 0 });
        }
    }
    queries
}

/// Whether an answer changes within the band around the point.
fn is_near_a_border(scene: &Scene<'_>, query: &TrimQuery) -> bool {
    let answer = trim_inside(scene, query.root, query.uv);
    (0..64).any(|i| {
        let angle = i as f32 * std::f32::consts::TAU / 16.0;
        let radius = BAND * (1 + i / 16) as f32 * 0.25;
        let beside = [query.uv[0] + radius * angle.cos(), query.uv[1] + radius * angle.sin()];
        trim_inside(scene, query.root, beside.map(|x| x.clamp(0.0, 1.0))) != answer
    })
}

#[test]
fn trims_agree() {
    let Some(gpu) = gpu() else { return };
    for name in ["mug", "flange"] {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name).join("model.step");
        let model = trimray::import::import(&file).unwrap();
        let (mut buffers, regions) = bake_with_regions(&model, &BakeOptions::default(), &|_, _| {});
        for method in TrimMethod::all() {
            retrim(&mut buffers, &regions, method).unwrap();
            let scene = buffers.scene();
            let queries = queries(&scene, 200);
            let found = gpu.trim_inside(&gpu.upload(&scene).unwrap(), &queries).unwrap();
            let mut inside = 0;
            let mut near = 0;
            for (query, &on_gpu) in queries.iter().zip(&found) {
                let on_cpu = trim_inside(&scene, query.root, query.uv);
                inside += usize::from(on_cpu);
                if on_cpu != on_gpu {
                    near += 1;
                    assert!(is_near_a_border(&scene, query), "{name}, {}: {query:?}", method.label());
                }
            }
            eprintln!("{name}, {}: {} queries, {near} differ at borders", method.label(), queries.len());
            assert!(inside > queries.len() / 10 && inside < queries.len(), "{name}: {inside} inside");
        }
    }
}

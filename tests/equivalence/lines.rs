//! Lines are the same on both devices.

use crate::{camera, gpu, options};
use std::path::Path;
use trimray::bake::BakeOptions;
use trimray::render::cpu::{self, Precision};
use trimray::render::gpu::GpuError;
use trimray::render::lines::{EdgeChoice, HiddenLines, LineOptions, line_coverage};
use trimray::render::section::Section;

#[test]
fn lines_agree() {
    let Some(gpu) = gpu() else { return };
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/bracket/model.step");
    let model = trimray::import::import(&file).unwrap();
    let bake = BakeOptions { edges: true, ..BakeOptions::default() };
    let buffers = trimray::bake::bake(&model, &bake, &|_, _| {});
    let scene = buffers.scene();
    let (camera, options) = (camera(&scene, false), options(false));
    let lines = LineOptions { edges: EdgeChoice::All, contours: true, hidden: HiddenLines::Dim, width: 1.5 };
    let film = cpu::render(&scene, &camera, &options, &|_, _| {});
    let on_cpu = line_coverage(&scene, &camera, &lines, &Section::default(), &film, &mut |rays| {
        Ok::<_, GpuError>(cpu::probe(&scene, rays, Precision::F32, true))
    });
    let on_gpu = gpu.upload(&scene).unwrap();
    let film = gpu.render(&on_gpu, &camera, &options, &|_, _| {}).unwrap();
    let found = line_coverage(&scene, &camera, &lines, &Section::default(), &film, &mut |rays| {
        gpu.probe(&on_gpu, rays, true)
    })
    .unwrap();
    let on_cpu = on_cpu.unwrap();
    let apart = |a: f32, b: f32| (a - b).abs() > 0.1;
    let differing = on_cpu.iter().zip(&found).filter(|&(&a, &b)| apart(a, b)).count();
    let drawn = on_cpu.iter().filter(|&&a| a > 0.5).count();
    eprintln!("{}: {differing} of {drawn} pixels of lines differ", gpu.name());
    assert!(drawn > 300 && differing <= drawn / 100, "{differing} of {drawn}");
}

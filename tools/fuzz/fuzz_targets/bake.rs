//! A STEP or IGES file to a model, a scene, and hits of a few rays.

#![no_main]

use libfuzzer_sys::{fuzz_mutator, fuzz_target};
use trimray::bake::{BakeOptions, bake};

fuzz_target!(|bytes: &[u8]| {
    let model = match trimray::step::read(bytes) {
        Ok(model) => model,
        Err(_) => match trimray::iges::read(bytes) {
            Ok(model) => model,
            Err(_) => return,
        },
    };
    let baked = bake(&model, &BakeOptions { keep_f64: true, ..BakeOptions::default() }, &|_, _| {});
    let scene = baked.scene();
    trimray::scene::validate(&scene).expect("a baked scene is valid");
    trimray_fuzz::trace(&scene);
});

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    trimray_fuzz::mutate_text(data, size, max_size, seed)
});

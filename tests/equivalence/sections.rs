//! Sections are the same on both devices.

use crate::{assert_pictures_agree, camera, gpu, options};
use glam::DVec3;
use std::path::Path;
use trimray::bake::BakeOptions;
use trimray::render::RenderOptions;
use trimray::render::section::{Section, SectionMode, SectionPlane};
use trimray::scene::{Instance, Scene};

#[test]
fn sections_agree() {
    let Some(gpu) = gpu() else { return };
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/bearing/model.step");
    let model = trimray::import::import(&file).unwrap();
    let buffers = trimray::bake::bake(&model, &BakeOptions::default(), &|_, _| {});
    let planes = [(DVec3::new(0.6, 0.0, 0.8), 1.0), (DVec3::NEG_Y, 20.0)]
        .map(|(normal, offset)| SectionPlane { normal, offset });
    // The third instance stays whole.
    let mut instances = buffers.instances.clone();
    instances[2].flags |= Instance::UNCUT;
    let scene = Scene { instances: &instances, ..buffers.scene() };
    for (mode, caps, ambient_occlusion) in [
        (SectionMode::Each, true, true),
        (SectionMode::Each, false, false),
        (SectionMode::Corner, true, true),
        (SectionMode::Corner, false, false),
    ] {
        let section = Section::new(&planes, mode, caps).unwrap();
        let options = RenderOptions { section, ..options(ambient_occlusion) };
        assert_pictures_agree("section", &gpu, &scene, &camera(&scene, !caps), &options);
    }
}

//! Adaptive pictures are those of all samples everywhere, but for the grain that these have.

use super::render;
use super::test_scenes::{TestFace, scene_of};
use crate::image::{Film, Picture, compare};
use crate::render::{Background, Camera, RenderOptions, Sampling};
use crate::scene::{FaceKind, Scene};
use glam::{DAffine3, DMat3, DVec3};

fn picture(scene: &Scene<'_>, camera: &Camera, options: &RenderOptions, sampling: Sampling) -> Film {
    render(scene, camera, &RenderOptions { sampling, ..*options }, &|_, _| {})
}

/// Looks along −z at the square from −1 to 1.
fn from_above() -> Camera {
    let [right, up, forward] = [DVec3::X, DVec3::Y, DVec3::NEG_Z];
    Camera { position: DVec3::Z * 10.0, forward, right, up, half_height: 1.0, orthographic: true }
}

#[test]
fn a_fixture_looks_the_same() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/bearing/model.step");
    let model = crate::import::import(&path).expect("a fixture");
    let buffers = crate::bake::bake(&model, &crate::bake::BakeOptions::default(), &|_, _| {});
    let scene = buffers.scene();
    let camera = Camera {
        position: DVec3::new(70.0, -80.0, 60.0),
        forward: DVec3::new(-0.575, 0.656, -0.49).normalize(),
        right: DVec3::new(0.752, 0.659, 0.0).normalize(),
        up: DVec3::new(0.575, -0.656, -0.49).cross(DVec3::new(0.752, 0.659, 0.0)).normalize() * -1.0,
        half_height: 0.2,
        orthographic: false,
    };
    // The sky of 16 rays a pixel has grain, that of neighbours together is smooth instead.
    for (ambient_occlusion, threshold, outliers, mean) in [(false, 2, 0.001, 0.05), (true, 16, 0.015, 1.2)] {
        let options = RenderOptions { resolution: [200, 150], ambient_occlusion, ..RenderOptions::default() };
        let [adaptive, uniform] = [Sampling::Adaptive, Sampling::Uniform]
            .map(|sampling| Picture::from(&picture(&scene, &camera, &options, sampling)));
        let difference = compare(&adaptive, &uniform, threshold).expect("one size");
        eprintln!("ambient occlusion {ambient_occlusion}: {difference:?}");
        assert!(difference.outliers < outliers && difference.mean < mean, "{difference:?}");
        let covered = uniform.pixels.iter().filter(|pixel| **pixel != [255; 4]).count();
        assert!(covered > uniform.pixels.len() / 10, "{covered}");
    }
}

/// Strips a tenth of a pixel wide, aslant: few centres see them.
#[test]
fn what_is_thinner_than_a_pixel_is_followed() {
    let (length, width) = (1.8, 2.0 / 64.0 / 10.0);
    let options = RenderOptions {
        resolution: [64, 64],
        background: Background::Transparent,
        ambient_occlusion: false,
        ..RenderOptions::default()
    };
    let covered = |film: &Film| film.color.iter().map(|color| f64::from(color[3])).sum::<f64>();
    let mut sums = [0.0; 2];
    let angles = [0.2, 0.3, 0.5, 0.7, 1.0, 1.2, 1.4];
    for angle in angles {
        let strip = TestFace::analytic(
            FaceKind::Plane,
            [0.0; 2],
            [-length / 2.0, -width / 2.0],
            [length / 2.0, width / 2.0],
        )
        .placed(DVec3::ZERO, DMat3::from_rotation_z(angle));
        let buffers = scene_of(&[strip], &[DAffine3::IDENTITY]);
        for (sum, sampling) in sums.iter_mut().zip([Sampling::Adaptive, Sampling::Uniform]) {
            *sum += covered(&picture(&buffers.scene(), &from_above(), &options, sampling));
        }
    }
    let [adaptive, uniform] = sums.map(|sum| sum / angles.len() as f64);
    let truth = length * width * (64.0 / 2.0) * (64.0 / 2.0);
    eprintln!("covered pixels: {adaptive} adaptive, {uniform} uniform, {truth} in truth");
    assert!((uniform / truth - 1.0).abs() < 0.1, "{uniform} {truth}");
    assert!((adaptive / uniform - 1.0).abs() < 0.2, "{adaptive} {uniform}");
}

/// One sample is the centre's, also behind what is seen through.
#[test]
fn one_sample_is_the_centre() {
    let face = TestFace::analytic(FaceKind::Sphere, [0.8, 0.0], [0.0, -1.5], [6.2, 1.5]);
    let buffers = scene_of(&[face], &[DAffine3::IDENTITY]);
    let options = RenderOptions {
        resolution: [40, 40],
        samples: 1,
        ambient_occlusion: false,
        ..RenderOptions::default()
    };
    let [adaptive, uniform] = [Sampling::Adaptive, Sampling::Uniform]
        .map(|sampling| picture(&buffers.scene(), &from_above(), &options, sampling));
    assert_eq!(adaptive, uniform);
    assert!(adaptive.face.iter().filter(|&&face| face != 0).count() > 200);
}

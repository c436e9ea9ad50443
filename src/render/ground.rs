//! Where the ground is: below what is seen of the model.

use super::cpu::{Precision, probe};
use super::framing::bounds;
use super::section::Section;
use super::sectioned::first_in_section;
use super::{Hit, Ray};
use crate::scene::Scene;
use glam::DVec3;

/// Rays along each side of a look from below.
const RAYS: i32 = 200;
/// How often the lowest place is looked at again more closely, and how much more closely.
const CLOSER: [f64; 2] = [1.0, 8.0 / RAYS as f64];

/// The least `up · p` of the scene's surfaces, millimetres, as far as they are in the section; `up` is a unit vector. That of the box around the scene where
/// nothing is seen from below.
///
/// Boxes around free-form faces are wider than these, so rays look for the lowest place, then around it.
pub fn lowest(scene: &Scene<'_>, section: &Section, up: DVec3) -> f64 {
    let bounds = bounds(scene);
    let radius = bounds.diagonal() / 2.0;
    let of_box = bounds.corners().iter().map(|corner| corner.dot(up)).fold(f64::INFINITY, f64::min);
    let (x, y) = up.any_orthonormal_pair();
    let mut center = bounds.center();
    let mut found = f64::INFINITY;
    for reach in CLOSER.map(|share| share * radius) {
        let ray = |index: i32| {
            let at = |i: i32| (f64::from(2 * i + 1) / f64::from(RAYS) - 1.0) * reach;
            let across = x * at(index % RAYS) + y * at(index / RAYS);
            let start = center + across;
            Ray { origin: start + up * (of_box - radius - start.dot(up)), direction: up }
        };
        let rays: Vec<Ray> = (0..RAYS * RAYS).map(ray).collect();
        let hits = probe(scene, &rays, Precision::F32, section.is_empty());
        let point = |(ray, hits): (&Ray, &Vec<Hit>)| {
            first_in_section(scene, section, ray, hits).map(|hit| ray.at(hit.t))
        };
        let points = rays.iter().zip(&hits).filter_map(point);
        let Some(low) = points.min_by(|a, b| a.dot(up).total_cmp(&b.dot(up))) else { break };
        found = found.min(low.dot(up));
        center = low;
    }
    if found.is_finite() { found } else { of_box }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::cpu::test_scenes::{TestFace, scene_of};
    use crate::scene::FaceKind;
    use glam::DAffine3;
    use std::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn the_ground_touches_a_sphere() {
        let sphere = TestFace::analytic(FaceKind::Sphere, [2.0, 0.0], [-PI, -FRAC_PI_2], [PI, FRAC_PI_2]);
        let place = DVec3::new(1.0, 2.0, 3.0);
        let buffers = scene_of(&[sphere], &[DAffine3::from_translation(place)]);
        for up in [DVec3::Z, -DVec3::Y, DVec3::new(1.0, 2.0, -0.5).normalize()] {
            let found = lowest(&buffers.scene(), &Section::default(), up);
            assert!((found - (place.dot(up) - 2.0)).abs() < 1e-5, "{up}: {found}");
        }
    }
}

//! Framing by sight: the camera that shows what is really there, not the box around it.
//!
//! A disc fills its box's middle, not its corners, and a picture framed by the corners shows it small and off the centre. So the scene is looked
//! at twice: coarsely by the camera of the box, then by a camera around the points that were seen.

use super::cpu::{Precision, first_distances, probe};
use super::section::Section;
use super::sectioned::first_in_section;
use super::{Camera, Ray, Viewpoint};
use crate::numeric::Aabb;
use crate::scene::Scene;
use glam::DVec3;
use rayon::prelude::*;

/// Rays along the longer side of the coarse look: a miss of half their spacing stays within the picture's margin.
const COARSE: f64 = 240.0;

impl Camera {
    /// The camera for pictures of the scene that are `aspect` times as wide as high. Where the viewpoint says itself where to look or to stand,
    /// it is taken at its word and the scene's box decides the rest.
    pub fn framing(view: &Viewpoint, scene: &Scene<'_>, aspect: f64) -> Self {
        Self::framing_section(view, scene, &Section::default(), aspect)
    }

    /// [`Self::framing`] for pictures of a section.
    pub fn framing_section(view: &Viewpoint, scene: &Scene<'_>, section: &Section, aspect: f64) -> Self {
        if view.position.is_some() || view.focal_point.is_some() {
            return Self::new(view, &bounds(scene).corners(), aspect);
        }
        Self::framing_the_seen(view, scene, section, aspect)
    }

    /// The cameras of a turntable: `count` of them at even steps of a whole turn about the viewpoint's up axis, the first one at the viewpoint.
    ///
    /// The axis passes through the focal point, or the middle of the scene's box, and all cameras are as far from it as the one that has to be
    /// farthest to show everything: a distance for each would make the model pulse.
    pub fn turntable(
        view: &Viewpoint,
        scene: &Scene<'_>,
        section: &Section,
        aspect: f64,
        count: u32,
    ) -> Vec<Self> {
        let focal_point = view.focal_point.unwrap_or_else(|| bounds(scene).center());
        let mut cameras: Vec<Self> = (0..count)
            .map(|index| {
                let azimuth = view.azimuth + std::f64::consts::TAU * f64::from(index) / f64::from(count);
                let view = Viewpoint { focal_point: Some(focal_point), azimuth, ..*view };
                if view.position.is_some() {
                    Self::new(&view, &bounds(scene).corners(), aspect)
                } else {
                    Self::framing_the_seen(&view, scene, section, aspect)
                }
            })
            .collect();
        let half_height = cameras.iter().map(|camera| camera.half_height).fold(0.0, f64::max);
        let distance = |camera: &Self| (focal_point - camera.position).dot(camera.forward);
        let farthest = cameras.iter().map(distance).fold(f64::NEG_INFINITY, f64::max);
        for camera in &mut cameras {
            camera.half_height = half_height;
            if view.position.is_none() {
                camera.position = focal_point - camera.forward * farthest;
            }
        }
        cameras
    }

    /// The camera around the points that a coarse look sees.
    fn framing_the_seen(view: &Viewpoint, scene: &Scene<'_>, section: &Section, aspect: f64) -> Self {
        let by_box = Self::new(view, &bounds(scene).corners(), aspect);
        let seen = visible_points(scene, section, &by_box, aspect);
        if seen.is_empty() { by_box } else { Self::new(view, &seen, aspect) }
    }
}

/// The box around the whole scene in model space.
pub fn bounds(scene: &Scene<'_>) -> Aabb {
    let anchor = DVec3::from_array(scene.header.world_anchor);
    let half = DVec3::from_array(scene.header.half_size.map(f64::from));
    Aabb { min: anchor - half, max: anchor + half }
}

/// Where a coarse grid of the camera's rays first meets the scene.
fn visible_points(scene: &Scene<'_>, section: &Section, camera: &Camera, aspect: f64) -> Vec<DVec3> {
    let width = (COARSE * aspect.min(1.0)).ceil().max(1.0);
    let height = (COARSE / aspect.max(1.0)).ceil().max(1.0);
    let at = |i: usize, count: f64| (2 * i + 1) as f64 / count - 1.0;
    let rays: Vec<Ray> = (0..width as usize * height as usize)
        .into_par_iter()
        .map(|i| camera.ray(at(i % width as usize, width), at(i / width as usize, height), aspect))
        .collect();
    if section.is_empty() {
        let seen = rays.par_iter().zip(first_distances(scene, &rays));
        return seen.filter(|(_, t)| t.is_finite()).map(|(ray, t)| ray.at(t)).collect();
    }
    let hits = probe(scene, &rays, Precision::F32, false);
    let point = |(ray, hits): (&Ray, &Vec<super::Hit>)| {
        let hit = first_in_section(scene, section, ray, hits);
        hit.map(|hit| ray.at(hit.t))
    };
    rays.iter().zip(&hits).filter_map(point).collect()
}

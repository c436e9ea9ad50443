//! The picture plane: points of the model to pixels, and back to rays.

use crate::image::{Film, Window};
use crate::render::cpu::pixel_ray;
use crate::render::{Camera, Ray};
use glam::{DVec2, DVec3};

/// A camera and a picture, and the part of it that is drawn. Places are those of the whole picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Screen<'a> {
    camera: &'a Camera,
    size: [usize; 2],
    window: Window,
}

impl<'a> Screen<'a> {
    /// The picture that a film shows all or part of.
    pub(super) fn of_film(camera: &'a Camera, film: &Film) -> Self {
        Self { camera, size: film.whole, window: film.window() }
    }

    pub(super) fn camera(&self) -> &Camera {
        self.camera
    }

    /// The part that is drawn.
    pub(super) fn window(&self) -> Window {
        self.window
    }

    /// Pixels across and down of the whole.
    pub(super) fn size(&self) -> [usize; 2] {
        self.size
    }

    /// Where a point of model space is in the picture, in pixels from the left and the top; `None` where it is not before the eye.
    pub(super) fn project(&self, point: DVec3) -> Option<DVec2> {
        let camera = self.camera;
        let offset = point - camera.position;
        let depth = offset.dot(camera.forward);
        if !(depth > 0.0) {
            return None;
        }
        let [width, height] = self.size.map(|pixels| pixels as f64);
        let scale = if camera.orthographic { 1.0 } else { depth } * camera.half_height;
        let x = offset.dot(camera.right) / scale * height / width;
        let y = offset.dot(camera.up) / scale;
        Some(DVec2::new((x + 1.0) * 0.5 * width, (1.0 - y) * 0.5 * height))
    }

    /// The ray through a place of the picture.
    pub(super) fn ray(&self, at: DVec2) -> Ray {
        pixel_ray(self.camera, self.size.map(|pixels| pixels as u32), at.x, at.y)
    }

    /// The ray towards a point that projects to `at`, and how far along it the point lies.
    pub(super) fn ray_to(&self, point: DVec3, at: DVec2) -> (Ray, f64) {
        let ray = if self.camera.orthographic {
            self.ray(at)
        } else {
            let origin = self.camera.position;
            Ray { origin, direction: (point - origin).normalize() }
        };
        (ray, (point - ray.origin).dot(ray.direction))
    }

    /// The view direction's share of a ray: depth = distance · this.
    pub(super) fn depth_of(&self, ray: &Ray) -> f64 {
        ray.direction.dot(self.camera.forward)
    }

    /// How wide a pixel is in space, millimetres, at a distance along a ray near the middle of the picture.
    pub(super) fn pixel_size(&self, distance: f64) -> f64 {
        let scale = if self.camera.orthographic { 1.0 } else { distance.max(0.0) };
        2.0 * scale * self.camera.half_height / self.size[1] as f64
    }
}
